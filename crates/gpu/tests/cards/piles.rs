//! Piles of one world, by sequential impulses on a card and on the processor.

use crate::card::card;
use crate::pair::Pair;
use model::Model;
use model::examples::{pile, pyramid, tower};
use rigid::Settings;
use sim::{SimulationSettings, SolverKind};

const H: f64 = 0.004;

fn settings() -> SimulationSettings {
    SimulationSettings {
        solver: SolverKind::Impulse,
        step: Settings {
            sleep_speed: 0.0,
            ..Settings::new(H)
        },
        ..SimulationSettings::new(1, H)
    }
}

fn agrees(model: &Model, steps: usize, once: f64) {
    let mut pair = Pair::at_rest(&card(), model, settings());
    for step in 0..steps {
        pair.put();
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < once, "{}: {moved:e} after step {step}", model.name);
    }
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn towers_agree_with_the_processor() {
    agrees(&tower(3, 0.001).unwrap(), 60, 1e-5);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn walls_agree_with_the_processor() {
    agrees(&pyramid(6).unwrap(), 60, 1e-5);
}

#[test]
#[ignore = "needs a graphics card or what stands in for one"]
fn mixed_piles_agree_with_the_processor() {
    agrees(&pile(30).unwrap(), 60, 1e-5);
}
