//! A robot in a room.

use super::room::furnish;
use super::stuff::{PLAIN, RUBBER};
use crate::{Axis, BodyHandle, Builder, Drive, Geometry, Model, ModelError, Pose, Shape};
use glam::DVec3;

/// Of the walls, so that the room can be seen from outside.
const GLASS: [f32; 4] = [0.72, 0.76, 0.80, 0.25];
/// Towards the table [rad].
const TURN: f64 = 2.2;

/// The [`room`](super::room) with a robot in it: a cart of 30 cm that drives and turns as its motors' speeds
/// say, with a head that looks along the body `head`'s −z.
///
/// To see: the robot drives about, pushes what is light, and stops at what is heavy.
///
/// # Errors
/// None.
pub fn rover() -> Result<Model, ModelError> {
    let mut world = Builder::new("rover");
    furnish(&mut world, Some(GLASS));
    let robot = world.object("robot");
    let cart = robot
        .body("cart")
        .shape(slippery(Geometry::Cylinder {
            radius: 0.18,
            half_height: 0.08,
        }))
        .mass(12.0)
        .handle();
    let head = head(robot);
    let place = Pose::at(DVec3::new(1.3, 0.1, -0.9));
    let wheels = robot.plane_xz("wheels", cart);
    wheels
        .frames(place, Pose::IDENTITY)
        .initial(&[0.0, 0.0, TURN]);
    for (dof, damping) in wheels.dofs_mut().iter_mut().zip([400.0, 400.0, 20.0]) {
        dof.drive = Drive {
            damping,
            effort_limit: 15.0 * damping.min(4.0),
            ..Drive::default()
        };
    }
    let axes = [Axis::angular(DVec3::Y), Axis::angular(DVec3::X)];
    let neck = robot.d6("neck", head, &axes);
    neck.parent(cart);
    neck.frames(Pose::at(DVec3::new(0.0, 0.3, 0.0)), Pose::IDENTITY);
    neck.drive(Drive {
        stiffness: 40.0,
        damping: 2.0,
        ..Drive::default()
    });
    world.build()
}

/// A mast with a head on it, its face at −z.
fn head(robot: &mut crate::Object) -> BodyHandle {
    let skull = Shape::new(Geometry::Box {
        half: DVec3::new(0.1, 0.07, 0.06),
    });
    let mast = PLAIN.shape(Geometry::Cylinder {
        radius: 0.025,
        half_height: 0.1,
    });
    let eye = RUBBER.shape(Geometry::Sphere { radius: 0.035 });
    robot
        .body("head")
        .shape(skull.without_contact())
        .shape(
            mast.at(Pose::at(DVec3::new(0.0, -0.15, 0.0)))
                .without_contact(),
        )
        .shape(
            eye.at(Pose::at(DVec3::new(0.0, 0.0, -0.05)))
                .without_contact(),
        )
        .mass(1.5)
        .handle()
}

/// What slides along what it meets.
fn slippery(geometry: Geometry) -> Shape {
    let mut shape = Shape::new(geometry);
    shape.material.friction = 0.2;
    shape
}
