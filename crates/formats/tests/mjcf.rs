//! What MJCF files become beyond the numbers that MuJoCo agrees on: warnings, leniency, includes,
//! loops, couplings, fused bodies, colours and meshes.

use glam::{DMat3, DVec3, Vec3};
use kinetarium_formats::{Files, Folder, InMemory, Loaded, Options, Warning, load, parse};
use model::{
    BodyId, BodyKind, CameraMode, CollisionFilter, Combine, Geometry, JointKind, Lamp, LampKind,
    Model, Pose, ShapeId, Softness,
};

fn read_with(body: &str, options: &Options) -> Loaded {
    let files = InMemory::default();
    parse(body, "robot.xml", &files, options).unwrap_or_else(|error| panic!("{error}"))
}

fn read(text: &str) -> Loaded {
    read_with(text, &Options::default())
}

fn lenient(text: &str) -> Loaded {
    read_with(
        text,
        &Options {
            lenient: true,
            ..Options::default()
        },
    )
}

fn lines(warnings: &[Warning]) -> Vec<String> {
    warnings.iter().map(Warning::to_string).collect()
}

#[test]
fn unused_things_are_listed_once_with_their_first_line() {
    let loaded = read(
        r#"<mujoco>
             <option integrator="RK4"/>
             <worldbody>
               <light pos="0 0 3"/>
               <light pos="0 0 4"/>
               <camera mode="targetbody"/>
               <body><joint solimpfriction="0.8"/><geom size="1"/></body>
               <body><joint solimpfriction="0.9"/><geom size="1"/></body>
             </worldbody>
             <sensor><clock/></sensor>
           </mujoco>"#,
    );
    assert_eq!(
        lines(&loaded.warnings),
        [
            "robot.xml:2: <option>: attribute `integrator`: the integrator is chosen when the \
             simulation is made",
            "robot.xml:6: <camera>: cameras of mode `targetbody`: not read: cameras do not turn by themselves",
            "robot.xml:7: <joint>: attribute `solimpfriction`: dry friction is not softened",
            "robot.xml:10: <clock>: sensors of this kind: not read",
        ]
    );
}

#[test]
fn lights_are_lamps() {
    let file = |lights: &str| {
        read(&format!(
            "<mujoco>\n<default><light cutoff=\"30\" diffuse=\"0.1 0.2 0.3\"/></default><worldbody>\n{lights}\n\
             <body pos=\"0 0 1\" euler=\"0 90 0\"><joint/><geom size=\"1\"/>\
             <light pos=\"1 0 0\" mode=\"track\" type=\"point\" castshadow=\"false\"/></body></worldbody></mujoco>"
        ))
    };
    let slant = r#"<frame euler="0 90 0"><light dir="0 0 -2" directional="true"/></frame>"#;
    let loaded = file(
        &[
            slant,
            r#"<light name="spot" pos="0 0 3" attenuation="0 0 1"/>"#,
        ]
        .concat(),
    );
    let [sun, spot, bulb] = &loaded.model.lamps[..] else {
        panic!("{:?}", loaded.model.lamps)
    };
    let along = |lamp: &Lamp| lamp.pose.direction(DVec3::NEG_Z);
    // A quarter turn about y takes −z to −x.
    assert!(along(sun).abs_diff_eq(DVec3::NEG_X, 1e-12), "{sun:?}");
    assert_eq!(
        (sun.name.as_str(), sun.kind),
        ("lamp_0", LampKind::Parallel)
    );
    assert_eq!(sun.color, Vec3::new(0.1, 0.2, 0.3));
    let (cutoff, exponent) = (30_f64.to_radians(), 10.0);
    assert_eq!(spot.kind, LampKind::Spot { cutoff, exponent });
    assert_eq!(
        (spot.pose.position, spot.attenuation),
        (DVec3::new(0.0, 0.0, 3.0), DVec3::Z)
    );
    assert!(along(spot).abs_diff_eq(DVec3::NEG_Z, 1e-12) && spot.shadows);
    // From its body, of which x points down, and not turning with it.
    assert_eq!(
        (bulb.body, bulb.kind, bulb.shadows),
        (Some(BodyId(0)), LampKind::Point, false)
    );
    assert_eq!(bulb.mode, CameraMode::Track);
    assert!(
        bulb.pose.position.abs_diff_eq(DVec3::NEG_Z, 1e-12),
        "{bulb:?}"
    );
    assert_eq!(loaded.warnings, []);
}

