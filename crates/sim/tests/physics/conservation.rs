//! What nothing may change: energy, momentum, rest.

use crate::common::*;
use glam::{DQuat, DVec3};
use kinetarium_sim::Simulation;
use model::examples::{CHAIN_LENGTH, CHAIN_LINK_MASS, Start, chain};
use model::{Axis, BodyId, Builder, Drive, Model, Pose};
use numbers::Float;

const LINKS: [usize; 4] = [2, 4, 10, 30];

/// What users run: single precision, 2 ms.
const STEP: f64 = 2e-3;

/// Work of gravity on a whole chain that falls from upright to hanging [J].
fn scale(links: usize) -> f64 {
    links as f64 * CHAIN_LINK_MASS * G * CHAIN_LENGTH
}

/// Largest energy gained and lost, relative to [`scale`], over a time [s], watched 32 times.
fn energy_change<T: Float>(simulation: &mut Simulation<T>, time: f64) -> (f64, f64) {
    let h = simulation.settings().step.time_step;
    let scale = scale(simulation.model().bodies.len());
    let before = simulation.outputs().energy(0);
    let (mut gained, mut lost): (f64, f64) = (0.0, 0.0);
    for _ in 0..32 {
        simulation.step((time / h / 32.0).round() as usize);
        let change = (simulation.outputs().energy(0) - before) / scale;
        (gained, lost) = (gained.max(change), lost.max(-change));
    }
    (gained, lost)
}

/// Chains let go horizontally: what energy is gained or lost vanishes like the method's order.
#[test]
fn energy_drifts_by_the_order_of_the_method() {
    for links in LINKS {
        let model = chain(links, Start::Horizontal).unwrap();
        for (method, order, h) in [
            (EULER, 1.0, 1.0 / 4096.0),
            (XPBD, 1.0, 1.0 / 4096.0),
            (RK4, 4.0, 1.0 / 512.0),
        ] {
            let drift = |h: f64| {
                let (gained, lost) = energy_change(&mut method.simulate::<f64>(&model, h), 0.5);
                gained.max(lost)
            };
            vanishes(format!("{links} {method:?}"), order, 0.2, h, drift);
        }
    }
}

/// By how much the energy that xpbd reports of a chain may vary, relative to [`scale`]: velocities are
/// half a substep h [s] late, during which the weight of a chain that has fallen from a height [m]
/// works, ½ h M g √(2 g height).
fn half_a_substep(h: f64, height: f64) -> f64 {
    0.5 * h * (2.0 * G * height).sqrt() / CHAIN_LENGTH
}

/// What users run: let go horizontally, single precision, steps of 2 ms, 2 s. The bounds leave room
/// for a factor of two to three; how they shrink with the step is tested above. Runge–Kutta is at
/// the rounding of single precision.
#[test]
fn energy_of_n_pendula_in_single_precision() {
    for (links, most) in LINKS.into_iter().zip([0.01, 0.03, 0.1, 0.3]) {
        let model = chain(links, Start::Horizontal).unwrap();
        let change =
            |method: Method| energy_change(&mut method.simulate::<f32>(&model, STEP), 2.048);
        let (gained, lost) = change(EULER);
        close(format!("{links} links, Euler"), gained.max(lost), 0.0, most);
        let (gained, lost) = change(RK4);
        close(
            format!("{links} links, Runge–Kutta"),
            gained.max(lost),
            0.0,
            2e-5,
        );
        let (gained, lost) = change(Method::Xpbd(4));
        let most = half_a_substep(STEP / 4.0, CHAIN_LENGTH);
        close(format!("{links} links, xpbd"), gained.max(lost), 0.0, most);
        // What moves across its joints within a small step is lost; by more links, more.
        let (gained, lost) = change(Method::Impulse(8));
        let most = half_a_substep(STEP / 8.0, CHAIN_LENGTH);
        close(format!("{links} links, impulse, gained"), gained, 0.0, most);
        close(format!("{links} links, impulse, lost"), lost, 0.0, 0.01);
    }
}

