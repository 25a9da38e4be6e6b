//! Bodies on the ground.

use glam::{DQuat, DVec3};
use model::{Builder, Geometry, Material, Model, Pose, Shape};

/// A surface with this friction and restitution; both of a pair are alike.
pub fn surface(friction: f64, restitution: f64) -> Material {
    Material {
        friction,
        restitution,
        ..Material::default()
    }
}

pub fn plane() -> Geometry {
    Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    }
}

/// One free body with its centre at `at`, on a plane whose normal is y turned by `slope` [rad] about z.
pub fn on_plane(geometry: Geometry, material: Material, at: DVec3, slope: f64) -> Model {
    let mut world = Builder::new("contact");
    let tilt = DQuat::from_rotation_z(slope);
    let ground = Shape::new(plane())
        .at(Pose::new(DVec3::ZERO, tilt))
        .with_material(material);
    world.object("ground").scenery(ground);
    let shape = Shape::new(geometry).with_material(material);
    let object = world.object("");
    object
        .body("body")
        .at(Pose::new(tilt * at, tilt))
        .shape(shape);
    world.build().unwrap()
}

pub fn cube() -> Geometry {
    Geometry::Box {
        half: DVec3::new(0.1, 0.05, 0.08),
    }
}
