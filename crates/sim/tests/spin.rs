//! Bodies that spin freely keep their energy and angular momentum, however long and fast.
//!
//! Each step keeps both but for what Newton's method leaves of the mean spin, of the order (h ω)⁸ after two steps: here less
//! than (h ω)⁸ a step, and rounding.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{Builder, Geometry, Model, Pose, Shape};
use numbers::Float;

const H: f64 = 0.002;
const STEPS: usize = 2500;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// An ellipsoid, alone or with a ball far from it, which it might touch.
fn ellipsoid(alone: bool) -> Model {
    let mut world = Builder::new("ellipsoid");
    world.gravity(DVec3::ZERO);
    let things = world.object("things");
    let half = DVec3::new(0.10, 0.15, 0.08);
    let shape = Shape::new(Geometry::Ellipsoid { half });
    let body = things.body("body").shape(shape).mass(1.0).handle();
    things.free("float", body);
    if !alone {
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
        let ball = things.body("ball").shape(ball).mass(1.0).handle();
        things
            .free("ball float", ball)
            .initial(&[9.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    }
    world.build().unwrap()
}

/// By how much energy, |L| and the direction of L [rad] change in 5 s.
fn changes<T: Float>(solver: SolverKind, alone: bool, spin: DVec3) -> [f64; 3] {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, H)
    };
    let mut sim = Simulation::<T>::new(ellipsoid(alone), settings).unwrap();
    let place = sim.outputs().joint_position(0);
    let mut velocity = sim.outputs().joint_velocity(0);
    velocity[3..6].copy_from_slice(&spin.to_array());
    sim.set_joint_state(0, &place, &velocity).unwrap();
    let (energy, momentum) = (sim.outputs().energy(0), sim.outputs().angular_momentum(0));
    sim.step(STEPS);
    let outputs = sim.outputs();
    let after = outputs.angular_momentum(0);
    [
        outputs.energy(0) / energy - 1.0,
        after.length() / momentum.length() - 1.0,
        after.angle_between(momentum),
    ]
}

/// About axes near the principal ones, the one that is not stable among them, and far from all.
#[test]
fn a_free_body_keeps_its_energy_and_angular_momentum() {
    let axes = [
        DVec3::new(1.0, 0.1, 0.1),
        DVec3::new(0.1, 1.0, 0.1),
        DVec3::new(0.1, 0.1, 1.0),
        DVec3::ONE,
    ];
    for (solver, alone) in SOLVERS.iter().flat_map(|s| [(*s, true), (*s, false)]) {
        for speed in [10.0, 30.0, 60.0, 150.0] {
            for axis in axes {
                let spin = axis.normalize() * speed;
                let [energy, size, angle] = changes::<f64>(solver, alone, spin);
                let what = format!("{solver:?} {spin}: {energy:e} {size:e} {angle:e}");
                let most = 1e-11 + STEPS as f64 * (H * speed).powi(8);
                assert!(energy.abs() < most && size.abs() < most, "{what}");
                // With reduced coordinates the body turns by the spin at the end of a step: first order in h.
                let reduced = solver == SolverKind::Featherstone;
                let most = if reduced { H * speed } else { 1e-7 };
                assert!(angle < most, "{what}");

                // Rounding of f32, some ten units in the last place a step, may add up.
                let [energy, size, _] = changes::<f32>(solver, alone, spin);
                let what = format!("{solver:?} {spin}: {energy:e} {size:e}");
                assert!(energy.abs() < 5e-3 && size.abs() < 5e-3, "{what}");
            }
        }
    }
}

/// Turns by radians in a step, also of what is cut into no parts: two balls on a rod. Reduced coordinates keep the energy
/// then, but for what two of Newton's steps leave over, and bodies the angular momentum.
#[test]
fn what_turns_by_radians_in_a_step_stays_finite() {
    let mut world = Builder::new("dumbbell");
    world.gravity(DVec3::ZERO);
    let things = world.object("things");
    let ball = Shape::new(Geometry::Sphere { radius: 0.05 });
    let end = |x: f64| ball.clone().at(Pose::at(DVec3::new(x, 0.0, 0.0)));
    let body = things.body("body").shape(end(-0.2)).shape(end(0.2));
    let body = body.mass(1.0).handle();
    things.free("float", body);
    let model = world.build().unwrap();
    for solver in SOLVERS {
        for turn in [1.0, 3.0, 10.0] {
            let mut settings = SimulationSettings {
                solver,
                ..SimulationSettings::new(1, H)
            };
            settings.step.speed_limit = 1e6;
            let mut sim = Simulation::<f64>::new(model.clone(), settings).unwrap();
            let place = sim.outputs().joint_position(0);
            let mut velocity = sim.outputs().joint_velocity(0);
            let spin = DVec3::new(1.0, 1.0, 0.9).normalize() * (turn / H);
            velocity[3..6].copy_from_slice(&spin.to_array());
            sim.set_joint_state(0, &place, &velocity).unwrap();
            let measure = |sim: &mut Simulation<f64>| {
                let outputs = sim.outputs();
                match solver {
                    SolverKind::Featherstone => outputs.energy(0),
                    _ => outputs.angular_momentum(0).length(),
                }
            };
            let before = measure(&mut sim);
            sim.step(500);
            assert!(sim.diverged().is_empty(), "{solver:?} {turn}");
            let ratio = measure(&mut sim) / before;
            assert!((ratio - 1.0).abs() < 0.01, "{solver:?} {turn}: {ratio}");
        }
    }
}
