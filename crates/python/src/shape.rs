//! Shapes: a form, its surface, and where it is.

use crate::count::mask;
use crate::geometry::{self, Geometry, pose};
use crate::material::Material;
use crate::pickled::{Reduced, reduce, restored};
use crate::vector::{vector, vector_or};
use kinetarium::model;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// A solid fixed to a body (or to the world), with its material.
///
/// `position` [m] and `orientation` (x, y, z, w) are in the body's frame; `density` [kg/m³] gives mass to bodies
/// that are given none; `color` is red, green, blue in sRGB and opacity, each 0 to 1; without `collides` it is only
/// seen; a `sensor` touches but never pushes; `membership` and `collides_with` are kinds, a bit each.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Shape(pub model::Shape);

#[pymethods]
impl Shape {
    #[new]
    #[pyo3(signature = (geometry, *, name="", position=None, orientation=None, density=1000.0,
        material=None, color=None, collides=true, sensor=false, membership=1, collides_with=1))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        geometry: Geometry,
        name: &str,
        position: Option<&Bound<'_, PyAny>>,
        orientation: Option<&Bound<'_, PyAny>>,
        density: f64,
        material: Option<Material>,
        color: Option<&Bound<'_, PyAny>>,
        collides: bool,
        sensor: bool,
        membership: i64,
        collides_with: i64,
    ) -> PyResult<Self> {
        let what = format!("shape {name:?}");
        let position = vector_or(&format!("{what}: position"), position, [0.0; 3])?;
        let unturned = [0.0, 0.0, 0.0, 1.0];
        let orientation = vector_or(&format!("{what}: orientation"), orientation, unturned)?;
        let color = color.map(|color| vector(&format!("{what}: color"), color));
        Ok(Self(model::Shape {
            name: name.to_owned(),
            pose: pose(position, geometry::orientation(&what, orientation)?),
            density,
            material: material.map(|m| m.0).unwrap_or_default(),
            color: color.transpose()?,
            collides,
            sensor,
            membership: mask(&what, "membership", membership)?,
            collides_with: mask(&what, "collides_with", collides_with)?,
            ..model::Shape::new(geometry.0)
        }))
    }
    /// Its form.
    #[getter]
    fn geometry(&self) -> Geometry {
        Geometry(self.0.geometry.clone())
    }
    /// Its name; may be empty.
    #[getter]
    fn name(&self) -> &str {
        &self.0.name
    }
    /// Where it is in the body's frame [m].
    #[getter]
    fn position(&self) -> (f64, f64, f64) {
        self.0.pose.position.into()
    }
    /// How it is turned in the body's frame, a quaternion x, y, z, w.
    #[getter]
    fn orientation(&self) -> (f64, f64, f64, f64) {
        self.0.pose.orientation.into()
    }
    /// Density [kg/m³].
    #[getter]
    fn density(&self) -> f64 {
        self.0.density
    }
    /// Its surface.
    #[getter]
    fn material(&self) -> Material {
        Material(self.0.material)
    }
    /// Red, green, blue in sRGB and opacity, each 0 to 1; none: its body's colour.
    #[getter]
    fn color(&self) -> Option<(f32, f32, f32, f32)> {
        self.0.color.map(Into::into)
    }
    /// Whether it takes part in contacts.
    #[getter]
    fn collides(&self) -> bool {
        self.0.collides
    }
    /// Whether it touches but never pushes.
    #[getter]
    fn sensor(&self) -> bool {
        self.0.sensor
    }
    /// Kinds that it is of, a bit each.
    #[getter]
    fn membership(&self) -> u32 {
        self.0.membership
    }
    /// Kinds that it collides with, a bit each.
    #[getter]
    fn collides_with(&self) -> u32 {
        self.0.collides_with
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        let geometry = self.geometry().__repr__();
        format!("Shape({geometry}, name={:?})", self.0.name)
    }
}

/// A shape, or a geometry that stands for a shape of the default material.
pub fn shape(value: &Bound<'_, PyAny>, what: &str) -> PyResult<model::Shape> {
    if let Ok(shape) = value.cast::<Shape>() {
        return Ok(shape.get().0.clone());
    }
    if let Ok(geometry) = value.cast::<Geometry>() {
        return Ok(geometry.get().0.clone().into());
    }
    let message = format!(
        "{what} is of type {}: give a Shape or a Geometry",
        value.get_type().name()?
    );
    Err(PyTypeError::new_err(message))
}

/// Shapes of a body, one or several.
pub fn shapes(value: &Bound<'_, PyAny>, body: &str) -> PyResult<Vec<model::Shape>> {
    let Ok(several) = value.try_iter() else {
        return Ok(vec![shape(value, &format!("shape of {body}"))?]);
    };
    let several = several.enumerate();
    let shapes = several.map(|(i, value)| shape(&value?, &format!("shape {i} of {body}")));
    shapes.collect()
}
