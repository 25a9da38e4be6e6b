//! What is fast does not get through what is thin, and what begins deep inside another is not shot out of it.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{
    BodyId, Builder, Geometry, Hull, Material, Model, Pose, Shape, Softness, TriangleMesh,
};

const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// Solids of about this radius [m].
fn solids(r: f64) -> Vec<(&'static str, Geometry)> {
    let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        r * DVec3::new(sign(0), 0.8 * sign(1), 0.9 * sign(2))
    });
    vec![
        ("ball", Geometry::Sphere { radius: r }),
        (
            "capsule",
            Geometry::Capsule {
                radius: r,
                half_height: 2.0 * r,
            },
        ),
        (
            "cylinder",
            Geometry::Cylinder {
                radius: r,
                half_height: r,
            },
        ),
        (
            "cone",
            Geometry::Cone {
                radius: r,
                half_height: r,
            },
        ),
        (
            "box",
            Geometry::Box {
                half: DVec3::splat(r),
            },
        ),
        (
            "ellipsoid",
            Geometry::Ellipsoid {
                half: r * DVec3::new(1.0, 1.2, 0.8),
            },
        ),
        ("hull", Geometry::Hull(Hull::new(&corners).unwrap())),
    ]
}

/// A body of one shape, and scenery, of one surface, without gravity.
fn scene(solid: &Geometry, wall: Shape, softness: Softness) -> Model {
    let material = Material {
        softness,
        ..Material::default()
    };
    let mut world = Builder::new("scene");
    world.gravity(DVec3::ZERO);
    world.object("wall").scenery(wall.with_material(material));
    let bodies = world.object("bodies");
    let shape = Shape::new(solid.clone()).with_material(material);
    bodies.body("body").shape(shape);
    world.build().unwrap()
}

fn simulation(model: Model, solver: SolverKind, worlds: usize, time_step: f64) -> Simulation<f32> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(worlds, time_step)
    };
    Simulation::new(model, settings).unwrap()
}

/// A box as one surface of triangles.
fn case(half: DVec3) -> TriangleMesh {
    let corners = [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
        let sign = |bit: usize| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
        half * DVec3::new(sign(0), sign(1), sign(2))
    });
    let faces = [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ];
    let triangles = faces.map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
    TriangleMesh::new(&corners, triangles.as_flattened()).unwrap()
}

/// Walls whose faces are at x = 0, or half a millimetre before.
fn walls() -> Vec<(&'static str, Shape)> {
    let half = DVec3::new(0.0005, 1.0, 1.0);
    let disc = Geometry::Cylinder {
        radius: 1.0,
        half_height: 0.0005,
    };
    let upright = Pose::new(
        DVec3::ZERO,
        DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
    );
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let sheet = corners.map(|[y, z]| DVec3::new(0.0, y, z)).to_vec();
    let sheet = TriangleMesh::new(&sheet, &[[0, 2, 1], [0, 3, 2]]).unwrap();
    let oblique = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(0.7));
    let plate = case(half);
    let plate = plate.vertices().iter().map(|v| oblique.point(*v));
    let plate = Hull::new(&Vec::from_iter(plate)).unwrap();
    vec![
        ("a thin box", Shape::new(Geometry::Box { half })),
        ("a disc", Shape::new(disc).at(upright)),
        ("a sheet", Shape::new(Geometry::Mesh(sheet))),
        (
            "a plate, a hull in oblique axes",
            Shape::new(Geometry::Hull(plate)).at(oblique.inverse()),
        ),
        (
            "a case, one mesh",
            Shape::new(Geometry::Mesh(case(DVec3::ONE))).at(Pose::at(DVec3::X)),
        ),
    ]
}

/// As MuJoCo's surfaces are, with an added mass of 19 times what moves; as stiff as their own time constant is long, or
/// undamped.
fn surfaces() -> [Softness; 3] {
    [
        Softness::default(),
        Softness::Time {
            constant: 0.02,
            ratio: 1.0,
            impedance: 0.95,
            mass: None,
        },
        Softness::Spring {
            stiffness: 1e4,
            damping: 0.0,
        },
    ]
}

