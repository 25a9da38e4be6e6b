//! A ball joint.

use super::stuff::{PLAIN, WOOD, floor};
use crate::{Builder, Drive, Geometry, Model, ModelError, Pose};
use glam::DVec3;

/// An arm of 1 kg with a crossbar, on a ball joint 1 m above the ground, whose motors hold it against its
/// weight. The three targets are a rotation vector.
///
/// To see: the arm turns about each axis as its target says, and sags a little, as any spring
/// under load.
///
/// # Errors
/// None.
pub fn ball_joint() -> Result<Model, ModelError> {
    const LENGTH: f64 = 0.6;
    let mut world = Builder::new("ball_joint");
    floor(world.object("ground"), PLAIN);
    let machine = world.object("machine");
    let post = WOOD.shape(Geometry::Cylinder {
        radius: 0.04,
        half_height: 0.48,
    });
    let at = Pose::at(DVec3::new(0.0, 0.48, 0.0));
    machine.scenery(post.at(at).without_contact());
    let rod = Geometry::Capsule {
        radius: 0.03,
        half_height: 0.5 * LENGTH,
    };
    let bar = Geometry::Box {
        half: DVec3::new(0.2, 0.03, 0.03),
    };
    let tip = Pose::at(DVec3::new(0.0, 0.5 * LENGTH, 0.0));
    let arm = machine
        .body("arm")
        .shape(PLAIN.shape(rod).without_contact())
        .shape(WOOD.shape(bar).at(tip).without_contact())
        .mass(1.0)
        .handle();
    let top = Pose::at(DVec3::new(0.0, 1.0, 0.0));
    let shoulder = machine.ball("shoulder", arm);
    shoulder.frames(top, Pose::at(DVec3::new(0.0, -0.5 * LENGTH, 0.0)));
    shoulder.drive(Drive {
        stiffness: 60.0,
        damping: 4.0,
        ..Drive::default()
    });
    world.build()
}
