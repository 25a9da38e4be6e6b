//! Bodies that are meshes: on planes, solids and other meshes, by every solver.

use glam::{DQuat, DVec2, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Hull, Model, Pose, Shape, TriangleMesh};
use numbers::Float;
use std::f64::consts::TAU;

const G: f64 = 9.81;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};

fn settings(solver: SolverKind) -> SimulationSettings {
    let mut settings = SimulationSettings::new(1, 0.002);
    settings.solver = solver;
    settings.threads = 1;
    settings.step.sleep_speed = 0.0;
    settings.step.substeps = 2;
    settings
}

fn mesh(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Geometry {
    Geometry::Mesh(TriangleMesh::new(vertices, triangles).unwrap())
}

/// What a profile sweeps.
fn swept(profile: &[DVec2], around: usize) -> Geometry {
    Geometry::Mesh(TriangleMesh::revolution(profile, around).unwrap())
}

/// A ring of a round cross-section about the y axis.
fn torus(radius: f64, thick: f64, n: usize, m: usize) -> Geometry {
    let point = |j: usize| {
        let (s, c) = (j as f64 / m as f64 * TAU).sin_cos();
        DVec2::new(radius + thick * c, thick * s)
    };
    swept(&(0..m).map(point).collect::<Vec<_>>(), n)
}

/// The surface of a box.
fn box_mesh(half: DVec3) -> Geometry {
    let corner = |i: u32| {
        half * DVec3::from_array([i, i >> 1, i >> 2].map(|b| f64::from(b & 1) * 2.0 - 1.0))
    };
    let corners: Vec<_> = (0..8).map(corner).collect();
    let hull = Hull::new(&corners).unwrap();
    mesh(hull.vertices(), hull.triangles())
}

/// A level floor of triangles.
fn floor() -> Geometry {
    Geometry::Mesh(TriangleMesh::height_field(&vec![vec![0.0; 21]; 21], DVec2::splat(0.2)).unwrap())
}

/// One body on some ground.
fn on(ground: Geometry, geometry: Geometry, at: Pose) -> Model {
    let mut world = Builder::new("moving");
    world.object("ground").scenery(Shape::new(ground));
    world
        .object("things")
        .body("thing")
        .at(at)
        .shape(Shape::new(geometry));
    world.build().unwrap()
}

fn run<T: Float>(
    model: &Model,
    solver: SolverKind,
    velocity: &[f64],
    steps: usize,
) -> Simulation<T> {
    let mut sim = Simulation::new(model.clone(), settings(solver)).unwrap();
    sim.set_joint_state(0, &model.initial_position(), velocity)
        .unwrap();
    sim.step(steps);
    assert!(sim.diverged().is_empty(), "{}", solver.name());
    sim
}

/// The forces of all contacts on what moves [N], averaged over some steps, in which the points they are
/// shared by may change.
fn mean_force<T: Float>(sim: &mut Simulation<T>) -> DVec3 {
    const STEPS: usize = 200;
    let mut sum = DVec3::ZERO;
    for _ in 0..STEPS {
        sim.step(1);
        let outputs = sim.outputs();
        sum += outputs.contacts(0).map(|c| c.force).sum::<DVec3>();
    }
    sum / STEPS as f64
}

fn place<T: Float>(sim: &mut Simulation<T>, body: usize) -> DVec3 {
    sim.outputs().body_position(0, BodyId(body))
}

/// A box of triangles slides, turning, and comes to rest as a box does, on every ground.
#[test]
fn a_box_of_triangles_is_a_box() {
    let half = DVec3::new(0.1, 0.05, 0.08);
    let large = DVec3::new(3.0, 1.0, 3.0);
    let grounds = [
        PLANE,
        Geometry::Box { half: large },
        floor(),
        box_mesh(large),
    ];
    for (i, ground) in grounds.into_iter().enumerate() {
        let top = if i % 2 == 1 { large.y } else { 0.0 };
        let at = Pose::at(DVec3::new(0.013, top + half.y, 0.021));
        for solver in SOLVERS {
            let [solid, mesh] = [Geometry::Box { half }, box_mesh(half)].map(|geometry| {
                let model = on(ground.clone(), geometry, at);
                let mut sim = run::<f32>(&model, solver, &[0.8, 0.0, 0.3, 0.0, 2.0, 0.0], 700);
                (
                    place(&mut sim, 0),
                    mean_force(&mut sim) / (model.total_mass() * G),
                )
            });
            let name = format!("{i} {}", solver.name());
            // It slides by 0.08 m, a little less or more as its points of contact share the load.
            assert!(
                (solid.0 - mesh.0).length() < 1.5e-3,
                "{name}: {solid:?} {mesh:?}"
            );
            assert!((mesh.1 - DVec3::Y).length() < 0.01, "{name}: {mesh:?}");
        }
    }
}

/// A ring falls around a peg, down to the ground; its hull would stay on top.
#[test]
fn a_ring_falls_around_a_peg() {
    let ring = torus(0.12, 0.03, 16, 8);
    for ground in [PLANE, floor()] {
        let mut world = Builder::new("peg");
        let peg = Geometry::Capsule {
            radius: 0.05,
            half_height: 0.4,
        };
        world
            .object("ground")
            .scenery(Shape::new(ground))
            .scenery(Shape::new(peg));
        let at = Pose::new(DVec3::new(0.03, 0.5, -0.02), DQuat::from_rotation_x(0.2));
        world
            .object("things")
            .body("ring")
            .at(at)
            .shape(Shape::new(ring.clone()));
        let model = world.build().unwrap();
        for solver in SOLVERS {
            let mut sim = run::<f64>(&model, solver, &[0.0; 6], 1500);
            let at = place(&mut sim, 0);
            assert!((at.y - 0.03).abs() < 1e-4, "{}: {at}", solver.name());
            assert!(
                at.x.hypot(at.z) < 0.12 - 0.03 - 0.05 + 1e-3,
                "{}: {at}",
                solver.name()
            );
            let force = mean_force(&mut sim) - model.total_mass() * G * DVec3::Y;
            assert!(
                force.length() < 0.03 * model.total_mass() * G,
                "{}: {force}",
                solver.name()
            );
        }
    }
}

/// Each link hangs in the one above it, which bears it and all below: contacts of meshes with meshes.
#[test]
fn a_chain_hangs_by_its_links() {
    let (radius, thick) = (0.12, 0.03);
    let link = torus(radius, thick, 24, 12);
    let mut world = Builder::new("chain");
    let upright = DQuat::from_rotation_x(0.25 * TAU);
    let top = Pose::new(DVec3::Y, upright);
    world
        .object("top")
        .scenery(Shape::new(link.clone()).at(top));
    let chain = world.object("chain");
    for i in 0..3 {
        let at = DVec3::Y * (1.0 - 0.17 * f64::from(i + 1));
        let turn = DQuat::from_rotation_y(0.25 * TAU * f64::from(i + 1));
        let body = chain.body(format!("link{i}"));
        body.at(Pose::new(at, turn * upright))
            .shape(Shape::new(link.clone()));
    }
    let model = world.build().unwrap();
    for solver in SOLVERS {
        let mut sim = run::<f32>(&model, solver, &[0.0; 18], 800);
        for i in 0..3 {
            // Lower than the one above by the width of its hole, but for the rings' corners.
            let at = place(&mut sim, i);
            let (links, width) = ((i + 1) as f64, 2.0 * (radius - thick));
            let off = at.y - (1.0 - width * links);
            assert!(off.abs() < 4e-3 * links, "{} {i}: {at}", solver.name());
            assert!(at.x.hypot(at.z) < 0.04, "{} {i}: {at}", solver.name());
        }
        // Three links, two, and one.
        let all: f64 = 2.0 * model.total_mass() * G;
        let force = mean_force(&mut sim).y;
        assert!(
            (force - all).abs() < 0.02 * all,
            "{}: {force} for {all}",
            solver.name()
        );
    }
}

/// A ball comes to rest in a bowl that stands on the ground and bears it.
#[test]
fn a_ball_rests_in_a_bowl() {
    let arc = |radius: f64, from: f64, to: f64| {
        (0..=8).map(move |i| {
            let (s, c) = (from + (to - from) * f64::from(i) / 8.0).sin_cos();
            DVec2::new(radius * s, 0.3 - radius * c)
        })
    };
    let profile: Vec<_> = arc(0.25, 1.4, 0.0).chain(arc(0.3, 0.0, 1.4)).collect();
    let bowl = swept(&profile, 24);
    for ground in [PLANE, floor()] {
        let mut world = Builder::new("bowl");
        world.object("ground").scenery(Shape::new(ground));
        let things = world.object("things");
        things.body("bowl").shape(Shape::new(bowl.clone()));
        let ball = things
            .body("ball")
            .at(Pose::at(DVec3::new(0.05, 0.2, 0.02)));
        ball.shape(Shape::new(Geometry::Sphere { radius: 0.06 }));
        let model = world.build().unwrap();
        for solver in SOLVERS {
            let mut sim = run::<f32>(&model, solver, &[0.0; 12], 1000);
            let (bowl, ball) = (place(&mut sim, 0), place(&mut sim, 1));
            let name = solver.name();
            assert!(bowl.length() < 2e-3, "{name}: {bowl}");
            let low = 0.05 + 0.06;
            assert!((low - 1e-3..low + 0.04).contains(&ball.y), "{name}: {ball}");
            assert!(ball.x.hypot(ball.z) < 0.1, "{name}: {ball}");
        }
    }
}
