//! The scenes that are measured.

use crate::contest::ROUND;
use crate::engine::Outcome;
use glam::{DVec2, DVec3};
use kinetarium::model::{ModelError, Shape, TriangleMesh};
use kinetarium::prelude::*;
use std::f64::consts::TAU;

const TOWERS: usize = 100;
const TOWER_BOXES: usize = 10;
const LAYERS: usize = 14;

/// A scene by its name, and which of its bodies ought to come down by a known distance.
pub struct Scene {
    pub name: &'static str,
    pub make: fn() -> Result<Model, ModelError>,
    /// Of a round.
    pub steps: usize,
    /// Whether it is measured at rest, too.
    pub rests: bool,
    tops: Tops,
}

#[derive(Clone, Copy)]
enum Tops {
    None,
    Towers,
    Pyramid,
}

pub static SCENES: [Scene; 6] = [
    Scene {
        name: "100 towers of 10 boxes",
        make: || examples::towers(TOWERS, TOWER_BOXES),
        steps: ROUND,
        rests: false,
        tops: Tops::Towers,
    },
    Scene {
        name: "pyramid of 1015 boxes",
        make: || examples::square_pyramid(LAYERS),
        steps: ROUND,
        rests: false,
        tops: Tops::Pyramid,
    },
    Scene {
        name: "bowl of 100 solids",
        make: || examples::bowl(100),
        steps: ROUND,
        rests: true,
        tops: Tops::None,
    },
    Scene {
        name: "bowl of 1000 solids",
        make: || examples::bowl(1000),
        steps: ROUND,
        rests: true,
        tops: Tops::None,
    },
    Scene {
        name: "bowl of 10 000 solids",
        make: || examples::bowl(10_000),
        steps: 10,
        rests: true,
        tops: Tops::None,
    },
    Scene {
        name: "1000 solids on 3872 triangles",
        make: || bumps(1000),
        steps: ROUND,
        rests: false,
        tops: Tops::None,
    },
];

/// The solids of a bowl, side by side, above a mesh of waves in which they come to rest.
fn bumps(count: usize) -> Result<Model, ModelError> {
    const CELLS: usize = 44;
    const CELL: f64 = 0.1;
    const SPACING: f64 = 0.12;
    let wave = |cell: usize| (TAU * cell as f64 / 8.0).sin();
    let row = |z: usize| (0..=CELLS).map(|x| 0.03 * wave(x) * wave(z)).collect();
    let heights: Vec<Vec<f64>> = (0..=CELLS).map(row).collect();
    let mesh = TriangleMesh::height_field(&heights, DVec2::splat(CELL))?;
    let bowl = examples::bowl(count)?;
    let (solids, ground): (Vec<_>, Vec<_>) = bowl.shapes.iter().partition(|s| s.body.is_some());
    let mut world = Builder::new(format!("bumps_{count}"));
    let field = Shape::new(Geometry::Mesh(mesh)).with_material(ground[0].material);
    world.object("ground").scenery(field.named("field"));
    let object = world.object("solids");
    let side = (count as f64).sqrt().ceil() as usize;
    for (i, solid) in solids.into_iter().enumerate() {
        let place = [i % side, i / side].map(|n| SPACING * (n as f64 - 0.5 * side as f64));
        let body = object.body(format!("solid_{i}"));
        let body = body.at(Pose::at(DVec3::new(place[0], 0.1, place[1])));
        body.shape(Shape {
            body: None,
            ..solid.clone()
        });
    }
    world.build()
}

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
