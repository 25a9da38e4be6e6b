//! Balls that bounce.

use super::stuff::{RUBBER, STONE, Stuff, floor};
use crate::{Builder, Combine, Geometry, Model, ModelError, Pose};
use glam::DVec3;

/// Five balls of 20 cm, dropped by a metre.
///
/// To see: each bounces to e² of the height it fell from, again and again, where its restitution e
/// is 0, ¼, ½, ¾, 1. The first stays down, the last comes up again each time.
///
/// # Errors
/// None.
pub fn balls() -> Result<Model, ModelError> {
    const RADIUS: f64 = 0.1;
    let mut world = Builder::new("balls");
    world.time_step(0.001);
    let elastic = Stuff {
        restitution: 1.0,
        ..STONE
    };
    floor(world.object("ground"), elastic);
    let balls = world.object("balls");
    for i in 0..5 {
        let restitution = 0.25 * f64::from(i);
        let mut shape = RUBBER.shape(Geometry::Sphere { radius: RADIUS });
        shape.material.restitution = restitution;
        shape.material.combine = Combine::Multiply;
        balls
            .body(format!("e_{restitution}"))
            .at(Pose::at(DVec3::new(0.4 * f64::from(i), 1.0 + RADIUS, 0.0)))
            .shape(shape);
    }
    world.build()
}
