//! Triangle meshes as ground: no seams, no holes, and the loads of closed forms.

mod distance_field;
mod moving;
mod rectangle;

use glam::{DQuat, DVec2, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::examples::terrain;
use model::{BodyId, Builder, Geometry, Hull, Material, Model, Pose, Shape, TriangleMesh};
use numbers::Float;

const G: f64 = 9.81;
/// Length of a step [s].
const STEP: f64 = 0.002;
const BALL: Geometry = Geometry::Sphere { radius: 0.1 };

fn settings() -> SimulationSettings {
    let mut settings = SimulationSettings::new(1, STEP);
    settings.solver = SolverKind::Impulse;
    settings.threads = 1;
    settings.step.sleep_speed = 0.0;
    settings
}

/// Heights over a square of so many cells of a width [m].
fn field(cells: usize, width: f64, height: impl Fn(f64, f64) -> f64) -> Shape {
    let at = |i: usize| width * (i as f64 - cells as f64 / 2.0);
    let row = |z: usize| (0..=cells).map(|x| height(at(x), at(z))).collect();
    let heights: Vec<Vec<f64>> = (0..=cells).map(row).collect();
    let mesh = TriangleMesh::height_field(&heights, DVec2::splat(width)).unwrap();
    Shape::new(Geometry::Mesh(mesh))
}

fn smooth() -> Material {
    Material {
        friction: 0.0,
        ..Material::default()
    }
}

/// One body on some ground.
fn on<T: Float>(ground: Shape, shape: Shape, at: Pose) -> Simulation<T> {
    let mut world = Builder::new("mesh");
    world.object("ground").scenery(ground);
    world.object("things").body("thing").at(at).shape(shape);
    Simulation::new(world.build().unwrap(), settings()).unwrap()
}

fn body() -> BodyId {
    BodyId(0)
}

/// The contact forces that are [N].
fn forces<T: Float>(sim: &mut Simulation<T>) -> Vec<DVec3> {
    let outputs = sim.outputs();
    let all = outputs.contacts(0).map(|c| c.force);
    all.filter(|force| *force != DVec3::ZERO).collect()
}

/// A box over one triangle, over some, and over thousands, presses with its weight, at four points.
#[test]
fn what_rests_presses_with_its_weight() {
    for width in [10.0, 0.13, 0.03] {
        let cells = (2.0 / width) as usize + 2;
        let half = DVec3::new(0.3, 0.1, 0.4);
        let at = Pose::new(DVec3::new(0.02, 0.1, 0.03), DQuat::from_rotation_y(0.3));
        let mut sim = on::<f32>(
            field(cells, width, |_, _| 0.0),
            Shape::new(Geometry::Box { half }),
            at,
        );
        let weight = sim.model().total_mass() * G;
        sim.step(500);
        let forces = forces(&mut sim);
        let sum: DVec3 = forces.iter().sum();
        assert!((sum - weight * DVec3::Y).length() < 1e-3 * weight, "{sum}");
        assert_eq!(forces.len(), 4, "{width}: {forces:?}");
        let place = sim.outputs().body_position(0, body());
        assert!((place - at.position).length() < 2e-4, "{width}: {place}");
    }
}

/// A ball that rolls, v = ω r, over some fifty seams, and over a corner (0, 0.4) of six of them: nothing
/// bumps it. Beside a corner by less than w = 2e-4 r it touches the corner, for a step, and with an arm
/// that is off by w the point of contact moves at ω w = 2e-4 v.
#[test]
fn a_ball_rolls_over_seams() {
    let at = Pose::at(DVec3::new(-2.0, 0.1, 0.1));
    let mut sim = on::<f64>(field(30, 0.2, |_, _| 0.0), Shape::new(BALL), at);
    let (speed, radius) = (2.0, 0.1);
    let velocity = [speed, 0.0, 0.3, 0.3 / radius, 0.0, -speed / radius];
    let start = [-2.0, 0.1, 0.1, 0.0, 0.0, 0.0, 1.0];
    sim.set_joint_state(0, &start, &velocity).unwrap();
    // Until the contact has settled.
    sim.step(200);
    let first = sim.outputs().body_velocity(0, body());
    for step in 200..1000 {
        sim.step(1);
        let off = sim.outputs().body_velocity(0, body()) - first;
        assert!(off.length() < 2e-4 * speed, "step {step}: {off}");
    }
    let end = sim.outputs().body_velocity(0, body());
    assert!((end - first).length() < 1e-6 * speed, "{end}");
    assert!(sim.outputs().body_position(0, body()).x > 1.9);
}

/// Two slopes of angle a: each bears m g / (2 cos a), at right angles to itself.
#[test]
fn a_ball_in_a_valley_presses_on_both_slopes() {
    let angle = 0.6_f64;
    let valley = field(4, 1.0, |x, _| x.abs() * angle.tan()).with_material(smooth());
    let at = Pose::at(DVec3::new(0.0, 0.1 / angle.cos(), 0.13));
    let mut sim = on::<f64>(valley, Shape::new(BALL).with_material(smooth()), at);
    let weight = sim.model().total_mass() * G;
    sim.step(1500);
    let forces = forces(&mut sim);
    assert_eq!(forces.len(), 2, "{forces:?}");
    for side in [-1.0, 1.0] {
        let out = DVec3::new(-side * angle.sin(), angle.cos(), 0.0);
        let expected = out * weight / (2.0 * angle.cos());
        let off = |f: &DVec3| (*f - expected).length();
        let nearest = forces.iter().map(off).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1e-3 * weight, "{forces:?} for {expected}");
    }
}

