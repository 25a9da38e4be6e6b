//! Solids of every kind, in a world of their own and in random places.

#![allow(dead_code, unused_imports)] // Each test uses its own part.

mod level;

use fastrand::Rng;
use glam::{DMat3, DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings};
pub use level::level;
use model::{Builder, Geometry, Model, Pose, Shape};
use std::f64::consts::TAU;

pub const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};
pub const CAPSULE: Geometry = Geometry::Capsule {
    radius: 0.5,
    half_height: 1.5,
};
pub const CYLINDER: Geometry = Geometry::Cylinder {
    radius: 0.5,
    half_height: 1.0,
};
pub const CONE: Geometry = Geometry::Cone {
    radius: 1.0,
    half_height: 1.0,
};
pub const HALF: DVec3 = DVec3::new(1.0, 2.0, 3.0);
pub const BOX: Geometry = Geometry::Box { half: HALF };
pub const ELLIPSOID: Geometry = Geometry::Ellipsoid { half: HALF };

/// Shapes fixed to the world, and a body without any.
pub fn scenery(shapes: impl IntoIterator<Item = Shape>) -> Model {
    let mut world = Builder::new("scenery");
    let object = world.object("things");
    for shape in shapes {
        object.scenery(shape);
    }
    object
        .body("bob")
        .inertia(1.0, DVec3::ZERO, DMat3::IDENTITY);
    world.build().unwrap()
}

pub fn simulate(model: Model) -> Simulation<f64> {
    let settings = SimulationSettings {
        threads: 2,
        ..SimulationSettings::new(1, 0.01)
    };
    Simulation::new(model, settings).unwrap()
}

/// In a cube about the origin of edges 2.
pub fn within(rng: &mut Rng) -> DVec3 {
    DVec3::from_array([(); 3].map(|()| 2.0 * rng.f64() - 1.0))
}

pub fn turn(rng: &mut Rng) -> DQuat {
    let [a, b, c] = [(); 3].map(|()| TAU * rng.f64());
    DQuat::from_euler(glam::EulerRot::XYZ, a, b, c)
}

pub fn somewhere(rng: &mut Rng) -> Pose {
    Pose::new(3.0 * within(rng), turn(rng))
}
