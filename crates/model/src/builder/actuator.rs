//! An actuator in the making.

use super::JointHandle;
use crate::Actuator;

/// An actuator in the making: on the joint's first degree of freedom, with gear 1 and no ranges,
/// unless said otherwise.
#[derive(Clone, Debug)]
pub struct ActuatorDraft {
    /// Its joint is not yet known by row; a placeholder stands there.
    pub(super) actuator: Actuator,
    pub(super) joint: JointHandle,
}

impl ActuatorDraft {
    /// Acts on another of the joint's degrees of freedom, counted from 0.
    pub fn dof(&mut self, dof: usize) -> &mut Self {
        self.actuator.dof = dof;
        self
    }
    /// Sets the transmission ratio.
    pub fn gear(&mut self, gear: f64) -> &mut Self {
        self.actuator.gear = gear;
        self
    }
    /// Clamps the control.
    pub fn control_range(&mut self, lower: f64, upper: f64) -> &mut Self {
        self.actuator.control_range = Some((lower, upper));
        self
    }
    /// Clamps the force [N or N·m].
    pub fn force_range(&mut self, lower: f64, upper: f64) -> &mut Self {
        self.actuator.force_range = Some((lower, upper));
        self
    }
}
