//! Sensors of MJCF files: what they become, what is left out, and what is refused. Readings are compared with
//! MuJoCo's in `python/tests/test_file_sensors.py`.

use glam::{DQuat, DVec3};
use kinetarium_formats::{InMemory, Loaded, Options, parse};
use model::{Axes, BodyId, JointId, Measurand, Mount, Pose, Sensor};
use std::f64::consts::FRAC_1_SQRT_2;

/// An arm of two joints, with a massless mount on the hand, and a ball that floats.
const ROBOT: &str = r#"
  <worldbody>
    <site name="origin"/>
    <body name="arm">
      <joint name="swing"/><joint name="twist" axis="1 0 0"/>
      <geom name="bone" size="0.1" pos="0 0 0.5"/>
      <body name="mount" pos="0 0 1"><site name="palm" pos="0 0.5 0" euler="0 0 90"/></body>
    </body>
    <body name="ball"><freejoint name="float"/><geom size="0.1"/><site name="shell"/></body>
  </worldbody>
  <actuator><motor name="motor" joint="twist"/></actuator>"#;

fn try_read(sensors: &str, lenient: bool) -> Result<Loaded, String> {
    let text = format!("<mujoco>{ROBOT}\n<sensor>{sensors}</sensor></mujoco>");
    let options = Options {
        lenient,
        ..Options::default()
    };
    let loaded = parse(&text, "robot.xml", &InMemory::default(), &options);
    let mut loaded = loaded.map_err(|error| error.to_string())?;
    // That the mount is part of the arm is told each time.
    loaded.warnings.retain(|warning| warning.element != "body");
    Ok(loaded)
}

fn read(sensors: &str) -> Vec<Sensor> {
    let loaded = try_read(sensors, false).unwrap();
    assert_eq!(loaded.warnings, []);
    loaded.model.sensors.clone()
}

#[test]
fn sensors_are_of_what_they_name() {
    let [a, b, c] = &read(
        r#"<jointpos joint="twist" noise="0.1" interval="0.02"/>
           <jointpos name="jointpos" joint="swing" cutoff="3" interval="0 0"/>
           <actuatorfrc actuator="motor"/>"#,
    )[..] else {
        panic!("three sensors")
    };
    // Two joints of a body are one joint of two axes.
    let joint = JointId(0);
    let twist = Measurand::JointPosition { joint, axis: 1 };
    assert_eq!(
        *a,
        Sensor {
            rate: Some(50.0),
            noise: 0.1,
            ..Sensor::new("jointpos_2", twist)
        }
    );
    let swing = Measurand::JointPosition { joint, axis: 0 };
    assert_eq!(
        *b,
        Sensor {
            cutoff: Some(3.0),
            ..Sensor::new("jointpos", swing)
        }
    );
    assert_eq!(c.measurand, Measurand::ActuatorForce { actuator: 0 });
}

/// A site is placed in its body, and in what that is fused with.
#[test]
fn frames_go_along_with_fused_bodies() {
    let sensors = read(
        r#"<gyro name="g" site="palm"/>
           <framepos name="p" objtype="xbody" objname="mount" reftype="site" refname="palm"/>
           <framelinvel name="v" objtype="geom" objname="bone"/>
           <framequat name="q" objtype="site" objname="origin" cutoff="0.1"/>"#,
    );
    let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    let at = |mount: Mount, position: DVec3, turn: DQuat| {
        assert_eq!(mount.body, Some(BodyId(0)));
        assert!((mount.pose.position - position).length() < 1e-15);
        assert!(mount.pose.orientation.dot(turn).abs() > 1.0 - 1e-15);
    };
    let palm = DVec3::new(0.0, 0.5, 1.0);
    let Measurand::AngularVelocity { mount, axes } = sensors[0].measurand else {
        panic!("{:?}", sensors[0]);
    };
    assert_eq!(axes, Axes::Own);
    at(mount, palm, turn);
    let Measurand::Position { mount, relative_to } = sensors[1].measurand else {
        panic!("{:?}", sensors[1]);
    };
    at(mount, DVec3::Z, DQuat::IDENTITY);
    at(relative_to, palm, turn);
    let Measurand::Velocity { mount, axes } = sensors[2].measurand else {
        panic!("{:?}", sensors[2]);
    };
    assert_eq!(axes, Axes::World);
    at(mount, DVec3::new(0.0, 0.0, 0.5), DQuat::IDENTITY);
    let world = Mount::in_world(Pose::IDENTITY);
    let still = Measurand::Orientation {
        mount: world,
        relative_to: world,
    };
    // What is of unit length is not cut off.
    assert_eq!(sensors[3], Sensor::new("q", still));
}

