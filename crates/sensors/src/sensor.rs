//! What can be measured, where, and how often.

use crate::{ImageNoise, Noise};
use glam::{DQuat, DVec3};
use model::{Axes, BodyId, JointId, Model, Mount, Pose};
use render::{Device, View};
use std::ops::Range;

/// A sensor: the same in every world.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Unique among the sensors of a simulation; its noise depends on it.
    pub name: String,
    /// What it measures.
    pub kind: SensorKind,
    /// Which of its numbers are told, such as `3..6` of an [`Imu`](SensorKind::Imu) for a gyroscope; `None`: all.
    pub part: Option<Range<usize>>,
    /// Samples per second [Hz] of a world's own time, the first at time 0; `None`: one at every step.
    pub rate: Option<f64>,
    /// Readings are kept within ± this, after noise was added; `None`: of any size.
    pub cutoff: Option<f64>,
    /// What is added to what it measures; nothing by default.
    pub noise: Noise,
}

impl Sensor {
    /// Exact, and sampled at every step.
    pub fn new(name: impl Into<String>, kind: SensorKind) -> Self {
        Self {
            name: name.into(),
            kind,
            part: None,
            rate: None,
            cutoff: None,
            noise: Noise::default(),
        }
    }
    /// The same, of which these numbers are told.
    pub fn with_part(self, part: Range<usize>) -> Self {
        let part = Some(part);
        Self { part, ..self }
    }
    /// The same, with readings kept within ± this.
    pub fn with_cutoff(self, cutoff: f64) -> Self {
        let cutoff = Some(cutoff);
        Self { cutoff, ..self }
    }
    /// The same, with so many samples per second [Hz].
    pub fn with_rate(self, rate: f64) -> Self {
        let rate = Some(rate);
        Self { rate, ..self }
    }
    /// The same, with noise.
    pub fn with_noise(self, noise: Noise) -> Self {
        Self { noise, ..self }
    }
}

/// What a sensor measures. n is how many numbers it has in a world.
#[derive(Clone, Debug, PartialEq)]
pub enum SensorKind {
    /// Coordinates of joints, one joint after the other [m, rad, quaternions x, y, z, w]; those of axes
    /// that turn without end are in [−π, π]. n: their coordinates.
    JointPosition {
        /// Joints that have coordinates.
        joints: Vec<JointId>,
    },
    /// Velocities of joints, one joint after the other [m/s or rad/s]. n: their degrees of freedom.
    JointVelocity {
        /// Joints that have degrees of freedom.
        joints: Vec<JointId>,
    },
    /// Generalised forces of drives, actuators and what a controller applies [N or N·m], one joint after
    /// the other, by the model's laws at this state under the present controls; without springs, dampers,
    /// friction and limits. n: their degrees of freedom.
    JointEffort {
        /// Joints that have degrees of freedom, and no drive with a control time.
        joints: Vec<JointId>,
    },
    /// Forces of actuators, before their gears [N or N·m], by the model's laws at this state under the present
    /// controls. n: how many.
    ActuatorForce {
        /// Rows of the actuators.
        actuators: Vec<usize>,
    },
    /// An accelerometer and a gyroscope. n = 6: proper acceleration of the mount's origin [m/s²], which at
    /// rest is g upwards and in free fall 0; angular velocity [rad/s]; both in the mount's axes.
    ///
    /// The acceleration is that of [`Outputs::body_acceleration`](sim::Outputs::body_acceleration):
    /// of `featherstone` the one at this moment, exact but for the contacts' forces, which are the last
    /// step's; of the other solvers the mean over the last substep h, which is ½ h ȧ behind, and 0 in a
    /// world that has just been set.
    Imu {
        /// Where.
        mount: Mount,
    },
    /// What a joint passes on to its child. n = 6: force [N], and torque [N·m] about the frame's origin,
    /// on the child, in the frame's axes.
    ForceTorque {
        /// The joint; no free one, which passes on nothing.
        joint: JointId,
        /// The frame, in the child body's; `None` is the child's joint frame.
        frame: Option<Pose>,
    },
    /// How hard a body is touched. n = 1: the sum of the normal forces of all contacts of its shapes [N],
    /// those of the last step.
    Touch {
        /// The body.
        body: BodyId,
    },
    /// Sum of the forces of all contacts on a body [N], those of the last step. n = 3.
    ContactForce {
        /// The body.
        body: BodyId,
        /// Axes of the world, or of the body's frame.
        axes: Axes,
    },
    /// Where a frame is. n = 7: position [m], orientation x, y, z, w.
    FramePose {
        /// The frame.
        mount: Mount,
        /// The frame in which it is told; the world by default.
        relative_to: Mount,
    },
    /// How a frame moves in the world. n = 6: velocity of its origin [m/s], angular velocity [rad/s].
    FrameVelocity {
        /// The frame.
        mount: Mount,
        /// Axes of the world, or of the frame.
        axes: Axes,
    },
    /// Centre of mass of a body and all that joints carry from it on [m], world axes; static bodies have no mass. n = 3.
    CenterOfMass {
        /// The body; `None`: all bodies.
        body: Option<BodyId>,
    },
    /// Distance to what is first met along the mount's x axis [m]. n = 1.
    ///
    /// As [`Simulation::cast_ray`](sim::Simulation::cast_ray), but through the shapes of the body that it
    /// is mounted on. Where nothing is met, `max_range`.
    Rangefinder {
        /// Where.
        mount: Mount,
        /// Largest distance [m]; may be infinite.
        max_range: f64,
    },
    /// Distances along many rays [m], each as of a [`Rangefinder`](Self::Rangefinder). Shape of a world:
    /// (elevations, azimuths).
    ///
    /// The ray of azimuth α and elevation ε goes along (cos ε cos α, cos ε sin α, sin ε) in the mount's
    /// axes: x forwards, y to the left, z upwards.
    Lidar {
        /// Where.
        mount: Mount,
        /// About the mount's z axis from x to y [rad].
        azimuths: Vec<f64>,
        /// From the mount's x-y plane towards z [rad]; 0 alone is a fan in that plane.
        elevations: Vec<f64>,
        /// Largest distance [m], read where nothing is met; may be infinite.
        max_range: f64,
    },
    /// Images: see [`Sensors::images`](crate::Sensors::images). Its noise is that of its images.
    Camera {
        /// The camera, with its mount, and which images are made.
        view: View,
        /// What is added to them.
        noise: ImageNoise,
        /// Where they are drawn: the ray-caster on the processors, or a graphics card.
        device: Device,
    },
}

