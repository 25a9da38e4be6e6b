//! What acts along the degrees of freedom of joints.

use crate::error;
use crate::geometry::direction;
use crate::pickled::{Reduced, reduce, restored};
use crate::range;
use crate::vector::{vector, vector_or};
use glam::DVec3;
use kinetarium::model::{self, ModelError};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// One axis of a `d6` joint. Axes act in turn: each is fixed in the frame that the ones before it have moved.
///
/// `reference` [m or rad] is the coordinate at which the two frames of the joint coincide.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis(pub model::Axis);

#[pymethods]
impl Axis {
    /// Rotation about a direction, of any length but zero, through a point `anchor` [m] of the joint's frame; other
    /// points than its origin only `featherstone` takes.
    #[staticmethod]
    #[pyo3(signature = (direction, *, anchor=None, reference=0.0))]
    fn angular(
        direction: &Bound<'_, PyAny>,
        anchor: Option<&Bound<'_, PyAny>>,
        reference: f64,
    ) -> PyResult<Self> {
        let direction = self::direction(vector("axis: direction", direction)?);
        Ok(Self(model::Axis {
            anchor: DVec3::from_array(vector_or("axis: anchor", anchor, [0.0; 3])?),
            reference,
            ..model::Axis::angular(direction)
        }))
    }
    /// Translation along a direction, of any length but zero.
    #[staticmethod]
    #[pyo3(signature = (direction, *, reference=0.0))]
    fn linear(direction: &Bound<'_, PyAny>, reference: f64) -> PyResult<Self> {
        let direction = self::direction(vector("axis: direction", direction)?);
        Ok(Self(model::Axis {
            reference,
            ..model::Axis::linear(direction)
        }))
    }
    /// What it does: "linear" or "angular".
    #[getter]
    fn kind(&self) -> &'static str {
        match self.0.kind {
            model::AxisKind::Linear => "linear",
            model::AxisKind::Angular => "angular",
        }
    }
    /// Unit direction in the joint's frame.
    #[getter]
    fn direction(&self) -> (f64, f64, f64) {
        self.0.direction.into()
    }
    /// A point on the axis in the joint's frame [m].
    #[getter]
    fn anchor(&self) -> (f64, f64, f64) {
        self.0.anchor.into()
    }
    /// Coordinate at which the two joint frames coincide [m or rad].
    #[getter]
    fn reference(&self) -> f64 {
        self.0.reference
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        let (direction, kind, reference) = (self.direction(), self.kind(), self.reference());
        let anchor = match self.0.kind {
            model::AxisKind::Linear => String::new(),
            model::AxisKind::Angular => format!("anchor={:?}, ", self.anchor()),
        };
        format!("Axis.{kind}({direction:?}, {anchor}reference={reference:?})")
    }
}

/// A soft stop at each end of a coordinate's range [m or rad]; none where that is infinite, as in `Limit(0, math.inf)`.
///
/// Beyond an end the force is −stiffness · excess − damping · velocity − inertia · acceleration, in N/m, N·s/m and kg
/// or N·m/rad, N·m·s/rad and kg·m²; it never pulls.
#[pyclass(frozen, eq, get_all, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Lower end [m or rad].
    lower: f64,
    /// Upper end [m or rad].
    upper: f64,
    /// Stiffness [N/m or N·m/rad].
    stiffness: f64,
    /// Damping [N·s/m or N·m·s/rad].
    damping: f64,
    /// Mass or moment of inertia that is carried along beyond the ends [kg or kg·m²].
    inertia: f64,
}

