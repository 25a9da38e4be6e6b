//! Hulls that touch, by both solvers of trees: a hull in the form of a box is the box, wherever its
//! corners lie in the shape's frame, and a tetrahedron stands on its face.

use crate::run::Run;
use glam::{DQuat, DVec3};
use kinetarium_rigid::{Kernels, Settings, TouchingFeatherstone, Xpbd, body as of_body};
use model::{Builder, Geometry, Hull, Material, Model, Pose, Shape};

/// Gravity of the models [m/s²].
const G: f64 = 9.81;
const HALF: DVec3 = DVec3::new(0.1, 0.05, 0.08);

/// A body above a plane that is turned by `slope` [rad] about z, with its centre at `at`, turned by
/// `turn`, in the plane's frame.
fn above_plane(shape: Shape, friction: f64, slope: f64, at: Pose) -> Model {
    let material = Material {
        friction,
        ..Material::default()
    };
    let mut world = Builder::new("hull");
    let tilt = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(slope));
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let ground = Shape::new(plane).at(tilt).with_material(material);
    world.object("ground").scenery(ground);
    let object = world.object("");
    object
        .body("body")
        .at(tilt * at)
        .shape(shape.with_material(material));
    world.build().unwrap()
}

/// A box as the hull of its corners, which lie anywhere in the shape's frame.
fn hull_of_box() -> Shape {
    let away = Pose::new(
        DVec3::new(0.3, -0.2, 0.5),
        DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, -0.3)),
    );
    let side = |i: usize, bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
    let corner = |i| away.point(HALF * DVec3::new(side(i, 0), side(i, 1), side(i, 2)));
    let corners: Vec<_> = (0..8).map(corner).collect();
    Shape::new(Geometry::Hull(Hull::new(&corners).unwrap())).at(away.inverse())
}

/// How far box and hull, started alike, come apart within 300 steps [m].
fn come_apart<K: Kernels>(
    solver: impl Fn(&Model) -> K,
    (friction, slope): (f64, f64),
    at: Pose,
    velocity: [f64; 6],
) -> f64 {
    let solids = [Shape::new(Geometry::Box { half: HALF }), hull_of_box()];
    let [mut cuboid, mut hull] = solids.map(|shape| {
        let model = above_plane(shape, friction, slope, at);
        Run::of(solver(&model), &model, &velocity)
    });
    let mut most: f64 = 0.0;
    for _ in 0..300 {
        cuboid.step(1);
        hull.step(1);
        let [a, b] = [&cuboid, &hull].map(|run| run.body(0, of_body::POSITION));
        most = most.max((a - b).length());
    }
    most
}

/// `near`: what it makes that the four points come in another order [m].
fn hulls_are_boxes<K: Kernels>(solver: impl Fn(&Model) -> K + Copy, near: f64) {
    let flat = Pose::at(DVec3::Y * (HALF.y - 1e-4));
    // At rest; stuck and sliding on inclines; thrown flat.
    let slope = 0.4_f64;
    let thrown = [1.0, 0.0, 0.3, 0.0, 2.0, 0.0];
    let cases = [
        (0.6, 0.0, flat, [0.0; 6]),
        (slope.tan() / 0.7, slope, flat, [0.0; 6]),
        (slope.tan() / 1.4, slope, flat, [0.0; 6]),
        (0.3, 0.0, Pose::at(DVec3::Y * 0.15), thrown),
    ];
    for (friction, slope, at, velocity) in cases {
        let apart = come_apart(solver, (friction, slope), at, velocity);
        assert!(apart < near, "{friction}, {slope}: {apart}");
    }
    // Dropped on a corner, it tumbles: of the corners that do not touch yet, others are looked at.
    let turn = DQuat::from_scaled_axis(DVec3::new(0.5, 0.2, -0.7));
    let high = Pose::new(DVec3::Y * 0.2, turn);
    let apart = come_apart(solver, (0.5, 0.0), high, [0.0; 6]);
    assert!(apart < 1e-2, "{apart}");
}

/// A tetrahedron of unequal edges, whose centre is a quarter of its height above each face.
fn tetrahedra_stand<K: Kernels>(solver: impl Fn(&Model) -> K) {
    let (height, sink) = (0.12, 2e-4);
    let corners = [
        DVec3::new(0.1, 0.0, 0.05),
        DVec3::new(-0.1, 0.0, 0.07),
        DVec3::new(0.01, 0.0, -0.1),
        DVec3::new(0.0, height, 0.01),
    ];
    let hull = Hull::new(&corners).unwrap();
    let middle = hull.center();
    assert!((middle.y - height / 4.0).abs() < 1e-15);
    let shape = Shape::new(Geometry::Hull(hull)).at(Pose::at(-middle));
    let model = above_plane(shape, 0.6, 0.0, Pose::at(DVec3::Y * middle.y));
    let mut run = Run::of(solver(&model), &model, &[0.0; 6]);
    run.step(1500);
    let weight = model.bodies[0].mass * G * DVec3::Y;
    assert!((run.forces().sum::<DVec3>() - weight).length() < 1e-3 * weight.y);
    let [position, velocity, spin] = [
        of_body::POSITION,
        of_body::VELOCITY,
        of_body::ANGULAR_VELOCITY,
    ]
    .map(|field| run.body(0, field));
    assert!(
        velocity.length() < 1e-6 && spin.length() < 1e-5,
        "{velocity} {spin}"
    );
    assert!(
        (position - DVec3::Y * middle.y).length() < sink,
        "{position}"
    );
}

fn featherstone(model: &Model) -> TouchingFeatherstone {
    TouchingFeatherstone::new(model, &Settings::new(0.002)).unwrap()
}

fn xpbd(model: &Model) -> Xpbd {
    Xpbd::touching(model, &Settings::new(0.001)).unwrap()
}

#[test]
fn a_hull_in_the_form_of_a_box_is_the_box_in_reduced_coordinates() {
    hulls_are_boxes(featherstone, 1e-9);
}

#[test]
fn a_hull_in_the_form_of_a_box_is_the_box_in_maximal_coordinates() {
    hulls_are_boxes(xpbd, 5e-4);
}

#[test]
fn a_tetrahedron_stands_on_its_face() {
    tetrahedra_stand(featherstone);
    tetrahedra_stand(xpbd);
}

/// A hull on a hull, and on each solid that is fixed to the world: borne by its weight.
#[test]
fn a_hull_stands_on_any_flat_top() {
    let tops = [
        Shape::new(Geometry::Box { half: HALF }),
        Shape::new(Geometry::Cylinder {
            radius: 0.2,
            half_height: HALF.y,
        }),
        hull_of_box(),
    ];
    for top in tops {
        let mut world = Builder::new("on top");
        world.object("ground").scenery(top);
        let object = world.object("");
        let place = Pose::at(DVec3::Y * (2.0 * HALF.y - 1e-4));
        object.body("body").at(place).shape(hull_of_box());
        let model = world.build().unwrap();
        let mut run = Run::of(featherstone(&model), &model, &[0.0; 6]);
        run.step(1000);
        let weight = model.bodies[0].mass * G * DVec3::Y;
        assert!((run.forces().sum::<DVec3>() - weight).length() < 1e-3 * weight.y);
        assert!(run.body(0, of_body::VELOCITY).length() < 1e-4);
    }
}
