//! A sound model, and what is said of one that is spoilt.

use glam::DVec3;
use kinetarium_model::{
    Actuator, Axis, Body, BodyId, BodyKind, Camera, CameraMode, Coupling, Geometry, Joint, JointId,
    JointKind, Keyframe, Model, Parts, Pose, Shape,
};

/// A base, two links on a hinge and a slider, a loop to close, and one of everything else.
pub fn sound() -> Parts {
    let base = Body {
        kind: BodyKind::Static,
        ..Body::new("base")
    };
    let bodies = vec![base, Body::new("upper"), Body::new("lower")];
    let joint = |name: &str, kind, parent, child, axis| {
        Joint::new(name, kind, Some(BodyId(parent)), BodyId(child), vec![axis])
    };
    let hinge = joint("hinge", JointKind::Revolute, 0, 1, Axis::angular(DVec3::Z));
    let slider = joint("slider", JointKind::Prismatic, 1, 2, Axis::linear(DVec3::X));
    let mut strut = joint("strut", JointKind::Revolute, 0, 2, Axis::angular(DVec3::Z));
    strut.closes_loop = true;
    Parts {
        name: "machine".into(),
        bodies,
        shapes: vec![Shape {
            body: Some(BodyId(1)),
            ..Shape::new(Geometry::Sphere { radius: 0.1 }).named("knob")
        }],
        joints: vec![hinge, slider, strut],
        couplings: vec![Coupling {
            name: "gears".into(),
            joint: JointId(0),
            other: JointId(1),
            ratio: 2.0,
            offset: 0.0,
        }],
        actuators: vec![Actuator::motor("motor", JointId(0))],
        keyframes: vec![Keyframe {
            name: "home".into(),
            joint_position: vec![0.0; 2],
            joint_velocity: vec![0.0; 2],
            control: vec![0.0],
        }],
        cameras: vec![Camera {
            name: "eye".into(),
            body: Some(BodyId(2)),
            mode: CameraMode::Fixed,
            pose: Pose::IDENTITY,
            field_of_view: 1.0,
            size: Some([640, 480]),
        }],
        ..Parts::default()
    }
}

pub type Case = (fn(&mut Parts), &'static str);

pub fn refuses(cases: &[Case]) {
    for (spoil, message) in cases {
        let mut parts = sound();
        spoil(&mut parts);
        let error = Model::new(parts).expect_err(message);
        assert_eq!(error.to_string(), *message);
    }
}
