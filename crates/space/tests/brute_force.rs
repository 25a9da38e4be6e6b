//! Every structure answers every query as brute force does, after any edits.

use glam::Vec3;
use kinetarium_space::{
    Aabb, Auto, Bsp, Bvh, Cast, Grid, Hit, KdTree, Neighbor, Octree, Pair, Space, Structure,
    SweepAndPrune,
};
use proptest::prelude::*;

/// The objects that should be there.
#[derive(Clone, Default)]
struct Truth(Vec<Option<Aabb>>);

impl Truth {
    fn present(&self) -> impl Iterator<Item = (u32, Aabb)> {
        let numbered = self.0.iter().enumerate();
        numbered.filter_map(|(i, b)| b.map(|b| (i as u32, b)))
    }
    fn pairs(&self) -> Vec<Pair> {
        let meets = |a: u32, x: Aabb| {
            let later = self.present().filter(move |(b, y)| a < *b && x.overlaps(y));
            later.map(move |(b, _)| Pair { a, b })
        };
        self.present().flat_map(|(a, x)| meets(a, x)).collect()
    }
    fn overlap(&self, region: &Aabb) -> Vec<u32> {
        self.present()
            .filter(|(_, b)| b.overlaps(region))
            .map(|(i, _)| i)
            .collect()
    }
    fn hits(&self, cast: &Cast) -> Vec<Hit> {
        let hit = |(object, b)| {
            cast.against(&b, cast.limit())
                .map(|time| Hit { object, time })
        };
        let mut hits: Vec<Hit> = self.present().filter_map(hit).collect();
        hits.sort_by(|x, y| x.time.total_cmp(&y.time).then(x.object.cmp(&y.object)));
        hits
    }
    fn nearest(&self, point: Vec3, k: usize, within: f32) -> Vec<Neighbor> {
        let neighbor = |(object, b): (u32, Aabb)| Neighbor {
            object,
            point: b.closest_point(point),
            distance_squared: b.distance_squared(point),
        };
        let mut near: Vec<Neighbor> = self.present().map(neighbor).collect();
        near.retain(|n| n.distance_squared <= within * within);
        near.sort_by(|x, y| {
            x.distance_squared
                .total_cmp(&y.distance_squared)
                .then(x.object.cmp(&y.object))
        });
        near.truncate(k);
        near
    }
}

#[derive(Clone, Debug)]
enum Edit {
    Insert(Aabb),
    Remove(usize),
    Relocate(usize, Aabb),
    MoveAll(Vec3),
}

#[derive(Clone, Debug)]
struct Questions {
    regions: Vec<Aabb>,
    casts: Vec<Cast>,
    points: Vec<Vec3>,
}

/// Whole numbers meet each other exactly; others hardly ever do.
fn coordinate() -> impl Strategy<Value = f32> {
    prop_oneof![(-5..6_i32).prop_map(|i| i as f32), -6.0..6.0_f32]
}
fn vector() -> impl Strategy<Value = Vec3> {
    [coordinate(), coordinate(), coordinate()].prop_map(Vec3::from_array)
}
fn half() -> impl Strategy<Value = Vec3> {
    let size = || prop_oneof![3 => 0.0..0.8_f32, 1 => Just(0.0), 1 => Just(0.5), 1 => 0.0..4.0_f32];
    [size(), size(), size()].prop_map(Vec3::from_array)
}
fn aabb() -> impl Strategy<Value = Aabb> {
    let unbounded = (0..3_usize, vector()).prop_map(|(axis, at)| {
        let mut plane = Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY);
        plane.max[axis] = at[axis];
        plane
    });
    prop_oneof![
        20 => (vector(), half()).prop_map(|(c, h)| Aabb::around(c, h)),
        2 => vector().prop_map(|c| Aabb::new(c, c)),
        2 => Just(Aabb::new(Vec3::ONE, Vec3::splat(2.0))),
        1 => vector().prop_map(|c| Aabb::around(1e6 * c, Vec3::ONE)),
        1 => unbounded,
    ]
}
fn scene() -> impl Strategy<Value = Vec<Aabb>> {
    prop_oneof![
        10 => prop::collection::vec(aabb(), 0..60),
        1 => (aabb(), 0..40_usize).prop_map(|(b, n)| vec![b; n]),
    ]
}
fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        3 => aabb().prop_map(Edit::Insert),
        3 => any::<usize>().prop_map(Edit::Remove),
        3 => (any::<usize>(), aabb()).prop_map(|(i, b)| Edit::Relocate(i, b)),
        1 => vector().prop_map(Edit::MoveAll),
    ]
}
fn cast() -> impl Strategy<Value = Cast> {
    let limit = prop_oneof![Just(f32::INFINITY), 0.0..3.0_f32];
    let grown = prop_oneof![2 => Just(Vec3::ZERO), 1 => half()];
    let valid = vector().prop_filter("a direction", |d| *d != Vec3::ZERO);
    (vector(), grown, valid, limit).prop_map(|(o, h, d, l)| Cast::aabb(o, h, d).unwrap().until(l))
}
fn questions() -> impl Strategy<Value = Questions> {
    let regions = prop::collection::vec(aabb(), 4);
    let casts = prop::collection::vec(cast(), 8);
    let points = prop::collection::vec(vector(), 4);
    (regions, casts, points).prop_map(|(regions, casts, points)| Questions {
        regions,
        casts,
        points,
    })
}

