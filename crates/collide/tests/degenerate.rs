//! Poses in which nothing is unique: concentric, touching, parallel, needles, no thickness; and
//! pairs seen from both sides.

mod common;

use common::reference::{best_gap, gap};
use common::{Pair, Solid, V, kernel, turn, unit};
use fastrand::Rng;
use kinetarium_collide::{FAR, FLAT, Manifold, Route, kind};
use numbers::{Float, Pose, Quat};

/// One solid of each kind, scaled along its axes.
fn solids(x: f64, y: f64, z: f64) -> Vec<Solid> {
    let tetrahedron = [[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]];
    let corner = |c: [i32; 3]| V::from_array(c.map(f64::from)).times(V::new(x, y, z));
    let of = |kind| match kind {
        kind::CAPSULE => Solid::new(kind, x, y.max(1.01 * x), 0.0),
        kind::HULL => Solid::hull(tetrahedron.map(corner).to_vec()),
        _ => Solid::new(kind, x, y, z),
    };
    (0..kind::CONVEX).map(of).collect()
}

/// Every pair of kinds in a pose, the lower kind first.
fn pairs(sizes: [f64; 3], poses: [Pose<f64>; 2]) -> Vec<Pair> {
    let [x, y, z] = sizes;
    let solids = solids(x, y, z);
    let mut pairs = Vec::new();
    for a in &solids {
        for b in &solids {
            if a.kind <= b.kind && Route::of(a.kind, b.kind).is_some() {
                let solids = [a.clone(), b.clone()];
                pairs.push(Pair { solids, poses });
            }
        }
    }
    pairs
}

fn at(x: f64, y: f64, z: f64) -> Pose<f64> {
    Pose::new(V::new(x, y, z), Quat::identity())
}

fn quarter_turns() -> [Quat<f64>; 4] {
    let s = 0.5f64.sqrt();
    [
        Quat::identity(),
        Quat::new(s, 0.0, 0.0, s),
        Quat::new(0.0, s, 0.0, s),
        Quat::new(0.0, 0.0, s, s),
    ]
}

/// All numbers finite, the normal of unit length, and the distance that of the normal.
fn sane(pair: &Pair, found: &Manifold<f64>, tolerance: f64) {
    let numbers = found.points.iter().flat_map(|p| {
        let [x, y, z] = p.position.to_array();
        [x, y, z, p.distance, p.feature]
    });
    let [x, y, z] = found.normal.to_array();
    let finite = numbers.chain([x, y, z]).all(f64::is_finite);
    assert!(finite, "{pair:#?} gave {found:#?}");
    let length = found.normal.length();
    assert!((length - 1.0).abs() < 1e-5, "{length}: {pair:#?}");
    for p in &found.points {
        assert!(p.feature >= 0.0 && p.feature.fract() == 0.0 && p.feature < 16_777_216.0);
        assert!(p.distance == FAR || p.distance < 100.0, "{found:#?}");
    }
    let along = gap(pair, found.normal);
    let reach = pair.solids[0].reach().max(pair.solids[1].reach());
    let off = found.distance() - along;
    assert!(
        (-tolerance * pair.scale()..=FLAT * reach + tolerance * pair.scale()).contains(&off),
        "{off}: {pair:#?} gave {found:#?}"
    );
}

fn in_both(pair: &Pair) {
    sane(pair, &kernel::manifold::<f32>(pair), 1e-5);
    sane(pair, &kernel::manifold::<f64>(pair), 1e-7);
}

#[test]
fn concentric() {
    for q in quarter_turns() {
        for pair in pairs(
            [0.3, 0.5, 0.4],
            [at(1.0, 2.0, 3.0), Pose::new(V::new(1.0, 2.0, 3.0), q)],
        ) {
            in_both(&pair);
        }
    }
}

#[test]
fn touching_and_parallel() {
    for axis in [
        V::new(1.0, 0.0, 0.0),
        V::new(0.0, 1.0, 0.0),
        V::new(0.0, 0.0, 1.0),
    ] {
        for way in [0.5, 0.6, 0.8, 1.0, 1.2, -1.0] {
            for q in quarter_turns() {
                let b = Pose::new(axis * way, q);
                for pair in pairs([0.3, 0.5, 0.4], [at(0.0, 0.0, 0.0), b]) {
                    in_both(&pair);
                }
            }
        }
    }
}

#[test]
fn needles_and_sheets() {
    let mut rng = Rng::with_seed(3);
    for sizes in [
        [1e-3, 1.0, 1e-3],
        [1.0, 1e-3, 1.0],
        [1e-3, 1e-3, 1.0],
        [1.0, 0.0, 1.0],
        [0.0, 1.0, 0.0],
    ] {
        for _ in 0..200 {
            let poses = [
                Pose::new(unit(&mut rng) * 0.5, turn(&mut rng)),
                Pose::new(V::zero(), turn(&mut rng)),
            ];
            for pair in pairs(sizes, poses) {
                in_both(&pair);
            }
        }
        for q in quarter_turns() {
            for pair in pairs(sizes, [at(0.0, 1e-3, 0.0), Pose::new(V::zero(), q)]) {
                in_both(&pair);
            }
        }
    }
}

