//! What CUDA alone has: cards that are counted, and no limit of a buffer but the card's memory.

use crate::card::{Card, card};
use crate::models::mixed;
use crate::worlds::{H, settings};
use ::piles::Card as _;
use kinetarium_cuda::{CudaError, Worlds};
use numbers::trace::PIECE;
use records::Programs;
use rigid::{Featherstone, Settings, Solver};
use sim::{DeviceError, DeviceWorlds, Simulation};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Held by those that fill a card's memory, which one of them alone can do.
fn full() -> MutexGuard<'static, ()> {
    static FULL: Mutex<()> = Mutex::new(());
    FULL.lock().unwrap_or_else(PoisonError::into_inner)
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_card_that_is_not_there_is_refused_with_those_that_are() {
    let told = Card::open(99).unwrap_err();
    assert!(matches!(told, CudaError::NoCard { ordinal: 99, .. }));
    let name = card().name().replace(" (CUDA)", "");
    assert!(told.to_string().contains(&name), "{told}");
}

/// Of what stands in for a driver.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn cards_that_are_too_old_or_taken_are_refused() {
    if card().name() != "processor (CUDA)" {
        return;
    }
    let told = Card::open(1).unwrap_err();
    assert!(matches!(told, CudaError::TooOld { .. }), "{told}");
    let told = Card::open(2).unwrap_err();
    assert!(matches!(told, CudaError::Refused { .. }), "{told}");
    assert!(!told.to_string().contains("snapshot"), "{told}");
}

/// A driver that is older than NVRTC does not know its output, which harms no other kernel.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn a_kernel_that_is_not_loaded_leaves_the_card_as_it_was() {
    let card = card();
    if card.name() != "processor (CUDA)" {
        return;
    }
    let text = "@group(0) @binding(0) var<storage, read_write> out: array<u32>;
        @compute @workgroup_size(1) fn refused() { out[0] = 1u; }";
    let layout = card.layout(1, 0);
    let told = card
        .entries(text, ::piles::seen(text, ["refused"]), &layout)
        .unwrap_err();
    assert!(told.to_string().contains("update the driver"), "{told}");
    let mut few = Simulation::on(&card, mixed(true).unwrap(), settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}

/// All worlds have one set of constants until one is to have its own: only then is there more to count, and to hold.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn constants_of_worlds_own_that_do_not_fit_are_refused() {
    let (card, model) = (card(), mixed(true).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let mut programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    // About as many as of a mesh of 27,000 triangles.
    programs.parameters.resize(1 << 20, 0.0);
    let place = |worlds| Worlds::new(&card, programs.clone(), worlds).unwrap();
    let told = place(1 << 12).takes(&[]).unwrap_err().to_string();
    assert!(told.contains("constants of their own"), "{told}");
    let _alone = full();
    let filled = (0..100).map(|_| {
        let worlds = Worlds::new(&card, programs.clone(), (1 << 12) - 1)?;
        worlds.takes(&[])?;
        Ok::<_, DeviceError>(worlds)
    });
    let told = filled.collect::<Result<Vec<_>, _>>().unwrap_err();
    assert!(
        told.to_string().contains("the memory of the card"),
        "{told}"
    );
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}

/// A card whose memory is full says so, and goes on.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn worlds_that_do_not_fit_are_refused() {
    let (card, model) = (card(), mixed(true).unwrap());
    let kernels = Featherstone::new(&model, &Settings::new(H)).unwrap();
    let programs = Programs::record(Solver::Featherstone(&kernels)).unwrap();
    let place = |worlds| Worlds::new(&card, programs.clone(), worlds);
    let most = u32::MAX as usize / programs.lengths.longest();
    let most = most - most % PIECE as usize;
    let told = place(most + 1).unwrap_err();
    assert!(matches!(told, CudaError::TooMany { .. }), "{told}");
    let _alone = full();
    let filled: Result<Vec<_>, _> = (0..100).map(|_| place(most)).collect();
    let told = filled.unwrap_err();
    assert!(matches!(told, CudaError::Memory { .. }), "{told}");
    let mut few = Simulation::on(&card, model, settings(2)).unwrap();
    few.try_step(1).unwrap();
    assert!(few.diverged().is_empty());
}
