//! What only xpbd does: compliance, caps, joints that let go; and what it did not
//! do while joints were solved one by one: lean at the rate of its dampers.

use crate::common::*;
use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationError};
use model::examples::{CHAIN_LENGTH, CHAIN_LINK_MASS, Start, chain};
use model::{BodyId, Builder, Drive, JointId, Model};
use std::f64::consts::TAU;

const H: f64 = 1e-3;

/// A weight on a compliant fixed joint hangs lower by weight × compliance. As an oscillator of
/// ω² = 1/(m α) it comes to rest by implicit Euler's own damping, h ω²/2.
#[test]
fn compliance_is_deflection_over_force() {
    let (m, compliance) = (3.0, 1e-5);
    let mut world = Builder::new("soft");
    let object = world.object("");
    let weight = body(object, "weight", m, DVec3::ZERO, DVec3::splat(0.1));
    object.fixed("mount", weight).compliance(compliance, 0.0);
    let model = world.build().unwrap();
    let mut simulation = XPBD.simulate::<f64>(&model, H);
    simulation.step(5000);
    let expected = DVec3::NEG_Y * m * G * compliance;
    let outputs = simulation.outputs();
    near(
        "deflection",
        outputs.body_position(0, BodyId(0)),
        expected,
        1e-12,
    );
    near(
        "force",
        outputs.reaction(0, JointId(0)).0,
        DVec3::Y * m * G,
        1e-6,
    );
}

/// A weight at the end of an arm turns a compliant mount by torque × compliance:
/// φ = α m g l cos φ.
#[test]
fn angular_compliance_is_turn_over_torque() {
    let (m, l, compliance) = (3.0, 0.5, 2e-3);
    let mut world = Builder::new("soft");
    let object = world.object("");
    let arm = body(object, "arm", m, DVec3::new(l, 0.0, 0.0), DVec3::splat(0.1));
    object.fixed("mount", arm).compliance(0.0, compliance);
    let model = world.build().unwrap();
    let mut simulation = XPBD.simulate::<f64>(&model, H);
    // ω = √(1/(α (I + m l²))) fades by h ω²/2 = 0.29 1/s.
    simulation.step(80_000);
    let mut turn: f64 = 0.0;
    for _ in 0..100 {
        turn = compliance * m * G * l * turn.cos();
    }
    let outputs = simulation.outputs();
    let q = outputs.body_orientation(0, BodyId(0));
    let turned = (DQuat::from_rotation_z(-turn).conjugate() * q)
        .xyz()
        .length();
    // The mount sees the angle before gravity pulls at the arm: off by what its torque turns the
    // arm by in a substep, h² τ/I.
    close("turn", 2.0 * turned, 0.0, H * H * m * G * l / 0.1);
    let (force, torque) = outputs.reaction(0, JointId(0));
    near("force", force, DVec3::Y * m * G, 1e-6);
    // Within the substep the angle changes by that, and the torque by that times m g l sin φ.
    let found = DVec3::X.angle_between(q * DVec3::X);
    let change = H * H * m * G * l / 0.1 * m * G * l * found.sin();
    close("torque", torque.z, m * G * l * found.cos(), 1.5 * change);
}

/// However many passes share it out, joints of trees and of loops bear no more than the cap.
#[test]
fn force_cap_holds_over_passes() {
    let m = 2.0;
    for closes_loop in [false, true] {
        let mut world = Builder::new("hook");
        let object = world.object("");
        let weight = body(object, "weight", m, DVec3::ZERO, DVec3::splat(0.1));
        if closes_loop {
            object.free("free", weight);
        }
        object.fixed("hook", weight).closes_loop(closes_loop);
        let model = world.build().unwrap();
        for iterations in [2, 5] {
            let mut settings = XPBD.settings(1, H);
            (settings.step.force_cap, settings.step.iterations) = (0.6 * m * G, iterations);
            let mut simulation = Simulation::<f64>::new(model.clone(), settings).unwrap();
            simulation.step(1000);
            let outputs = simulation.outputs();
            let fallen = 0.4 * G * H * H * 1000.0 * 1001.0 / 2.0;
            let place = outputs.body_position(0, BodyId(0));
            let name = format!("{closes_loop} {iterations}");
            near(&name, place, DVec3::NEG_Y * fallen, 1e-9);
            assert!(outputs.capped(0) >= 1000);
        }
    }
}

