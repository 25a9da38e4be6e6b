//! What a model adds to its parts: free joints, order, starts, placements, names.

use glam::{DQuat, DVec3};
use kinetarium_model::examples::{CHAIN_LENGTH, Start, chain, n_pendula};
use kinetarium_model::{
    Axis, Body, BodyId, BodyKind, Coupling, Joint, JointId, JointKind, Model, Parts, Pose,
};
use std::f64::consts::FRAC_PI_2;

fn hinge(name: &str, parent: Option<usize>, child: usize) -> Joint {
    let axes = vec![Axis::angular(DVec3::Z)];
    Joint::new(
        name,
        JointKind::Revolute,
        parent.map(BodyId),
        BodyId(child),
        axes,
    )
}

fn model(bodies: &[&str], joints: Vec<Joint>) -> Model {
    let bodies = bodies.iter().map(|&name| Body::new(name)).collect();
    Model::new(Parts {
        bodies,
        joints,
        ..Parts::default()
    })
    .unwrap()
}

#[track_caller]
fn assert_at(pose: Pose, position: DVec3, orientation: DQuat) {
    assert!(
        pose.position.abs_diff_eq(position, 1e-12),
        "{} is not {position}",
        pose.position
    );
    let aligned = pose.orientation.dot(orientation).abs();
    assert!(
        (aligned - 1.0).abs() < 1e-12,
        "{} is not {orientation}",
        pose.orientation
    );
}

#[test]
fn loose_dynamic_bodies_get_free_joints() {
    let pose = Pose::new(DVec3::new(1.0, 2.0, 3.0), DQuat::from_rotation_x(0.5));
    let bodies = vec![
        Body {
            kind: BodyKind::Static,
            ..Body::new("floor")
        },
        Body {
            pose,
            ..Body::new("stone")
        },
        Body::new("link"),
    ];
    let joints = vec![hinge("hinge", None, 2)];
    let model = Model::new(Parts {
        bodies,
        joints,
        ..Parts::default()
    })
    .unwrap();
    assert_eq!(model.joints.len(), 2);
    let free = &model.joints[1];
    assert_eq!(
        (free.name.as_str(), free.kind, free.child),
        ("stone_free", JointKind::Free, BodyId(1))
    );
    assert_eq!(free.parent_frame, Pose::IDENTITY);
    assert_eq!(model.carrier(BodyId(0)), None);
    assert_eq!(model.carrier(BodyId(1)), Some(JointId(1)));
    assert_eq!(model.carrier(BodyId(2)), Some(JointId(0)));
    assert_at(model.bodies[1].pose, pose.position, pose.orientation);
    assert_eq!((model.coordinates(), model.degrees_of_freedom()), (8, 7));
    assert_eq!(model.coordinate_range(JointId(1)), 1..8);
    assert_eq!(model.dof_range(JointId(1)), 1..7);
    let q = pose.orientation;
    assert_eq!(
        model.initial_position(),
        [0.0, 1.0, 2.0, 3.0, q.x, q.y, q.z, q.w]
    );
}

#[test]
fn names_of_free_joints_avoid_those_taken() {
    let model = model(&["a", "b"], vec![hinge("a_free", None, 1)]);
    assert_eq!(model.joints[1].name, "a_free_");
    let other = hinge("a_free_3", None, 1);
    assert_eq!(
        self::model(&["a", "b"], vec![other]).joints[1].name,
        "a_free_"
    );
}

#[test]
fn a_remade_model_is_the_same() {
    let first = model(&["a", "b"], vec![hinge("hinge", Some(0), 1)]);
    assert_eq!(Model::new(first.clone().into_parts()).unwrap(), first);
}

#[test]
fn parents_come_first_and_all_else_stays() {
    let joints = vec![hinge("0", Some(3), 0), hinge("1", Some(2), 3)];
    let ids = |model: &Model| model.order().iter().map(|b| b.0).collect::<Vec<_>>();
    assert_eq!(ids(&model(&["a", "b", "c", "d"], joints)), [2, 3, 0, 1]);
    assert_eq!(ids(&model(&["a", "b", "c"], vec![])), [0, 1, 2]);
}

#[test]
fn joints_that_close_a_loop_have_no_coordinates() {
    let mut strut = hinge("strut", None, 1);
    strut.closes_loop = true;
    let model = model(
        &["a", "b"],
        vec![strut, hinge("0", None, 0), hinge("1", Some(0), 1)],
    );
    assert_eq!((model.coordinates(), model.degrees_of_freedom()), (2, 2));
    assert_eq!(model.coordinate_range(JointId(0)), 0..0);
    assert_eq!(model.carrier(BodyId(1)), Some(JointId(2)));
    assert_eq!(model.coordinate_names(), ["0", "1"]);
    assert_eq!(model.loops(), ["joint \"strut\" closing a loop"]);
    assert!(!model.is_tree());
}

#[test]
fn distance_joints_carry_nothing() {
    let rope = |name: &str| Joint::new(name, JointKind::Distance, None, BodyId(0), vec![]);
    let model = model(&["a"], vec![rope("left"), rope("right")]);
    assert_eq!(model.carrier(BodyId(0)), Some(JointId(2)));
    assert_eq!(model.joints[2].kind, JointKind::Free);
    assert_eq!(
        model.loops(),
        ["distance joint \"left\"", "distance joint \"right\""]
    );
}

