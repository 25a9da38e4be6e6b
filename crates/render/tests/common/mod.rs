//! Scenes to look at.
#![allow(dead_code)]

use fastrand::Rng;
use glam::{DQuat, DVec2, DVec3, EulerRot};
use kinetarium_render::{Camera, Channels, Images, Scene, View, ray_caster};
use model::{Builder, Geometry, Hull, Model, Pose, Shape, TriangleMesh};

/// Half sizes of the box and the ellipsoid.
pub const HALF: DVec3 = DVec3::new(0.5, 0.3, 0.4);

pub fn hull() -> Hull {
    let corners = [
        [0.6, 0.0, 0.1],
        [-0.4, 0.0, 0.2],
        [0.1, 0.7, 0.0],
        [0.0, -0.5, 0.1],
        [0.2, 0.1, 0.6],
        [0.2, 0.1, -0.5],
        [0.4, 0.4, 0.3],
    ];
    Hull::new(&corners.map(DVec3::from)).unwrap()
}

/// A hill of 20 × 20 cells of 10 cm.
pub fn hill() -> TriangleMesh {
    let height = |row: usize, column: usize| {
        let (x, z) = (column as f64 / 20.0 - 0.5, row as f64 / 20.0 - 0.5);
        0.6 * (-6.0 * (x * x + z * z)).exp() + 0.03 * (9.0 * x).sin() * (7.0 * z).cos()
    };
    let heights: Vec<Vec<f64>> = (0..=20)
        .map(|row| (0..=20).map(|column| height(row, column)).collect())
        .collect();
    TriangleMesh::height_field(&heights, DVec2::splat(0.1)).unwrap()
}

/// One of each kind that moves.
pub fn solids() -> [Geometry; 7] {
    let (radius, half_height) = (0.3, 0.5);
    [
        Geometry::Sphere { radius },
        Geometry::Capsule {
            radius,
            half_height,
        },
        Geometry::Cylinder {
            radius,
            half_height,
        },
        Geometry::Cone {
            radius,
            half_height,
        },
        Geometry::Box { half: HALF },
        Geometry::Ellipsoid { half: HALF },
        Geometry::Hull(hull()),
    ]
}

/// Shapes fixed to the world.
pub fn scenery(shapes: impl IntoIterator<Item = Shape>) -> Model {
    let mut world = Builder::new("scenery");
    let object = world.object("things");
    for shape in shapes {
        object.scenery(shape);
    }
    world.build().unwrap()
}

/// One of each solid, twice, scattered over a floor with a hill and a rectangle, and a pose for each.
pub fn medley(seed: u64) -> (Model, Vec<Pose>) {
    let mut rng = Rng::with_seed(seed);
    let mut world = Builder::new("medley");
    let ground = world.object("ground");
    let plane = |half_x, half_z| Geometry::Plane { half_x, half_z };
    ground.scenery(plane(0.0, 0.0));
    ground.scenery(Shape::new(Geometry::Mesh(hill())).at(Pose::at(DVec3::new(1.5, 0.02, -1.0))));
    let tilted = Pose::new(DVec3::new(-1.5, 0.6, -1.0), DQuat::from_rotation_x(0.9));
    ground.scenery(Shape::new(plane(0.5, 0.8)).at(tilted));
    let things = world.object("things");
    for (i, geometry) in solids().into_iter().chain(solids()).enumerate() {
        let mut shape = Shape::new(geometry).at(anywhere(&mut rng, DVec3::splat(0.05)));
        if i % 5 == 2 {
            shape = shape.with_color([0.9, 0.4, 0.1, 0.6]);
        }
        things.body(format!("thing_{i}")).shape(shape);
    }
    let model = world.build().unwrap();
    let up = Pose::at(DVec3::new(0.0, 1.2, 0.0));
    let place = |_| up * anywhere(&mut rng, DVec3::new(2.0, 1.0, 2.0));
    let poses = (0..model.bodies.len()).map(place).collect();
    (model, poses)
}

/// Within a box about the origin, turned at random.
pub fn anywhere(rng: &mut Rng, half: DVec3) -> Pose {
    let mut number = || 2.0 * rng.f64() - 1.0;
    let position = half * DVec3::new(number(), number(), number());
    let [a, b, c] = [(); 3].map(|()| 3.2 * number());
    Pose::new(position, DQuat::from_euler(EulerRot::XYZ, a, b, c))
}

/// Sees the medley.
pub fn camera(width: usize, height: usize) -> Camera {
    let (eye, target) = (DVec3::new(2.0, 3.0, 6.0), DVec3::new(0.0, 0.8, 0.0));
    Camera::new(width, height, 0.8).looking(eye, target, DVec3::Y)
}

pub fn all(model: &Model, camera: Camera, poses: &[Pose]) -> Images {
    let view = View::new(camera).with_channels(Channels::ALL);
    ray_caster::render(&Scene::new(model).unwrap(), &view, &[poses]).unwrap()
}
