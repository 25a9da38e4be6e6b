//! What sensors read of worlds on a device: all that they measure by, and no more.

use kinetarium_sensors::{Sensor, SensorKind, Sensors};
use model::{Axes, BodyId, JointId, Model, Mount, Pose, ShapeId};
use numbers::Memory;
use rigid::{Report, Solver};
use sim::{
    Address, Control, Device, DeviceError, DeviceWorlds, Processor, Simulation, SimulationSettings,
};
use std::ops::Range;
use std::sync::{Arc, Mutex};

/// How many numbers of the output have been read, how often, and how often it was filled.
type Count = Arc<Mutex<[usize; 3]>>;

/// A device whose outputs are what they are read at, and which counts what is read.
struct Told(Count);

impl Device<f32> for Told {
    fn name(&self) -> String {
        "told".into()
    }
    fn place(&self, _: Solver<'_>, _: usize) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        Ok(Box::new(Self(Arc::clone(&self.0))))
    }
}

impl DeviceWorlds<f32> for Told {
    fn write_state(&mut self, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_worlds(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_input(&mut self, _: Range<usize>, _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn write_parameters(&mut self, _: &[usize], _: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn step(&mut self, _: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn report(&mut self, _: Report) -> Result<(), DeviceError> {
        self.0.lock().unwrap()[2] += 1;
        Ok(())
    }
    fn read_state(&mut self, _: &[Range<usize>], _: &mut Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read_output(
        &mut self,
        numbers: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for at in numbers.iter().cloned().flatten() {
            output.fill(at, 0.3 + (0.618 * at as f32).fract());
            self.0.lock().unwrap()[0] += 1;
        }
        self.0.lock().unwrap()[1] += 1;
        Ok(())
    }
    fn input_address(&self) -> Result<Option<Address>, DeviceError> {
        Ok(Some(Address { card: 0, at: 64 }))
    }
}

fn humanoid() -> Model {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../session/models/humanoid.xml"
    );
    let options = formats::Options::default();
    formats::load(path.as_ref(), &options).unwrap().model
}

fn body(model: &Model, name: &str) -> BodyId {
    let at = model.bodies.iter().position(|b| b.name == name);
    BodyId(at.unwrap_or_else(|| panic!("no body {name}")))
}

/// One of each kind, but for cameras, and the most numbers that it has to read; the foot has so many numbers of contacts.
fn kinds(model: &Model, rows: usize) -> Vec<(SensorKind, usize)> {
    let (torso, foot) = (body(model, "torso"), body(model, "right_foot"));
    let mount = Mount {
        body: Some(torso),
        pose: Pose::at(glam::DVec3::X * 0.1),
    };
    let beside = Mount {
        body: Some(foot),
        ..mount
    };
    let joint = model.actuators[0].joint;
    let (motion, acceleration) = (13, 6);
    let coordinates = |joint| model.coordinate_range(joint).len();
    let velocities = |joint| model.dof_range(joint).len();
    let other = model.actuators[1].joint;
    vec![
        (
            SensorKind::JointPosition {
                joints: vec![joint, JointId(0)],
            },
            coordinates(joint) + coordinates(JointId(0)),
        ),
        (
            SensorKind::JointVelocity {
                joints: vec![joint],
            },
            velocities(joint),
        ),
        (
            SensorKind::JointEffort {
                joints: vec![joint],
            },
            coordinates(joint) + velocities(joint),
        ),
        (
            SensorKind::ActuatorForce {
                actuators: vec![0, 1],
            },
            coordinates(joint) + velocities(joint) + coordinates(other) + velocities(other),
        ),
        (SensorKind::Imu { mount }, motion + acceleration),
        (SensorKind::ForceTorque { joint, frame: None }, motion + 6),
        (SensorKind::Touch { body: foot }, rows),
        (
            SensorKind::ContactForce {
                body: foot,
                axes: Axes::Own,
            },
            rows + motion,
        ),
        (
            SensorKind::FramePose {
                mount,
                relative_to: beside,
            },
            2 * motion,
        ),
        (
            SensorKind::FrameVelocity {
                mount,
                axes: Axes::Own,
            },
            motion,
        ),
        (
            SensorKind::CenterOfMass { body: None },
            model.bodies.len() * motion,
        ),
        (
            SensorKind::Rangefinder {
                mount,
                max_range: 10.0,
            },
            model.bodies.len() * motion,
        ),
    ]
}

/// What a sensor measures does not depend on whether all else is known, too.
#[test]
fn sensors_read_what_they_measure_by_and_no_more() {
    let model = humanoid();
    let count = Count::default();
    let placed = || {
        let settings = SimulationSettings::new(2, 0.003);
        let device = Told(Arc::clone(&count));
        let mut simulation = Simulation::on(&device, model.clone(), settings).unwrap();
        let control = vec![0.3; model.actuators.len()];
        for world in 0..2 {
            let mut controls = simulation.controls();
            controls.set_control(world, &control).unwrap();
        }
        simulation
    };
    let read = |simulation: &mut Simulation<f32>, kind: &SensorKind| {
        let before = *count.lock().unwrap();
        let list = vec![Sensor::new("s", kind.clone())];
        let sensors = Sensors::new(simulation, list, 0).unwrap();
        let numbers = sensors.reading("s").unwrap().numbers.to_vec();
        let after = *count.lock().unwrap();
        assert!(after[1] - before[1] <= 1, "{kind:?} is read at once");
        (numbers, after[0] - before[0])
    };
    let mut known = placed();
    let outputs = known.try_outputs().unwrap();
    let foot = body(&model, "right_foot");
    let rows = |of: Option<BodyId>| {
        let is_one = |shape: ShapeId| of.is_none() || model.shapes[shape.0].body == of;
        outputs.contact_rows(is_one).len()
    };
    let (own, all) = (rows(Some(foot)), rows(None));
    assert!(own < all, "others have contacts, too");
    for (kind, most) in kinds(&model, 11 * own) {
        let (numbers, fetched) = read(&mut placed(), &kind);
        assert!(numbers.iter().any(|x| *x != 0.0), "{kind:?}: {numbers:?}");
        assert!(0 < fetched && fetched <= most, "{kind:?}: {fetched}");
        let (of_all, more) = read(&mut known, &kind);
        assert_eq!(numbers, of_all, "{kind:?}");
        assert_eq!(more, 0, "{kind:?}");
    }
}

#[test]
fn sensors_that_are_due_are_read_together() {
    let model = humanoid();
    let count = Count::default();
    let settings = SimulationSettings::new(2, 0.003);
    let mut simulation =
        Simulation::on(&Told(Arc::clone(&count)), model.clone(), settings).unwrap();
    let all = kinds(&model, 0).into_iter().enumerate();
    let list = all.map(|(i, (kind, _))| Sensor::new(format!("s{i}"), kind));
    let mut sensors = Sensors::new(&mut simulation, list.collect(), 0).unwrap();
    assert_eq!(count.lock().unwrap()[1], 1);
    sensors.step(&mut simulation, 3).unwrap();
    assert_eq!(count.lock().unwrap()[1], 4);
    sensors.update(&mut simulation).unwrap();
    assert_eq!(count.lock().unwrap()[1], 4);
}

/// One with contacts and one with accelerations, which need more.
fn at_two_rates(count: &Count) -> (Simulation<f32>, Sensors<f32>) {
    let model = humanoid();
    let settings = SimulationSettings::new(2, 0.003);
    let mut simulation = Simulation::on(&Told(Arc::clone(count)), model.clone(), settings).unwrap();
    let touch = SensorKind::Touch {
        body: body(&model, "right_foot"),
    };
    let imu = SensorKind::Imu {
        mount: Mount::on(body(&model, "torso")),
    };
    let mut slow = Sensor::new("imu", imu);
    slow.rate = Some(1.0 / 0.006);
    let list = vec![Sensor::new("touch", touch), slow];
    let sensors = Sensors::new(&mut simulation, list, 0).unwrap();
    (simulation, sensors)
}

/// All that is due is reported at once, whichever sensor comes first.
#[test]
fn sensors_of_two_rates_that_are_due_are_reported_once() {
    let count = Count::default();
    let (mut simulation, mut sensors) = at_two_rates(&count);
    let reports = || count.lock().unwrap()[2];
    assert_eq!(reports(), 1);
    sensors.step(&mut simulation, 1).unwrap();
    assert_eq!(reports(), 2, "the touch alone");
    sensors.step(&mut simulation, 1).unwrap();
    assert_eq!(reports(), 3, "both");
}

/// Accelerations hang on controls, which others may have set.
#[test]
fn what_is_sampled_anew_is_reported_anew_where_others_set_controls() {
    let count = Count::default();
    let (mut simulation, mut sensors) = at_two_rates(&count);
    let reports = || count.lock().unwrap()[2];
    sensors.resample(&mut simulation).unwrap();
    assert_eq!(reports(), 1, "no controls were set");
    simulation.control_on_device(Control::Force).unwrap();
    for expected in [2, 3] {
        sensors.resample(&mut simulation).unwrap();
        assert_eq!(reports(), expected);
    }
}