impl Limit {
    /// As models have it; `None` where neither end is.
    fn in_model(self) -> Option<model::Limit> {
        let (lower, upper) = range::in_model([self.lower, self.upper])?;
        Some(model::Limit {
            lower,
            upper,
            stiffness: self.stiffness,
            damping: self.damping,
            inertia: self.inertia,
        })
    }
    /// A limit, or the two ends of one that is otherwise as usual.
    pub fn of(value: &Bound<'_, PyAny>) -> PyResult<Self> {
        if let Ok(limit) = value.extract::<Self>() {
            return Ok(limit);
        }
        let Ok([lower, upper]) = value.extract::<[f64; 2]>() else {
            let message = format!(
                "{} is no limit: give a Limit or its two ends",
                value.repr()?
            );
            return Err(PyTypeError::new_err(message));
        };
        // Checked with the joint's model, whose message has its name.
        Ok(Self {
            lower,
            upper,
            stiffness: 1e4,
            damping: 1e2,
            inertia: 0.0,
        })
    }
}

#[pymethods]
impl Limit {
    #[new]
    #[pyo3(signature = (lower, upper, *, stiffness=1e4, damping=1e2, inertia=0.0))]
    fn new(lower: f64, upper: f64, stiffness: f64, damping: f64, inertia: f64) -> PyResult<Self> {
        if lower > upper {
            return Err(error::model(ModelError::RangeReversed {
                what: "limit".into(),
                quantity: "range",
                lower,
                upper,
            }));
        }
        let numbers = [
            ("stiffness", stiffness),
            ("damping", damping),
            ("inertia", inertia),
        ];
        error::negative("limit", numbers)?;
        Ok(Self {
            lower,
            upper,
            stiffness,
            damping,
            inertia,
        })
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        let Self {
            lower,
            upper,
            stiffness,
            damping,
            inertia,
        } = self;
        format!(
            "Limit({lower:?}, {upper:?}, stiffness={stiffness:?}, damping={damping:?}, inertia={inertia:?})"
        )
    }
}

/// A motor that pulls a coordinate to targets: stiffness · (target − q) + damping · (target velocity − q̇), within
/// ± effort limit; of a ball that is a limit of the torque, whichever way it points.
///
/// A hinge without a limit turns without end, and is pulled the shorter way round, unlike by a position servo, which counts
/// turns.
///
/// `control_time` [s] is the time constant with which it follows a jump of the target.
#[pyclass(frozen, eq, get_all, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Stiffness [N/m or N·m/rad].
    stiffness: f64,
    /// Damping [N·s/m or N·m·s/rad].
    damping: f64,
    /// Initial position target [m or rad].
    target_position: f64,
    /// Initial velocity target [m/s or rad/s].
    target_velocity: f64,
    /// Largest force or torque [N or N·m].
    effort_limit: f64,
    /// Time constant with which it follows a jump of the target [s].
    control_time: f64,
}

impl From<Drive> for model::Drive {
    fn from(drive: Drive) -> Self {
        Self {
            stiffness: drive.stiffness,
            damping: drive.damping,
            target_position: drive.target_position,
            target_velocity: drive.target_velocity,
            effort_limit: drive.effort_limit,
            control_time: drive.control_time,
        }
    }
}

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
    ) -> PyResult<Self> {
        let numbers = [
            ("stiffness", stiffness),
            ("damping", damping),
            ("effort limit", effort_limit),
            ("control time [s]", control_time),
        ];
        error::negative("drive", numbers)?;
        Ok(Self {
            stiffness,
            damping,
            target_position,
            target_velocity,
            effort_limit,
            control_time,
        })
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        let Self {
            stiffness,
            damping,
            target_position,
            target_velocity,
            effort_limit,
            control_time,
        } = self;
        format!(
            "Drive({stiffness:?}, {damping:?}, target_position={target_position:?}, \
             target_velocity={target_velocity:?}, effort_limit={effort_limit:?}, control_time={control_time:?})"
        )
    }
}

