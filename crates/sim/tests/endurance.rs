//! Ten million steps of each of gymnasium's models that walk or swim, under random controls.

use kinetarium_sim::{Simulation, SimulationSettings};
use model::{BodyId, Model};
use std::path::{Path, PathBuf};

const WORLDS: usize = 2048;
const STEPS: usize = 10_000_000_usize.div_ceil(WORLDS);
/// Steps for which a control is held.
const HOLD: usize = 10;
/// Steps after which all worlds start anew.
const EPISODE: usize = 1000;

/// Where `cargo xtask peers` has written MuJoCo's references.
fn references() -> PathBuf {
    let folder = std::env::var("KINETARIUM_PEERS").expect("KINETARIUM_PEERS names the references");
    PathBuf::from(folder)
}

/// The model that a reference names.
fn load(reference: &Path, options: &formats::Options) -> Model {
    let text = std::fs::read_to_string(reference).expect("a reference");
    let reference: serde_json::Value = serde_json::from_str(&text).expect("JSON");
    let file = reference["path"].as_str().expect("a path");
    let loaded = formats::load(Path::new(file), options);
    loaded.unwrap_or_else(|e| panic!("{e}")).model
}

/// The models whose falls are recorded.
fn models() -> Vec<Model> {
    let falls = std::fs::read_dir(references().join("falls")).expect("the folder of falls");
    let mut paths: Vec<PathBuf> = falls.map(|f| f.expect("a file").path()).collect();
    paths.sort();
    let load = |path: &PathBuf| load(path, &formats::Options::default());
    paths.iter().map(load).collect()
}

/// A control within each actuator's range, which all of these models' actuators have.
fn random_control(model: &Model, random: &mut fastrand::Rng) -> Vec<f64> {
    let ranges = model.actuators.iter().map(|a| a.control_range);
    ranges
        .map(|range| {
            let (low, high) = range.expect("a range of controls");
            low + (high - low) * random.f64()
        })
        .collect()
}

/// No world may diverge, and none may fall through the ground.
fn endure(model: Model) {
    let name = model.name.clone();
    let (bodies, time_step) = (model.bodies.len(), model.time_step);
    let settings = SimulationSettings::new(WORLDS, time_step);
    let mut simulation = Simulation::<f32>::new(model, settings).unwrap_or_else(|e| panic!("{e}"));
    let model = simulation.model().clone();
    let mut random = fastrand::Rng::with_seed(7);
    let mut lowest = f64::INFINITY;
    for step in (0..STEPS).step_by(HOLD) {
        if step % EPISODE == 0 {
            simulation.reset_all();
        }
        for world in 0..WORLDS {
            let control = random_control(&model, &mut random);
            simulation.controls().set_control(world, &control).unwrap();
        }
        let diverged = simulation.step(HOLD);
        assert!(diverged.is_empty(), "{name}: {diverged:?}");
        if step % EPISODE >= EPISODE - HOLD {
            let outputs = simulation.outputs();
            let height = |(w, b)| outputs.body_position(w, BodyId(b)).z;
            let all = (0..WORLDS).flat_map(|w| (0..bodies).map(move |b| (w, b)));
            lowest = all.map(height).fold(lowest, f64::min);
        }
    }
    println!("{name}: lowest body {lowest:.3} m");
    assert!(lowest > -0.2, "{name}: a body at {lowest} m");
}

#[test]
#[ignore = "needs the models that MuJoCo's references name: cargo xtask peers"]
fn no_world_diverges_in_ten_million_steps_under_random_controls() {
    let models = models();
    assert_eq!(models.len(), 7);
    models.into_iter().for_each(endure);
}

/// Without the drag of its water, which no solver has: nothing slows it but its joints' limits.
#[test]
#[ignore = "needs the models that MuJoCo's references name: cargo xtask peers"]
fn no_swimmer_diverges_in_ten_million_steps_under_random_controls() {
    let lenient = formats::Options {
        lenient: true,
        ..formats::Options::default()
    };
    endure(load(&references().join("swimmer.json"), &lenient));
}