#[test]
fn what_is_not_read_of_lights_is_told() {
    let file = |light: &str| {
        read(&format!(
            "<mujoco><worldbody>{light}<body><joint/><geom size=\"1\"/></body></worldbody></mujoco>"
        ))
    };
    let off = file(r#"<light active="false"/>"#);
    assert!(off.model.lamps.is_empty() && off.warnings.is_empty());
    let all_around = file(r#"<light cutoff="180"/>"#);
    assert_eq!(all_around.model.lamps[0].kind, LampKind::Point);
    let aiming = file(r#"<light mode="targetbody" target="a" specular="1 1 1"/>"#);
    assert_eq!(
        lines(&aiming.warnings),
        [
            "robot.xml:1: <light>: attribute `specular`: what shines reflects `diffuse`",
            "robot.xml:1: <light>: lights of mode `targetbody`: not read: lights do not turn by themselves",
        ]
    );
    for (light, told) in [
        (r#"<light dir="0 0 0"/>"#, "`dir` is no direction"),
        (r#"<light cutoff="-1"/>"#, "cutoff [rad]"),
        (r#"<light colour="1 1 1"/>"#, "colour"),
    ] {
        let text = format!("<mujoco><worldbody>{light}</worldbody></mujoco>");
        let error = parse(
            &text,
            "robot.xml",
            &InMemory::default(),
            &Options::default(),
        );
        let error = error.unwrap_err().to_string();
        assert!(error.contains(told), "{error}");
    }
}

#[test]
fn lenient_turns_missing_physics_into_warnings() {
    let loaded = lenient(
        r#"<mujoco>
             <option density="1000" viscosity="0.1"/>
             <worldbody>
               <body gravcomp="1">
                 <joint name="j" damping="1 2 3"/>
                 <geom size="0.1"/>
               </body>
             </worldbody>
             <actuator>
               <muscle joint="j"/>
               <motor name="kept" joint="j"/>
             </actuator>
             <keyframe><key ctrl="5 7"/></keyframe>
           </mujoco>"#,
    );
    let features: Vec<_> = loaded
        .warnings
        .iter()
        .map(|w| (w.element.as_str(), w.line))
        .collect();
    let expected = [
        ("option", 2),
        ("option", 2),
        ("body", 4),
        ("joint", 5),
        ("muscle", 10),
    ];
    assert_eq!(features, expected);
    assert_eq!(loaded.model.actuators[0].name, "kept");
    assert_eq!(loaded.model.keyframes[0].control, [7.0]);
    assert_eq!(loaded.model.joints[0].dofs[0].damping, 1.0);
}

#[test]
fn includes_are_spliced_in() {
    let files = InMemory::new([
        (
            "arm.xml",
            r#"<mujoco><body name="arm"><joint/><include file="hand.xml"/></body></mujoco>"#,
        ),
        ("hand.xml", r#"<any><geom name="hand" size="0.1"/></any>"#),
    ]);
    let text = r#"<mujoco><worldbody><include file="arm.xml"/></worldbody></mujoco>"#;
    let loaded = parse(text, "robot.xml", &files, &Options::default()).expect("a model");
    assert_eq!(loaded.model.bodies[0].name, "arm");
    assert_eq!(loaded.model.shapes[0].name, "hand");
}

/// MuJoCo 4.0 takes a file beside the main one, and else one beside that which includes it.
#[test]
fn includes_are_relative_to_the_main_file_or_to_the_including_one() {
    let body =
        |name: &str| format!("<any><body name='{name}'><joint/><geom size='0.1'/></body></any>");
    let include = |file: &str| format!("<any><include file='{file}'/></any>");
    let found = |files: &[(&str, String)]| {
        let files = InMemory::new(files.iter().cloned());
        let text = "<mujoco><worldbody><include file='sub/a.xml'/></worldbody></mujoco>";
        parse(text, "robot.xml", &files, &Options::default())
            .map(|loaded| loaded.model.bodies[0].name.clone())
            .map_err(|error| error.to_string())
    };
    let inner = ("sub/b.xml", body("inner"));
    let outer = ("b.xml", body("outer"));
    let by = ("sub/a.xml", include("b.xml"));
    assert_eq!(found(&[by.clone(), inner.clone()]), Ok("inner".into()));
    assert_eq!(
        found(&[by.clone(), inner.clone(), outer.clone()]),
        Ok("outer".into())
    );
    let up = ("sub/a.xml", include("../b.xml"));
    assert_eq!(found(&[up, outer.clone()]), Ok("outer".into()));
    let from_main = ("sub/a.xml", include("sub/b.xml"));
    assert_eq!(found(&[from_main, inner]), Ok("inner".into()));
    let deep = [
        ("sub/a.xml", include("c/d.xml")),
        ("sub/c/d.xml", include("e.xml")),
    ];
    let last = ("sub/c/e.xml", body("deep"));
    assert_eq!(found(&[&deep[..], &[last]].concat()), Ok("deep".into()));
    // Not beside those that include the including one.
    let halfway = ("sub/e.xml", body("halfway"));
    let missing = found(&[&deep[..], &[halfway]].concat()).expect_err("no file");
    assert!(
        missing.starts_with("sub/c/d.xml:1:15: <include>: attribute `file` names `e.xml`"),
        "{missing}"
    );
    let itself = found(&[("sub/a.xml", include("a.xml"))]).expect_err("a circle");
    assert!(itself.contains("already part of the model"), "{itself}");
}

#[test]
fn a_file_is_read_with_the_files_beside_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let robot = folder.path().join("robot.xml");
    let text = r#"<mujoco>
        <compiler meshdir="meshes"/>
        <asset><mesh name="m" file="m.stl" scale="2 2 2"/></asset>
        <worldbody>
          <include file="more.xml"/>
          <geom type="mesh" mesh="m"/>
        </worldbody>
      </mujoco>"#;
    std::fs::write(&robot, text).expect("written");
    std::fs::write(folder.path().join("more.xml"), "<x><geom size='1'/></x>").expect("written");
    let model = load(&robot, &Options::default()).expect("a model").model;
    assert_eq!(model.name, "robot");
    let file = folder
        .path()
        .join("meshes/m.stl")
        .to_string_lossy()
        .into_owned();
    assert_eq!(
        model.shapes[1].geometry,
        Geometry::MeshFile {
            file,
            scale: DVec3::splat(2.0)
        }
    );

    std::fs::write(folder.path().join("more.xml"), "<x>\n<geom size='0'/></x>").expect("written");
    let error = load(&robot, &Options::default())
        .expect_err("a size of zero")
        .to_string();
    assert!(
        error.starts_with(&format!("{}/more.xml:2:7: ", folder.path().display())),
        "{error}"
    );
    let missing = load(&folder.path().join("none.xml"), &Options::default()).expect_err("no file");
    assert!(
        missing.to_string().contains("none.xml: cannot be read"),
        "{missing}"
    );
    let not_text = folder.path().join("noise.xml");
    std::fs::write(&not_text, [0xff, 0xfe, 0x00]).expect("written");
    assert!(load(&not_text, &Options::default()).is_err());
    assert!(Folder::new(folder.path()).read("absent").is_err());
}

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

/// It replaces the surfaces of all geoms.
#[test]
fn an_override_of_contacts_is_refused() {
    let text = r#"<mujoco><option o_solref="0.1 1"><flag override="enable"/></option></mujoco>"#;
    let files = InMemory::default();
    let error = parse(text, "robot.xml", &files, &Options::default()).expect_err("another contact");
    let told = "<flag>: one surface for all contacts (flag `override`) is not supported";
    assert!(error.to_string().contains(told), "{error}");
    assert_eq!(lenient(text).warnings.len(), 2);
}

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

/// A pair that says the same again counts once.
#[test]
fn pairs_may_be_repeated() {
    let text = |again: &str| {
        format!(
            "<mujoco><worldbody><geom name='a' size='1'/><body><freejoint/><geom name='b' size='1'/></body></worldbody>\
             <contact><pair geom1='a' geom2='b' margin='0.1'/>\n{again}</contact></mujoco>"
        )
    };
    let once = read(&text(""));
    for again in [
        "<pair geom1='a' geom2='b' margin='.1'/>",
        "<pair name='c' geom1='b' geom2='a' margin='0.1' condim='3'/>",
    ] {
        let twice = read(&text(again));
        assert_eq!(twice.model, once.model);
        let told = "robot.xml:2: <pair>: a pair that repeats an earlier one: it counts once; MuJoCo makes each of its \
                    contacts twice, which is a little stiffer";
        assert_eq!(lines(&twice.warnings), [told]);
    }
}

#[test]
fn geoms_have_colours_friction_and_collide() {
    let model = read(
        r#"<mujoco>
             <asset><material name="red" rgba="1 0 0 1"/></asset>
             <default><geom condim="6" friction="0.7 0.02"/>
               <default class="blue"><geom rgba="0 0 1 1"/></default>
               <default class="hidden"><geom group="3"/></default>
             </default>
             <worldbody>
               <geom size="1" material="red"/>
               <geom size="1" material="red" rgba="0 1 0 0.5" contype="0" conaffinity="0"/>
               <geom type="plane" size="3 4 0.1"/>
               <geom size="1" class="blue"/>
               <geom size="1" material="red" class="hidden"/>
             </worldbody>
           </mujoco>"#,
    )
    .model;
    let [ball, ghost, plane, inherited, hidden] = &model.shapes[..] else {
        panic!("five shapes")
    };
    assert_eq!(ball.color, Some([1.0, 0.0, 0.0, 1.0]));
    assert_eq!(ghost.color, Some([0.0, 1.0, 0.0, 0.5]));
    assert_eq!(plane.color, None);
    assert_eq!(inherited.color, Some([0.0, 0.0, 1.0, 1.0]));
    assert_eq!(hidden.color.map(|c| c[3]), Some(0.0));
    assert_eq!((ball.collides, ghost.collides), (true, false));
    let m = ball.material;
    let friction = [m.friction, m.torsional_friction, m.rolling_friction];
    assert_eq!(friction, [0.7, 0.02, 0.0001]);
    assert_eq!(
        plane.geometry,
        Geometry::Plane {
            half_x: 3.0,
            half_z: 4.0
        }
    );
    assert!(plane.pose.direction(DVec3::Y).abs_diff_eq(DVec3::Z, 1e-12));
}

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

/// MuJoCo's ranges act where the lower end is below the upper one. 0 0, its default, is none, and takes back what is
/// inherited, whether `autolimits` is on or off.
#[test]
fn ranges_of_0_0_are_none() {
    for (compiler, empty) in [("true", "0 0"), ("true", "1 1"), ("false", "0 0")] {
        let loaded = read(&format!(
            "<mujoco><compiler autolimits='{compiler}'/>
             <default><joint range='0 90' actuatorfrcrange='-1 1'/><tendon range='0 1'/>
               <motor ctrlrange='-1 1' forcerange='-2 2'/></default>
             <worldbody><body>
               <joint name='j' range='{empty}' actuatorfrcrange='{empty}'/><geom size='0.1'/>
             </body></worldbody>
             <tendon><fixed range='{empty}'><joint joint='j' coef='1'/></fixed></tendon>
             <actuator><motor joint='j' ctrlrange='{empty}' forcerange='{empty}'/></actuator></mujoco>"
        ));
        assert_eq!(loaded.model.joints[0].dofs[0].limit, None);
        let actuator = &loaded.model.actuators[0];
        let ranges = (actuator.control_range, actuator.force_range);
        assert_eq!(ranges, (None, None), "{empty}");
    }
}

/// The force is clamped to its own range, and behind the gear to its joint's, whether these meet or not.
#[test]
fn forces_are_clamped_to_the_range_of_the_joint_at_last() {
    let second = "<motor joint='j' gear='0'/>";
    for (own, other, expected) in [
        ("gear='-2' forcerange='-.25 5'", "", (-0.25, 0.5)),
        ("forcerange='5 10'", "", (1.0, 1.0)),
        ("forcerange='5 10' gear='-2'", "", (0.5, 0.5)),
        ("forcerange='-10 -5'", "", (-1.0, -1.0)),
        ("", second, (-1.0, 1.0)),
    ] {
        let loaded = read(&format!(
            "<mujoco><worldbody><body><joint name='j' actuatorfrcrange='-1 1'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' {own}/>{other}</actuator></mujoco>"
        ));
        let found = loaded.model.actuators[0].force_range;
        assert_eq!(found, Some(expected), "{own}");
        assert_eq!(loaded.warnings, []);
    }
}

/// What MuJoCo 4.0 makes of `ctrlrange` and `inheritrange` at several levels.
#[test]
fn the_last_of_two_ranges_of_a_control_holds() {
    let inherited = "<position inheritrange='1'/>";
    let range = "range='-1 1'";
    let servo = "biastype='affine' gainprm='2' biasprm='0 -2'";
    let general = format!("<general joint='j' ctrlrange='-3 3' {servo}/>");
    let no_servo = "<general joint='j' ctrlrange='-3 3' inheritrange='1'/>";
    let own = "<position joint='j' inheritrange='2'/>";
    let unlimited = "<position joint='j' ctrllimited='false'/>";
    for (default, joint, actuator, expected) in [
        (inherited, range, "<position joint='j'/>", Some((-1.0, 1.0))),
        (
            inherited,
            range,
            "<position joint='j' ctrlrange='-3 3'/>",
            Some((-3.0, 3.0)),
        ),
        (
            inherited,
            range,
            "<position joint='j' ctrlrange='0 0'/>",
            None,
        ),
        (
            inherited,
            range,
            "<position joint='j' inheritrange='0'/>",
            None,
        ),
        (inherited, range, unlimited, None),
        (inherited, range, "<motor joint='j'/>", None),
        (
            "<position ctrlrange='-3 3'/>",
            range,
            own,
            Some((-2.0, 2.0)),
        ),
        (
            "<general inheritrange='1'/>",
            range,
            general.as_str(),
            Some((-1.0, 1.0)),
        ),
        ("", range, no_servo, Some((-3.0, 3.0))),
        // The joint's range is taken whether it limits the joint or not.
        ("", "range='-1 1' limited='false'", own, Some((-2.0, 2.0))),
    ] {
        for flag in ["enable", "disable"] {
            let loaded = read(&format!(
                "<mujoco><compiler angle='radian'/><option><flag limit='{flag}'/></option>
                 <default>{default}</default>
                 <worldbody><body><joint name='j' {joint}/><geom size='0.1'/></body></worldbody>
                 <actuator>{actuator}</actuator></mujoco>"
            ));
            let found = loaded.model.actuators[0].control_range;
            assert_eq!(found, expected, "{default} {joint} {actuator}");
        }
    }
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

#[test]
fn contact_masks_are_the_shapes_kinds() {
    let model = read(
        "<mujoco><worldbody><geom size='1'/><geom size='1' contype='6' conaffinity='-1'/>\
         <geom size='1' contype='4294967295' conaffinity='0'/></worldbody></mujoco>",
    );
    assert!(model.warnings.is_empty());
    let shapes = model.model.shapes.iter();
    let masks: Vec<_> = shapes.map(|s| (s.membership, s.collides_with)).collect();
    assert_eq!(masks, [(1, 1), (6, u32::MAX), (u32::MAX, 0)]);
}

fn pairs(model: &Model) -> Vec<(usize, usize)> {
    let filter = CollisionFilter::new(model);
    filter.pairs().map(|(a, b)| (a.0, b.0)).collect()
}

/// A trunk with a limb, which has a welded thumb; all overlap.
fn limb(option: &str, contact: &str) -> Loaded {
    read(&format!(
        "<mujoco><option>{option}</option><worldbody>\
         <body name='trunk'><freejoint/><geom name='trunk' size='1'/>\
         <body name='limb'><joint/><geom name='limb' size='1' solref='0.001 1'/>\
         <body name='thumb'><geom name='thumb' size='1' solref='0.001 1'/></body></body></body>\
         </worldbody><contact>{contact}</contact></mujoco>"
    ))
}

/// Whether a softness has this time constant at the end of MuJoCo's standard impedance.
#[track_caller]
fn assert_time(softness: Softness, expected: f64) {
    let Softness::Time {
        constant,
        ratio,
        impedance,
        ..
    } = softness
    else {
        panic!("{softness:?}")
    };
    assert!((constant * impedance / 0.95 - expected).abs() < 1e-15 && ratio == 1.0);
    assert!((0.9..=0.95).contains(&impedance), "{impedance}");
}

#[test]
fn flags_let_parents_touch_and_contacts_be_stiff() {
    assert_eq!(pairs(&limb("", "").model), []);
    let open = limb("<flag filterparent='disable' refsafe='disable'/>", "").model;
    assert_eq!(pairs(&open), [(0, 1), (0, 2)]);
    assert_time(open.shapes[1].material.softness, 0.001);
    let safe = limb("", "").model;
    assert_time(safe.shapes[1].material.softness, 2.0 * 0.002);
}

#[test]
fn pairs_touch_in_spite_of_joints_unless_contacts_are_off() {
    let pair = "<pair geom1='thumb' geom2='trunk' friction='0.2 0.2'/>";
    let model = limb("", pair).model;
    assert_eq!(pairs(&model), [(0, 2)]);
    let material = model.contact_material(ShapeId(0), ShapeId(2));
    assert_eq!((material.friction, material.torsional_friction), (0.2, 0.0));
    assert_time(material.softness, 0.02);
    let off = limb("<flag contact='disable'/>", pair).model;
    assert_eq!(pairs(&off), []);
    let still = limb("", "<pair geom1='thumb' geom2='thumb'/>");
    assert_eq!(
        lines(&still.warnings),
        ["robot.xml:1: <pair>: pair: left out, for its geoms never move against each other"]
    );
}

/// The mount is massless, and fused with the trunk.
#[test]
fn exclusions_of_fused_bodies_are_those_of_what_they_are_fused_with() {
    let model = read(
        "<mujoco><worldbody>\
         <body name='other'><freejoint/><geom size='1'/></body>\
         <body name='trunk'><freejoint/><geom size='1'/>\
         <body name='mount'><geom size='1' mass='0'/>\
         <body name='limb'><joint/><geom size='1'/></body></body></body>\
         </worldbody><contact><exclude body1='mount' body2='other'/>\
         <exclude body1='trunk' body2='mount'/></contact></mujoco>",
    )
    .model;
    assert_eq!(model.bodies.len(), 3);
    assert!(model.exclusions.contains(&(Some(BodyId(1)), BodyId(0))));
    assert_eq!(pairs(&model), [(0, 3)]);
}

#[test]
fn stiffness_and_damping_of_contacts_are_time_and_ratio() {
    let text = "<geom size='1' solref='-400 -20' solimp='0.6 0.6 0.01'/>";
    let model = read(&format!("<mujoco><worldbody>{text}</worldbody></mujoco>"));
    assert!(model.warnings.is_empty());
    let material = model.model.shapes[0].material;
    assert_eq!(material.combine, Combine::Maximum);
    assert_eq!(
        material.softness,
        Softness::Time {
            constant: 0.1,
            ratio: 0.5,
            impedance: 0.6,
            mass: None,
        }
    );
}

#[test]
fn materials_of_bodies_of_any_mass_mix_as_in_mujoco() {
    let ball = |mass: f64| format!("<body><freejoint/><geom size='1' mass='{mass}'/></body>");
    let balls: String = [0.1, 2.0, 30.0].map(ball).concat();
    let floor = "<geom type='plane' size='1 1 1'/>";
    let model = read(&format!(
        "<mujoco><worldbody>{floor}{balls}</worldbody></mujoco>"
    ))
    .model;
    assert_eq!(pairs(&model).len(), 6);
    assert!(model.contact_pairs.is_empty());
}

/// Where `condim` or `priority` mix a surface, it has the friction that its geoms are given later.
#[test]
fn mixed_surfaces_follow_the_friction_of_their_geoms() {
    let ball = |surface: &str| format!("<body><freejoint/><geom size='1' {surface}/></body>");
    let smooth = ball("condim='1' friction='0.9' solref='0.05 1'");
    let first = ball("priority='1' friction='0.3' solref='0.05 1'");
    let floor = "<geom type='plane' size='1 1 1' friction='0.7'/>";
    let model = read(&format!(
        "<mujoco><worldbody>{floor}{smooth}{smooth}{first}</worldbody></mujoco>"
    ))
    .model;
    let mixed = |model: &Model| {
        let shapes = [(0, 1), (1, 2), (0, 3), (1, 3)];
        shapes.map(|(a, b)| model.contact_material(ShapeId(a), ShapeId(b)).friction)
    };
    assert!(!model.contact_pairs.is_empty());
    assert_eq!(mixed(&model), [0.9, 0.0, 0.3, 0.3]);
    let mut parts = model.into_parts();
    for (shape, friction) in parts.shapes.iter_mut().zip([0.1, 0.05, 0.05, 0.2]) {
        shape.material.friction = friction;
        shape.material.restitution = 0.5;
    }
    let model = Model::new(parts).unwrap();
    assert_eq!(mixed(&model), [0.1, 0.0, 0.2, 0.2]);
    let bounces = |pair: &model::ContactPair| pair.material.restitution == 0.5;
    assert!(model.contact_pairs.iter().all(bounces));
}

/// A ball of 2 kg: a pyramid's edges make its contact p = μ² (1 + μ²) / (i (c − 1)) times as soft, a cone's do not.
#[test]
fn pyramids_of_friction_soften_contacts() {
    let mass = |option: &str, surface: &str| {
        let ball = format!("<geom size='1' mass='2' {surface}/>");
        let loaded = read(&format!(
            "<mujoco><option {option}/><worldbody><body><freejoint/>{ball}</body></worldbody></mujoco>"
        ));
        assert!(loaded.warnings.is_empty());
        match loaded.model.shapes[0].material.softness {
            Softness::Time { mass, .. } => mass.expect("a mass of its own"),
            spring @ Softness::Spring { .. } => panic!("{spring:?}"),
        }
    };
    let near = |found: f64, expected: f64| assert!((found - expected).abs() < 1e-12 * expected);
    near(mass("", ""), 2.0);
    near(mass("", "friction='2'"), 2.0 / 10.0);
    near(mass("", "friction='2' condim='6'"), 2.0 / 4.0);
    near(mass("", "friction='2' condim='1'"), 2.0);
    near(mass("", "friction='0'"), 2.0 / 1e-3);
    near(mass("impratio='5'", "friction='2'"), 2.0 / 2.0);
    near(mass("cone='elliptic'", "friction='2'"), 2.0);
}

#[test]
fn tendons_without_force_are_noted() {
    let fixed = "<tendon><fixed><joint joint='a' coef='1'/></fixed></tendon>";
    let body = "<body><joint name='a'/><geom size='1'/></body>";
    let loaded = read(&format!(
        "<mujoco><worldbody>{body}</worldbody>{fixed}</mujoco>"
    ));
    assert_eq!(
        lines(&loaded.warnings),
        ["robot.xml:1: <fixed>: tendons: exert no force; not read"]
    );
}

/// The first number of `gear` counts, squared, for all degrees of freedom of a joint: MuJoCo 4.0's mass matrix and
/// passive forces.
#[test]
fn rotors_reflect_on_all_of_a_joint() {
    for (kind, count, gear, factor) in [
        ("hinge", 1, "3", 9.0),
        ("ball", 3, "0 2 0", 0.0),
        ("ball", 3, "3", 9.0),
        ("free", 6, "0 0 0 5", 0.0),
        ("free", 6, "3", 9.0),
    ] {
        let model = read(&format!(
            "<mujoco><worldbody><body><joint name='j' type='{kind}'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' armature='2' damping='5' gear='{gear}'/></actuator></mujoco>"
        ))
        .model;
        let found = model.joints[0].dofs.iter();
        let found: Vec<_> = found.map(|dof| (dof.armature, dof.damping)).collect();
        assert_eq!(
            found,
            vec![(2.0 * factor, 5.0 * factor); count],
            "{kind} {gear}"
        );
    }
}

/// As in MuJoCo 4.0, where an `orientation` has no rotor; a tendon's is left out with it.
#[test]
fn rotors_of_actuators_that_are_left_out_stay() {
    let rotor = "armature='2' damping='5' gear='3'";
    for (kind, actuator, factor) in [
        ("hinge", format!("<muscle joint='j' {rotor}/>"), 9.0),
        ("hinge", format!("<pid joint='j' {rotor}/>"), 9.0),
        (
            "hinge",
            format!("<general joint='j' dyntype='integrator' {rotor}/>"),
            9.0,
        ),
        (
            "hinge",
            format!("<position joint='j' timeconst='1' {rotor}/>"),
            9.0,
        ),
        ("ball", format!("<position joint='j' {rotor}/>"), 9.0),
        ("ball", format!("<motor jointinparent='j' {rotor}/>"), 9.0),
        ("ball", "<orientation joint='j' class='c'/>".to_owned(), 0.0),
        ("hinge", format!("<motor tendon='t' {rotor}/>"), 0.0),
    ] {
        let loaded = lenient(&format!(
            "<mujoco><default><default class='c'><general {rotor}/></default></default>
             <worldbody><body><joint name='j' type='{kind}'/><geom size='1'/></body></worldbody>
             <actuator>{actuator}</actuator></mujoco>"
        ));
        assert_eq!(
            loaded.warnings.len(),
            1,
            "{actuator}: {:?}",
            loaded.warnings
        );
        for dof in &loaded.model.joints[0].dofs {
            let found = (dof.armature, dof.damping);
            assert_eq!(found, (2.0 * factor, 5.0 * factor), "{actuator}");
        }
    }
}

/// They exert no force in MuJoCo, but their rotors go along.
#[test]
fn actuators_that_are_switched_off_are_noted() {
    for (option, told) in [
        (
            "<option actuatorgroupdisable='2'/>",
            "its group is in `actuatorgroupdisable`",
        ),
        (
            "<option><flag actuation='disable'/></option>",
            "the flag `actuation` is off",
        ),
    ] {
        let loaded = read(&format!(
            "<mujoco>{option}<default><motor group='2'/></default>
             <worldbody><body><joint name='j' actuatorfrcrange='-1 1'/><geom size='1'/></body></worldbody>
             <actuator><motor joint='j' armature='3' damping='2'/><motor tendon='t'/></actuator></mujoco>"
        ));
        let told = format!("robot.xml:3: <motor>: actuator: left out, for {told}");
        assert_eq!(lines(&loaded.warnings), [told]);
        assert_eq!(loaded.model.actuators, []);
        let dof = &loaded.model.joints[0].dofs[0];
        assert_eq!((dof.armature, dof.damping), (3.0, 2.0));
    }
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

#[test]
fn planes_that_move_are_noted() {
    let body = |joint: &str| {
        let plane = "<geom type='plane' size='1 1 1'/>";
        let loaded = read(&format!(
            "<mujoco><worldbody>{plane}<body>{joint}<geom size='1'/>\n{plane}</body></worldbody></mujoco>"
        ));
        lines(&loaded.warnings)
    };
    let told = "robot.xml:2: <geom>: a plane of a body that moves: a half space that goes along with it; MuJoCo refuses \
                it";
    assert_eq!(body("<joint/>"), [told]);
    assert_eq!(body(""), [""; 0]);
}

#[test]
fn times_of_keyframes_are_noted() {
    let key = |key: &str| {
        let text = format!("<mujoco><keyframe>\n<key {key}/></keyframe></mujoco>");
        lines(&read(&text).warnings)
    };
    let told = "robot.xml:2: <key>: attribute `time`: simulations start at 0";
    assert_eq!(key("time='2.5'"), [told]);
    assert_eq!(key("time='0'"), [""; 0]);
}

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

/// A mount without mass becomes part of its body, and its cameras go there, too.
#[test]
fn cameras_of_a_massless_body_are_its_carrier_s() {
    let model = |inner: &str| {
        let text = format!(
            r#"<mujoco><worldbody><body pos="1 2 3" euler="10 20 30"><freejoint/><geom size="0.1"/>
                 {inner}
               </body></worldbody></mujoco>"#
        );
        read(&text).model
    };
    let cameras = r#"<camera name="a" pos="1 0 0" euler="0 0 40"/><camera name="b" mode="track" pos="0 1 0"/>"#;
    let fused = model(&format!(
        r#"<body pos="0 0 1" euler="50 0 0">{cameras}</body>"#
    ));
    let framed = model(&format!(
        r#"<frame pos="0 0 1" euler="50 0 0">{cameras}</frame>"#
    ));
    assert_eq!((fused.bodies.len(), fused.cameras.len()), (1, 2));
    for (one, other) in fused.cameras.iter().zip(&framed.cameras) {
        assert_eq!((one.body, one.mode), (other.body, other.mode));
        assert!(
            one.pose.position.abs_diff_eq(other.pose.position, 1e-12),
            "{one:?} {other:?}"
        );
        assert!(
            one.pose
                .orientation
                .abs_diff_eq(other.pose.orientation, 1e-12),
            "{one:?} {other:?}"
        );
    }
}

#[test]
fn cameras_that_cannot_be_had_are_told() {
    let loaded = read(
        r#"<mujoco><worldbody>
             <camera name="a" projection="orthographic" fovy="2"/>
             <camera name="b" mode="trackcom" principal="0.1 0"/>
             <camera/>
           </worldbody></mujoco>"#,
    );
    let names: Vec<_> = loaded
        .model
        .cameras
        .iter()
        .map(|c| c.name.as_str())
        .collect();
    assert_eq!(names, ["b", "camera_1"]);
    assert_eq!(
        lines(&loaded.warnings),
        [
            "robot.xml:2: <camera>: orthographic cameras: not read",
            "robot.xml:3: <camera>: attribute `principal`: the optical axis is in the middle of the image",
            "robot.xml:3: <camera>: mode `trackcom`: it goes along with its body's origin, not with the centre of mass",
        ]
    );
    let broken = |camera: &str| {
        let text = format!("<mujoco><worldbody>{camera}</worldbody></mujoco>");
        let read = parse(
            &text,
            "robot.xml",
            &InMemory::default(),
            &Options::default(),
        );
        read.expect_err(camera).to_string()
    };
    assert!(broken(r#"<camera mode="ride"/>"#).contains("ride"));
    assert!(broken(r#"<camera sensorsize="1 1"/>"#).contains("give `focal` or `focalpixel`"));
    assert!(broken(r#"<camera fovy="180"/>"#).contains("field of view"));
    assert!(broken(r#"<camera resolution="-1 5"/>"#).contains("size [pixel]"));
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

/// MuJoCo's actuators are of group 0 unless they say otherwise.
#[test]
fn groups_of_actuators_without_actuators_may_be_switched_off() {
    let text = |group: &str| {
        format!(
            "<mujoco><option actuatorgroupdisable='1 3'/><worldbody><body><joint name='j'/><geom size='1'/></body>
             </worldbody><actuator><motor joint='j'/><motor joint='j' group='{group}'/></actuator></mujoco>"
        )
    };
    let loaded = read(&text("2"));
    assert_eq!(
        (loaded.model.actuators.len(), loaded.warnings.len()),
        (2, 0)
    );
    let loaded = lenient(&text("3"));
    assert_eq!(
        (loaded.model.actuators.len(), loaded.warnings.len()),
        (1, 1)
    );
}
