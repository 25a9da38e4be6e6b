//! What a robot's file says of its sensors.

use crate::{BodyId, JointId, Pose};
use serde::{Deserialize, Serialize};

/// A sensor as it is described: what it measures, and how well. A model only carries it along; the crate `sensors`
/// makes readings of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sensor {
    /// Unique among the model's sensors.
    pub name: String,
    /// What it measures.
    pub measurand: Measurand,
    /// Samples per second [Hz]; `None`: one at every step.
    pub rate: Option<f64>,
    /// Standard deviation of its noise, in the unit of what it measures.
    pub noise: f64,
    /// Readings are kept within ± this; `None`: of any size.
    pub cutoff: Option<f64>,
}

impl Sensor {
    /// Exact, and sampled at every step.
    pub fn new(name: impl Into<String>, measurand: Measurand) -> Self {
        Self {
            name: name.into(),
            measurand,
            rate: None,
            noise: 0.0,
            cutoff: None,
        }
    }
}

/// A frame on a body, or in the world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mount {
    /// What carries it; `None`, the default, is the world.
    pub body: Option<BodyId>,
    /// Placement in the body's frame, or in the world; the origin by default.
    pub pose: Pose,
}

impl Mount {
    /// The frame of a body itself.
    pub fn on(body: BodyId) -> Self {
        Self {
            body: Some(body),
            pose: Pose::IDENTITY,
        }
    }
    /// A frame that stands in the world.
    pub fn in_world(pose: Pose) -> Self {
        Self { body: None, pose }
    }
    /// The same, at a placement in the frame of what carries it.
    pub fn at(self, pose: Pose) -> Self {
        Self { pose, ..self }
    }
}

/// Along which axes a vector is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axes {
    /// Those of the world.
    World,
    /// Those of the sensor's own frame: its mount's or body's.
    #[default]
    Own,
}

/// A quantity that a sensor is to measure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Measurand {
    /// Coordinate of one axis of a joint [m or rad].
    JointPosition {
        /// The joint; no ball or free one.
        joint: JointId,
        /// Which of its axes.
        axis: usize,
    },
    /// Velocity along one axis of a joint [m/s or rad/s].
    JointVelocity {
        /// The joint; no ball or free one.
        joint: JointId,
        /// Which of its axes.
        axis: usize,
    },
    /// What actuators, drives and a controller do along one axis of a joint [N or N·m].
    JointEffort {
        /// The joint; no ball or free one.
        joint: JointId,
        /// Which of its axes.
        axis: usize,
    },
    /// Orientation of a ball joint, x, y, z, w.
    BallOrientation {
        /// The joint.
        joint: JointId,
    },
    /// Angular velocity of a ball joint [rad/s], in the child's axes.
    BallVelocity {
        /// The joint.
        joint: JointId,
    },
    /// Force of an actuator before its gear [N or N·m].
    ActuatorForce {
        /// Row of the actuator.
        actuator: usize,
    },
    /// Proper acceleration of a frame's origin [m/s²] in the frame's axes: at rest g upwards.
    Acceleration {
        /// The frame.
        mount: Mount,
    },
    /// Velocity of a frame's origin [m/s].
    Velocity {
        /// The frame.
        mount: Mount,
        /// Axes of the world, or of the frame.
        axes: Axes,
    },
    /// Angular velocity of a frame [rad/s].
    AngularVelocity {
        /// The frame.
        mount: Mount,
        /// Axes of the world, or of the frame.
        axes: Axes,
    },
    /// Force of a joint on its child [N], in the axes of a frame of the child.
    Force {
        /// The joint; no free one.
        joint: JointId,
        /// The frame, in the child body's.
        frame: Pose,
    },
    /// Torque of a joint on its child [N·m] about a frame of the child, in its axes.
    Torque {
        /// The joint; no free one.
        joint: JointId,
        /// The frame, in the child body's.
        frame: Pose,
    },
    /// Sum of the normal forces of all contacts of a body [N].
    Touch {
        /// The body.
        body: BodyId,
    },
    /// Position of a frame [m].
    Position {
        /// The frame.
        mount: Mount,
        /// In which frame it is told.
        relative_to: Mount,
    },
    /// Orientation of a frame, x, y, z, w.
    Orientation {
        /// The frame.
        mount: Mount,
        /// In which frame it is told.
        relative_to: Mount,
    },
    /// Distance along the frame's x axis to what is first met [m], through the shapes of the body that carries it.
    Distance {
        /// The frame.
        mount: Mount,
    },
    /// Centre of mass of a body and all that joints carry from it on; of all bodies, if none [m].
    CenterOfMass {
        /// The body.
        body: Option<BodyId>,
    },
}

impl Measurand {
    /// The frames that it is of, as they can be changed.
    pub fn mounts_mut(&mut self) -> Vec<&mut Mount> {
        match self {
            Self::Acceleration { mount }
            | Self::Velocity { mount, .. }
            | Self::AngularVelocity { mount, .. }
            | Self::Distance { mount } => vec![mount],
            Self::Position { mount, relative_to } | Self::Orientation { mount, relative_to } => {
                vec![mount, relative_to]
            }
            _ => Vec::new(),
        }
    }
    /// The joint that it is of, as it can be changed.
    pub fn joint_mut(&mut self) -> Option<&mut JointId> {
        match self {
            Self::JointPosition { joint, .. }
            | Self::JointVelocity { joint, .. }
            | Self::JointEffort { joint, .. }
            | Self::BallOrientation { joint }
            | Self::BallVelocity { joint }
            | Self::Force { joint, .. }
            | Self::Torque { joint, .. } => Some(joint),
            _ => None,
        }
    }
    /// The body that it is of as a whole, as it can be changed.
    pub fn body_mut(&mut self) -> Option<&mut BodyId> {
        match self {
            Self::Touch { body } => Some(body),
            Self::CenterOfMass { body } => body.as_mut(),
            _ => None,
        }
    }
}
