//! Forms of shapes.

use crate::error;
use crate::pickled::{Reduced, reduce, restored};
use crate::vector::{read, vector};
use glam::{DQuat, DVec2, DVec3};
use kinetarium::model::{self, ModelError};
use numpy::{AllowTypeChange, Element, PyArray2, PyArrayLikeDyn, PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// A placement from position [m] and quaternion x, y, z, w.
pub fn pose(position: [f64; 3], orientation: [f64; 4]) -> model::Pose {
    model::Pose::new(DVec3::from_array(position), DQuat::from_array(orientation))
}

/// A quaternion that turns; `what` is of which it is, as in `body "torso"`.
pub fn orientation(what: &str, quaternion: [f64; 4]) -> PyResult<[f64; 4]> {
    if quaternion != [0.0; 4] {
        return Ok(quaternion);
    }
    Err(error::model(ModelError::ZeroLength {
        what: what.to_owned(),
        quantity: "orientation".into(),
        remedy: "give a quaternion x, y, z, w",
    }))
}

/// The direction of a vector of any length; what has none stays, to be refused with the model.
pub fn direction(vector: [f64; 3]) -> DVec3 {
    let vector = DVec3::from_array(vector);
    vector.try_normalize().unwrap_or(vector)
}

/// Rows of three.
fn table<T: Element>(py: Python<'_>, rows: Vec<[T; 3]>) -> PyResult<Bound<'_, PyArray2<T>>> {
    let count = rows.len();
    rows.into_flattened().to_pyarray(py).reshape([count, 3])
}

/// Points [m] that are given as rows.
fn points(what: &str, given: &Bound<'_, PyAny>) -> PyResult<Vec<DVec3>> {
    let rows: Vec<[f64; 3]> = read(what, given, "rows of 3 numbers")?;
    Ok(rows.into_iter().map(DVec3::from_array).collect())
}

/// Triangles that are given as rows of three vertices.
fn triangles(given: &Bound<'_, PyAny>) -> PyResult<Vec<[u32; 3]>> {
    let rows: Vec<[i64; 3]> = read("mesh: triangles", given, "rows of 3 whole numbers")?;
    let row = |(triangle, row): (usize, [i64; 3])| match row.map(u32::try_from) {
        [Ok(a), Ok(b), Ok(c)] => Ok([a, b, c]),
        _ => {
            let why = "give rows of the vertices, counted from 0";
            let message = format!("triangle {triangle} of the mesh is {row:?}: {why}");
            Err(error::value(message))
        }
    };
    rows.into_iter().enumerate().map(row).collect()
}

/// A solid, centred at the origin of its own frame unless it is a hull, or a surface.
///
/// Sizes are half sizes [m]; capsules, cylinders and cones stand along y. Made by its static methods, as in
/// `Geometry.sphere(0.1)`.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Geometry(pub model::Geometry);

#[pymethods]
impl Geometry {
    /// The half space below y = 0 of its frame, drawn as a rectangle; endless where a half size is 0. A plane that ends
    /// is a `rectangle`.
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
    fn r#box(half: &Bound<'_, PyAny>) -> PyResult<Self> {
        let half = DVec3::from_array(vector("box: half", half)?);
        Ok(Self(model::Geometry::Box { half }))
    }
    /// An ellipsoid of three half axes [m].
    #[staticmethod]
    fn ellipsoid(half: &Bound<'_, PyAny>) -> PyResult<Self> {
        let half = DVec3::from_array(vector("ellipsoid: half", half)?);
        Ok(Self(model::Geometry::Ellipsoid { half }))
    }
    /// The convex hull of points [m], an array of the shape (points, 3).
    #[staticmethod]
    fn hull(points: &Bound<'_, PyAny>) -> PyResult<Self> {
        let hull = model::Hull::new(&self::points("hull: points", points)?);
        let hull = hull.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Hull(hull)))
    }
    /// A surface of triangles, touched from its front: vertices [m] (vertices, 3), triangles (triangles, 3)
    /// counter-clockwise as seen from outside. Where it is closed it has the mass of
    /// what it holds.
    #[staticmethod]
    fn mesh(vertices: &Bound<'_, PyAny>, triangles: &Bound<'_, PyAny>) -> PyResult<Self> {
        let vertices = points("mesh: vertices", vertices)?;
        let mesh = model::TriangleMesh::new(&vertices, &self::triangles(triangles)?);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// What a closed profile of points (distance from the y axis, height) [m], counter-clockwise about what is solid,
    /// sweeps as it turns about that axis in `around` steps: a ring, a bowl.
    #[staticmethod]
    #[pyo3(signature = (profile, around = 32))]
    fn revolution(profile: &Bound<'_, PyAny>, around: usize) -> PyResult<Self> {
        let profile: Vec<[f64; 2]> = read("revolution: profile", profile, "rows of 2 numbers")?;
        let profile: Vec<_> = profile.into_iter().map(DVec2::from_array).collect();
        let mesh = model::TriangleMesh::revolution(&profile, around);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// A rectangle in the plane y = 0 of its frame, of half sizes [m], as a mesh of two triangles without thickness. It is
    /// touched from above, and what rolls off its edge falls; rays meet both of its sides. A plate to be touched from both
    /// is a thin box.
    #[staticmethod]
    fn rectangle(half_x: f64, half_z: f64) -> PyResult<Self> {
        let mesh = model::TriangleMesh::rectangle(half_x, half_z);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// A height field, around the origin: heights [m] along y, an array of the shape (along z, along x), `spacing` [m]
    /// apart along x and z, in this order. The first axis is z: `heights[i][j]` stands at x = j · spacing[0] and
    /// z = i · spacing[1], counted from the corner of least x and z.
    #[staticmethod]
    fn height_field(heights: &Bound<'_, PyAny>, spacing: &Bound<'_, PyAny>) -> PyResult<Self> {
        let needs = "rows of numbers, an array of the shape (along z, along x)";
        let heights: Vec<Vec<f64>> = read("height field: heights", heights, needs)?;
        let spacing = DVec2::from_array(vector("height field: spacing", spacing)?);
        let mesh = model::TriangleMesh::height_field(&heights, spacing);
        let mesh = mesh.map_err(|e| error::model(e.into()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }
    /// The surface where signed distances [m] are zero, an array of the shape (along x, along y, along z), negative
    /// inside; the samples are `spacing` [m] apart, around the origin. The first axis is x, other than that of a
    /// height field.
    #[staticmethod]
    fn distance_field(
        distances: PyArrayLikeDyn<'_, f64, AllowTypeChange>,
        spacing: f64,
    ) -> PyResult<Self> {
        let distances = distances.as_array();
        let &[x, y, z] = distances.shape() else {
            let message = format!(
                "the distances have the shape {:?}; give an array of three axes, along x, y and z",
                distances.shape()
            );
            return Err(error::raise("ShapeError", message));
        };
        // The engine has x running fastest.
        let samples: Vec<f64> = distances.t().iter().copied().collect();
        let mesh = model::TriangleMesh::distance_field([x, y, z], spacing, &samples);
        let mesh = mesh.map_err(|e| error::value(e.to_string()))?;
        Ok(Self(model::Geometry::Mesh(mesh)))
    }

    /// The convex hull of a mesh: what was hollow is filled.
    fn convex_hull(&self) -> PyResult<Self> {
        let hull = match &self.0 {
            model::Geometry::Mesh(mesh) => mesh
                .convex_hull()
                .map_err(|e| error::model(ModelError::Hull(e)))?,
            model::Geometry::Hull(hull) => hull.clone(),
            _ => {
                let message = format!("a {} has no vertices; give a mesh or a hull", self.kind());
                return Err(error::value(message));
            }
        };
        Ok(Self(model::Geometry::Hull(hull)))
    }

    /// What it is, by the name of the method that makes it, such as "sphere"; "mesh" for all surfaces of triangles.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0 {
            model::Geometry::Plane { .. } => "plane",
            model::Geometry::Sphere { .. } => "sphere",
            model::Geometry::Capsule { .. } => "capsule",
            model::Geometry::Cylinder { .. } => "cylinder",
            model::Geometry::Cone { .. } => "cone",
            model::Geometry::Box { .. } => "box",
            model::Geometry::Ellipsoid { .. } => "ellipsoid",
            model::Geometry::Hull(_) => "hull",
            model::Geometry::Mesh(_) => "mesh",
            model::Geometry::MeshFile { .. } => "mesh file",
        }
    }
    /// Middle of boxes about it [m]: the origin, but of a hull a point inside, and of a mesh the middle of its corners.
    #[getter]
    fn center(&self) -> (f64, f64, f64) {
        self.0.center().into()
    }
    /// Half of the box about `center` that holds it, along its own axes [m]; none for a plane, which has no end.
    #[getter]
    fn half_extents(&self) -> Option<(f64, f64, f64)> {
        self.0.half_extents().map(Into::into)
    }
    /// Corners of a hull or mesh [m], shape (corners, 3); of others there are none.
    #[getter]
    fn vertices<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let vertices = match &self.0 {
            model::Geometry::Hull(hull) => hull.vertices(),
            model::Geometry::Mesh(mesh) => mesh.vertices(),
            _ => &[],
        };
        table(py, vertices.iter().map(DVec3::to_array).collect())
    }
    /// Triangles of a hull or mesh, as rows of `vertices`, counter-clockwise as seen from outside, shape
    /// (triangles, 3); of others there are none.
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        let triangles = match &self.0 {
            model::Geometry::Hull(hull) => hull.triangles(),
            model::Geometry::Mesh(mesh) => mesh.triangles(),
            _ => &[],
        };
        table(py, triangles.to_vec())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    pub fn __repr__(&self) -> String {
        let sizes = match &self.0 {
            model::Geometry::Plane { half_x, half_z } => {
                format!("half_x={half_x:?}, half_z={half_z:?}")
            }
            model::Geometry::Sphere { radius } => format!("{radius:?}"),
            model::Geometry::Capsule {
                radius,
                half_height,
            }
            | model::Geometry::Cylinder {
                radius,
                half_height,
            }
            | model::Geometry::Cone {
                radius,
                half_height,
            } => format!("radius={radius:?}, half_height={half_height:?}"),
            model::Geometry::Box { half } | model::Geometry::Ellipsoid { half } => {
                format!("({:?}, {:?}, {:?})", half.x, half.y, half.z)
            }
            model::Geometry::Hull(hull) => format!("<{} corners>", hull.vertices().len()),
            model::Geometry::Mesh(mesh) => format!("<{} triangles>", mesh.triangles().len()),
            model::Geometry::MeshFile { file, .. } => format!("{file:?}"),
        };
        format!("Geometry.{}({sizes})", self.kind())
    }
}
