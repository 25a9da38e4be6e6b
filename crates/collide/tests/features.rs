//! While the same features touch, contacts keep their numbers, by which a solver starts warm.

mod common;

use common::{Pair, Solid, V, kernel, unit};
use fastrand::Rng;
use kinetarium_collide::kind;
use numbers::{Float, Pose, Quat};
use std::collections::BTreeSet;

fn cube() -> Solid {
    let corners = (0..8).map(|i: i32| {
        let side = |bit: i32| if i >> bit & 1 == 0 { -0.4 } else { 0.4 };
        V::new(side(0), side(1), side(2))
    });
    Solid::hull(corners.collect())
}

fn solid(kind: usize) -> Solid {
    match kind {
        kind::HULL => cube(),
        kind::CAPSULE => Solid::new(kind, 0.2, 0.6, 0.2),
        _ => Solid::new(kind, 0.4, 0.4, 0.4),
    }
}

/// The numbers of the points that touch.
fn features(pair: &Pair) -> BTreeSet<u32> {
    let found = kernel::manifold::<f32>(pair);
    let touching = found.points.iter().filter(|p| p.distance < 0.01);
    let numbers: Vec<_> = touching.map(|p| p.feature as u32).collect();
    let different: BTreeSet<_> = numbers.iter().copied().collect();
    assert_eq!(numbers.len(), different.len(), "{found:#?}");
    different
}

/// A solid that rests on another one, turned about the vertical, and shaken a little.
#[test]
fn resting_solids_keep_their_features() {
    let mut rng = Rng::with_seed(43);
    for below in [kind::PLANE, kind::CYLINDER, kind::BOX, kind::HULL] {
        for above in [kind::CYLINDER, kind::CONE, kind::BOX, kind::HULL] {
            let height = if below == kind::PLANE { 0.4 } else { 0.8 };
            let mut changed = 0;
            for _ in 0..100 {
                let q = Quat::from_axis_angle(V::new(0.0, 1.0, 0.0), 6.3 * rng.f64());
                let (x, z) = (0.3 * rng.f64(), 0.3 * rng.f64());
                let mut shaken = || {
                    let by = Quat::from_axis_angle(unit(&mut rng), 1e-5);
                    let at = V::new(x, height, z) + unit(&mut rng) * 1e-6;
                    let poses = [Pose::identity(), Pose::new(at, by * q)];
                    let pair = Pair {
                        solids: [solid(below), solid(above)],
                        poses,
                    };
                    if below > above { pair.swapped() } else { pair }
                };
                changed += usize::from(features(&shaken()) != features(&shaken()));
            }
            assert!(changed <= 3, "{below} {above}: {changed} of 100");
        }
    }
}

/// The slots of the points that touch, with their numbers.
fn slots<T: Float>(pair: &Pair) -> Vec<(usize, u32)> {
    let points = kernel::manifold::<T>(pair).points;
    let touching = (0..4).filter(|&slot| points[slot].distance < 0.01);
    touching
        .map(|slot| (slot, points[slot].feature as u32))
        .collect()
}

/// A solid that lies on its side on a plane, with either end lower by rounding: each end keeps its slot and its number.
fn lying_solids_keep_their_slots<T: Float>(rocked: f64) {
    let mut rng = Rng::with_seed(44);
    for kind in [kind::CYLINDER, kind::CONE, kind::CAPSULE] {
        let (radius, half) = (0.2, 0.5);
        // From the apex of a cone at half its height to the line along its side.
        let (lean, height) = match kind {
            kind::CONE => {
                let lean = f64::atan2(radius, 2.0 * half);
                (lean, half * lean.sin())
            }
            _ => (0.0, radius),
        };
        for _ in 0..100 {
            let axis = unit(&mut rng);
            let rolled = Quat::from_axis_angle(V::new(0.0, 1.0, 0.0), 6.3 * rng.f64());
            let heading = Quat::from_axis_angle(V::new(0.0, 1.0, 0.0), 6.3 * rng.f64());
            let mut kept = Vec::new();
            for by in [rocked, -rocked] {
                // Apex at +x, the base a little higher there than on the ground.
                let quarter = 0.25 * std::f64::consts::TAU;
                let down = Quat::from_axis_angle(V::new(0.0, 0.0, 1.0), -quarter - lean + by);
                let q = heading * down * rolled;
                let at = V::new(axis.x, height, axis.z);
                let pair = Pair {
                    solids: [solid(kind::PLANE), Solid::new(kind, radius, half, 0.0)],
                    poses: [Pose::identity(), Pose::new(at, q)],
                };
                kept.push(slots::<T>(&pair));
            }
            assert_eq!(kept[0], kept[1], "{kind}");
            assert_eq!(kept[0].len(), 2, "{kind}: {kept:?}");
        }
    }
}

#[test]
fn lying_solids_keep_their_slots_in_f32() {
    lying_solids_keep_their_slots::<f32>(1e-6);
}

#[test]
fn lying_solids_keep_their_slots_in_f64() {
    lying_solids_keep_their_slots::<f64>(1e-12);
}

/// A cylinder that leans or rolls over keeps the number of each end.
#[test]
fn a_cylinder_that_turns_over_keeps_the_places_of_its_ends() {
    for lean in [0.3, 1.0, 1.5, 1.6, 2.0, 2.8] {
        let q = Quat::from_axis_angle(V::new(0.0, 0.0, 1.0), lean);
        let pair = Pair {
            solids: [
                solid(kind::PLANE),
                Solid::new(kind::CYLINDER, 0.2, 0.5, 0.0),
            ],
            poses: [Pose::identity(), Pose::new(V::zero(), q)],
        };
        let points = kernel::manifold::<f64>(&pair).points;
        assert_eq!([points[0].feature, points[2].feature], [5.0, 4.0]);
        let ends = [-0.5, 0.5].map(|y| q.rotate(V::new(0.0, y, 0.0)));
        for (point, end) in [points[0], points[2]].into_iter().zip(ends) {
            let lowest = end.y - 0.2 * lean.sin().abs();
            assert!((point.distance - lowest).abs() < 1e-12, "{lean}: {point:?}");
        }
    }
}