/// A weight hangs from a fixed joint with a force cap of 0.6 of its weight: it falls by the rest, and
/// every substep is reported. A cap above the weight is never felt.
#[test]
fn force_cap_bites_and_is_reported() {
    let m = 2.0;
    let mut world = Builder::new("hook");
    let object = world.object("");
    let weight = body(object, "weight", m, DVec3::ZERO, DVec3::splat(0.1));
    object.fixed("hook", weight);
    let model = world.build().unwrap();
    for (share, falls, bites) in [(0.6, 0.4 * G, 1000), (1.5, 0.0, 0)] {
        let mut settings = XPBD.settings(1, H);
        settings.step.force_cap = share * m * G;
        let mut simulation = Simulation::<f64>::new(model.clone(), settings).unwrap();
        simulation.step(1000);
        let outputs = simulation.outputs();
        let fallen = falls * H * H * 1000.0 * 1001.0 / 2.0;
        let place = outputs.body_position(0, BodyId(0));
        near(format!("{share}"), place, DVec3::NEG_Y * fallen, 1e-9);
        assert_eq!(outputs.capped(0), bites);
        let force = outputs.reaction(0, JointId(0)).0;
        near("force", force, DVec3::Y * share.min(1.0) * m * G, 1e-6);
    }
}

/// A displacement cap of 0.3 g h² a pass leaves a fall with 0.7 g.
#[test]
fn displacement_cap_bites_and_is_reported() {
    let mut world = Builder::new("hook");
    let object = world.object("");
    let weight = body(object, "weight", 2.0, DVec3::ZERO, DVec3::splat(0.1));
    object.fixed("hook", weight);
    let model = world.build().unwrap();
    let mut settings = XPBD.settings(1, H);
    settings.step.displacement_cap = 0.3 * G * H * H;
    let mut simulation = Simulation::<f64>::new(model.clone(), settings).unwrap();
    simulation.step(1000);
    let outputs = simulation.outputs();
    let fallen = 0.7 * G * H * H * 1000.0 * 1001.0 / 2.0;
    near(
        "place",
        outputs.body_position(0, BodyId(0)),
        DVec3::NEG_Y * fallen,
        1e-9,
    );
    assert_eq!(outputs.capped(0), 1000);
}

/// The same model with the joint switched off.
fn let_go(model: &Model) -> Model {
    let mut parts = model.clone().into_parts();
    parts.joints[0].enabled = false;
    Model::new(parts).unwrap()
}

/// One world's pendulum is let go in mid-swing: its centre flies on in a parabola, and the
/// neighbours swing on to the bit.
#[test]
fn joint_disabled_at_run_time_lets_go() {
    let model = pendulum();
    let worlds = || {
        let mut simulation = Simulation::<f64>::new(model.clone(), XPBD.settings(3, H)).unwrap();
        for world in 0..3 {
            simulation.set_joint_state(world, &[0.8], &[1.0]).unwrap();
        }
        simulation.step(300);
        simulation
    };
    let (mut untouched, mut simulation) = (worlds(), worlds());
    simulation.set_world_model(1, &let_go(&model)).unwrap();
    let center = |simulation: &mut Simulation<f64>, world: usize| {
        let outputs = simulation.outputs();
        let arm = DVec3::new(0.0, -PENDULUM.1, 0.0);
        let pose = outputs.body_pose(world, BodyId(0));
        let w = outputs.body_angular_velocity(world, BodyId(0));
        let v = outputs.body_velocity(world, BodyId(0)) + w.cross(pose.direction(arm));
        (pose.point(arm), v, w)
    };
    let (p, v, w) = center(&mut simulation, 1);
    let n = 500;
    simulation.step(n);
    untouched.step(n);
    let (found, _, spin) = center(&mut simulation, 1);
    let fallen = 0.5 * G * H * H * (n * (n + 1)) as f64;
    near(
        "centre",
        found,
        p + v * n as f64 * H - DVec3::Y * fallen,
        1e-10,
    );
    near("spin", spin, w, 1e-10);
    for world in [0, 2] {
        let swings = |s: &mut Simulation<f64>| s.outputs().joint_position(world)[0].to_bits();
        assert_eq!(swings(&mut simulation), swings(&mut untouched));
    }
}

