//! Distances of solids in double precision, and when one that moves meets another.

mod common;
#[path = "../../sim/tests/solids/level.rs"]
mod level;

use common::reference::{best_gap, gap, support};
use common::{Pair, Solid, V, turn, unit};
use fastrand::Rng;
use glam::{DQuat, DVec3};
use kinetarium_collide::distance::{Convex, Separation, first_touch, outside, separation};
use kinetarium_collide::kind::{self, CONVEX, PLANE, SPHERE};
use level::level;
use model::{Geometry, Hull, Pose};
use numbers::dispatch::Isa;

fn geometry(solid: &Solid) -> Geometry {
    let V { x, y, z } = solid.size;
    let (radius, half_height, half) = (x, y, DVec3::new(x, y, z));
    match solid.kind {
        kind::PLANE => Geometry::Plane {
            half_x: 0.0,
            half_z: 0.0,
        },
        kind::SPHERE => Geometry::Sphere { radius },
        kind::CAPSULE => Geometry::Capsule {
            radius,
            half_height,
        },
        kind::CYLINDER => Geometry::Cylinder {
            radius,
            half_height,
        },
        kind::CONE => Geometry::Cone {
            radius,
            half_height,
        },
        kind::BOX => Geometry::Box { half },
        kind::ELLIPSOID => Geometry::Ellipsoid { half },
        _ => {
            let vertices: Vec<_> = solid.vertices.iter().map(|v| from(*v)).collect();
            Geometry::Hull(Hull::new(&vertices).unwrap())
        }
    }
}

/// The level of a solid in its place.
fn beyond(solid: &Solid, at: numbers::Pose<f64>, x: V) -> f64 {
    level(&geometry(solid), pose(at).inverse().point(from(x)))
}

fn from(v: V) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

fn to(v: DVec3) -> V {
    V::new(v.x, v.y, v.z)
}

fn pose(p: numbers::Pose<f64>) -> Pose {
    let q = DQuat::from_xyzw(p.q.x, p.q.y, p.q.z, p.q.w);
    Pose::new(from(p.p), q.normalize())
}

/// The points of A and B that a way leads from and to are points of theirs, and nothing of them is between planes through
/// these: the distance can be no other.
#[track_caller]
fn check_apart(pair: &Pair, way: &Separation) {
    let Separation {
        distance,
        normal,
        on_b,
    } = *way;
    let tolerance = 1e-11 * pair.scale();
    let on_a = on_b - distance * normal;
    // The gap falls short of |v| by 1e-10 of it at most, the way of the normal by the root of that. Levels of ellipsoids and cones are
    // steeper than distances, by ten at most.
    let tolerances = [1e-5 * distance, 10.0 * tolerance];
    for (i, (point, tolerance)) in [on_a, on_b].into_iter().zip(tolerances).enumerate() {
        let off = beyond(&pair.solids[i], pair.poses[i], to(point));
        assert!(off < tolerance, "{off:e} off {i}: {pair:?} {way:?}");
    }
    // The normal errs by rounding over distance, and the gap by that times the extent.
    let wrong = (gap(pair, to(normal)) - distance).abs();
    let rounding = 1e-15 * pair.scale().powi(2) / distance;
    assert!(wrong < tolerance + rounding, "{wrong:e}: {pair:?} {way:?}");
}

