//! What drives, actuators and a controller do along a joint's degrees of freedom.
//!
//! ```text
//! drive      clamp(k (target − q) + d (target velocity − q̇), ± effort limit)
//! ball       the same of vectors: k log(q⁻¹ target) + d (target velocity − ω), shortened to the limit
//! actuator   gear · clamp(gain · u + bias₀ + bias₁ l + bias₂ l̇, force range),   l = gear · q
//! ```
//!
//! These are the laws of [`model::Drive`] and [`model::Actuator`] at the present state. A solver takes
//! them at the end of its step, which is this state: where nothing has been set since, they are what acted
//! in the last substep.

use crate::measure::Look;
use glam::{DQuat, DVec3};
use model::{Actuator, AxisKind, Joint, JointId, JointKind};
use numbers::Float;
use std::f64::consts::TAU;

/// Calls `take` with the force of each degree of freedom of a joint [N or N·m], in their order.
pub(crate) fn effort<T: Float>(look: &Look<'_, T>, id: JointId, mut take: impl FnMut(f64)) {
    let model = look.simulation.world_model(look.world);
    let joint = &model.joints[id.0];
    let ball = ball_drive(look, joint, id).to_array();
    for (axis, dof) in model.dof_range(id).enumerate() {
        let speed = look.outputs.dof_velocity(look.world, dof);
        let value = value(look, joint, id, axis);
        let drive = match joint.kind {
            JointKind::Ball => ball[axis],
            JointKind::Free => 0.0,
            _ => drive(look, joint, axis, dof, [value, speed]),
        };
        let actuators = model.actuators.iter().enumerate();
        let forces = actuators
            .filter(|(_, a)| a.joint == id && a.dof == axis)
            .map(|(row, a)| {
                let control = look.simulation.inputs().control(look.world, row);
                a.gear * actuator(a, control, [value, speed])
            });
        let applied = look.simulation.inputs().force(look.world, dof);
        take(applied + drive + forces.sum::<f64>());
    }
}

/// The force of an actuator before its gear [N or N·m].
pub(crate) fn actuator_force<T: Float>(look: &Look<'_, T>, row: usize) -> f64 {
    let model = look.simulation.world_model(look.world);
    let a = &model.actuators[row];
    let value = value(look, &model.joints[a.joint.0], a.joint, a.dof);
    let dof = model.dof_range(a.joint).start + a.dof;
    let speed = look.outputs.dof_velocity(look.world, dof);
    let control = look.simulation.inputs().control(look.world, row);
    actuator(a, control, [value, speed])
}

/// The coordinate of a degree of freedom. Rotations of balls and free joints have none, and their servos no
/// position term.
fn value<T: Float>(look: &Look<'_, T>, joint: &Joint, id: JointId, axis: usize) -> f64 {
    let shifts = joint.kind == JointKind::Free && axis < 3;
    if shifts || axis < joint.axes.len() {
        let row = look.simulation.model().coordinate_range(id).start + axis;
        look.outputs.coordinate(look.world, row)
    } else {
        0.0
    }
}

/// Of an axis, at its value and speed.
fn drive<T: Float>(
    look: &Look<'_, T>,
    joint: &Joint,
    axis: usize,
    dof: usize,
    [value, speed]: [f64; 2],
) -> f64 {
    let law = &joint.dofs[axis];
    let inputs = look.simulation.inputs();
    let mut error = inputs.target(look.world, dof) - value;
    let endless = law.limit.is_none() && law.stiffness == 0.0;
    if endless && joint.axes[axis].kind == AxisKind::Angular {
        // Whole turns between value and target do not count.
        error -= TAU * (error / TAU).round();
    }
    let d = &law.drive;
    let wanted = inputs.target_velocity(look.world, dof) - speed;
    (d.stiffness * error + d.damping * wanted).clamp(-d.effort_limit, d.effort_limit)
}

/// Of a ball joint; of others nothing.
fn ball_drive<T: Float>(look: &Look<'_, T>, joint: &Joint, id: JointId) -> DVec3 {
    if joint.kind != JointKind::Ball {
        return DVec3::ZERO;
    }
    let model = look.simulation.model();
    let (q, dof) = (model.coordinate_range(id).start, model.dof_range(id).start);
    let inputs = look.simulation.inputs();
    let along = |of: &dyn Fn(usize) -> f64| DVec3::new(of(dof), of(dof + 1), of(dof + 2));
    let target = DQuat::from_scaled_axis(along(&|i| inputs.target(look.world, i)));
    let target_velocity = along(&|i| inputs.target_velocity(look.world, i));
    let speed = along(&|i| look.outputs.dof_velocity(look.world, i));
    let now = [0, 1, 2, 3].map(|i| look.outputs.coordinate(look.world, q + i));
    let error = DQuat::from_array(now).normalize().conjugate() * target;
    let error = if error.w < 0.0 { -error } else { error };
    let d = &joint.dofs[0].drive;
    let force = d.stiffness * error.to_scaled_axis() + d.damping * (target_velocity - speed);
    force.clamp_length_max(d.effort_limit)
}

/// Of an actuator with this control, at its coordinate's value and speed, before its gear.
fn actuator(a: &Actuator, control: f64, [value, speed]: [f64; 2]) -> f64 {
    let within = |x: f64, range: Option<(f64, f64)>| match range {
        Some((low, high)) => x.clamp(low, high),
        None => x,
    };
    let control = within(control, a.control_range);
    let [constant, position, velocity] = a.bias;
    let force = a.gain * control + constant + a.gear * (position * value + velocity * speed);
    within(force, a.force_range)
}