/// A chain of 30 that is let go cracks like a whip at 300 rad/s, over and over; small steps take energy
/// from it, and never give any. So for a star of twelve rods on a light hub, which turns for ever.
#[test]
fn impulses_give_no_energy() {
    let impulse = Method::Impulse(8);
    let mut whip = impulse.simulate::<f32>(&chain(30, Start::Horizontal).unwrap(), STEP);
    let (gained, _) = energy_change(&mut whip, 20.48);
    let most = half_a_substep(STEP / 8.0, CHAIN_LENGTH);
    close("whip", gained, 0.0, most);
    let mut world = Builder::new("star");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let hub = body(object, "hub", 0.1, DVec3::ZERO, DVec3::splat(1e-4));
    for i in 0..12 {
        let turn = DQuat::from_rotation_z(i as f64 / 12.0 * std::f64::consts::TAU);
        let rod = body(
            object,
            &format!("rod{i}"),
            0.3,
            DVec3::Y * 0.1,
            DVec3::new(1e-3, 1e-4, 1e-3),
        );
        let socket = Pose::new(turn * (DVec3::Y * 0.05), turn);
        object
            .ball(format!("socket{i}"), rod)
            .parent(hub)
            .frames(socket, Pose::IDENTITY);
    }
    let model = world.build().unwrap();
    let mut star = impulse.simulate::<f64>(&model, STEP);
    let dofs = model.degrees_of_freedom();
    let velocity: Vec<f64> = (0..dofs)
        .map(|i| 3.0 * (1.7 * i as f64 + 0.4).sin())
        .collect();
    star.set_joint_state(0, &model.initial_position(), &velocity)
        .unwrap();
    let before = star.outputs().energy(0);
    for _ in 0..20 {
        star.step(500);
        let energy = star.outputs().energy(0);
        close("star", energy / before, 1.0, 1e-3);
    }
}

/// Balanced upright, a chain leaves its place by rounding alone, and crumples: 30 links at hundreds
/// of rad/s, which steps of 2 ms are too long for, but not steps of 1/8 ms. xpbd gains no energy
/// at any step, but for what half a substep makes.
#[test]
fn energy_of_n_pendula_that_fall_from_upright() {
    for links in LINKS {
        let model = chain(links, Start::Upright).unwrap();
        let change =
            |method: Method, h: f64| energy_change(&mut method.simulate::<f32>(&model, h), 2.048);
        let (gained, lost) = change(RK4, STEP / 16.0);
        close(
            format!("{links} links, Runge–Kutta"),
            gained.max(lost),
            0.0,
            1e-3,
        );
        for h in [STEP, STEP / 16.0] {
            let (gained, _) = change(XPBD, h);
            let most = half_a_substep(h, 2.0 * CHAIN_LENGTH);
            close(format!("{links} links, xpbd, gained"), gained, 0.0, most);
            let (gained, _) = change(Method::Impulse(8), h);
            let most = half_a_substep(h / 8.0, 2.0 * CHAIN_LENGTH);
            close(format!("{links} links, impulse, gained"), gained, 0.0, most);
        }
    }
}

/// Largest distance of any body from where it started in 60 s, and largest speed in the last second.
fn unrest(simulation: &mut Simulation<f32>) -> (f64, f64) {
    let bodies = simulation.model().bodies.len();
    let at = |simulation: &mut Simulation<f32>| -> Vec<(DVec3, DVec3)> {
        let outputs = simulation.outputs();
        let ids = (0..bodies).map(BodyId);
        ids.map(|b| (outputs.body_position(0, b), outputs.body_velocity(0, b)))
            .collect()
    };
    let start = at(simulation);
    let (mut way, mut speed): (f64, f64) = (0.0, 0.0);
    for _ in 0..60 {
        simulation.step((1.0 / STEP).round() as usize);
        speed = 0.0;
        for ((from, _), (to, v)) in start.iter().zip(at(simulation)) {
            (way, speed) = (way.max(to.distance(*from)), speed.max(v.length()));
        }
    }
    (way, speed)
}

/// How far rounding moves a chain at rest in xpbd [m]: positions of up to 3 m are rounded a dozen
/// times in a substep.
const ROUNDING: f64 = 12.0 * f32::EPSILON as f64 * CHAIN_LENGTH;

/// Speeds [m/s] that this makes: what moves a body in a substep also changes its velocity.
fn noise(substeps: usize) -> f64 {
    ROUNDING / (STEP / substeps as f64)
}

