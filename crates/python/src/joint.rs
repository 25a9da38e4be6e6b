//! What acts along the degrees of freedom of joints.

use glam::DVec3;
use kinetarium::model;
use pyo3::prelude::*;

/// One axis of a `d6` joint. Axes act in turn: each is fixed in the frame that the ones before it have moved.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Axis(pub model::Axis);

#[pymethods]
impl Axis {
    /// Rotation about a direction through the joint frame's origin.
    #[staticmethod]
    fn angular(direction: [f64; 3]) -> Self {
        Self(model::Axis::angular(DVec3::from_array(direction)))
    }
    /// Translation along a direction.
    #[staticmethod]
    fn linear(direction: [f64; 3]) -> Self {
        Self(model::Axis::linear(DVec3::from_array(direction)))
    }
    fn __repr__(&self) -> String {
        let model::Axis {
            kind, direction: d, ..
        } = self.0;
        format!("Axis({kind:?}, ({}, {}, {}))", d.x, d.y, d.z)
    }
}

/// A soft stop at each end of a coordinate's range [m or rad].
///
/// Beyond an end the force is −stiffness · excess − damping · velocity − inertia · acceleration, in N/m, N·s/m and kg
/// or N·m/rad, N·m·s/rad and kg·m²; it never pulls.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Limit(pub model::Limit);

#[pymethods]
impl Limit {
    #[new]
    #[pyo3(signature = (lower, upper, *, stiffness=1e4, damping=1e2, inertia=0.0))]
    fn new(lower: f64, upper: f64, stiffness: f64, damping: f64, inertia: f64) -> Self {
        Self(model::Limit {
            lower,
            upper,
            stiffness,
            damping,
            inertia,
        })
    }
    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}

/// A motor that pulls a coordinate to targets: stiffness · (target − q) + damping · (target velocity − q̇), within
/// ± effort limit.
///
/// `control_time` [s] is the time constant with which it follows a jump of the target.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq)]
pub struct Drive(pub model::Drive);

#[pymethods]
impl Drive {
    #[new]
    #[pyo3(signature = (stiffness=0.0, damping=0.0, *, target_position=0.0, target_velocity=0.0,
        effort_limit=f64::INFINITY, control_time=0.0))]
    fn new(
        stiffness: f64,
        damping: f64,
        target_position: f64,
        target_velocity: f64,
        effort_limit: f64,
        control_time: f64,
    ) -> Self {
        Self(model::Drive {
            stiffness,
            damping,
            target_position,
            target_velocity,
            effort_limit,
            control_time,
        })
    }
    fn __repr__(&self) -> String {
        format!("{:?}", self.0)
    }
}