/// The largest overlap [m] of a world's surfaces.
fn overlap(simulation: &mut Simulation<f32>, world: usize) -> f64 {
    let outputs = simulation.outputs();
    let depths = outputs.contacts(world).map(|contact| -contact.distance);
    depths.fold(0.0, f64::max)
}

/// Bullets of all forms, at all places in a lane, that fly at 100 m/s against walls from a third of a metre away, end
/// before them: at rest, but for the 3 m/s with which surfaces are pushed apart, and inside by less than a tenth of their
/// radius, which soft surfaces still push out.
#[test]
fn bullets_stop_at_thin_walls() {
    let mut wrong = Vec::new();
    for (solver, softness) in SOLVERS.iter().flat_map(|s| surfaces().map(|f| (*s, f))) {
        for (wall_name, wall) in walls() {
            for (name, solid) in solids(0.01) {
                let model = scene(&solid, wall.clone(), softness);
                let mut simulation = simulation(model, solver, 16, 0.002);
                for world in 0..16 {
                    let turn =
                        DQuat::from_rotation_y(0.3) * DQuat::from_rotation_z(0.4 * world as f64);
                    let x = -0.3 - 0.0125 * world as f64;
                    let [i, j, k, w] = turn.to_array();
                    let velocity = [100.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                    simulation
                        .set_joint_state(world, &[x, 0.0, 0.0, i, j, k, w], &velocity)
                        .unwrap();
                }
                simulation.step(20);
                let what = format!("{solver:?} {softness:?}: {name} at {wall_name}");
                assert_eq!(simulation.diverged(), [], "{what}");
                for world in 0..16 {
                    let outputs = simulation.outputs();
                    let x = outputs.body_position(world, BodyId(0)).x;
                    let speed = outputs.body_velocity(world, BodyId(0)).length();
                    let deep = overlap(&mut simulation, world);
                    if !(-0.15..0.0).contains(&x) || speed > 3.1 || deep > 1e-3 {
                        wrong.push(format!(
                            "{what}, {world}: {x} m, {speed} m/s, {deep} m deep"
                        ));
                        break;
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

/// Balls at 0.5 to 8 m/s, which springs of 50 rad/s stop or let through, against a sheet and a wall: none gets through,
/// however slowly it comes. Critically damped a spring lets in by v / (e ω), undamped by v / ω.
#[test]
fn soft_springs_let_nothing_through() {
    let (radius, frequency, worlds) = (0.01, 50.0_f64, 32);
    let solid = Geometry::Sphere { radius };
    let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let time = |impedance| Softness::Time {
        constant: 1.0 / frequency,
        ratio: 1.0,
        impedance,
        mass: None,
    };
    let spring = Softness::Spring {
        stiffness: mass * frequency.powi(2),
        damping: 0.0,
    };
    let mut through = Vec::new();
    for solver in SOLVERS {
        for softness in [time(0.0), time(0.95), spring] {
            for (wall_name, wall) in walls() {
                let model = scene(&solid, wall, softness);
                let mut simulation = simulation(model, solver, worlds, 0.001);
                for world in 0..worlds {
                    let speed = 0.5 * 1.09_f64.powi(world as i32);
                    simulation
                        .set_joint_state(
                            world,
                            &[-0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
                            &[speed, 0.0, 0.0, 0.0, 0.0, 0.0],
                        )
                        .unwrap();
                }
                simulation.step(100);
                let what = format!("{solver:?} {softness:?}: {wall_name}");
                assert_eq!(simulation.diverged(), [], "{what}");
                let outputs = simulation.outputs();
                let x = |world: &usize| outputs.body_position(*world, BodyId(0)).x;
                let worlds: Vec<_> = (0..worlds).filter(|world| x(world) > 0.0).collect();
                if !worlds.is_empty() {
                    through.push(format!("{what}: {worlds:?}"));
                }
            }
        }
    }
    assert!(through.is_empty(), "{through:#?}");
}

/// A bullet and a plate of 1 mm at the origin, of 1 kg, that is free, or hangs on a hinge along its upper edge.
fn plate_scene(solid: &Geometry, hinged: bool) -> Model {
    let mut world = Builder::new("scene");
    world.gravity(DVec3::ZERO);
    let bodies = world.object("bodies");
    let bullet = bodies.body("bullet").shape(solid.clone()).handle();
    bodies.free("flight", bullet);
    let half = DVec3::new(0.0005, 0.5, 0.5);
    let plate = bodies.body("plate").shape(Geometry::Box { half }).mass(1.0);
    let plate = plate.handle();
    if hinged {
        let edge = Pose::at(0.5 * DVec3::Y);
        bodies.revolute("hinge", plate, DVec3::Z).frames(edge, edge);
    } else {
        bodies.free("drift", plate);
    }
    world.build().unwrap()
}

/// The same against a plate that gives way: a bullet is never on its other side.
#[test]
fn bullets_stop_at_plates_that_move() {
    let mut through = Vec::new();
    for solver in SOLVERS {
        for hinged in [false, true] {
            for (name, solid) in solids(0.01) {
                let mut simulation = simulation(plate_scene(&solid, hinged), solver, 16, 0.002);
                for world in 0..16 {
                    let turn =
                        DQuat::from_rotation_y(0.3) * DQuat::from_rotation_z(0.4 * world as f64);
                    let x = -0.3 - 0.0125 * world as f64;
                    let [i, j, k, w] = turn.to_array();
                    let mut position = vec![x, -0.2, 0.1, i, j, k, w];
                    let mut velocity = vec![100.0, 0.0, 0.0, 0.0, 0.0, 0.0];
                    if hinged {
                        position.push(0.0);
                        velocity.push(0.0);
                    } else {
                        position.extend([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
                        velocity.extend([0.0; 6]);
                    }
                    simulation
                        .set_joint_state(world, &position, &velocity)
                        .unwrap();
                }
                simulation.step(12);
                let outputs = simulation.outputs();
                let passed = |world: &usize| {
                    let plate = outputs.body_pose(*world, BodyId(1));
                    let bullet = outputs.body_position(*world, BodyId(0));
                    plate.inverse().point(bullet).x > 0.0
                };
                let struck = |world: &usize| outputs.body_velocity(*world, BodyId(1)).x > 0.1;
                let count = (0..16).filter(passed).count();
                let missed = 16 - (0..16).filter(struck).count();
                if count + missed > 0 {
                    let plate = if hinged { "a hinged" } else { "a free" };
                    through.push(format!(
                        "{solver:?}: {count} of 16 {name} through {plate} plate, {missed} not struck"
                    ));
                }
            }
        }
    }
    assert!(through.is_empty(), "{through:#?}");
}

/// Half sunk into a box, solids of 10 cm come out no faster than surfaces are pushed apart, 3 m/s, and half as much for
/// what turns; in the end they are out.
#[test]
fn what_begins_deep_inside_is_not_shot_out() {
    let mut shot = Vec::new();
    for solver in SOLVERS {
        for time_step in [0.001, 0.002, 0.005] {
            for (name, solid) in solids(0.05) {
                let half = DVec3::new(1.0, 0.1, 1.0);
                let wall = Shape::new(Geometry::Box { half });
                let model = scene(&solid, wall, Softness::default());
                let mut simulation = simulation(model, solver, 16, time_step);
                for world in 0..16 {
                    let turn = DQuat::from_rotation_z(0.4 * world as f64);
                    let [i, j, k, w] = turn.to_array();
                    let position = [0.0, 0.1 + 0.003 * world as f64, 0.0, i, j, k, w];
                    simulation
                        .set_joint_state(world, &position, &[0.0; 6])
                        .unwrap();
                }
                let mut fastest = 0.0_f64;
                for _ in 0..100 {
                    simulation.step(1);
                    let outputs = simulation.outputs();
                    let speed = |world| outputs.body_velocity(world, BodyId(0)).length();
                    fastest = (0..16).map(speed).fold(fastest, f64::max);
                }
                assert_eq!(simulation.diverged(), [], "{solver:?} {name}");
                let deep = |world| overlap(&mut simulation, world);
                let deepest = (0..16).map(deep).fold(0.0, f64::max);
                if fastest > 4.5 || deepest > 1e-3 {
                    shot.push(format!(
                        "{solver:?} {time_step} s: {name} {fastest} m/s, {deepest} m deep"
                    ));
                }
            }
        }
    }
    assert!(shot.is_empty(), "{shot:#?}");
}

/// A dumbbell of two balls that turns by 1.2 rad in a step is no ball: it does not meet a wall that is 5 cm out of its
/// reach, though its ends fly towards that for a moment.
#[test]
fn a_dumbbell_is_not_stopped_by_what_it_does_not_reach() {
    let mut world = Builder::new("dumbbell");
    world.gravity(DVec3::ZERO);
    let half = DVec3::new(0.0005, 1.0, 1.0);
    let wall = Shape::new(Geometry::Box { half }).at(Pose::at(DVec3::X * 0.6));
    world.object("wall").scenery(wall);
    let ball = |y| Shape::new(Geometry::Sphere { radius: 0.05 }).at(Pose::at(DVec3::Y * y));
    let bodies = world.object("bodies");
    bodies.body("dumbbell").shape(ball(0.5)).shape(ball(-0.5));
    let model = world.build().unwrap();
    let mut simulation = simulation(model, SolverKind::Impulse, 1, 0.004);
    let spin = 300.0;
    let place = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    simulation
        .set_joint_state(0, &place, &[0.0, 0.0, 0.0, 0.0, 0.0, spin])
        .unwrap();
    simulation.step(50);
    let outputs = simulation.outputs();
    let kept = outputs.body_angular_velocity(0, BodyId(0)).z;
    assert!((kept - spin).abs() < 1e-3 * spin, "{kept}");
}

/// A thin plate, a hull whose corners lie askew to its axes, is struck so that it would get through a wall behind it in
/// one step: that counts by how thin it is, not by the box about it.
#[test]
fn a_plate_that_is_struck_does_not_pass_a_wall() {
    let oblique = Pose::new(
        DVec3::ZERO,
        DQuat::from_rotation_z(0.25 * std::f64::consts::PI),
    );
    let plate = case(DVec3::new(0.01, 0.5, 0.5));
    let plate = plate.vertices().iter().map(|v| oblique.point(*v));
    let plate = Hull::new(&Vec::from_iter(plate)).unwrap();
    let plate = Shape::new(Geometry::Hull(plate)).at(oblique.inverse());
    let half = DVec3::new(0.005, 1.0, 1.0);
    let wall = Shape::new(Geometry::Box { half }).at(Pose::at(DVec3::X * 0.06));
    let mut world = Builder::new("plate");
    world.gravity(DVec3::ZERO);
    world.object("wall").scenery(wall);
    let bodies = world.object("bodies");
    bodies.body("plate").shape(plate).mass(1.0);
    let ball = Geometry::Sphere { radius: 0.1 };
    let at = Pose::at(DVec3::X * -0.2);
    bodies.body("ball").at(at).shape(ball).mass(20.0);
    let mut simulation = simulation(world.build().unwrap(), SolverKind::Impulse, 1, 1.0 / 60.0);
    let position = simulation.outputs().joint_position(0);
    let mut velocity = [0.0; 12];
    velocity[6] = 15.0;
    simulation.set_joint_state(0, &position, &velocity).unwrap();
    for step in 0..30 {
        simulation.step(1);
        let x = simulation.outputs().body_position(0, BodyId(0)).x;
        assert!(x < 0.06, "behind the wall in step {step}: {x} m");
    }
}
