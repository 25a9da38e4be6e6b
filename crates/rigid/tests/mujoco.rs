//! Every MJCF model that gymnasium ships, at 200 random states each, against MuJoCo: joint
//! accelerations, mass matrix, placements and energy, in `f64` and in lanes of `f32`.
//!
//! `cargo xtask peers` writes MuJoCo's answers as JSON and names the folder in `KINETARIUM_PEERS`.
//! Contacts are off and no limit is active. Switched off besides, on both sides:
//!
//! - the fluid of `swimmer` (density and viscosity), which no solver here has yet; the file is read
//!   leniently.

mod block;

use glam::{DQuat, DVec3};
use kinetarium_rigid::{
    Dynamics, Featherstone, InputTables, Kernels, OutputTables, Settings, body, total,
};
use model::{JointId, JointKind, Model};
use numbers::dispatch::Isa;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// Models of the reference whose files need leniency, each for the reason above.
const LENIENT: [&str; 1] = ["swimmer"];

/// What is allowed. Accelerations: ‖q̈ − q̈ₘ‖ / ‖q̈ₘ‖ over all degrees of freedom; mass matrix: the
/// same of its entries; energies: the difference over 1 J or the energy, whichever is more;
/// positions: the largest |x − xₘ| in metres; orientations: the largest angle in radians.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    acceleration: f64,
    mass_matrix: f64,
    energy: f64,
    position: f64,
    orientation: f64,
}

const DOUBLE: Errors = Errors {
    acceleration: 1e-8,
    mass_matrix: 1e-9,
    energy: 1e-9,
    position: 1e-9,
    orientation: 1e-9,
};

const SINGLE: Errors = Errors {
    acceleration: 1e-3,
    mass_matrix: 1e-5,
    energy: 1e-4,
    position: 1e-5,
    orientation: 1e-5,
};

impl Errors {
    fn largest(self, other: Self) -> Self {
        Self {
            acceleration: self.acceleration.max(other.acceleration),
            mass_matrix: self.mass_matrix.max(other.mass_matrix),
            energy: self.energy.max(other.energy),
            position: self.position.max(other.position),
            orientation: self.orientation.max(other.orientation),
        }
    }
    fn within(&self, allowed: &Self) -> bool {
        self.acceleration <= allowed.acceleration
            && self.mass_matrix <= allowed.mass_matrix
            && self.energy <= allowed.energy
            && self.position <= allowed.position
            && self.orientation <= allowed.orientation
    }
}

/// A file of `tests/peers/reference_dynamics.py`.
#[derive(Deserialize)]
struct Reference {
    model: String,
    path: PathBuf,
    switched_off: Vec<String>,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    qacc: Vec<f64>,
    mass_matrix: Vec<Vec<f64>>,
    /// Of all bodies, the world first.
    xpos: Vec<[f64; 3]>,
    /// As `xpos`; w, x, y, z.
    xquat: Vec<[f64; 4]>,
    energy: Energy,
}

#[derive(Deserialize)]
struct Energy {
    kinetic: f64,
    potential: f64,
}

