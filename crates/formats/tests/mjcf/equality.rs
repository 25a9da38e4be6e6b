//! Loops and couplings.

use crate::common::{lenient, read};
use glam::DVec3;
use kinetarium_formats::{Loaded, Warning};
use model::{JointKind, Pose};

const TWO_ARMS: &str = r#"
    <body name="left" pos="-1 0 0"><joint name="l" ref="10"/><geom size="0.1"/>
      <site name="on_left" pos="0 0 1" euler="90 0 0"/></body>
    <body name="right" pos="1 0 0" euler="0 0 90"><joint name="r"/><geom size="0.1"/>
      <site name="on_right" pos="0 2 0"/></body>
    <body name="post" pos="0 3 0"/>"#;

fn with_equality(equality: &str) -> Loaded {
    read(&format!(
        "<mujoco><worldbody>{TWO_ARMS}</worldbody><equality>{equality}</equality></mujoco>"
    ))
}

/// Where the frames of a joint that closes a loop lie in the world.
fn frames(loaded: &Loaded) -> (Pose, Pose) {
    let joint = &loaded.model.joints[2];
    assert!(joint.closes_loop);
    let parent = joint
        .parent
        .map_or(Pose::IDENTITY, |id| loaded.model.bodies[id.0].pose);
    let child = loaded.model.bodies[joint.child.0].pose;
    (parent * joint.parent_frame, child * joint.child_frame)
}

fn same(a: Pose, b: Pose) -> bool {
    a.position.abs_diff_eq(b.position, 1e-12)
        && a.orientation.dot(b.orientation).abs() > 1.0 - 1e-12
}

