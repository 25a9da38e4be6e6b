//! A room with furniture.

use super::stuff::{RUBBER, STONE, Stuff, WOOD, floor};
use crate::{BodyDraft, Builder, Geometry, Limit, Model, ModelError, Object, Pose, Shape};
use glam::{DQuat, DVec3};
use std::f64::consts::FRAC_PI_2;

/// Half sizes of the room [m].
const ROOM: DVec3 = DVec3::new(2.0, 1.25, 1.5);
/// Half sizes of the door [m]: width, height, thickness.
const DOOR: DVec3 = DVec3::new(0.4, 1.0, 0.02);

/// A room of 4 m × 3 m with a table, a chair, a ball, and a door on a hinge that closes by itself.
///
/// To see: the ball falls on the edge of the table, and on, and rolls along the floor to the wall.
/// Table and chair, which are bodies of several boxes each, stand. The door swings shut in about 3 s.
///
/// # Errors
/// None.
pub fn room() -> Result<Model, ModelError> {
    let mut world = Builder::new("room");
    furnish(&mut world, None);
    world.build()
}

/// Puts the room, with walls of a colour, and what is in it into a world.
pub(super) fn furnish(world: &mut Builder, walls: Option<[f32; 4]>) {
    let building = world.object("building");
    floor(building, STONE);
    build_walls(building, walls);
    table(world.object("table"));
    chair(world.object("chair"));
    let ball = Stuff {
        density: 80.0,
        ..RUBBER
    };
    world
        .object("toys")
        .body("ball")
        .at(Pose::at(DVec3::new(0.7, 1.4, 0.1)))
        .shape(ball.shape(Geometry::Sphere { radius: 0.11 }));
    door(world.object("door"));
}

/// A box between two corners.
fn block(stuff: Stuff, from: DVec3, to: DVec3) -> Shape {
    let half = 0.5 * (to - from);
    let middle = Pose::at(0.5 * (from + to));
    stuff.shape(Geometry::Box { half }).at(middle)
}

/// Four walls of 10 cm, with a doorway in the one at −x.
fn build_walls(building: &mut Object, color: Option<[f32; 4]>) {
    let (thick, high) = (0.1, 2.0 * ROOM.y);
    let (x, z, gap) = (ROOM.x, ROOM.z, DOOR.x + 0.01);
    let walls = [
        ([x, -z - thick], [x + thick, z + thick]),
        ([-x, -z - thick], [x, -z]),
        ([-x, z], [x, z + thick]),
        ([-x - thick, -z - thick], [-x, -gap]),
        ([-x - thick, gap], [-x, z + thick]),
    ];
    for ([x0, z0], [x1, z1]) in walls {
        let (from, to) = (DVec3::new(x0, 0.0, z0), DVec3::new(x1, high, z1));
        let wall = block(STONE, from, to).named("wall");
        let color = color.or(wall.color);
        building.scenery(Shape { color, ..wall });
    }
}

/// Four legs of a width [m] under a board whose corners are given.
fn on_legs(body: &mut BodyDraft, corner: DVec3, leg: f64) {
    for (x, z) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
        let outer = DVec3::new(x * corner.x, 0.0, z * corner.z);
        let inner = DVec3::new(x * (corner.x - leg), corner.y, z * (corner.z - leg));
        body.shape(block(WOOD, outer.min(inner), outer.max(inner)));
    }
}

/// A table of 75 cm at the middle, its origin on the floor.
fn table(object: &mut Object) {
    let body = object.body("table");
    on_legs(body, DVec3::new(0.6, 0.72, 0.4), 0.05);
    let (from, to) = (DVec3::new(-0.65, 0.72, -0.45), DVec3::new(0.65, 0.75, 0.45));
    body.shape(block(WOOD, from, to));
}

/// A chair beside the table, its back to the wall at +z, its origin on the floor.
fn chair(object: &mut Object) {
    let body = object.body("chair").at(Pose::at(DVec3::new(0.0, 0.0, 0.8)));
    on_legs(body, DVec3::new(0.2, 0.43, 0.2), 0.04);
    let (from, to) = (DVec3::new(-0.22, 0.43, -0.22), DVec3::new(0.22, 0.46, 0.22));
    body.shape(block(WOOD, from, to));
    let (from, to) = (DVec3::new(-0.2, 0.46, 0.18), DVec3::new(0.2, 0.9, 0.21));
    body.shape(block(WOOD, from, to));
}

/// A door in the wall at −x, ajar by a radian, with a spring that closes it and keeps it shut.
fn door(object: &mut Object) {
    let panel = object
        .body("door")
        .shape(WOOD.shape(Geometry::Box { half: DOOR }))
        .handle();
    let doorway = DVec3::new(-ROOM.x, DOOR.y + 0.01, -DOOR.x);
    let turned = DQuat::from_rotation_y(-FRAC_PI_2);
    object
        .revolute("hinge", panel, DVec3::Y)
        .frames(Pose::new(doorway, turned), Pose::at(DVec3::X * -DOOR.x))
        .initial(&[1.0])
        .spring(5.0, -0.5)
        .damping(10.0)
        .limit(Limit {
            lower: 0.0,
            upper: 1.5,
            stiffness: 2000.0,
            damping: 100.0,
            inertia: 0.0,
        });
}
