//! Springs and dampers of joints, and flags that switch them off.

use crate::common::{lenient, lines, read};
use glam::DVec3;
use kinetarium_formats::{InMemory, Options, parse};

#[test]
fn flags_switch_things_off() {
    let model = read(
        r#"<mujoco>
             <option><flag gravity="disable" limit="disable" passive="disable" contact="disable"/></option>
             <worldbody><body>
               <joint range="0 1" damping="3" stiffness="2" frictionloss="1"/><geom size="0.1"/>
             </body></worldbody>
           </mujoco>"#,
    )
    .model;
    let dof = &model.joints[0].dofs[0];
    assert_eq!(
        (dof.limit, dof.damping, dof.stiffness, dof.friction_loss),
        (None, 0.0, 0.0, 1.0)
    );
    assert_eq!(model.gravity, DVec3::ZERO);
    assert!(!model.shapes[0].collides);
}

/// MuJoCo 4.0 has a stiffness of 1.6755 and a damping of 0.3351 for a ball of 4.189 kg and a radius of 0.1 m,
/// I = 2/5 m r²: I/T² and 2 I/T; and adds what actuators damp, 3 behind gear 2.
#[test]
fn springdamper_goes_by_the_flags_of_springs_and_dampers() {
    for (flag, stiffness, damping) in [
        ("gravity", 1.675_516_081_9, 12.335_103_216_4),
        ("spring", 0.0, 12.335_103_216_4),
        ("damper", 1.675_516_081_9, 0.0),
        ("passive", 0.0, 0.0),
    ] {
        let model = read(&format!(
            "<mujoco><option><flag {flag}='disable'/></option><worldbody><body>
               <joint name='j' springdamper='0.1 1' damping='7' stiffness='5'/><geom size='0.1'/>
             </body></worldbody><actuator><motor joint='j' damping='3' gear='2'/></actuator></mujoco>"
        ))
        .model;
        let dof = &model.joints[0].dofs[0];
        assert!((dof.stiffness - stiffness).abs() < 1e-9, "{flag}: {dof:?}");
        assert!((dof.damping - damping).abs() < 1e-9, "{flag}: {dof:?}");
    }
}

/// One number of `damping` keeps its class's others, which MuJoCo 4.0 has as a polynomial.
#[test]
fn a_linear_damping_does_not_take_back_a_polynomial() {
    let text = "<mujoco><default><joint damping='1 2 3'/></default><worldbody><body>\
                <joint damping='4'/><geom size='1'/></body></worldbody></mujoco>";
    let files = InMemory::default();
    let error = parse(text, "robot.xml", &files, &Options::default()).expect_err("a polynomial");
    assert!(error.to_string().contains("nonlinear damping"), "{error}");
    assert_eq!(lenient(text).model.joints[0].dofs[0].damping, 4.0);
}

/// MuJoCo has a stiffness of 3 there, which no solver takes; damping stays.
#[test]
fn springs_of_balls_are_left_out_leniently() {
    let joint = |spring: &str| {
        let loaded = lenient(&format!(
            "<mujoco><worldbody><body><joint type='ball' {spring}/><geom size='0.1'/></body></worldbody></mujoco>"
        ));
        let warnings = lines(&loaded.warnings);
        let told = [
            "robot.xml:1: <joint>: a spring at a ball or free joint: left out although it changes the physics",
        ];
        assert_eq!(warnings, told);
        loaded.model.joints[0].dofs.clone()
    };
    for dof in joint("stiffness='3' damping='2'") {
        assert_eq!((dof.stiffness, dof.damping), (0.0, 2.0));
    }
    // 2 I / T, with MuJoCo's I = 2/5 m r² of a ball of 4.189 kg.
    for dof in joint("springdamper='0.1 1'") {
        assert_eq!(dof.stiffness, 0.0);
        assert!((dof.damping - 0.335_103_216_4).abs() < 1e-9, "{dof:?}");
    }
}
