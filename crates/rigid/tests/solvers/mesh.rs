//! Solids on triangle meshes, by both solvers of trees: what is flat is a plane, seams are not felt, and
//! each slope bears its share.

use crate::run::Run;
use glam::{DQuat, DVec2, DVec3};
use kinetarium_rigid::{Kernels, Settings, TouchingFeatherstone, Xpbd, body as of_body};
use model::{Builder, Geometry, Material, Model, Pose, Shape, TriangleMesh};

/// Gravity of the models [m/s²].
const G: f64 = 9.81;

/// The contact forces that are [N].
fn pushes<K: Kernels>(run: &Run<K>) -> Vec<DVec3> {
    run.forces().filter(|force| *force != DVec3::ZERO).collect()
}

const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};
const BALL: Geometry = Geometry::Sphere { radius: 0.1 };
const BOX: Geometry = Geometry::Box {
    half: DVec3::new(0.1, 0.05, 0.08),
};

/// A level floor of triangles of all shapes, 6 m wide, off the origin of its shape's frame, and the
/// shape that puts it back there.
fn floor() -> Shape {
    let away = Pose::new(
        DVec3::new(3.0, -2.0, 5.0),
        DQuat::from_scaled_axis(DVec3::new(0.4, 0.9, -0.3)),
    );
    let flat = TriangleMesh::height_field(&vec![vec![0.0; 31]; 31], DVec2::splat(0.2)).unwrap();
    let moved = |(i, v): (usize, &DVec3)| {
        let inside = v.x.abs() < 2.9 && v.z.abs() < 2.9;
        // By less than a quarter of the spacing, so that no triangle is turned over.
        let by = |k: f64| {
            if inside {
                0.045 * (k * i as f64).sin()
            } else {
                0.0
            }
        };
        away.point(*v + DVec3::new(by(1.3), 0.0, by(2.9)))
    };
    let vertices: Vec<_> = flat.vertices().iter().enumerate().map(moved).collect();
    let mesh = TriangleMesh::new(&vertices, flat.triangles()).unwrap();
    Shape::new(Geometry::Mesh(mesh)).at(away.inverse())
}

/// Something on some ground.
fn on(ground: Shape, geometry: Geometry, at: Pose, friction: f64) -> Model {
    let material = Material {
        friction,
        ..Material::default()
    };
    let mut world = Builder::new("mesh");
    let ground = ground.with_material(material);
    world.object("ground").scenery(ground);
    let shape = Shape::new(geometry).with_material(material);
    world.object("").body("body").at(at).shape(shape);
    world.build().unwrap()
}

fn featherstone(model: &Model) -> TouchingFeatherstone {
    TouchingFeatherstone::new(model, &Settings::new(0.002)).unwrap()
}

fn xpbd(model: &Model) -> Xpbd {
    Xpbd::touching(model, &Settings::new(0.001)).unwrap()
}

/// A box slides, and comes to rest, over a floor of triangles as it does on a plane: the points of
/// contact are the same but for their order.
fn boxes_feel_no_triangles<K: Kernels>(solver: impl Fn(&Model) -> K, near: f64) {
    let at = Pose::at(DVec3::new(0.03, 0.0499, -0.02));
    let run = |ground: Shape| {
        let model = on(ground, BOX, at, 0.4);
        let mut run = Run::of(solver(&model), &model, &[1.0, 0.0, 0.3, 0.0, 0.0, 0.0]);
        run.step(1000);
        (run, model.total_mass() * G)
    };
    let ((plane, weight), (mesh, _)) = (run(Shape::new(PLANE)), run(floor()));
    let off = plane.body(0, of_body::POSITION) - mesh.body(0, of_body::POSITION);
    assert!(off.length() < near, "{off}");
    for run in [plane, mesh] {
        let forces = pushes(&run);
        let sum: DVec3 = forces.iter().sum();
        assert_eq!(forces.len(), 4, "{forces:?}");
        assert!((sum - weight * DVec3::Y).length() < 1e-3 * weight, "{sum}");
    }
}

#[test]
fn a_box_on_triangles_is_a_box_on_a_plane() {
    boxes_feel_no_triangles(featherstone, 1e-6);
    boxes_feel_no_triangles(xpbd, 1e-4);
}

/// A ball that rolls, v = ω r, over some fifty seams: nothing bumps it.
fn balls_roll_on<K: Kernels>(solver: impl Fn(&Model) -> K, step: f64) {
    let model = on(floor(), BALL, Pose::at(DVec3::new(-2.0, 0.1, 0.1)), 0.5);
    let (speed, radius) = (2.0, 0.1);
    let start = [speed, 0.0, 0.1, 0.1 / radius, 0.0, -speed / radius];
    let mut run = Run::of(solver(&model), &model, &start);
    // The ball sinks in for some time constants of the contact, of 20 ms.
    run.step((0.4 / step) as usize);
    let [v, w] = [of_body::VELOCITY, of_body::ANGULAR_VELOCITY].map(|f| run.body(0, f));
    for _ in 0..(1.5 / step) as usize {
        run.step(1);
        let off = run.body(0, of_body::VELOCITY) - v;
        assert!(off.length() < 1e-5 * speed, "{off}");
        let off = run.body(0, of_body::ANGULAR_VELOCITY) - w;
        assert!(off.length() * radius < 1e-5 * speed, "{off}");
    }
    assert!(run.body(0, of_body::POSITION).x > 1.7);
}

#[test]
fn a_ball_rolls_over_seams() {
    balls_roll_on(featherstone, 0.002);
    balls_roll_on(xpbd, 0.001);
}

/// Two slopes of angle a on each side of z: each bears m g / (2 cos a), at right angles to itself.
fn valleys_share_the_weight<K: Kernels>(solver: impl Fn(&Model) -> K) {
    let (angle, radius) = (0.6_f64, 0.1);
    let row: Vec<_> = [-2, -1, 0, 1, 2]
        .map(|x| f64::from(x).abs() * angle.tan())
        .to_vec();
    let mesh = TriangleMesh::height_field(&vec![row; 5], DVec2::ONE).unwrap();
    let at = Pose::at(DVec3::new(0.0, radius / angle.cos(), 0.13));
    let model = on(Shape::new(Geometry::Mesh(mesh)), BALL, at, 0.0);
    let weight = model.total_mass() * G;
    let mut run = Run::of(solver(&model), &model, &[0.0; 6]);
    run.step(1500);
    let forces = pushes(&run);
    assert_eq!(forces.len(), 2, "{forces:?}");
    for side in [-1.0, 1.0] {
        let out = DVec3::new(-side * angle.sin(), angle.cos(), 0.0);
        let expected = out * weight / (2.0 * angle.cos());
        let off = |f: &DVec3| (*f - expected).length();
        let nearest = forces.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3 * weight, "{forces:?} for {expected}");
    }
}

#[test]
fn a_ball_in_a_valley_presses_on_both_slopes() {
    valleys_share_the_weight(featherstone);
    valleys_share_the_weight(xpbd);
}
