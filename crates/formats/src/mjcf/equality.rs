//! `<equality>` (XML reference, "equality"): joints that close a loop, couplings, and joints that are held.

use super::Context;
use super::hold;
use super::joint::Kind;
use super::tree::{Tree, TreeJoint, taken};
use crate::error::FormatError;
use crate::joint_space::JointSpace;
use crate::names::Taken;
use crate::report::Report;
use crate::xml::Element;
use glam::DVec3;
use model::{BodyId, Coupling, Joint, JointId, JointKind, Pose};
use std::collections::HashSet;

pub(super) const KNOWN: &[&str] = &[
    "name", "class", "active", "body1", "body2", "anchor", "site1", "site2", "relpose", "joint1",
    "joint2", "polycoef",
];
pub(super) const UNUSED: &[(&str, &str)] = &[
    ("solref", "the constraint is rigid"),
    ("solimp", "the constraint is rigid"),
    ("torquescale", "the constraint is rigid"),
];

/// One end of a constraint: a body, or the world, and a frame in it.
type End = (Option<BodyId>, Pose);

/// Reads all equality constraints into the tree's joints and couplings.
pub(super) fn read(
    root: &Element,
    tree: &mut Tree,
    space: &JointSpace,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let mut names = HashSet::new();
    let mut joints = Taken::by(tree.parts.joints.iter().map(|joint| &joint.name));
    for element in root
        .children_named("equality")
        .flat_map(|section| &section.children)
    {
        if !context.physics.on("equality") {
            report.note(element, "equality", "left out, for its flag is off");
            continue;
        }
        let kind = element.name.as_str();
        let merged = context.defaults.apply(element, None, &["equality"])?;
        let active = merged.truth("active")? != Some(false);
        if !["connect", "weld", "joint"].contains(&kind) {
            if !active {
                note_inactive(element, report);
                continue;
            }
            let remedy = "remove it, or use connect, weld or joint";
            report.refuse(
                element,
                &format!("an equality constraint of kind {kind}"),
                remedy,
            )?;
            continue;
        }
        let holds = kind == "joint" && !merged.has("joint2");
        match holds {
            true => report.check_attributes(&merged, &[KNOWN, hold::KNOWN].concat(), hold::UNUSED),
            false => report.check_attributes(&merged, KNOWN, UNUSED),
        }?;
        let name = merged.get("name").unwrap_or_default();
        if !name.is_empty() && !names.insert(name.to_owned()) {
            return Err(taken(&merged, "equality constraint", name));
        }
        match kind {
            "joint" if holds => hold_joint(&merged, active, tree, space, context, report)?,
            "joint" => couple(&merged, active, tree, report)?,
            _ => close_loop(&merged, active, &mut joints, tree, report)?,
        }
    }
    Ok(())
}

fn note_inactive(element: &Element, report: &mut Report) {
    report.note(element, "inactive constraint", "left out");
}

/// A constraint may have the name of a joint of the file, and has a number behind it then.
fn close_loop(
    element: &Element,
    active: bool,
    joints: &mut Taken,
    tree: &mut Tree,
    report: &mut Report,
) -> Result<(), FormatError> {
    let (kind, (one, two)) = match element.name.as_str() {
        "connect" => (JointKind::Ball, connect_ends(element, tree)?),
        _ => (JointKind::Fixed, weld_ends(element, tree)?),
    };
    if one.0 == two.0 {
        let remedy = "name two different bodies";
        return Err(element.invalid("it ties a body to itself", remedy));
    }
    let ((parent, parent_frame), (child, child_frame)) = if tree.moves(two.0) {
        (one, two)
    } else {
        (two, one)
    };
    let Some(child) = child.filter(|_| tree.moves(child)) else {
        report.note(
            element,
            "constraint",
            "left out, for neither of its bodies moves",
        );
        return Ok(());
    };
    let mut name = String::new();
    if let Some(wish) = element.get("name").filter(|wish| !wish.is_empty()) {
        joints.fill(&mut name, wish);
    }
    let mut joint = Joint::new(name, kind, parent, child, Vec::new());
    joint.dofs.iter_mut().for_each(|dof| dof.name.clear());
    (joint.parent_frame, joint.child_frame) = (parent_frame, child_frame);
    joint.closes_loop = true;
    joint.bodies_collide = true;
    joint.enabled = active;
    tree.parts.joints.push(joint);
    Ok(())
}

/// Sites may be given instead of bodies.
fn site_ends(element: &Element, tree: &Tree) -> Result<Option<(End, End)>, FormatError> {
    if element.has("site1") || element.has("site2") {
        return Ok(Some((
            tree.site(element, "site1")?,
            tree.site(element, "site2")?,
        )));
    }
    Ok(None)
}

