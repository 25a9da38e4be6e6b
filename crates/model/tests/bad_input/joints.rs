//! Joints, and what acts on them.

use crate::common::{refuses, sound};
use glam::{DQuat, DVec3};
use kinetarium_model::{Axis, BodyId, Drive, Joint, JointId, JointKind, Limit, Model, ModelError};

/// Hinges side by side, an axis between, and inertia of its own tell how far each of two parallel axes moves.
#[test]
fn parallel_axes_that_are_apart_are_taken() {
    let turn = |anchor: DVec3| {
        let mut axis = Axis::angular(DVec3::Z);
        axis.anchor = anchor;
        axis
    };
    let across = Axis::angular(DVec3::X);
    let refused = |axes: Vec<Axis>, armature: f64| {
        let mut parts = sound();
        parts.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
        parts.joints[0].dofs[1].armature = armature;
        matches!(Model::new(parts), Err(ModelError::SameAxis { .. }))
    };
    let origin = DVec3::ZERO;
    assert!(
        refused(vec![turn(origin), turn(DVec3::Z)], 0.0),
        "the same line"
    );
    assert!(!refused(vec![turn(origin), turn(DVec3::X)], 0.0), "apart");
    assert!(
        !refused(vec![turn(origin), across, turn(origin)], 0.0),
        "with another between"
    );
    assert!(
        !refused(vec![turn(origin), turn(origin)], 0.1),
        "with a mass of its own"
    );
}

#[test]
fn joint_ends() {
    refuses(&[
        (
            |p| p.joints[0].child = BodyId(3),
            "joint \"hinge\": its child body is number 3, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.joints[0].parent = Some(BodyId(9)),
            "joint \"hinge\": its parent body is number 9, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.joints[1].parent = Some(BodyId(2)),
            "joint \"slider\": body \"lower\" is both parent and child; name two different bodies",
        ),
        (
            |p| p.joints[0].child = BodyId(0),
            "joint \"hinge\": its child \"base\" is static; make the body dynamic, or swap parent \
             and child",
        ),
        (
            |p| p.joints[2].closes_loop = false,
            "joint \"strut\": its child \"lower\" already hangs on joint \"slider\"; mark the \
             joint closes_loop, merge the two into one d6 joint, or swap its parent and child",
        ),
        (
            |p| p.joints[0].parent = Some(BodyId(2)),
            "the bodies \"upper\", \"lower\" hang on one another in a circle; mark one of their \
             joints closes_loop",
        ),
    ]);
}

#[test]
fn joint_frames_and_numbers() {
    refuses(&[
        (
            |p| p.joints[0].parent_frame.position.y = f64::NAN,
            "joint \"hinge\": parent frame is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].child_frame.orientation = DQuat::from_xyzw(0.5, 0.0, 0.0, 0.0),
            "joint \"hinge\": quaternion of its child frame has length 0.5; normalise it (1 within 1e-6)",
        ),
        (
            |p| p.joints[0].linear_compliance = -1.0,
            "joint \"hinge\": linear compliance [m/N] is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].angular_compliance = f64::INFINITY,
            "joint \"hinge\": angular compliance [rad/(N·m)] is inf; give a finite number",
        ),
        (
            |p| {
                let mut rope = Joint::new("rope", JointKind::Distance, None, BodyId(1), vec![]);
                rope.length = -0.5;
                p.joints.push(rope);
            },
            "joint \"rope\": length [m] is -0.5; it must not be negative",
        ),
    ]);
}

#[test]
fn axes() {
    refuses(&[
        (
            |p| p.joints[0].axes.clear(),
            "joint \"hinge\": a revolute joint needs exactly one angular axis, but it has 0 linear \
             and 0 angular",
        ),
        (
            |p| p.joints[0].axes = vec![Axis::linear(DVec3::X)],
            "joint \"hinge\": a revolute joint needs exactly one angular axis, but it has 1 linear \
             and 0 angular",
        ),
        (
            |p| p.joints[1].axes = vec![Axis::linear(DVec3::X); 2],
            "joint \"slider\": a prismatic joint needs exactly one linear axis, but it has 2 \
             linear and 0 angular",
        ),
        (
            |p| p.joints[0].kind = JointKind::Ball,
            "joint \"hinge\": a ball joint takes no axes, but it has 0 linear and 1 angular",
        ),
        (
            |p| p.joints[0].kind = JointKind::PlaneXz,
            "joint \"hinge\": a plane_xz joint needs two linear axes and an angular one, but it \
             has 0 linear and 1 angular",
        ),
        (
            |p| {
                let mut axes = Joint::plane_xz_axes();
                axes.swap(0, 1);
                p.joints[0] = Joint::new("hinge", JointKind::PlaneXz, None, BodyId(1), axes);
            },
            "joint \"hinge\": the axes of a plane_xz joint are linear x, linear z and angular y, \
             in this order; use Joint::plane_xz_axes and turn the joint frames instead",
        ),
        (
            |p| {
                let axes = vec![Axis::angular(DVec3::X); 4];
                p.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
            },
            "joint \"hinge\": a d6 joint needs 1 to 6 axes, at most 3 linear and at most 3 \
             angular, but it has 0 linear and 4 angular",
        ),
        (
            |p| {
                let axes = [DVec3::X, DVec3::Z, -DVec3::Z].map(Axis::angular).to_vec();
                p.joints[0] = Joint::new("hinge", JointKind::D6, None, BodyId(1), axes);
            },
            "joint \"hinge\": its axes 1 and 2 are the same line, so that nothing tells how far each of them moves: \
             leave one out, or give one an armature",
        ),
        (
            |p| p.joints[0].axes[0].direction = DVec3::new(1.0, 1.0, 0.0),
            "joint \"hinge\": axis direction has length 1.4142135623730951; normalise it (1 within \
             1e-6)",
        ),
        (
            |p| p.joints[0].axes[0].direction = DVec3::ZERO,
            "joint \"hinge\": axis direction has length zero and so no direction; give one, such \
             as (0, 1, 0)",
        ),
        (
            |p| p.joints[0].axes[0].anchor.x = f64::NAN,
            "joint \"hinge\": axis anchor [m] is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].axes[0].reference = f64::NAN,
            "joint \"hinge\": axis reference is NaN; give a finite number",
        ),
    ]);
}