fn compare<S: Structure>(space: &Space<S>, truth: &Truth, ask: &Questions) {
    assert_eq!(space.pairs(), truth.pairs());
    for region in &ask.regions {
        assert_eq!(space.overlap(region), truth.overlap(region), "{region:?}");
    }
    let batch = space.cast_batch(&ask.casts, space.boxes());
    let alone = ask.casts.iter().map(|cast| space.cast(cast, space.boxes()));
    assert!(batch.into_iter().eq(alone));
    for cast in &ask.casts {
        let hits = truth.hits(cast);
        assert_eq!(
            space.cast(cast, space.boxes()).as_ref(),
            hits.first(),
            "{cast:?}"
        );
        assert_eq!(space.cast_all(cast, space.boxes()), hits, "{cast:?}");
        let mut visited = Vec::new();
        space.sweep(cast, |object| {
            visited.push(object);
            cast.limit()
        });
        assert!(hits.iter().all(|hit| visited.contains(&hit.object)));
        // The first of all is visited also where what comes after a hit no longer counts.
        let mut first: Option<(f32, u32)> = None;
        space.sweep(cast, |object| {
            let limit = first.map_or(cast.limit(), |(time, _)| time);
            let hit = cast.against(space.boxes().get(object), limit);
            let found = first.into_iter().chain(hit.map(|time| (time, object)));
            first = found.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            first.map_or(cast.limit(), |(time, _)| time)
        });
        let expected = hits.first().map(|hit| (hit.time, hit.object));
        assert_eq!(first, expected, "{cast:?}");
    }
    for &point in &ask.points {
        for (k, within) in [(1, f32::INFINITY), (5, 2.0), (1000, 3.0)] {
            let near = truth.nearest(point, k, within);
            assert_eq!(
                space.nearest(point, k, within, space.boxes()),
                near,
                "{k} nearest of {point}"
            );
            let mut visited = Vec::new();
            space.approach(point, within, |object| {
                visited.push(object);
                within
            });
            let all = truth.nearest(point, usize::MAX, within);
            assert!(all.iter().all(|near| visited.contains(&near.object)));
        }
    }
}

fn apply<S: Structure>(space: &mut Space<S>, truth: &mut Truth, edit: &Edit) {
    match edit {
        Edit::Insert(aabb) => {
            let object = space.insert(*aabb).unwrap() as usize;
            truth.0.resize(truth.0.len().max(object + 1), None);
            assert_eq!(truth.0[object].replace(*aabb), None);
        }
        Edit::Remove(i) if !truth.0.is_empty() => {
            let object = i % truth.0.len();
            let expected = truth.0[object].take().is_some();
            assert_eq!(space.remove(object as u32).is_ok(), expected);
        }
        Edit::Relocate(i, aabb) if !truth.0.is_empty() => {
            let object = i % truth.0.len();
            let done = space.relocate(object as u32, *aabb).is_ok();
            assert_eq!(done, truth.0[object].is_some());
            truth.0[object] = truth.0[object].map(|_| *aabb);
        }
        Edit::MoveAll(by) => {
            // Farther apart or closer together, and shifted.
            let moved = |b: Aabb| Aabb::around(b.center() * by.x.abs() + *by, 0.5 * b.extent());
            let moved = |b: Aabb| if b.extent().is_finite() { moved(b) } else { b };
            truth.0.iter_mut().flatten().for_each(|b| *b = moved(*b));
            let boxes: Vec<Aabb> = truth.0.iter().map(|b| b.unwrap_or(Aabb::EMPTY)).collect();
            space.update(&boxes).unwrap();
        }
        Edit::Remove(_) | Edit::Relocate(..) => {}
    }
}

fn check<S: Structure>(scene: &[Aabb], edits: &[Edit], ask: &Questions) {
    let mut space = Space::<S>::new(scene).unwrap();
    let mut truth = Truth(scene.iter().copied().map(Some).collect());
    compare(&space, &truth, ask);
    for edit in edits {
        apply(&mut space, &mut truth, edit);
        compare(&space, &truth, ask);
    }
}

macro_rules! structures {
    ($($name:ident: $structure:ty),*) => { $(
        mod $name {
            use super::*;
            proptest! {
                #![proptest_config(ProptestConfig::with_cases(400))]
                #[test]
                fn small(scene in scene(), edits in prop::collection::vec(edit(), 0..30), ask in questions()) {
                    check::<$structure>(&scene, &edits, &ask);
                }
            }
            proptest! {
                #![proptest_config(ProptestConfig::with_cases(6))]
                #[test]
                fn large(scene in prop::collection::vec(aabb(), 1000..3000), edits in prop::collection::vec(edit(), 0..4), ask in questions()) {
                    check::<$structure>(&scene, &edits, &ask);
                }
            }
        }
    )* };
}

structures!(bvh: Bvh, sweep_and_prune: SweepAndPrune, grid: Grid, octree: Octree, kd_tree: KdTree, bsp: Bsp, auto: Auto);
