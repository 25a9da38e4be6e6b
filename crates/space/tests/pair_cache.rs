//! A cache of pairs has the pairs that there are, whatever was there before.

use glam::Vec3;
use kinetarium_space::{Aabb, Bvh, Pair, PairCache, Space, SpaceError};
use proptest::prelude::*;

fn may_meet(pair: Pair) -> bool {
    !(pair.a + pair.b).is_multiple_of(5)
}

/// The pairs of a cache whose boxes overlap now.
fn overlapping<K: Default>(cache: &PairCache<K>, boxes: &[Aabb]) -> Vec<Pair> {
    let pairs = cache.pairs().iter().map(|kept| kept.0);
    let overlap = |pair: &Pair| boxes[pair.a as usize].overlaps(&boxes[pair.b as usize]);
    pairs.filter(overlap).collect()
}

fn expected(boxes: &[Aabb]) -> Vec<Pair> {
    let pairs = Space::<Bvh>::new(boxes).unwrap().pairs().into_iter();
    pairs.filter(|pair| may_meet(*pair)).collect()
}

const OBJECTS: usize = 300;

/// Which objects go in an update, and how far: one, so that it is put in its place alone; some; or all.
fn motion() -> impl Strategy<Value = (std::ops::Range<usize>, f32)> {
    let count = prop_oneof![Just(1), Just(30), Just(OBJECTS)];
    let who = (0..OBJECTS, count).prop_map(|(first, count)| {
        let first = first % (OBJECTS + 1 - count);
        first..first + count
    });
    (who, prop_oneof![Just(0.01_f32), Just(0.2), Just(5.0)])
}

proptest! {
    #[test]
    fn overlapping_pairs_are_those_of_the_boxes(
        motions in prop::collection::vec(motion(), 1..30),
        seed: u64,
    ) {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut vector = |side: f32| side * (Vec3::from_array([0; 3].map(|_| random.f32())) - 0.5);
        let mut boxes: Vec<_> = (0..OBJECTS)
            .map(|_| Aabb::around(vector(7.0), 0.5 + vector(0.8)))
            .collect();
        boxes[7] = Aabb::new(Vec3::NEG_INFINITY, Vec3::new(f32::INFINITY, 0.0, f32::INFINITY));
        let mut cache = PairCache::<u32>::default();
        for (who, side) in motions {
            for own in &mut boxes[who] {
                let shift = vector(side);
                *own = Aabb::new(own.min + shift, own.max + shift);
            }
            cache.update(&boxes, may_meet).unwrap();
            prop_assert!(cache.pairs().is_sorted_by_key(|kept| kept.0));
            prop_assert_eq!(overlapping(&cache, &boxes), expected(&boxes));
        }
    }
}

fn row(shift: f32) -> Vec<Aabb> {
    let at = |i: u16| Aabb::around(Vec3::X * (0.9 * f32::from(i) + shift), Vec3::splat(0.5));
    (0..20).map(at).collect()
}

#[test]
fn what_is_known_of_a_pair_is_kept_while_it_stays() {
    let mut cache = PairCache::<u32>::default();
    let mut update = |boxes: &[Aabb]| {
        cache.update(boxes, |_| true).unwrap();
        for (_, times) in cache.pairs_mut() {
            *times += 1;
        }
        cache.pairs().to_vec()
    };
    let neighbours = update(&row(0.0));
    assert_eq!(neighbours.len(), 19);
    let mut boxes = row(0.001);
    assert!(update(&boxes).iter().all(|kept| kept.1 == 2));
    // One leaves, and comes back: it is as new.
    boxes[10] = Aabb::around(Vec3::Y * 9.0, Vec3::splat(0.5));
    assert_eq!(update(&boxes).len(), 17);
    for (pair, times) in update(&row(0.001)) {
        let new = pair.a == 10 || pair.b == 10;
        assert_eq!(times, if new { 1 } else { 4 }, "{pair:?}");
    }
}

/// A box goes up and down by a length a step, 2 cm beside a point. Where it is slow, its fat box holds the point;
/// where it is fast, it has none that is larger than its own.
#[test]
fn fat_boxes_are_for_what_is_slow() {
    let pairs = |length: f32| {
        let mut cache = PairCache::<()>::default();
        for step in 0..20 {
            let height = if step % 2 == 0 { 0.0 } else { length };
            let one = Aabb::around(Vec3::Y * height, Vec3::splat(0.5));
            let point = Aabb::around(Vec3::X * 0.52, Vec3::ZERO);
            cache.update(&[one, point], |_| true).unwrap();
        }
        cache.pairs().len()
    };
    assert_eq!([pairs(1e-3), pairs(0.3)], [1, 0]);
}

#[test]
fn bad_boxes_are_refused_and_nothing_is_lost() {
    let mut cache = PairCache::<u32>::default();
    let boxes = row(0.0);
    cache.update(&boxes, |_| true).unwrap();
    for bad in [Vec3::NAN, Vec3::splat(-9.0)] {
        let mut wrong = row(0.3);
        wrong[3].max = bad;
        let error = cache.update(&wrong, |_| true).unwrap_err();
        let at_3 = matches!(
            error,
            SpaceError::NotANumber { object: 3, .. } | SpaceError::InsideOut { object: 3, .. }
        );
        assert!(at_3, "{error}");
        assert_eq!(overlapping(&cache, &boxes).len(), 19);
    }
    cache.update(&row(0.3), |_| true).unwrap();
    assert_eq!(overlapping(&cache, &row(0.3)).len(), 19);
}

/// Another number of objects is another scene.
#[test]
fn objects_may_come_and_go_all_together() {
    let mut cache = PairCache::<u32>::default();
    cache.update(&row(0.0), |_| true).unwrap();
    cache.update(&row(0.0)[..5], |_| true).unwrap();
    assert_eq!(cache.pairs().len(), 4);
    cache.update(&[], |_| true).unwrap();
    assert!(cache.pairs().is_empty());
}
