//! Lamps, cameras and sensors.

use crate::common::{refuses, sound};
use glam::DVec3;
use kinetarium_model::{
    BodyId, JointId, Lamp, LampKind, Measurand, Model, Mount, Parts, Pose, Sensor,
};

#[test]
fn lamps() {
    fn with(p: &mut Parts, change: fn(&mut Lamp)) {
        let (cutoff, exponent) = (0.8, 10.0);
        let mut lamp = Lamp::new("torch", LampKind::Spot { cutoff, exponent });
        change(&mut lamp);
        p.lamps.push(lamp);
    }
    refuses(&[
        (
            |p| (0..2).for_each(|_| with(p, |_| {})),
            "two of kind lamp are named \"torch\"; rename one",
        ),
        (
            |p| with(p, |l| l.body = Some(BodyId(3))),
            "lamp \"torch\": its body is number 3, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| with(p, |l| l.pose.position.y = f64::NAN),
            "lamp \"torch\": pose is NaN; give a finite number",
        ),
        (
            |p| with(p, |l| l.color.y = -0.1),
            "lamp \"torch\": colour is -0.10000000149011612; it must not be negative",
        ),
        (
            |p| with(p, |l| l.attenuation = DVec3::ZERO),
            "lamp \"torch\": sum of its attenuation is 0; it must be above zero",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 0.0,
                        exponent: 1.0,
                    }
                })
            },
            "lamp \"torch\": cutoff [rad] is 0; it must be above zero",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 2.0,
                        exponent: 1.0,
                    }
                })
            },
            "lamp \"torch\": cutoff [rad] is 2; it must lie from 0 to 1.5707963267948966",
        ),
        (
            |p| {
                with(p, |l| {
                    l.kind = LampKind::Spot {
                        cutoff: 1.0,
                        exponent: 200.0,
                    }
                })
            },
            "lamp \"torch\": exponent is 200; it must lie from 0 to 128",
        ),
        (
            |p| p.lamps = vec![Lamp::new("torch", LampKind::Point); 300],
            "the model has 300 lamps, more than the 256 it may have; check the number, or split the model",
        ),
    ]);
}

#[test]
fn cameras() {
    refuses(&[
        (
            |p| p.cameras.push(p.cameras[0].clone()),
            "two of kind camera are named \"eye\"; rename one",
        ),
        (
            |p| p.cameras[0].body = Some(BodyId(3)),
            "camera \"eye\": its body is number 3, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| p.cameras[0].pose.position.y = f64::INFINITY,
            "camera \"eye\": pose is inf; give a finite number",
        ),
        (
            |p| p.cameras[0].field_of_view = 3.2,
            "camera \"eye\": field of view [rad] is 3.2; it must lie from 0.000001 to 3.141591653589793",
        ),
        (
            |p| p.cameras[0].size = Some([640, 0]),
            "camera \"eye\": size [pixel] is 0; it must lie from 1 to 16384",
        ),
    ]);
}

#[test]
fn sensors() {
    fn sensor(parts: &mut Parts, measurand: Measurand) -> &mut Sensor {
        parts.sensors.push(Sensor::new("eye", measurand));
        &mut parts.sensors[0]
    }
    const MOUNT: Mount = Mount {
        body: Some(BodyId(1)),
        pose: Pose::IDENTITY,
    };
    const FALL: Measurand = Measurand::Acceleration { mount: MOUNT };
    const JOINT: JointId = JointId(0);
    let mut parts = sound();
    sensor(&mut parts, FALL);
    Model::new(parts).unwrap();
    refuses(&[
        (
            |p| {
                sensor(p, FALL);
                sensor(p, FALL);
            },
            "two of kind sensor are named \"eye\"; rename one",
        ),
        (
            |p| sensor(p, FALL).noise = -1.0,
            "sensor \"eye\": noise is -1; it must not be negative",
        ),
        (
            |p| sensor(p, FALL).rate = Some(0.0),
            "sensor \"eye\": rate [Hz] is 0; it must be above zero",
        ),
        (
            |p| sensor(p, FALL).cutoff = Some(f64::NAN),
            "sensor \"eye\": cutoff is NaN; give a finite number",
        ),
        (
            |p| {
                let body = Some(BodyId(7));
                sensor(p, Measurand::CenterOfMass { body });
            },
            "sensor \"eye\": its body is number 7, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| {
                let mount = Mount::on(BodyId(7));
                sensor(p, Measurand::Distance { mount });
            },
            "sensor \"eye\": its body is number 7, but the model has 3, numbered from 0; use a number below 3",
        ),
        (
            |p| {
                sensor(p, Measurand::ActuatorForce { actuator: 1 });
            },
            "sensor \"eye\": its actuator is number 1, but the model has 1, numbered from 0; use a number below 1",
        ),
        (
            |p| {
                sensor(
                    p,
                    Measurand::JointPosition {
                        joint: JOINT,
                        axis: 1,
                    },
                );
            },
            "sensor \"eye\": its axis is number 1, but the model has 1, numbered from 0; use a number below 1",
        ),
        (
            |p| {
                sensor(p, Measurand::BallVelocity { joint: JOINT });
            },
            "sensor \"eye\": joint \"hinge\" has not what it measures; orientations and angular velocities are of ball joints, forces and torques of all but free ones",
        ),
    ]);
}
