//! Which bodies there are, and where.

use crate::common::{lines, read};
use glam::{DMat3, DQuat, DVec3};
use kinetarium_formats::{InMemory, Options, parse};
use model::BodyKind;

#[test]
fn what_nothing_moves_is_static() {
    let model = read(
        r#"<mujoco><worldbody>
             <body name="table"><geom size="1"/><body name="lamp" pos="0 0 1"/>
               <body name="drawer"><joint type="slide"/><geom size="0.1"/></body>
             </body>
           </worldbody></mujoco>"#,
    )
    .model;
    let kinds: Vec<BodyKind> = model.bodies.iter().map(|body| body.kind).collect();
    assert_eq!(
        kinds,
        [BodyKind::Static, BodyKind::Static, BodyKind::Dynamic]
    );
    assert_eq!(model.joints.len(), 1);
    assert_eq!(model.joints[0].parent.map(|id| id.0), Some(0));
}

/// A massless mount on a link, and a massless carriage that carries a welded mass.
#[test]
fn massless_bodies_are_fused() {
    let loaded = read(
        r#"<mujoco><worldbody>
             <body name="link" pos="0 0 1"><joint name="pin"/><geom size="0.1" mass="2"/>
               <body name="mount" pos="0 1 0" euler="0 0 90">
                 <geom name="plate" size="0.1" mass="0" pos="1 0 0"/>
                 <body name="rider" pos="0 0 1"><joint name="rail" type="slide"/><geom size="0.1"/></body>
               </body>
             </body>
             <body name="carriage"><freejoint name="free"/>
               <body name="load" pos="0 0 2"><geom size="0.1" mass="3"/></body>
             </body>
           </worldbody>
           <actuator><motor name="m" joint="rail"/></actuator></mujoco>"#,
    );
    let told = "robot.xml:3: <body>: bodies that are fixed to each other become one where either has no mass or no inertia \
                (give it both to keep it); these names are gone, with position [m] and quaternion x y z w in what has \
                them: \"mount\" in \"link\" at (0 1 0), (0 0 0.707107 0.707107); \
                \"load\" in \"carriage\" at (0 0 2), (0 0 0 1) (line 9)";
    assert_eq!(lines(&loaded.warnings), [told]);
    let model = loaded.model;
    let names: Vec<&str> = model.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(names, ["link", "rider", "carriage"]);
    assert_eq!((model.bodies[0].mass, model.bodies[2].mass), (2.0, 3.0));
    assert_eq!(model.bodies[2].center, DVec3::new(0.0, 0.0, 2.0));
    assert!(
        model.shapes[1]
            .pose
            .position
            .abs_diff_eq(DVec3::new(0.0, 2.0, 0.0), 1e-12)
    );
    let rail = &model.joints[model.actuators[0].joint.0];
    assert_eq!(
        (rail.name.as_str(), rail.parent.map(|id| id.0), rail.child.0),
        ("rail", Some(0), 1)
    );
    assert!(
        rail.parent_frame
            .position
            .abs_diff_eq(DVec3::new(0.0, 1.0, 1.0), 1e-12)
    );
}

