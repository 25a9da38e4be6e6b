//! The same answers, in the same order, whatever the structure and the number of threads.

use glam::Vec3;
use kinetarium_space::{
    Aabb, Bsp, Bvh, Cast, Grid, Hit, KdTree, Neighbor, Octree, Pair, Space, Structure,
    SweepAndPrune,
};

type Answers = (
    Vec<Pair>,
    Vec<Option<Hit>>,
    Vec<Vec<Hit>>,
    Vec<Vec<u32>>,
    Vec<Vec<Neighbor>>,
);

fn answers<S: Structure>(threads: usize) -> Answers {
    let mut random = fastrand::Rng::with_seed(7);
    let mut vector = |side: f32| side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
    let mut boxes: Vec<Aabb> = (0..20_000)
        .map(|_| Aabb::around(vector(40.0), vector(1.0)))
        .collect();
    boxes.push(Aabb::new(
        Vec3::NEG_INFINITY,
        Vec3::new(f32::INFINITY, 1.0, f32::INFINITY),
    ));
    let casts: Vec<Cast> = (0..1000)
        .map(|_| Cast::ray(vector(40.0), vector(2.0) - 1.0).unwrap())
        .collect();
    let regions: Vec<Aabb> = (0..500)
        .map(|_| Aabb::around(vector(40.0), vector(2.0)))
        .collect();
    let points: Vec<Vec3> = (0..500).map(|_| vector(40.0)).collect();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .unwrap();
    pool.install(|| {
        let mut space = Space::<S>::new(&boxes).unwrap();
        let moved: Vec<Aabb> = boxes
            .iter()
            .map(|b| Aabb::new(b.min + 0.5, b.max + 0.5))
            .collect();
        space.update(&moved).unwrap();
        (
            space.pairs(),
            space.cast_batch(&casts, space.boxes()),
            space.cast_all_batch(&casts[..100], space.boxes()),
            space.overlap_batch(&regions),
            space.nearest_batch(&points, 4, 5.0, space.boxes()),
        )
    })
}

#[test]
fn neither_threads_nor_structure_change_an_answer() {
    let expected = answers::<Bvh>(1);
    assert!(expected.0.len() > 10_000 && expected.1.iter().flatten().count() > 900);
    assert!(expected == answers::<Bvh>(2));
    assert!(expected == answers::<Bvh>(5));
    assert!(expected == answers::<SweepAndPrune>(3));
    assert!(expected == answers::<Grid>(1));
    assert!(expected == answers::<Grid>(3));
    assert!(expected == answers::<Octree>(2));
    assert!(expected == answers::<KdTree>(2));
    assert!(expected == answers::<Bsp>(2));
}

/// Neighbouring pixels' rays go together in lanes, and hit what each hits alone.
#[test]
fn rays_that_go_together_hit_what_they_hit_alone() {
    let mut random = fastrand::Rng::with_seed(11);
    let mut vector = |side: f32| side * Vec3::from_array(std::array::from_fn(|_| random.f32()));
    let boxes: Vec<Aabb> = (0..5000)
        .map(|_| Aabb::around(vector(40.0), vector(0.6)))
        .collect();
    let space = Space::<Bvh>::new(&boxes).unwrap();
    for (half, limit) in [(0.0, f32::INFINITY), (0.0, 30.0), (0.3, f32::INFINITY)] {
        let casts: Vec<Cast> = (0..4096)
            .map(|i| {
                let toward = Vec3::new((i / 64) as f32 - 31.5, (i % 64) as f32 - 31.5, 60.0);
                let from = Vec3::new(20.0, 20.0, -10.0) + vector(0.5);
                Cast::aabb(from, Vec3::splat(half), toward.normalize())
                    .unwrap()
                    .until(limit)
            })
            .collect();
        let alone: Vec<Option<Hit>> = casts
            .iter()
            .map(|cast| space.cast(cast, space.boxes()))
            .collect();
        assert!(alone.iter().flatten().count() > 500);
        assert_eq!(space.cast_batch(&casts, space.boxes()), alone);
    }
}
