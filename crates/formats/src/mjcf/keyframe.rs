//! `<keyframe>` (XML reference, "keyframe"): named states.

use super::actuator::Motors;
use super::joint::Kind;
use super::tree::{Tree, taken};
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::DQuat;
use model::Keyframe;
use std::collections::HashSet;

const KNOWN: &[&str] = &["name", "time", "qpos", "qvel", "ctrl"];
const UNUSED: &[(&str, &str)] = &[
    ("act", "there are no activations"),
    ("mpos", "mocap bodies are static"),
    ("mquat", "mocap bodies are static"),
    ("plastic", "springs do not yield"),
];

/// Reads all keyframes into the tree's table.
pub(super) fn read(
    root: &Element,
    tree: &mut Tree,
    motors: &Motors,
    report: &mut Report,
) -> Result<(), FormatError> {
    let mut names = HashSet::new();
    for key in root
        .children_named("keyframe")
        .flat_map(|section| &section.children)
    {
        if key.name != "key" {
            return Err(key.invalid("a keyframe section holds keys only", "write <key …/>"));
        }
        report.check_attributes(key, KNOWN, UNUSED)?;
        if key.number("time")?.unwrap_or(0.0) != 0.0 {
            report.note(key, "attribute `time`", "simulations start at 0");
        }
        let name = key.get("name").unwrap_or_default();
        if !name.is_empty() && !names.insert(name) {
            return Err(taken(key, "keyframe", name));
        }
        let keyframe = Keyframe {
            name: name.to_owned(),
            joint_position: positions(key, tree)?,
            joint_velocity: velocities(key, tree)?,
            control: controls(key, motors)?,
        };
        tree.parts.keyframes.push(keyframe);
    }
    Ok(())
}

/// The numbers of an attribute; those that are missing stay as they are by default.
fn filled(key: &Element, name: &str, mut default: Vec<f64>) -> Result<Vec<f64>, FormatError> {
    let given = key.list(name, 0, default.len())?.unwrap_or_default();
    default[..given.len()].copy_from_slice(&given);
    Ok(default)
}

fn positions(key: &Element, tree: &Tree) -> Result<Vec<f64>, FormatError> {
    let initial = tree.joints.iter().flat_map(|joint| {
        let coordinates = &tree.parts.joints[joint.joint.0].initial;
        // Joints that share a body have one coordinate each.
        let mut own = coordinates[joint.dof..][..joint.file.kind.coordinates()].to_vec();
        rotate_quaternion(joint.file.kind, &mut own, |q| q.rotate_right(1));
        own
    });
    let mut positions = filled(key, "qpos", initial.collect())?;
    let mut rest = &mut positions[..];
    for joint in &tree.joints {
        let (own, after) = rest.split_at_mut(joint.file.kind.coordinates());
        rotate_quaternion(joint.file.kind, own, |q| q.rotate_left(1));
        normalize_quaternion(key, joint.file.kind, own)?;
        rest = after;
    }
    Ok(positions)
}

/// The quaternion among a joint's coordinates.
fn quaternion(kind: Kind, coordinates: &mut [f64]) -> &mut [f64] {
    match kind {
        Kind::Free => &mut coordinates[3..],
        Kind::Ball => coordinates,
        Kind::Slide | Kind::Hinge => &mut [],
    }
}

/// Brings the quaternion's numbers into another order: w x y z in the file, x y z w in the model.
fn rotate_quaternion(kind: Kind, coordinates: &mut [f64], rotate: fn(&mut [f64])) {
    let quaternion = quaternion(kind, coordinates);
    if !quaternion.is_empty() {
        rotate(quaternion);
    }
}

fn normalize_quaternion(
    key: &Element,
    kind: Kind,
    coordinates: &mut [f64],
) -> Result<(), FormatError> {
    let quaternion = quaternion(kind, coordinates);
    if quaternion.is_empty() {
        return Ok(());
    }
    let q = DQuat::from_slice(quaternion);
    if q.length() < 1e-14 {
        let remedy = "write 1 0 0 0 for no rotation";
        return Err(key.invalid_attribute("qpos", "has a quaternion of length zero", remedy));
    }
    quaternion.copy_from_slice(&q.normalize().to_array());
    Ok(())
}

fn velocities(key: &Element, tree: &Tree) -> Result<Vec<f64>, FormatError> {
    let count = tree
        .joints
        .iter()
        .map(|joint| joint.file.kind.degrees_of_freedom())
        .sum();
    filled(key, "qvel", vec![0.0; count])
}

/// Controls of the actuators that are in the model.
fn controls(key: &Element, motors: &Motors) -> Result<Vec<f64>, FormatError> {
    let all = filled(key, "ctrl", vec![0.0; motors.kept.len()])?;
    let kept = all.into_iter().zip(&motors.kept).filter(|(_, kept)| **kept);
    Ok(kept.map(|(control, _)| control).collect())
}
