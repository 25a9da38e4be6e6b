//! Shapes and their surfaces.

use crate::error;
use glam::{DQuat, DVec2, DVec3};
use kinetarium::model;
use pyo3::prelude::*;

/// A placement from position [m] and quaternion x, y, z, w.
pub fn pose(position: [f64; 3], orientation: [f64; 4]) -> model::Pose {
    model::Pose::new(DVec3::from_array(position), DQuat::from_array(orientation))
}

fn points(vertices: Vec<[f64; 3]>) -> Vec<DVec3> {
    vertices.into_iter().map(DVec3::from_array).collect()
}

/// A solid, centred at the origin of its own frame unless it is a hull, or a surface.
///
/// Sizes are half sizes [m]; capsules, cylinders and cones stand along y. Made by its static methods, as in
/// `Geometry.sphere(0.1)`.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry(pub model::Geometry);

#[pymethods]
impl Geometry {
    /// The half space below y = 0 of its frame, drawn as a rectangle; endless where a half size is 0.
    #[staticmethod]
    #[pyo3(signature = (half_x=0.0, half_z=0.0))]
    fn plane(half_x: f64, half_z: f64) -> Self {
        Self(model::Geometry::Plane { half_x, half_z })
    }
    /// A ball of a radius [m].
    #[staticmethod]
    fn sphere(radius: f64) -> Self {
        Self(model::Geometry::Sphere { radius })
    }
    /// A cylinder with round caps, along y; the half height [m] includes the caps and is at least 1.01 radii.
    #[staticmethod]
    fn capsule(radius: f64, half_height: f64) -> Self {
        Self(model::Geometry::Capsule {
            radius,
            half_height,
        })
    }
    /// A cylinder along y.
    #[staticmethod]
    fn cylinder(radius: f64, half_height: f64) -> Self {
        Self(model::Geometry::Cylinder {
            radius,
            half_height,
        })
    }
    /// A cone along y, its base at −half_height.
    #[staticmethod]
    fn cone(radius: f64, half_height: f64) -> Self {
        Self(model::Geometry::Cone {
            radius,
            half_height,
        })
    }
    /// A cuboid of three half extents [m].
    #[staticmethod]
    fn r#box(half: [f64; 3]) -> Self {
        let half = DVec3::from_array(half);
        Self(model::Geometry::Box { half })
    }
    /// An ellipsoid of three half axes [m].
    #[staticmethod]
    fn ellipsoid(half: [f64; 3]) -> Self {
        let half = DVec3::from_array(half);
        Self(model::Geometry::Ellipsoid { half })
    }
    /// The convex hull of points [m], an array of the shape (points, 3).
    #[staticmethod]
    fn hull(points: Vec<[f64; 3]>) -> PyResult<Self> {
        let hull = model::Hull::new(&self::points(points));
        let hull = hull.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Hull(hull)))
    }
    /// A surface of triangles, touched from its front: vertices [m] (vertices, 3), triangles (triangles, 3)
    /// counter-clockwise as seen from outside. Where it is closed it has the mass of
    /// what it holds.
    #[staticmethod]
    fn mesh(vertices: Vec<[f64; 3]>, triangles: Vec<[u32; 3]>) -> PyResult<Self> {
        let mesh = model::TriangleMesh::new(&points(vertices), &triangles);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// What a closed profile of points (distance from the y axis, height) [m], counter-clockwise about what is solid,
    /// sweeps as it turns about that axis in `around` steps: a ring, a bowl.
    #[staticmethod]
    #[pyo3(signature = (profile, around = 32))]
    fn revolution(profile: Vec<[f64; 2]>, around: usize) -> PyResult<Self> {
        let profile: Vec<_> = profile.into_iter().map(DVec2::from_array).collect();
        let mesh = model::TriangleMesh::revolution(&profile, around);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// A height field: heights [m] as rows along x of columns along z, `spacing` [m] apart along x and z.
    #[staticmethod]
    fn height_field(heights: Vec<Vec<f64>>, spacing: [f64; 2]) -> PyResult<Self> {
        let mesh = model::TriangleMesh::height_field(&heights, DVec2::from_array(spacing));
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    fn __repr__(&self) -> String {
        match &self.0 {
            model::Geometry::Hull(hull) => format!("Geometry(Hull of {})", hull.vertices().len()),
            model::Geometry::Mesh(mesh) => format!("Geometry(Mesh of {})", mesh.triangles().len()),
            other => format!("Geometry({other:?})"),
        }
    }
}

/// Resistance of a surface to being pressed in, at each point of contact.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Softness(model::Softness);

#[pymethods]
impl Softness {
    /// What brings the touching masses to rest in a time constant [s] with a damping ratio; `impedance`,
    /// from 0 to below 1, is the share of a load that an added mass takes.
    #[staticmethod]
    #[pyo3(signature = (constant=0.002, ratio=1.0, impedance=0.0))]
    fn time(constant: f64, ratio: f64, impedance: f64) -> Self {
        Self(model::Softness::Time {
            constant,
            ratio,
            impedance,
        })
    }
    /// Stiffness [N/m] and damping [N·s/m].
    #[staticmethod]
    fn spring(stiffness: f64, damping: f64) -> Self {
        Self(model::Softness::Spring { stiffness, damping })
    }
    fn __repr__(&self) -> String {
        format!("Softness({:?})", self.0)
    }
}

/// Surface of a shape.
///
/// `torsional_friction` and `rolling_friction` are lengths [m]; `margin` [m] is the distance from the surface at
/// which contact begins; `combine` tells how coefficients of two surfaces become one: "average", "minimum",
/// "multiply" or "maximum", of which the later holds.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Material(pub model::Material);

#[pymethods]
impl Material {
    #[new]
    #[pyo3(signature = (friction=0.5, *, torsional_friction=0.0, rolling_friction=0.0, restitution=0.0,
        softness=None, margin=0.0, combine="average"))]
    fn new(
        friction: f64,
        torsional_friction: f64,
        rolling_friction: f64,
        restitution: f64,
        softness: Option<Softness>,
        margin: f64,
        combine: &str,
    ) -> PyResult<Self> {
        let combine = match combine {
            "average" => model::Combine::Average,
            "minimum" => model::Combine::Minimum,
            "multiply" => model::Combine::Multiply,
            "maximum" => model::Combine::Maximum,
            other => {
                let known = "known are average, minimum, multiply, maximum";
                return Err(error::value(format!("unknown rule \"{other}\"; {known}")));
            }
        };
        Ok(Self(model::Material {
            friction,
            torsional_friction,
            rolling_friction,
            restitution,
            softness: softness.map(|s| s.0).unwrap_or_default(),
            margin,
            combine,
        }))
    }
    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}

