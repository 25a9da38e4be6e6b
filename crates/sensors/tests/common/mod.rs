//! What the tests share: small models, and how to compare.
#![allow(dead_code)]

use glam::{DMat3, DQuat, DVec3};
use kinetarium_sensors::{Device, ImageNoise, Sensor, SensorKind, Sensors, View};
use model::{BodyHandle, Builder, Geometry, Model, Object, Pose};
use numbers::Float;
use sim::{Simulation, SimulationSettings, SolverKind};

/// Gravity of all models, along −y [m/s²].
pub const G: f64 = 9.81;

pub const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// Worlds of a model, with a time step h [s].
pub fn simulate<T: Float>(
    model: &Model,
    solver: SolverKind,
    worlds: usize,
    h: f64,
) -> Simulation<T> {
    let mut settings = SimulationSettings {
        threads: 1,
        solver,
        ..SimulationSettings::new(worlds, h)
    };
    settings.step.sleep_speed = 0.0;
    Simulation::new(model.clone(), settings).unwrap()
}

/// A camera on the processors.
pub fn eye(view: View, noise: ImageNoise) -> SensorKind {
    SensorKind::Camera {
        view,
        noise,
        device: Device::Processor,
    }
}

/// What one sensor reads now, in all worlds.
pub fn read<T: Float>(simulation: &mut Simulation<T>, kind: SensorKind) -> Vec<f64> {
    let sensors = Sensors::new(simulation, vec![Sensor::new("s", kind)], 0).unwrap();
    let reading = sensors.reading("s").unwrap();
    reading.numbers.iter().map(|x| x.to_f64()).collect()
}

/// Two vectors one after the other.
pub fn two(numbers: &[f64]) -> [DVec3; 2] {
    [
        DVec3::from_slice(numbers),
        DVec3::from_slice(&numbers[3..6]),
    ]
}

/// A pose like no other.
pub fn askew() -> Pose {
    let turn = DQuat::from_scaled_axis(DVec3::new(0.4, -0.9, 0.3));
    Pose::new(DVec3::new(0.1, -0.2, 0.3), turn)
}

/// Adds a body with its mass [kg], centre [m] and principal moments [kg·m²].
pub fn body(
    object: &mut Object,
    name: &str,
    mass: f64,
    center: DVec3,
    moments: DVec3,
) -> BodyHandle {
    let inertia = DMat3::from_diagonal(moments);
    object.body(name).inertia(mass, center, inertia).handle()
}

/// A body on its own.
pub fn floating() -> Model {
    let mut world = Builder::new("floating");
    let moments = DVec3::new(0.5, 0.9, 1.1);
    let object = world.object("");
    body(object, "body", 2.0, DVec3::new(0.05, 0.02, -0.04), moments);
    world.build().unwrap()
}

/// Mass of the [`resting`] box [kg].
pub const BOX: f64 = 3.0;

/// A box on the ground.
pub fn resting() -> Model {
    let mut world = Builder::new("resting");
    let ground = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(ground);
    let half = DVec3::new(0.2, 0.1, 0.15);
    let at = Pose::at(DVec3::new(0.0, 0.1, 0.0));
    let object = world.object("");
    let draft = object.body("box").at(at).shape(Geometry::Box { half });
    draft.mass(BOX);
    world.build().unwrap()
}

/// Mass [kg], distance of its centre from the hinge [m], and moment about that centre [kg·m²].
pub const PENDULUM: (f64, f64, f64) = (1.5, 0.4, 0.03);

/// A pendulum about z; it hangs at 0.
pub fn pendulum() -> Model {
    let (m, l, i) = PENDULUM;
    let mut world = Builder::new("pendulum");
    let object = world.object("");
    let moments = DVec3::new(i, 0.01, i);
    let bob = body(object, "bob", m, DVec3::new(0.0, -l, 0.0), moments);
    object.revolute("hinge", bob, DVec3::Z);
    world.build().unwrap()
}

/// Fails where a number is further from what it should be than the tolerance.
#[track_caller]
pub fn close(what: impl std::fmt::Display, found: f64, expected: f64, tolerance: f64) {
    let error = (found - expected).abs();
    println!("{what}: {found:.9e}, error {error:.2e} of {tolerance:.2e}");
    assert!(
        error <= tolerance,
        "{what} is {found}, should be {expected}: error {error:e}, tolerance {tolerance:e}"
    );
}

/// As [`close`], for vectors.
#[track_caller]
pub fn near(what: impl std::fmt::Display, found: DVec3, expected: DVec3, tolerance: f64) {
    let error = found.distance(expected);
    println!("{what}: {found}, error {error:.2e} of {tolerance:.2e}");
    assert!(
        error <= tolerance,
        "{what} is {found}, should be {expected}: error {error:e}, tolerance {tolerance:e}"
    );
}
