//! Shapes: what a body looks and collides like.

use crate::{BodyId, Hull, Material, Pose, TriangleMesh, default_color};
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// Row of a shape in [`Parts::shapes`](crate::Parts::shapes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct ShapeId(pub usize);

/// A solid, centred at the origin of its own frame unless it is a hull, or a surface. Sizes are half
/// sizes [m].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Geometry {
    /// The half space below y = 0 of the shape's frame, however large it is drawn: as a rectangle,
    /// endless where `half_x` and `half_z` are zero. A plane that ends is a
    /// [rectangle](TriangleMesh::rectangle).
    Plane {
        /// Half size along x; 0 is endless.
        half_x: f64,
        /// Half size along z; 0 is endless.
        half_z: f64,
    },
    /// A ball.
    Sphere {
        /// Radius.
        radius: f64,
    },
    /// A cylinder with round caps, along y.
    Capsule {
        /// Radius.
        radius: f64,
        /// Half of the whole height, caps included; at least 1.01 radii.
        half_height: f64,
    },
    /// A cylinder along y.
    Cylinder {
        /// Radius.
        radius: f64,
        /// Half height.
        half_height: f64,
    },
    /// A cone along y, its base at −half_height, its apex at +half_height.
    Cone {
        /// Radius of the base.
        radius: f64,
        /// Half height.
        half_height: f64,
    },
    /// A cuboid.
    Box {
        /// Half extents.
        half: DVec3,
    },
    /// An ellipsoid.
    Ellipsoid {
        /// Half axes.
        half: DVec3,
    },
    /// The convex hull of points.
    Hull(Hull),
    /// A surface of triangles, touched from its front. It has the mass of what it holds if it is closed,
    /// and else none. A [height field](TriangleMesh::height_field) is one, and so is a plane that ends, a
    /// [rectangle](TriangleMesh::rectangle).
    Mesh(TriangleMesh),
    /// A triangle mesh, named by its file and only seen; read by those who draw it.
    MeshFile {
        /// Path as the model file gives it, resolved against that file's folder.
        file: String,
        /// Scale along each axis.
        scale: DVec3,
    },
}

impl Geometry {
    /// Middle of the boxes and balls about it [m]: the origin of its frame but for a hull, of which it
    /// is the [centre](Hull::center), which is inside, and a mesh, of whose box it is the
    /// [middle](TriangleMesh::center).
    pub fn center(&self) -> DVec3 {
        match self {
            Self::Hull(hull) => hull.center(),
            Self::Mesh(mesh) => mesh.center(),
            _ => DVec3::ZERO,
        }
    }
    /// Half of the box about its [centre](Self::center) that holds it, along its own axes [m]; `None`
    /// for a plane, which has no end, and for the file of a mesh, which is not read here.
    pub fn half_extents(&self) -> Option<DVec3> {
        Some(match *self {
            Self::Plane { .. } | Self::MeshFile { .. } => return None,
            Self::Sphere { radius } => DVec3::splat(radius),
            Self::Capsule {
                radius,
                half_height,
            }
            | Self::Cylinder {
                radius,
                half_height,
            }
            | Self::Cone {
                radius,
                half_height,
            } => DVec3::new(radius, half_height, radius),
            Self::Box { half } | Self::Ellipsoid { half } => half,
            Self::Hull(ref hull) => hull.half_extents(),
            Self::Mesh(ref mesh) => mesh.half_extents(),
        })
    }
}

/// A solid fixed to a body (or to the world), with its material.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape {
    /// Name; may be empty.
    pub name: String,
    /// Owner; `None` is the world.
    pub body: Option<BodyId>,
    /// Form.
    pub geometry: Geometry,
    /// Placement in the body's frame.
    pub pose: Pose,
    /// Density [kg/m³], for those who derive a body's mass from its shapes.
    pub density: f64,
    /// Surface.
    pub material: Material,
    /// Colour in sRGB and opacity, each 0 to 1; only seen. Of opacity 0 it is not seen at all. `None` is
    /// the [default colour](crate::default_color) of its body.
    pub color: Option<[f32; 4]>,
    /// True: takes part in contacts. False: only seen.
    pub collides: bool,
    /// True: where it collides, it touches but never pushes. False: solid.
    pub sensor: bool,
    /// Kinds the shape is of, a bit each; 1 by default.
    pub membership: u32,
    /// Kinds the shape collides with; one shape's wish is enough. 1 by default.
    pub collides_with: u32,
}

impl Shape {
    /// A colliding solid of 1000 kg/m³ with the default material, at its body's origin.
    pub fn new(geometry: Geometry) -> Self {
        Self {
            name: String::new(),
            body: None,
            geometry,
            pose: Pose::IDENTITY,
            density: 1000.0,
            material: Material::default(),
            color: None,
            collides: true,
            sensor: false,
            membership: 1,
            collides_with: 1,
        }
    }
    /// The same, with a name.
    pub fn named(self, name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            ..self
        }
    }
    /// The same, elsewhere in its body's frame.
    pub fn at(self, pose: Pose) -> Self {
        Self { pose, ..self }
    }
    /// The same, of another density [kg/m³].
    pub fn with_density(self, density: f64) -> Self {
        Self { density, ..self }
    }
    /// The same, of another material.
    pub fn with_material(self, material: Material) -> Self {
        Self { material, ..self }
    }
    /// The same, of a colour: red, green, blue in sRGB and opacity, each 0 to 1.
    pub fn with_color(self, color: [f32; 4]) -> Self {
        let color = Some(color);
        Self { color, ..self }
    }
    /// Colour in sRGB and opacity that it is drawn with: its own, or else its body's default.
    pub fn drawn_color(&self) -> [f32; 4] {
        self.color.unwrap_or_else(|| default_color(self.body))
    }
    /// The same, of other kinds, and colliding with other kinds; a bit each.
    pub fn with_masks(self, membership: u32, collides_with: u32) -> Self {
        Self {
            membership,
            collides_with,
            ..self
        }
    }
    /// The same, only seen.
    pub fn without_contact(self) -> Self {
        Self {
            collides: false,
            ..self
        }
    }
    /// The same, touching but never pushing. It weighs what a solid would: see
    /// [`with_density`](Shape::with_density).
    pub fn as_sensor(self) -> Self {
        Self {
            sensor: true,
            ..self
        }
    }
}

impl From<Geometry> for Shape {
    fn from(geometry: Geometry) -> Self {
        Self::new(geometry)
    }
}
