//! Closed loops and couplings, of all solvers that have them.

use crate::common::*;
use glam::{DVec2, DVec3};
use kinetarium_sim::{Effort, Simulation};
use model::{BodyId, Builder, Drive, JointId, Model, Pose};

const H: f64 = 1e-3;

/// Crank, coupler and rocker [m]; the ground between the pivots is 1 m.
const FOUR_BAR: [f64; 3] = [0.3, 0.9, 0.7];

/// Where coupler and rocker meet for a crank angle: the upper crossing of two circles.
fn meeting_point(crank: f64) -> DVec2 {
    let [a, b, c] = FOUR_BAR;
    let (from, to) = (DVec2::from_angle(crank) * a, DVec2::X);
    let d = to - from;
    let along = (b * b - c * c + d.length_squared()) / (2.0 * d.length());
    let across = (b * b - along * along).sqrt();
    from + d.normalize() * along + d.normalize().perp() * across
}

fn angle(from: DVec2, to: DVec2) -> f64 {
    (to - from).to_angle()
}

/// A four-bar linkage whose crank is driven at one turn a second.
fn four_bar(start: f64) -> Model {
    let [a, b, c] = FOUR_BAR;
    let mut world = Builder::new("four-bar");
    let object = world.object("");
    let mut bar = |name: &str, length: f64| {
        let across = length * length / 12.0;
        let moments = DVec3::new(1e-3, across, across);
        body(
            object,
            name,
            1.0,
            DVec3::new(length / 2.0, 0.0, 0.0),
            moments,
        )
    };
    let (crank, coupler, rocker) = (bar("crank", a), bar("coupler", b), bar("rocker", c));
    let [_, bend, swing] = four_bar_angles(start);
    let motor = Drive {
        damping: 1e5,
        target_velocity: TURN,
        ..Drive::default()
    };
    object
        .revolute("motor", crank, DVec3::Z)
        .drive(motor)
        .initial(&[start]);
    let end = |length: f64| Pose::at(DVec3::new(length, 0.0, 0.0));
    let knee = object.revolute("knee", coupler, DVec3::Z);
    knee.parent(crank)
        .frames(end(a), Pose::IDENTITY)
        .initial(&[bend]);
    let pivot = object.revolute("pivot", rocker, DVec3::Z);
    pivot.frames(end(1.0), Pose::IDENTITY).initial(&[swing]);
    let loop_joint = object.revolute("loop", rocker, DVec3::Z);
    loop_joint
        .parent(coupler)
        .frames(end(b), end(c))
        .closes_loop(true);
    world.build().unwrap()
}

const TURN: f64 = std::f64::consts::TAU;

/// Angles of crank, knee and pivot for a crank angle.
fn four_bar_angles(crank: f64) -> [f64; 3] {
    let top = meeting_point(crank);
    let bend = angle(DVec2::from_angle(crank) * FOUR_BAR[0], top) - crank;
    [crank, bend, angle(DVec2::X, top)]
}