/// A bowl of facets: whatever rolls or slides in it never has more energy than it began with.
#[test]
fn nothing_gains_energy_in_a_bowl() {
    let bowl = || field(40, 0.1, |x, z| 0.4 * (x * x + z * z));
    let half = DVec3::new(0.12, 0.05, 0.08);
    for shape in [BALL, Geometry::Box { half }] {
        for material in [smooth(), Material::default()] {
            let at = Pose::at(DVec3::new(1.0, 0.6, 0.2));
            let shape = Shape::new(shape.clone()).with_material(material);
            let mut sim = on::<f64>(bowl().with_material(material), shape, at);
            // Against the bottom of the bowl.
            let start = sim.outputs().energy(0);
            for step in 0..2500 {
                sim.step(1);
                let energy = sim.outputs().energy(0);
                assert!(
                    energy < start + 1e-3 * start.abs(),
                    "step {step}: {energy} J of {start} J"
                );
            }
            let place = sim.outputs().body_position(0, body());
            assert!(place.x.hypot(place.z) < 1.3 && place.y > 0.0, "{place}");
        }
    }
}

/// A wall of triangles in the plane x = 0 that is touched from −x.
fn wall() -> Shape {
    let turn = DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2);
    field(10, 0.2, |_, _| 0.0).at(Pose::new(DVec3::ZERO, turn))
}

/// A ball of 1 cm, at up to 200 of its diameters a step, does not pass what it meets head-on: contacts
/// are looked for as far as a body gets within the step. From behind there is no wall.
#[test]
fn a_bullet_meets_the_front_of_a_wall_only() {
    for (speed, from_front) in [(10.0, true), (100.0, true), (1000.0, true), (100.0, false)] {
        let mut world = Builder::new("range");
        world.gravity(DVec3::ZERO);
        world.object("wall").scenery(wall());
        let side = if from_front { -1.0 } else { 1.0 };
        let place = DVec3::new(side * 1.03, 0.05, 0.03);
        let bullet = Shape::new(Geometry::Sphere { radius: 0.005 }).with_density(10.0);
        world
            .object("bullet")
            .body("bullet")
            .at(Pose::at(place))
            .shape(bullet);
        let mut sim = Simulation::<f32>::new(world.build().unwrap(), settings()).unwrap();
        let start = [place.x, place.y, place.z, 0.0, 0.0, 0.0, 1.0];
        let velocity = [-side * speed, 0.0, 0.0, 0.0, 0.0, 0.0];
        sim.set_joint_state(0, &start, &velocity).unwrap();
        sim.step((2.0 / (speed * STEP)) as usize + 20);
        let x = sim.outputs().body_position(0, body()).x;
        assert!(x < 0.0, "{speed}: {x}");
    }
}

/// Hills, 4 m wide.
fn hills() -> Shape {
    field(40, 0.1, |x, z| {
        0.1 * (3.0 * x).sin() * (2.0 * z).cos() + 0.2 * (x * x + z * z)
    })
    .named("hills")
}

