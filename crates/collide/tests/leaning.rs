//! Faces that lean, and overlap with all of their corners all the same, touch in four points, each with its own depth.

mod common;

use common::reference::{gap, outside};
use common::{Pair, Solid, V, kernel, turn, unit};
use fastrand::Rng;
use kinetarium_collide::{FAR, kind};
use numbers::{Float, Pose, Quat};
use std::collections::BTreeSet;

/// Half of the height and of the width of everything that stands.
const HALF: f64 = 0.4;

/// What stands on a flat face whose corners are a square or a circle: a box, a cylinder, a cone, a cube, a frustum
/// with bevelled edges.
fn standing() -> Vec<Solid> {
    let square = |half: f64, y: f64| {
        let corner = move |(x, z): (f64, f64)| V::new(half * x, y, half * z);
        [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)].map(corner)
    };
    let cube = [square(HALF, -HALF), square(HALF, HALF)].concat();
    let bevelled = [
        square(HALF, -HALF),
        square(1.25 * HALF, -0.75 * HALF),
        square(0.5 * HALF, HALF),
    ];
    let solid = |kind| Solid::new(kind, HALF, HALF, HALF);
    vec![
        solid(kind::BOX),
        solid(kind::CYLINDER),
        solid(kind::CONE),
        Solid::hull(cube),
        Solid::hull(bevelled.concat()),
    ]
}

/// Where a solid that leans by an angle [rad] and is turned about the vertical has all of its lower face under y = 0.
fn leaning(angle: f64, rng: &mut Rng) -> Pose<f64> {
    let heading = Quat::from_axis_angle(V::new(0.0, 1.0, 0.0), 6.3 * rng.f64());
    let (x, z) = (6.3 * rng.f64()).sin_cos();
    let lean = Quat::from_axis_angle(V::new(x, 0.0, z), angle);
    let highest = HALF * (2f64.sqrt() * angle.sin() - angle.cos());
    let at = V::new(rng.f64() - 0.5, -highest - 1e-3, rng.f64() - 0.5) * 0.2;
    Pose::new(V::new(at.x, -highest - 1e-3, at.z), lean * heading)
}

/// Leans from nothing to eight degrees [rad].
fn leans() -> impl Iterator<Item = f64> {
    (0..=32).map(|i| f64::from(i) * 0.25f64.to_radians())
}

fn on_a_plane<T: Float>(tolerance: f64) {
    let mut rng = Rng::with_seed(21);
    let plane = Solid::new(kind::PLANE, 0.0, 0.0, 0.0);
    for solid in standing() {
        for angle in leans() {
            for _ in 0..20 {
                let pose = leaning(angle, &mut rng);
                let pair = Pair {
                    solids: [plane.clone(), solid.clone()],
                    poses: [Pose::identity(), pose],
                };
                let found = kernel::manifold::<T>(&pair);
                for point in found.points {
                    let what = || format!("{angle}: {pair:#?} gave {found:#?}");
                    assert!(point.distance < 0.0, "{}", what());
                    // Its end on the solid: a point of the lower face's edge, as deep as it says.
                    let end = point.position + found.normal * (0.5 * point.distance);
                    assert!((end.y - point.distance).abs() < tolerance, "{}", what());
                    let V { x, y, z } = pose.q.rotate_inverse(end - pose.p);
                    let round = matches!(solid.kind, kind::CYLINDER | kind::CONE);
                    let out = if round {
                        x.hypot(z)
                    } else {
                        x.abs().min(z.abs())
                    };
                    assert!((out - HALF).abs() < tolerance, "{}", what());
                    assert!((y + HALF).abs() < tolerance, "{}", what());
                }
                let numbers: BTreeSet<_> = found.points.map(|p| p.feature as u32).into();
                assert_eq!(numbers.len(), 4, "{found:#?}");
            }
        }
    }
}

#[test]
fn on_a_plane_in_f32() {
    on_a_plane::<f32>(1e-6);
}

#[test]
fn on_a_plane_in_f64() {
    on_a_plane::<f64>(1e-12);
}

