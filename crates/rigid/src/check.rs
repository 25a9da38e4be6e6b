//! What no solver here can simulate, and so refuses rather than leave out.

use crate::SolverError;
use model::{AxisKind, Dof, Drive, Joint, JointKind, Model};

/// Which of a joint's axes are linear, and which angular, for a solver that takes them in this order and
/// meeting in a point.
pub(crate) fn axes(
    joint: &Joint,
    solver: &'static str,
) -> Result<(Vec<usize>, Vec<usize>), SolverError> {
    let of = |kind| -> Vec<usize> {
        let axes = joint.axes.iter().enumerate();
        axes.filter(|(_, axis)| axis.kind == kind)
            .map(|(i, _)| i)
            .collect()
    };
    let (linear, angular) = (of(AxisKind::Linear), of(AxisKind::Angular));
    let refuse = |what, remedy| {
        let name = joint.name.clone();
        Err(SolverError::Unsupported {
            solver,
            what,
            name,
            remedy,
        })
    };
    let early = |l: &usize| angular.first().is_some_and(|a| a < l);
    if linear.iter().any(early) {
        return refuse(
            "a linear axis after an angular one",
            "order them linear first, or use the solver `featherstone`",
        );
    }
    let anchors: Vec<_> = angular.iter().map(|&i| joint.axes[i].anchor).collect();
    if anchors.iter().any(|a| a.distance(anchors[0]) > 1e-12) {
        return refuse(
            "axes that do not meet",
            "split the joint, or use the solver `featherstone`",
        );
    }
    Ok((linear, angular))
}

/// Refuses laws along single rotations of joints that turn in any direction.
pub(crate) fn rotations(model: &Model, solver: &'static str) -> Result<(), SolverError> {
    for joint in model.joints.iter().filter(|j| !j.closes_loop) {
        if let Some(what) = unlawful(joint) {
            let (name, remedy) = (joint.name.clone(), "use a d6 joint with three angular axes");
            return Err(SolverError::Unsupported {
                solver,
                what,
                name,
                remedy,
            });
        }
    }
    let servo = |a: &&model::Actuator| {
        a.bias[1] != 0.0 && turning(&model.joints[a.joint.0]).contains(&a.dof)
    };
    if let Some(actuator) = model.actuators.iter().find(servo) {
        return Err(SolverError::Unsupported {
            solver,
            what: "a position servo on a ball or free joint",
            name: actuator.name.clone(),
            remedy: "use the drive of a ball joint, or a d6 joint with three angular axes",
        });
    }
    Ok(())
}

/// The degrees of freedom that have no coordinate of their own, but share a quaternion.
fn turning(joint: &Joint) -> std::ops::Range<usize> {
    match joint.kind {
        JointKind::Ball => 0..3,
        JointKind::Free => 3..6,
        _ => 0..0,
    }
}

fn unlawful(joint: &Joint) -> Option<&'static str> {
    let dofs = &joint.dofs[turning(joint)];
    if dofs.iter().any(|d| d.stiffness > 0.0) {
        return Some("a spring on the rotations of a ball or free joint");
    }
    if dofs.iter().any(|d| d.limit.is_some()) {
        return Some("limits of a ball joint");
    }
    let gains = |d: &Dof| {
        let Drive {
            stiffness,
            damping,
            effort_limit,
            control_time,
            ..
        } = d.drive;
        [stiffness, damping, effort_limit, control_time]
    };
    let unlike = dofs.windows(2).any(|d| gains(&d[0]) != gains(&d[1]));
    unlike.then_some("drives that differ between the axes of a ball joint")
}
