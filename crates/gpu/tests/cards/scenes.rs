//! Every example scene, on a card and on the processor, by the solvers of trees; by that of piles see `piles`.
//!
//! Where things touch, rounding soon decides who slips first. A step from the same state agrees; after some time the
//! whole has the same energy and the same mean height, which do not depend on who lies where.

use crate::card::card;
use crate::pair::{Pair, of_joints};
use model::BodyId;
use model::examples::{SCENES, Scene};
use sim::{Outputs, SimulationSettings};

const WORLDS: usize = 2;
/// Poses after a step [m, or numbers of unit quaternions]. Rounding decides which of two features of boxes touch, and
/// with it where they are pushed.
const ONCE: f64 = 1e-4;

/// Energy [J], and the mean height [m] of all bodies, of all worlds together.
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

fn agrees(name: &str) {
    let model = Scene::find(name).unwrap().model().unwrap();
    let settings = SimulationSettings {
        solver: of_joints(&model),
        ..SimulationSettings::new(WORLDS, model.time_step)
    };
    let mut pair = Pair::at_rest(&card(), &model, settings);
    let bodies = model.bodies.len();
    for _ in 0..4 {
        pair.put();
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < ONCE, "{name}: {moved:e} after a step");
        pair.step(39);
    }
    assert!(pair.gpu.diverged().is_empty(), "{name}");
    let [cpu, gpu] = pair.both().map(|s| statistics(&s.outputs(), bodies));
    for (cpu, gpu) in cpu.into_iter().zip(gpu) {
        assert!(
            (cpu - gpu).abs() < 0.01 * cpu.abs(),
            "{name}: {cpu}, on the card {gpu}"
        );
    }
}

/// A test for each, so that they are compiled side by side.
macro_rules! scenes {
    ($($name:ident)*) => {
        $(
            #[test]
            #[ignore = "needs a graphics card or what stands in for one"]
            fn $name() {
                agrees(stringify!($name));
            }
        )*

        #[test]
        fn none_is_left_out() {
            let names = SCENES.map(|scene| scene.name);
            assert_eq!(names, [$(stringify!($name)),*]);
        }
    };
}

scenes! {
    balls billiards collide dominoes tower pyramid card_house arch pile terrain ragdolls room
}
