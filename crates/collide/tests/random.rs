//! Ten thousand random poses of every pair against an independent reference.

mod common;

use common::reference::{distance, gap, outside};
use common::{Pair, kernel};
use fastrand::Rng;
use kinetarium_collide::{FLAT, Manifold, Route, kind};
use numbers::Float;

const POSES: usize = 10_000;

/// Every pair of kinds that can touch, the lower kind first.
fn pairs() -> impl Iterator<Item = [usize; 2]> {
    (0..kind::CONVEX)
        .flat_map(|a| (a..kind::CONVEX).map(move |b| [a, b]))
        .filter(|[a, b]| Route::of(*a, *b).is_some())
}

/// Checks one contact; `tolerance` is relative to the scene's size.
fn check(pair: &Pair, found: &Manifold<f64>, tolerance: f64) {
    let slack = tolerance * pair.scale();
    let n = found.normal;
    assert!((n.length() - 1.0).abs() < 10.0 * tolerance, "{n:?}");

    // The distance is the gap along the normal, and no other normal has a larger one.
    let reported = found.distance();
    // Points on a rim are at fixed places while it stands within `FLAT`.
    let rim = FLAT * (1.0 - 0.5f64.sqrt()) * pair.solids[1].reach();
    let true_gap = gap(pair, n);
    let least = true_gap - slack..=true_gap + slack + rim;
    assert!(least.contains(&reported), "{reported} is not {true_gap}");
    let best = distance(pair);
    assert!(reported > best - slack, "{reported} where {best} was found");

    // Every point lies on both surfaces, half its distance to each side.
    for point in found.points.iter().filter(|p| p.distance < 0.0) {
        let half = n * (0.5 * point.distance);
        let ends = [point.position - half, point.position + half];
        for (i, end) in ends.into_iter().enumerate() {
            let off = outside(&pair.solids[i], pair.poses[i], end);
            assert!(off < slack + rim, "{off} off the solid {i}");
        }
    }
}

fn all<T: Float>(tolerance: f64) {
    for kinds in pairs() {
        let mut rng = Rng::with_seed(7);
        for _ in 0..POSES {
            let pair = Pair::random(kinds, &mut rng);
            let found = kernel::manifold::<T>(&pair);
            let checked = std::panic::catch_unwind(|| check(&pair, &found, tolerance));
            assert!(checked.is_ok(), "{pair:#?} gave {found:#?}");
        }
    }
}

#[test]
fn in_f32() {
    all::<f32>(3e-6);
}

#[test]
fn in_f64() {
    all::<f64>(1e-8);
}
