//! What runs on a card is the kernel that runs on the processor, to rounding.

use crate::card::{Card, card, rounds_alike};
use crate::models::{heap, looped, mixed};
use crate::pair::{Pair, apart};
use glam::DVec3;
use model::examples::{Start, chain};
use model::{BodyId, Builder, Geometry, Model, Pose, Shape, TriangleMesh};
use rigid::{Integrator, Settings};
use sim::{Quantity, Simulation, SimulationSettings, SolverKind};
use std::collections::HashSet;

const H: f64 = 0.002;

pub fn read(simulation: &mut Simulation<f32>, quantity: Quantity) -> Vec<f64> {
    let [rows, width] = quantity.shape(simulation.model());
    let mut out = vec![0.0; simulation.worlds() * rows * width];
    simulation.read(quantity, &mut out).unwrap();
    out.into_iter().map(f64::from).collect()
}

/// Coordinates and velocities after one step within `once`, bodies after a hundred, and every quantity of one state.
fn agrees(card: &Card, model: &Model, settings: SimulationSettings, once: f64) {
    let mut pair = Pair::new(card, model, settings);
    pair.step(1);
    let name = format!("{} of {}", pair.gpu.solver(), model.name);
    // A state may hold accelerations, whose rounding is that of velocities over h.
    let (apart_once, most) = (pair.apart(), once + 2.0 * f64::from(f32::EPSILON) / H);
    assert!(apart_once < most, "{name}: {apart_once:e} after a step");
    for quantity in [Quantity::JointPosition, Quantity::JointVelocity] {
        let [cpu, gpu] = pair.both().map(|s| read(s, quantity));
        let joints = apart(&cpu, &gpu);
        assert!(
            joints < once,
            "{name}: {joints:e} of {quantity:?} after a step"
        );
    }
    pair.step(99);
    let moved = pair.moved_apart();
    assert!(moved < 1e-3, "{name}: {moved:e} after 100 steps");
    pair.put();
    for quantity in Quantity::ALL {
        let [cpu, gpu] = pair.both().map(|s| read(s, quantity));
        let reported = apart(&cpu, &gpu);
        // Sums of forces in which most cancels.
        assert!(reported < 1e-3, "{name}: {reported:e} of {quantity:?}");
    }
}

fn settings(solver: SolverKind, integrator: Integrator) -> SimulationSettings {
    let step = Settings {
        integrator,
        ..Settings::new(H)
    };
    SimulationSettings {
        solver,
        step,
        contacts: false,
        ..SimulationSettings::new(5, H)
    }
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn articulated_bodies_agree_with_the_processor() {
    let card = card();
    let steps = |integrator| settings(SolverKind::Featherstone, integrator);
    let chain = chain(6, Start::Horizontal).unwrap();
    agrees(&card, &chain, steps(Integrator::default()), 1e-5);
    let mixed = mixed(true).unwrap();
    for integrator in [
        Integrator::SemiImplicitEuler,
        Integrator::ExplicitEuler,
        Integrator::Verlet,
        Integrator::RungeKutta4,
    ] {
        agrees(&card, &mixed, steps(integrator), 1e-5);
    }
}

/// Errors of positions over h are velocities, and so is their rounding.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn closed_loops_agree_with_the_processor() {
    let once = 1e-5 + 2.0 * f64::from(f32::EPSILON) / H;
    let settings = settings(SolverKind::Featherstone, Integrator::default());
    agrees(&card(), &looped().unwrap(), settings, once);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn position_based_dynamics_agrees_with_the_processor() {
    let card = card();
    for model in [chain(6, Start::Horizontal), mixed(false), looped()] {
        // Velocities take up corrections of positions over h, and with them their rounding.
        let once = 1e-5 + 2.0 * f64::from(f32::EPSILON) / H;
        let settings = settings(SolverKind::Xpbd, Integrator::default());
        agrees(&card, &model.unwrap(), settings, once);
    }
}

/// Worlds of bodies that touch.
const WORLDS: usize = 3;

/// Bodies that touch part ways, as rounding decides who slips first: a step agrees, and where they come to rest.
pub fn come_to_rest(solver: SolverKind) {
    let (card, model) = (card(), heap().unwrap());
    let rounds_alike = rounds_alike(&card);
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(WORLDS, H)
    };
    let mut pair = Pair::new(&card, &model, settings);
    // The fall, and the first touches.
    for step in 0..100 {
        pair.put();
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < 1e-3, "{solver:?}: {moved:e} after step {step}");
    }
    pair.step(1400);
    assert!(pair.gpu.diverged().is_empty());
    let (cpu, gpu) = (pair.cpu.outputs(), pair.gpu.outputs());
    let mut sums = [0.0; 2];
    for world in 0..WORLDS {
        for body in (0..model.bodies.len()).map(BodyId) {
            let height = |o: &sim::Outputs<'_, f32>| o.body_position(world, body).y;
            let (cpu, gpu) = (height(&cpu), height(&gpu));
            assert!(
                !rounds_alike || (cpu - gpu).abs() < 0.01 * cpu.abs().max(0.1),
                "{solver:?}: body {} of world {world} rests at {cpu} m, on the card at {gpu} m",
                body.0
            );
            sums = [sums[0] + cpu, sums[1] + gpu];
        }
    }
    // Where a card fuses, each may have come to lie otherwise, but not all of them together.
    let [cpu, gpu] = sums;
    assert!(
        (cpu - gpu).abs() < 0.05 * cpu,
        "{solver:?}: {cpu} m all together, on the card {gpu} m"
    );
}

