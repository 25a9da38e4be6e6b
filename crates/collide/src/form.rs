//! A model's geometry as kernels know it.

use crate::kind;
use glam::DVec3;
use model::{Geometry, Pose};

/// Kind and size of a shape, and where its frame is in the geometry's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Form {
    /// One of [`kind`].
    pub kind: usize,
    /// Half sizes [m], as the kind has them.
    pub size: DVec3,
    /// The kernels' frame in the geometry's.
    pub pose: Pose,
}

impl Form {
    /// The form of a geometry. A plane is a half space, however large it is drawn; the kernels' vertices
    /// of a hull are its [arms](model::Hull::arms), and a mesh lies about its
    /// [middle](model::TriangleMesh::center).
    ///
    /// `None` for the file of a mesh: it takes reading, and a choice between its
    /// [surface](crate::mesh), its [hull](model::Hull) and its convex pieces.
    pub fn of(geometry: &Geometry) -> Option<Self> {
        let (kind, size) = match *geometry {
            Geometry::Plane { .. } => (kind::PLANE, DVec3::ZERO),
            Geometry::Sphere { radius } => (kind::SPHERE, DVec3::splat(radius)),
            Geometry::Capsule {
                radius,
                half_height,
            } => (kind::CAPSULE, round(radius, half_height)),
            Geometry::Cylinder {
                radius,
                half_height,
            } => (kind::CYLINDER, round(radius, half_height)),
            Geometry::Cone {
                radius,
                half_height,
            } => (kind::CONE, round(radius, half_height)),
            Geometry::Box { half } => (kind::BOX, half),
            Geometry::Ellipsoid { half } => (kind::ELLIPSOID, half),
            Geometry::Hull(ref hull) => (kind::HULL, hull.half_extents()),
            Geometry::Mesh(ref mesh) => (kind::MESH, mesh.half_extents()),
            Geometry::MeshFile { .. } => return None,
        };
        Some(Self {
            kind,
            size,
            pose: Pose::at(geometry.center()),
        })
    }

    /// A rectangle in the plane y = 0 with these half sizes [m], solid below to a depth of the larger
    /// of them: what lies beside it does not touch it.
    pub fn finite_plane(half_x: f64, half_z: f64) -> Self {
        let depth = half_x.max(half_z);
        Self {
            kind: kind::BOX,
            size: DVec3::new(half_x, 0.5 * depth, half_z),
            pose: Pose::at(DVec3::new(0.0, -0.5 * depth, 0.0)),
        }
    }
}

fn round(radius: f64, half_height: f64) -> DVec3 {
    DVec3::new(radius, half_height, radius)
}