/// MuJoCo 4.0 has these at (1/2, 1, 3/2) and (1/2, 0, 0), with quaternions (0.3148, 0.8489, −0.4245, 0) and
/// (0.7071, 0, −0.7071, 0) of w, x, y, z.
#[test]
fn sites_may_lie_between_two_points() {
    let text = r#"<mujoco><worldbody>
        <site name="slant" type="capsule" fromto="0 0 0 1 2 3"/>
        <site name="lying" type="box" size="0.1" fromto="0 0 0 1 0 0"/></worldbody>
      <sensor><gyro site="slant"/><gyro site="lying"/></sensor></mujoco>"#;
    let files = InMemory::default();
    let loaded = parse(text, "robot.xml", &files, &Options::default()).unwrap();
    let slant = [
        0.848_948_461_506_886_3,
        -0.424_474_230_753_443_15,
        0.0,
        0.314_814_448_733_477_64,
    ];
    let lying = [0.0, -FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];
    let expected = [([0.5, 1.0, 1.5], slant), ([0.5, 0.0, 0.0], lying)];
    for (sensor, (position, turn)) in loaded.model.sensors.iter().zip(expected) {
        let Measurand::AngularVelocity { mount, .. } = sensor.measurand else {
            panic!("{sensor:?}");
        };
        let middle = DVec3::from_array(position);
        assert!(mount.pose.position.abs_diff_eq(middle, 1e-12), "{mount:?}");
        let cosine = mount.pose.orientation.dot(DQuat::from_array(turn));
        assert!(cosine.abs() > 1.0 - 1e-12, "{mount:?}");
    }
}

/// Static bodies have no mass here, and no joint ties what hangs on a static one of theirs; MuJoCo counts both.
#[test]
fn centers_of_mass_are_not_of_static_bodies() {
    let read = |robot: &str, body: &str| {
        let text = format!(
            "<mujoco><worldbody><geom size='1'/>{robot}</worldbody>\
             <sensor><subtreecom body='{body}'/></sensor></mujoco>"
        );
        let files = InMemory::default();
        parse(&text, "robot.xml", &files, &Options::default()).unwrap()
    };
    let drawer = "<body name='drawer'><joint type='slide'/><geom size='0.1'/></body>";
    let table = &format!("<body name='table'><geom size='0.1'/>{drawer}</body>");
    let frames = &format!("<body name='outer'><body name='inner'>{drawer}</body></body>");
    let goal = &format!("<body name='goal'><geom size='1' mass='0'/></body>{drawer}");
    let mount = &format!("<body name='base'><body name='mount'/>{drawer}</body>");
    for (robot, body, row) in [
        (goal, "world", None),
        (mount, "base", Some(BodyId(0))),
        (table, "drawer", Some(BodyId(1))),
        (frames, "world", None),
        (frames, "inner", Some(BodyId(1))),
    ] {
        let measurand = Measurand::CenterOfMass { body: row };
        let loaded = read(robot, body);
        assert_eq!(loaded.model.sensors[0].measurand, measurand, "{body}");
        assert_eq!(loaded.warnings, []);
    }
    for (robot, body) in [(table, "table"), (table, "world"), (frames, "outer")] {
        let loaded = read(robot, body);
        assert_eq!(loaded.model.sensors, [], "{body}");
        let told = "robot.xml:1: <subtreecom>: of static bodies, which have no mass here: not read";
        assert_eq!(loaded.warnings[0].to_string(), told);
    }
}

#[test]
fn what_is_not_read_is_listed() {
    let cases = [
        (
            "<magnetometer site='palm'/>",
            "<magnetometer>: sensors of this kind: not read",
        ),
        (
            "<force site='palm'/>",
            "<force>: at a body that is fused with its parent: not read",
        ),
        (
            "<torque site='shell'/>",
            "<torque>: at a body that no joint holds: not read",
        ),
        (
            "<force site='origin'/>",
            "<force>: at a body that no joint holds: not read",
        ),
        (
            "<touch site='origin'/>",
            "<touch>: at a site of the world: not read",
        ),
        (
            "<subtreecom body='mount'/>",
            "<subtreecom>: of a body that is fused with its parent: not read",
        ),
        (
            "<rangefinder site='palm' data='dist normal'/>",
            "<rangefinder>: rangefinders that tell more than one distance: not read",
        ),
        (
            "<framequat objtype='body' objname='arm'/>",
            "<framequat>: the orientation of a geom or of principal axes: not read",
        ),
        (
            "<framepos objtype='site' objname='palm' reftype='geom' refname='bone'/>",
            "<framepos>: a frame of reference that is a geom's or along principal axes: not read",
        ),
        (
            "<frameangvel objtype='site' objname='palm' reftype='site' refname='shell'/>",
            "<frameangvel>: a velocity relative to a frame: not read",
        ),
        (
            "<framepos objtype='camera' objname='eye'/>",
            "<framepos>: the frame of a camera: not read",
        ),
    ];
    for (sensor, warning) in cases {
        let loaded = try_read(sensor, false).unwrap();
        assert_eq!(loaded.model.sensors, [], "{sensor}");
        let [found] = &loaded.warnings[..] else {
            panic!("{sensor}: {:?}", loaded.warnings);
        };
        assert_eq!(found.to_string(), format!("robot.xml:12: {warning}"));
    }
    let loaded = try_read("<gyro site='palm' delay='1'/>", false).unwrap();
    assert_eq!(loaded.model.sensors.len(), 1);
    let warning = "robot.xml:12: <gyro>: attribute `delay`: readings are told at once";
    assert_eq!(loaded.warnings[0].to_string(), warning);
    let off = ROBOT.replace(
        "<worldbody>",
        "<option><flag sensor='disable'/></option><worldbody>",
    );
    let text = format!("<mujoco>{off}<sensor><gyro site='palm'/></sensor></mujoco>");
    let loaded = parse(
        &text,
        "robot.xml",
        &InMemory::default(),
        &Options::default(),
    )
    .unwrap();
    assert_eq!(loaded.model.sensors, []);
}

