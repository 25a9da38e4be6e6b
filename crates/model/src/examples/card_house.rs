//! A house of cards.

use super::countable;
use super::stuff::{CARD, STONE, floor};
use crate::{Builder, Geometry, Model, ModelError, Object, Pose};
use glam::{DQuat, DVec3};

/// Half sizes of a leaning card [m]: thickness, length, width.
const HALF: DVec3 = DVec3::new(0.0007, 0.05, 0.035);
/// Of a leaning card against the vertical [rad].
const LEAN: f64 = 0.35;
/// Between two neighbouring pairs of cards [m].
const GAP: f64 = 0.004;

/// A house of cardboard cards, 10 cm × 7 cm × 1.4 mm: each storey is a row of pairs that lean on each
/// other, a pair less than the one below, on a floor that is one long card.
///
/// To see: nothing. The house stands by friction alone.
///
/// # Errors
/// If there are no storeys, or more than a thousand.
pub fn card_house(storeys: usize) -> Result<Model, ModelError> {
    countable(
        "card house",
        "number of cards",
        storeys.saturating_mul(storeys),
    )?;
    let mut world = Builder::new(format!("card_house_{storeys}"));
    world.time_step(0.001);
    floor(world.object("ground"), STONE);
    let house = world.object("house");
    let mut height = 0.0;
    for storey in 0..storeys {
        let pairs = storeys - storey;
        for i in 0..pairs {
            let x = spacing() * (i as f64 - 0.5 * (pairs - 1) as f64);
            pair(house, &format!("{storey}_{i}"), DVec3::new(x, height, 0.0));
        }
        height += 2.0 * reach().y;
        if pairs > 1 {
            let half = DVec3::new(0.5 * spacing() * pairs as f64 - GAP, HALF.x, HALF.z);
            house
                .body(format!("floor_{storey}"))
                .at(Pose::at(DVec3::Y * (height + half.y)))
                .shape(CARD.shape(Geometry::Box { half }));
            height += 2.0 * half.y;
        }
    }
    world.build()
}

/// Two cards that meet above a point.
fn pair(house: &mut Object, name: &str, at: DVec3) {
    for (side, name) in [
        (-1.0, format!("left_{name}")),
        (1.0, format!("right_{name}")),
    ] {
        let centre = DVec3::new(side * reach().x, reach().y, 0.0);
        house
            .body(name)
            .at(Pose::new(at + centre, DQuat::from_rotation_z(side * LEAN)))
            .shape(CARD.shape(Geometry::Box { half: HALF }));
    }
}

/// How far a leaning card reaches from its centre along x and y [m].
///
/// Its half length a and half thickness d turned by α: a sin α + d cos α and a cos α + d sin α.
fn reach() -> DVec3 {
    let (sin, cos) = LEAN.sin_cos();
    DVec3::new(
        HALF.y * sin + HALF.x * cos,
        HALF.y * cos + HALF.x * sin,
        0.0,
    )
}

/// From one pair to the next [m].
fn spacing() -> f64 {
    4.0 * reach().x + GAP
}
