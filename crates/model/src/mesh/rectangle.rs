//! Rectangles: planes that end.

use crate::{HeightFieldError, MeshError, TriangleMesh};
use glam::DVec2;

impl TriangleMesh {
    /// A rectangle in the plane y = 0, of half sizes [m] along x and z: two triangles, without
    /// thickness.
    ///
    /// It is touched from above, as planes and height fields are, and beside it there is nothing: what
    /// rolls off its edge falls. Rays meet both of its sides. A plate to be touched from both is a thin
    /// [box](crate::Geometry::Box).
    ///
    /// # Errors
    /// Half sizes that are not positive, or beyond 1e9 m.
    pub fn rectangle(half_x: f64, half_z: f64) -> Result<Self, MeshError> {
        let flat = [vec![0.0; 2], vec![0.0; 2]];
        let spacing = 2.0 * DVec2::new(half_x, half_z);
        Self::height_field(&flat, spacing).map_err(|error| match error {
            HeightFieldError::Mesh(error) => error,
            _ => MeshError::Rectangle { half_x, half_z },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    #[test]
    fn it_faces_up_and_ends_where_it_is_said_to() {
        let mesh = TriangleMesh::rectangle(2.0, 0.5).unwrap();
        assert_eq!(mesh.triangles().len(), 2);
        assert_eq!(mesh.half_extents(), DVec3::new(2.0, 0.0, 0.5));
        assert!((0..2).all(|t| mesh.normal(t) == DVec3::Y));
    }

    #[test]
    fn what_has_no_size_is_no_rectangle() {
        for (half_x, half_z) in [
            (0.0, 1.0),
            (1.0, -1.0),
            (f64::NAN, 1.0),
            (f64::INFINITY, 1.0),
        ] {
            let refused = TriangleMesh::rectangle(half_x, half_z).unwrap_err();
            assert!(matches!(refused, MeshError::Rectangle { .. }), "{refused}");
        }
        let refused = TriangleMesh::rectangle(2e9, 1.0).unwrap_err();
        assert!(matches!(refused, MeshError::TooFar { .. }), "{refused}");
    }
}
