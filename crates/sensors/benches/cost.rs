//! What sensors cost beside the steps of 4096 humanoids on the ground, all of them sampled at every step.
//!
//! `cargo bench --package kinetarium-sensors`. Rounds take turns, so that a busy machine is as busy for each;
//! medians.

use kinetarium_sensors::{Level, Mount, Noise, Sensor, SensorKind, Sensors};
use model::{Model, Pose};
use sim::{Simulation, SimulationSettings, SolverKind};
use std::error::Error;
use std::time::Instant;

const WORLDS: usize = 4096;
const ROUNDS: usize = 15;
const STEPS: usize = 10;

fn list(model: &Model, noise: &Noise, touch: bool) -> Result<Vec<Sensor>, Box<dyn Error>> {
    let mount = Mount::on(model.body("torso")?).at(Pose::IDENTITY);
    let joints = SensorKind::all_joints(model);
    let kinds = [
        ("imu", SensorKind::Imu { mount }),
        (
            "position",
            SensorKind::JointPosition {
                joints: joints.clone(),
            },
        ),
        ("velocity", SensorKind::JointVelocity { joints }),
    ];
    let sensor = |(name, kind)| Sensor::new(name, kind).with_noise(noise.clone());
    let mut list: Vec<_> = kinds.into_iter().map(sensor).collect();
    if touch {
        for foot in ["left_foot", "right_foot"] {
            let body = model.body(foot)?;
            list.push(Sensor::new(foot, SensorKind::Touch { body }));
        }
    }
    Ok(list)
}

/// Four rings of 16 rays about the torso.
fn lidar(model: &Model) -> Result<Sensor, Box<dyn Error>> {
    let around = |i: usize| std::f64::consts::TAU * i as f64 / 16.0;
    let kind = SensorKind::Lidar {
        mount: Mount::on(model.body("torso")?).at(Pose::IDENTITY),
        azimuths: (0..16).map(around).collect(),
        elevations: vec![-0.6, -0.3, 0.0, 0.2],
        max_range: 30.0,
    };
    Ok(Sensor::new("lidar", kind))
}

/// Median of times [s].
fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../session/models/humanoid.xml"
    );
    let model = formats::load(path.as_ref(), &formats::Options::default())?.model;
    let settings = SimulationSettings {
        solver: SolverKind::Featherstone,
        ..SimulationSettings::new(WORLDS, 0.003)
    };
    let mut simulation = Simulation::<f32>::new(model.clone(), settings)?;
    let white = Noise::white(0.01);
    let all = Noise {
        bias: Level::All(0.01),
        walk: Level::All(0.01),
        ..white.clone()
    };
    let mut cases = vec![];
    for (name, noise, touch) in [
        ("imu, joints", &Noise::default(), false),
        ("imu, joints, touch of feet", &Noise::default(), true),
        ("imu, joints, white noise", &white, false),
        ("imu, joints, all noise", &all, false),
    ] {
        let sensors = Sensors::new(&mut simulation, list(&model, noise, touch)?, 0)?;
        cases.push((name, sensors, vec![]));
    }
    let sensors = Sensors::new(&mut simulation, vec![lidar(&model)?], 0)?;
    cases.push(("lidar of 64 rays", sensors, vec![]));
    let (mut steps, mut reports) = (vec![], vec![]);
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for _ in 0..STEPS {
            simulation.step(1);
        }
        steps.push(start.elapsed().as_secs_f64());
        let start = Instant::now();
        for _ in 0..STEPS {
            simulation.controls();
            simulation.outputs();
        }
        reports.push(start.elapsed().as_secs_f64());
        for (_, sensors, times) in &mut cases {
            let mut time = 0.0;
            for _ in 0..STEPS {
                simulation.step(1);
                simulation.outputs();
                let start = Instant::now();
                sensors.update(&mut simulation)?;
                time += start.elapsed().as_secs_f64();
            }
            times.push(time);
        }
    }
    let step = median(&mut steps);
    println!(
        "a step of {WORLDS} worlds: {:.2} ms",
        1e3 * step / STEPS as f64
    );
    let share = |time: f64| 100.0 * time / step;
    println!(
        "{:<30} {:5.1} % of a step",
        "report",
        share(median(&mut reports))
    );
    for (name, _, times) in &mut cases {
        println!("{name:<30} {:5.1} %, besides", share(median(times)));
    }
    Ok(())
}