/// Of each pair of kinds, in 200 poses: the nearest points are found where the two are apart, and a way out as short
/// as that of other code where they are not.
#[test]
fn ways_between_solids_are_the_shortest() {
    let isa = Isa::detect();
    let mut rng = Rng::with_seed(11);
    let (mut apart, mut longer) = (0, 0);
    for a in PLANE..CONVEX {
        for b in a.max(SPHERE)..CONVEX {
            for _ in 0..200 {
                let pair = Pair::random([a, b], &mut rng);
                let shapes = [0, 1].map(|i| geometry(&pair.solids[i]));
                let [first, second] =
                    [0, 1].map(|i| Convex::new(&shapes[i], pose(pair.poses[i])).unwrap());
                let way = separation(isa, &first, &second).unwrap();
                let back = separation(isa, &second, &first).unwrap();
                let tolerance = 1e-9 * pair.scale();
                if way.distance > 0.0 {
                    apart += 1;
                    check_apart(&pair, &way);
                    assert!((back.distance - way.distance).abs() < tolerance);
                } else {
                    assert!((gap(&pair, to(way.normal)) - way.distance).abs() < tolerance);
                    let shortest = best_gap(&pair).max(gap(&pair, to(-back.normal)));
                    longer += usize::from(way.distance < shortest - 1e-6 * pair.scale());
                }
            }
        }
    }
    assert!(
        apart > 1000 && longer < 70,
        "{apart} apart, {longer} longer"
    );
}

/// Distances down to the size of rounding, also of corners, where no surface tells the normal.
#[test]
fn solids_that_nearly_touch_are_apart_by_what_is_left() {
    let isa = Isa::detect();
    let mut rng = Rng::with_seed(12);
    for (a, b) in [(5, 5), (5, 7), (7, 7), (2, 5), (1, 7)] {
        for _ in 0..200 {
            let mut pair = Pair::random([a, b], &mut rng);
            let shapes = [0, 1].map(|i| geometry(&pair.solids[i]));
            let at = |pair: &Pair, i: usize| Convex::new(&shapes[i], pose(pair.poses[i])).unwrap();
            // Apart first; then along the way to where a millionth and less is left.
            pair.poses[1].p += unit(&mut rng) * (2.0 * pair.scale());
            let way = separation(isa, &at(&pair, 0), &at(&pair, 1)).unwrap();
            let left = 10f64.powf(-3.0 - 6.0 * rng.f64());
            pair.poses[1].p -= to(way.normal) * (way.distance - left);
            let near = separation(isa, &at(&pair, 0), &at(&pair, 1)).unwrap();
            assert!(
                (near.distance - left).abs() < 1e-8 * pair.scale(),
                "{left:e}: {near:?}"
            );
        }
    }
}

/// Outside, the nearest point is in the solid, and all of that is beyond the plane through it across the way: no point is
/// nearer. Inside, the way out ends on the surface, and there is none shorter in any direction.
#[test]
fn points_are_as_far_outside_as_no_other_point_of_the_surface_is_near() {
    let isa = Isa::detect();
    let mut rng = Rng::with_seed(13);
    for kind in SPHERE..CONVEX {
        let mut inside = 0;
        for _ in 0..400 {
            let solid = Solid::random(kind, &mut rng);
            let shape = geometry(&solid);
            let convex = Convex::new(&shape, Pose::IDENTITY).unwrap();
            let x = from(unit(&mut rng)) * (1.5 * rng.f64() * solid.reach());
            let found = outside(isa, &convex, x);
            let case = format!("{solid:?} at {x}: {found:?}");
            let height = |n: DVec3| n.dot(x) - n.dot(from(support(&solid, to(n))));
            assert!((found.normal.length() - 1.0).abs() < 1e-12, "{case}");
            let (distance, on) = (found.distance, x - found.distance * found.normal);
            assert!(
                level(&shape, on).abs() < 1e-9,
                "{case}: {:e}",
                level(&shape, on)
            );
            assert!(distance * level(&shape, x) >= -1e-15, "{case}");
            let wrong = (height(found.normal) - distance).abs();
            assert!(wrong < 1e-12 + 1e-14 / distance.abs(), "{case}: {wrong:e}");
            if distance < 0.0 {
                inside += 1;
                for _ in 0..100 {
                    assert!(height(from(unit(&mut rng))) < distance + 1e-9, "{case}");
                }
            }
        }
        assert!(inside > 30, "{kind}: {inside} inside");
    }
}