/// What acts along one degree of freedom of a joint, in N/m, N·s/m, kg, N or N·m/rad, N·m·s/rad, kg·m², N·m: `limit`
/// (or its two ends), `drive`, `damping`, `stiffness` of a spring that rests at `rest`, `armature`, `friction_loss`.
///
/// `name` is unique in the model; unless given, it is the joint's, with a number behind where there are several. What
/// is not given is as the joint's own keywords say; or else does not act, or stays as it was where a joint is changed.
#[pyclass(frozen, eq, get_all, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Dof {
    /// Its name.
    pub name: Option<String>,
    /// Range of the coordinate.
    pub limit: Option<Limit>,
    /// Motor.
    pub drive: Option<Drive>,
    /// Viscous damping [N·s/m or N·m·s/rad].
    pub damping: Option<f64>,
    /// Stiffness of a spring [N/m or N·m/rad].
    pub stiffness: Option<f64>,
    /// Coordinate at which the spring is slack [m or rad].
    pub rest: Option<f64>,
    /// Reflected inertia of the motor [kg or kg·m²].
    pub armature: Option<f64>,
    /// Dry friction [N or N·m].
    pub friction_loss: Option<f64>,
}

impl Dof {
    /// The names of what is given.
    pub fn given(&self) -> impl Iterator<Item = &'static str> {
        let options = [
            ("name", self.name.is_some()),
            ("limit", self.limit.is_some()),
            ("drive", self.drive.is_some()),
            ("damping", self.damping.is_some()),
            ("stiffness", self.stiffness.is_some()),
            ("rest", self.rest.is_some()),
            ("armature", self.armature.is_some()),
            ("friction_loss", self.friction_loss.is_some()),
        ];
        let given = options.into_iter().filter(|(_, given)| *given);
        given.map(|(name, _)| name)
    }
    /// With what is given for all degrees of freedom where this says nothing.
    pub fn or(self, all: &Self) -> Self {
        Self {
            name: self.name.or_else(|| all.name.clone()),
            limit: self.limit.or(all.limit),
            drive: self.drive.or(all.drive),
            damping: self.damping.or(all.damping),
            stiffness: self.stiffness.or(all.stiffness),
            rest: self.rest.or(all.rest),
            armature: self.armature.or(all.armature),
            friction_loss: self.friction_loss.or(all.friction_loss),
        }
    }
    /// Lets all that is given act; what is not given stays.
    pub fn act(self, dof: &mut model::Dof) {
        *dof = model::Dof {
            name: self.name.unwrap_or_else(|| dof.name.clone()),
            armature: self.armature.unwrap_or(dof.armature),
            damping: self.damping.unwrap_or(dof.damping),
            stiffness: self.stiffness.unwrap_or(dof.stiffness),
            rest: self.rest.unwrap_or(dof.rest),
            friction_loss: self.friction_loss.unwrap_or(dof.friction_loss),
            limit: self.limit.map_or(dof.limit, Limit::in_model),
            drive: self.drive.map_or(dof.drive, Into::into),
        };
    }
}

#[pymethods]
impl Dof {
    #[new]
    #[pyo3(signature = (name=None, *, limit=None, drive=None, damping=None, stiffness=None, rest=None, armature=None,
        friction_loss=None))]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    fn new(
        name: Option<String>,
        limit: Option<&Bound<'_, PyAny>>,
        drive: Option<Drive>,
        damping: Option<f64>,
        stiffness: Option<f64>,
        rest: Option<f64>,
        armature: Option<f64>,
        friction_loss: Option<f64>,
    ) -> PyResult<Self> {
        Ok(Self {
            name,
            limit: limit.map(Limit::of).transpose()?,
            drive,
            damping,
            stiffness,
            rest,
            armature,
            friction_loss,
        })
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(slf: &Bound<'_, Self>) -> PyResult<String> {
        let given = slf.get().given().map(|name| {
            let value = slf.getattr(name)?.repr()?;
            Ok(format!("{name}={value}"))
        });
        Ok(format!(
            "Dof({})",
            given.collect::<PyResult<Vec<_>>>()?.join(", ")
        ))
    }
}
