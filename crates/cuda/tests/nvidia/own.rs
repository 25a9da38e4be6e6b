//! What CUDA alone has: cards that are counted, and no limit of a buffer but the card's memory.

use crate::card::{Card, card};
use crate::models::mixed;
use crate::worlds::{H, settings};
use kinetarium_cuda::{CudaError, Worlds};
use records::Programs;
use rigid::{Featherstone, Settings, Solver};
use sim::Simulation;

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_card_that_is_not_there_is_refused_with_those_that_are() {
    let told = Card::open(99).unwrap_err();
    assert!(matches!(told, CudaError::NoCard { ordinal: 99, .. }));
    let name = card().name().replace(" (CUDA)", "");
    assert!(told.to_string().contains(&name), "{told}");
}

/// A card whose memory is full says so, and goes on.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_that_do_not_fit_are_refused() {
    let (card, model) = (card(), mixed(true).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let place = |worlds| Worlds::new(&card, programs.clone(), worlds);
    let longest = programs.lengths.longest().max(programs.parameters.len());
    let most = u32::MAX as usize / longest;
    let told = place(most + 1).unwrap_err();
    assert!(matches!(told, CudaError::TooMany { .. }), "{told}");
    let filled: Result<Vec<_>, _> = (0..100).map(|_| place(most)).collect();
    let told = filled.unwrap_err();
    assert!(matches!(told, CudaError::Memory { .. }), "{told}");
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}
