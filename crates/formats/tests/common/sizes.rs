//! Sizes of solids.

use glam::DVec3;
use model::Geometry;

/// As MuJoCo has them.
pub fn sizes(geometry: &Geometry) -> DVec3 {
    match *geometry {
        Geometry::Sphere { radius } => DVec3::new(radius, 0.0, 0.0),
        Geometry::Capsule {
            radius,
            half_height,
        } => DVec3::new(radius, half_height - radius, 0.0),
        Geometry::Cylinder {
            radius,
            half_height,
        } => DVec3::new(radius, half_height, 0.0),
        Geometry::Box { half } | Geometry::Ellipsoid { half } => half,
        ref other => panic!("{other:?}"),
    }
}
