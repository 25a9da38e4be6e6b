//! Closed loops and couplings, of all solvers that have them.

use crate::common::*;
use glam::{DVec2, DVec3};
use kinetarium_sim::{Effort, Simulation};
use model::{BodyId, Builder, Drive, JointId, Model, Pose};
use numbers::Float;

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

/// Mass [kg] and length [m] of a rope's links.
const LINK: (f64, f64) = (0.03, 0.1);

/// A rope of thin rods along x, with hinges about z or balls between them, whose far end is held at `span`. It starts as a
/// V, so that its end is there.
fn rope(links: usize, balls: bool, span: f64, damping: f64) -> Model {
    let (mass, length) = LINK;
    let across = mass * length * length / 12.0;
    let moments = DVec3::new(1e-3 * across, across, across);
    let mut world = Builder::new("rope");
    let object = world.object("");
    let slope = (span / (links as f64 * length)).min(1.0).acos();
    let end = Pose::at(DVec3::X * length);
    let mut parent = None;
    for i in 0..links {
        let rod = body(
            object,
            &format!("rod{i}"),
            mass,
            DVec3::X * length / 2.0,
            moments,
        );
        let turn = match i {
            0 => -slope,
            _ if 2 * i == links => 2.0 * slope,
            _ => 0.0,
        };
        let joint = if balls {
            object.ball(format!("joint{i}"), rod)
        } else {
            object.revolute(format!("joint{i}"), rod, DVec3::Z)
        };
        if !balls {
            joint.initial(&[turn]);
        }
        joint.damping(damping);
        if let Some(parent) = parent.replace(rod) {
            joint.parent(parent).frames(end, Pose::IDENTITY);
        }
    }
    let held = object.ball("held", parent.unwrap());
    held.frames(Pose::at(DVec3::X * span), end)
        .closes_loop(true);
    world.build().unwrap()
}

/// Where the links of a rope begin, and its end.
fn shape<T: Float>(simulation: &mut Simulation<T>, links: usize) -> Vec<DVec3> {
    let outputs = simulation.outputs();
    let poses: Vec<_> = (0..links)
        .map(|i| outputs.body_pose(0, BodyId(i)))
        .collect();
    let end = poses[links - 1].point(DVec3::X * LINK.1);
    poses.iter().map(|p| p.position).chain([end]).collect()
}

/// A taut rope is where its constraint moves nothing to first order. It does not leave its line by more than a few
/// hundredths, gains no energy, and holds at both ends.
fn stays_taut<T: Float>(links: usize, balls: bool, damping: f64) {
    let length = links as f64 * LINK.1;
    let mut simulation = EULER.simulate::<T>(&rope(links, balls, length, damping), 2e-3);
    let start = simulation.outputs().energy(0);
    for _ in 0..400 {
        simulation.step(5);
        let energy = simulation.outputs().energy(0);
        assert!(
            energy < start + 1e-4,
            "{links} {balls} {damping}: {start} {energy}"
        );
        let shape = shape(&mut simulation, links);
        let sag = shape.iter().map(|p| -p.y).fold(0.0, f64::max);
        assert!(
            sag < 0.03 * length,
            "{links} {balls} {damping}: sags by {sag}"
        );
        let gap = shape[links].distance(DVec3::X * length);
        assert!(
            gap < 2e-3 * length,
            "{links} {balls} {damping}: gapes by {gap}"
        );
    }
    assert!(simulation.diverged().is_empty());
}

#[test]
fn taut_ropes_stay_taut() {
    for links in [2, 3, 4, 10] {
        for balls in [false, true] {
            for damping in [0.0, 1e-3] {
                stays_taut::<f64>(links, balls, damping);
                stays_taut::<f32>(links, balls, damping);
            }
        }
    }
}