#[test]
fn hanging_chains_stay_put() {
    for links in LINKS {
        let model = chain(links, Start::Hanging).unwrap();
        assert_eq!(unrest(&mut EULER.simulate(&model, STEP)), (0.0, 0.0));
        let (way, speed) = unrest(&mut Method::Xpbd(4).simulate(&model, STEP));
        close(format!("{links} links: way"), way, 0.0, ROUNDING);
        close(format!("{links} links: speed"), speed, 0.0, noise(4));
    }
}

/// An upright chain whose drives hold all joints where they start.
fn held(links: usize, stiffness: f64, damping: f64) -> Model {
    let mut parts = chain(links, Start::Upright).unwrap().into_parts();
    for joint in &mut parts.joints {
        let target_position = joint.initial[0];
        joint.dofs[0].drive = Drive {
            stiffness,
            damping,
            target_position,
            ..Drive::default()
        };
    }
    Model::new(parts).unwrap()
}

/// A chain of n links of length l and mass m on springs k buckles under its weight where
/// n m g/L · L³/(k l) > 7.84 (Greenhill 1881): at k = 3400 N·m/rad for 30 links, far below what
/// holds it here. On dampers d alone it sinks at a rate of m g L n/2 d at most, 0.004 1/s; from
/// the rounding of π, 1e-7, no further than a micrometre in 60 s.
#[test]
fn upright_chains_held_by_stiff_targets_stay_put() {
    for links in LINKS {
        for (stiffness, damping) in [(1e5, 1e3), (1e6, 0.0), (0.0, 1e5)] {
            let model = held(links, stiffness, damping);
            let (way, speed) = unrest(&mut EULER.simulate(&model, STEP));
            let what = format!("{links} links, k = {stiffness}, d = {damping}");
            close(format!("{what}: way"), way, 0.0, 1e-5);
            close(format!("{what}: speed"), speed, 0.0, 1e-5);
            for substeps in [1, 4] {
                let what = format!("{what}, xpbd, {substeps} substeps");
                let method = Method::Xpbd(substeps);
                let (way, speed) = unrest(&mut method.simulate(&model, STEP));
                // What nothing damps swings on with what rounding feeds it.
                let swings = if damping == 0.0 { 2.0 } else { 1.0 };
                close(format!("{what}: way"), way, 0.0, swings * ROUNDING);
                close(
                    format!("{what}: speed"),
                    speed,
                    0.0,
                    swings * noise(substeps),
                );
            }
        }
    }
}

/// A chain that floats freely: ten rods on ball joints and hinges, without gravity.
fn floating_chain() -> Model {
    let mut world = Builder::new("floating chain");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let end = Pose::at(DVec3::new(0.15, 0.0, 0.0));
    let mut parent = None;
    for i in 0..10 {
        let moments = DVec3::new(0.002, 0.01, 0.009);
        let rod = body(
            object,
            &format!("rod{i}"),
            1.0 + 0.1 * i as f64,
            DVec3::ZERO,
            moments,
        );
        if let Some(parent) = parent {
            let joint = match i % 3 {
                0 => object.ball(format!("joint{i}"), rod),
                1 => object.revolute(format!("joint{i}"), rod, DVec3::Z),
                _ => object.revolute(format!("joint{i}"), rod, DVec3::Y),
            };
            joint.parent(parent).frames(end, end.inverse());
        } else {
            object.free("flight", rod);
        }
        parent = Some(rod);
    }
    world.build().unwrap()
}

