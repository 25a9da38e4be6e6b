//! Named states.

use serde::{Deserialize, Serialize};

/// A named state, in the order of the model's coordinates, velocities and actuators.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Keyframe {
    /// Unique in the model.
    pub name: String,
    /// Coordinates of all joints, [`Model::coordinates`](crate::Model::coordinates) of them.
    pub joint_position: Vec<f64>,
    /// Velocities of all joints, [`Model::degrees_of_freedom`](crate::Model::degrees_of_freedom) of them.
    pub joint_velocity: Vec<f64>,
    /// Controls of all actuators.
    pub control: Vec<f64>,
}
