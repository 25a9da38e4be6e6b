//! What tests against MuJoCo share: forward kinematics, contacts, and numbers out of JSON.

use glam::{DQuat, DVec3};
use model::{Axis, AxisKind, BodyId, CollisionFilter, JointKind, Model, Pose, Softness};
use serde_json::Value;

pub const TOLERANCE: f64 = 1e-6;

/// MuJoCo's qpos with quaternions as x y z w.
pub fn coordinates(model: &Model, qpos: &Value) -> Vec<f64> {
    let mut q: Vec<f64> = qpos.as_array().unwrap().iter().map(number).collect();
    let mut start = 0;
    for joint in &model.joints {
        match joint.kind {
            JointKind::Free => q[start + 3..start + 7].rotate_left(1),
            JointKind::Ball if !joint.closes_loop => q[start..start + 4].rotate_left(1),
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

/// The pairs of shapes that may touch are MuJoCo's, and so are their friction and softness.
pub fn compare_contacts(model: &Model, reference: &Value, path: &str) {
    let row = |value: &Value| value.as_u64().expect("a row") as usize;
    let contacts = reference["contacts"].as_array().expect("contacts");
    let expected: Vec<_> = contacts
        .iter()
        .map(|c| (row(&c["geoms"][0]), row(&c["geoms"][1])))
        .collect();
    let pairs: Vec<_> = CollisionFilter::new(model).pairs().collect();
    let rows: Vec<_> = pairs.iter().map(|(a, b)| (a.0, b.0)).collect();
    assert_eq!(rows, expected, "{path}");
    for ((a, b), contact) in pairs.iter().zip(contacts) {
        let material = model.contact_material(*a, *b);
        let what = format!("{path}, shapes {} and {}", a.0, b.0);
        close(material.friction, number(&contact["friction"][0]), &what);
        let torsional = number(&contact["friction"][1]);
        close(material.torsional_friction, torsional, &what);
        close(
            material.rolling_friction,
            number(&contact["friction"][2]),
            &what,
        );
        close(material.margin, number(&contact["margin"]), &what);
        let solref = [0, 1].map(|i| number(&contact["solref"][i]));
        compare_softness(material.softness, solref, 2.0 * model.time_step, &what);
    }
}

/// k = 1 / (T² ζ²) and b = 2 / T, or k and b themselves with a minus.
fn compare_softness(softness: Softness, solref: [f64; 2], least_time: f64, what: &str) {
    let (k, b) = match solref {
        [time, ratio] if time > 0.0 => {
            let time = time.max(least_time);
            (1.0 / (time * ratio).powi(2), 2.0 / time)
        }
        [k, b] => (-k, -b),
    };
    let (stiffness, damping) = softness.spring(3.0);
    close(stiffness, 3.0 * k, what);
    close(damping, 3.0 * b, what);
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
