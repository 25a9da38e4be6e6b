//! Lights and cameras.

use crate::common::{lines, read};
use glam::{DVec3, Vec3};
use kinetarium_formats::{InMemory, Options, parse};
use model::{BodyId, CameraMode, Lamp, LampKind};

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
