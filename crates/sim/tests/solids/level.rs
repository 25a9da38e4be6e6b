//! How far in or out of a solid a point is, written anew.

use glam::DVec3;
use model::Geometry;

/// Negative inside a solid, 0 on its surface, and outside no more than the distance times a factor; meshes have none.
pub fn level(geometry: &Geometry, p: DVec3) -> f64 {
    let across = p.x.hypot(p.z);
    match *geometry {
        Geometry::Sphere { radius } => p.length() - radius,
        Geometry::Capsule {
            radius,
            half_height,
        } => {
            let h = half_height - radius;
            (p - p.y.clamp(-h, h) * DVec3::Y).length() - radius
        }
        Geometry::Cylinder {
            radius,
            half_height,
        } => (across - radius).max(p.y.abs() - half_height),
        Geometry::Cone {
            radius,
            half_height: h,
        } => (across - radius * (h - p.y) / (2.0 * h)).max(-h - p.y),
        Geometry::Box { half } => (p.abs() - half).max_element(),
        Geometry::Ellipsoid { half } => (p / half).length() - 1.0,
        Geometry::Hull(ref hull) => {
            let above = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize().dot(p - a);
            hull.faces().map(above).fold(f64::NEG_INFINITY, f64::max)
        }
        Geometry::Plane { .. } | Geometry::Mesh(_) | Geometry::MeshFile { .. } => p.y,
    }
}
