//! What wgpu alone has: buffers that are too small for all worlds, cards that are named.

use crate::card::{card, small};
use crate::pair::Pair;
use crate::worlds::{H, settings};
use kinetarium_gpu::{Choice, Gpu, GpuError, Worlds};
use model::examples::{Start, chain};
use records::Programs;
use rigid::{Featherstone, Kernels, Settings, Solver};
use sim::{Simulation, SimulationSettings, SolverKind};

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_beyond_one_buffer_lie_in_several() {
    let (card, model) = (small(1 << 23), chain(50, Start::Horizontal).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / kernels.lengths().longest();
    let worlds = 2 * widest + 1;
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let told = Worlds::new(&small(1 << 12), programs.clone(), 1).unwrap_err();
    assert!(matches!(told, GpuError::TooLarge { .. }), "{told}");
    let width = Worlds::new(&card, programs, worlds);
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

/// A card whose memory is full says so, and goes on. What a program has for memory is the machine's: it is not filled.
#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn worlds_that_do_not_fit_are_refused() {
    let card = card();
    if card.name().contains("llvmpipe") {
        return;
    }
    let model = chain(150, Start::Horizontal).unwrap();
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let widest = card.most_bytes() as usize / size_of::<f32>() / kernels.lengths().longest();
    let mut filled = Vec::new();
    let told = loop {
        match Worlds::new(&card, programs.clone(), widest) {
            Ok(worlds) => filled.push(worlds),
            Err(told) => break told,
        }
    };
    assert!(matches!(told, GpuError::Memory { .. }), "{told}");
    let pile = model::examples::towers(100, 10).unwrap();
    let impulse = SimulationSettings {
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(1, 0.004)
    };
    // What little is left may do for some steps.
    if let Ok(mut pile) = Simulation::on(&card, pile, impulse) {
        pile.try_step(10).unwrap();
        assert!(pile.diverged().is_empty());
    }
    drop(filled);
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
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
