//! Two solids, and what pushes one against the other.

use super::stuff::{PLAIN, STONE, Stuff, floor};
use crate::{
    BodyHandle, Builder, Combine, Drive, Geometry, Material, Model, ModelError, Object, Pose, Shape,
};
use glam::DVec3;

/// Forms of [`Collide`]'s solids, each as high as wide.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A cube.
    Cube,
    /// A ball.
    Ball,
    /// A cylinder that stands.
    Cylinder,
    /// A cone that stands.
    Cone,
    /// A capsule that stands.
    Capsule,
}

impl Form {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::Cube,
        Self::Ball,
        Self::Cylinder,
        Self::Cone,
        Self::Capsule,
    ];

    /// The solid of a half height [m].
    fn geometry(self, half: f64) -> Geometry {
        let (radius, half_height) = (half, half);
        match self {
            Self::Cube => Geometry::Box {
                half: DVec3::splat(half),
            },
            Self::Ball => Geometry::Sphere { radius },
            Self::Cylinder => Geometry::Cylinder {
                radius,
                half_height,
            },
            Self::Cone => Geometry::Cone {
                radius,
                half_height,
            },
            Self::Capsule => Geometry::Capsule {
                radius: 0.5 * half,
                half_height,
            },
        }
    }
}

/// What collides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Collide {
    /// Forms of the solid that is pushed, and of the one that it meets.
    pub forms: [Form; 2],
    /// Their masses [kg].
    pub masses: [f64; 2],
    /// Coulomb friction of everything.
    pub friction: f64,
    /// Restitution of the two solids.
    pub restitution: f64,
    /// Speed of the pusher [m/s].
    pub speed: f64,
}

impl Default for Collide {
    /// A cube and a ball of 1 kg, friction 0.4, restitution 0.3, pushed at 1.5 m/s.
    fn default() -> Self {
        Self {
            forms: [Form::Cube, Form::Ball],
            masses: [1.0, 1.0],
            friction: 0.4,
            restitution: 0.3,
            speed: 1.5,
        }
    }
}

/// Half size of the solids [m].
const HALF: f64 = 0.1;
/// Where the solids stand along x [m].
const PLACES: [f64; 2] = [-0.45, 0.25];

/// A pusher drives one solid along the floor, which slides on and meets another.
///
/// To see: the pusher brings its solid up to speed, then stops at the end of its way; from there on
/// friction slows what slides by μ g, and momentum is shared where the two meet.
///
/// # Errors
/// Numbers out of range, as for any body and material.
pub fn collide(what: Collide) -> Result<Model, ModelError> {
    let mut world = Builder::new("collide");
    world.time_step(0.001);
    let material = Material {
        friction: what.friction,
        restitution: what.restitution,
        combine: Combine::Minimum,
        ..Material::default()
    };
    let ground = Stuff {
        friction: what.friction,
        restitution: 1.0,
        ..STONE
    };
    floor(world.object("ground"), ground);
    let solids = world.object("solids");
    for (i, name) in ["pushed", "met"].into_iter().enumerate() {
        let shape = Shape::new(what.forms[i].geometry(HALF)).with_material(material);
        solids
            .body(name)
            .at(Pose::at(DVec3::new(PLACES[i], HALF, 0.0)))
            .shape(shape)
            .mass(what.masses[i]);
    }
    let machine = world.object("machine");
    let plate = pusher(machine);
    let start = Pose::at(DVec3::new(-1.0, 0.12, 0.0));
    let slider = machine.prismatic("pusher", plate, DVec3::X);
    slider.frames(start, Pose::IDENTITY);
    slider.drive(Drive {
        damping: 2000.0,
        target_velocity: what.speed,
        ..Drive::default()
    });
    slider.limit(crate::Limit {
        lower: 0.0,
        upper: 0.7,
        stiffness: 1e6,
        damping: 1e4,
        inertia: 0.0,
    });
    world.build()
}

/// A plate that slides above the floor.
fn pusher(machine: &mut Object) -> BodyHandle {
    let half = DVec3::new(0.02, 0.1, 0.2);
    let plate = PLAIN.shape(Geometry::Box { half });
    machine.body("plate").shape(plate).mass(5.0).handle()
}
