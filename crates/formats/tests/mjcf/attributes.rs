//! Names, and attributes that come from classes.

use crate::common::read;
use model::{Geometry, Softness};

/// An empty name is none.
#[test]
fn empty_names_may_be_repeated() {
    let model = read(
        "<mujoco><worldbody><body name='a'><joint name='' axis='1 0 0'/><joint name=''/><geom size='1'/></body>
         <body name='b'><joint name=''/><geom size='1'/><site name='s'/></body></worldbody>
         <sensor><gyro name='' site='s'/><gyro name='' site='s'/></sensor></mujoco>",
    )
    .model;
    let names: Vec<_> = model.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["a", "b"]);
    let names: Vec<_> = model.sensors.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["gyro", "gyro_2"]);
}

#[test]
fn unnamed_things_get_names() {
    let model = read(
        r#"<mujoco><worldbody>
             <body><freejoint/><geom size="1"/>
               <body name="body_1"><joint/><joint axis="1 0 0"/><geom size="1"/></body></body>
           </worldbody></mujoco>"#,
    )
    .model;
    let bodies: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(bodies, ["body_1_2", "body_1"]);
    let joints: Vec<&str> = model
        .joints
        .iter()
        .map(|joint| joint.name.as_str())
        .collect();
    assert_eq!(joints, ["body_1_2", "body_1"]);
    assert_eq!(model.joints[1].dofs[1].name, "body_1_1");
}

/// MuJoCo 4.0 overwrites the numbers that are given, class by class, and leaves those behind them.
#[test]
fn shorter_lists_keep_the_rest_of_their_class_s() {
    let model = read(
        r#"<mujoco>
             <compiler angle="radian"/>
             <default>
               <geom type="capsule" size="0.05 0.3" condim="6" friction="2 3 4" solref="0.1 0.2"
                 solimp="0.8 0.8 0.3"/>
               <joint range="-1 1" solreflimit="0.1 0.5" solimplimit="0.5 0.5 0.1"/>
               <motor gear="0 0 3"/>
               <default class="inner"><geom friction="5 6" solimp="0.7 0.7"/></default>
             </default>
             <worldbody>
               <geom class="inner" size="0.1" friction="7" solref="0.3"/>
               <body><freejoint name="free"/><geom size="1"/></body>
               <body><joint solreflimit="0.2"/><geom size="1"/></body>
             </worldbody>
             <actuator><motor joint="free" gear="0"/></actuator>
           </mujoco>"#,
    )
    .model;
    let ends = |radius: f64| Geometry::Capsule {
        radius,
        half_height: radius + 0.3,
    };
    assert_eq!(model.shapes[0].geometry, ends(0.1));
    let m = model.shapes[0].material;
    let friction = [m.friction, m.torsional_friction, m.rolling_friction];
    assert_eq!(friction, [7.0, 6.0, 4.0]);
    let Softness::Time {
        constant,
        ratio,
        impedance,
        ..
    } = m.softness
    else {
        panic!("{m:?}")
    };
    assert_eq!((constant, ratio, impedance), (0.3, 0.2, 0.7));
    // k = 1 / (T ζ)² and b = 2 / T for the inertia twice that of the joint, as d = ½.
    let limit = model.joints[1].dofs[0].limit.expect("a limit");
    let square = limit.damping * limit.damping / (limit.stiffness * limit.inertia);
    assert!(
        (limit.damping / limit.inertia - 2.0 * 2.0 / 0.2).abs() < 1e-9,
        "{limit:?}"
    );
    assert!((square - 2.0 * 4.0 * 0.5 * 0.5).abs() < 1e-9, "{limit:?}");
    assert_eq!((model.actuators[0].dof, model.actuators[0].gear), (2, 3.0));
}
