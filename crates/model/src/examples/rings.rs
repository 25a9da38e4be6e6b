//! Rings on a peg, and a chain.

use super::stuff::{PAINTED, STONE, WOOD};
use crate::model::Subject;
use crate::{Builder, Geometry, Model, ModelError, Pose, TriangleMesh};
use glam::{DQuat, DVec2, DVec3};
use std::f64::consts::TAU;

/// From the middle of a ring to that of its bar, and half the bar's thickness [m].
const RADIUS: f64 = 0.12;
const THICK: f64 = 0.03;
/// Links of the chain, and how far apart they hang [m].
const LINKS: usize = 4;
const APART: f64 = 2.0 * (RADIUS - THICK);

/// Rings of triangles that fall around a peg, and beside it a chain of them that hangs from a hook: nothing
/// holds its links together but their shape.
///
/// To see: the rings come to rest on each other, around the peg. The chain swings as a whole, and its
/// lowest link comes off only by being turned through.
///
/// # Errors
/// If there are no rings, or more than twelve.
pub fn rings(count: usize) -> Result<Model, ModelError> {
    let subject = Subject {
        kind: "rings",
        name: "",
    };
    subject.within("number of rings", count as f64, 1.0, 12.0)?;
    let mut world = Builder::new(format!("rings_{count}"));
    world.time_step(0.004);
    let half_height = 0.5 * (count as f64 * 2.0 * THICK + 0.15);
    let peg = WOOD.shape(Geometry::Capsule {
        radius: 0.05,
        half_height,
    });
    let ground = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let ring = Geometry::Mesh(ring()?);
    let hook = Pose::new(
        DVec3::new(0.6, 1.1, 0.0),
        DQuat::from_rotation_x(0.25 * TAU),
    );
    world
        .object("ground")
        .scenery(STONE.shape(ground))
        .scenery(peg.at(Pose::at(half_height * DVec3::Y)))
        .scenery(STONE.shape(ring.clone()).at(hook).named("hook"));
    let things = world.object("things");
    for i in 0..count {
        let turn = DQuat::from_rotation_y(2.4 * i as f64) * DQuat::from_rotation_x(0.2);
        let off = DQuat::from_rotation_y(1.7 * i as f64) * (0.02 * DVec3::X);
        let above = 2.0 * half_height + 0.1 + 0.15 * i as f64;
        things
            .body(format!("ring_{i}"))
            .at(Pose::new(off + above * DVec3::Y, turn))
            .shape(PAINTED.shape(ring.clone()));
    }
    // The chain begins a little off its plane, and so swings.
    let lean = DQuat::from_rotation_z(0.5);
    for i in 1..=LINKS {
        let down = lean * (-(i as f64) * (APART - 0.005) * DVec3::Y);
        let turn = DQuat::from_rotation_y(0.25 * TAU * i as f64);
        things
            .body(format!("link_{i}"))
            .at(Pose::new(
                hook.position + down,
                lean * turn * hook.orientation,
            ))
            .shape(STONE.shape(ring.clone()));
    }
    world.build()
}

/// About the y axis.
fn ring() -> Result<TriangleMesh, ModelError> {
    let point = |i: usize| {
        let (s, c) = (i as f64 / 8.0 * TAU).sin_cos();
        DVec2::new(RADIUS + THICK * c, THICK * s)
    };
    let profile: Vec<_> = (0..8).map(point).collect();
    Ok(TriangleMesh::revolution(&profile, 16)?)
}