impl SensorKind {
    /// The joints of a model that have coordinates, in its order.
    pub fn all_joints(model: &Model) -> Vec<JointId> {
        let has = |joint: &JointId| model.joints[joint.0].coordinates() > 0;
        (0..model.joints.len()).map(JointId).filter(has).collect()
    }
    /// So many directions [rad], evenly from the first to the last of them.
    pub fn fan(first: f64, last: f64, count: usize) -> Vec<f64> {
        let step = (last - first) / count.saturating_sub(1).max(1) as f64;
        (0..count).map(|i| first + i as f64 * step).collect()
    }
    /// Its name in errors.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Self::JointPosition { .. } => "joint position",
            Self::JointVelocity { .. } => "joint velocity",
            Self::JointEffort { .. } => "joint effort",
            Self::ActuatorForce { .. } => "actuator force",
            Self::Imu { .. } => "imu",
            Self::ForceTorque { .. } => "force/torque",
            Self::Touch { .. } => "touch",
            Self::ContactForce { .. } => "contact force",
            Self::FramePose { .. } => "frame pose",
            Self::FrameVelocity { .. } => "frame velocity",
            Self::CenterOfMass { .. } => "centre of mass",
            Self::Rangefinder { .. } => "rangefinder",
            Self::Lidar { .. } => "lidar",
            Self::Camera { .. } => "camera",
        }
    }
}

/// Unit vector of each ray of a sensor in its mount's axes, the azimuths of each elevation in turn.
pub(crate) fn directions(kind: &SensorKind) -> Vec<DVec3> {
    match kind {
        SensorKind::Rangefinder { .. } => vec![DVec3::X],
        SensorKind::Lidar {
            azimuths,
            elevations,
            ..
        } => {
            let ray = |elevation: f64, azimuth: f64| {
                let up = DQuat::from_rotation_y(-elevation);
                DQuat::from_rotation_z(azimuth) * (up * DVec3::X)
            };
            let rows = elevations.iter();
            rows.flat_map(|&e| azimuths.iter().map(move |&a| ray(e, a)))
                .collect()
        }
        _ => Vec::new(),
    }
}
