//! Signed distance fields, as ground and as bodies, by every solver.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Geometry, Model, Pose, Shape, TriangleMesh};

const G: f64 = 9.81;
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];
/// Between samples [m].
const SPACING: f64 = 0.05;

/// The surface where a distance is zero, sampled over a cuboid of these half sizes.
fn field(half: DVec3, distance: impl Fn(DVec3) -> f64) -> Geometry {
    let counts = half
        .to_array()
        .map(|x| 2 * (x / SPACING).ceil() as usize + 1);
    let at = |i: usize, n: usize| SPACING * (i as f64 - 0.5 * (n - 1) as f64);
    let [nx, ny, nz] = counts;
    let mut samples = Vec::new();
    for z in 0..nz {
        for y in 0..ny {
            let row = (0..nx).map(|x| DVec3::new(at(x, nx), at(y, ny), at(z, nz)));
            samples.extend(row.map(&distance));
        }
    }
    Geometry::Mesh(TriangleMesh::distance_field(counts, SPACING, &samples).unwrap())
}

/// One body on some ground.
fn on(ground: Geometry, body: Geometry, at: Pose) -> Model {
    let mut world = Builder::new("distance field");
    world.object("ground").scenery(Shape::new(ground));
    let things = world.object("things");
    things.body("thing").at(at).shape(Shape::new(body));
    world.build().unwrap()
}

/// Where the body is after 2 s, how fast, and what it presses with as a share of its weight.
fn rest(model: &Model, solver: SolverKind) -> (Pose, f64, DVec3) {
    let mut settings = SimulationSettings {
        solver,
        threads: 1,
        ..SimulationSettings::new(1, 0.002)
    };
    settings.step.sleep_speed = 0.0;
    settings.step.substeps = 2;
    let mut sim = Simulation::<f32>::new(model.clone(), settings).unwrap();
    sim.step(1000);
    assert!(sim.diverged().is_empty(), "{solver:?}");
    let outputs = sim.outputs();
    let force: DVec3 = outputs.contacts(0).map(|c| c.force).sum();
    let body = BodyId(0);
    (
        outputs.body_pose(0, body),
        outputs.body_velocity(0, body).length(),
        force / (model.total_mass() * G),
    )
}

/// A slab whose top is level, between samples: where it is to rounding, so that a box and a ball that are let go a
/// millimetre above lie on it where they were, half of a millimetre deep at most.
#[test]
fn solids_rest_on_a_level_field() {
    let top = 0.013;
    let ground = field(DVec3::new(0.6, 0.2, 0.6), |p| p.y - top);
    let half = DVec3::new(0.1, 0.05, 0.08);
    let turned = DQuat::from_rotation_y(0.4);
    for (name, solid, height) in [
        ("box", Geometry::Box { half }, half.y),
        ("ball", Geometry::Sphere { radius: 0.1 }, 0.1),
    ] {
        let place = DVec3::new(0.07, top + height, -0.04);
        let at = Pose::new(place + 1e-3 * DVec3::Y, turned);
        let model = on(ground.clone(), solid, at);
        for solver in SOLVERS {
            let (pose, speed, force) = rest(&model, solver);
            let what = format!("{name}, {solver:?}: {pose:?}, {speed} m/s, {force}");
            println!("{what}");
            assert!((pose.position - place).length() < 5e-4, "{what}");
            assert!(speed < 1e-3, "{what}");
            assert!((force - DVec3::Y).length() < 0.01, "{what}");
        }
    }
}

/// In a hollow of radius R, where the triangles are chords up to s²/8R inside the sphere, a ball of radius r rolls R − r
/// from the middle, to that and a millimetre.
#[test]
fn a_ball_rolls_in_a_hollow() {
    let (hollow, radius) = (0.5, 0.15);
    let ground = field(DVec3::splat(0.7), |p| hollow - p.length());
    let place = DVec3::new(0.1, -0.25, 0.05);
    let model = on(ground, Geometry::Sphere { radius }, Pose::at(place));
    let sag = SPACING * SPACING / (8.0 * hollow);
    for solver in SOLVERS {
        let (pose, _, _) = rest(&model, solver);
        let away = pose.position.length() - (hollow - radius);
        println!("{solver:?}: {pose:?}, {away} m of {sag}");
        assert!(away.abs() < 2.0 * sag + 1e-3, "{solver:?}: {away} of {sag}");
        assert!(pose.position.y < -0.3, "{solver:?}: {pose:?}");
    }
}

/// Bodies that are fields, on a plane: a ball, whose corners are on the sphere to s²/8r, and a box, whose faces lie between
/// samples; each with its weight, and as high as it is.
#[test]
fn fields_rest_on_a_plane() {
    const PLANE: Geometry = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    let radius = 0.22;
    let sag = SPACING * SPACING / (8.0 * radius);
    let ball = field(DVec3::splat(0.3), |p| p.length() - radius);
    let half = DVec3::new(0.23, 0.12, 0.18);
    let cuboid = field(DVec3::splat(0.3), |p| (p.abs() - half).max_element());
    for (name, body, height, most) in [
        ("ball", ball, radius, sag + 5e-4),
        ("box", cuboid, half.y, 5e-4),
    ] {
        let at = Pose::at(DVec3::new(0.3, height + 1e-3, 0.2));
        let model = on(PLANE, body, at);
        for solver in SOLVERS {
            let (pose, speed, force) = rest(&model, solver);
            let what = format!("{name}, {solver:?}: {pose:?}, {speed} m/s, {force}, {sag}");
            println!("{what}");
            assert!((pose.position.y - height).abs() < most, "{what}");
            assert!((force - DVec3::Y).length() < 0.02, "{what}");
            assert!(speed < 0.02, "{what}");
        }
    }
}
