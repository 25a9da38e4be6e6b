//! Derivatives of a step of gymnasium's models against MuJoCo's `mjd_transitionFD`, contacts off.
//!
//! `cargo xtask test peers` writes MuJoCo's answers (`tests/peers/transitions.py`, which says why both
//! step alike) and names the folder in `KINETARIUM_PEERS`. MuJoCo takes central differences of width
//! 1e-6: rounding leaves 1e-16 / 1e-6 of the velocities in the step, which go to some hundreds under random
//! controls, and what it cuts off is e² F‴ / 6, some 1e-13 of the third derivatives. Hence 1e-7 of a
//! column's largest entry; 1e-6 is asked for.

mod scene;

use kinetarium_derivatives::{Linearization, linearize};
use model::Model;
use rigid::Integrator;
use scene::{quaternions, settings};
use serde::Deserialize;
use sim::Simulation;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Largest difference of an entry, relative to the largest of its column and 1.
const TOLERANCE: f64 = 1e-6;

/// A file of `tests/peers/transitions.py`.
#[derive(Deserialize)]
struct Reference {
    model: String,
    path: PathBuf,
    timestep: f64,
    /// Of one call [s].
    seconds: f64,
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    qpos: Vec<f64>,
    qvel: Vec<f64>,
    ctrl: Vec<f64>,
    /// Row-major.
    a: Vec<f64>,
    b: Vec<f64>,
}

const MODELS: [&str; 8] = [
    "ant",
    "half_cheetah",
    "hopper",
    "humanoid",
    "inverted_double_pendulum",
    "inverted_pendulum",
    "reacher",
    "walker2d",
];

fn reference(name: &str) -> Reference {
    let folder = std::env::var("KINETARIUM_PEERS").expect("KINETARIUM_PEERS names the references");
    let path = Path::new(&folder)
        .join("transitions")
        .join(name)
        .with_extension("json");
    let text = std::fs::read_to_string(&path).expect("a reference");
    serde_json::from_str(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// MuJoCo's coordinates with quaternions as x, y, z, w.
fn position(model: &Model, qpos: &[f64]) -> Vec<f64> {
    let mut position = qpos.to_vec();
    for [q, _] in quaternions(model) {
        position[q..q + 4].rotate_left(1);
    }
    position
}

/// Largest difference of two matrices, each column relative to its largest entry and 1.
fn apart(found: &[f64], expected: &[f64], columns: usize) -> f64 {
    assert_eq!(found.len(), expected.len());
    let column = |j: usize| {
        let of =
            |x: &'_ [f64]| -> Vec<f64> { x.iter().skip(j).step_by(columns).copied().collect() };
        let (found, expected) = (of(found), of(expected));
        let size = expected.iter().fold(1.0, |m: f64, x| x.abs().max(m));
        let apart = found.iter().zip(&expected).map(|(a, b)| (a - b).abs());
        apart.fold(0.0, f64::max) / size
    };
    (0..columns).map(column).fold(0.0, f64::max)
}

fn check(reference: &Reference) {
    let loaded = formats::load(&reference.path, &formats::Options::default());
    let model = loaded.unwrap_or_else(|e| panic!("{e}")).model;
    let mut settings = settings(Integrator::SemiImplicitEuler, 1);
    settings.step.time_step = reference.timestep;
    let mut simulation = Simulation::<f64>::new(model, settings).expect("a simulation");
    let model = simulation.model().clone();
    let (mut worst, mut seconds) = (0.0f64, Vec::new());
    for state in &reference.states {
        let position = position(&model, &state.qpos);
        let set = simulation.set_joint_state(0, &position, &state.qvel);
        set.expect("a state");
        let set = simulation.controls().set_control(0, &state.ctrl);
        set.expect("controls");
        let start = Instant::now();
        let step: Linearization = linearize(&mut simulation, 0).expect("a linearisation");
        seconds.push(start.elapsed().as_secs_f64());
        let (a, b) = (
            apart(&step.state, &state.a, 2 * step.dofs),
            apart(&step.control, &state.b, step.controls),
        );
        worst = worst.max(a).max(b);
    }
    seconds.sort_by(f64::total_cmp);
    let share = seconds[seconds.len() / 2] / reference.seconds;
    let name = &reference.model;
    println!("{name}: apart by {worst:.1e}, in {share:.2} times MuJoCo's time");
    assert!(worst < TOLERANCE, "{name}: {worst:e}");
}

#[test]
#[ignore = "needs MuJoCo's reference files: cargo xtask test peers"]
fn derivatives_are_those_of_mujoco() {
    MODELS.iter().for_each(|name| check(&reference(name)));
}