/// Solids of one kind, exchanged: the same distance, the opposite normal.
fn symmetric<T: Float>(tolerance: f64) {
    let mut rng = Rng::with_seed(5);
    for kind in kind::SPHERE..kind::CONVEX {
        for _ in 0..1000 {
            let pair = Pair::random([kind, kind], &mut rng);
            let slack = tolerance * pair.scale();
            let (one, other) = (
                kernel::manifold::<T>(&pair),
                kernel::manifold::<T>(&pair.swapped()),
            );
            // Where the shortest way out is not unique, or was not found, each side has its own.
            let unique =
                best_gap(&pair) > -0.05 * pair.solids[0].reach().min(pair.solids[1].reach());
            if !unique {
                continue;
            }
            assert!(
                (one.distance() - other.distance()).abs() < slack + FLAT * pair.scale(),
                "{pair:#?}"
            );
            let along = gap(&pair, -other.normal);
            assert!((gap(&pair, one.normal) - along).abs() < slack, "{pair:#?}");
        }
    }
}

#[test]
fn exchanged_in_f32() {
    symmetric::<f32>(2e-5);
}

#[test]
fn exchanged_in_f64() {
    symmetric::<f64>(1e-7);
}

/// How many points touch, and the span between the farthest two.
fn touching(pair: &Pair) -> usize {
    let found = kernel::manifold::<f32>(pair);
    found.points.iter().filter(|p| p.distance < 1e-3).count()
}

/// Faces that rest on each other touch in as many points as keep them there.
#[test]
fn resting_faces_touch_in_enough_points() {
    let flat = |kind| match kind {
        kind::HULL => Solid::hull(
            [
                [1, 1, 1],
                [1, 1, -1],
                [-1, 1, -1],
                [-1, 1, 1],
                [1, -1, 1],
                [1, -1, -1],
                [-1, -1, -1],
                [-1, -1, 1],
            ]
            .map(|c: [i32; 3]| V::from_array(c.map(f64::from)) * 0.4)
            .to_vec(),
        ),
        _ => Solid::new(kind, 0.4, 0.4, 0.4),
    };
    let mut rng = Rng::with_seed(9);
    let flat_kinds = [kind::CYLINDER, kind::BOX, kind::HULL];
    for below in [kind::PLANE, kind::CYLINDER, kind::BOX, kind::HULL] {
        for above in [kind::CYLINDER, kind::CONE, kind::BOX, kind::HULL] {
            for _ in 0..50 {
                let turn = Quat::from_axis_angle(V::new(0.0, 1.0, 0.0), 6.3 * rng.f64());
                let tilt = Quat::from_axis_angle(unit(&mut rng), 1e-4 * rng.f64());
                let height = if below == kind::PLANE { 0.4 } else { 0.8 };
                let upper = Pose::new(V::new(0.1, height, -0.05), tilt * turn);
                let mut pair = Pair {
                    solids: [flat(below), flat(above)],
                    poses: [at(0.0, 0.0, 0.0), upper],
                };
                if below > above {
                    pair = pair.swapped();
                }
                let points = touching(&pair);
                assert!(points >= 3, "{points} points: {pair:#?}");
                // Resting on a box, a box stays on four.
                if flat_kinds.contains(&below) && below != kind::CYLINDER && above == kind::BOX {
                    assert_eq!(points, 4, "{pair:#?}");
                }
            }
        }
    }
}

/// A cylinder on its side touches along a line.
#[test]
fn lines_touch_in_two_points() {
    let s = 0.5f64.sqrt();
    let lying = Quat::new(s, 0.0, 0.0, s);
    for kind in [kind::CAPSULE, kind::CYLINDER] {
        let solid = Solid::new(kind, 0.2, 0.5, 0.0);
        for below in [kind::PLANE, kind::BOX] {
            let height = if below == kind::PLANE { 0.2 } else { 1.2 };
            let under = Solid::new(below, 1.0, 1.0, 1.0);
            let mut pair = Pair {
                solids: [under, solid.clone()],
                poses: [
                    at(0.0, 0.0, 0.0),
                    Pose::new(V::new(0.0, height, 0.0), lying),
                ],
            };
            if below > kind {
                pair = pair.swapped();
            }
            assert_eq!(touching(&pair), 2, "{pair:#?}");
        }
    }
}

/// Exchanged, the normal turns and the points stay.
#[test]
fn a_manifold_seen_from_the_other_side() {
    let pair = Pair::random([kind::BOX, kind::BOX], &mut Rng::with_seed(1));
    let found = kernel::manifold::<f64>(&pair);
    let swapped = found.swapped();
    assert_eq!(swapped.normal, -found.normal);
    for i in 0..4 {
        let (here, there) = (found.contact(i), swapped.contact(i));
        assert_eq!(here.normal, -there.normal);
        assert_eq!(
            (here.position, here.distance, here.feature),
            (there.position, there.distance, there.feature)
        );
    }
    assert_eq!(
        Route::of(kind::BOX, kind::SPHERE),
        Route::of(kind::SPHERE, kind::BOX)
    );
    assert_eq!(
        (
            Route::of(kind::PLANE, kind::PLANE),
            Route::of(kind::BOX, kind::MESH + 1)
        ),
        (None, None)
    );
}
