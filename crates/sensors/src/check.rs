//! What a sensor must fulfil, and how many numbers it has.

use crate::SensorError;
use crate::sensor::{Sensor, SensorKind};
use model::{BodyId, Joint, JointId, JointKind, Model, Mount, Pose};
use std::ops::Range;

/// Most rays of a sensor.
const MOST_RAYS: usize = 1 << 20;
/// Highest rate [Hz].
const MOST_RATE: f64 = 1e9;
/// Farthest place of a mount in its frame [m].
const FARTHEST: f64 = 1e9;

/// Refuses sensors without names of their own.
pub(crate) fn names(sensors: &[Sensor]) -> Result<(), SensorError> {
    let mut known = std::collections::HashSet::new();
    for (row, sensor) in sensors.iter().enumerate() {
        if sensor.name.is_empty() {
            return Err(SensorError::NoName { row });
        }
        if !known.insert(sensor.name.as_str()) {
            let name = sensor.name.clone();
            return Err(SensorError::SameName { name });
        }
    }
    Ok(())
}

/// What is measured of a world, and which of it is told.
pub(crate) struct Layout {
    /// Of a reading in one world.
    pub shape: Vec<usize>,
    /// First numbers of the quaternions in it.
    pub quaternions: Vec<usize>,
    /// Which of the numbers that are measured are told.
    pub part: Range<usize>,
}

/// A sensor, to be checked against a model.
#[derive(Clone, Copy)]
pub(crate) struct Check<'a> {
    pub sensor: &'a Sensor,
    pub model: &'a Model,
}

