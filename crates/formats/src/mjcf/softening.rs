//! What depends on the inertia that a degree of freedom shows: limits, `springdamper`, `dampratio`.

use super::Context;
use super::actuator::Motors;
use super::joint::Kind;
use super::option::Physics;
use super::tree::{Tree, TreeJoint};
use crate::joint_space::JointSpace;
use model::Joint;

/// Fills in limits, springs and dampers of the joints, and the damping of position servos.
pub(super) fn apply(tree: &mut Tree, motors: &Motors, space: &JointSpace, context: &Context<'_>) {
    let wanted = |j: &&TreeJoint| j.file.range.is_some() || j.file.spring_damper.is_some();
    for joint in tree.joints.iter().filter(wanted) {
        let of_model = &mut tree.parts.joints[joint.joint.0];
        soften(joint, of_model, space, &context.physics);
    }
    for (actuator, ratio) in &motors.damping_ratios {
        // Critical damping of stiffness k and mass m is 2 √(k m); m as the actuator sees it.
        let actuator = &mut tree.parts.actuators[*actuator];
        let critical = match actuator.gear {
            0.0 => 0.0,
            gear => {
                let m = space.effective_inertia(actuator.joint.0, actuator.dof) / gear.powi(2);
                2.0 * (actuator.gain * m).max(0.0).sqrt()
            }
        };
        actuator.bias[2] = -ratio * critical;
    }
}

fn soften(joint: &TreeJoint, of_model: &mut Joint, space: &JointSpace, physics: &Physics) {
    let n = joint.file.kind.degrees_of_freedom();
    let dofs = joint.dof..joint.dof + n;
    let inertias = dofs
        .clone()
        .map(|dof| space.effective_inertia(joint.joint.0, dof));
    let inertia = inertias.sum::<f64>() / n as f64;
    for dof in &mut of_model.dofs[dofs] {
        if let Some(range) = joint.file.range {
            let least_time = physics.least_time();
            dof.limit = Some(joint.file.softness.limit(range, inertia, least_time));
        }
        let Some([tc, ratio]) = joint.file.spring_damper else {
            continue;
        };
        if physics.on("damper") {
            // Actuators have damping of their own.
            dof.damping += 2.0 * inertia / tc;
        }
        if physics.on("spring") && matches!(joint.file.kind, Kind::Hinge | Kind::Slide) {
            dof.stiffness = inertia / (tc * tc * ratio * ratio);
        }
    }
}
