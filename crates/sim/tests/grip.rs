//! Torsional and rolling friction, with all solvers: torques rₜ N about the normal and rᵣ N across it.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Combine, Geometry, Material, Model, Pose, Shape};

const H: f64 = 0.002;
const G: f64 = 9.81;
const RADIUS: f64 = 0.1;
const BALL: Geometry = Geometry::Sphere { radius: RADIUS };
const PLANE: Geometry = Geometry::Plane {
    half_x: 0.0,
    half_z: 0.0,
};
const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

/// A surface without much sliding, with these lengths [m].
fn gripping(torsional_friction: f64, rolling_friction: f64) -> Material {
    Material {
        friction: 1.0,
        torsional_friction,
        rolling_friction,
        ..Material::default()
    }
}

/// A ball on a plane that is inclined by an angle [rad] towards x.
fn on_plane(material: Material, angle: f64) -> Model {
    let mut world = Builder::new("ball");
    let turned = DQuat::from_rotation_z(-angle);
    world.gravity(turned.inverse() * DVec3::NEG_Y * G);
    world
        .object("ground")
        .scenery(Shape::new(PLANE).with_material(material));
    let things = world.object("things");
    let shape = Shape::new(BALL).with_material(material);
    let ball = things.body("ball").shape(shape).mass(2.0).handle();
    things
        .free("float", ball)
        .initial(&[0.0, RADIUS, 0.0, 0.0, 0.0, 0.0, 1.0]);
    world.build().unwrap()
}

/// At rest on the ground, then in motion.
fn moving(model: Model, solver: SolverKind, velocity: [f64; 6]) -> Simulation<f64> {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, H)
    };
    let mut sim = Simulation::new(model, settings).unwrap();
    sim.step(500);
    let place = sim.outputs().joint_position(0);
    let mut all = vec![0.0; sim.model().degrees_of_freedom()];
    all[..6].copy_from_slice(&velocity);
    sim.set_joint_state(0, &place, &all).unwrap();
    sim
}

/// A ball that spins about the vertical is slowed by rₜ m g, and stops.
#[test]
fn torsional_friction_stops_a_spinning_ball() {
    let (torsion, speed) = (0.01, 10.0);
    let slowing = torsion * G / (0.4 * RADIUS * RADIUS);
    for solver in SOLVERS {
        let model = on_plane(gripping(torsion, 0.0), 0.0);
        let mut sim = moving(model, solver, [0.0, 0.0, 0.0, 0.0, speed, 0.0]);
        let spin = |sim: &mut Simulation<f64>| sim.outputs().body_angular_velocity(0, BodyId(0));
        sim.step(150);
        let now = spin(&mut sim).y;
        // What touches anew is slowed from its second step on.
        let expected = speed - 150.0 * H * slowing;
        assert!(
            (now - expected).abs() < 2.0 * H * slowing,
            "{solver:?}: {now} {expected}"
        );
        sim.step((speed / slowing / H) as usize);
        assert!(
            spin(&mut sim).length() < 1e-6,
            "{solver:?}: {}",
            spin(&mut sim)
        );
    }
}

/// A ball that rolls is slowed by a torque rᵣ m g, m a r = τ / (1 + I / (m r²)), and stops after v² / (2 a).
#[test]
fn rolling_friction_stops_a_rolling_ball() {
    let (rolling, v) = (0.005, 1.0);
    let a = rolling * G / RADIUS / 1.4;
    for solver in SOLVERS {
        let model = on_plane(gripping(0.0, rolling), 0.0);
        let mut sim = moving(model, solver, [v, 0.0, 0.0, 0.0, 0.0, -v / RADIUS]);
        let from = sim.outputs().body_position(0, BodyId(0)).x;
        sim.step((1.1 * v / a / H) as usize);
        let way = sim.outputs().body_position(0, BodyId(0)).x - from;
        let expected = v * v / (2.0 * a);
        assert!(
            (way - expected).abs() < 0.01 * expected,
            "{solver:?}: {way} {expected}"
        );
        let speed = sim.outputs().body_velocity(0, BodyId(0)).length();
        assert!(speed < 1e-4, "{solver:?}: {speed}");
    }
}

/// Below tan θ = rᵣ / r a ball stays where it is on an incline, above it rolls down with
/// g (sin θ − rᵣ / r cos θ) / (1 + I / (m r²)).
#[test]
fn a_ball_on_an_incline_stays_or_rolls() {
    let angle = 0.2_f64;
    for solver in SOLVERS {
        for share in [0.5, 0.9, 1.1, 1.5, 3.0] {
            let rolling = RADIUS * angle.tan() / share;
            let mut sim = moving(on_plane(gripping(0.0, rolling), angle), solver, [0.0; 6]);
            let from = sim.outputs().body_position(0, BodyId(0)).x;
            sim.step(500);
            let way = sim.outputs().body_position(0, BodyId(0)).x - from;
            let what = format!("{solver:?} {share}: {way}");
            if share < 1.0 {
                assert!(way.abs() < 1e-3, "{what}");
            } else {
                let a = G * (angle.sin() - rolling / RADIUS * angle.cos()) / 1.4;
                let expected = 0.5 * a;
                let tolerance = 0.01 * G * angle.sin() / 2.0;
                assert!((way - expected).abs() < tolerance, "{what} {expected}");
            }
        }
    }
}

/// A ball spins on a box that lies on ice: they end up turning as one, with the angular momentum that the ball had.
#[test]
fn torsional_friction_acts_on_both_bodies() {
    let (half, speed) = (DVec3::new(0.2, 0.1, 0.2), 10.0);
    let grip = Material {
        combine: Combine::Minimum,
        ..gripping(0.02, 0.01)
    };
    let ice = Material {
        friction: 0.0,
        combine: Combine::Minimum,
        ..Material::default()
    };
    for solver in SOLVERS {
        let mut world = Builder::new("turntable");
        let ground = Shape::new(PLANE).with_material(ice);
        world.object("ground").scenery(ground);
        let things = world.object("things");
        let above = DVec3::Y * (2.0 * half.y + RADIUS);
        for (name, solid, at) in [
            ("ball", BALL, above),
            ("box", Geometry::Box { half }, DVec3::Y * half.y),
        ] {
            let shape = Shape::new(solid).with_material(grip);
            things.body(name).at(Pose::at(at)).shape(shape);
        }
        let model = world.build().unwrap();
        let moments = [
            0.4 * model.bodies[0].mass * RADIUS * RADIUS,
            model.bodies[1].mass * (half.x * half.x + half.z * half.z) / 3.0,
        ];
        let mut sim = moving(model, solver, [0.0, 0.0, 0.0, 0.0, speed, 0.0]);
        sim.step(2000);
        let together = speed * moments[0] / (moments[0] + moments[1]);
        for body in [0, 1] {
            let spin = sim.outputs().body_angular_velocity(0, BodyId(body)).y;
            assert!(
                (spin / together - 1.0).abs() < 1e-3,
                "{solver:?} {body}: {spin} {together}"
            );
        }
    }
}
