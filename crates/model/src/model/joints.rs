//! What a joint must fulfil.

use super::check::Subject;
use crate::{Axis, AxisKind, Body, BodyId, BodyKind, Dof, Drive, Joint, JointKind, ModelError};
use glam::DVec3;

/// Checks one joint against the bodies.
pub(super) fn joint(joint: &Joint, bodies: &[Body]) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "joint",
        name: &joint.name,
    };
    ends(&subject, joint, bodies)?;
    subject.pose("parent frame", &joint.parent_frame)?;
    subject.pose("child frame", &joint.child_frame)?;
    subject.not_negative("length [m]", joint.length)?;
    subject.not_negative("linear compliance [m/N]", joint.linear_compliance)?;
    subject.not_negative("angular compliance [rad/(N·m)]", joint.angular_compliance)?;
    axes(joint)?;
    joint.axes.iter().try_for_each(|a| axis(&subject, a))?;
    subject.length(
        "table of degrees of freedom",
        joint.dofs.len(),
        dofs(joint),
        "",
    )?;
    joint.dofs.iter().try_for_each(|d| dof(d, joint))?;
    initial(&subject, joint)
}

fn ends(subject: &Subject, joint: &Joint, bodies: &[Body]) -> Result<(), ModelError> {
    subject.row("child body", joint.child.0, bodies.len())?;
    let child = &bodies[joint.child.0];
    if child.kind == BodyKind::Static {
        return Err(ModelError::StaticChild {
            joint: joint.name.clone(),
            body: child.name.clone(),
        });
    }
    let Some(BodyId(parent)) = joint.parent else {
        return Ok(());
    };
    subject.row("parent body", parent, bodies.len())?;
    if parent == joint.child.0 {
        return Err(ModelError::ParentIsChild {
            joint: joint.name.clone(),
            body: child.name.clone(),
        });
    }
    let parent_world = bodies[parent].world;
    if parent_world != -1 && parent_world != child.world {
        return Err(ModelError::AcrossWorlds {
            joint: joint.name.clone(),
            parent_world,
            child_world: child.world,
        });
    }
    Ok(())
}

fn axes(joint: &Joint) -> Result<(), ModelError> {
    let linear = joint
        .axes
        .iter()
        .filter(|a| a.kind == AxisKind::Linear)
        .count();
    let angular = joint.axes.len() - linear;
    let (fits, needs) = match joint.kind {
        JointKind::Revolute => (
            (linear, angular) == (0, 1),
            "needs exactly one angular axis",
        ),
        JointKind::Prismatic => ((linear, angular) == (1, 0), "needs exactly one linear axis"),
        JointKind::D6 => (
            (1..=6).contains(&joint.axes.len()) && linear <= 3 && angular <= 3,
            "needs 1 to 6 axes, at most 3 linear and at most 3 angular",
        ),
        JointKind::PlaneXz => (
            (linear, angular) == (2, 1),
            "needs two linear axes and an angular one",
        ),
        JointKind::Fixed | JointKind::Ball | JointKind::Free | JointKind::Distance => {
            (joint.axes.is_empty(), "takes no axes")
        }
    };
    if !fits {
        let (joint, kind) = (joint.name.clone(), joint.kind);
        return Err(ModelError::WrongAxes {
            joint,
            kind,
            needs,
            linear,
            angular,
        });
    }
    if joint.kind == JointKind::PlaneXz {
        let agrees = |(a, b): (&Axis, &Axis)| a.kind == b.kind && a.direction == b.direction;
        if !joint.axes.iter().zip(&Joint::plane_xz_axes()).all(agrees) {
            return Err(ModelError::WrongPlane {
                joint: joint.name.clone(),
            });
        }
    }
    independent(joint)
}

/// Refuses neighbours among the axes that are one line, unless an armature tells how each of them moves.
fn independent(joint: &Joint) -> Result<(), ModelError> {
    const PARALLEL: f64 = 1e-9;
    for (first, pair) in joint.axes.windows(2).enumerate() {
        let [a, b] = [&pair[0], &pair[1]];
        let armed = joint.dofs.iter().skip(first).take(2);
        let armed = joint.dofs.is_empty() || armed.into_iter().any(|dof| dof.armature > 0.0);
        let across = |v: DVec3| a.direction.cross(v).length();
        let turn_apart = a.kind == AxisKind::Angular && across(b.anchor - a.anchor) > PARALLEL;
        if a.kind == b.kind && across(b.direction) < PARALLEL && !armed && !turn_apart {
            return Err(ModelError::SameAxis {
                joint: joint.name.clone(),
                first,
                second: first + 1,
            });
        }
    }
    Ok(())
}

