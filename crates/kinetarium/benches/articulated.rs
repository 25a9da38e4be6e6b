//! Kinetarium's side of `cargo xtask bench`.
//!
//! Reads `cases.json` from the folder named, runs every case once, and prints one JSON record a
//! line. Batches are stepped in single precision on two threads; every run starts anew after
//! [`RESTART_STEPS`], so that none leaves the range in which explicit steps are stable. Only the
//! stepping is timed.

use fastrand::Rng;
use glam::DVec3;
use kinetarium::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

const WORLDS: usize = 4096;
const THREADS: usize = 2;
const RESTART_STEPS: usize = 80;
const MEASURED: Duration = Duration::from_secs(1);

/// What to simulate.
#[derive(Deserialize)]
struct Case {
    case: String,
    path: PathBuf,
    /// [s]
    timestep: f64,
    /// Those of the peer; ours have an `xpbd_4` more.
    methods: Vec<String>,
    tip: Option<Tip>,
}

/// Where a point of a body must be.
#[derive(Deserialize)]
struct Tip {
    body: String,
    /// In the body's frame [m].
    offset: [f64; 3],
    /// [s]
    time: f64,
    /// In the world [m].
    reference: [f64; 3],
}

type Outcome<T> = Result<T, Box<dyn Error>>;

fn main() -> Outcome<()> {
    // Cargo adds `--bench`.
    let folder = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with("--"));
    let folder = PathBuf::from(folder.ok_or("name the folder with cases.json in it")?);
    let cases: Vec<Case> = serde_json::from_slice(&std::fs::read(folder.join("cases.json"))?)?;
    for case in &cases {
        sizes(case)?;
        speeds(case)?;
    }
    Ok(())
}

/// From the file to the end of the first step, and the bytes of a world.
fn sizes(case: &Case) -> Outcome<()> {
    let begin = Instant::now();
    let mut simulation = simulation(&load(&case.path)?, case, "euler", 1)?;
    simulation.step(1);
    let seconds = begin.elapsed().as_secs_f64();
    print(json!({"kind": "load", "case": case.case, "seconds": seconds}));
    print(json!({"kind": "memory", "case": case.case, "bytes": simulation.bytes_per_world()}));
    Ok(())
}

fn speeds(case: &Case) -> Outcome<()> {
    let model = load(&case.path)?;
    for method in case.methods.iter().map(String::as_str).chain(["xpbd_4"]) {
        let tip_error = case
            .tip
            .as_ref()
            .map(|tip| tip_error(&model, case, tip, method))
            .transpose()?;
        for worlds in [WORLDS, 1] {
            let mut simulation = simulation(&model, case, method, worlds)?;
            move_apart(&mut simulation)?;
            let steps_per_second = worlds as f64 * steps_per_second(&mut simulation)?;
            print(json!({
                "kind": "speed", "case": case.case, "method": method, "worlds": worlds,
                "threads": simulation.threads(), "steps_per_second": steps_per_second,
                "tip_error": tip_error,
            }));
        }
    }
    Ok(())
}

fn print(record: Value) {
    println!("{record}");
}

fn load(path: &Path) -> Outcome<Model> {
    Ok(kinetarium::formats::load(path, &Options::default())?.model)
}

fn simulation(model: &Model, case: &Case, method: &str, worlds: usize) -> Outcome<Simulation<f32>> {
    let (solver, integrator, substeps) = match method {
        "euler" => (SolverKind::Featherstone, Integrator::SemiImplicitEuler, 1),
        "rk4" => (SolverKind::Featherstone, Integrator::RungeKutta4, 1),
        "xpbd_4" => (SolverKind::Xpbd, Integrator::default(), 4),
        _ => return Err(format!("unknown method `{method}`").into()),
    };
    let step = Settings {
        substeps,
        integrator,
        ..Settings::new(case.timestep)
    };
    let threads = if worlds == 1 { 1 } else { THREADS };
    let settings = SimulationSettings {
        contacts: false,
        solver,
        step,
        threads,
        ..SimulationSettings::new(worlds, case.timestep)
    };
    Ok(Simulation::new(model.clone(), settings)?)
}

/// Starts each world a little differently, with constant controls of its own.
fn move_apart(simulation: &mut Simulation<f32>) -> Outcome<()> {
    let mut rng = Rng::with_seed(1);
    let mut random = |n: usize, size: f64| -> Vec<f64> {
        (0..n).map(|_| size * (2.0 * rng.f64() - 1.0)).collect()
    };
    let model = simulation.model().clone();
    for world in 0..simulation.worlds() {
        let velocity = random(model.degrees_of_freedom(), 0.02);
        simulation.set_joint_state(world, &model.initial_position(), &velocity)?;
        simulation
            .controls()
            .set_control(world, &random(model.actuators.len(), 0.2))?;
    }
    Ok(())
}

/// Steps again and again from the present state, once to warm up and then for [`MEASURED`].
fn steps_per_second(simulation: &mut Simulation<f32>) -> Outcome<f64> {
    let start = simulation.snapshot();
    let (mut elapsed, mut runs) = (Duration::ZERO, 0);
    simulation.step(RESTART_STEPS);
    while elapsed < MEASURED {
        simulation.restore(&start)?;
        let begin = Instant::now();
        simulation.step(RESTART_STEPS);
        elapsed += begin.elapsed();
        runs += 1;
    }
    if let Some(lost) = simulation.diverged().first() {
        return Err(format!(
            "world {} diverged, so that the speed means nothing",
            lost.world
        )
        .into());
    }
    Ok((runs * RESTART_STEPS) as f64 / elapsed.as_secs_f64())
}

/// Distance of the tip from where it must be [m], started from the model's own state at rest.
fn tip_error(model: &Model, case: &Case, tip: &Tip, method: &str) -> Outcome<f64> {
    let mut simulation = simulation(model, case, method, 1)?;
    simulation.step((tip.time / case.timestep).round() as usize);
    let pose = simulation.outputs().body_pose(0, model.body(&tip.body)?);
    let reached = pose.position + pose.orientation * DVec3::from_array(tip.offset);
    Ok(reached.distance(DVec3::from_array(tip.reference)))
}
