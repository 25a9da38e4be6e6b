//! Actuators: named control inputs that act on a degree of freedom.

use crate::JointId;
use serde::{Deserialize, Serialize};

/// Force = gain · u + bias₀ + bias₁ · l + bias₂ · l̇ with l = gear · q, clamped to
/// the force range; it acts on the degree of freedom times `gear`.
///
/// A motor has gain 1 and no bias; a position servo of stiffness k has gain k and
/// bias (0, −k, 0); a velocity servo of damping d has gain d and bias (0, 0, −d).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Actuator {
    /// Unique in the model.
    pub name: String,
    /// Joint it acts on.
    pub joint: JointId,
    /// Which of the joint's degrees of freedom.
    pub dof: usize,
    /// Transmission ratio.
    pub gear: f64,
    /// Factor of the control.
    pub gain: f64,
    /// Constant, position and velocity terms.
    pub bias: [f64; 3],
    /// Range the control is clamped to.
    pub control_range: Option<(f64, f64)>,
    /// Range the force is clamped to [N or N·m].
    pub force_range: Option<(f64, f64)>,
}

impl Actuator {
    /// The control is the force [N or N·m] on a joint's first degree of freedom.
    pub fn motor(name: impl Into<String>, joint: JointId) -> Self {
        Self {
            name: name.into(),
            joint,
            dof: 0,
            gear: 1.0,
            gain: 1.0,
            bias: [0.0; 3],
            control_range: None,
            force_range: None,
        }
    }
    /// The control is the position [m or rad] that a spring [N/m or N·m/rad] with a damper
    /// [N·s/m or N·m·s/rad] pulls to.
    pub fn position(name: impl Into<String>, joint: JointId, stiffness: f64, damping: f64) -> Self {
        Self {
            gain: stiffness,
            bias: [0.0, -stiffness, -damping],
            ..Self::motor(name, joint)
        }
    }
    /// The control is the velocity [m/s or rad/s] that a damper [N·s/m or N·m·s/rad] pulls to.
    pub fn velocity(name: impl Into<String>, joint: JointId, damping: f64) -> Self {
        Self {
            gain: damping,
            bias: [0.0, 0.0, -damping],
            ..Self::motor(name, joint)
        }
    }
}
