//! Pairs of shapes with surfaces of their own, in every solver.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Material, Model, Pose, Shape};

const G: f64 = 9.81;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
const SPEED: f64 = 1.0;
/// Friction of the materials, and of the pair.
const ROUGH: f64 = 0.5;
const SLIPPERY: f64 = 0.05;

/// Two blocks of one material on a floor of it; the first makes a pair with the floor.
fn blocks() -> Model {
    let rough = Material {
        friction: ROUGH,
        ..Material::default()
    };
    let mut world = Builder::new("blocks");
    let floor = world.object("floor");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    floor.scenery(Shape::new(plane).with_material(rough));
    let floor = floor.id().scenery(0);
    let half = DVec3::new(0.2, 0.1, 0.2);
    let blocks = world.object("blocks");
    let mut block = |name: &str, z: f64| {
        let body = blocks.body(name).at(Pose::at(DVec3::new(0.0, half.y, z)));
        let shape = Shape::new(Geometry::Box { half }).with_material(rough);
        body.shape(shape).handle()
    };
    let (first, _) = (block("first", 0.0), block("second", 1.0));
    let pair = world.contact_pair(first.shape(0), floor).unwrap();
    pair.friction(SLIPPERY);
    world.build().unwrap()
}

/// What slides with v is after t at v t − μ g t² / 2, or has stopped at v² / 2 μ g.
#[test]
fn the_friction_of_a_pair_wins_over_that_of_materials() {
    let (steps, step) = (250, 0.002);
    let time = f64::from(steps) * step;
    let slides = SPEED * time - 0.5 * SLIPPERY * G * time * time;
    let stops = SPEED * SPEED / (2.0 * ROUGH * G);
    // Within a few steps at the speed, as long as the surface takes to bear what lies on it.
    let tolerance = 5.0 * SPEED * step;
    for solver in SOLVERS {
        let mut settings = SimulationSettings::new(1, step);
        settings.solver = solver;
        settings.threads = 1;
        let model = blocks();
        let start = model.initial_position();
        let mut velocity = vec![0.0; model.degrees_of_freedom()];
        (velocity[0], velocity[6]) = (SPEED, SPEED);
        let mut sim = Simulation::<f64>::new(model, settings).unwrap();
        sim.set_joint_state(0, &start, &velocity).unwrap();
        sim.step(steps as usize);
        let [first, second] = [0, 1].map(|i| sim.outputs().body_position(0, BodyId(i)).x);
        let name = solver.name();
        assert!(
            (first - slides).abs() < tolerance,
            "{name}: {first}, not {slides}"
        );
        assert!(
            (second - stops).abs() < tolerance,
            "{name}: {second}, not {stops}"
        );
    }
}