#[test]
fn coordinates() {
    refuses(&[
        (
            |p| p.joints[0].dofs.clear(),
            "joint \"hinge\": its table of degrees of freedom has 0 entries; it needs 1",
        ),
        (
            |p| p.joints[0].initial = vec![0.0, 1.0],
            "joint \"hinge\": its list of initial coordinates has 2 entries; it needs 1",
        ),
        (
            |p| p.joints[0].initial[0] = f64::NAN,
            "joint \"hinge\": initial coordinate is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Ball, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.joints[1].initial = vec![0.0; 4];
            },
            "joint \"slider\": quaternion of its coordinates has length zero and so no direction; give one; \
             no rotation is (0, 0, 0, 1)",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Free, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.joints[1].initial[6] = 3.0;
            },
            "joint \"slider\": quaternion of its coordinates has length 3; normalise it (1 within 1e-6)",
        ),
    ]);
}

#[test]
fn degrees_of_freedom() {
    refuses(&[
        (
            |p| p.joints[0].dofs[0].stiffness = -1.0,
            "degree of freedom \"hinge\": stiffness is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].damping = -1.0,
            "degree of freedom \"hinge\": damping is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].armature = f64::NAN,
            "degree of freedom \"hinge\": armature is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].dofs[0].friction_loss = -1.0,
            "degree of freedom \"hinge\": friction loss is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].rest = f64::INFINITY,
            "degree of freedom \"hinge\": rest is inf; give a finite number",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: 1.0,
                    upper: -1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": the lower end of its limit, 1, is above the upper end, \
             -1; swap them",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: -1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": limit stiffness is -1; it must not be negative",
        ),
        (
            |p| {
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: f64::NAN,
                };
                p.joints[0].dofs[0].limit = Some(limit);
            },
            "degree of freedom \"hinge\": limit inertia is NaN; give a finite number",
        ),
        (
            |p| p.joints[0].dofs[0].drive.effort_limit = -1.0,
            "degree of freedom \"hinge\": drive effort limit is -1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].drive.control_time = -0.1,
            "degree of freedom \"hinge\": drive control time [s] is -0.1; it must not be negative",
        ),
        (
            |p| p.joints[0].dofs[0].drive.target_position = f64::NAN,
            "degree of freedom \"hinge\": drive target position is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[0] = Joint::new("hinge", JointKind::Free, None, BodyId(1), vec![]);
                p.couplings.clear();
                p.joints[0].dofs[2].drive = Drive {
                    damping: 1.0,
                    ..Drive::default()
                };
            },
            "joint \"hinge\": a free joint takes no drive; remove it, or use a d6 joint",
        ),
        (
            |p| {
                p.joints[0] = Joint::new("hinge", JointKind::Free, None, BodyId(1), vec![]);
                p.couplings.clear();
                let limit = Limit {
                    lower: -1.0,
                    upper: 1.0,
                    stiffness: 1.0,
                    damping: 1.0,
                    inertia: 0.0,
                };
                p.joints[0].dofs[2].limit = Some(limit);
            },
            "joint \"hinge\": a free joint takes no limit; remove it, or use a d6 joint",
        ),
    ]);
}

#[test]
fn couplings_and_actuators() {
    refuses(&[
        (
            |p| p.couplings[0].joint = JointId(5),
            "coupling \"gears\": its joint is number 5, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.couplings[0].ratio = f64::NAN,
            "coupling \"gears\": ratio is NaN; give a finite number",
        ),
        (
            |p| p.couplings[0].other = JointId(0),
            "coupling \"gears\": joint \"hinge\" both leads and follows; name two different joints",
        ),
        (
            |p| p.joints[1] = Joint::new("slider", JointKind::Fixed, None, BodyId(2), vec![]),
            "coupling \"gears\": joint \"slider\" has 0 axes; couple joints with exactly one",
        ),
        (
            |p| p.actuators[0].joint = JointId(5),
            "actuator \"motor\": its joint is number 5, but the model has 3, numbered from 0; \
             use a number below 3",
        ),
        (
            |p| p.actuators[0].dof = 1,
            "actuator \"motor\": joint \"hinge\" has 1 degrees of freedom in the state, numbered \
             from 0, so not number 1; choose another",
        ),
        (
            |p| p.actuators[0].joint = JointId(2),
            "actuator \"motor\": joint \"strut\" has 0 degrees of freedom in the state, numbered \
             from 0, so not number 0; choose another joint, for this one closes a loop",
        ),
        (
            |p| p.actuators[0].gear = f64::NAN,
            "actuator \"motor\": gear is NaN; give a finite number",
        ),
        (
            |p| p.actuators[0].control_range = Some((1.0, 0.0)),
            "actuator \"motor\": the lower end of its control range, 1, is above the upper end, 0; \
             swap them",
        ),
        (
            |p| p.actuators[0].force_range = Some((0.0, f64::NAN)),
            "actuator \"motor\": force range is NaN; give a finite number",
        ),
    ]);
}
