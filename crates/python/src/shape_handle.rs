//! Shapes of bodies and sceneries in the making.

use kinetarium::model;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// A shape of a builder, in all replicas of its object; made by `Body.shape` and `Object.scenery`.
#[pyclass(frozen, eq, hash, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, PartialEq, Eq, Hash)]
pub struct ShapeHandle {
    pub handle: model::ShapeHandle,
    /// Of what it is, as in `body "ball"`, and its number there.
    pub owner: String,
    pub number: usize,
}

#[pymethods]
impl ShapeHandle {
    fn __copy__(&self) -> Self {
        self.clone()
    }
    fn __deepcopy__(&self, _memo: &Bound<'_, PyDict>) -> Self {
        self.clone()
    }
    fn __repr__(&self) -> String {
        format!("<ShapeHandle {} of {}>", self.number, self.owner)
    }
}
