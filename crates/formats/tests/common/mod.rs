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

/// The pairs of shapes that may touch are MuJoCo's, and so are their friction, margin and softness.
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
        let solref = refsafe(solref, 2.0 * model.time_step);
        let mass = number(&contact["mass"]);
        compare_softness(material.softness, mass, solref, &contact["solimp"], &what);
    }
}

/// Time constants are no shorter than two steps.
pub fn refsafe([first, second]: [f64; 2], least_time: f64) -> [f64; 2] {
    let first = if first > 0.0 {
        first.max(least_time)
    } else {
        first
    };
    [first, second]
}

pub fn impedances(solimp: &Value) -> [f64; 2] {
    [0, 1].map(|i| number(&solimp[i]).clamp(1e-4, 0.9999))
}

/// Stiffness and damping of what holds a unit of inertia with the impedance d, and d:
/// f = d / (1 − d) (d k r + b v) with k = 1 / (dmax T ζ)² and b = 2 / (dmax T), or
/// k = −solref₀ / dmax² and b = −solref₁ / dmax.
pub fn law(solref: [f64; 2], most: f64, d: f64) -> (f64, f64, f64) {
    let (k, b) = match solref {
        [time, ratio] if time > 0.0 => ((most * time * ratio).powi(-2), 2.0 / (most * time)),
        [k, b] => (-k / (most * most), -b / most),
    };
    let share = d / (1.0 - d);
    (share * d * k, share * b, d)
}

/// MuJoCo's law at the impedance that was taken, one of those that the contact has.
fn compare_softness(softness: Softness, mass: f64, solref: [f64; 2], solimp: &Value, what: &str) {
    // Of bodies that only slide, MuJoCo leaves out the armature, which is all that weightless ones have.
    if mass < 1e-4 {
        return;
    }
    let Softness::Time { impedance, .. } = softness else {
        panic!("{what}: {softness:?}")
    };
    let [least, most] = impedances(solimp);
    assert!((least..=most).contains(&impedance), "{what}: {impedance}");
    let (k, b, d) = law(solref, most, impedance);
    let whole = 3.0;
    // MuJoCo's contacts are rigid where the centre of mass cannot move; here they hold the whole mass.
    let mass = if mass < 1e9 { mass } else { whole };
    let (stiffness, damping) = softness.spring(whole);
    close(stiffness, mass * k, what);
    close(damping, mass * b, what);
    close(softness.added_mass(whole), mass * d / (1.0 - d), what);
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
