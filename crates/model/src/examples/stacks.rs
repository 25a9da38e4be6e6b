//! Boxes on boxes.

use super::countable;
use super::stuff::{STONE, WOOD, floor};
use crate::{Builder, Geometry, Model, ModelError, Pose, Shape};
use glam::DVec3;

/// Edge of the boxes [m].
const EDGE: f64 = 0.1;

/// A tower of wooden cubes of 10 cm, each `gap` [m] above the one below it.
///
/// To see: nothing. The gaps close, and the tower stands.
///
/// # Errors
/// If there are no boxes, or more than a million.
pub fn tower(boxes: usize, gap: f64) -> Result<Model, ModelError> {
    countable("tower", "number of boxes", boxes)?;
    let mut world = Builder::new(format!("tower_{boxes}"));
    floor(world.object("ground"), STONE);
    let tower = world.object("tower");
    for i in 0..boxes {
        let height = (EDGE + gap) * (i as f64 + 1.0) - 0.5 * EDGE;
        tower
            .body(format!("box_{i}"))
            .at(Pose::at(DVec3::Y * height))
            .shape(cube());
    }
    world.build()
}

/// A wall of wooden cubes of 10 cm: as many in the lowest row as there are rows, one less in each
/// further row, every cube upon two, with 5 mm between neighbours.
///
/// To see: nothing. The wall stands.
///
/// # Errors
/// If there are no rows, or more than a thousand.
pub fn pyramid(rows: usize) -> Result<Model, ModelError> {
    const SPACING: f64 = 1.05 * EDGE;
    countable("pyramid", "number of boxes", rows.saturating_mul(rows))?;
    let mut world = Builder::new(format!("pyramid_{rows}"));
    floor(world.object("ground"), STONE);
    let wall = world.object("wall");
    for row in 0..rows {
        let width = rows - row;
        for i in 0..width {
            let x = SPACING * (i as f64 - 0.5 * (width - 1) as f64);
            wall.body(format!("box_{row}_{i}"))
                .at(Pose::at(DVec3::new(x, EDGE * (row as f64 + 0.5), 0.0)))
                .shape(cube());
        }
    }
    world.build()
}

fn cube() -> Shape {
    WOOD.shape(Geometry::Box {
        half: DVec3::splat(0.5 * EDGE),
    })
}
