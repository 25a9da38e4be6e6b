//! CUDA rounds every operation as processors do, so what comes out has the same bits.

use crate::agreement::read;
use crate::card::card;
use crate::models::{heap, looped, mixed};
use crate::pair::{Pair, of_joints};
use crate::worlds::settings;
use model::Model;
use model::examples::{SCENES, rings};
use sim::{Quantity, SimulationSettings, SolverKind};

fn has_the_same_bits(model: &Model, solver: SolverKind, contacts: bool, steps: usize) {
    let settings = SimulationSettings {
        solver,
        contacts,
        ..settings(5)
    };
    have_the_same_bits(Pair::new(&card(), model, settings), steps);
}

fn have_the_same_bits(mut pair: Pair, steps: usize) {
    pair.step(steps);
    for quantity in Quantity::ALL {
        let [cpu, cuda] = pair.both().map(|s| read(s, quantity));
        let mut numbers = cpu.iter().zip(&cuda).enumerate();
        let apart = numbers.find(|(_, (x, y))| x.to_bits() != y.to_bits());
        assert_eq!(
            apart,
            None,
            "{quantity:?} of {}, {} after {steps} steps",
            pair.cpu.model().name,
            pair.cpu.solver()
        );
    }
    assert!(pair.cpu.diverged().is_empty());
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn articulated_bodies_have_the_same_bits() {
    has_the_same_bits(&mixed(true).unwrap(), SolverKind::Featherstone, false, 300);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn closed_loops_have_the_same_bits() {
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        has_the_same_bits(&looped().unwrap(), solver, false, 300);
    }
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn bodies_that_touch_have_the_same_bits() {
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        has_the_same_bits(&heap().unwrap(), solver, true, 500);
    }
}

/// Rings of triangles on a peg, and a chain of them.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn meshes_that_move_have_the_same_bits() {
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        has_the_same_bits(&rings(1).unwrap(), solver, true, 100);
    }
}

/// Not a bit is lost where things tumble and rounding decides who slips first.
#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn every_scene_has_the_same_bits() {
    let card = card();
    for scene in SCENES {
        let model = scene.model().unwrap();
        let settings = SimulationSettings {
            solver: of_joints(&model),
            ..SimulationSettings::new(2, model.time_step)
        };
        have_the_same_bits(Pair::at_rest(&card, &model, settings), 200);
    }
}
