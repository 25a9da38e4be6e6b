//! What joints pass on: statics and the forces of motion.

use crate::common::*;
use glam::DVec3;
use model::examples::{CHAIN_LINK_MASS, Start, chain};
use model::{Builder, JointId, Pose};

/// In a hanging chain every joint carries what hangs below it.
#[test]
fn hanging_chain_carries_the_weight_below() {
    let links = 10;
    let model = chain(links, Start::Hanging).unwrap();
    for method in [EULER, Method::Xpbd(4), Method::Impulse(8)] {
        let mut simulation = method.simulate::<f64>(&model, 2e-3);
        simulation.step(10_000);
        let outputs = simulation.outputs();
        for i in 0..links {
            let weight = (links - i) as f64 * CHAIN_LINK_MASS * G;
            let (force, torque) = outputs.reaction(0, JointId(i));
            near(
                format!("{method:?} force {i}"),
                force,
                DVec3::Y * weight,
                1e-8,
            );
            near(format!("{method:?} torque {i}"), torque, DVec3::ZERO, 1e-8);
        }
    }
}

/// Along the rod of a swinging pendulum: m g cos θ + m l θ̇². Across it: the weight's part less what
/// accelerates, m (g sin θ + l θ̈) with θ̈ = −m g l sin θ/(I + m l²).
fn pendulum_force(q: f64, v: f64) -> DVec3 {
    let (m, l, i) = PENDULUM;
    let acceleration = -m * G * l * q.sin() / (i + m * l * l);
    let (inwards, forwards) = (
        DVec3::new(-q.sin(), q.cos(), 0.0),
        DVec3::new(q.cos(), q.sin(), 0.0),
    );
    inwards * m * (G * q.cos() + l * v * v) + forwards * m * (G * q.sin() + l * acceleration)
}

#[test]
fn pendulum_pulls_at_its_hinge() {
    let model = pendulum();
    let mut simulation = EULER.simulate::<f64>(&model, 1e-3);
    for (q, v) in [(0.0, 4.0), (0.8, -3.0), (2.5, 1.0), (-1.2, 6.0)] {
        simulation.set_joint_state(0, &[q], &[v]).unwrap();
        let (force, torque) = simulation.outputs().reaction(0, JointId(0));
        near(
            format!("force at {q}, {v}"),
            force,
            pendulum_force(q, v),
            1e-10,
        );
        near(format!("torque at {q}, {v}"), torque, DVec3::ZERO, 1e-12);
    }
}

/// In maximal coordinates it is the mean over the last substep or small step, so it tends to the momentary
/// one by first order.
#[test]
fn pendulum_pulls_at_its_hinge_in_maximal_coordinates() {
    let model = pendulum();
    let error = |method: Method, h: f64| {
        let mut simulation = method.simulate::<f64>(&model, h);
        simulation.set_joint_state(0, &[1.0], &[3.0]).unwrap();
        simulation.step((0.3 / h).round() as usize);
        let outputs = simulation.outputs();
        let (q, v) = (outputs.joint_position(0)[0], outputs.joint_velocity(0)[0]);
        outputs
            .reaction(0, JointId(0))
            .0
            .distance(pendulum_force(q, v))
    };
    for method in [XPBD, IMPULSE] {
        vanishes(format!("{method:?} force"), 1.0, 0.1, 1e-3, |h| {
            error(method, h)
        });
    }
}

/// A cantilever of two welded beams: the wall carries both weights and m g times their arms; the weld
/// the outer one's.
#[test]
fn cantilever_carries_torque() {
    let (m, half) = ([2.0, 1.0], 0.5);
    let mut world = Builder::new("cantilever");
    let object = world.object("");
    let center = DVec3::new(half, 0.0, 0.0);
    let moments = DVec3::new(0.01, 0.2, 0.2);
    let (inner, outer) = (
        body(object, "inner", m[0], center, moments),
        body(object, "outer", m[1], center, moments),
    );
    object.fixed("wall", inner);
    let end = Pose::at(DVec3::new(2.0 * half, 0.0, 0.0));
    object
        .fixed("weld", outer)
        .parent(inner)
        .frames(end, Pose::IDENTITY);
    let model = world.build().unwrap();
    for method in [EULER, Method::Xpbd(4), Method::Impulse(8)] {
        let mut simulation = method.simulate::<f64>(&model, 2e-3);
        simulation.step(5000);
        let outputs = simulation.outputs();
        let at_weld = m[1] * G * half;
        let at_wall = m[0] * G * half + m[1] * G * 3.0 * half;
        for (joint, weight, moment) in [(0, m[0] + m[1], at_wall), (1, m[1], at_weld)] {
            let (force, torque) = outputs.reaction(0, JointId(joint));
            near(
                format!("{method:?} force {joint}"),
                force,
                DVec3::Y * weight * G,
                1e-6,
            );
            near(
                format!("{method:?} torque {joint}"),
                torque,
                DVec3::Z * moment,
                1e-3,
            );
        }
    }
}