#[test]
fn featherstone_refuses_a_disabled_joint_and_names_xpbd() {
    let mut simulation = EULER.simulate::<f64>(&pendulum(), H);
    let refused = simulation
        .set_world_model(0, &let_go(&pendulum()))
        .unwrap_err();
    assert!(matches!(refused, SimulationError::Solver(_)));
    assert_eq!(
        refused.to_string(),
        "joint `hinge` is disabled, which `featherstone` cannot simulate: use the solver `xpbd`"
    );
}

/// Torques at the hinges of an upright chain per small angles q of theirs [N·m/rad]: link i of n, at
/// φ_i = Σ_{j ≤ i} q_j, has Σ_{k ≥ i} m g l less half a link above its hinge.
fn toppling(q: &[f64]) -> Vec<f64> {
    let n = q.len();
    let per_link = CHAIN_LINK_MASS * G * CHAIN_LENGTH / n as f64;
    let mut lean = 0.0;
    let mut torques: Vec<f64> = q
        .iter()
        .enumerate()
        .map(|(i, q)| {
            lean += q;
            per_link * ((n - i) as f64 - 0.5) * lean
        })
        .collect();
    for i in (0..n - 1).rev() {
        torques[i] += torques[i + 1];
    }
    torques
}

/// An upright chain that leans a little, held by dampers d alone, creeps by d q̇ = A q, A from
/// [`toppling`]: q(t) = exp(t A/d) q(0). It starts from rest, and so is late by I/d, with its moment
/// of inertia I; xpbd, of first order, by a step.
#[test]
fn upright_chains_on_dampers_creep_as_fast_as_those_let_them() {
    let (lean, time) = (1e-3, 60.0);
    for links in [2, 4, 10, 30] {
        let trace: f64 = (0..links)
            .map(|i| {
                let mut unit = vec![0.0; links];
                unit[i] = 1.0;
                toppling(&unit)[i]
            })
            .sum();
        // No mode of A grows faster than its trace: by a factor e at most.
        let damping = trace * time;
        let mut parts = chain(links, Start::Upright).unwrap().into_parts();
        for joint in &mut parts.joints {
            joint.dofs[0].drive = Drive {
                damping,
                ..Drive::default()
            };
        }
        let model = Model::new(parts).unwrap();
        let upright = model.initial_position();
        let mut q = upright.clone();
        q[0] += lean;
        let mut simulation = XPBD.simulate::<f64>(&model, 2.0 * H);
        simulation
            .set_joint_state(0, &q, &vec![0.0; links])
            .unwrap();
        simulation.step((time / (2.0 * H)).round() as usize);
        let mut term: Vec<f64> = q.iter().zip(&upright).map(|(q, q0)| q - q0).collect();
        let mut expected = term.clone();
        for k in 1..20 {
            let next = toppling(&term);
            term = next
                .iter()
                .map(|x| x * time / damping / f64::from(k))
                .collect();
            expected.iter_mut().zip(&term).for_each(|(q, x)| *q += x);
        }
        let found = simulation.outputs().joint_position(0);
        let inertia = links as f64 * CHAIN_LINK_MASS * CHAIN_LENGTH * CHAIN_LENGTH / 3.0;
        let late = inertia / damping + 2.0 * H;
        for (i, expected) in expected.iter().enumerate() {
            let what = format!("{links} links on dampers, joint {i}");
            let turned = (found[i] - upright[i]).rem_euclid(TAU);
            let turned = if turned > TAU / 2.0 {
                turned - TAU
            } else {
                turned
            };
            // No angle grows faster than by e × lean in the time.
            close(what, turned, *expected, late / time * 3.0 * lean);
        }
    }
}
