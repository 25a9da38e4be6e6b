//! Every example scene, on a card and on the processor.
//!
//! Where things touch, rounding soon decides who slips first. A step from the same state agrees; after a second
//! the whole still has the same energy and the same mean height, which does not depend on who lies where.

use crate::pair::{Pair, card};
use model::BodyId;
use model::examples::SCENES;
use sim::{Outputs, SimulationSettings};

const WORLDS: usize = 2;

/// Energy [J], and the mean height [m] of all that moves, of all worlds together.
fn statistics(outputs: &Outputs<'_, f32>, bodies: usize) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for world in 0..WORLDS {
        sums[0] += outputs.energy(world);
        for body in (0..bodies).map(BodyId) {
            sums[1] += outputs.body_position(world, body).y / bodies as f64;
        }
    }
    sums
}

#[test]
#[ignore = "needs a graphics card or Mesa's llvmpipe"]
fn every_scene_agrees_with_the_processor() {
    let card = card();
    for scene in &SCENES {
        let begin = std::time::Instant::now();
        let model = scene.model().unwrap();
        let settings = SimulationSettings::new(WORLDS, model.time_step);
        let mut pair = Pair::new(&card, &model, settings);
        let (name, bodies) = (scene.name, model.bodies.len());
        let before = statistics(&pair.cpu.outputs(), bodies);
        let steps = (1.0 / model.time_step).round() as usize;
        for _ in 0..5 {
            pair.put();
            pair.step(1);
            let moved = pair.moved_apart();
            assert!(moved < 1e-5, "{name}: {moved:e} after a step");
            pair.step(9);
        }
        pair.step(steps - 50);
        assert!(pair.gpu.diverged().is_empty(), "{name}");
        let [cpu, gpu] = pair.both().map(|s| statistics(&s.outputs(), bodies));
        eprintln!(
            "{name}: {cpu:?} {gpu:?}, {before:?}, {:.1} s",
            begin.elapsed().as_secs_f64()
        );
        for ((cpu, gpu), before) in cpu.into_iter().zip(gpu).zip(before) {
            let size = before.abs().max(cpu.abs());
            assert!(
                (cpu - gpu).abs() < 0.01 * size,
                "{name}: {cpu}, on the card {gpu}"
            );
        }
    }
}
