//! Actuators: named control inputs that act on a degree of freedom.

use crate::JointId;

/// Force = gain · u + bias₀ + bias₁ · l + bias₂ · l̇ with l = gear · q, clamped to
/// the force range; it acts on the degree of freedom times `gear`.
///
/// A motor has gain 1 and no bias; a position servo of stiffness k has gain k and
/// bias (0, −k, 0); a velocity servo of damping d has gain d and bias (0, 0, −d).
#[derive(Clone, Debug, PartialEq)]
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