/// On a box or a hull all of a face touches, too, but for corners that two directions of an outline share.
fn on_a_face<T: Float>(tolerance: f64) {
    let mut rng = Rng::with_seed(24);
    let corners = (0..8).map(|i: i32| {
        let side = |bit: i32| f64::from(2 * (i >> bit & 1) - 1);
        V::new(side(0), HALF * side(1), side(2))
    });
    let slabs = [
        Solid::new(kind::BOX, 1.0, HALF, 1.0),
        Solid::hull(corners.collect()),
    ];
    for (below, above) in slabs
        .iter()
        .flat_map(|b| standing().into_iter().map(move |a| (b, a)))
    {
        let (mut met, mut whole) = (0, 0);
        for angle in leans() {
            for _ in 0..20 {
                let poses = [
                    Pose::new(V::new(0.0, -HALF, 0.0), Quat::identity()),
                    leaning(angle, &mut rng),
                ];
                let solids = [below.clone(), above.clone()];
                let pair = Pair { solids, poses };
                let pair = if below.kind > above.kind {
                    pair.swapped()
                } else {
                    pair
                };
                let found = kernel::manifold::<T>(&pair);
                let what = || format!("{angle}: {pair:#?} gave {found:#?}");
                let depth = gap(&pair, found.normal);
                // The rim of a cap is an octagon.
                assert!(
                    (found.distance() - depth).abs() < tolerance + 1e-3,
                    "{}",
                    what()
                );
                let touching = || found.points.iter().filter(|p| p.distance < 0.0);
                for point in touching() {
                    let half = found.normal * (0.5 * point.distance);
                    let ends = [point.position - half, point.position + half];
                    for ((solid, pose), end) in pair.solids.iter().zip(pair.poses).zip(ends) {
                        assert!(outside(solid, pose, end) < tolerance, "{}", what());
                    }
                }
                met += 1;
                whole += usize::from(touching().count() == 4);
                assert!(touching().count() >= 3, "{}", what());
            }
        }
        assert!(
            whole * 20 > 19 * met,
            "{} on {}: {whole} of {met}",
            above.kind,
            below.kind
        );
    }
}

#[test]
fn on_a_face_in_f32() {
    on_a_face::<f32>(1e-5);
}

#[test]
fn on_a_face_in_f64() {
    on_a_face::<f64>(1e-9);
}

/// A hull that rocks on a plane keeps each of its corners in one slot.
#[test]
fn a_rocking_hull_keeps_its_slots() {
    let mut rng = Rng::with_seed(22);
    let plane = Solid::new(kind::PLANE, 0.0, 0.0, 0.0);
    let cube = standing().swap_remove(3);
    let slots = |angle: f64, rng: &mut Rng| {
        let pair = Pair {
            solids: [plane.clone(), cube.clone()],
            poses: [Pose::identity(), leaning(angle, rng)],
        };
        kernel::manifold::<f64>(&pair).points.map(|p| p.feature)
    };
    let level = slots(0.0, &mut rng);
    for angle in leans() {
        for _ in 0..20 {
            assert_eq!(slots(angle, &mut rng), level, "{angle}");
        }
    }
}

/// Hulls of any shape in any attitude: the points are different vertices, and the lowest is one of them.
#[test]
fn any_hull_on_a_plane_touches_with_different_vertices() {
    let mut rng = Rng::with_seed(23);
    for count in [4, 5, 6, 8, 12, 40] {
        for _ in 0..500 {
            let size = V::new(rng.f64(), rng.f64(), rng.f64()) + V::new(0.1, 0.1, 0.1);
            let vertices = (0..count).map(|_| unit(&mut rng).times(size)).collect();
            let pose = Pose::new(V::zero(), turn(&mut rng));
            let pair = Pair {
                solids: [
                    Solid::new(kind::PLANE, 0.0, 0.0, 0.0),
                    Solid::hull(vertices),
                ],
                poses: [Pose::identity(), pose],
            };
            let found = kernel::manifold::<f64>(&pair);
            let points: Vec<_> = found.points.iter().filter(|p| p.distance < FAR).collect();
            let numbers: BTreeSet<_> = points.iter().map(|p| p.feature as usize).collect();
            assert_eq!(numbers.len(), points.len(), "{found:#?}");
            let height = |i: usize| pose.point(pair.solids[1].vertices[i]).y;
            for point in &points {
                let there = height(point.feature as usize);
                assert!((point.distance - there).abs() < 1e-12, "{found:#?}");
            }
            let lowest = (0..count).map(height).fold(f64::INFINITY, f64::min);
            assert!(found.distance() - lowest < 0.01 * pair.solids[1].reach());
        }
    }
}