/// A point mass counts in full on what it is welded to: on a ball, and, as in MuJoCo, as the body that moves itself.
#[test]
fn point_masses_are_fused() {
    let point = r#"<inertial pos="0 0 .3" mass="2" diaginertia="0 0 0"/>"#;
    let ball = r#"<geom size=".1" mass="3"/>"#;
    let text = |outer: &str, inner: &str| {
        format!(
            r#"<mujoco><worldbody><body name="b"><joint/>{outer}
               <body name="c">{inner}</body></body></worldbody></mujoco>"#
        )
    };
    for text in [text(ball, point), text(point, ball)] {
        let loaded = read(&text);
        let [body] = &loaded.model.bodies[..] else {
            panic!("one body")
        };
        assert_eq!((body.name.as_str(), body.mass), ("b", 5.0));
        assert!(body.center.abs_diff_eq(DVec3::new(0.0, 0.0, 0.12), 1e-15));
        // 2/5 m r² of the ball, and the reduced mass at the distance.
        let own = 0.4 * 3.0 * 0.1 * 0.1;
        let across = own + 0.3 * 0.3 * (2.0 * 3.0 / 5.0);
        let inertia = DMat3::from_diagonal(DVec3::new(across, across, own));
        assert!(body.inertia.abs_diff_eq(inertia, 1e-15), "{}", body.inertia);
        let told = lines(&loaded.warnings).remove(0);
        assert!(
            told.starts_with("robot.xml:2: <body>: bodies that are fixed"),
            "{told}"
        );
        assert!(
            told.ends_with(r#": "c" in "b" at (0 0 0), (0 0 0 1)"#),
            "{told}"
        );
    }
    // What has mass and inertia stays a body of its own.
    assert_eq!(read(&text(ball, ball)).model.bodies.len(), 2);
    let alone = text(point, "");
    let error = parse(
        &alone,
        "robot.xml",
        &InMemory::default(),
        &Options::default(),
    );
    let error = error.expect_err("a point that turns").to_string();
    assert!(
        error.contains("smallest principal moment of inertia is 0"),
        "{error}"
    );
}

/// MuJoCo leaves what is free where its body is.
#[test]
fn free_joints_may_stand_in_frames() {
    let body = |joint: &str| {
        read(&format!(
            "<mujoco><worldbody><body pos='0 0 1'>{joint}<geom size='1' pos='1 0 0'/></body></worldbody></mujoco>"
        ))
    };
    for joint in ["<freejoint/>", "<joint type='free' pos='1 1 1'/>"] {
        let framed = format!("<frame pos='1 2 3' euler='0 30 0'>{joint}</frame>");
        assert_eq!(body(&framed), body(joint));
    }
}

/// Of what does not move, or has no weight.
#[test]
fn gravity_compensation_without_weight_is_read() {
    for (gravity, joint) in [("0 0 0", "<joint/>"), ("0 0 -9.81", "")] {
        let loaded = read(&format!(
            "<mujoco><option gravity='{gravity}'/><worldbody><body gravcomp='1'>{joint}<geom size='1'/></body>
             </worldbody></mujoco>"
        ));
        assert_eq!(loaded.warnings, []);
    }
}

/// A chain as deep as an element may be nested is read without overflowing the stack.
#[test]
fn deep_chains_are_read() {
    let links = 490;
    let text = format!(
        "<mujoco><worldbody>{}{}</worldbody></mujoco>",
        "<body pos='0 0 1'><joint axis='0 1 0' range='-90 90'/><geom size='0.1'/>".repeat(links),
        "</body>".repeat(links)
    );
    assert_eq!(read(&text).model.degrees_of_freedom(), links);
    let deep = format!(
        "<mujoco>{}{}</mujoco>",
        "<frame>".repeat(600),
        "</frame>".repeat(600)
    );
    let error = parse(&deep, "deep.xml", &InMemory::default(), &Options::default());
    let error = error.expect_err("too deep").to_string();
    assert!(
        error.contains("nested more than 500 deep; make the tree of elements flatter"),
        "{error}"
    );
}

/// The frame of MuJoCo 4.0, for a mesh that weighs alone, and where a site and an anchor are in it.
#[test]
fn free_bodies_are_aligned_with_a_mesh() {
    let cube = "-1 -1 0 1 -1 0 1 1 0 -1 1 0 -1 -1 2 1 -1 2 1 1 2 -1 1 2 0 0 1";
    let faces =
        "3 2 1 3 1 0 0 1 5 0 5 4 1 2 6 1 6 5 2 3 7 2 7 6 3 0 4 3 4 7 4 5 8 5 6 8 6 7 8 7 4 8";
    let loaded = read(&format!(
        "<mujoco><asset><mesh name='m' inertia='exact' vertex='{cube}' face='{faces}' scale='.3 .1 .2'/></asset>
         <worldbody><site name='world'/>
           <body name='b' pos='1 2 3' euler='0 0 90'><freejoint align='true'/>
             <geom type='mesh' mesh='m' pos='.1 .2 .3' euler='10 20 30'/><site name='s' pos='1 0 0'/></body></worldbody>
         <equality><connect site1='world' site2='s'/><connect body1='b' anchor='1 0 0'/></equality></mujoco>"
    ));
    let body = &loaded.model.bodies[0];
    let place = DVec3::new(0.8277399049, 2.1581434244, 3.4573208183);
    assert!(body.pose.position.abs_diff_eq(place, 1e-7), "{body:?}");
    let turn = DQuat::from_xyzw(-0.0996005029, 0.7697511313, 0.5648625215, -0.2801664996);
    let cosine = body.pose.orientation.dot(turn).abs();
    assert!((cosine - 1.0).abs() < 1e-9, "{body:?}");
    let moments = DMat3::from_diagonal(DVec3::new(1.708, 1.44, 0.556));
    assert!(body.inertia.abs_diff_eq(moments, 1e-6), "{body:?}");
    // The site stays where it was in the world; the anchor is given in the frame that the body gets.
    let site = DVec3::new(-0.6831350016, -0.1071716623, 0.6851125233);
    for (joint, expected) in loaded.model.joints[1..].iter().zip([site, DVec3::X]) {
        let found = joint.child_frame.position;
        assert!(found.abs_diff_eq(expected, 1e-7), "{found}");
    }
}
