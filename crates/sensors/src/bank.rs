//! Sensors of joints, bodies and contacts that are read together: those of one rate.

use crate::SensorError;
use crate::sensor::SensorKind;
use model::Axes;
use numbers::Float;
use sim::{Gauge, Gauges, Report, Simulation};
use std::ops::Range;

/// Sensors of one rate.
#[derive(Clone, Debug)]
pub(crate) struct Bank<T: Float> {
    gauges: Gauges<T>,
    /// Rows of the sensors.
    sensors: Vec<usize>,
}

impl<T: Float> Bank<T> {
    /// Of the sensors in these rows, each of a gauge.
    pub fn new(
        simulation: &Simulation<T>,
        sensors: Vec<(usize, Gauge)>,
    ) -> Result<Self, SensorError> {
        let (sensors, list) = sensors.into_iter().unzip();
        Ok(Self {
            gauges: simulation.gauges(list)?,
            sensors,
        })
    }
    /// The rows of its sensors.
    pub fn sensors(&self) -> &[usize] {
        &self.sensors
    }
    /// How much of the outputs it is read from.
    pub fn needs(&self) -> Report {
        self.gauges.needs()
    }
    /// Where the numbers of its sensors stand among its own.
    pub fn numbers(&self) -> &[Range<usize>] {
        self.gauges.numbers()
    }
    /// Reads all its sensors in these worlds.
    pub fn read(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[usize],
    ) -> Result<(), SensorError> {
        Ok(simulation.read_gauges(&mut self.gauges, worlds)?)
    }
    /// Copies numbers that were read of a world, from one of them on.
    pub fn copy(&self, world: usize, from: usize, numbers: &mut [T]) {
        self.gauges.copy(world, from, numbers);
    }
}

/// The gauge of a sensor of joints, bodies or contacts, of which these numbers are told.
pub(crate) fn gauge(kind: &SensorKind, part: &Range<usize>) -> Option<Gauge> {
    Some(match kind {
        SensorKind::JointPosition { joints } => Gauge::JointPosition(joints.clone()),
        SensorKind::JointVelocity { joints } => Gauge::JointVelocity(joints.clone()),
        SensorKind::JointEffort { joints } => Gauge::JointEffort(joints.clone()),
        SensorKind::ActuatorForce { actuators } => Gauge::ActuatorForce(actuators.clone()),
        // A gyroscope needs no accelerations, and a frame's velocity ends as an IMU does.
        SensorKind::Imu { mount } if part.start >= 3 => Gauge::FrameVelocity(*mount, Axes::Own),
        SensorKind::Imu { mount } => Gauge::Imu(*mount),
        SensorKind::ForceTorque { joint, frame } => Gauge::ForceTorque(*joint, *frame),
        SensorKind::Touch { body } => Gauge::Touch(*body),
        SensorKind::ContactForce { body, axes } => Gauge::ContactForce(*body, *axes),
        SensorKind::FramePose { mount, relative_to } => Gauge::FramePose([*mount, *relative_to]),
        SensorKind::FrameVelocity { mount, axes } => Gauge::FrameVelocity(*mount, *axes),
        SensorKind::CenterOfMass { body } => Gauge::CenterOfMass(*body),
        SensorKind::Rangefinder { .. } | SensorKind::Lidar { .. } | SensorKind::Camera { .. } => {
            return None;
        }
    })
}
