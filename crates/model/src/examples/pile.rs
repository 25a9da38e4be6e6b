//! Solids of all kinds in a heap.

use super::bowl::{Slopes, slopes};
use super::countable;
use super::stuff::{PAINTED, RUBBER, STONE, Stuff, floor};
use crate::{Builder, Geometry, Model, ModelError, Pose};
use glam::{DQuat, DVec3};

/// Four slopes that begin 25 cm from the middle.
const SLOPES: Slopes = Slopes {
    sides: 4,
    inner: 0.25,
    tilt: 0.7,
    half: DVec3::new(0.5, 0.1, 1.0),
};

/// Spheres, capsules, cylinders, cones, boxes and ellipsoids of about 15 cm, of wood, stone and
/// rubber in turn, fall into a bowl of a metre and a half.
///
/// To see: they bounce, roll down the slopes, and come to rest in a heap at the bottom.
///
/// # Errors
/// If there are none, or more than a million.
pub fn pile(count: usize) -> Result<Model, ModelError> {
    countable("pile", "number of solids", count)?;
    let mut world = Builder::new(format!("pile_{count}"));
    let ground = world.object("ground");
    floor(ground, STONE);
    slopes(ground, &SLOPES, STONE);
    let solids = world.object("solids");
    let stuffs = [
        PAINTED,
        STONE,
        Stuff {
            restitution: 0.5,
            ..RUBBER
        },
    ];
    for i in 0..count {
        let (name, geometry) = solid(i);
        // A spiral of golden angles, so that no two fall exactly onto each other.
        let angle = 2.399_963 * i as f64;
        let around = DVec3::new(angle.cos(), 0.0, angle.sin());
        let place = 0.2 * around + DVec3::Y * (0.3 + 0.12 * i as f64);
        let turn = DQuat::from_axis_angle(around, 0.7 * i as f64);
        solids
            .body(format!("{name}_{i}"))
            .at(Pose::new(place, turn))
            .shape(stuffs[i % stuffs.len()].shape(geometry));
    }
    world.build()
}

/// The i-th solid's name and form.
pub(super) fn solid(i: usize) -> (&'static str, Geometry) {
    let (radius, half_height) = (0.07, 0.08);
    match i % 6 {
        0 => ("sphere", Geometry::Sphere { radius }),
        1 => (
            "capsule",
            Geometry::Capsule {
                radius: 0.05,
                half_height: 0.11,
            },
        ),
        2 => (
            "cylinder",
            Geometry::Cylinder {
                radius,
                half_height,
            },
        ),
        3 => (
            "box",
            Geometry::Box {
                half: DVec3::new(0.08, 0.06, 0.07),
            },
        ),
        4 => (
            "ellipsoid",
            Geometry::Ellipsoid {
                half: DVec3::new(0.1, 0.06, 0.07),
            },
        ),
        _ => (
            "cone",
            Geometry::Cone {
                radius: 0.08,
                half_height,
            },
        ),
    }
}
