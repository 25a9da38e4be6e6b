//! Worlds on a card are worlds as any others: set, reset, read, watched, restored.

use crate::card::{KERNELS, card};
use crate::every_gauge::every_gauge;
use crate::models::mixed;
use crate::pair::Pair;
use crate::reports::happened;
use glam::{DMat3, DVec3};
use model::examples::{Start, chain};
use model::{BodyId, Builder, Geometry, Model, Pose, Shape};
use sim::{
    Event, EventKind, Parameter, Quantity, Simulation, SimulationSettings, SolverKind, Watch,
};

pub const H: f64 = 0.002;

pub fn settings(worlds: usize) -> SimulationSettings {
    SimulationSettings {
        solver: SolverKind::Featherstone,
        ..SimulationSettings::new(worlds, H)
    }
}

/// A ball that falls to the ground from 1 m.
fn ball() -> Model {
    let mut world = Builder::new("ball");
    world.object("ground").scenery(Shape::new(Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    }));
    let sphere = Geometry::Sphere { radius: 0.1 };
    let ball = world.object("ball").body("ball").shape(sphere);
    ball.at(Pose::at(glam::DVec3::Y));
    world.build().unwrap()
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_are_set_and_reset_one_by_one() {
    let (card, model) = (card(), mixed(true).unwrap());
    let mut pair = Pair::new(&card, &model, settings(70));
    pair.step(20);
    let dofs = model.degrees_of_freedom();
    for simulation in pair.both() {
        simulation.reset(&[3, 64]).unwrap();
        let velocity: Vec<_> = (0..dofs).map(|i| 0.1 * i as f64).collect();
        let position = model.initial_position();
        simulation
            .set_joint_state(69, &position, &velocity)
            .unwrap();
        simulation.move_joints(0, &position, &velocity).unwrap();
    }
    pair.step(1);
    let times = pair
        .both()
        .map(|s| [0, 3, 64, 69, 70 - 2].map(|w| s.time(w)));
    assert_eq!(times[0], times[1]);
    let apart = pair.apart();
    assert!(apart < 1e-4, "{apart:e}");
    pair.step(20);
    let apart = pair.apart();
    assert!(apart < 1e-3, "{apart:e}");
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_snapshot_returns_to_a_card_and_to_the_processor() {
    let (card, model) = (card(), mixed(true).unwrap());
    let mut pair = Pair::new(&card, &model, settings(5));
    pair.gpu.step(50);
    let snapshot = pair.gpu.snapshot();
    pair.gpu.step(30);
    let after = pair.gpu.snapshot();
    pair.gpu.restore(&snapshot).unwrap();
    assert_eq!(pair.gpu.snapshot(), snapshot);
    pair.gpu.step(30);
    assert_eq!(
        pair.gpu.snapshot(),
        after,
        "the same steps on the same card"
    );
    pair.cpu.restore(&snapshot).unwrap();
    pair.cpu.step(30);
    let apart = pair.apart();
    assert!(apart < 1e-3, "{apart:e}");
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn what_is_read_is_of_the_present_state() {
    let (card, model) = (card(), mixed(true).unwrap());
    let mut simulation = Simulation::on(&card, model, settings(3)).unwrap();
    let mut positions = vec![0.0; 3 * simulation.model().coordinates()];
    for _ in 0..3 {
        simulation.step(5);
        simulation
            .read(Quantity::JointPosition, &mut positions)
            .unwrap();
        let outputs = simulation.outputs();
        let all: Vec<_> = (0..3).flat_map(|w| outputs.joint_position(w)).collect();
        let read: Vec<_> = positions.iter().map(|x| f64::from(*x)).collect();
        assert_eq!(read, all);
    }
    let before = simulation.outputs().joint_acceleration(1);
    simulation.controls().set_dof_force(1, 0, 50.0).unwrap();
    let pushed = simulation.outputs().joint_acceleration(1);
    assert_ne!(before, pushed, "controls act on accelerations at once");
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_world_that_diverges_stops_and_harms_no_other() {
    let (card, model) = (card(), mixed(false).unwrap());
    let mut pair = Pair::new(&card, &model, settings(3));
    for simulation in pair.both() {
        simulation.controls().set_dof_force(1, 3, 1e30).unwrap();
    }
    pair.step(50);
    for simulation in pair.both() {
        let diverged: Vec<_> = simulation.diverged().iter().map(|d| d.world).collect();
        assert_eq!(diverged, [1]);
    }
    let apart = pair.apart();
    assert!(apart < 1e-3, "{apart:e}");
    for simulation in pair.both() {
        simulation.reset(&[1]).unwrap();
    }
    pair.step(1);
    assert!(pair.gpu.diverged().is_empty());
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_can_have_constants_of_their_own() {
    let (card, model) = (card(), mixed(true).unwrap());
    let mut parts = (*model).clone();
    parts.gravity *= 0.5;
    let lighter = Model::new(parts).unwrap();
    let mut pair = Pair::new(&card, &model, settings(2));
    pair.step(5);
    for simulation in pair.both() {
        simulation.set_world_model(1, &lighter).unwrap();
    }
    pair.step(20);
    let apart = pair.apart();
    assert!(apart < 1e-4, "{apart:e}");
    let states = [0, 1].map(|w| pair.gpu.numbers_of_world(w).unwrap().state);
    assert_ne!(states[0], states[1]);
}

/// Worlds have the same bits whether each is given its constants by itself, some time after the others, or all at once.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn constants_of_few_worlds_are_those_of_all() {
    const WORLDS: usize = 70;
    let (card, model) = (card(), mixed(false).unwrap());
    let lighter = |world: usize| [0.0, -9.81 / (1 + world % 3) as f64, 0.0];
    let of = |rounds: &[Vec<usize>]| {
        let mut simulation = Simulation::on(&card, model.clone(), settings(WORLDS)).unwrap();
        let mut gauges = simulation.gauges(every_gauge(&model)).unwrap();
        let all = Vec::from_iter(0..WORLDS);
        for worlds in rounds {
            let gravity = Vec::from_iter(worlds.iter().copied().flat_map(lighter));
            let given = simulation.set_parameter(Parameter::Gravity, worlds, &gravity);
            given.unwrap();
            simulation.read_gauges(&mut gauges, &all).unwrap();
        }
        simulation.reset_all();
        simulation.step(10);
        simulation.read_gauges(&mut gauges, &all).unwrap();
        let mut read = vec![0.0_f32; WORLDS * gauges.length()];
        let rows = read.chunks_exact_mut(gauges.length()).enumerate();
        rows.for_each(|(world, row)| gauges.copy(world, 0, row));
        (simulation.snapshot(), read)
    };
    let together = of(&[Vec::from_iter(0..WORLDS)]);
    let rest = (0..WORLDS).filter(|w| ![3, 64, 69].contains(w));
    let apart = of(&[Vec::from_iter(rest), vec![69, 3], vec![64]]);
    assert!(together == apart);
    let differs = |world: usize| together.0 != of(&[vec![world]]).0;
    assert!(differs(1));
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn events_are_those_of_the_processor() {
    let mut pair = Pair::new(&card(), &ball(), settings(2));
    let [cpu, gpu] = pair.both().map(|simulation| {
        simulation.watch(Watch::ALL);
        // √(2 · 0.9 m / g) = 0.43 s.
        simulation.step(300);
        let events = simulation.drain_events();
        let all = events.iter().map(|event| (event.time, happened(event)));
        let begins = |e: &&Event| matches!(e.kind, EventKind::ContactBegins { .. });
        (Vec::from_iter(all), events.iter().filter(begins).count())
    });
    assert_eq!(cpu, gpu);
    assert!(cpu.1 >= 2, "{cpu:?}");
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_kernel_is_compiled_once_for_a_card() {
    let (card, model) = (card(), chain(6, Start::Horizontal).unwrap());
    for worlds in [1, 7] {
        let mut simulation = Simulation::on(&card, model.clone(), settings(worlds)).unwrap();
        simulation.step(40);
        let mut positions = vec![0.0; worlds * 6];
        simulation
            .read(Quantity::JointPosition, &mut positions)
            .unwrap();
    }
    assert_eq!(card.compiled(), KERNELS);
}

/// Of what does not move there is nothing to control.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_without_controls_are_restored() {
    let mut world = Builder::new("fixed");
    let object = world.object("post");
    let inertia = DMat3::IDENTITY;
    let post = object.body("post").inertia(1.0, DVec3::ZERO, inertia);
    let post = post.handle();
    object.fixed("nail", post);
    let model = world.build().unwrap();
    for solver in [SolverKind::Featherstone, SolverKind::Impulse] {
        let settings = SimulationSettings {
            solver,
            ..settings(5)
        };
        let mut simulation = Simulation::on(&card(), model.clone(), settings).unwrap();
        let before = simulation.snapshot();
        simulation.step(2);
        simulation.restore(&before).unwrap();
        simulation.try_step(2).unwrap();
        let position = simulation
            .try_outputs()
            .unwrap()
            .body_position(4, BodyId(0));
        assert!(position.length() < 1e-3, "{solver:?}: {position}");
    }
}