/// Bodies that float freely, without gravity: a tree with joints of every kind, laws along their
/// coordinates, a coupling, and a soft stay across.
fn floating_tree() -> Model {
    let mut world = Builder::new("floating tree");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let end = Pose::at(DVec3::new(0.15, 0.0, 0.0));
    let (mut parent, mut hinges) = (None, Vec::new());
    for i in 0..10 {
        let moments = DVec3::new(0.002, 0.01, 0.009);
        let name = format!("rod{i}");
        let rod = body(object, &name, 1.0 + 0.1 * i as f64, DVec3::ZERO, moments);
        let name = format!("joint{i}");
        let universal = [Axis::angular(DVec3::Y), Axis::angular(DVec3::Z)];
        let slides = [Axis::linear(DVec3::X), Axis::angular(DVec3::Y)];
        let Some((first, last)) = parent else {
            object.free("flight", rod);
            parent = Some((rod, rod));
            continue;
        };
        let joint = match i {
            1 => object.ball(name, rod).damping(0.02),
            2 => object.prismatic(name, rod, DVec3::X).spring(100.0, 0.0),
            3 | 4 => object.revolute(name, rod, DVec3::Z),
            5 => object.d6(name, rod, &universal),
            6 => object.d6(name, rod, &slides).spring(30.0, 0.0),
            7 => object.fixed(name, rod),
            8 => object
                .revolute(name, rod, DVec3::Y)
                .spring(5.0, 0.1)
                .damping(0.1),
            _ => object.revolute(name, rod, DVec3::Z),
        };
        // All but the last from end to end; that on the first one.
        let joint = joint.parent(if i < 9 { last } else { first });
        let handle = joint.frames(end, end.inverse()).handle();
        if i == 3 || i == 4 {
            hinges.push(handle);
        }
        if i == 5 {
            let stay = object.distance("stay", rod, 1.5).parent(first);
            stay.frames(end, end).compliance(1e-3, 0.0);
        }
        parent = Some((first, rod));
    }
    object.couple("teeth", hinges[1], hinges[0], -2.0, 0.0);
    world.build().unwrap()
}

/// Relative change of linear and angular momentum over 2 s of a model that tumbles.
fn momentum_change<T: Float>(model: &Model, method: Method, h: f64) -> (f64, f64) {
    let mut simulation = method.simulate::<T>(model, h);
    let velocity: Vec<f64> = (0..model.degrees_of_freedom())
        .map(|i| (1.7 * i as f64 + 0.4).sin())
        .collect();
    simulation
        .set_joint_state(0, &model.initial_position(), &velocity)
        .unwrap();
    let start = (
        simulation.outputs().momentum(0),
        simulation.outputs().angular_momentum(0),
    );
    let (mut linear, mut angular): (f64, f64) = (0.0, 0.0);
    for _ in 0..20 {
        simulation.step((0.1 / h).round() as usize);
        let outputs = simulation.outputs();
        linear = linear.max(outputs.momentum(0).distance(start.0) / start.0.length());
        angular = angular.max(outputs.angular_momentum(0).distance(start.1) / start.1.length());
    }
    (linear, angular)
}

/// xpbd and impulse keep linear and angular momentum to rounding, ten a step or small step at most. Reduced coordinates keep
/// both to the order of the method.
#[test]
fn momentum_of_a_floating_chain() {
    let (h, model) = (1e-3, floating_chain());
    let roundings = 2.0 / h * 10.0;
    for (what, model) in [("chain", &model), ("tree", &floating_tree())] {
        let (linear, angular) = momentum_change::<f64>(model, XPBD, h);
        let most = roundings * f64::EPSILON;
        close(format!("xpbd, {what}"), linear, 0.0, most);
        close(format!("xpbd, {what}, angular"), angular, 0.0, most);
        let (linear, angular) = momentum_change::<f32>(model, XPBD, h);
        let most = roundings * f64::from(f32::EPSILON);
        close(format!("xpbd, {what} in f32"), linear, 0.0, most);
        close(format!("xpbd, {what} in f32, angular"), angular, 0.0, most);
    }
    for method in [IMPULSE, Method::Impulse(8)] {
        let (linear, angular) = momentum_change::<f64>(&model, method, h);
        let most = roundings * 8.0 * f64::EPSILON;
        close(format!("{method:?}"), linear, 0.0, most);
        close(format!("{method:?}, angular"), angular, 0.0, most);
        let (linear, angular) = momentum_change::<f32>(&model, method, h);
        let most = roundings * 8.0 * f64::from(f32::EPSILON);
        close(format!("{method:?} in f32"), linear, 0.0, most);
        close(format!("{method:?} in f32, angular"), angular, 0.0, most);
    }
    let (linear, angular) = momentum_change::<f64>(&model, RK4, h);
    close("Runge–Kutta", linear, 0.0, 1e-11);
    close("Runge–Kutta, angular", angular, 0.0, 1e-11);
    vanishes("Runge–Kutta", 4.0, 0.3, 4.0 * h, |h| {
        momentum_change::<f64>(&model, RK4, h).1
    });
    vanishes("Euler", 1.0, 0.1, h, |h| {
        momentum_change::<f64>(&model, EULER, h).1
    });
}