/// A rope with slack hangs as a chain of rods does: with the weight w of a rod and the pull H along x, moments about a rod's
/// end give tan θₖ = (k − (n − 1)/2) w/H, and the span, n L mean cos θₖ, gives H. Also where there is hardly any slack.
#[test]
fn a_slack_rope_hangs_as_a_chain_of_rods() {
    let links = 10;
    let length = links as f64 * LINK.1;
    for share in [0.8, 0.99, 0.9999] {
        let span = share * length;
        let slope = |k: usize, steep: f64| (k as f64 - (links - 1) as f64 / 2.0) * steep;
        let reach = |steep: f64| -> f64 {
            let cosines = (0..links).map(|k| slope(k, steep).atan().cos());
            cosines.sum::<f64>() * LINK.1
        };
        let (mut low, mut high) = (0.0, 10.0);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if reach(middle) > span {
                low = middle;
            } else {
                high = middle;
            }
        }
        let mut simulation = EULER.simulate::<f64>(&rope(links, false, span, 2e-3), 1e-3);
        simulation.step(20_000);
        let found = shape(&mut simulation, links);
        let mut expected = DVec3::ZERO;
        for (k, found) in found.iter().enumerate() {
            near(format!("{share}, end of rod {k}"), *found, expected, 1e-6);
            let angle = slope(k, low).atan();
            expected += DVec3::new(angle.cos(), angle.sin(), 0.0) * LINK.1;
        }
    }
}