#[test]
fn connect_is_a_ball_that_closes_a_loop() {
    let loaded =
        with_equality(r#"<connect name="c" body1="left" body2="right" anchor="0.5 0 0"/>"#);
    let joint = &loaded.model.joints[2];
    assert_eq!((joint.kind, joint.name.as_str()), (JointKind::Ball, "c"));
    let (a, b) = frames(&loaded);
    assert!(
        same(a, b) && a.position == DVec3::new(-0.5, 0.0, 0.0),
        "{a:?} {b:?}"
    );
    assert!(joint.enabled);

    let to_world = with_equality(r#"<connect body1="left" anchor="0 0 1" active="false"/>"#);
    let joint = &to_world.model.joints[2];
    assert_eq!(
        (joint.parent, joint.child.0, joint.enabled),
        (None, 0, false)
    );
    let (a, b) = frames(&to_world);
    assert!(same(a, b), "{a:?} {b:?}");

    let sites = with_equality(r#"<connect site1="on_left" site2="on_right"/>"#);
    let (a, b) = frames(&sites);
    assert_eq!(a.position, DVec3::new(-1.0, 0.0, 1.0));
    assert!(
        b.position.abs_diff_eq(DVec3::new(-1.0, 0.0, 0.0), 1e-12),
        "{b:?}"
    );
}

#[test]
fn weld_is_a_fixed_joint_that_closes_a_loop() {
    let loaded = with_equality(r#"<weld body1="left" body2="right" anchor="0 1 0"/>"#);
    assert_eq!(loaded.model.joints[2].kind, JointKind::Fixed);
    let (a, b) = frames(&loaded);
    assert!(same(a, b), "{a:?} {b:?}");

    let placed =
        with_equality(r#"<weld body1="left" body2="right" relpose="0.1 0.2 0.3 0 0 0 2"/>"#);
    let joint = &placed.model.joints[2];
    assert_eq!(joint.parent_frame.position, DVec3::new(0.1, 0.2, 0.3));
    assert_eq!(
        joint.parent_frame.orientation.to_array(),
        [0.0, 0.0, 1.0, 0.0]
    );
    assert_eq!(joint.child_frame, Pose::IDENTITY);

    let static_second = with_equality(r#"<weld body1="left" body2="post"/>"#);
    let joint = &static_second.model.joints[2];
    assert_eq!((joint.parent.map(|id| id.0), joint.child.0), (Some(2), 0));
    let nothing_moves = with_equality(r#"<weld body1="post"/>"#);
    assert_eq!(nothing_moves.model.joints.len(), 2);
    assert_eq!(
        nothing_moves.warnings.last().map(|w| w.element.as_str()),
        Some("weld")
    );
}

/// y − y₀ = a₀ + a₁ (x − x₀), with y₀ = 10° and x₀ = 0.
#[test]
fn joint_equality_is_a_coupling() {
    let loaded = with_equality(r#"<joint joint1="l" joint2="r" polycoef="0.5 -2 0 0 0"/>"#);
    let coupling = &loaded.model.couplings[0];
    assert_eq!((coupling.joint.0, coupling.other.0), (0, 1));
    assert_eq!(coupling.ratio, -2.0);
    assert!((coupling.offset - (10f64.to_radians() + 0.5)).abs() < 1e-12);
    assert!(
        lenient("<mujoco><equality><flex/></equality></mujoco>")
            .model
            .joints
            .is_empty()
    );
}

/// The law of MuJoCo's constraint on the inertia m that the joint shows, at the mean impedance of its ramp:
/// a force d / (1 − d) m (d k r + b v), and the inertia d / (1 − d) m, beside the joint's own spring.
#[test]
fn one_joint_alone_is_held() {
    let read = |joint: &str, equality: &str| {
        read(&format!(
            "<mujoco><worldbody><body><joint name='a' axis='0 1 0' ref='10' {joint}/>
               <joint name='b' type='slide' axis='0 1 0'/><geom size='0.1' mass='2' pos='0 0 -1'/></body></worldbody>
               <equality><joint joint1='a' {equality}/></equality></mujoco>"
        ))
    };
    let m = 2.0 * (1.0 + 0.4 * 0.01);
    let (start, held) = (10f64.to_radians(), 10f64.to_radians() + 0.3);
    for (equality, time, impedances) in [
        ("", 0.02, [0.9, 0.95]),
        ("solref='0.1 1' solimp='0.5 0.7'", 0.1, [0.5, 0.7]),
    ] {
        let [least, most] = impedances;
        let d = 0.5 * (least + most);
        let (share, reach) = (d / (1.0 - d) * m, most * time);
        let loaded = read("", &format!("polycoef='0.3 9' {equality}"));
        let dof = &loaded.model.joints[0].dofs[0];
        let near = |found: f64, expected: f64| (found - expected).abs() < 1e-9 * expected;
        assert!(near(dof.stiffness, share * d / (reach * reach)), "{dof:?}");
        assert!(near(dof.damping, share * 2.0 / reach), "{dof:?}");
        assert!(near(dof.armature, share), "{dof:?}");
        assert!(near(dof.rest, held), "{dof:?}");
        assert!(loaded.warnings.is_empty(), "{:?}", loaded.warnings);
        // The other joint of the body is free.
        let free = &loaded.model.joints[0].dofs[1];
        assert_eq!((free.stiffness, free.armature), (0.0, 0.0));
    }
    let alone = read("", "polycoef='0.3'").model.joints[0].dofs[0].clone();
    let beside = read("stiffness='500' springref='10'", "polycoef='0.3'");
    let dof = &beside.model.joints[0].dofs[0];
    assert_eq!(dof.stiffness, alone.stiffness + 500.0);
    let torque = |q: f64| alone.stiffness * (held - q) + 500.0 * (start - q);
    assert!((dof.stiffness * (dof.rest - 0.2) - torque(0.2)).abs() < 1e-9);
}

/// Whatever it would do, were it active.
#[test]
fn inactive_constraints_do_nothing() {
    for equality in [
        r#"<joint joint1="l" active="false"/>"#,
        r#"<joint joint1="l" joint2="r" polycoef="0 1 2" active="false"/>"#,
        r#"<tendon tendon1="t" active="false"/>"#,
    ] {
        let loaded = with_equality(equality);
        assert!(loaded.model.couplings.is_empty());
        let told = |warning: &Warning| warning.message == "inactive constraint: left out";
        assert!(loaded.warnings.iter().any(told), "{:?}", loaded.warnings);
    }
}

/// MuJoCo has names of their own for joints and for equality constraints.
#[test]
fn constraints_may_have_the_names_of_joints() {
    let body =
        |name: &str| format!("<body name='{name}'><joint name='{name}'/><geom size='0.1'/></body>");
    let bodies = ["grip", "hold_0", "other"].map(body).concat();
    let model = read(&format!(
        "<mujoco><worldbody>{bodies}</worldbody><equality>
           <connect name='grip' body1='grip' body2='other' anchor='0 0 0'/>
           <connect name='hold' body1='hold_0' body2='other' anchor='0 0 0'/>
           <joint joint1='grip' joint2='other'/>
           <joint name='coupling_0' joint1='hold_0' joint2='other'/>
         </equality></mujoco>"
    ))
    .model;
    let names: Vec<_> = model.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["grip", "hold_0", "other", "grip_2", "hold"]);
    let dofs = model.joints[3..].iter().flat_map(|joint| &joint.dofs);
    let names: Vec<_> = dofs.map(|dof| dof.name.as_str()).collect();
    let expected = [
        "grip_2_0", "grip_2_1", "grip_2_2", "hold_0_2", "hold_1", "hold_2",
    ];
    assert_eq!(names, expected);
    let names: Vec<_> = model.couplings.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(names, ["coupling_0_2", "coupling_0"]);
}
