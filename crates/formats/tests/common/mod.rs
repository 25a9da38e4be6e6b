//! What tests against MuJoCo share: forward kinematics, and numbers out of JSON.

use glam::{DQuat, DVec3};
use model::{Axis, AxisKind, BodyId, JointKind, Model, Pose};
use serde_json::Value;

pub const TOLERANCE: f64 = 1e-6;

/// MuJoCo's qpos with quaternions as x y z w.
pub fn coordinates(model: &Model, qpos: &Value) -> Vec<f64> {
    let mut q: Vec<f64> = qpos.as_array().unwrap().iter().map(number).collect();
    let mut start = 0;
    for joint in &model.joints {
        match joint.kind {
            JointKind::Free => q[start + 3..start + 7].rotate_left(1),
            JointKind::Ball => q[start..start + 4].rotate_left(1),
            _ => {}
        }
        start += joint.coordinates();
    }
    q
}

/// Forward kinematics, straight from the definition of joints and axes.
pub fn poses(model: &Model, q: &[f64]) -> Vec<Pose> {
    let mut poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
    for id in model.order() {
        let Some(carrier) = model.carrier(*id) else {
            continue;
        };
        let joint = &model.joints[carrier.0];
        let q = &q[model.coordinate_range(carrier)];
        let parent = joint
            .parent
            .map_or(Pose::IDENTITY, |BodyId(row)| poses[row]);
        let motion = match joint.kind {
            JointKind::Ball => Pose::new(DVec3::ZERO, DQuat::from_slice(q)),
            JointKind::Free => Pose::new(DVec3::from_slice(q), DQuat::from_slice(&q[3..])),
            _ => joint
                .axes
                .iter()
                .zip(q)
                .fold(Pose::IDENTITY, |t, (axis, q)| t * step(axis, *q)),
        };
        poses[id.0] = parent * joint.parent_frame * motion * joint.child_frame.inverse();
    }
    poses
}

fn step(axis: &Axis, q: f64) -> Pose {
    let by = q - axis.reference;
    match axis.kind {
        AxisKind::Linear => Pose::at(axis.direction * by),
        AxisKind::Angular => {
            let turn = Pose::new(DVec3::ZERO, DQuat::from_axis_angle(axis.direction, by));
            Pose::at(axis.anchor) * turn * Pose::at(-axis.anchor)
        }
    }
}

pub fn close(value: f64, expected: f64, what: &str) {
    let error = (value - expected).abs();
    assert!(
        error <= TOLERANCE * expected.abs().max(1e-30),
        "{what}: {value}, not {expected}"
    );
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

pub fn vector(value: &Value) -> DVec3 {
    DVec3::new(number(&value[0]), number(&value[1]), number(&value[2]))
}

/// MuJoCo's w x y z.
pub fn quaternion(value: &Value) -> DQuat {
    DQuat::from_xyzw(
        number(&value[1]),
        number(&value[2]),
        number(&value[3]),
        number(&value[0]),
    )
}
