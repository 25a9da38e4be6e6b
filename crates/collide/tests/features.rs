//! While the same features touch, contacts keep their numbers, by which a solver starts warm.

mod common;

use common::{Pair, Solid, V, kernel, unit};
use fastrand::Rng;
use kinetarium_collide::kind;
use numbers::{Pose, Quat};
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
