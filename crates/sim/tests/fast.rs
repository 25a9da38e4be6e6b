//! What is fast does not get through what is thin, and what begins deep inside another is not shot out of it.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Hull, Model, Pose, Shape, TriangleMesh};

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

/// A body of one shape, and scenery, without gravity.
fn scene(solid: &Geometry, wall: Shape) -> Model {
    let mut world = Builder::new("scene");
    world.gravity(DVec3::ZERO);
    world.object("wall").scenery(wall);
    world
        .object("bodies")
        .body("body")
        .shape(Shape::new(solid.clone()));
    world.build().unwrap()
}

fn simulation(model: Model, solver: SolverKind, time_step: f64) -> Simulation<f32> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(16, time_step)
    };
    Simulation::new(model, settings).unwrap()
}

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
    vec![
        ("a thin box", Shape::new(Geometry::Box { half })),
        ("a disc", Shape::new(disc).at(upright)),
        ("a sheet", Shape::new(Geometry::Mesh(sheet))),
    ]
}

/// Bullets of all forms, at all places in a lane, that fly at 100 m/s against 1 mm from a third of a metre away.
#[test]
fn bullets_stop_at_thin_walls() {
    let mut through = Vec::new();
    for solver in SOLVERS {
        for (wall_name, wall) in walls() {
            for (name, solid) in solids(0.01) {
                let model = scene(&solid, wall.clone());
                let mut simulation = simulation(model, solver, 0.002);
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
                let outputs = simulation.outputs();
                let x = |world| outputs.body_position(world, BodyId(0)).x;
                let passed = (0..16).filter(|world| x(*world) > 0.0).count();
                if passed > 0 {
                    through.push(format!(
                        "{solver:?}: {passed} of 16 {name} through {wall_name}"
                    ));
                }
            }
        }
    }
    assert!(through.is_empty(), "{through:#?}");
}

/// Half sunk into a box, solids of 10 cm come out no faster than surfaces are pushed apart, 3 m/s, and half as much for
/// what turns.
#[test]
fn what_begins_deep_inside_is_not_shot_out() {
    let mut shot = Vec::new();
    for solver in SOLVERS {
        for time_step in [0.001, 0.002, 0.005] {
            for (name, solid) in solids(0.05) {
                let half = DVec3::new(1.0, 0.1, 1.0);
                let model = scene(&solid, Shape::new(Geometry::Box { half }));
                let mut simulation = simulation(model, solver, time_step);
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
                if fastest > 4.5 {
                    shot.push(format!("{solver:?} {time_step} s: {name} {fastest} m/s"));
                }
            }
        }
    }
    assert!(shot.is_empty(), "{shot:#?}");
}
