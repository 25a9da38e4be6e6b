//! Planes that end: what rolls off their edge falls, by every solver, and rays beside them meet nothing.

use glam::DVec3;
use kinetarium_sim::{Ray, Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Model, Pose, Shape, TriangleMesh};

const G: f64 = 9.81;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
const RADIUS: f64 = 0.1;
const HALF: f64 = 0.5;
/// Length of a step [s].
const STEP: f64 = 0.002;

/// A ball on a square, some way from its edge.
fn table() -> Model {
    let top = TriangleMesh::rectangle(HALF, HALF).unwrap();
    let mut world = Builder::new("table");
    world
        .object("table")
        .scenery(Shape::new(Geometry::Mesh(top)));
    let ball = world.object("ball").body("ball");
    ball.shape(Geometry::Sphere { radius: RADIUS })
        .at(Pose::at(DVec3::new(-0.3, RADIUS, 0.05)));
    world.build().unwrap()
}

fn simulate(solver: SolverKind) -> Simulation<f64> {
    let mut settings = SimulationSettings::new(1, STEP);
    settings.solver = solver;
    settings.threads = 1;
    settings.step.sleep_speed = 0.0;
    Simulation::new(table(), settings).unwrap()
}

/// It rolls with v to the edge, across the seam of the two triangles, and is off as soon as its centre is, for
/// v² > g R: from there it falls by g t² / 2, and keeps its v.
#[test]
fn a_ball_rolls_off_the_edge_and_falls() {
    for solver in SOLVERS {
        let mut sim = simulate(solver);
        let speed = 1.2;
        let start = sim.model().initial_position();
        let rolling = [speed, 0.0, 0.0, 0.0, 0.0, -speed / RADIUS];
        sim.set_joint_state(0, &start, &rolling).unwrap();
        sim.step(300);
        let on = sim.outputs().body_position(0, BodyId(0));
        let rolled = -0.3 + speed * 0.6;
        assert!((on.x - rolled).abs() < 0.01, "{}: {on}", solver.name());
        assert!((on.y - RADIUS).abs() < 1e-3, "{}: {on}", solver.name());
        assert!((on.z - 0.05).abs() < 1e-3, "{}: {on}", solver.name());
        sim.step(300);
        let off = sim.outputs().body_position(0, BodyId(0));
        let falling = 1.2 - (HALF + 0.3) / speed;
        let fallen = RADIUS - 0.5 * G * falling * falling;
        assert!(
            (off.x - (speed * 1.2 - 0.3)).abs() < 0.05,
            "{}: {off}",
            solver.name()
        );
        // The edge is left at a time that is known to a step or two, at which it falls by g t each.
        let late = 4.0 * STEP * G * falling;
        assert!(
            (off.y - fallen).abs() < late,
            "{}: {off}, not {fallen}",
            solver.name()
        );
    }
}

#[test]
fn rays_meet_it_inside_its_edges_and_nothing_beside() {
    let mut sim = simulate(SolverKind::Impulse);
    let down = |x: f64, z: f64| Ray {
        origin: DVec3::new(x, 2.0, z),
        direction: DVec3::NEG_Y,
        max_distance: f64::INFINITY,
    };
    let hits = sim
        .cast_rays(
            0,
            &[
                down(0.4, 0.0),
                down(0.49, -0.49),
                down(0.51, 0.0),
                down(0.0, -0.51),
            ],
        )
        .unwrap();
    for hit in &hits[..2] {
        let hit = hit.as_ref().unwrap();
        assert!(
            (hit.distance - 2.0).abs() < 1e-12 && hit.normal == DVec3::Y,
            "{hit:?}"
        );
    }
    assert!(hits[2].is_none() && hits[3].is_none());
}
