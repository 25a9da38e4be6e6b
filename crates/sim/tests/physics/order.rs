//! Every integrator has the order that it claims, on systems that are not linear.

use crate::common::*;
use glam::DVec3;
use kinetarium_sim::Simulation;
use model::examples::{Start, chain};
use model::{Builder, JointId, Model, Pose};

/// Joint coordinates and velocities after a time.
fn run(simulation: &mut Simulation<f64>, time: f64) -> Vec<f64> {
    let h = simulation.settings().step.time_step;
    simulation.step((time / h).round() as usize);
    let outputs = simulation.outputs();
    [outputs.joint_position(0), outputs.joint_velocity(0)].concat()
}

/// Largest difference.
fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max)
}

/// A double pendulum whose velocities matter (Coriolis forces), let go at an angle.
fn double_pendulum(method: Method, h: f64) -> Simulation<f64> {
    let mut simulation = method.simulate(&chain(2, Start::Hanging).unwrap(), h);
    simulation
        .set_joint_state(0, &[1.0, 0.7], &[0.5, -1.0])
        .unwrap();
    simulation
}

/// Far finer than any step tested: (ω h)⁴ ≈ 1e-14.
const FINE: f64 = 1.0 / 16_384.0;

#[test]
fn on_a_double_pendulum() {
    let reference = run(&mut double_pendulum(RK4, FINE), 1.0);
    for (method, order, h) in [
        (EULER, 1.0, 1.0 / 2048.0),
        (EXPLICIT_EULER, 1.0, 1.0 / 2048.0),
        (RK4, 4.0, 1.0 / 128.0),
        (XPBD, 1.0, 1.0 / 2048.0),
    ] {
        let error = |h| distance(&run(&mut double_pendulum(method, h), 1.0), &reference);
        vanishes(format!("{method:?}"), order, 0.1, h, error);
    }
}

/// What counts in xpbd is the substep, not the step.
#[test]
fn of_xpbd_in_substeps() {
    let reference = run(&mut double_pendulum(RK4, FINE), 1.0);
    let step = 1.0 / 64.0;
    let error = |h: f64| {
        let method = Method::Xpbd((step / h).round() as usize);
        distance(&run(&mut double_pendulum(method, step), 1.0), &reference)
    };
    vanishes("xpbd in substeps", 1.0, 0.1, step / 32.0, error);
}

/// Verlet's claim is for forces that do not depend on velocity.
#[test]
fn of_verlet_where_forces_depend_on_position_only() {
    let run = |method: Method, h: f64| {
        let mut simulation = method.simulate(&pendulum(), h);
        simulation.set_joint_state(0, &[2.0], &[0.3]).unwrap();
        run(&mut simulation, 1.0)
    };
    let reference = run(RK4, FINE);
    vanishes("Verlet", 2.0, 0.1, 1.0 / 128.0, |h| {
        distance(&run(VERLET, h), &reference)
    });
}

/// A lopsided body that flies freely and carries another on a ball joint, without gravity.
fn gyroscope() -> Model {
    let mut world = Builder::new("gyroscope");
    world.gravity(DVec3::new(0.3, -G, 0.2));
    let object = world.object("");
    let base = body(
        object,
        "base",
        1.3,
        DVec3::new(0.1, 0.0, 0.05),
        DVec3::new(0.2, 0.35, 0.5),
    );
    let arm = body(
        object,
        "arm",
        0.8,
        DVec3::new(0.0, -0.3, 0.1),
        DVec3::new(0.1, 0.04, 0.09),
    );
    object.free("flight", base);
    let (at, from) = (DVec3::new(0.2, 0.0, 0.0), DVec3::new(0.0, 0.2, 0.0));
    object
        .ball("ball", arm)
        .parent(base)
        .frames(Pose::at(at), Pose::at(from));
    world.build().unwrap()
}

/// Rotations of a free body and of a ball joint, with their gyroscopic terms: quaternions need the
/// correction of their rates to keep the order.
#[test]
fn on_free_and_ball_rotations() {
    let model = gyroscope();
    let run = |method: Method, h: f64| {
        let mut simulation = method.simulate(&model, h);
        let mut q = model.initial_position();
        let ball = model.coordinate_range(JointId(1));
        q[ball].copy_from_slice(&[0.1, 0.3, -0.2, 0.9]);
        simulation
            .set_joint_state(0, &q, &[0.4, 0.1, -0.2, 2.0, -1.5, 1.0, -1.0, 2.0, 0.5])
            .unwrap();
        run(&mut simulation, 1.0)
    };
    let reference = run(RK4, FINE);
    for (method, order, h) in [
        (EULER, 1.0, 1.0 / 2048.0),
        (EXPLICIT_EULER, 1.0, 1.0 / 2048.0),
        (RK4, 4.0, 1.0 / 64.0),
        (XPBD, 1.0, 1.0 / 2048.0),
    ] {
        vanishes(format!("{method:?}"), order, 0.15, h, |h| {
            distance(&run(method, h), &reference)
        });
    }
}
