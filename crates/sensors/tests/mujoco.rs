//! Sensors against MuJoCo's own: on every model that gymnasium ships, at a random site of each body and at
//! random states; rays among solids of all kinds; touch of what rests.
//!
//! `cargo xtask peers` writes MuJoCo's readings as JSON and names the folder in `KINETARIUM_PEERS`.

mod common;

use glam::{DQuat, DVec3};
use kinetarium_sensors::{Axes, Mount, Sensor, SensorKind, Sensors};
use model::{BodyId, JointId, JointKind, Model, Pose};
use numbers::Float;
use serde::Deserialize;
use sim::{Simulation, SimulationSettings, SolverKind};
use std::collections::BTreeMap;
use std::path::PathBuf;

/// A file of `tests/peers/sensors.py`.
#[derive(Deserialize)]
struct Reference {
    path: PathBuf,
    lenient: bool,
    sensors: Vec<Described>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct Described {
    kind: String,
    #[serde(default)]
    body: usize,
    #[serde(default)]
    pos: [f64; 3],
    /// w, x, y, z.
    #[serde(default)]
    quat: [f64; 4],
    #[serde(default)]
    dof: usize,
}

#[derive(Deserialize)]
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    readings: Vec<Vec<f64>>,
}

fn reference(name: &str) -> (Reference, Model) {
    let folder = std::env::var("KINETARIUM_PEERS").expect("KINETARIUM_PEERS names the references");
    let path = PathBuf::from(folder).join(format!("sensors/{name}.json"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let reference: Reference = serde_json::from_str(&text).unwrap();
    let options = formats::Options {
        lenient: reference.lenient,
        ..formats::Options::default()
    };
    let loaded = formats::load(&reference.path, &options).unwrap_or_else(|e| panic!("{e}"));
    (reference, loaded.model)
}

/// From w, x, y, z.
fn quaternion([w, x, y, z]: [f64; 4]) -> DQuat {
    DQuat::from_xyzw(x, y, z, w)
}

/// MuJoCo's coordinates with quaternions as x, y, z, w.
fn position(model: &Model, state: &State) -> Vec<f64> {
    let mut q = state.qpos.clone();
    for (i, joint) in model.joints.iter().enumerate() {
        if matches!(joint.kind, JointKind::Ball | JointKind::Free) {
            let end = model.coordinate_range(JointId(i)).end;
            q[end - 4..end].rotate_left(1);
        }
    }
    q
}

/// The joint of a degree of freedom, and which of the joint's it is.
fn joint_of(model: &Model, dof: usize) -> (JointId, usize) {
    let ids = (0..model.joints.len()).map(JointId);
    let mut ranges = ids.map(|id| (id, model.dof_range(id)));
    let (id, range) = ranges.find(|(_, range)| range.contains(&dof)).unwrap();
    (id, dof - range.start)
}

impl Described {
    fn mount(&self) -> Mount {
        let pose = Pose::new(DVec3::from_array(self.pos), quaternion(self.quat));
        Mount::on(BodyId(self.body)).at(pose)
    }
    /// The same sensor here, and which of its numbers MuJoCo's are.
    fn ours(&self, model: &Model) -> (SensorKind, std::ops::Range<usize>) {
        let mount = self.mount();
        let reaction = || SensorKind::ForceTorque {
            joint: model.carrier(BodyId(self.body)).unwrap(),
            frame: Some(mount.pose),
        };
        let moves = |axes| SensorKind::FrameVelocity { mount, axes };
        let relative_to = Mount::default();
        let pose = SensorKind::FramePose { mount, relative_to };
        match self.kind.as_str() {
            "accelerometer" => (SensorKind::Imu { mount }, 0..3),
            "gyro" => (SensorKind::Imu { mount }, 3..6),
            "velocimeter" => (moves(Axes::Own), 0..3),
            "framelinvel" => (moves(Axes::World), 0..3),
            "frameangvel" => (moves(Axes::World), 3..6),
            "framepos" => (pose, 0..3),
            "framequat" => (pose, 3..7),
            "force" => (reaction(), 0..3),
            "torque" => (reaction(), 3..6),
            "jointactfrc" => {
                let (joint, at) = joint_of(model, self.dof);
                let joints = vec![joint];
                (SensorKind::JointEffort { joints }, at..at + 1)
            }
            "rangefinder" => {
                // MuJoCo's ray goes along z.
                let turn = DQuat::from_rotation_arc(DVec3::X, DVec3::Z);
                let mount = mount.at(mount.pose * Pose::new(DVec3::ZERO, turn));
                let max_range = f64::INFINITY;
                (SensorKind::Rangefinder { mount, max_range }, 0..1)
            }
            "touch" => {
                let body = BodyId(self.body);
                (SensorKind::Touch { body }, 0..1)
            }
            other => panic!("no sensor is as MuJoCo's {other}"),
        }
    }
    /// MuJoCo's reading as ours are.
    fn converted(&self, reading: &[f64], ours: &[f64]) -> Vec<f64> {
        match self.kind.as_str() {
            // Both signs mean the same rotation.
            "framequat" => {
                let theirs = quaternion([0, 1, 2, 3].map(|i| reading[i]));
                let sign = theirs.dot(DQuat::from_slice(ours)).signum();
                (theirs * sign).to_array().to_vec()
            }
            "rangefinder" if reading[0] < 0.0 => vec![f64::INFINITY],
            _ => reading.to_vec(),
        }
    }
}

/// Largest error of each kind of sensor, over 1 or the length of MuJoCo's reading, whichever is more.
fn errors<T: Float>(
    (reference, model): &(Reference, Model),
    solver: SolverKind,
    steps: usize,
) -> BTreeMap<String, f64> {
    let settings = SimulationSettings {
        threads: 1,
        solver,
        contacts: steps > 0,
        ..SimulationSettings::new(reference.states.len(), model.time_step)
    };
    let mut simulation = Simulation::<T>::new(model.clone(), settings).unwrap();
    for (world, state) in reference.states.iter().enumerate() {
        simulation
            .set_joint_state(world, &position(model, state), &state.qvel)
            .unwrap();
        simulation
            .controls()
            .set_control(world, &state.ctrl)
            .unwrap();
    }
    simulation.step(steps);
    let ours: Vec<_> = reference.sensors.iter().map(|s| s.ours(model)).collect();
    let list = ours.iter().enumerate();
    let list = list.map(|(i, (kind, _))| Sensor::new(i.to_string(), kind.clone()));
    let sensors = Sensors::new(&mut simulation, list.collect(), 0).unwrap();
    let mut worst = BTreeMap::new();
    for (row, (described, (_, part))) in reference.sensors.iter().zip(ours).enumerate() {
        let reading = sensors.reading_at(row).unwrap();
        let n = reading.shape[1];
        for (world, state) in reference.states.iter().enumerate() {
            let numbers = &reading.numbers[world * n..][..n][part.clone()];
            let found: Vec<f64> = numbers.iter().map(|x| x.to_f64()).collect();
            let expected = described.converted(&state.readings[row], &found);
            let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
            let apart: Vec<f64> = found
                .iter()
                .zip(&expected)
                .map(|(a, b)| if a == b { 0.0 } else { a - b })
                .collect();
            let error = length(&apart) / length(&expected).max(1.0);
            let most = worst.entry(described.kind.clone()).or_insert(0.0);
            *most = f64::max(*most, error);
            assert!(!error.is_nan(), "{} {found:?} {expected:?}", described.kind);
        }
    }
    worst
}

#[track_caller]
fn check(name: &str, errors: &BTreeMap<String, f64>, allowed: f64) {
    println!("{name}: {errors:?}");
    for (kind, error) in errors {
        assert!(
            *error <= allowed,
            "{name}, {kind}: {error} exceeds {allowed}"
        );
    }
}

const MODELS: [&str; 11] = [
    "ant",
    "half_cheetah",
    "hopper",
    "humanoid",
    "humanoidstandup",
    "inverted_pendulum",
    "inverted_double_pendulum",
    "pusher",
    "reacher",
    "swimmer",
    "walker2d",
];

/// At the same state, by the same laws, all but rounding is equal. That of single precision is seen most in
/// accelerations of small bodies: 1e-3 of them, as in the comparison of dynamics.
#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn sensors_read_what_those_of_mujoco_read() {
    for name in MODELS {
        let reference = reference(name);
        let errors_of = errors::<f64>(&reference, SolverKind::Featherstone, 0);
        assert!(errors_of.len() >= 10, "{name} has few kinds: {errors_of:?}");
        check(name, &errors_of, 1e-10);
        let single = errors::<f32>(&reference, SolverKind::Featherstone, 0);
        check(&format!("{name} in f32"), &single, 1e-3);
    }
}

#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn rangefinders_read_what_those_of_mujoco_read() {
    let reference = reference("rays");
    let hits = reference.0.states.iter().flat_map(|s| &s.readings);
    let (hits, misses): (Vec<_>, Vec<_>) = hits.partition(|reading| reading[0] > 0.0);
    assert!(hits.len() > 500 && misses.len() > 200);
    let errors = errors::<f64>(&reference, SolverKind::Featherstone, 0);
    check("rays", &errors, 1e-11);
}

/// What rests is touched with what it carries; MuJoCo's iterations end at a residual of 1e-8.
#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn touch_sensors_read_what_those_of_mujoco_read() {
    let reference = reference("resting");
    for solver in common::SOLVERS {
        let errors = errors::<f64>(&reference, solver, 2000);
        check(solver.name(), &errors, 1e-7);
    }
}
