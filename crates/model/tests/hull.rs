//! Convex hulls: closed, convex, holding their points; and points that have none.

use glam::{DQuat, DVec3};
use kinetarium_model::{Hull, HullError};
use proptest::prelude::*;
use std::collections::HashSet;

/// Whether a surface is closed: each edge once in either direction; and Euler's V − E + F = 2.
fn assert_closed(hull: &Hull) {
    let edges: HashSet<_> = hull
        .triangles()
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .collect();
    let (v, f) = (hull.vertices().len(), hull.triangles().len());
    assert_eq!(edges.len(), 3 * f);
    assert!(edges.iter().all(|&[a, b]| edges.contains(&[b, a])));
    assert_eq!(v + f, 3 * f / 2 + 2);
}

/// How far points are outside of a hull.
fn outside(hull: &Hull, points: &[DVec3]) -> f64 {
    let mut most: f64 = 0.0;
    for [a, b, c] in hull.faces() {
        let n = (b - a).cross(c - a).normalize();
        most = points.iter().fold(most, |m, p| m.max(n.dot(*p - a)));
    }
    most
}

fn points(n: std::ops::Range<usize>) -> impl Strategy<Value = Vec<DVec3>> {
    let number = || -1.0..1.0;
    prop::collection::vec((number(), number(), number()).prop_map(DVec3::from), n)
}

proptest! {
    /// Corners are points, and points are inside, but for the millionth of their extent within which
    /// they are left out.
    #[test]
    fn hulls_hold_their_points(points in points(4..200)) {
        let hull = Hull::new(&points).unwrap();
        assert_closed(&hull);
        prop_assert!(hull.vertices().iter().all(|v| points.contains(v)));
        prop_assert!(outside(&hull, &points) < 4e-6);
        prop_assert!(outside(&hull, &[hull.center()]) == 0.0);
        let (half, radius) = (hull.half_extents(), hull.radius());
        for arm in hull.arms() {
            prop_assert!(arm.abs().cmple(half).all() && arm.length() <= radius);
        }
    }

    /// Of points on a grid, many in one plane or on one line.
    #[test]
    fn coplanar_points_make_closed_hulls(
        points in prop::collection::vec((0_u8..4, 0_u8..4, 0_u8..4), 4..60),
    ) {
        let at = |&(x, y, z): &(u8, u8, u8)| DVec3::new(x.into(), y.into(), z.into());
        let points: Vec<_> = points.iter().map(at).collect();
        if let Ok(hull) = Hull::new(&points) {
            assert_closed(&hull);
            prop_assert!(outside(&hull, &points) < 1e-12);
        }
    }
}

/// A box of 9³ points, turned, has eight corners, though its points are in its faces within
/// rounding only, and within that of single precision.
#[test]
fn flat_faces_have_no_corners() {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.3, -1.1, 0.4));
    let at = |i: u32| turn * DVec3::new((i % 9).into(), (i / 9 % 9).into(), (i / 81).into());
    let exact: Vec<_> = (0..729).map(at).collect();
    let single: Vec<_> = exact.iter().map(|p| p.as_vec3().as_dvec3()).collect();
    for points in [exact, single] {
        let hull = Hull::new(&points).unwrap();
        assert_closed(&hull);
        assert_eq!(hull.vertices().len(), 8);
    }
}

/// The corners of a regular solid are all of its hull; those of a fine sphere, too, up to the most
/// that are taken.
#[test]
fn round_hulls_keep_their_corners() {
    let sphere = |n: u32| -> Vec<_> {
        // Fibonacci's lattice.
        let at = |i: u32| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(n);
            let (sine, cosine) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
            let radius = (1.0 - z * z).sqrt();
            DVec3::new(radius * cosine, radius * sine, z)
        };
        (0..n).map(at).collect()
    };
    let hull = Hull::new(&sphere(4000)).unwrap();
    assert_closed(&hull);
    assert_eq!(hull.vertices().len(), 4000);
    let (corners, most) = (5000, 4096);
    assert_eq!(
        Hull::new(&sphere(5000)),
        Err(HullError::TooManyCorners { corners, most })
    );
}

#[test]
fn points_without_a_hull() {
    let square = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X + DVec3::Y];
    let flat = Hull::new(&square).unwrap_err();
    assert!(matches!(flat, HullError::Flat { points: 4, .. }), "{flat}");
    let line: Vec<_> = (0..5).map(|i| DVec3::X * f64::from(i)).collect();
    assert!(matches!(Hull::new(&line), Err(HullError::Flat { .. })));
    let few = Hull::new(&[DVec3::ZERO, DVec3::X, DVec3::ZERO]);
    assert_eq!(few, Err(HullError::TooFew { points: 2 }));
    assert_eq!(Hull::new(&[]), Err(HullError::TooFew { points: 0 }));
    let endless = Hull::new(&[DVec3::ZERO, DVec3::X, DVec3::INFINITY]);
    assert!(matches!(
        endless,
        Err(HullError::NotFinite { point: 2, .. })
    ));
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    for scale in [1e-12, 1e-300, 1e12, 1e300] {
        let extent = Hull::new(&corners.map(|p| p * scale)).unwrap_err();
        assert!(matches!(extent, HullError::Extent { .. }), "{extent}");
    }
    for scale in [1e-8, 1e8] {
        let hull = Hull::new(&corners.map(|p| p * scale)).unwrap();
        assert_eq!(hull.vertices().len(), 4);
    }
}
