//! `<joint>` (urdf/XML/joint).

use super::tree::{Connection, Tree, TreeJoint};
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::{DQuat, DVec3};
use model::{Axis, BodyId, Coupling, Dof, Drive, Joint, JointId, JointKind, Parts, Pose};

/// The kinds of joint of URDF.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Revolute,
    Continuous,
    Prismatic,
    Fixed,
    Floating,
    Planar,
}

impl Kind {
    pub fn of(joint: &Element) -> Result<Self, FormatError> {
        joint.require("type")?;
        let words = [
            "revolute",
            "continuous",
            "prismatic",
            "fixed",
            "floating",
            "planar",
        ];
        Ok(match joint.word("type", &words)? {
            Some("revolute") => Self::Revolute,
            Some("continuous") => Self::Continuous,
            Some("prismatic") => Self::Prismatic,
            Some("floating") => Self::Floating,
            Some("planar") => Self::Planar,
            _ => Self::Fixed,
        })
    }
}

/// The joint of the model, and the range of its coordinate if it has one.
pub(super) fn read(
    connection: &Connection,
    ends: (Option<BodyId>, BodyId),
    report: &mut Report,
) -> Result<(Joint, Option<(f64, f64)>), FormatError> {
    let element = connection.element;
    report.check_attributes(element, &["name", "type"], &[])?;
    let direction = axis(connection, report)?;
    let (kind, axes, turn) = match connection.kind {
        Kind::Revolute | Kind::Continuous => (
            JointKind::Revolute,
            vec![Axis::angular(direction)],
            DQuat::IDENTITY,
        ),
        Kind::Prismatic => (
            JointKind::Prismatic,
            vec![Axis::linear(direction)],
            DQuat::IDENTITY,
        ),
        Kind::Fixed => (JointKind::Fixed, Vec::new(), DQuat::IDENTITY),
        Kind::Floating => (JointKind::Free, Vec::new(), DQuat::IDENTITY),
        Kind::Planar => {
            let turn = DQuat::from_rotation_arc(DVec3::Y, direction);
            (JointKind::PlaneXz, Joint::plane_xz_axes(), turn)
        }
    };
    let mut joint = Joint::new(element.require("name")?, kind, ends.0, ends.1, axes);
    joint.parent_frame = connection.origin * Pose::new(DVec3::ZERO, turn);
    joint.child_frame = Pose::new(DVec3::ZERO, turn);
    for dof in &mut joint.dofs {
        dynamics(element, dof, report)?;
    }
    let range = limit(connection, &mut joint, report)?;
    Ok((joint, range))
}

fn axis(connection: &Connection, report: &mut Report) -> Result<DVec3, FormatError> {
    let needed = !matches!(connection.kind, Kind::Fixed | Kind::Floating);
    let Some(axis) = connection.element.child("axis").filter(|_| needed) else {
        return Ok(DVec3::X);
    };
    report.check_attributes(axis, &["xyz"], &[])?;
    let vector = axis.vector("xyz")?.unwrap_or(DVec3::X);
    if vector.length() < 1e-9 {
        let remedy = "write a vector that is not zero";
        return Err(axis.invalid_attribute("xyz", "has no direction", remedy));
    }
    Ok(vector.normalize())
}

fn dynamics(joint: &Element, dof: &mut Dof, report: &mut Report) -> Result<(), FormatError> {
    let Some(dynamics) = joint.child("dynamics") else {
        return Ok(());
    };
    report.check_attributes(dynamics, &["damping", "friction"], &[])?;
    dof.damping = dynamics.non_negative("damping")?.unwrap_or(0.0);
    dof.friction_loss = dynamics.non_negative("friction")?.unwrap_or(0.0);
    Ok(())
}

/// Effort limits the drive; velocity is noted.
fn limit(
    connection: &Connection,
    joint: &mut Joint,
    report: &mut Report,
) -> Result<Option<(f64, f64)>, FormatError> {
    let element = connection.element;
    let bounded = matches!(connection.kind, Kind::Revolute | Kind::Prismatic);
    let Some(limit) = element.child("limit") else {
        if bounded {
            let remedy = "add <limit lower=… upper=… effort=… velocity=…/>, or make the joint \
                          continuous";
            return Err(element.invalid("a revolute or prismatic joint needs a limit", remedy));
        }
        return Ok(None);
    };
    let unused = [("velocity", "the velocity is not limited")];
    report.check_attributes(limit, &["lower", "upper", "effort"], &unused)?;
    if let (Some(effort), [dof]) = (limit.non_negative("effort")?, &mut joint.dofs[..]) {
        dof.drive = Drive {
            effort_limit: effort,
            ..Drive::default()
        };
        if effort == 0.0 {
            report.note(limit, "effort 0", "the joint's drive exerts no force");
        }
    }
    if !bounded {
        return Ok(None);
    }
    let lower = limit.number("lower")?.unwrap_or(0.0);
    let upper = limit.number("upper")?.unwrap_or(0.0);
    if lower > upper {
        return Err(limit.invalid_attribute(
            "lower",
            &format!("is {lower}, above the upper end {upper}"),
            "swap them",
        ));
    }
    Ok(Some((lower, upper)))
}

/// What has no coordinate follows nothing, whether the joint is in the model or not.
pub(super) fn note_fixed_follower(joint: &Element, report: &mut Report) {
    if let Some(mimic) = joint.child("mimic") {
        let meaning = "left out, for such a joint does not move";
        report.note(mimic, "mimic of a fixed joint", meaning);
    }
}

/// `mimic`: this joint's coordinate is multiplier · the other's + offset.
pub(super) fn couple(
    tree: &Tree,
    parts: &mut Parts,
    report: &mut Report,
) -> Result<(), FormatError> {
    for follower in &tree.joints {
        let moves = parts.joints[follower.id.0].kind != JointKind::Fixed;
        let Some(mimic) = follower.element.child("mimic").filter(|_| moves) else {
            continue;
        };
        report.check_attributes(mimic, &["joint", "multiplier", "offset"], &[])?;
        let leader = leader(mimic, follower, tree)?;
        let axes = |id: JointId| parts.joints[id.0].axes.len();
        if axes(follower.id) != 1 || axes(leader.id) != 1 {
            let remedy = "use it between revolute, continuous and prismatic joints";
            return Err(mimic.invalid("both joints need exactly one axis", remedy));
        }
        parts.couplings.push(Coupling {
            name: follower.element.require("name")?.to_owned(),
            joint: follower.id,
            other: leader.id,
            ratio: mimic.number("multiplier")?.unwrap_or(1.0),
            offset: mimic.number("offset")?.unwrap_or(0.0),
        });
    }
    Ok(())
}

fn leader<'a>(
    mimic: &Element,
    follower: &TreeJoint,
    tree: &'a Tree<'a>,
) -> Result<&'a TreeJoint<'a>, FormatError> {
    let name = mimic.require("joint")?;
    let leader = tree
        .joints
        .iter()
        .find(|joint| joint.element.get("name") == Some(name));
    let problem = match leader {
        Some(leader) if leader.id != follower.id => return Ok(leader),
        Some(_) => format!("names `{name}`, the joint itself"),
        None => format!("names `{name}`, but no moving joint has this name"),
    };
    Err(mimic.invalid_attribute("joint", &problem, "name another joint"))
}
