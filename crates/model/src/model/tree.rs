//! Which joint carries which body, and where the bodies therefore stand.

use crate::{Body, BodyId, BodyKind, Joint, JointId, JointKind, ModelError, Parts, Pose};
use std::collections::HashSet;

/// For each body, the joint that carries it: the first that names it as its child.
///
/// Joints that close a loop carry nothing, and neither do distance joints: they have no
/// coordinates that could say where the body is.
pub(super) fn carriers(parts: &Parts) -> Result<Vec<Option<JointId>>, ModelError> {
    let mut carrier: Vec<Option<JointId>> = vec![None; parts.bodies.len()];
    for (index, joint) in parts.joints.iter().enumerate() {
        if joint.closes_loop || joint.kind == JointKind::Distance {
            continue;
        }
        if let Some(first) = carrier[joint.child.0] {
            return Err(ModelError::SecondCarrier {
                joint: joint.name.clone(),
                first: parts.joints[first.0].name.clone(),
                body: parts.bodies[joint.child.0].name.clone(),
            });
        }
        carrier[joint.child.0] = Some(JointId(index));
    }
    Ok(carrier)
}

/// Gives a free joint, from the world, to every dynamic body that nothing carries.
pub(super) fn free_the_rest(parts: &mut Parts, carrier: &mut [Option<JointId>]) {
    let mut taken: HashSet<String> = parts.joints.iter().map(|j| j.name.clone()).collect();
    taken.extend(
        parts
            .joints
            .iter()
            .flat_map(|j| &j.dofs)
            .map(|d| d.name.clone()),
    );
    for (index, body) in parts.bodies.iter().enumerate() {
        if body.kind == BodyKind::Static || carrier[index].is_some() {
            continue;
        }
        let joint = free_joint(body, BodyId(index), &taken);
        taken.insert(joint.name.clone());
        taken.extend(joint.dofs.iter().map(|d| d.name.clone()));
        carrier[index] = Some(JointId(parts.joints.len()));
        parts.joints.push(joint);
    }
}

fn free_joint(body: &Body, id: BodyId, taken: &HashSet<String>) -> Joint {
    let mut name = format!("{}_free", body.name);
    loop {
        let mut joint = Joint::new(name.as_str(), JointKind::Free, None, id, vec![]);
        let is_taken = |n: &String| taken.contains(n);
        if !is_taken(&joint.name) && !joint.dofs.iter().any(|d| is_taken(&d.name)) {
            joint.initial = coordinates_of(&body.pose);
            return joint;
        }
        name.push('_');
    }
}

/// A placement as the coordinates of a free joint.
fn coordinates_of(pose: &Pose) -> Vec<f64> {
    [
        pose.position.to_array().as_slice(),
        &pose.orientation.to_array(),
    ]
    .concat()
}

/// The bodies, every parent before its children, otherwise as they were given.
pub(super) fn order(parts: &Parts, carrier: &[Option<JointId>]) -> Result<Vec<BodyId>, ModelError> {
    let parent = |b: usize| {
        carrier[b]
            .and_then(|j| parts.joints[j.0].parent)
            .map(|p| p.0)
    };
    let mut order = Vec::with_capacity(parts.bodies.len());
    let mut placed = vec![false; parts.bodies.len()];
    let mut on_path = vec![false; parts.bodies.len()];
    let mut path = Vec::new();
    for body in 0..parts.bodies.len() {
        let mut next = Some(body);
        while let Some(b) = next.filter(|&b| !placed[b]) {
            path.push(b);
            if std::mem::replace(&mut on_path[b], true) {
                return Err(cycle(parts, &path));
            }
            next = parent(b);
        }
        while let Some(b) = path.pop() {
            placed[b] = true;
            order.push(BodyId(b));
        }
    }
    Ok(order)
}

/// The path ends where it met itself.
fn cycle(parts: &Parts, path: &[usize]) -> ModelError {
    let (met, before) = path.split_last().expect("a cycle has a body");
    let start = before.iter().position(|b| b == met).unwrap_or(0);
    let bodies = before[start..]
        .iter()
        .map(|&b| parts.bodies[b].name.clone())
        .collect();
    ModelError::Cycle { bodies }
}

/// Places the bodies by their joints' initial coordinates, parents first:
/// X_child = X_parent · parent_frame · T(q) · child_frame⁻¹.
pub(super) fn place(parts: &mut Parts, carrier: &[Option<JointId>], order: &[BodyId]) {
    for &BodyId(child) in order {
        let Some(id) = carrier[child] else { continue };
        let joint = &parts.joints[id.0];
        let parent = joint
            .parent
            .map_or(Pose::IDENTITY, |p| parts.bodies[p.0].pose);
        let motion = joint.motion(&joint.initial);
        let pose = parent * joint.parent_frame * motion * joint.child_frame.inverse();
        parts.bodies[child].pose = pose;
    }
}

/// Sums before each entry, and the total last.
pub(super) fn starts(counts: impl Iterator<Item = usize>) -> Vec<usize> {
    let mut starts = vec![0];
    starts.extend(counts.scan(0, |sum, n| {
        *sum += n;
        Some(*sum)
    }));
    starts
}