impl Check<'_> {
    /// Checks all but the noise, the cutoff and what is drawn.
    pub fn layout(self) -> Result<Layout, SensorError> {
        let (shape, quaternions) = self.measured()?;
        let measured = shape.iter().product();
        let Some(part) = self.sensor.part.clone() else {
            let part = 0..measured;
            return Ok(Layout {
                shape,
                quaternions,
                part,
            });
        };
        let remedy = "read it whole";
        self.support(
            shape.len() == 1 && measured > 0,
            "part of its numbers",
            remedy,
        )?;
        let valid = !part.is_empty() && part.end <= measured;
        let must = "some of its numbers, counted from 0";
        self.require(valid, "its part", format!("{part:?}"), must)?;
        let whole = |q: &usize| part.start <= *q && q + 4 <= part.end;
        let quaternions = quaternions.into_iter().filter(whole);
        Ok(Layout {
            shape: vec![part.len()],
            quaternions: quaternions.map(|q| q - part.start).collect(),
            part,
        })
    }

    /// The shape of what is measured in one world, and the first numbers of the quaternions in it.
    fn measured(self) -> Result<(Vec<usize>, Vec<usize>), SensorError> {
        if let Some(rate) = self.sensor.rate {
            let valid = rate > 0.0 && rate <= MOST_RATE;
            self.require(valid, "its rate", rate, "above 0 and at most 1e9, in Hz")?;
        }
        match &self.sensor.kind {
            SensorKind::JointPosition { joints } => self.positions(joints),
            SensorKind::JointVelocity { joints } => self.dofs(joints),
            SensorKind::JointEffort { joints } => {
                joints.iter().try_for_each(|&joint| self.effort(joint))?;
                self.dofs(joints)
            }
            SensorKind::ActuatorForce { actuators } => {
                let count = self.model.actuators.len();
                self.require(
                    !actuators.is_empty(),
                    "its list of actuators",
                    "empty",
                    "one actuator or more",
                )?;
                actuators
                    .iter()
                    .try_for_each(|&row| self.row("actuator", row, count))?;
                Ok((vec![actuators.len()], vec![]))
            }
            SensorKind::CenterOfMass { body } => {
                body.iter().try_for_each(|&body| self.body(body))?;
                Ok((vec![3], vec![]))
            }
            SensorKind::Imu { mount } | SensorKind::FrameVelocity { mount, .. } => {
                self.mount(mount)?;
                Ok((vec![6], vec![]))
            }
            SensorKind::ForceTorque { joint, frame } => self.reaction(*joint, frame.as_ref()),
            SensorKind::Touch { body } => {
                self.body(*body)?;
                Ok((vec![1], vec![]))
            }
            SensorKind::ContactForce { body, .. } => {
                self.body(*body)?;
                Ok((vec![3], vec![]))
            }
            SensorKind::FramePose { mount, relative_to } => {
                self.mount(mount)?;
                self.mount(relative_to)?;
                Ok((vec![7], vec![3]))
            }
            SensorKind::Rangefinder { mount, max_range } => {
                self.rays(mount, *max_range)?;
                Ok((vec![1], vec![]))
            }
            SensorKind::Lidar {
                mount,
                azimuths,
                elevations,
                max_range,
            } => {
                self.rays(mount, *max_range)?;
                self.angles("azimuth", azimuths)?;
                self.angles("elevation", elevations)?;
                let (rows, columns) = (elevations.len(), azimuths.len());
                let rays = rows.saturating_mul(columns);
                let most = "at most 1048576";
                self.require(rays <= MOST_RAYS, "its number of rays", rays, most)?;
                Ok((vec![rows, columns], vec![]))
            }
            SensorKind::Camera { noise, .. } => {
                let remedy = "give it to the kind, for its images";
                self.support(self.sensor.noise.is_none(), "noise of numbers", remedy)?;
                let remedy = "leave it out";
                self.support(self.sensor.cutoff.is_none(), "cutoff", remedy)?;
                let must = "from 0 to 1e9";
                let small = |level: f64| (0.0..=1e9).contains(&level);
                self.require(
                    small(noise.rgb),
                    "the noise of its colours",
                    noise.rgb,
                    must,
                )?;
                self.require(
                    small(noise.depth),
                    "the noise of its depth",
                    noise.depth,
                    must,
                )?;
                Ok((vec![0], vec![]))
            }
        }
    }

    fn require(
        self,
        holds: bool,
        what: &'static str,
        value: impl ToString,
        must: &'static str,
    ) -> Result<(), SensorError> {
        if holds {
            return Ok(());
        }
        Err(SensorError::OutOfRange {
            sensor: self.sensor.name.clone(),
            what,
            value: value.to_string(),
            must,
        })
    }
    fn support(
        self,
        does: bool,
        what: impl Into<String>,
        remedy: &'static str,
    ) -> Result<(), SensorError> {
        if does {
            return Ok(());
        }
        Err(SensorError::Unsupported {
            sensor: self.sensor.name.clone(),
            kind: self.sensor.kind.name(),
            what: what.into(),
            remedy,
        })
    }

    fn row(self, what: &'static str, row: usize, count: usize) -> Result<(), SensorError> {
        if row < count {
            return Ok(());
        }
        Err(SensorError::NotInModel {
            sensor: self.sensor.name.clone(),
            what,
            row,
            count,
        })
    }
    fn body(self, body: BodyId) -> Result<(), SensorError> {
        self.row("body", body.0, self.model.bodies.len())
    }
    fn joint(&self, joint: JointId) -> Result<&Joint, SensorError> {
        self.row("joint", joint.0, self.model.joints.len())?;
        Ok(&self.model.joints[joint.0])
    }

    fn pose(self, what: &'static str, pose: &Pose) -> Result<(), SensorError> {
        let near = pose.position.abs().max_element() <= FARTHEST;
        let must = "finite, within 1e9 m, its orientation of unit length";
        let value = format!("at {}, turned by {}", pose.position, pose.orientation);
        self.require(pose.is_valid() && near, what, value, must)
    }
    fn mount(self, mount: &Mount) -> Result<(), SensorError> {
        mount.body.iter().try_for_each(|&body| self.body(body))?;
        self.pose("the pose of its mount", &mount.pose)
    }
    fn rays(self, mount: &Mount, max_range: f64) -> Result<(), SensorError> {
        self.mount(mount)?;
        let must = "above 0, in metres; it may be infinite";
        self.require(max_range > 0.0, "its largest range", max_range, must)
    }
    fn angles(self, what: &'static str, angles: &[f64]) -> Result<(), SensorError> {
        self.require(!angles.is_empty(), what, "missing", "given at least once")?;
        let bad = angles.iter().find(|angle| !(-1e3..=1e3).contains(*angle));
        let must = "from -1000 to 1000, in radians";
        bad.map_or(Ok(()), |bad| self.require(false, what, bad, must))
    }

    /// The joints there are, of which each has coordinates.
    fn joints(self, joints: &[JointId]) -> Result<(), SensorError> {
        self.require(
            !joints.is_empty(),
            "its list of joints",
            "empty",
            "one joint or more",
        )?;
        for &id in joints {
            let joint = self.joint(id)?;
            let what = format!("joint without coordinates, as `{}`", joint.name);
            let remedy = "leave it out";
            self.support(joint.coordinates() > 0, what, remedy)?;
        }
        Ok(())
    }
    fn positions(self, joints: &[JointId]) -> Result<(Vec<usize>, Vec<usize>), SensorError> {
        self.joints(joints)?;
        let (mut n, mut quaternions) = (0, Vec::new());
        for joint in joints.iter().map(|&j| &self.model.joints[j.0]) {
            match joint.kind {
                JointKind::Ball => quaternions.push(n),
                JointKind::Free => quaternions.push(n + 3),
                _ => {}
            }
            n += joint.coordinates();
        }
        Ok((vec![n], quaternions))
    }
    fn dofs(self, joints: &[JointId]) -> Result<(Vec<usize>, Vec<usize>), SensorError> {
        self.joints(joints)?;
        let dofs = |j: &JointId| self.model.joints[j.0].degrees_of_freedom();
        Ok((vec![joints.iter().map(dofs).sum()], vec![]))
    }
    /// Where a drive follows its target only knows its solver.
    fn effort(self, id: JointId) -> Result<(), SensorError> {
        let joint = self.joint(id)?;
        let at_once = joint.dofs.iter().all(|dof| dof.drive.control_time == 0.0);
        let what = format!("drive with a control time, as joint `{}` has", joint.name);
        let remedy = "set its control time to 0, and smooth the targets that are set";
        self.support(at_once, what, remedy)
    }
    fn reaction(
        self,
        id: JointId,
        frame: Option<&Pose>,
    ) -> Result<(Vec<usize>, Vec<usize>), SensorError> {
        let joint = self.joint(id)?;
        let what = format!("free joint, as `{}`", joint.name);
        let remedy = "a free body is held by nothing; measure contact forces, or another joint";
        self.support(joint.kind != JointKind::Free, what, remedy)?;
        frame.map_or(Ok(()), |frame| self.pose("its frame", frame))?;
        Ok((vec![6], vec![]))
    }
}
