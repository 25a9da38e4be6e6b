//! Where copies of an object are.

use crate::builder::Builder;
use crate::error;
use crate::vector::vector;
use glam::DVec3;
use kinetarium::model::{self, ModelError, ObjectId};
use pyo3::prelude::*;

/// One copy of an object, or all, to be moved within the world.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Replica {
    pub builder: Py<Builder>,
    pub object: ObjectId,
    /// None: all.
    pub k: Option<usize>,
}

impl Replica {
    fn place(
        &self,
        py: Python<'_>,
        change: impl FnOnce(&mut model::Placement<'_>),
    ) -> PyResult<()> {
        let mut builder = self.builder.borrow_mut(py);
        let object = builder
            .builder
            .object_mut(self.object)
            .map_err(error::model)?;
        let mut placement = match self.k {
            Some(k) => object.replica(k).map_err(error::model)?,
            None => object.replicas(),
        };
        change(&mut placement);
        Ok(())
    }
}

/// A vector; `what` is the argument.
fn point(what: &str, given: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    let numbers = vector(&format!("placement: {what}"), given)?;
    Ok(DVec3::from_array(numbers))
}

/// A direction of any length but zero.
fn direction(axis: &Bound<'_, PyAny>) -> PyResult<DVec3> {
    let axis = point("axis", axis)?;
    if axis.length() > 1e-12 && axis.is_finite() {
        return Ok(axis);
    }
    let what = "placement".into();
    let quantity = "axis".into();
    Err(error::model(ModelError::ZeroLength {
        what,
        quantity,
        remedy: "give a direction",
    }))
}

#[pymethods]
impl Replica {
    /// Moves it by a shift [m].
    fn translate_by(&self, py: Python<'_>, shift: &Bound<'_, PyAny>) -> PyResult<()> {
        let shift = self::point("shift", shift)?;
        self.place(py, |p| {
            p.translate_by(shift);
        })
    }
    /// Moves its origin to a point [m].
    fn translate_to(&self, py: Python<'_>, point: &Bound<'_, PyAny>) -> PyResult<()> {
        let point = self::point("point", point)?;
        self.place(py, |p| {
            p.translate_to(point);
        })
    }
    /// Moves it along a direction by a distance [m].
    fn move_on_axis_by(
        &self,
        py: Python<'_>,
        axis: &Bound<'_, PyAny>,
        distance: f64,
    ) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.move_on_axis_by(axis, distance);
        })
    }
    /// Moves it along a direction until its origin is at a distance [m] along it.
    fn move_on_axis_to(
        &self,
        py: Python<'_>,
        axis: &Bound<'_, PyAny>,
        distance: f64,
    ) -> PyResult<()> {
        let axis = direction(axis)?;
        self.place(py, |p| {
            p.move_on_axis_to(axis, distance);
        })
    }
    /// Turns it about an axis through a point [m] by an angle [rad].
    fn rotate_around_by(
        &self,
        py: Python<'_>,
        point: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        angle: f64,
    ) -> PyResult<()> {
        let (point, axis) = (self::point("point", point)?, direction(axis)?);
        self.place(py, |p| {
            p.rotate_around_by(point, axis, angle);
        })
    }
    /// Turns it about an axis through a point [m] until it is turned by an angle [rad] about it.
    fn rotate_around_to(
        &self,
        py: Python<'_>,
        point: &Bound<'_, PyAny>,
        axis: &Bound<'_, PyAny>,
        angle: f64,
    ) -> PyResult<()> {
        let (point, axis) = (self::point("point", point)?, direction(axis)?);
        self.place(py, |p| {
            p.rotate_around_to(point, axis, angle);
        })
    }
}