fn wedge() -> Hull {
    let end = |z| [(-0.1, 0.0), (0.1, 0.0), (0.05, 0.12)].map(|(x, y)| DVec3::new(x, y, z));
    Hull::new(&[end(-0.06), end(0.07)].concat()).unwrap()
}

/// Solids of all kinds, one above the other.
fn solids() -> [Geometry; 7] {
    let (radius, half_height) = (0.07, 0.12);
    [
        BALL,
        Geometry::Capsule {
            radius,
            half_height,
        },
        Geometry::Box {
            half: DVec3::new(0.1, 0.05, 0.08),
        },
        Geometry::Cylinder {
            radius,
            half_height,
        },
        Geometry::Cone {
            radius,
            half_height,
        },
        Geometry::Ellipsoid {
            half: DVec3::new(0.08, 0.1, 0.12),
        },
        Geometry::Hull(wedge()),
    ]
}

fn pile(ground: Shape) -> Model {
    let mut world = Builder::new("pile");
    world.object("ground").scenery(ground);
    let object = world.object("pile");
    for (i, solid) in (0..4).flat_map(|_| solids()).enumerate() {
        let turn = DQuat::from_rotation_z(0.3 * i as f64);
        let place = DVec3::new(
            0.5 * (i % 3) as f64 - 0.5,
            0.6 + 0.12 * i as f64,
            0.3 * (i % 2) as f64,
        );
        object
            .body(format!("solid_{i}"))
            .at(Pose::new(place, turn))
            .shape(solid);
    }
    world.build().unwrap()
}

fn places<T: Float>(sim: &mut Simulation<T>) -> Vec<DVec3> {
    let bodies = 0..sim.model().bodies.len();
    let outputs = sim.outputs();
    bodies
        .map(|i| outputs.body_position(0, BodyId(i)))
        .collect()
}

/// Solids of all kinds fall on hills: in lanes, one by one, with threads, and from a snapshot on the
/// same bits, and at rest on the hills in the end, which bear their weight.
#[test]
fn a_pile_on_hills_is_the_same_however_it_is_computed() {
    let model = pile(hills());
    let weight = model.total_mass() * G;
    let run = |settings: SimulationSettings| {
        let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
        sim.step(1500);
        let snapshot = sim.snapshot();
        sim.step(1000);
        let places = places(&mut sim);
        sim.restore(&snapshot).unwrap();
        sim.step(1000);
        let again: Vec<_> = (0..places.len())
            .map(|i| sim.outputs().body_position(0, BodyId(i)))
            .collect();
        assert_eq!(again, places);
        let outputs = sim.outputs();
        let borne = outputs.contacts(0).filter(|c| c.shapes[0].0 == 0);
        (places, borne.map(|c| c.force.y).sum::<f64>())
    };
    let (places, force) = run(settings());
    assert!((force / weight - 1.0).abs() < 0.05, "{force} for {weight}");
    let lies = |p: &DVec3| p.x.hypot(p.z) < 1.5 && p.y > -0.1 && p.y < 1.0;
    assert!(places.iter().all(lies), "{places:?}");
    let (mut scalar, mut threads) = (settings(), settings());
    scalar.scalar = true;
    threads.threads = 2;
    assert_eq!([run(scalar).0, run(threads).0], [places.clone(), places]);
}

/// The triangles that a world has kept as those that are near are all that a world finds that has kept none.
#[test]
fn triangles_that_are_kept_are_all_that_are_near() {
    let model = pile(hills());
    let mut kept = Simulation::<f32>::new(model.clone(), settings()).unwrap();
    for step in 0..500 {
        let mut fresh = Simulation::<f32>::new(model.clone(), settings()).unwrap();
        fresh.restore(&kept.snapshot()).unwrap();
        fresh.step(1);
        kept.step(1);
        assert_eq!(places(&mut fresh), places(&mut kept), "step {step}");
    }
    assert!(kept.outputs().contacts(0).count() > 20);
}

