//! Worlds on a card are worlds as any others: set, reset, read, watched, restored.

use crate::models::mixed;
use crate::pair::{Pair, card};
use kinetarium_gpu::{Choice, Gpu, GpuError, Worlds};
use model::examples::{Start, chain};
use model::{Builder, Geometry, Model, Pose, Shape};
use rigid::{Featherstone, Kernels, Programs, Settings};
use sim::{
    EventKind, Quantity, Simulation, SimulationError, SimulationSettings, SolverKind, Watch,
};

const H: f64 = 0.002;

fn settings(worlds: usize) -> SimulationSettings {
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
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_beyond_one_buffer_lie_in_several() {
    let (card, model) = (card(), chain(50, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / kernels.lengths().longest();
    let worlds = 2 * widest + 1;
    if worlds > 100_000 {
        // A card that takes buffers so large holds what anybody simulates in one.
        return;
    }
    let width = Worlds::new(&card, Programs::record(&kernels).unwrap(), worlds);
    assert_eq!(worlds.div_ceil(width.unwrap().width()), 3);
    let mut pair = Pair::new(&card, &model, settings(worlds));
    let start = pair.cpu.model().initial_position();
    // Of each part, and some worlds that are set again by themselves.
    for round in [1.0, 2.0] {
        let every = if round == 1.0 { 1 } else { widest / 3 };
        for simulation in pair.both() {
            for world in (0..worlds).step_by(every) {
                let mut position = start.clone();
                position[0] += round * 1e-3 * (world % 1000) as f64;
                let velocity = vec![0.0; position.len()];
                simulation
                    .set_joint_state(world, &position, &velocity)
                    .unwrap();
            }
        }
        pair.step(1);
        let moved = pair.moved_apart();
        // Neighbours are ten times as far apart.
        assert!(moved < 1e-4, "{moved:e}");
    }
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn events_are_those_of_the_processor() {
    let mut pair = Pair::new(&card(), &ball(), settings(2));
    let [cpu, gpu] = pair.both().map(|simulation| {
        simulation.watch(Watch::ALL);
        // √(2 · 0.9 m / g) = 0.43 s.
        simulation.step(300);
        let events = simulation.drain_events().into_iter();
        let begin = events.filter(|e| matches!(e.kind, EventKind::ContactBegins { .. }));
        begin.map(|e| (e.world, e.time)).collect::<Vec<_>>()
    });
    assert_eq!(cpu, gpu);
    assert!(cpu.len() >= 2, "{cpu:?}");
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn a_solver_that_runs_on_processors_only_is_refused() {
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        ..settings(1)
    };
    let told = Simulation::on(&card(), ball(), settings).unwrap_err();
    assert!(
        matches!(told, SimulationError::NotOnDevice { .. }),
        "{told}"
    );
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
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
    assert_eq!(card.compiled(), 2);
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn a_card_that_is_not_there_is_refused_with_those_that_are() {
    let name = card().name().to_owned();
    let wanted = Choice::Named("no such card".into());
    let told = Gpu::open(&wanted).unwrap_err();
    assert!(matches!(told, GpuError::NoCard { .. }));
    let bare = name.split(" (").next().unwrap();
    assert!(told.to_string().contains(bare), "{told}");
}