/// The second body; without one, the world.
fn second_body(element: &Element, tree: &Tree) -> Result<Option<BodyId>, FormatError> {
    match element.has("body2") {
        true => tree.body(element, "body2"),
        false => Ok(None),
    }
}

/// The anchor is given in the first body; in the second it is where it is at the start.
fn connect_ends(element: &Element, tree: &Tree) -> Result<(End, End), FormatError> {
    if let Some(((one, a), (two, b))) = site_ends(element, tree)? {
        return Ok(((one, Pose::at(a.position)), (two, Pose::at(b.position))));
    }
    let (one, two) = (tree.body(element, "body1")?, second_body(element, tree)?);
    element.require("anchor")?;
    let frame = Pose::at(element.vector("anchor")?.unwrap_or(DVec3::ZERO));
    let seen = tree.pose(two).inverse() * tree.pose(one) * frame;
    Ok(((one, frame), (two, seen)))
}

/// `relpose` is the pose of the second body's anchor frame in the first body; without it the bodies
/// stay as they are at the start.
fn weld_ends(element: &Element, tree: &Tree) -> Result<(End, End), FormatError> {
    if let Some(ends) = site_ends(element, tree)? {
        return Ok(ends);
    }
    let (one, two) = (tree.body(element, "body1")?, second_body(element, tree)?);
    let frame = Pose::at(element.vector("anchor")?.unwrap_or(DVec3::ZERO));
    let relative = element
        .numbers::<7>("relpose")?
        .filter(|p| p[3..].iter().any(|x| *x != 0.0));
    let seen = match relative {
        Some([x, y, z, a, b, c, d]) => {
            let turn = super::orientation::from_quat(element, "relpose", [a, b, c, d])?;
            Pose::new(DVec3::new(x, y, z), turn)
        }
        None => tree.pose(one).inverse() * tree.pose(two) * frame,
    };
    Ok(((one, seen), (two, frame)))
}

/// y − y₀ = a₀: a joint alone.
fn hold_joint(
    element: &Element,
    active: bool,
    tree: &mut Tree,
    space: &JointSpace,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let [a0, ..] = polynomial(element)?;
    let held = one_axis(element, "joint1", tree)?;
    if !active {
        note_inactive(element, report);
        return Ok(());
    }
    let (joint, row) = (held.joint.0, held.dof);
    let (value, inertia) = (
        held.file.reference + a0,
        space.effective_inertia(joint, row),
    );
    let dof = &mut tree.parts.joints[joint].dofs[row];
    hold::at(element, value, inertia, &context.physics, dof)
}

/// y − y₀ = a₀ + a₁ (x − x₀): a coupling of two joints.
fn couple(
    element: &Element,
    active: bool,
    tree: &mut Tree,
    report: &mut Report,
) -> Result<(), FormatError> {
    let [a0, a1, higher @ ..] = polynomial(element)?;
    let follower = one_axis(element, "joint1", tree)?;
    let leader = one_axis(element, "joint2", tree)?;
    if !active {
        note_inactive(element, report);
        return Ok(());
    }
    if higher != [0.0; 3] {
        let remedy = "keep the first two coefficients only";
        return report.refuse(element, "a relation that is not linear", remedy);
    }
    let alone = |joint: &TreeJoint| tree.parts.joints[joint.joint.0].axes.len() == 1;
    if !alone(follower) || !alone(leader) {
        let feature = "a relation of a joint that shares its body with others";
        return report.refuse(element, feature, "put each joint on a body of its own");
    }
    let (y0, x0) = (follower.file.reference, leader.file.reference);
    let (joint, other): (JointId, JointId) = (follower.joint, leader.joint);
    let name = element.get("name").unwrap_or_default().to_owned();
    let offset = y0 + a0 - a1 * x0;
    tree.parts.couplings.push(Coupling {
        name,
        joint,
        other,
        ratio: a1,
        offset,
    });
    Ok(())
}

/// The hinge or slide that an attribute names.
fn one_axis<'a>(
    element: &Element,
    attribute: &str,
    tree: &'a Tree,
) -> Result<&'a TreeJoint, FormatError> {
    let joint = tree.joint(element, attribute)?;
    if !matches!(joint.file.kind, Kind::Hinge | Kind::Slide) {
        let remedy = "name a hinge or a slide";
        return Err(element.invalid_attribute(attribute, "names a ball or free joint", remedy));
    }
    Ok(joint)
}

fn polynomial(element: &Element) -> Result<[f64; 5], FormatError> {
    let mut coefficients = [0.0, 1.0, 0.0, 0.0, 0.0];
    let given = element.list("polycoef", 1, 5)?.unwrap_or_default();
    coefficients
        .iter_mut()
        .zip(given)
        .for_each(|(own, new)| *own = new);
    Ok(coefficients)
}