fn axis(subject: &Subject, axis: &Axis) -> Result<(), ModelError> {
    subject.unit("axis direction", axis.direction)?;
    subject.all_finite("axis anchor [m]", &axis.anchor.to_array())?;
    subject.finite("axis reference", axis.reference)
}

/// Degrees of freedom that the kind and its axes ask for, also where the joint closes a loop.
fn dofs(joint: &Joint) -> usize {
    match joint.kind {
        JointKind::Ball => 3,
        JointKind::Free => 6,
        _ => joint.axes.len(),
    }
}

fn dof(dof: &Dof, joint: &Joint) -> Result<(), ModelError> {
    let subject = Subject {
        kind: "degree of freedom",
        name: &dof.name,
    };
    subject.not_negative("armature", dof.armature)?;
    subject.not_negative("damping", dof.damping)?;
    subject.not_negative("stiffness", dof.stiffness)?;
    subject.finite("rest", dof.rest)?;
    subject.not_negative("friction loss", dof.friction_loss)?;
    if let Some(limit) = dof.limit {
        subject.range("limit", (limit.lower, limit.upper))?;
        subject.not_negative("limit stiffness", limit.stiffness)?;
        subject.not_negative("limit damping", limit.damping)?;
        subject.not_negative("limit inertia", limit.inertia)?;
    }
    drive(&subject, &dof.drive)?;
    let drives = dof.drive.stiffness > 0.0 || dof.drive.damping > 0.0;
    if joint.closes_loop {
        let laws = [
            (drives, "drive"),
            (dof.stiffness > 0.0, "spring"),
            (dof.damping > 0.0, "damping"),
            (dof.limit.is_some(), "limit"),
            (dof.armature > 0.0, "armature"),
            (dof.friction_loss > 0.0, "friction"),
        ];
        if let Some((_, what)) = laws.into_iter().find(|(acts, _)| *acts) {
            return Err(ModelError::ClosingJointTakesNo {
                joint: joint.name.clone(),
                what,
            });
        }
    }
    if joint.kind == JointKind::Free {
        let what = if drives {
            Some("drive")
        } else {
            dof.limit.map(|_| "limit")
        };
        if let Some(what) = what {
            return Err(ModelError::FreeJointTakesNo {
                joint: joint.name.clone(),
                what,
            });
        }
    }
    Ok(())
}

fn drive(subject: &Subject, drive: &Drive) -> Result<(), ModelError> {
    subject.not_negative("drive stiffness", drive.stiffness)?;
    subject.not_negative("drive damping", drive.damping)?;
    subject.finite("drive target position", drive.target_position)?;
    subject.finite("drive target velocity", drive.target_velocity)?;
    if drive.effort_limit != f64::INFINITY {
        subject.not_negative("drive effort limit", drive.effort_limit)?;
    }
    subject.not_negative("drive control time [s]", drive.control_time)
}

fn initial(subject: &Subject, joint: &Joint) -> Result<(), ModelError> {
    // A joint that closes a loop has no coordinates; initial ones do no harm there.
    if !joint.closes_loop {
        let needed = joint.coordinates();
        subject.length(
            "list of initial coordinates",
            joint.initial.len(),
            needed,
            "",
        )?;
    }
    subject.all_finite("initial coordinate", &joint.initial)?;
    quaternion(subject, joint, &joint.initial)
}

/// Checks the quaternion among the coordinates of a ball or free joint.
pub(super) fn quaternion(subject: &Subject, joint: &Joint, q: &[f64]) -> Result<(), ModelError> {
    match (joint.kind, q) {
        (JointKind::Ball, q @ [_, _, _, _]) | (JointKind::Free, [_, _, _, q @ ..]) => {
            subject.rotation("coordinates", q)
        }
        _ => Ok(()),
    }
}