/// The rocker of a four-bar linkage is where plane geometry has it for the crank's angle, for two
/// turns. What one pass leaves open of a loop is of the order of the way of a substep's
/// accelerations, h² (g + a ω² + …): the error vanishes like h². In impulse each of four joints is a
/// spring of an eighth of the frequency of small steps, (8 / 2π)² times as soft. In featherstone one joint alone is not
/// part of the tree, and gapes by the third order of a step's way.
#[test]
fn four_bar_linkage_follows_its_geometry() {
    let model = four_bar(1.0);
    let (after, before) = (four_bar_angles(1.0 + 1e-5), four_bar_angles(1.0 - 1e-5));
    let speeds = [0, 1, 2].map(|i| (after[i] - before[i]) / 2e-5 * TURN);
    let worst = |method: Method, h: f64| {
        let mut simulation = method.simulate::<f64>(&model, h);
        simulation
            .set_joint_state(0, &four_bar_angles(1.0), &speeds)
            .unwrap();
        let (mut of_rocker, mut turned): (f64, f64) = (0.0, 0.0);
        for _ in 0..(2.0 / h) as usize {
            simulation.step(1);
            let outputs = simulation.outputs();
            let q = outputs.joint_position(0);
            turned += outputs.joint_velocity(0)[0] * h;
            of_rocker = of_rocker.max((q[2] - four_bar_angles(q[0])[2]).abs());
            let [coupler, rocker] = [1, 2].map(|b| outputs.body_pose(0, BodyId(b)));
            let gap = coupler.point(DVec3::X * FOUR_BAR[1]) - rocker.point(DVec3::X * FOUR_BAR[2]);
            let accelerations = G + FOUR_BAR[0] * TURN * TURN;
            let give = match method {
                EULER => 10.0 * h,
                IMPULSE => 16.0,
                _ => 2.0,
            };
            assert!(
                gap.length() < give * h * h * accelerations,
                "{method:?}: the loop gapes {gap}"
            );
        }
        assert!(turned > 1.9 * TURN, "the crank turned by {turned} only");
        of_rocker
    };
    for (method, order) in [(EULER, 3.0), (XPBD, 2.0), (IMPULSE, 2.0)] {
        vanishes(format!("{method:?} four-bar"), order, 0.3, 5e-4, |h| {
            worst(method, h)
        });
    }
}

/// A ball that closes a loop has no coordinates, so that nothing acts along them, were it the last joint.
#[test]
fn a_ball_in_a_loop_has_no_effort() {
    let mut world = Builder::new("triangle");
    let object = world.object("");
    let upper = body(object, "upper", 1.0, DVec3::ZERO, DVec3::ONE);
    let lower = body(object, "lower", 1.0, DVec3::ZERO, DVec3::ONE);
    object.revolute("first", upper, DVec3::Z);
    let second = object.revolute("second", lower, DVec3::Z);
    second
        .parent(upper)
        .frames(Pose::at(DVec3::X), Pose::IDENTITY);
    let loop_joint = object.ball("loop", lower);
    loop_joint
        .frames(Pose::at(DVec3::X + DVec3::Y), Pose::at(DVec3::Y))
        .closes_loop(true);
    let mut simulation = EULER.simulate::<f64>(&world.build().unwrap(), H);
    let forces = simulation.observe(|simulation, outputs| {
        let (world, id) = (0, JointId(2));
        let effort = Effort {
            simulation,
            outputs,
            world,
        };
        let mut of_joint = Vec::new();
        effort.of_joint(id, |force| of_joint.push(force));
        (of_joint, effort.of_drive(id, 0))
    });
    assert_eq!(forces.unwrap(), (vec![], 0.0));
}

/// Two wheels geared as q₁ = offset + ratio q₂, pushed at one: together they have the inertia
/// I₂ + ratio² I₁ along q₂; and as the relation is linear, it is kept to rounding.
#[test]
fn gears_keep_their_ratio() {
    let (ratio, offset, push) = (2.5, 0.1, 1.3);
    let mut world = Builder::new("gears");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let small = body(
        object,
        "small",
        1.0,
        DVec3::ZERO,
        DVec3::new(0.15, 0.15, 0.2),
    );
    let large = body(object, "large", 1.0, DVec3::ZERO, DVec3::new(0.5, 0.5, 0.9));
    let follower = object
        .revolute("follower", small, DVec3::Z)
        .initial(&[offset])
        .handle();
    let leader = object.revolute("leader", large, DVec3::Z).handle();
    object.couple("gear", follower, leader, ratio, offset);
    let model = world.build().unwrap();
    for method in [EULER, XPBD] {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation.controls().set_force(0, &[0.0, push]).unwrap();
        let n = 1000;
        let acceleration = push / (0.9 + ratio * ratio * 0.2);
        for _ in 0..n {
            simulation.step(1);
            let q = simulation.outputs().joint_position(0);
            assert!((q[0] - offset - ratio * q[1]).abs() < 1e-12, "{q:?}");
        }
        let expected = acceleration * H * H * (n * (n + 1)) as f64 / 2.0;
        let leader = simulation.outputs().joint_position(0)[1];
        close(format!("leader, {method:?}"), leader, expected, 1e-10);
    }
}

