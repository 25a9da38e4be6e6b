//! The model as a whole: its settings, sizes and names.

use crate::common::{refuses, sound};
use kinetarium_model::{
    Body, BodyId, Geometry, Joint, JointKind, Model, ModelError, Parts, Shape, examples,
};

#[test]
fn accepts_the_sound_model() {
    Model::new(sound()).unwrap();
}

#[test]
fn settings() {
    refuses(&[
        (
            |p| p.time_step = 0.0,
            "model \"machine\": time step [s] is 0; it must be above zero",
        ),
        (
            |p| p.time_step = -1e-3,
            "model \"machine\": time step [s] is -0.001; it must be above zero",
        ),
        (
            |p| p.time_step = f64::NAN,
            "model \"machine\": time step [s] is NaN; give a finite number",
        ),
        (
            |p| p.gravity.y = f64::NEG_INFINITY,
            "model \"machine\": gravity [m/s²] is -inf; give a finite number",
        ),
        (
            |p| p.worlds = 0,
            "the model asks for 0 worlds; ask for at least 1",
        ),
    ]);
}

#[test]
fn absurd_sizes() {
    refuses(&[
        (
            |p| p.worlds = usize::MAX,
            "the model has 18446744073709551615 worlds, more than the 10000000 it may have; \
             check the number, or split the model",
        ),
        (
            |p| p.bodies = vec![Body::new("b"); 1_000_001],
            "the model has 1000001 bodies, more than the 1000000 it may have; \
             check the number, or split the model",
        ),
        (
            |p| p.shapes = vec![Shape::new(Geometry::Sphere { radius: 1.0 }); 1_000_001],
            "the model has 1000001 shapes, more than the 1000000 it may have; \
             check the number, or split the model",
        ),
    ]);
}

#[test]
fn names() {
    refuses(&[
        (
            |p| p.bodies[1].name.clear(),
            "body number 1 has no name; give it one",
        ),
        (
            |p| p.joints[0].name.clear(),
            "joint number 0 has no name; give it one",
        ),
        (
            |p| p.joints[1].dofs[0].name.clear(),
            "degree of freedom number 1 has no name; give it one",
        ),
        (
            |p| p.keyframes[0].name.clear(),
            "keyframe number 0 has no name; give it one",
        ),
        (
            |p| p.bodies[2].name = "upper".into(),
            "two of kind body are named \"upper\"; rename one",
        ),
        (
            |p| p.joints[1].name = "hinge".into(),
            "two of kind joint are named \"hinge\"; rename one",
        ),
        (
            |p| p.joints[1].dofs[0].name = "hinge".into(),
            "two of kind degree of freedom are named \"hinge\"; rename one",
        ),
        (
            |p| p.actuators.push(p.actuators[0].clone()),
            "two of kind actuator are named \"motor\"; rename one",
        ),
        (
            |p| p.couplings.push(p.couplings[0].clone()),
            "two of kind coupling are named \"gears\"; rename one",
        ),
        (
            |p| p.keyframes.push(p.keyframes[0].clone()),
            "two of kind keyframe are named \"home\"; rename one",
        ),
    ]);
}

#[test]
fn keyframes() {
    refuses(&[
        (
            |p| p.keyframes[0].joint_position.clear(),
            "keyframe \"home\": its list of joint positions has 0 entries; it needs 2 (bodies \
             without a joint get a free one, last in the order)",
        ),
        (
            |p| p.keyframes[0].joint_velocity.push(0.0),
            "keyframe \"home\": its list of joint velocities has 3 entries; it needs 2 (bodies \
             without a joint get a free one, last in the order)",
        ),
        (
            |p| p.keyframes[0].control.clear(),
            "keyframe \"home\": its list of controls has 0 entries; it needs 1",
        ),
        (
            |p| p.keyframes[0].joint_position[1] = f64::NAN,
            "keyframe \"home\": joint position is NaN; give a finite number",
        ),
        (
            |p| {
                p.joints[1] = Joint::new("slider", JointKind::Ball, None, BodyId(2), vec![]);
                p.couplings.clear();
                p.keyframes[0].joint_position = vec![0.0; 5];
                p.keyframes[0].joint_velocity = vec![0.0; 4];
            },
            "keyframe \"home\": quaternion of its coordinates has length zero and so no direction; give \
             one; no rotation is (0, 0, 0, 1)",
        ),
    ]);
}

#[test]
fn unknown_names() {
    let model = Model::new(sound()).unwrap();
    let message = |error: ModelError| error.to_string();
    assert_eq!(
        message(model.body("uper").unwrap_err()),
        "there is no body named \"uper\"; did you mean \"upper\"?"
    );
    assert_eq!(
        message(model.joint("xyz").unwrap_err()),
        "there is no joint named \"xyz\"; there are hinge, slider, strut"
    );
    assert_eq!(
        message(model.dof("sliders").unwrap_err()),
        "there is no degree of freedom named \"sliders\"; did you mean \"slider\"?"
    );
    assert_eq!(
        message(model.actuator("Motor").unwrap_err()),
        "there is no actuator named \"Motor\"; did you mean \"motor\"?"
    );
    let empty = Model::new(Parts::default()).unwrap();
    assert_eq!(
        message(empty.keyframe("home").unwrap_err()),
        "there is no keyframe named \"home\"; there are none"
    );
    let chain = examples::n_pendula(21).unwrap();
    let told = message(chain.body("zzz").unwrap_err());
    assert!(told.starts_with("there is no body named \"zzz\"; there are link0, link1, "));
    assert!(told.ends_with(", link19, …"), "{told}");
}

#[test]
fn example_sizes() {
    let message = |links| examples::n_pendula(links).unwrap_err().to_string();
    assert_eq!(
        message(0),
        "chain: number of links is 0; it must lie from 1 to 1000000"
    );
    assert_eq!(
        message(2_000_000),
        "chain: number of links is 2000000; it must lie from 1 to 1000000"
    );
}
