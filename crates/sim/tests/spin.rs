//! Bodies that spin freely keep their energy and angular momentum, however long and fast.
//!
//! Each step keeps both but for what Newton's method leaves of the mean spin, of the order (h ω)⁸ after two steps: here less
//! than (h ω)⁸ a step, and rounding.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{Builder, Geometry, Model, Shape};
use numbers::Float;

const H: f64 = 0.002;
const STEPS: usize = 2500;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

fn ellipsoid() -> Model {
    let mut world = Builder::new("ellipsoid");
    world.gravity(DVec3::ZERO);
    let things = world.object("things");
    let half = DVec3::new(0.10, 0.15, 0.08);
    let shape = Shape::new(Geometry::Ellipsoid { half });
    let body = things.body("body").shape(shape).mass(1.0).handle();
    things.free("float", body);
    world.build().unwrap()
}

/// By how much energy, |L| and the direction of L [rad] change in 5 s.
fn changes<T: Float>(solver: SolverKind, spin: DVec3) -> [f64; 3] {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, H)
    };
    let mut sim = Simulation::<T>::new(ellipsoid(), settings).unwrap();
    let place = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    let velocity = [0.0, 0.0, 0.0, spin.x, spin.y, spin.z];
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
    for solver in SOLVERS {
        for speed in [10.0, 30.0, 60.0, 150.0] {
            for axis in axes {
                let spin = axis.normalize() * speed;
                let [energy, size, angle] = changes::<f64>(solver, spin);
                let what = format!("{solver:?} {spin}: {energy:e} {size:e} {angle:e}");
                let most = 1e-11 + STEPS as f64 * (H * speed).powi(8);
                assert!(energy.abs() < most && size.abs() < most, "{what}");
                // With reduced coordinates the body turns by the spin at the end of a step: first order in h.
                let reduced = solver == SolverKind::Featherstone;
                let most = if reduced { H * speed } else { 1e-7 };
                assert!(angle < most, "{what}");

                // Rounding of f32, some ten units in the last place a step, may add up.
                let [energy, size, _] = changes::<f32>(solver, spin);
                let what = format!("{solver:?} {spin}: {energy:e} {size:e}");
                assert!(energy.abs() < 5e-3 && size.abs() < 5e-3, "{what}");
            }
        }
    }
}