/// The joints of a finger are coupled, and share a link: with xpbd the ratio then holds to second order, and
/// more passes bring it closer; with featherstone it holds to rounding.
#[test]
fn coupled_joints_of_one_chain_keep_their_ratio() {
    let mut world = Builder::new("finger");
    let object = world.object("");
    let mut bone = |name: &str| {
        body(
            object,
            name,
            0.2,
            DVec3::new(0.2, 0.0, 0.0),
            DVec3::new(1e-3, 3e-3, 3e-3),
        )
    };
    let (near_bone, far_bone) = (bone("near"), bone("far"));
    let leader = object.revolute("knuckle", near_bone, DVec3::Z).handle();
    let tip = object.revolute("tip", far_bone, DVec3::Z);
    let end = Pose::at(DVec3::new(0.4, 0.0, 0.0));
    let follower = tip.parent(near_bone).frames(end, Pose::IDENTITY).handle();
    object.couple("tendon", follower, leader, 0.7, 0.0);
    let model = world.build().unwrap();
    let worst = |method: Method, iterations: usize, h: f64| {
        let mut settings = method.settings(1, h);
        settings.step.iterations = iterations;
        let mut simulation = Simulation::<f64>::new(model.clone(), settings).unwrap();
        let mut worst: f64 = 0.0;
        for _ in 0..(2.0 / h) as usize {
            simulation.step(1);
            let q = simulation.outputs().joint_position(0);
            worst = worst.max((q[1] - 0.7 * q[0]).abs());
        }
        worst
    };
    let (one, ten) = (worst(XPBD, 1, H), worst(XPBD, 10, H));
    assert!(ten < 0.2 * one, "one pass {one:e}, ten {ten:e}");
    vanishes("tendon", 2.0, 0.3, H, |h| worst(XPBD, 1, h));
    close("tendon, featherstone", worst(EULER, 1, H), 0.0, 1e-12);
}

/// The same model with its last joint switched off.
fn let_go(model: &Model) -> Model {
    let mut parts = model.clone().into_parts();
    parts.joints.last_mut().unwrap().enabled = false;
    Model::new(parts).unwrap()
}

/// One world's sling is let go in mid-swing: the stone flies on in a parabola, and the neighbours swing on to the bit.
#[test]
fn a_sling_lets_go_at_run_time() {
    let mut world = Builder::new("sling");
    let object = world.object("");
    let stone = body(object, "stone", 0.3, DVec3::ZERO, DVec3::splat(1e-3));
    object
        .free("flight", stone)
        .initial(&[0.5, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
    object.distance("sling", stone, 0.5);
    let model = world.build().unwrap();
    for method in [EULER, XPBD] {
        let worlds = || {
            let mut simulation =
                Simulation::<f64>::new(model.clone(), method.settings(3, H)).unwrap();
            simulation.step(300);
            simulation
        };
        let (mut untouched, mut simulation) = (worlds(), worlds());
        simulation.set_world_model(1, &let_go(&model)).unwrap();
        let outputs = simulation.outputs();
        let (p, v) = (
            outputs.body_position(1, BodyId(0)),
            outputs.body_velocity(1, BodyId(0)),
        );
        let n = 500;
        simulation.step(n);
        untouched.step(n);
        let fallen = 0.5 * G * H * H * (n * (n + 1)) as f64;
        let flown = p + v * n as f64 * H - DVec3::Y * fallen;
        let found = simulation.outputs().body_position(1, BodyId(0));
        near(format!("{method:?}"), found, flown, 1e-10);
        let (force, _) = simulation.outputs().reaction(1, JointId(1));
        near(format!("{method:?}, force"), force, DVec3::ZERO, 1e-12);
        for world in [0, 2] {
            let swings = |s: &mut Simulation<f64>| s.outputs().body_position(world, BodyId(0));
            assert_eq!(swings(&mut simulation), swings(&mut untouched));
        }
    }
}