/// MuJoCo reads zero there.
#[test]
fn forces_of_actuators_that_are_left_out_are_not_read() {
    let off = "<option><flag actuation='disable'/></option>";
    let text = |name: &str| {
        format!("<mujoco>{off}{ROBOT}\n<sensor><actuatorfrc actuator='{name}'/></sensor></mujoco>")
    };
    let files = InMemory::default();
    let read = |name| parse(&text(name), "robot.xml", &files, &Options::default());
    let loaded = read("motor").unwrap();
    assert_eq!(loaded.model.sensors, []);
    let told = "robot.xml:12: <actuatorfrc>: of an actuator that is left out: not read";
    assert_eq!(loaded.warnings.last().unwrap().to_string(), told);
    let unknown = read("mtor").unwrap_err().to_string();
    assert!(unknown.ends_with("did you mean `motor`?"), "{unknown}");
}

/// MuJoCo 4.0 reads 5 where the joint's force is clamped to 1.
#[test]
fn forces_that_are_clamped_to_their_joint_s_range_are_told() {
    let robot = ROBOT.replace("\"twist\" axis", "\"twist\" actuatorfrcrange=\"-1 1\" axis");
    let sensors = "<actuatorfrc actuator='motor'/><jointactuatorfrc joint='twist'/>";
    let text = format!("<mujoco>{robot}\n<sensor>{sensors}</sensor></mujoco>");
    let files = InMemory::default();
    let loaded = parse(&text, "robot.xml", &files, &Options::default()).unwrap();
    let told = "robot.xml:12: <actuatorfrc>: actuatorfrc: within the joint's `actuatorfrcrange`; MuJoCo tells the force \
                before it is clamped to that";
    assert_eq!(loaded.warnings.last().unwrap().to_string(), told);
    assert_eq!(loaded.model.sensors.len(), 2);
}

#[test]
fn bad_sensors_are_refused() {
    let cases = [
        (
            "<gyro site='plam'/>",
            "<gyro>: attribute `site` names `plam`, but no site has this name; did you mean `palm`?",
        ),
        (
            "<gyro/>",
            "<gyro>: attribute `site` is missing; write site=\"…\"",
        ),
        (
            "<jointpos joint='float'/>",
            "<jointpos>: attribute `joint` names a joint of another kind than is measured; name a hinge or slide joint",
        ),
        (
            "<ballquat joint='swing'/>",
            "<ballquat>: attribute `joint` names a joint of another kind than is measured; name a ball joint",
        ),
        (
            "<actuatorfrc actuator='mtor'/>",
            "<actuatorfrc>: attribute `actuator` names `mtor`, but no actuator has this name; did you mean `motor`?",
        ),
        (
            "<gyros site='palm'/>",
            "<gyros>: this is no sensor; correct its spelling, or remove it",
        ),
        (
            "<gyro site='palm' noise='-1'/>",
            "<gyro>: attribute `noise` is -1, below zero; write zero or a positive number",
        ),
        (
            "<gyro name='a' site='palm'/><gyro name='a' site='palm'/>",
            "<gyro>: attribute `name` is `a`, the name of another sensor; rename one of them",
        ),
        (
            "<framepos objtype='tendon' objname='a'/>",
            "<framepos>: attribute `objtype` is `tendon`; write one of: body, xbody, geom, site, camera",
        ),
    ];
    for (sensor, message) in cases {
        let error = try_read(sensor, false).unwrap_err();
        assert!(
            error.starts_with("robot.xml:12:") && error.ends_with(message),
            "{error}"
        );
    }
    let unnamed = ROBOT.replace("motor name=\"motor\"", "motor");
    let text = format!("<mujoco>{unnamed}<sensor><actuatorfrc actuator=''/></sensor></mujoco>");
    let files = InMemory::default();
    let error = parse(&text, "robot.xml", &files, &Options::default()).unwrap_err();
    assert!(
        error.to_string().contains("no actuator has this name"),
        "{error}"
    );
    let loaded = try_read("<actuatorfrc actuator='left out'/>", true).unwrap();
    assert_eq!(loaded.model.sensors, []);
}
