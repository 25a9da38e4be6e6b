//! Every example scene, and the machines of the page's gallery, on a card and on the processor, by the solvers of trees; by
//! that of piles see `piles`.
//!
//! Where things touch, rounding soon decides who slips first. A step from the same state agrees; after some time the
//! whole has the same energy and the same mean height, which do not depend on who lies where.

use crate::card::card;
use crate::pair::{Pair, of_joints};
use formats::{InMemory, Options};
use model::examples::{self, SCENES, Scene};
use model::{BodyId, Model};
use sim::{Outputs, SimulationSettings};

const WORLDS: usize = 2;
/// Poses after a step [m, or numbers of unit quaternions]. Rounding decides which of two features of boxes touch, and
/// with it where they are pushed.
const ONCE: f64 = 1e-4;
/// Steps that each takes by itself before the whole is compared.
const FREE: usize = 160;

/// Energy [J], and the mean height [m] of all bodies, of so many worlds together.
pub fn statistics(outputs: &Outputs<'_, f32>, model: &Model, worlds: usize) -> [f64; 2] {
    let (bodies, up) = (model.bodies.len(), -model.gravity.normalize());
    let mut sums = [0.0; 2];
    for world in 0..worlds {
        sums[0] += outputs.energy(world);
        for body in (0..bodies).map(BodyId) {
            sums[1] += outputs.body_position(world, body).dot(up) / bodies as f64;
        }
    }
    sums
}

fn agrees(name: &str, model: &Model) {
    let settings = SimulationSettings {
        solver: of_joints(model),
        ..SimulationSettings::new(WORLDS, model.time_step)
    };
    let mut pair = Pair::at_rest(&card(), model, settings);
    for _ in 0..4 {
        pair.put();
        pair.step(1);
        let moved = pair.moved_apart();
        assert!(moved < ONCE, "{name}: {moved:e} after a step");
        pair.step(39);
    }
    pair.step(FREE);
    assert!(pair.gpu.diverged().is_empty(), "{name}");
    let [cpu, gpu] = pair.both().map(|s| statistics(&s.outputs(), model, WORLDS));
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
                let name = stringify!($name);
                agrees(name, &Scene::find(name).unwrap().model().unwrap());
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

fn read(name: &str, text: &str) -> Model {
    let files = InMemory::new([(name, text)]);
    formats::parse(text, name, &files, &Options::default())
        .unwrap()
        .model
}

macro_rules! machines {
    ($($name:ident $model:expr;)*) => {
        $(
            #[test]
            #[ignore = "needs a graphics card or what stands in for one"]
            fn $name() {
                agrees(stringify!($name), &$model);
            }
        )*
    };
}

machines! {
    humanoid read("humanoid.xml", include_str!("../../../session/models/humanoid.xml"));
    ant read("ant.xml", include_str!("../../../session/models/ant.xml"));
    linkage examples::linkage(2).unwrap();
    rover examples::rover().unwrap();
    ball_joint examples::ball_joint().unwrap();
    prismatic examples::prismatic().unwrap();
}
