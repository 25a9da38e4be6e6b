//! Surfaces of shapes.

use crate::error;
use crate::names::{Table, find, name_of};
use crate::pickled::{Reduced, reduce, restored};
use kinetarium::model;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

/// Resistance of a surface to being pressed in, at each point of contact.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Softness(pub model::Softness);

#[pymethods]
impl Softness {
    /// What brings the touching masses to rest in a time constant [s] with a damping ratio; `impedance`,
    /// from 0 to below 1, is the share of a load that an added mass takes; `mass` [kg] is what moves at this
    /// surface, unless it is all that hangs together.
    #[staticmethod]
    #[pyo3(signature = (constant=0.002, ratio=1.0, impedance=0.0, mass=None))]
    fn time(constant: f64, ratio: f64, impedance: f64, mass: Option<f64>) -> Self {
        Self(model::Softness::Time {
            constant,
            ratio,
            impedance,
            mass,
        })
    }
    /// Stiffness [N/m] and damping [N·s/m].
    #[staticmethod]
    fn spring(stiffness: f64, damping: f64) -> Self {
        Self(model::Softness::Spring { stiffness, damping })
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        match self.0 {
            model::Softness::Time {
                constant,
                ratio,
                impedance,
                mass,
            } => {
                let mass = mass.map(|m| format!(", mass={m:?}")).unwrap_or_default();
                format!("Softness.time({constant:?}, {ratio:?}, {impedance:?}{mass})")
            }
            model::Softness::Spring { stiffness, damping } => {
                format!("Softness.spring({stiffness:?}, {damping:?})")
            }
        }
    }
}

/// How coefficients of two surfaces become one.
const COMBINE: Table<model::Combine, 4> = [
    ("average", model::Combine::Average),
    ("minimum", model::Combine::Minimum),
    ("multiply", model::Combine::Multiply),
    ("maximum", model::Combine::Maximum),
];

/// Surface of a shape.
///
/// `friction` is the coefficient of what slides, `static_friction` that of what sticks, at least as large; none: the same.
/// `torsional_friction` and `rolling_friction` are lengths [m]; `margin` [m] is the distance from the surface at
/// which contact begins; `combine` tells how coefficients of two surfaces become one: "average", "minimum",
/// "multiply" or "maximum", of which the later holds.
#[pyclass(frozen, eq, from_py_object, module = "kinetarium._engine")]
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material(pub model::Material);

#[pymethods]
impl Material {
    #[new]
    #[expect(clippy::too_many_arguments, reason = "keywords in Python")]
    #[pyo3(signature = (friction=0.5, *, static_friction=None, torsional_friction=0.0, rolling_friction=0.0,
        restitution=0.0, softness=None, margin=0.0, combine="average"))]
    fn new(
        friction: f64,
        static_friction: Option<f64>,
        torsional_friction: f64,
        rolling_friction: f64,
        restitution: f64,
        softness: Option<Softness>,
        margin: f64,
        combine: &str,
    ) -> PyResult<Self> {
        let combine = find(&COMBINE, "rule", combine)?;
        let numbers = [
            ("friction", friction),
            ("static friction", static_friction.unwrap_or(0.0)),
            ("torsional friction [m]", torsional_friction),
            ("rolling friction [m]", rolling_friction),
            ("restitution", restitution),
        ];
        error::negative("material", numbers)?;
        Ok(Self(model::Material {
            friction,
            static_friction,
            torsional_friction,
            rolling_friction,
            restitution,
            softness: softness.map(|s| s.0).unwrap_or_default(),
            margin,
            combine,
        }))
    }
    /// Coulomb friction coefficient of what slides.
    #[getter]
    fn friction(&self) -> f64 {
        self.0.friction
    }
    /// Coulomb friction coefficient of what sticks, where it is another one.
    #[getter]
    fn static_friction(&self) -> Option<f64> {
        self.0.static_friction
    }
    /// Torsional friction coefficient [m].
    #[getter]
    fn torsional_friction(&self) -> f64 {
        self.0.torsional_friction
    }
    /// Rolling friction coefficient [m].
    #[getter]
    fn rolling_friction(&self) -> f64 {
        self.0.rolling_friction
    }
    /// Separation speed over approach speed.
    #[getter]
    fn restitution(&self) -> f64 {
        self.0.restitution
    }
    /// How far the surface gives way.
    #[getter]
    fn softness(&self) -> Softness {
        Softness(self.0.softness)
    }
    /// Distance from the surface at which contact begins [m].
    #[getter]
    fn margin(&self) -> f64 {
        self.0.margin
    }
    /// How coefficients of two surfaces become one.
    #[getter]
    fn combine(&self) -> &'static str {
        name_of(&COMBINE, &self.0.combine)
    }
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Reduced<'py>> {
        reduce(slf, slf.get())
    }
    #[staticmethod]
    fn _from_bytes(bytes: &[u8]) -> PyResult<Self> {
        restored(bytes)
    }
    fn __repr__(&self) -> String {
        let model::Material {
            friction,
            static_friction,
            torsional_friction,
            rolling_friction,
            restitution,
            softness,
            margin,
            ..
        } = self.0;
        let sticking = static_friction.map(|x| format!(", static_friction={x:?}"));
        let sticking = sticking.unwrap_or_default();
        format!(
            "Material({friction:?}{sticking}, torsional_friction={torsional_friction:?}, \
             rolling_friction={rolling_friction:?}, restitution={restitution:?}, softness={}, \
             margin={margin:?}, combine={:?})",
            Softness(softness).__repr__(),
            self.combine(),
        )
    }
}
