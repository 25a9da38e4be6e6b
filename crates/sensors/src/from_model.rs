//! From what a model's file says of its sensors to sensors.

use crate::sensor::{Sensor, SensorKind};
use crate::{Level, Noise};
use model::{Measurand, Model};
use std::ops::Range;

impl Sensor {
    /// The sensors that the model's file describes, in its order, with their rates, cutoffs and noise; none where it
    /// says nothing of sensors. They are as others: to be changed, left out, and given to
    /// [`Sensors::new`](crate::Sensors::new) beside others.
    ///
    /// Each tells what MuJoCo's `sensordata` has of it, but for the order of quaternions, x, y, z, w; for
    /// rangefinders that meet nothing, which read their largest range; and for noise, which MuJoCo does not add.
    pub fn from_model(model: &Model) -> Vec<Self> {
        model.sensors.iter().map(described).collect()
    }
}

fn described(sensor: &model::Sensor) -> Sensor {
    let (kind, part) = kind(sensor);
    let is_range = matches!(kind, SensorKind::Rangefinder { .. });
    Sensor {
        name: sensor.name.clone(),
        kind,
        part,
        rate: sensor.rate,
        cutoff: sensor.cutoff.filter(|_| !is_range),
        noise: Noise::white(Level::All(sensor.noise)),
    }
}

/// What is measured, and which of its numbers are told if not all.
fn kind(sensor: &model::Sensor) -> (SensorKind, Option<Range<usize>>) {
    let part = |kind, first, count| (kind, Some(first..first + count));
    match sensor.measurand {
        Measurand::JointPosition { joint, axis } => {
            let joints = vec![joint];
            part(SensorKind::JointPosition { joints }, axis, 1)
        }
        Measurand::JointVelocity { joint, axis } => {
            let joints = vec![joint];
            part(SensorKind::JointVelocity { joints }, axis, 1)
        }
        Measurand::JointEffort { joint, axis } => {
            let joints = vec![joint];
            part(SensorKind::JointEffort { joints }, axis, 1)
        }
        Measurand::BallOrientation { joint } => {
            let joints = vec![joint];
            (SensorKind::JointPosition { joints }, None)
        }
        Measurand::BallVelocity { joint } => {
            let joints = vec![joint];
            (SensorKind::JointVelocity { joints }, None)
        }
        Measurand::ActuatorForce { actuator } => {
            let actuators = vec![actuator];
            (SensorKind::ActuatorForce { actuators }, None)
        }
        Measurand::Acceleration { mount } => part(SensorKind::Imu { mount }, 0, 3),
        Measurand::Velocity { mount, axes } => {
            part(SensorKind::FrameVelocity { mount, axes }, 0, 3)
        }
        Measurand::AngularVelocity { mount, axes } => {
            part(SensorKind::FrameVelocity { mount, axes }, 3, 3)
        }
        Measurand::Force { joint, frame } => {
            let frame = Some(frame);
            part(SensorKind::ForceTorque { joint, frame }, 0, 3)
        }
        Measurand::Torque { joint, frame } => {
            let frame = Some(frame);
            part(SensorKind::ForceTorque { joint, frame }, 3, 3)
        }
        Measurand::Touch { body } => (SensorKind::Touch { body }, None),
        Measurand::Position { mount, relative_to } => {
            part(SensorKind::FramePose { mount, relative_to }, 0, 3)
        }
        Measurand::Orientation { mount, relative_to } => {
            part(SensorKind::FramePose { mount, relative_to }, 3, 4)
        }
        Measurand::Distance { mount } => {
            let max_range = sensor.cutoff.unwrap_or(f64::INFINITY);
            (SensorKind::Rangefinder { mount, max_range }, None)
        }
        Measurand::CenterOfMass { body } => (SensorKind::CenterOfMass { body }, None),
    }
}
