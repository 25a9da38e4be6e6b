//! The scenes that are measured.

use crate::contest::ROUND;
use crate::engine::Outcome;
use kinetarium::model::ModelError;
use kinetarium::prelude::*;

const TOWERS: usize = 100;
const TOWER_BOXES: usize = 10;
const LAYERS: usize = 14;

/// A scene by its name, and which of its bodies ought to come down by a known distance.
pub struct Scene {
    pub name: &'static str,
    pub make: fn() -> Result<Model, ModelError>,
    /// Of a round.
    pub steps: usize,
    tops: Tops,
}

#[derive(Clone, Copy)]
enum Tops {
    None,
    Towers,
    Pyramid,
}

pub static SCENES: [Scene; 5] = [
    Scene {
        name: "100 towers of 10 boxes",
        make: || examples::towers(TOWERS, TOWER_BOXES),
        steps: ROUND,
        tops: Tops::Towers,
    },
    Scene {
        name: "pyramid of 1015 boxes",
        make: || examples::square_pyramid(LAYERS),
        steps: ROUND,
        tops: Tops::Pyramid,
    },
    Scene {
        name: "bowl of 100 solids",
        make: || examples::bowl(100),
        steps: ROUND,
        tops: Tops::None,
    },
    Scene {
        name: "bowl of 1000 solids",
        make: || examples::bowl(1000),
        steps: ROUND,
        tops: Tops::None,
    },
    Scene {
        name: "bowl of 10 000 solids",
        make: || examples::bowl(10_000),
        steps: 10,
        tops: Tops::None,
    },
];

impl Scene {
    /// The bodies at the top, each of which comes down by 1 mm for itself and each one below it.
    pub fn tops(&self, model: &Model) -> Outcome<Vec<BodyId>> {
        let names: Vec<String> = match self.tops {
            Tops::None => Vec::new(),
            Tops::Towers => (0..TOWERS).map(|t| top_of_tower(t, TOWER_BOXES)).collect(),
            Tops::Pyramid => vec![format!("box_{}_0", LAYERS - 1)],
        };
        let ids = names.iter().map(|name| Ok(model.body(name)?));
        ids.collect()
    }
}

pub fn top_of_tower(tower: usize, boxes: usize) -> String {
    format!("box_{tower}_{}", boxes - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_has_its_tops() {
        let counts = [100, 1, 0, 0];
        for (scene, count) in SCENES.iter().zip(counts) {
            let model = (scene.make)().unwrap();
            assert_eq!(scene.tops(&model).unwrap().len(), count, "{}", scene.name);
        }
    }
}
