//! Kinetarium's side of `cargo xtask bench`.
//!
//! Reads `cases.json` from the folder named, runs every case once, and prints one JSON record a
//! line. Batches are stepped in single precision on two threads. Without contacts, every run starts
//! anew after [`RESTART_STEPS`], so that none leaves the range in which explicit steps are stable;
//! with contacts, it is as long as a robot takes to fall and lie, and driven by random controls. Only
//! the stepping is timed.

mod ground;

use fastrand::Rng;
use glam::DVec3;
use ground::on_the_ground;
use kinetarium::model::ModelError;
use kinetarium::prelude::*;
use serde::Deserialize;
use serde_json::{Value, json};
use std::error::Error;
use std::path::PathBuf;
use std::time::{Duration, Instant};

const WORLDS: usize = 4096;
const THREADS: usize = 2;
const RESTART_STEPS: usize = 80;
const FALL_STEPS: usize = 400;
/// Steps from one random control to the next.
const HELD_STEPS: usize = 20;
/// How much finer the steps are that an error is measured against.
const FINER: usize = 16;
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
    contacts: Contacts,
    tip: Option<Tip>,
    /// Those under which the error is measured: by interval, world and actuator.
    controls: Vec<Vec<Vec<f64>>>,
}

/// What bodies touch; limits of joints are left out where that is nothing, unless they are the case.
#[derive(Clone, Copy, Deserialize, PartialEq)]
#[serde(rename_all = "snake_case")]
enum Contacts {
    None,
    Limits,
    Ground,
    All,
}

impl Case {
    fn touches(&self) -> bool {
        matches!(self.contacts, Contacts::Ground | Contacts::All)
    }
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
    let mut simulation = simulation(&load(case)?, case, "euler", [1, 1], 1)?;
    simulation.step(1);
    let seconds = begin.elapsed().as_secs_f64();
    print(json!({"kind": "load", "case": case.case, "seconds": seconds}));
    print(json!({"kind": "memory", "case": case.case, "bytes": simulation.bytes_per_world()}));
    Ok(())
}

fn speeds(case: &Case) -> Outcome<()> {
    let model = load(case)?;
    let further = (case.contacts == Contacts::None).then_some("xpbd_4");
    for method in case.methods.iter().map(String::as_str).chain(further) {
        let error = match &case.tip {
            Some(tip) => Some(tip_error(&model, case, tip, method)?),
            None if !case.touches() => None,
            None => Some(joint_error(&model, case, method)?),
        };
        // What a second thread is worth is told of the fastest method alone.
        let alone = (method == "euler").then_some([WORLDS, 1]);
        for [worlds, threads] in [[WORLDS, THREADS], [1, 1]].into_iter().chain(alone) {
            let mut simulation = simulation(&model, case, method, [worlds, threads], 1)?;
            move_apart(&mut simulation)?;
            let steps_per_second = worlds as f64 * steps_per_second(&mut simulation, case)?;
            print(json!({
                "kind": "speed", "case": case.case, "method": method, "worlds": worlds,
                "threads": simulation.threads(), "steps_per_second": steps_per_second,
                "error": error,
            }));
        }
    }
    Ok(())
}

fn print(record: Value) {
    println!("{record}");
}

fn load(case: &Case) -> Outcome<Model> {
    let model = kinetarium::formats::load(&case.path, &Options::default())?.model;
    match case.contacts {
        Contacts::None => Ok(without_limits(model)?),
        Contacts::Ground => Ok(on_the_ground(model)?),
        Contacts::Limits | Contacts::All => Ok(model),
    }
}

fn without_limits(model: Model) -> Result<Model, ModelError> {
    let mut parts = model.into_parts();
    let dofs = parts.joints.iter_mut().flat_map(|joint| &mut joint.dofs);
    dofs.for_each(|dof| dof.limit = None);
    Model::new(parts)
}