/// Newton's root of an ellipsoid where axes are equal, where a point is on planes of symmetry, in the middle, and far away.
#[test]
fn ellipsoids_have_a_nearest_point_everywhere() {
    let isa = Isa::detect();
    for half in [
        DVec3::new(1.0, 2.0, 3.0),
        DVec3::new(2.0, 2.0, 1.0),
        DVec3::new(1.0, 2.0, 2.0),
        DVec3::ONE,
        DVec3::new(1e-3, 1.0, 1.0),
    ] {
        let shape = Geometry::Ellipsoid { half };
        let convex = Convex::new(&shape, Pose::IDENTITY).unwrap();
        let level = |p: DVec3| (p / half).length() - 1.0;
        let scales = [-1.5, -0.3, -1e-9, 0.0, 1e-12, 0.2, 0.9, 1.0, 3.0, 1e6];
        for (i, x) in scales.into_iter().enumerate() {
            for y in scales {
                let p = half * DVec3::new(x, y, scales[(i + 3) % scales.len()]);
                let found = outside(isa, &convex, p);
                let on = p - found.distance * found.normal;
                let far = 1.0 + p.length() / half.min_element();
                let case = format!("{half} at {p}: {found:?}");
                assert!(level(on).abs() < 1e-14 * far, "{case}: {:e}", level(on));
                assert!(found.distance * level(p) >= -1e-14 * far, "{case}");
                let gradient = (on / (half * half)).normalize();
                assert!((found.normal - gradient).length() < 1e-9 * far, "{case}");
            }
        }
    }
}

/// Where a cast ends, a point is in both solids; before, the plane across the normal is between them.
#[test]
fn a_solid_stops_where_it_touches_and_no_sooner() {
    let isa = Isa::detect();
    let mut rng = Rng::with_seed(14);
    let (mut hits, mut misses) = (0, 0);
    for a in SPHERE..CONVEX {
        for b in PLANE..CONVEX {
            for _ in 0..60 {
                let solids = [a, b].map(|kind| Solid::random(kind, &mut rng));
                let reach = solids[0].reach() + solids[1].reach();
                let aim = unit(&mut rng) * (0.9 * rng.f64() * reach);
                let direction = unit(&mut rng);
                let start = aim - direction * (3.0 * reach);
                let poses = [
                    numbers::Pose::new(start, turn(&mut rng)),
                    numbers::Pose::new(V::zero(), turn(&mut rng)),
                ];
                let shapes = [0, 1].map(|i| geometry(&solids[i]));
                let [first, second] =
                    [0, 1].map(|i| Convex::new(&shapes[i], pose(poses[i])).unwrap());
                let span = [0.0, 6.0 * reach];
                let found = first_touch(isa, &first, &second, from(direction), span);
                let mut pair = Pair { solids, poses };
                let Some((t, way)) = found else {
                    misses += 1;
                    // Nothing overlaps anywhere on the way.
                    for i in 0..60 {
                        pair.poses[0].p = start + direction * (0.1 * f64::from(i) * reach);
                        let moved = if b == PLANE {
                            pair.swapped()
                        } else {
                            pair.clone()
                        };
                        assert!(best_gap(&moved) > -1e-9 * reach, "{moved:?}");
                    }
                    continue;
                };
                let speed = way.normal.dot(from(direction));
                if t == 0.0 {
                    assert!(b == PLANE, "overlaps at once: {pair:?}");
                    continue;
                }
                hits += 1;
                assert!(speed > 0.0, "{way:?}");
                pair.poses[0].p = start + direction * t;
                for i in 0..2 {
                    let off = beyond(&pair.solids[i], pair.poses[i], to(way.on_b));
                    // The way is from 1e-8 of the sizes before.
                    assert!(off < 1e-6 * reach, "{off:e} off {i}: {pair:?} {way:?}");
                }
                // The gap along n shrinks at that speed: it was open at all times before.
                let n = to(way.normal);
                let left = if b == PLANE {
                    gap(&pair.swapped(), -n)
                } else {
                    gap(&pair, n)
                };
                // The normal errs by 1e-8, and the gap by that times the extents.
                assert!(left > -1e-7 * reach, "{left:e} beyond: {pair:?} {way:?}");
            }
        }
    }
    assert!(hits > 1500 && misses > 200, "{hits} hits, {misses} misses");
}
