//! An eye that flies among shapes of every kind.

use glam::{DMat3, DQuat, DVec2, DVec3, EulerRot};
use model::{Builder, Geometry, Hull, Model, Pose, Shape, TriangleMesh};

/// Numbers that look random, from −1 to 1.
fn number(i: usize) -> f64 {
    2.0 * (0.618_033_988_75 * i as f64 * (i as f64 + 3.7)).fract() - 1.0
}

/// Within 3 m of the origin along each axis, and turned.
pub fn somewhere(i: usize) -> Pose {
    let [x, y, z, a, b, c] = [0, 1, 2, 3, 4, 5].map(|k| number(6 * i + k));
    let turn = DQuat::from_euler(EulerRot::XYZ, 3.0 * a, 3.0 * b, 3.0 * c);
    Pose::new(3.0 * DVec3::new(x, y, z), turn)
}

/// Unit vectors about evenly in all directions, along the golden angle's spiral; and one along each axis.
pub fn directions(count: usize) -> Vec<DVec3> {
    let spiral = |i: usize| {
        let y = 1.0 - 2.0 * (i as f64 + 0.5) / count as f64;
        let (sin, cos) = (2.399_963_23 * i as f64).sin_cos();
        let r = (1.0 - y * y).sqrt();
        DVec3::new(r * cos, y, r * sin)
    };
    let axes = [DVec3::X, -DVec3::Y, DVec3::Z];
    (0..count).map(spiral).chain(axes).collect()
}

fn hills() -> Geometry {
    let height = |r: i32, c: i32| 0.3 * (2.1 * f64::from(r)).sin() + 0.2 * f64::from(c).cos();
    let row = |r| (0..8).map(|c| height(r, c)).collect();
    let heights: Vec<Vec<_>> = (0..10).map(row).collect();
    Geometry::Mesh(TriangleMesh::height_field(&heights, DVec2::new(0.9, 0.7)).unwrap())
}

fn wedge() -> Geometry {
    let corners = [
        [1.2, 0.1, 0.2],
        [-0.7, 0.0, 0.3],
        [0.2, 1.5, -0.1],
        [0.1, -0.9, 0.2],
        [0.4, 0.2, 1.1],
        [0.3, 0.1, -0.8],
    ];
    Geometry::Hull(Hull::new(&corners.map(DVec3::from)).unwrap())
}

/// One of each kind, but for planes.
fn solids() -> [Geometry; 8] {
    let (radius, half_height, half) = (0.5, 1.0, DVec3::new(0.5, 1.0, 1.5));
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
        Geometry::Box { half },
        Geometry::Ellipsoid { half },
        wedge(),
        hills(),
    ]
}

/// The first body is the eye, with a shape of its own; the others and scenery are of every kind, above a floor. They touch
/// nothing. A sensor is about all.
pub fn surroundings() -> Model {
    let mut world = Builder::new("surroundings");
    let object = world.object("things");
    object
        .body("eye")
        .shape(Shape::new(Geometry::Sphere { radius: 0.2 }).without_contact());
    let mut all = Shape::new(Geometry::Sphere { radius: 20.0 }).without_contact();
    all.sensor = true;
    object.scenery(all);
    let floor = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let floor = Shape::new(floor).at(Pose::at(-3.0 * DVec3::Y));
    object.scenery(floor.without_contact());
    for (i, geometry) in solids().into_iter().enumerate() {
        let shape = Shape::new(geometry).without_contact();
        object.scenery(shape.clone().at(somewhere(2 * i)));
        let flying = object.body(format!("flying_{i}"));
        flying.inertia(1.0, DVec3::ZERO, DMat3::IDENTITY);
        flying.shape(shape.at(somewhere(2 * i + 1)));
    }
    world.build().unwrap()
}

/// Where the bodies of so many are in a world, as joint coordinates.
pub fn flights(world: usize, bodies: usize) -> Vec<f64> {
    let place = |body: usize| {
        let Pose {
            position,
            orientation,
        } = somewhere(100 + world * bodies + body);
        let turn = orientation.to_array();
        position.to_array().into_iter().chain(turn)
    };
    (0..bodies).flat_map(place).collect()
}