fn simulation(
    model: &Model,
    case: &Case,
    method: &str,
    [worlds, threads]: [usize; 2],
    finer: usize,
) -> Outcome<Simulation<f32>> {
    let (solver, integrator, substeps) = match method {
        "euler" => (SolverKind::Featherstone, Integrator::SemiImplicitEuler, 1),
        "rk4" => (SolverKind::Featherstone, Integrator::RungeKutta4, 1),
        "xpbd_4" => (SolverKind::Xpbd, Integrator::default(), 4),
        _ => return Err(format!("unknown method `{method}`").into()),
    };
    let step = Settings {
        substeps,
        integrator,
        ..Settings::new(case.timestep / finer as f64)
    };
    let settings = SimulationSettings {
        contacts: case.touches(),
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

/// Draws controls over the whole range for every world.
fn drive(simulation: &mut Simulation<f32>, rng: &mut Rng) -> Outcome<()> {
    let model = simulation.model().clone();
    let ranges = model
        .actuators
        .iter()
        .map(|a| a.control_range.unwrap_or((-1.0, 1.0)));
    let ranges: Vec<(f64, f64)> = ranges.collect();
    for world in 0..simulation.worlds() {
        let drawn = ranges
            .iter()
            .map(|(low, high)| low + (high - low) * rng.f64());
        let drawn: Vec<f64> = drawn.collect();
        simulation.controls().set_control(world, &drawn)?;
    }
    Ok(())
}

/// One run; how long its steps took.
fn perform(simulation: &mut Simulation<f32>, case: &Case) -> Outcome<Duration> {
    let mut elapsed = Duration::ZERO;
    let mut rng = Rng::with_seed(1);
    let (steps, held) = length(case);
    for _ in 0..steps / held {
        if case.touches() {
            drive(simulation, &mut rng)?;
        }
        let begin = Instant::now();
        simulation.step(held);
        elapsed += begin.elapsed();
    }
    Ok(elapsed)
}

/// Steps of a run, and from one control to the next.
fn length(case: &Case) -> (usize, usize) {
    if case.touches() {
        (FALL_STEPS, HELD_STEPS)
    } else {
        (RESTART_STEPS, RESTART_STEPS)
    }
}

/// Steps again and again from the present state, once to warm up and then for [`MEASURED`].
fn steps_per_second(simulation: &mut Simulation<f32>, case: &Case) -> Outcome<f64> {
    let start = simulation.snapshot();
    let (mut elapsed, mut runs) = (Duration::ZERO, 0);
    perform(simulation, case)?;
    while elapsed < MEASURED {
        simulation.restore(&start)?;
        elapsed += perform(simulation, case)?;
        runs += 1;
    }
    if let Some(lost) = simulation.diverged().first() {
        return Err(format!(
            "world {} diverged, so that the speed means nothing",
            lost.world
        )
        .into());
    }
    Ok((runs * length(case).0) as f64 / elapsed.as_secs_f64())
}

/// Median over worlds of the root mean square difference [m and rad] of the joints to finer steps.
fn joint_error(model: &Model, case: &Case, method: &str) -> Outcome<f64> {
    let worlds = case.controls.first().map_or(0, Vec::len);
    let mut ends = Vec::new();
    for finer in [1, FINER] {
        let mut simulation = simulation(model, case, method, [worlds, THREADS], finer)?;
        for interval in &case.controls {
            for (world, control) in interval.iter().enumerate() {
                simulation.controls().set_control(world, control)?;
            }
            simulation.step(HELD_STEPS * finer);
        }
        let outputs = simulation.outputs();
        let end = (0..worlds).map(|world| outputs.joint_position(world));
        ends.push(end.collect::<Vec<_>>());
    }
    let difference = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
        (squares.sum::<f64>() / a.len() as f64).sqrt()
    };
    let mut errors: Vec<f64> = ends[0].iter().zip(&ends[1]).map(difference).collect();
    errors.sort_by(f64::total_cmp);
    Ok(0.5 * (errors[(worlds - 1) / 2] + errors[worlds / 2]))
}

/// Distance of the tip from where it must be [m], started from the model's own state at rest.
fn tip_error(model: &Model, case: &Case, tip: &Tip, method: &str) -> Outcome<f64> {
    let mut simulation = simulation(model, case, method, [1, 1], 1)?;
    simulation.step((tip.time / case.timestep).round() as usize);
    let pose = simulation.outputs().body_pose(0, model.body(&tip.body)?);
    let reached = pose.position + pose.orientation * DVec3::from_array(tip.offset);
    Ok(reached.distance(DVec3::from_array(tip.reference)))
}
