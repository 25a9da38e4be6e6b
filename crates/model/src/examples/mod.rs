//! Models to try things with.
//!
//! Y is up; lengths in metres. All scenes but the chains are of bodies that touch, on ground that is
//! level at y = 0.

mod arch;
mod ball_joint;
mod balls;
mod billiards;
mod bowl;
mod card_house;
mod chain;
mod collide;
mod dominoes;
mod linkage;
#[cfg(test)]
mod overlap;
mod pile;
mod prismatic;
mod ragdolls;
mod rings;
mod room;
mod rover;
mod stacks;
mod stuff;
mod terrain;

pub use arch::arch;
pub use ball_joint::ball_joint;
pub use balls::balls;
pub use billiards::billiards;
pub use bowl::bowl;
pub use card_house::card_house;
pub use chain::{CHAIN_LENGTH, CHAIN_LINK_MASS, Start, chain, n_pendula};
pub use collide::{Collide, Form, collide};
pub use dominoes::dominoes;
pub use linkage::linkage;
pub use pile::pile;
pub use prismatic::prismatic;
pub use ragdolls::ragdolls;
pub use rings::rings;
pub use room::room;
pub use rover::rover;
pub use stacks::{pyramid, square_pyramid, tower, towers};
pub use terrain::terrain;

use crate::model::{MOST_ROWS, Subject};
use crate::{Model, ModelError};

/// A scene of bodies that touch, by its name.
#[derive(Clone, Copy, Debug)]
pub struct Scene {
    /// Name, as a word.
    pub name: &'static str,
    /// What there is to see, in a line.
    pub about: &'static str,
    make: fn() -> Result<Model, ModelError>,
}

impl Scene {
    const fn new(
        name: &'static str,
        about: &'static str,
        make: fn() -> Result<Model, ModelError>,
    ) -> Self {
        Self { name, about, make }
    }
    /// The scene of that name, if there is one.
    pub fn find(name: &str) -> Option<&'static Self> {
        SCENES.iter().find(|scene| scene.name == name)
    }
    /// Makes the model.
    ///
    /// # Errors
    /// None; the scenes are tested.
    pub fn model(&self) -> Result<Model, ModelError> {
        (self.make)()
    }
}

/// The scenes, each of the size that shows it best.
pub static SCENES: [Scene; 12] = [
    Scene::new(
        "balls",
        "five balls bounce to e² of their height each, e = 0, ¼, ½, ¾, 1",
        balls,
    ),
    Scene::new(
        "billiards",
        "elastic balls on a smooth table: head-on, off centre, and five in a row",
        billiards,
    ),
    Scene::new("collide", "a pusher drives a cube against a ball", || {
        collide(Collide::default())
    }),
    Scene::new(
        "dominoes",
        "twenty dominoes, the first about to fall",
        || dominoes(20),
    ),
    Scene::new("tower", "ten boxes on each other, at rest", || {
        tower(10, 0.001)
    }),
    Scene::new("pyramid", "a wall of six rows of boxes, at rest", || {
        pyramid(6)
    }),
    Scene::new(
        "card_house",
        "three storeys of leaning cards, at rest",
        || card_house(3),
    ),
    Scene::new("arch", "nine wedges of stone, at rest", || arch(9)),
    Scene::new("pile", "solids of six kinds fall into a bowl", || pile(24)),
    Scene::new(
        "terrain",
        "solids tumble and a ball rolls down a hillside of triangles",
        || terrain(15),
    ),
    Scene::new(
        "ragdolls",
        "four limp people fall on the floor and on each other",
        || ragdolls(4),
    ),
    Scene::new(
        "room",
        "a ball falls off a table, a chair stands by, a door closes",
        room,
    ),
];

/// Refuses none, and more than a model can have.
fn countable(kind: &'static str, what: &'static str, count: usize) -> Result<(), ModelError> {
    let subject = Subject { kind, name: "" };
    subject.within(what, count as f64, 1.0, MOST_ROWS as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_a_tree_with_few_moving_shapes_and_is_found_by_its_name() {
        for scene in &SCENES {
            let model = scene.model().unwrap();
            assert!(model.is_tree(), "{}", scene.name);
            let moving = model.shapes.iter().filter(|s| s.body.is_some()).count();
            assert!((1..=60).contains(&moving), "{}: {moving}", scene.name);
            assert_eq!(Scene::find(scene.name).unwrap().about, scene.about);
        }
        assert!(Scene::find("towr").is_none());
    }

    #[test]
    fn scenes_of_nothing_or_far_too_much_are_refused() {
        for scene in [
            |n| arch(n),
            |n| tower(n, 0.0),
            |n| pyramid(n),
            |n| square_pyramid(n),
            |n| bowl(n),
            |n| card_house(n),
            |n| dominoes(n),
            |n| linkage(n),
            |n| pile(n),
            |n| rings(n),
            |n| terrain(n),
        ] as [fn(usize) -> Result<Model, ModelError>; 11]
        {
            assert!(scene(0).is_err() && scene(usize::MAX).is_err());
        }
    }
}
