//! Sensors of joints, bodies and contacts, in one world.

use crate::sensor::SensorKind;
use glam::{DQuat, DVec3};
use model::{Axes, BodyId, BodyKind, JointId, Mount, Pose};
use numbers::Float;
use sim::{Effort, Outputs, Simulation};

/// A world as it is now.
#[derive(Clone, Copy)]
pub(crate) struct Look<'a, T: Float> {
    pub simulation: &'a Simulation<T>,
    pub outputs: &'a Outputs<'a, T>,
    pub world: usize,
}

/// Numbers, written one after the other.
struct Writer<'a, T>(std::slice::IterMut<'a, T>);

impl<T: Float> Writer<'_, T> {
    fn number(&mut self, x: f64) {
        if let Some(to) = self.0.next() {
            *to = T::from_f64(x);
        }
    }
    fn vector(&mut self, v: DVec3) {
        v.to_array().into_iter().for_each(|x| self.number(x));
    }
    fn quaternion(&mut self, q: DQuat) {
        q.to_array().into_iter().for_each(|x| self.number(x));
    }
}

impl<'a, T: Float> Look<'a, T> {
    fn effort(&self) -> Effort<'a, T> {
        Effort {
            simulation: self.simulation,
            outputs: self.outputs,
            world: self.world,
        }
    }
    /// Fills `numbers` with what a sensor of joints, bodies or contacts measures; contacts of its body
    /// stand in `rows`.
    pub fn measure(&self, kind: &SensorKind, rows: &[usize], numbers: &mut [T]) {
        let mut out = Writer(numbers.iter_mut());
        let model = self.simulation.model();
        match kind {
            SensorKind::JointPosition { joints } => {
                let rows = joints.iter().flat_map(|&j| model.coordinate_range(j));
                rows.for_each(|row| out.number(self.outputs.coordinate(self.world, row)));
            }
            SensorKind::JointVelocity { joints } => {
                let dofs = joints.iter().flat_map(|&j| model.dof_range(j));
                dofs.for_each(|dof| out.number(self.outputs.dof_velocity(self.world, dof)));
            }
            SensorKind::JointEffort { joints } => {
                for &joint in joints {
                    self.effort().of_joint(joint, |force| out.number(force));
                }
            }
            SensorKind::ActuatorForce { actuators } => {
                let forces = actuators.iter().map(|&row| self.effort().of_actuator(row));
                forces.for_each(|force| out.number(force));
            }
            SensorKind::Imu { mount } => self.imu(mount, &mut out),
            SensorKind::ForceTorque { joint, frame } => {
                self.force_torque(*joint, frame.as_ref(), &mut out);
            }
            SensorKind::Touch { body } => out.number(self.touch(*body, rows)),
            SensorKind::ContactForce { body, axes } => {
                let turn = self.turn(*axes, || self.pose(*body));
                out.vector(turn * self.contact_force(*body, rows));
            }
            SensorKind::FramePose { mount, relative_to } => {
                let pose = self.placed(relative_to).inverse() * self.placed(mount);
                out.vector(pose.position);
                out.quaternion(pose.orientation);
            }
            SensorKind::FrameVelocity { mount, axes } => {
                let turn = self.turn(*axes, || self.placed(mount));
                let [linear, angular] = self.velocity(mount);
                out.vector(turn * linear);
                out.vector(turn * angular);
            }
            SensorKind::CenterOfMass { body } => out.vector(self.center_of_mass(*body)),
            SensorKind::Rangefinder { .. }
            | SensorKind::Lidar { .. }
            | SensorKind::Camera { .. } => {}
        }
    }

    fn pose(&self, body: BodyId) -> Pose {
        Pose::new(
            self.outputs.body_position(self.world, body),
            self.outputs.body_orientation(self.world, body).normalize(),
        )
    }
    /// Where a mount is.
    pub fn placed(&self, mount: &Mount) -> Pose {
        let carrier = mount.body.map_or(Pose::IDENTITY, |body| self.pose(body));
        carrier * mount.pose
    }
    /// From axes of the world to those asked for.
    fn turn(&self, axes: Axes, own: impl Fn() -> Pose) -> DQuat {
        match axes {
            Axes::World => DQuat::IDENTITY,
            Axes::Own => own().orientation.conjugate(),
        }
    }

    /// A point r from the body's origin moves with v + ω × r.
    fn velocity(&self, mount: &Mount) -> [DVec3; 2] {
        let Some(body) = mount.body else {
            return [DVec3::ZERO; 2];
        };
        let arm = self.pose(body).direction(mount.pose.position);
        let angular = self.outputs.body_angular_velocity(self.world, body);
        let linear = self.outputs.body_velocity(self.world, body);
        [linear + angular.cross(arm), angular]
    }

    /// A point r from the body's origin accelerates with a + α × r + ω × (ω × r).
    fn imu(&self, mount: &Mount, out: &mut Writer<'_, T>) {
        let gravity = self.simulation.world_model(self.world).gravity;
        let to_own = self.placed(mount).orientation.conjugate();
        let (mut acceleration, mut angular) = (DVec3::ZERO, DVec3::ZERO);
        if let Some(body) = mount.body {
            let arm = self.pose(body).direction(mount.pose.position);
            let turning = self.outputs.body_angular_acceleration(self.world, body);
            angular = self.outputs.body_angular_velocity(self.world, body);
            acceleration = self.outputs.body_acceleration(self.world, body)
                + turning.cross(arm)
                + angular.cross(angular.cross(arm));
        }
        out.vector(to_own * (acceleration - gravity));
        out.vector(to_own * angular);
    }

    /// A force f that acts at x has the torque τ + (x − y) × f about y, if τ is that about x.
    fn force_torque(&self, joint: JointId, frame: Option<&Pose>, out: &mut Writer<'_, T>) {
        let joint_of_world = &self.simulation.world_model(self.world).joints[joint.0];
        let child = self.pose(joint_of_world.child);
        let inner = joint_of_world.child_frame;
        let at = child * *frame.unwrap_or(&inner);
        let (force, torque) = self.outputs.reaction(self.world, joint);
        let arm = child.point(inner.position) - at.position;
        let to_own = at.orientation.conjugate();
        out.vector(to_own * force);
        out.vector(to_own * (torque + arm.cross(force)));
    }

    /// C = Σ m c / Σ m, of a body and all that it carries, or of all; where nothing has mass, the body's origin, or
    /// the world's.
    fn center_of_mass(&self, of: Option<BodyId>) -> DVec3 {
        let model = self.simulation.world_model(self.world);
        let mut carried = vec![of.is_none(); model.bodies.len()];
        let (mut mass, mut sum) = (0.0, DVec3::ZERO);
        for &id in model.order() {
            let parent = model.carrier(id).and_then(|j| model.joints[j.0].parent);
            carried[id.0] |= of == Some(id) || parent.is_some_and(|parent| carried[parent.0]);
            let body = &model.bodies[id.0];
            if carried[id.0] && body.kind == BodyKind::Dynamic {
                mass += body.mass;
                sum += body.mass * self.pose(id).point(body.center);
            }
        }
        if mass > 0.0 {
            return sum / mass;
        }
        of.map_or(DVec3::ZERO, |body| self.pose(body).position)
    }

    /// Of each contact of a body: its normal, and its force on the body.
    fn contacts(&self, body: BodyId, rows: &[usize]) -> impl Iterator<Item = (DVec3, DVec3)> {
        let shapes = &self.simulation.model().shapes;
        let now = rows
            .iter()
            .filter_map(|&row| self.outputs.contact(self.world, row));
        now.filter_map(move |contact| {
            let [first, second] = contact.shapes.map(|shape| shapes[shape.0].body);
            let sign = match Some(body) {
                of if of == second => 1.0,
                of if of == first => -1.0,
                _ => return None,
            };
            Some((contact.normal, sign * contact.force))
        })
    }
    fn touch(&self, body: BodyId, rows: &[usize]) -> f64 {
        self.contacts(body, rows)
            .map(|(normal, force)| normal.dot(force).abs())
            .sum()
    }
    fn contact_force(&self, body: BodyId, rows: &[usize]) -> DVec3 {
        self.contacts(body, rows).map(|(_, force)| force).sum()
    }
}
