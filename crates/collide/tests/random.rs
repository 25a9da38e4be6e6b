//! Ten thousand random poses of every pair against an independent reference.

mod common;

use common::reference::{best_gap, gap, outside};
use common::{Pair, kernel, unit};
use fastrand::Rng;
use kinetarium_collide::{FAR, FLAT, Manifold, Route, kind};
use numbers::Float;

/// Depth, against the smaller solid, from which a way out need not be the shortest.
const DEEP: f64 = 0.1;
/// Depth, against the sum of the sizes, up to which the first way out is taken.
const SHALLOW: f64 = 0.005;

/// Every pair of kinds that can touch, the lower kind first.
fn pairs() -> impl Iterator<Item = [usize; 2]> {
    (0..kind::CONVEX)
        .flat_map(|a| (a..kind::CONVEX).map(move |b| [a, b]))
        .filter(|[a, b]| Route::of(*a, *b).is_some())
}

/// What a check of a contact says.
enum Verdict {
    Right,
    /// Right along its normal, but deep overlap has a shorter way out.
    Local,
    Wrong(String),
}

/// Checks a contact; the tolerance is relative to the scene's size.
fn check(pair: &Pair, found: &Manifold<f64>, tolerance: f64) -> Verdict {
    let slack = tolerance * pair.scale();
    let n = found.normal;
    let off = (n.length() - 1.0).abs();
    if off.is_nan() || off > 10.0 * tolerance {
        return Verdict::Wrong(format!("the normal {n:?} is not of unit length"));
    }
    // What lies within `FLAT` of a plane is taken as lying in it.
    let flat = FLAT * pair.solids[0].reach().max(pair.solids[1].reach());
    let (distance, along, most) = (found.distance(), gap(pair, n), best_gap(pair));
    if !(along - slack..=along + slack + flat).contains(&distance) {
        return Verdict::Wrong(format!("{distance} is not {along}, the gap along {n:?}"));
    }
    let off = off_the_surfaces(pair, found);
    // The search may end before a deep overlap's normal is at a right angle to both surfaces.
    if off.is_nan() || off > slack + flat + 0.05 * (-along).max(0.0) {
        return Verdict::Wrong(format!("a point is {off} off a surface"));
    }
    let route = Route::of(pair.solids[0].kind, pair.solids[1].kind).expect("a route");
    let points = found.points.iter().filter(|p| p.distance < FAR).count();
    if !(1..=route.points()).contains(&points) {
        return Verdict::Wrong(format!("{points} points by {route:?}"));
    }
    let smaller = pair.solids[0].reach().min(pair.solids[1].reach());
    let sizes = pair.solids[0].size.length() + pair.solids[1].size.length();
    if along >= most - slack {
        Verdict::Right
    } else if most < -DEEP * smaller || along.abs() < SHALLOW * sizes {
        Verdict::Local
    } else {
        Verdict::Wrong(format!("{along} where another normal has {most}"))
    }
}

/// How far a point's ends, half its distance to each side, are outside of the solids at most.
fn off_the_surfaces(pair: &Pair, found: &Manifold<f64>) -> f64 {
    let touching = found.points.iter().filter(|p| p.distance < 0.0);
    let off = touching.flat_map(|point| {
        let half = found.normal * (0.5 * point.distance);
        [point.position - half, point.position + half]
            .into_iter()
            .zip([0, 1])
            .map(|(end, i)| outside(&pair.solids[i], pair.poses[i], end))
    });
    off.fold(0.0, |most, x| if x <= most { most } else { x })
}

/// Checks random poses of a pair, of which one in a hundred may be out of a deep overlap the long way.
fn check_poses<T: Float>(kinds: [usize; 2], tolerance: f64, poses: usize) {
    let mut rng = Rng::with_seed(7);
    let mut local = 0;
    for _ in 0..poses {
        let pair = Pair::random(kinds, &mut rng);
        let found = kernel::manifold::<T>(&pair);
        match check(&pair, &found, tolerance) {
            Verdict::Right => {}
            Verdict::Local => local += 1,
            Verdict::Wrong(what) => panic!("{what}: {pair:#?} gave {found:#?}"),
        }
    }
    let most = if T::DOUBLE { 50 } else { 100 };
    assert!(local * most <= poses, "{kinds:?}: {local} of {poses}");
}

/// Every second pair of kinds, from the first or the second on, so that two tests share them.
fn check_every_second<T: Float>(first: usize, tolerance: f64) {
    // What is found is the same search in both; single precision has the harder time.
    let poses = if T::DOUBLE { 2500 } else { 10_000 };
    for kinds in pairs().skip(first).step_by(2) {
        check_poses::<T>(kinds, tolerance, poses);
    }
}

#[test]
fn in_f32_even_kinds() {
    check_every_second::<f32>(0, 1e-5);
}

#[test]
fn in_f32_odd_kinds() {
    check_every_second::<f32>(1, 1e-5);
}

#[test]
fn in_f64_even_kinds() {
    check_every_second::<f64>(0, 1e-7);
}

#[test]
fn in_f64_odd_kinds() {
    check_every_second::<f64>(1, 1e-7);
}

/// Two solids that are looked for step after step: from a direction that is not far from the best, the contact found
/// is right along its own normal and no deeper, and they are never said to be farther apart than they are.
#[test]
fn from_a_known_direction_it_gets_no_deeper() {
    let searched =
        |[a, b]: &[usize; 2]| *a != kind::PLANE && Route::of(*a, *b) >= Some(Route::SphereConvex);
    for kinds in pairs().filter(searched) {
        let mut rng = Rng::with_seed(11);
        for _ in 0..1000 {
            let pair = Pair::random(kinds, &mut rng);
            let normal = kernel::manifold::<f64>(&pair).normal;
            let known = (normal + unit(&mut rng) * 0.1).normalized_or(normal);
            let (found, least) = kernel::manifold_along::<f32>(&pair, known);
            let slack = 1e-5 * pair.scale();
            let (distance, before) = (found.distance(), gap(&pair, known));
            assert!(
                distance >= before - slack,
                "{distance} < {before}: {pair:#?}"
            );
            assert!(
                (before - slack..=distance + slack).contains(&least),
                "{least}: {pair:#?}"
            );
            if let Verdict::Wrong(what) = check(&pair, &found, 1e-5)
                && !what.contains("another normal")
            {
                panic!("{what}: {pair:#?} gave {found:#?}");
            }
        }
    }
}
