//! Boxes on boxes.

use super::countable;
use super::stuff::{PAINTED, PLAIN, STONE, Stuff, floor};
use crate::{Builder, Geometry, Model, ModelError, Object, Pose};
use glam::DVec3;

/// Edge of the boxes [m].
const EDGE: f64 = 0.1;
/// Between neighbours, and above the ground, in the stacks that are measured [m].
const GAP: f64 = 0.001;

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
        let place = DVec3::Y * height(i, gap);
        cube(tower, format!("box_{i}"), place, PAINTED);
    }
    world.build()
}

/// As many towers, on a grid of a metre, each of as many cubes of 10 cm, with 1 mm between cubes and
/// below the lowest. Cube i of tower t is `box_t_i`.
///
/// To see: nothing. Each top comes down by 1 mm a cube, and the towers stand.
///
/// # Errors
/// If there are no cubes, or more than a million.
pub fn towers(count: usize, boxes: usize) -> Result<Model, ModelError> {
    countable("towers", "number of boxes", count.saturating_mul(boxes))?;
    let mut world = Builder::new(format!("towers_{count}x{boxes}"));
    floor(world.object("ground"), PLAIN);
    let towers = world.object("towers");
    let side = (count as f64).sqrt().ceil() as usize;
    for t in 0..count {
        let place = square(side, t, 1.0);
        for i in 0..boxes {
            let up = DVec3::Y * height(i, GAP);
            cube(towers, format!("box_{t}_{i}"), place + up, PLAIN);
        }
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
            let place = DVec3::new(x, EDGE * (row as f64 + 0.5), 0.0);
            cube(wall, format!("box_{row}_{i}"), place, PAINTED);
        }
    }
    world.build()
}

/// A pyramid of cubes of 10 cm upon a square: as many layers as cubes along its lowest edge, each
/// layer one cube narrower than the one below, every cube upon four, with 1 mm between neighbours and
/// below the lowest. Cube i of a layer is `box_layer_i`; 14 layers have 1015 cubes.
///
/// To see: nothing. The top comes down by 1 mm a layer, and the pyramid stands.
///
/// # Errors
/// If there are no layers, or more than a hundred.
pub fn square_pyramid(layers: usize) -> Result<Model, ModelError> {
    let most = layers.saturating_mul(layers).saturating_mul(layers);
    countable("square pyramid", "number of boxes", most)?;
    let mut world = Builder::new(format!("square_pyramid_{layers}"));
    floor(world.object("ground"), PLAIN);
    let pyramid = world.object("pyramid");
    for layer in 0..layers {
        let side = layers - layer;
        let up = DVec3::Y * height(layer, GAP);
        for i in 0..side * side {
            let place = square(side, i, EDGE + GAP) + up;
            cube(pyramid, format!("box_{layer}_{i}"), place, PLAIN);
        }
    }
    world.build()
}

/// Of the middle of the i-th cube from below, with a gap below each [m].
fn height(i: usize, gap: f64) -> f64 {
    (EDGE + gap) * (i as f64 + 1.0) - 0.5 * EDGE
}

/// The i-th place of a square about the origin, of as many along each side.
fn square(side: usize, i: usize, spacing: f64) -> DVec3 {
    let middle = 0.5 * (side as f64 - 1.0);
    let (x, z) = ((i % side) as f64, (i / side) as f64);
    spacing * DVec3::new(x - middle, 0.0, z - middle)
}

fn cube(object: &mut Object, name: String, place: DVec3, stuff: Stuff) {
    let half = DVec3::splat(0.5 * EDGE);
    object
        .body(name)
        .at(Pose::at(place))
        .shape(stuff.shape(Geometry::Box { half }));
}

#[cfg(test)]
mod tests {
    use super::super::overlap::nothing_overlaps;
    use super::*;

    #[test]
    fn towers_stand_apart_with_as_many_boxes_each() {
        for (count, boxes) in [(1, 10), (10, 10), (100, 10)] {
            let model = towers(count, boxes).unwrap();
            assert_eq!(model.bodies.len(), count * boxes);
            assert!(model.bodies.iter().all(|b| (b.mass - 1.0).abs() < 1e-12));
            nothing_overlaps(&model);
        }
        let model = towers(3, 4).unwrap();
        let top = &model.bodies[model.body("box_2_3").unwrap().0];
        let place = DVec3::new(-0.5, 3.5 * EDGE + 4.0 * GAP, 0.5);
        assert!(top.pose.position.distance(place) < 1e-12);
        assert!(towers(0, 1).is_err() && towers(1, 0).is_err());
        assert!(towers(usize::MAX, 2).is_err());
    }

    #[test]
    fn a_square_pyramid_of_fourteen_layers_has_1015_boxes() {
        for (layers, boxes) in [(1, 1), (3, 14), (14, 1015)] {
            let model = square_pyramid(layers).unwrap();
            assert_eq!(model.bodies.len(), boxes);
            nothing_overlaps(&model);
        }
    }
}
