//! What is refused, and what is said then.

mod common;

use common::{eye, floating, pendulum, simulate};
use glam::DVec3;
use kinetarium_sensors::{
    Axes, Camera, ImageNoise, Level, Mount, Noise, Sensor, SensorError, SensorKind, Sensors, View,
};
use model::{BodyId, Builder, Drive, JointId, Pose};
use sim::{Simulation, SolverKind};

fn simulation() -> Simulation<f64> {
    simulate(&pendulum(), SolverKind::Featherstone, 2, 0.01)
}

fn make(list: Vec<Sensor>) -> Result<Sensors<f64>, SensorError> {
    Sensors::new(&mut simulation(), list, 0)
}

#[track_caller]
fn refused(kind: SensorKind, says: &[&str]) {
    refused_sensor(Sensor::new("s", kind), says);
}

#[track_caller]
fn refused_sensor(sensor: Sensor, says: &[&str]) {
    let error = make(vec![sensor]).unwrap_err().to_string();
    for says in [&["sensor `s`"], says].concat() {
        assert!(error.contains(says), "`{error}` does not say `{says}`");
    }
}

fn imu() -> SensorKind {
    let mount = Mount::on(BodyId(0));
    SensorKind::Imu { mount }
}

#[test]
fn names_are_unique_and_not_empty() {
    let both = vec![Sensor::new("a", imu()), Sensor::new("a", imu())];
    let error = make(both).unwrap_err();
    assert!(matches!(error, SensorError::SameName { name } if name == "a"));
    let error = make(vec![Sensor::new("a", imu()), Sensor::new("", imu())]).unwrap_err();
    assert!(matches!(error, SensorError::NoName { row: 1 }));
}

#[test]
fn sensors_that_are_not_there_are_not_read() {
    let sensors = make(vec![Sensor::new("a", imu()), Sensor::new("b", imu())]).unwrap();
    let error = sensors.reading("c").unwrap_err().to_string();
    assert_eq!(error, "there is no sensor \"c\"; there are a, b");
    let error = sensors.reading_at(2).unwrap_err();
    assert!(matches!(error, SensorError::NoSuchRow { row: 2, count: 2 }));
    let error = sensors.images("a").unwrap_err().to_string();
    assert!(error.contains("no camera"), "{error}");
    let view = View::new(Camera::new(4, 4, 1.0));
    let noise = ImageNoise::default();
    let sensors = make(vec![Sensor::new("eye", eye(view, noise))]).unwrap();
    let error = sensors.reading("eye").unwrap_err().to_string();
    assert!(error.contains("call `images`"), "{error}");
}

#[test]
fn bodies_and_joints_exist() {
    let (body, joint) = (BodyId(1), JointId(7));
    let mount = Mount::on(body);
    let no_body = ["body 1 does not exist: the model has 1"];
    let no_joint = ["joint 7 does not exist"];
    let joints = || vec![JointId(0), joint];
    refused(SensorKind::Imu { mount }, &no_body);
    refused(SensorKind::Touch { body }, &no_body);
    let axes = Axes::Own;
    refused(SensorKind::ContactForce { body, axes }, &no_body);
    refused(SensorKind::FrameVelocity { mount, axes }, &no_body);
    let relative_to = Mount::default();
    refused(SensorKind::FramePose { mount, relative_to }, &no_body);
    let (mount, relative_to) = (Mount::default(), Mount::on(body));
    refused(SensorKind::FramePose { mount, relative_to }, &no_body);
    refused(SensorKind::JointPosition { joints: joints() }, &no_joint);
    refused(SensorKind::JointVelocity { joints: joints() }, &no_joint);
    refused(SensorKind::JointEffort { joints: joints() }, &no_joint);
    let frame = None;
    refused(SensorKind::ForceTorque { joint, frame }, &no_joint);
    let view = View::new(Camera::new(4, 4, 1.0).on(body));
    let noise = ImageNoise::default();
    refused(eye(view, noise), &["on body 1"]);
    let joints = vec![];
    refused(
        SensorKind::JointPosition { joints },
        &["list of joints is empty"],
    );
}

#[test]
fn numbers_make_sense() {
    for rate in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused_sensor(Sensor::new("s", imu()).with_rate(rate), &["rate", "Hz"]);
    }
    for level in [-1.0, f64::NAN, f64::INFINITY] {
        let with = |noise| Sensor::new("s", imu()).with_noise(noise);
        refused_sensor(with(Noise::white(level)), &["standard deviation"]);
        let each = vec![0.0, 0.0, 0.0, 0.0, 0.0, level];
        refused_sensor(with(Noise::white(each)), &["standard deviation"]);
        let (bias, walk, step) = (Level::All(level), Level::All(level), Level::All(level));
        let noise = Noise::default;
        refused_sensor(with(Noise { bias, ..noise() }), &["bias"]);
        refused_sensor(with(Noise { walk, ..noise() }), &["walk"]);
        refused_sensor(with(Noise { step, ..noise() }), &["step"]);
    }
    let short = Sensor::new("s", imu()).with_noise(Noise::white(vec![0.1; 3]));
    refused_sensor(short, &["has 3 numbers, but the sensor has 6"]);

    let far = Pose::at(DVec3::new(f64::NAN, 0.0, 0.0));
    let mount = Mount::on(BodyId(0)).at(far);
    refused(SensorKind::Imu { mount }, &["pose of its mount"]);
    let (joint, frame) = (JointId(0), Some(far));
    refused(SensorKind::ForceTorque { joint, frame }, &["its frame"]);

    let mount = Mount::on(BodyId(0));
    for max_range in [0.0, -1.0, f64::NAN] {
        refused(
            SensorKind::Rangefinder { mount, max_range },
            &["largest range"],
        );
    }
    let lidar = |azimuths, elevations| SensorKind::Lidar {
        mount,
        azimuths,
        elevations,
        max_range: 1.0,
    };
    refused(lidar(vec![], vec![0.0]), &["azimuth is missing"]);
    refused(lidar(vec![0.0], vec![]), &["elevation is missing"]);
    refused(lidar(vec![0.0, f64::NAN], vec![0.0]), &["azimuth is NaN"]);
    refused(lidar(vec![0.0; 2000], vec![0.0; 2000]), &["number of rays"]);
    let view = View::new(Camera::new(0, 4, 1.0));
    let noise = ImageNoise::default();
    refused(eye(view, noise), &["width"]);
}

