//! What creeps does not sleep: dampers hold it back, but a force moves it on. And what wakes falls from where it slept.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{BodyId, Builder, Drive, Geometry, Model, Pose, Shape};
use numbers::Float;

const G: f64 = 9.81;
const H: f64 = 1.0 / 60.0;

fn simulation<T: Float>(model: Model) -> Simulation<T> {
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(1, H)
    };
    Simulation::new(model, settings).unwrap()
}

fn cube(half: f64) -> Geometry {
    Geometry::Box {
        half: DVec3::splat(half),
    }
}

/// A driven arm of 1 kg on a hinge.
fn arm(drive: Drive, gravity: f64) -> Model {
    let mut world = Builder::new("arm");
    world.gravity(DVec3::NEG_Y * gravity);
    let robot = world.object("robot");
    let at = Pose::at(DVec3::X * 0.25);
    let arm = robot
        .body("arm")
        .at(at)
        .shape(cube(0.25))
        .mass(1.0)
        .handle();
    let hinge = robot.revolute("hinge", arm, DVec3::Z);
    hinge.at(Pose::IDENTITY).drive(drive);
    world.build().unwrap()
}

/// A drive k, d alone brings its arm to the target as e^(−k t / d): here for minutes, at 3 mm/s and less.
#[test]
fn a_damped_drive_reaches_its_target() {
    let drive = Drive {
        stiffness: 2.0,
        damping: 200.0,
        ..Drive::default()
    };
    let mut sim = simulation::<f64>(arm(drive, 0.0));
    sim.controls().set_target(0, 0, 0.5).unwrap();
    sim.step(6000);
    let (angle, time) = (sim.outputs().joint_position(0)[0], 6000.0 * H);
    let left = (-drive.stiffness * time / drive.damping).exp();
    let ideal = 0.5 * (1.0 - left);
    assert!((angle - ideal).abs() < 2e-3 * ideal, "{angle} for {ideal}");
}

/// Single precision tells what creeps from what is rounded: a damped arm that has reached its target sleeps.
#[test]
fn a_damped_drive_sleeps_at_its_target() {
    let drive = Drive {
        stiffness: 2e3,
        damping: 200.0,
        ..Drive::default()
    };
    let mut sim = simulation::<f32>(arm(drive, G));
    sim.controls().set_target(0, 0, 0.5).unwrap();
    sim.step(300);
    assert!(sim.outputs().asleep(0, BodyId(0)));
}

/// A weight on a damped rail sinks with m g / d, and so does what only a damper holds to the world.
#[test]
fn a_damped_weight_sinks() {
    let (mass, damping) = (10.0, 2e4);
    for free in [false, true] {
        let mut world = Builder::new("weight");
        world.gravity(DVec3::NEG_Y * G);
        let object = world.object("object");
        let body = object.body("weight").shape(cube(0.1)).mass(mass).handle();
        if free {
            object.free("air", body).damping(damping);
        } else {
            object.prismatic("rail", body, DVec3::Y).damping(damping);
        }
        let mut sim = simulation::<f64>(world.build().unwrap());
        sim.step(1200);
        let height = sim.outputs().body_position(0, BodyId(0)).y;
        let ideal = -mass * G / damping * 1200.0 * H;
        assert!(
            (height - ideal).abs() < 1e-3 * ideal.abs(),
            "{height} for {ideal}"
        );
    }
}

/// A block sleeps on a lift, 0.3 mm above a post. The lift drops, and the block would fall by g h² / 2 ≈ 1.4 mm in the
/// first step: the post bears it.
#[test]
fn what_wakes_and_falls_is_caught_in_the_same_step() {
    let drive = Drive {
        stiffness: 1e6,
        damping: 1e4,
        ..Drive::default()
    };
    let mut world = Builder::new("lift");
    world.gravity(DVec3::NEG_Y * G);
    let post = Shape::new(cube(0.2)).at(Pose::at(DVec3::new(0.15, 0.2, 0.0)));
    world.object("post").scenery(post);
    let object = world.object("object");
    let top = 0.4003;
    let at = Pose::at(DVec3::new(-0.3, top - 0.2, 0.0));
    let lift = object
        .body("lift")
        .at(at)
        .shape(cube(0.2))
        .mass(1.0)
        .handle();
    object.prismatic("rail", lift, DVec3::Y).drive(drive);
    let slab = Geometry::Box {
        half: DVec3::new(0.5, 0.1, 0.2),
    };
    let at = Pose::at(DVec3::new(-0.1, top + 0.1, 0.0));
    object.body("block").at(at).shape(slab).mass(1.0);
    let mut sim = simulation::<f64>(world.build().unwrap());
    sim.step(120);
    let bodies = [BodyId(0), BodyId(1)];
    assert!(bodies.iter().all(|body| sim.outputs().asleep(0, *body)));
    sim.controls().set_target(0, 0, -0.3).unwrap();
    let mut lowest = f64::INFINITY;
    for _ in 0..120 {
        sim.step(1);
        let outputs = sim.outputs();
        let deepest = outputs.contacts(0).map(|c| -c.distance).fold(0.0, f64::max);
        assert!(deepest < 5e-4, "{deepest} m deep");
        lowest = lowest.min(outputs.body_position(0, BodyId(0)).y);
    }
    assert!(lowest < 0.0, "the lift is down: {lowest} m");
}