/// A jointed pair and a loose box on hills, by the solvers of trees: all worlds differ, and each is the
/// same in lanes, alone and with threads.
#[test]
fn robots_walk_over_hills_in_many_worlds() {
    let mut world = Builder::new("robots");
    world.object("ground").scenery(hills());
    let robot = world.object("robot");
    let rod = Geometry::Capsule {
        radius: 0.04,
        half_height: 0.2,
    };
    let upper = robot.body("upper").shape(rod.clone()).handle();
    robot
        .free("float", upper)
        .initial(&[0.1, 0.7, 0.0, 0.6, 0.0, 0.0, 0.8]);
    let lower = robot.body("lower").shape(rod).handle();
    let (top, bottom) = (Pose::at(DVec3::Y * 0.2), Pose::at(DVec3::Y * -0.2));
    robot
        .revolute("knee", lower, DVec3::Z)
        .parent(upper)
        .frames(bottom, top);
    let half = DVec3::new(0.1, 0.05, 0.08);
    robot
        .body("box")
        .at(Pose::at(DVec3::new(-0.6, 0.4, 0.1)))
        .shape(Geometry::Box { half });
    let model = world.build().unwrap();
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        let run = |worlds: usize, threads: usize, scalar: bool, first: usize| {
            let mut settings = SimulationSettings {
                solver,
                threads,
                scalar,
                worlds,
                ..settings()
            };
            settings.step.substeps = 2;
            let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
            for w in 0..worlds {
                let mut position = model.initial_position();
                position[0] += 0.02 * (first + w) as f64;
                let velocity = vec![0.0; model.degrees_of_freedom()];
                sim.set_joint_state(w, &position, &velocity).unwrap();
            }
            sim.step(600);
            assert!(sim.diverged().is_empty(), "{:?}", sim.diverged());
            let outputs = sim.outputs();
            let of = |w| [0, 1, 2].map(|i| outputs.body_position(w, BodyId(i)));
            (0..worlds).map(of).collect::<Vec<_>>()
        };
        let expected = run(17, 1, false, 0);
        for place in expected.iter().flatten() {
            let (x, z) = (place.x, place.z);
            let ground = 0.1 * (3.0 * x).sin() * (2.0 * z).cos() + 0.2 * (x * x + z * z);
            let above = place.y - ground;
            assert!((0.0..0.5).contains(&above), "{}: {place}", solver.name());
        }
        assert_eq!(run(17, 2, false, 0), expected);
        assert_eq!(run(17, 1, true, 0), expected);
        assert_eq!(run(1, 1, false, 16), expected[16..]);
    }
}

/// The triangles are part of what worlds have in common.
#[test]
fn a_world_has_no_other_mesh_of_its_own() {
    let settings = SimulationSettings {
        worlds: 2,
        ..settings()
    };
    let mut sim = Simulation::<f32>::new(pile(hills()), settings).unwrap();
    let other = pile(field(40, 0.1, |x, _| 0.1 * x));
    assert!(sim.set_world_model(1, &other).is_err());
    sim.set_world_model(1, &pile(hills())).unwrap();
}

/// The scene: nothing leaves it, and on the level meadow the ball, which rolls at 4 m/s, keeps its
/// velocity. By less than w = 2e-4 r beside a corner of the mesh it is off by ω w for a step, as above.
#[test]
fn a_ball_crosses_the_meadow() {
    let mut settings = settings();
    settings.step.sleep_speed = 0.01;
    let mut sim = Simulation::<f32>::new(terrain(15).unwrap(), settings).unwrap();
    let ball = BodyId(sim.model().bodies.len() - 1);
    let mut crossing = Vec::new();
    for _ in 0..5000 {
        sim.step(1);
        let outputs = sim.outputs();
        let (x, v) = (
            outputs.body_position(0, ball).x,
            outputs.body_velocity(0, ball),
        );
        // Not yet at the rim, nor on the slope.
        if (0.3..1.8).contains(&x) && sim.time(0) < 3.0 && v.x > 0.0 {
            crossing.push(v);
        }
    }
    let first = crossing[0];
    assert!(
        crossing.len() > 100 && first.x > 3.0,
        "{}: {first}",
        crossing.len()
    );
    let off = crossing.iter().map(|v| (*v - first).length());
    let most = off.fold(0.0, f64::max);
    assert!(most < 5e-4 * first.x, "{most}");
    for (i, place) in places(&mut sim).into_iter().enumerate() {
        let inside = place.x.abs() < 3.2 && place.z.abs() < 2.2 && place.y > 0.0;
        assert!(inside, "body {i}: {place}");
    }
}