#[test]
fn couplings_make_it_no_tree() {
    let mut parts = model(
        &["a", "b"],
        vec![hinge("0", None, 0), hinge("1", Some(0), 1)],
    )
    .into_parts();
    assert!(Model::new(parts.clone()).unwrap().is_tree());
    let (joint, other) = (JointId(1), JointId(0));
    parts.couplings.push(Coupling {
        name: "mimic".into(),
        joint,
        other,
        ratio: 1.0,
        offset: 0.0,
    });
    assert_eq!(Model::new(parts).unwrap().loops(), ["coupling \"mimic\""]);
}

#[test]
fn names_of_coordinates_and_velocities() {
    let ball = Joint::new("shoulder", JointKind::Ball, None, BodyId(0), vec![]);
    let mut planar = Joint::new(
        "slide",
        JointKind::PlaneXz,
        Some(BodyId(0)),
        BodyId(1),
        Joint::plane_xz_axes(),
    );
    planar.dofs[2].name = "yaw".into();
    let model = model(
        &["a", "b", "c"],
        vec![ball, planar, hinge("elbow", Some(1), 2)],
    );
    let orientation = ["x", "y", "z", "w"].map(|axis| format!("shoulder_orientation_{axis}"));
    let names = model.coordinate_names();
    assert_eq!(names[..4], orientation);
    assert_eq!(names[4..], ["slide_0", "slide_1", "yaw", "elbow"]);
    let dofs: Vec<_> = model.dof_names().collect();
    let expected = [
        "shoulder_0",
        "shoulder_1",
        "shoulder_2",
        "slide_0",
        "slide_1",
        "yaw",
        "elbow",
    ];
    assert_eq!(dofs, expected);
    assert_eq!(model.dof("yaw").unwrap(), 5);
    assert_eq!(model.joint("elbow").unwrap(), JointId(2));
    assert_eq!(model.body("c").unwrap(), BodyId(2));
    let free = self::model(&["a"], vec![]).coordinate_names();
    assert_eq!(free[2..4], ["a_free_position_z", "a_free_orientation_x"]);
}

#[test]
fn axes_act_in_turn() {
    // Turn by 90° about z, then slide 2 along the turned x, which is y.
    let axes = vec![Axis::angular(DVec3::Z), Axis::linear(DVec3::X)];
    let mut joint = Joint::new("d6", JointKind::D6, None, BodyId(0), axes);
    joint.initial = vec![FRAC_PI_2, 2.0];
    let turned = DQuat::from_rotation_z(FRAC_PI_2);
    assert_at(
        model(&["a"], vec![joint.clone()]).bodies[0].pose,
        DVec3::new(0.0, 2.0, 0.0),
        turned,
    );
    // The other way round, slide first: 2 along x, then turn in place.
    joint.axes.reverse();
    joint.initial.reverse();
    assert_at(
        model(&["a"], vec![joint]).bodies[0].pose,
        DVec3::new(2.0, 0.0, 0.0),
        turned,
    );
}

#[test]
fn an_anchor_stays_where_it_is_and_references_are_subtracted() {
    let mut joint = hinge("hinge", None, 0);
    joint.axes[0].anchor = DVec3::new(1.0, 0.0, 0.0);
    joint.axes[0].reference = 0.3;
    joint.initial = vec![0.3 + FRAC_PI_2];
    let pose = model(&["a"], vec![joint]).bodies[0].pose;
    assert_at(
        pose,
        DVec3::new(1.0, -1.0, 0.0),
        DQuat::from_rotation_z(FRAC_PI_2),
    );
}

#[test]
fn frames_and_parents_place_the_child() {
    let mut first = hinge("0", None, 0);
    first.parent_frame = Pose::at(DVec3::new(0.0, 5.0, 0.0));
    first.child_frame = Pose::at(DVec3::new(0.0, 1.0, 0.0));
    first.initial = vec![FRAC_PI_2];
    let mut second = hinge("1", Some(0), 1);
    second.parent_frame = Pose::at(DVec3::new(0.0, -1.0, 0.0));
    second.child_frame = Pose::at(DVec3::new(0.0, 1.0, 0.0));
    second.initial = vec![-FRAC_PI_2];
    let model = model(&["a", "b"], vec![first, second]);
    assert_at(
        model.bodies[0].pose,
        DVec3::new(1.0, 5.0, 0.0),
        DQuat::from_rotation_z(FRAC_PI_2),
    );
    assert_at(
        model.bodies[1].pose,
        DVec3::new(2.0, 4.0, 0.0),
        DQuat::IDENTITY,
    );
}

#[test]
fn what_stands_still_has_no_mass() {
    let model = Model::new(Parts::default()).unwrap();
    assert!(model.total_mass() == 0.0 && model.total_mass().is_sign_positive());
}

#[test]
fn chains_start_as_asked() {
    let towards = [
        (Start::Hanging, DVec3::NEG_Y),
        (Start::Horizontal, DVec3::X),
        (Start::Upright, DVec3::Y),
    ];
    for links in [1, 2, 30] {
        for (start, direction) in towards {
            let model = chain(links, start).unwrap();
            let length = CHAIN_LENGTH / links as f64;
            assert_eq!(model.degrees_of_freedom(), links);
            assert!((model.total_mass() - links as f64).abs() < 1e-12);
            assert!(model.is_tree());
            for (i, body) in model.bodies.iter().enumerate() {
                let center = (i as f64 + 0.5) * length * direction;
                assert!(body.pose.position.abs_diff_eq(center, 1e-12));
            }
        }
    }
    assert_eq!(n_pendula(4).unwrap(), chain(4, Start::Horizontal).unwrap());
}
