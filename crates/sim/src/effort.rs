//! What drives, actuators and a controller do along a joint's degrees of freedom.
//!
//! ```text
//! drive      clamp(k (target − q) + d (target velocity − q̇), ± effort limit)
//! ball       the same of vectors: k log(q⁻¹ target) + d (target velocity − ω), shortened to the limit
//! actuator   gear · clamp(gain · u + bias₀ + bias₁ l + bias₂ l̇, force range),   l = gear · q
//! ```
//!
//! These are the laws of [`model::Drive`] and [`model::Actuator`] at the present state, with as much of k, and of gain, bias₀ and
//! bias₁ of an actuator that has a bias₁, as the solver takes: by `impulse` joints that share a body are no stiffer than small
//! steps resolve. A solver takes what damps at the end of its step, which is this state, and springs at a share of the way
//! there (`docs/concepts/solvers.md`, Springs): what acted in the last substep differs by up to h k q̇, with the k that acts.
//! Drives that follow their targets with a lag ([`model::Drive::control_time`]), which only a solver knows, are taken to be
//! there.

use crate::{Outputs, Simulation};
use glam::{DQuat, DVec3};
use model::{Actuator, Joint, JointId, JointKind};
use numbers::Float;
use std::f64::consts::TAU;

/// What acts along the degrees of freedom of a world now.
#[derive(Clone, Copy, Debug)]
pub struct Effort<'a, T: Float> {
    /// The simulation.
    pub simulation: &'a Simulation<T>,
    /// Its outputs.
    pub outputs: &'a Outputs<'a, T>,
    /// Which world.
    pub world: usize,
}

impl<T: Float> Effort<'_, T> {
    /// Calls `take` with the force of each degree of freedom of a joint [N or N·m], in their order: that of its
    /// drive, of its actuators, and what was set.
    pub fn of_joint(&self, id: JointId, mut take: impl FnMut(f64)) {
        let model = self.simulation.world_model(self.world);
        let ball = self.ball_drive(id).to_array();
        for (axis, dof) in model.dof_range(id).enumerate() {
            let drive = match model.joints[id.0].kind {
                JointKind::Ball => ball[axis],
                _ => self.axis_drive(id, axis),
            };
            let actuators = model.actuators.iter().enumerate();
            let forces = actuators
                .filter(|(_, a)| a.joint == id && a.dof == axis)
                .map(|(row, a)| a.gear * self.of_actuator(row));
            let applied = self.simulation.inputs().force(self.world, dof);
            take(applied + drive + forces.sum::<f64>());
        }
    }

    /// The force of the drive of a joint's degree of freedom [N or N·m].
    pub fn of_drive(&self, id: JointId, axis: usize) -> f64 {
        match self.simulation.model().joints[id.0].kind {
            JointKind::Ball => self.ball_drive(id)[axis],
            _ => self.axis_drive(id, axis),
        }
    }

    /// The force of an actuator before its gear [N or N·m].
    pub fn of_actuator(&self, row: usize) -> f64 {
        let model = self.simulation.world_model(self.world);
        let a = &model.actuators[row];
        let value = self.value(&model.joints[a.joint.0], a.joint, a.dof);
        let dof = model.dof_range(a.joint).start + a.dof;
        let speed = self.outputs.dof_velocity(self.world, dof);
        let control = self.simulation.inputs().control(self.world, row);
        let pulls = a.bias[1] != 0.0;
        let acts = if pulls { self.acting(dof) } else { 1.0 };
        actuator(a, acts, control, [value, speed])
    }

    /// The share of the stiffness along a degree of freedom that acts.
    fn acting(&self, dof: usize) -> f64 {
        self.simulation.compiled(self.world).acting[dof]
    }

    /// The coordinate of a degree of freedom. Rotations of balls and free joints have none, and their servos no
    /// position term.
    fn value(&self, joint: &Joint, id: JointId, axis: usize) -> f64 {
        let shifts = joint.kind == JointKind::Free && axis < 3;
        if shifts || axis < joint.axes.len() {
            let row = self.simulation.model().coordinate_range(id).start + axis;
            self.outputs.coordinate(self.world, row)
        } else {
            0.0
        }
    }

    /// Of an axis of a joint that is no ball; none where it is free or closes a loop.
    fn axis_drive(&self, id: JointId, axis: usize) -> f64 {
        let model = self.simulation.world_model(self.world);
        let joint = &model.joints[id.0];
        if joint.kind == JointKind::Free || joint.closes_loop {
            return 0.0;
        }
        let (law, dof) = (&joint.dofs[axis], model.dof_range(id).start + axis);
        let inputs = self.simulation.inputs();
        let mut error = inputs.target(self.world, dof) - self.value(joint, id, axis);
        if model.turns_without_end(id, axis) {
            // Whole turns between value and target do not count.
            error -= TAU * (error / TAU).round();
        }
        let d = &law.drive;
        let speed = self.outputs.dof_velocity(self.world, dof);
        let wanted = inputs.target_velocity(self.world, dof) - speed;
        let stiffness = self.acting(dof) * d.stiffness;
        (stiffness * error + d.damping * wanted).clamp(-d.effort_limit, d.effort_limit)
    }

    /// Of a ball joint; of others nothing, nor of one that closes a loop, which has no coordinates.
    fn ball_drive(&self, id: JointId) -> DVec3 {
        let joint = &self.simulation.world_model(self.world).joints[id.0];
        if joint.kind != JointKind::Ball || joint.closes_loop {
            return DVec3::ZERO;
        }
        let model = self.simulation.model();
        let (q, dof) = (model.coordinate_range(id).start, model.dof_range(id).start);
        let inputs = self.simulation.inputs();
        let along = |of: &dyn Fn(usize) -> f64| DVec3::new(of(dof), of(dof + 1), of(dof + 2));
        let target = DQuat::from_scaled_axis(along(&|i| inputs.target(self.world, i)));
        let target_velocity = along(&|i| inputs.target_velocity(self.world, i));
        let speed = along(&|i| self.outputs.dof_velocity(self.world, i));
        let now = [0, 1, 2, 3].map(|i| self.outputs.coordinate(self.world, q + i));
        let error = DQuat::from_array(now).normalize().conjugate() * target;
        let error = if error.w < 0.0 { -error } else { error };
        let d = &joint.dofs[0].drive;
        let stiffness = d.stiffness * along(&|i| self.acting(i));
        let force = stiffness * error.to_scaled_axis() + d.damping * (target_velocity - speed);
        force.clamp_length_max(d.effort_limit)
    }
}

/// Of an actuator of which so much acts, but for what damps, with this control, at its coordinate's value and speed, before its
/// gear.
fn actuator(a: &Actuator, acts: f64, control: f64, [value, speed]: [f64; 2]) -> f64 {
    let within = |x: f64, range: Option<(f64, f64)>| match range {
        Some((low, high)) => x.clamp(low, high),
        None => x,
    };
    let control = within(control, a.control_range);
    let [constant, position, velocity] = a.bias;
    let spring = a.gain * control + constant + a.gear * position * value;
    let force = acts * spring + a.gear * velocity * speed;
    within(force, a.force_range)
}