/// A solid fixed to a body (or to the world), with its material.
///
/// `position` [m] and `orientation` (x, y, z, w) are in the body's frame; `density` [kg/m³] gives mass to bodies
/// that are given none; `color` is red, green, blue in sRGB and opacity, each 0 to 1; without `collides` it is only
/// seen; a `sensor` touches but never pushes; `membership` and `collides_with` are kinds, a bit each.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Shape(pub model::Shape);

#[pymethods]
impl Shape {
    #[new]
    #[pyo3(signature = (geometry, *, name="", position=[0.0; 3], orientation=[0.0, 0.0, 0.0, 1.0],
        density=1000.0, material=None, color=None, collides=true, sensor=false, membership=1, collides_with=1))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        geometry: Geometry,
        name: &str,
        position: [f64; 3],
        orientation: [f64; 4],
        density: f64,
        material: Option<Material>,
        color: Option<[f32; 4]>,
        collides: bool,
        sensor: bool,
        membership: u32,
        collides_with: u32,
    ) -> Self {
        Self(model::Shape {
            name: name.to_owned(),
            pose: pose(position, orientation),
            density,
            material: material.map(|m| m.0).unwrap_or_default(),
            color,
            collides,
            sensor,
            membership,
            collides_with,
            ..model::Shape::new(geometry.0)
        })
    }
    fn __repr__(&self) -> String {
        format!(
            "Shape({}, name={:?})",
            Geometry(self.0.geometry.clone()).__repr__(),
            self.0.name
        )
    }
}

/// A shape, or a geometry that stands for a shape of the default material.
#[derive(FromPyObject)]
#[expect(clippy::large_enum_variant, reason = "an argument, unpacked at once")]
pub enum AnyShape {
    Shape(Shape),
    Geometry(Geometry),
}

impl From<AnyShape> for model::Shape {
    fn from(shape: AnyShape) -> Self {
        match shape {
            AnyShape::Shape(shape) => shape.0,
            AnyShape::Geometry(geometry) => geometry.0.into(),
        }
    }
}
