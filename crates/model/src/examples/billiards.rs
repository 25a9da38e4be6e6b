//! Balls that collide on a smooth table.

use super::stuff::{Stuff, floor};
use crate::{Builder, Geometry, Keyframe, Model, ModelError, Pose};
use glam::DVec3;

/// Phenolic resin, as of billiard balls, but without friction and loss.
const RESIN: Stuff = Stuff {
    density: 1700.0,
    friction: 0.0,
    restitution: 1.0,
    color: None,
};
/// Of a billiard ball [m].
const RADIUS: f64 = 0.0286;
/// Of the balls that start [m/s].
const SPEED: f64 = 1.0;

/// Between the games [m], so that none disturbs another.
const LANE: f64 = 2.0;

/// Billiard balls on a table, without friction, without loss. The keyframe `start` holds how they
/// move at first: three of them at 1 m/s along x.
///
/// To see: the first pair meets head-on, and the balls change places: what came stops, what stood
/// goes on at the same speed. The second pair meets half a ball off centre and parts at a right
/// angle. In the row of five with gaps between them the impact runs through, and the last one leaves.
/// Kinetic energy stays.
///
/// # Errors
/// None.
pub fn billiards() -> Result<Model, ModelError> {
    let mut world = Builder::new("billiards");
    world.time_step(0.001);
    floor(world.object("table"), RESIN);
    let balls = world.object("balls");
    let mut velocity = Vec::new();
    let mut ball = |name: &str, x: f64, z: f64, speed: f64| {
        balls
            .body(name)
            .at(Pose::at(DVec3::new(x, RADIUS, z)))
            .shape(RESIN.shape(Geometry::Sphere { radius: RADIUS }));
        velocity.extend([speed, 0.0, 0.0, 0.0, 0.0, 0.0]);
    };
    ball("straight", -0.3, -LANE, SPEED);
    ball("straight_hit", 0.0, -LANE, 0.0);
    ball("oblique", -0.3, RADIUS, SPEED);
    ball("oblique_hit", 0.0, 0.0, 0.0);
    for i in 0..5 {
        let speed = if i == 0 { SPEED } else { 0.0 };
        let x = if i == 0 {
            -0.3
        } else {
            0.08 * f64::from(i - 1)
        };
        ball(&format!("row_{i}"), x, LANE, speed);
    }
    let joint_position = world.build()?.initial_position();
    world.keyframe(Keyframe {
        name: "start".into(),
        joint_position,
        joint_velocity: velocity,
        control: Vec::new(),
    });
    world.build()
}