#[test]
fn parts_and_cutoffs_make_sense() {
    for part in [0..0, 4..7, 6..7] {
        refused_sensor(Sensor::new("s", imu()).with_part(part), &["its part is"]);
    }
    for cutoff in [0.0, -1.0, f64::NAN] {
        refused_sensor(Sensor::new("s", imu()).with_cutoff(cutoff), &["its cutoff"]);
    }
    let lidar = SensorKind::Lidar {
        mount: Mount::on(BodyId(0)),
        azimuths: vec![0.0, 1.0],
        elevations: vec![0.0],
        max_range: 1.0,
    };
    let message = ["a lidar sensor takes no part of its numbers: read it whole"];
    refused_sensor(Sensor::new("s", lidar).with_part(0..1), &message);
    let actuators = vec![0];
    refused(
        SensorKind::ActuatorForce { actuators },
        &["actuator 0 does not exist"],
    );
    let actuators = vec![];
    refused(
        SensorKind::ActuatorForce { actuators },
        &["list of actuators is empty"],
    );
    let body = Some(BodyId(1));
    refused(
        SensorKind::CenterOfMass { body },
        &["body 1 does not exist"],
    );
}

#[test]
fn what_a_kind_does_not_take_is_refused() {
    let view = View::new(Camera::new(4, 4, 1.0));
    let noise = ImageNoise::default();
    let noisy = Sensor::new("s", eye(view.clone(), noise)).with_noise(Noise::white(1.0));
    refused_sensor(noisy, &["camera", "noise"]);
    let cut = Sensor::new("s", eye(view.clone(), noise)).with_cutoff(1.0);
    refused_sensor(cut, &["camera", "cutoff"]);
    for level in [-0.1, f64::NAN, f64::INFINITY] {
        let rgb = ImageNoise {
            rgb: level,
            ..noise
        };
        refused(eye(view.clone(), rgb), &["noise of its colours"]);
        let depth = ImageNoise {
            depth: level,
            ..noise
        };
        refused(eye(view.clone(), depth), &["noise of its depth"]);
    }

    let mut simulation = simulate::<f64>(&floating(), SolverKind::Featherstone, 1, 0.01);
    let (joint, frame) = (JointId(0), None);
    let kind = SensorKind::ForceTorque { joint, frame };
    let error = Sensors::new(&mut simulation, vec![Sensor::new("s", kind)], 0);
    let error = error.unwrap_err().to_string();
    assert!(error.contains("free joint, as `body_free`"), "{error}");

    let mut world = Builder::new("lag");
    let object = world.object("");
    let body = common::body(object, "a", 1.0, DVec3::ZERO, DVec3::ONE);
    let drive = Drive {
        stiffness: 1.0,
        control_time: 0.1,
        ..Drive::default()
    };
    object.revolute("lagging", body, DVec3::X).drive(drive);
    let fixed = common::body(object, "b", 1.0, DVec3::ZERO, DVec3::ONE);
    object.fixed("fixed", fixed);
    let model = world.build().unwrap();
    let mut simulation = simulate::<f64>(&model, SolverKind::Featherstone, 1, 0.01);
    let mut of = |kind| {
        let list = vec![Sensor::new("s", kind)];
        Sensors::new(&mut simulation, list, 0)
            .unwrap_err()
            .to_string()
    };
    let error = of(SensorKind::JointEffort {
        joints: vec![JointId(0)],
    });
    assert!(error.contains("control time"), "{error}");
    let error = of(SensorKind::JointPosition {
        joints: vec![JointId(1)],
    });
    assert!(error.contains("without coordinates, as `fixed`"), "{error}");
}

#[test]
fn another_simulation_is_refused() {
    let mut sensors = make(vec![Sensor::new("a", imu())]).unwrap();
    let mut more = simulate::<f64>(&pendulum(), SolverKind::Featherstone, 3, 0.01);
    let error = sensors.update(&mut more).unwrap_err();
    assert!(matches!(error, SensorError::OtherSimulation));
    let mut other = simulate::<f64>(&floating(), SolverKind::Featherstone, 2, 0.01);
    let error = sensors.step(&mut other, 1).unwrap_err();
    assert!(matches!(error, SensorError::OtherSimulation));
    // One of an equal model is welcome.
    sensors.step(&mut simulation(), 1).unwrap();
}
