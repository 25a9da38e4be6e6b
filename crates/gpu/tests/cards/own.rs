//! What wgpu alone has: buffers that are too small for all worlds, cards that are named.

use crate::card::card;
use crate::pair::Pair;
use crate::worlds::{H, settings};
use kinetarium_gpu::{Choice, Gpu, GpuError, Worlds};
use model::examples::{Start, chain};
use records::Programs;
use rigid::{Featherstone, Kernels, Settings, Solver};

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
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
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
