//! Dynamics of trees as functions of their state, as `kinetarium.Dynamics` uses them.

use crate::error;
use crate::model::Model;
use crate::simulation::slice;
use glam::DVec3;
use kinetarium::model::BodyId;
use kinetarium::rigid::{self, DynamicsError};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

type Rows<'py> = PyReadonlyArray2<'py, f64>;
type Found<'py> = PyResult<Bound<'py, PyArray1<f64>>>;

/// Functions of states, one a row; arrays are float64 and contiguous, and Python's lock is free meanwhile.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Dynamics(rigid::Dynamics);

/// A function's numbers of each row, one row after the other.
fn each<'py>(
    py: Python<'py>,
    rows: usize,
    function: impl Fn(usize) -> Result<Vec<f64>, DynamicsError> + Send + Sync,
) -> Found<'py> {
    let found = py.detach(|| {
        let mut found = Vec::new();
        for row in 0..rows {
            let numbers = function(row).map_err(|why| format!("row {row}: {why}"))?;
            found.extend(numbers);
        }
        Ok(found)
    });
    let found = found.map_err(|message: String| error::raise("SimulationError", message))?;
    Ok(found.into_pyarray(py))
}

/// The number of rows, and the numbers of each.
fn rows<'a>(array: &'a Rows<'_>) -> PyResult<impl Fn(usize) -> &'a [f64] + use<'a>> {
    let (columns, numbers) = (array.shape()[1], slice(array)?);
    Ok(move |row: usize| &numbers[row * columns..][..columns])
}

#[pymethods]
impl Dynamics {
    #[new]
    fn new(model: &Model) -> PyResult<Self> {
        let made = rigid::Dynamics::new(&model.model);
        let made = made.map_err(|why| error::raise("SimulationError", why.to_string()))?;
        Ok(Self(made))
    }

    /// M(q), row by row.
    fn mass_matrix<'py>(&self, py: Python<'py>, position: Rows<'py>) -> Found<'py> {
        let q = rows(&position)?;
        each(py, position.shape()[0], |i| self.0.mass_matrix(q(i)))
    }

    /// τ of a motion.
    fn inverse_dynamics<'py>(
        &self,
        py: Python<'py>,
        position: Rows<'py>,
        velocity: Rows<'py>,
        acceleration: Rows<'py>,
    ) -> Found<'py> {
        let (q, v, a) = (rows(&position)?, rows(&velocity)?, rows(&acceleration)?);
        each(py, position.shape()[0], |i| {
            self.0.inverse_dynamics(q(i), v(i), a(i))
        })
    }

    /// q̈ under forces.
    fn forward_dynamics<'py>(
        &self,
        py: Python<'py>,
        position: Rows<'py>,
        velocity: Rows<'py>,
        force: Rows<'py>,
    ) -> Found<'py> {
        let (q, v, f) = (rows(&position)?, rows(&velocity)?, rows(&force)?);
        each(py, position.shape()[0], |i| {
            self.0.forward_dynamics(q(i), v(i), f(i))
        })
    }

    /// J(q) of points of a body, row by row.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        position: Rows<'py>,
        body: usize,
        point: Rows<'py>,
    ) -> Found<'py> {
        let (q, p) = (rows(&position)?, rows(&point)?);
        each(py, position.shape()[0], |i| {
            let point = DVec3::from_slice(p(i));
            self.0.jacobian(q(i), BodyId(body), point)
        })
    }

    /// 13 numbers of each body: placement and velocities.
    fn bodies<'py>(&self, py: Python<'py>, position: Rows<'py>, velocity: Rows<'py>) -> Found<'py> {
        let (q, v) = (rows(&position)?, rows(&velocity)?);
        each(py, position.shape()[0], |i| self.0.bodies(q(i), v(i)))
    }
}