/// Stones of forms that no example has lie on the ground: a step from the same states agrees.
fn stones_agree(ground: Geometry) {
    let model = stones(ground);
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(2, H)
        };
        let mut pair = Pair::at_rest(&card(), &model, settings);
        for step in 0..12 {
            pair.step(11);
            pair.put();
            pair.step(1);
            let moved = pair.moved_apart();
            assert!(moved < 1e-3, "{solver:?}: {moved:e} after step {step}");
        }
        assert!(pair.gpu.diverged().is_empty());
        let outputs = pair.gpu.outputs();
        let touching = outputs.contacts(0).filter(|c| c.distance < 1e-3);
        let stones: HashSet<_> = touching.map(|contact| contact.shapes[1]).collect();
        assert_eq!(stones.len(), 3, "{stones:?} touch");
    }
}

/// A ball, a cone and an ellipsoid above the ground, each by itself.
fn stones(ground: Geometry) -> Model {
    let mut world = Builder::new("stones");
    let ground = Shape::new(ground).with_masks(1, 2);
    world.object("ground").scenery(ground);
    let (radius, half_height) = (0.06, 0.08);
    let half = DVec3::new(0.1, 0.05, 0.07);
    let stones = [
        Geometry::Sphere { radius },
        Geometry::Cone {
            radius,
            half_height,
        },
        Geometry::Ellipsoid { half },
    ];
    for (i, stone) in stones.into_iter().enumerate() {
        let at = DVec3::new(0.5 * i as f64 - 0.5, 0.12, 0.1 * i as f64);
        let object = world.object(format!("stone {i}"));
        let body = object.body(format!("body {i}")).at(Pose::at(at));
        body.shape(Shape::new(stone).with_masks(2, 1));
    }
    world.build().unwrap()
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn stones_on_a_plane_agree() {
    stones_agree(Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    });
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn stones_on_a_mesh_agree() {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let corners = corners.map(|(x, z)| DVec3::new(x, 0.02 * x, z));
    let mesh = TriangleMesh::new(&corners, &[[0, 2, 1], [0, 3, 2]]).unwrap();
    stones_agree(Geometry::Mesh(mesh));
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn articulated_bodies_that_touch_come_to_rest_as_on_the_processor() {
    come_to_rest(SolverKind::Featherstone);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn bodies_in_maximal_coordinates_that_touch_come_to_rest_as_on_the_processor() {
    come_to_rest(SolverKind::Xpbd);
}