/// An arm and a body that floats, which are welded 0.14 m apart: what closes the weld moves neither faster than 1 m/s
/// requires, and is taken back when it is closed, but for a share of ½ m v² where directions turned on the way. Without
/// gravity, which closing would work against.
#[test]
fn an_open_weld_closes_without_gaining_energy() {
    let mut world = Builder::new("weld");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let moments = DVec3::new(1e-4, 4e-3, 4e-3);
    let near_bone = body(object, "near", 0.5, DVec3::X * 0.15, moments);
    let far_bone = body(object, "far", 0.5, DVec3::X * 0.15, moments);
    let end = Pose::at(DVec3::X * 0.3);
    object.revolute("shoulder", near_bone, DVec3::Z);
    let elbow = object.revolute("elbow", far_bone, DVec3::Z);
    elbow.parent(near_bone).frames(end, Pose::IDENTITY);
    let ball = body(object, "ball", 1.0, DVec3::ZERO, DVec3::splat(4e-3));
    object
        .free("float", ball)
        .initial(&[0.7, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let weld = object.fixed("weld", ball);
    weld.parent(far_bone)
        .frames(end, Pose::IDENTITY)
        .closes_loop(true);
    let model = world.build().unwrap();
    for h in [2e-3, 1e-3] {
        let mut simulation = EULER.simulate::<f64>(&model, h);
        let start = simulation.outputs().energy(0);
        let mut most = start;
        let gap = |simulation: &mut Simulation<f64>| {
            let outputs = simulation.outputs();
            let [arm, ball] = [1, 2].map(|b| outputs.body_pose(0, BodyId(b)));
            arm.point(DVec3::X * 0.3).distance(ball.position)
        };
        let mut last = gap(&mut simulation);
        for _ in 0..(0.3 / h) as usize {
            simulation.step(1);
            most = most.max(simulation.outputs().energy(0));
            let gap = gap(&mut simulation);
            assert!(gap < last.max(5e-5), "{h}: {last} {gap}");
            assert!(last - gap < 1.1 * h, "{h}: {last} {gap}");
            last = gap;
        }
        let end = simulation.outputs().energy(0);
        assert!(last < 5e-5, "{h}: gapes by {last}");
        assert!(end < 0.3 * most, "{h}: of {most} J remain {end}");
        // All of it at 1 m/s, and half as much for what turns.
        assert!(most < start + 1.5, "{h}: {start} J was {most}");
    }
}

/// A box of 8 kg that floats, 0.2 m from the point of the world that its top is tied to: it comes at a pace, and is not left
/// with a fast spin, as where it took the way within a step.
#[test]
fn a_loop_that_begins_open_closes_at_a_pace() {
    let mut world = Builder::new("open");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let boxed = body(object, "box", 8.0, DVec3::ZERO, DVec3::splat(0.053));
    let initial = [0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    object.free("float", boxed).initial(&initial);
    let at = Pose::at(DVec3::Z * 0.1);
    let tie = object.ball("tie", boxed);
    tie.frames(at, at).closes_loop(true);
    let model = world.build().unwrap();
    for method in [EULER, Method::Xpbd(4), IMPULSE, Method::Impulse(8)] {
        let mut simulation = method.simulate::<f64>(&model, 2e-3);
        simulation.step(500);
        let outputs = simulation.outputs();
        let speeds = [0, 1, 2, 3, 4, 5].map(|i| outputs.dof_velocity(0, i).abs());
        let fastest = speeds.into_iter().fold(0.0, f64::max);
        let pose = simulation.outputs().body_pose(0, BodyId(0));
        let gap = pose.point(DVec3::Z * 0.1).distance(DVec3::Z * 0.1);
        assert!(gap < 1e-4, "{method:?}: gapes by {gap}");
        println!("{method:?}: gapes by {gap}, is left with {fastest}");
        // 1 m/s over its lever of 0.1 m.
        assert!(fastest < 10.0, "{method:?}: {fastest}");
    }
}

/// A body that is tied by a lever, and begins to spin about its centre of mass, fast: what that makes the loop gape by goes
/// at once.
#[test]
fn a_loop_whose_body_spins_fast_stays_closed() {
    for (lever, spin) in [(0.3, 300.0), (0.3, 400.0)] {
        let mut world = Builder::new("spinning");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let bob = body(object, "bob", 1.0, DVec3::ZERO, DVec3::splat(0.01));
        object.free("float", bob);
        let tie = object.ball("tie", bob);
        let at = Pose::at(DVec3::X * -lever);
        tie.frames(at, at).closes_loop(true);
        let model = world.build().unwrap();
        let mut simulation = Method::Xpbd(4).simulate::<f64>(&model, 2e-3);
        let velocity = [0.0, 0.0, 0.0, 0.0, 0.0, spin];
        let position = model.initial_position();
        simulation.set_joint_state(0, &position, &velocity).unwrap();
        for _ in 0..100 {
            assert!(simulation.step(1).is_empty(), "{spin} rad/s: it diverged");
            let pose = simulation.outputs().body_pose(0, BodyId(0));
            let gap = pose.point(at.position).distance(at.position);
            assert!(gap < 2e-3, "{spin} rad/s: gapes by {gap}");
        }
    }
}

/// Gears that are off by a tooth turn there at a bounded speed, and stop.
#[test]
fn gears_that_are_off_turn_there() {
    let mut world = Builder::new("gears");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let [small, large] =
        [0.2, 0.9].map(|i| body(object, &format!("{i}"), 1.0, DVec3::ZERO, DVec3::splat(i)));
    let follower = object.revolute("follower", small, DVec3::Z).handle();
    let leader = object
        .revolute("leader", large, DVec3::Z)
        .initial(&[0.3])
        .handle();
    object.couple("gear", follower, leader, 2.5, 0.0);
    let mut simulation = EULER.simulate::<f64>(&world.build().unwrap(), H);
    // The sum of three moments over the mass is the square of what stands for their size.
    let fastest = 1.0 / (3.0_f64 * (0.2 + 0.9) / 2.0).sqrt();
    let off = |q: &[f64]| 2.5 * q[1] - q[0];
    let mut last = 0.75;
    for _ in 0..1200 {
        simulation.step(1);
        let now = off(&simulation.outputs().joint_position(0));
        assert!((-1e-12..=fastest * H + 1e-12).contains(&(last - now)));
        last = now;
    }
    close("gap", last, 0.0, 1e-12);
    close("energy", simulation.outputs().energy(0), 0.0, 1e-12);
}
