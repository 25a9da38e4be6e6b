//! Dominoes in a row.

use super::countable;
use super::stuff::{PAINTED, STONE, floor};
use crate::{Builder, Geometry, Model, ModelError, Pose};
use glam::{DQuat, DVec3};

/// Half sizes [m]: along the row, up, across.
const HALF: DVec3 = DVec3::new(0.015, 0.1, 0.05);
/// From one to the next [m].
const SPACING: f64 = 0.1;
/// Of the first [rad]: it balances at atan(0.15).
const TILT: f64 = 0.25;

/// Wooden dominoes of 20 cm in a row along x, the first one leaning beyond its balance.
///
/// To see: a wave of falling runs down the row at about 1.5 m/s, and they end lying on each other.
///
/// # Errors
/// If there are none, or more than a million.
pub fn dominoes(count: usize) -> Result<Model, ModelError> {
    countable("dominoes", "number", count)?;
    let mut world = Builder::new(format!("dominoes_{count}"));
    world.time_step(0.001);
    floor(world.object("ground"), STONE);
    let row = world.object("row");
    for i in 0..count {
        // Turned about the lower edge that it falls over.
        let edge = DVec3::new(HALF.x, 0.0, 0.0);
        let turn = DQuat::from_rotation_z(if i == 0 { -TILT } else { 0.0 });
        let place = edge + turn * (DVec3::Y * HALF.y - edge) + DVec3::X * (SPACING * i as f64);
        row.body(format!("domino_{i}"))
            .at(Pose::new(place, turn))
            .shape(PAINTED.shape(Geometry::Box { half: HALF }));
    }
    world.build()
}