fn references() -> Vec<Reference> {
    let folder = std::env::var("KINETARIUM_PEERS").expect("KINETARIUM_PEERS names the references");
    let mut paths: Vec<_> = std::fs::read_dir(&folder)
        .expect("the folder of references")
        .map(|entry| entry.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    let read = |path: &PathBuf| {
        let text = std::fs::read_to_string(path).expect("a reference");
        serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
    };
    let found: Vec<Reference> = paths.iter().map(read).collect();
    for name in [
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
    ] {
        assert!(
            found.iter().any(|r| r.model == name),
            "no {name} in {folder}"
        );
    }
    found
}

/// Our model of a reference, with the state and the input of each of its states.
struct Case {
    reference: Reference,
    model: Model,
    inputs: InputTables,
}

impl Case {
    fn new(reference: Reference) -> Self {
        let lenient = LENIENT.contains(&reference.model.as_str());
        let fluid = reference.switched_off.iter().any(|what| what == "fluid");
        assert_eq!(lenient, fluid, "{}", reference.model);
        assert_eq!(reference.states.len(), 200, "{}", reference.model);
        let options = formats::Options {
            lenient,
            ..formats::Options::default()
        };
        let path: &Path = &reference.path;
        let model = formats::load(path, &options)
            .unwrap_or_else(|e| panic!("{e}"))
            .model;
        let inputs = InputTables::new(&model);
        Self {
            reference,
            model,
            inputs,
        }
    }

    /// MuJoCo's coordinates with quaternions as x, y, z, w. Velocities mean the same on both sides.
    fn position(&self, state: &State) -> Vec<f64> {
        let mut q = state.qpos.clone();
        for (i, joint) in self.model.joints.iter().enumerate() {
            if matches!(joint.kind, JointKind::Ball | JointKind::Free) {
                let end = self.model.coordinate_range(JointId(i)).end;
                q[end - 4..end].rotate_left(1);
            }
        }
        q
    }

    fn input(&self, state: &State) -> Vec<f64> {
        let mut input = self.inputs.initial(&self.model);
        input[self.inputs.control.at(0, 0)..][..state.ctrl.len()].copy_from_slice(&state.ctrl);
        input
    }
}

/// What is compared, from either precision.
struct Found {
    acceleration: Vec<f64>,
    mass_matrix: Vec<f64>,
    bodies: Vec<f64>,
    kinetic: f64,
    potential: f64,
}

fn relative(found: &[f64], expected: &[f64]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let difference: f64 = found
        .iter()
        .zip(expected)
        .map(|(a, b)| (a - b).powi(2))
        .sum();
    let size: f64 = expected.iter().map(|x| x * x).sum();
    (difference / size).sqrt()
}

impl Found {
    fn errors(&self, state: &State) -> Errors {
        let energy = |found: f64, expected: f64| (found - expected).abs() / expected.abs().max(1.0);
        let (mut position, mut orientation) = (0.0f64, 0.0f64);
        let bodies = self.bodies.chunks(body::WIDTH);
        assert_eq!(bodies.len() + 1, state.xpos.len());
        for ((row, x), q) in bodies.zip(&state.xpos[1..]).zip(&state.xquat[1..]) {
            let [w, i, j, k] = *q;
            let turn = DQuat::from_slice(&row[body::ORIENTATION..]).normalize();
            let apart = DVec3::from_slice(&row[body::POSITION..]) - DVec3::from_array(*x);
            position = position.max(apart.length());
            let turned = turn.conjugate() * DQuat::from_xyzw(i, j, k, w);
            orientation = orientation.max(2.0 * turned.xyz().length().min(1.0).asin());
        }
        Errors {
            acceleration: relative(&self.acceleration, &state.qacc),
            mass_matrix: relative(&self.mass_matrix, &state.mass_matrix.concat()),
            energy: energy(self.kinetic, state.energy.kinetic)
                .max(energy(self.potential, state.energy.potential)),
            position,
            orientation,
        }
    }
}

/// Checks all states of a model; prints the largest errors.
#[track_caller]
fn check(case: &Case, found: &[Found], allowed: &Errors, what: &str) {
    let name = &case.reference.model;
    let mut worst = Errors::default();
    for (i, (found, state)) in found.iter().zip(&case.reference.states).enumerate() {
        let errors = found.errors(state);
        assert!(
            errors.within(allowed),
            "{name} {what}, state {i}: {errors:?} exceed {allowed:?}"
        );
        worst = worst.largest(errors);
    }
    println!("{name} {what}: {worst:?}");
}

#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn dynamics_in_f64_are_those_of_mujoco() {
    for case in references().into_iter().map(Case::new) {
        let dynamics = Dynamics::new(&case.model).unwrap();
        let evaluate = |state: &State| {
            let (q, v) = (case.position(state), &state.qvel);
            let force = dynamics.applied_forces(&q, v, &case.input(state)).unwrap();
            let totals = dynamics.totals(&q, v).unwrap();
            Found {
                acceleration: dynamics.forward_dynamics(&q, v, &force).unwrap(),
                mass_matrix: dynamics.mass_matrix(&q).unwrap(),
                bodies: dynamics.bodies(&q, v).unwrap(),
                kinetic: totals.kinetic,
                potential: totals.potential,
            }
        };
        let found: Vec<_> = case.reference.states.iter().map(evaluate).collect();
        check(&case, &found, &DOUBLE, "in f64");
    }
}

#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask peers"]
fn dynamics_in_lanes_of_f32_are_those_of_mujoco() {
    for case in references().into_iter().map(Case::new) {
        let settings = Settings::new(case.model.time_step);
        let solver = Featherstone::new(&case.model, &settings).unwrap();
        let dynamics = Dynamics::new(&case.model).unwrap();
        let world = |s: &State| {
            let state = solver.initial(&case.model, &case.position(s), &s.qvel);
            (state, case.input(s))
        };
        let worlds: Vec<_> = case.reference.states.iter().map(world).collect();
        for isa in Isa::available() {
            let output = block::evaluate(isa, &solver, dynamics.kernels(), &worlds);
            let (t, m) = (OutputTables::new(&case.model), dynamics.kernels().tables());
            let n = case.model.degrees_of_freedom();
            let read = |world: usize, start: usize, length: usize| -> Vec<f64> {
                let at = |i| f64::from(output.get(world, start + i));
                (0..length).map(at).collect()
            };
            let evaluate = |world: usize| Found {
                acceleration: read(world, t.acceleration.at(0, 0), n),
                mass_matrix: read(world, m.mass_matrix.at(0, 0), n * n),
                bodies: read(
                    world,
                    t.body.at(0, 0),
                    case.model.bodies.len() * body::WIDTH,
                ),
                kinetic: f64::from(output.get(world, t.total.at(0, total::KINETIC))),
                potential: f64::from(output.get(world, t.total.at(0, total::POTENTIAL))),
            };
            let found: Vec<_> = (0..worlds.len()).map(evaluate).collect();
            check(&case, &found, &SINGLE, &format!("in lanes of f32, {isa}"));
        }
    }
}
