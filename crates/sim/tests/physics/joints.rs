//! Every kind of joint, and how it is driven.

use crate::common::*;
use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings};
use model::{Axis, BodyId, Builder, Drive, JointId, Model, Pose};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const H: f64 = 1e-3;

/// What falls with a constant acceleration a from rest by v' = v + h a, x' = x + h v' has gone
/// n (n + 1)/2 h² a after n steps.
fn gone(n: usize, a: DVec3) -> DVec3 {
    a * H * H * (n * (n + 1)) as f64 / 2.0
}

fn rotation(turn: DVec3) -> [f64; 4] {
    DQuat::from_scaled_axis(turn).to_array()
}

/// A ball joint's target turns twice round an oblique axis, given as rotation vectors that jump from
/// 180° to −180°. A drive k, d with velocity target zero follows a rate w with the constant lag
/// (d/k − h) w, as its spring is that of before the step; started in this motion it stays in it, across ±180° and all else, to rounding.
#[test]
fn ball_joint_follows_a_target_across_180_degrees() {
    let (stiffness, damping, rate) = (500.0, 20.0, 1.0);
    let lag = (damping / stiffness - H) * rate;
    let mut world = Builder::new("gimbal");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let ball = body(object, "ball", 1.0, DVec3::ZERO, DVec3::splat(0.3));
    object.ball("ball", ball).drive(Drive {
        stiffness,
        damping,
        ..Drive::default()
    });
    let model = world.build().unwrap();
    let axis = DVec3::new(1.0, 2.0, -2.0) / 3.0;
    let steps = (2.0 * TAU / rate / H) as usize;
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        let start = rotation(axis * (-PI - lag));
        simulation
            .set_joint_state(0, &start, &(axis * rate).to_array())
            .unwrap();
        let mut worst: f64 = 0.0;
        for i in 1..=steps {
            let angle = i as f64 * H * rate - PI;
            let target = axis * (angle - TAU * (angle / TAU).round());
            for (dof, x) in target.to_array().into_iter().enumerate() {
                simulation.controls().set_target(0, dof, x).unwrap();
            }
            simulation.step(1);
            let q = simulation.outputs().body_orientation(0, BodyId(0));
            let expected = DQuat::from_scaled_axis(axis * (angle - lag));
            worst = worst.max(2.0 * (expected.conjugate() * q).xyz().length());
        }
        close(
            format!("{method:?} angle from the target"),
            worst,
            0.0,
            1e-9,
        );
    }
}

/// A ball's target jumps by 179.9° about any axis: the joint turns there the short way, in the plane
/// of the turn, and never faster than a critically damped spring would: w₀ e⁻¹ times the jump.
#[test]
fn ball_joint_turns_the_short_way() {
    let (inertia, stiffness) = (0.3_f64, 120.0);
    // Of steps with the spring of before and the damper of afterwards.
    let damping = 2.0 * (stiffness * inertia).sqrt() + H * stiffness;
    let fastest = (stiffness / inertia).sqrt() * (-1.0_f64).exp() * PI;
    let mut world = Builder::new("gimbal");
    world.gravity(DVec3::ZERO);
    let object = world.object("");
    let ball = body(object, "ball", 1.0, DVec3::ZERO, DVec3::splat(inertia));
    object.ball("ball", ball).drive(Drive {
        stiffness,
        damping,
        ..Drive::default()
    });
    let model = world.build().unwrap();
    for method in SOLVERS {
        for axis in [DVec3::X, -DVec3::Y, DVec3::new(2.0, -1.0, 2.0) / 3.0] {
            let mut simulation = method.simulate::<f64>(&model, H);
            let target = axis * 179.9_f64.to_radians();
            for (dof, x) in target.to_array().into_iter().enumerate() {
                simulation.controls().set_target(0, dof, x).unwrap();
            }
            for _ in 0..2000 {
                simulation.step(1);
                let v = DVec3::from_slice(&simulation.outputs().joint_velocity(0));
                assert!(
                    v.cross(axis).length() < 1e-9,
                    "{method:?} leaves the plane: {v}"
                );
                assert!(
                    v.dot(axis) > -1e-9 && v.dot(axis) < fastest,
                    "{method:?}: {v}"
                );
            }
            // 2 s are 40 time constants.
            let q = simulation.outputs().body_orientation(0, BodyId(0));
            let left = DQuat::from_scaled_axis(target).conjugate() * q;
            close(
                format!("{method:?} end"),
                2.0 * left.xyz().length(),
                0.0,
                1e-9,
            );
        }
    }
}

/// A weight on a string is back after the elliptic period. xpbd is of first order, and keeps the string's length to
/// rounding. Where forces depend on places only, a step of featherstone with a loop is SHAKE's, of second order: it
/// is late by h², and as it turns back half a step before its start, that is a h/2 h² of way. The length is kept to the
/// third order of a step's way, (v h)³ / L².
#[test]
fn distance_joint_is_a_pendulum() {
    let (length, start) = (0.8, 60_f64.to_radians());
    let mut world = Builder::new("string");
    let object = world.object("");
    let (sin, cos) = start.sin_cos();
    let place = DVec3::new(sin, -cos, 0.0) * length;
    let bob = object
        .body("bob")
        .at(Pose::at(place))
        .inertia(
            1.0,
            DVec3::ZERO,
            glam::DMat3::from_diagonal(DVec3::splat(0.01)),
        )
        .handle();
    object.distance("string", bob, length);
    let model = world.build().unwrap();
    let auto = Simulation::<f64>::new(model.clone(), SimulationSettings::new(1, H)).unwrap();
    assert_eq!(
        auto.solver(),
        "featherstone",
        "what `auto` picks where a joint closes a loop"
    );
    let t = TAU * (length / G).sqrt() / agm(1.0, (start / 2.0).cos());
    for (method, order) in [(EULER, 3.0), (XPBD, 1.0)] {
        let error = |h: f64| {
            let mut simulation = method.simulate::<f64>(&model, h);
            let fastest = (2.0 * G * length * (1.0 - start.cos())).sqrt();
            let slack = match method {
                EULER => (fastest * h).powi(3) / length.powi(2),
                _ => 1e-12,
            };
            let mut worst = 0.0_f64;
            for _ in 0..(t / h).round() as usize {
                simulation.step(1);
                let p = simulation.outputs().body_position(0, BodyId(0));
                worst = worst.max((p.length() - length).abs());
            }
            close(format!("length, {method:?}"), worst, 0.0, slack);
            let end = simulation.outputs().body_position(0, BodyId(0));
            end.distance(place)
        };
        let name = format!("distance pendulum, {method:?}");
        vanishes(name, order, 0.1, t / 2000.0, error);
    }
}

/// A sled on a rail, its centre beside it. In xpbd the weight turns the sled by what one pass leaves
/// of the way of a substep, g h².
#[test]
fn prismatic_joint_slides_down_an_incline() {
    let axis = DVec3::new(3.0, -1.0, 2.0).normalize();
    let mut world = Builder::new("incline");
    let object = world.object("");
    let moments = DVec3::new(0.1, 0.2, 0.3);
    let sled = body(object, "sled", 2.0, DVec3::new(0.3, 0.1, 0.2), moments);
    object.prismatic("rail", sled, axis);
    let model = world.build().unwrap();
    for (method, tolerance) in [(EULER, 1e-9), (XPBD, G * H * H)] {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation.step(1000);
        let along = axis * axis.dot(DVec3::new(0.0, -G, 0.0));
        let place = simulation.outputs().body_position(0, BodyId(0));
        near(format!("{method:?}"), place, gone(1000, along), tolerance);
        let turn = simulation
            .outputs()
            .body_orientation(0, BodyId(0))
            .xyz()
            .length();
        close(format!("{method:?} turn"), turn, 0.0, tolerance / 0.1);
    }
}

/// A puck on a plane: pushed and turned, it slides as free as in space, and the plane carries it.
#[test]
fn plane_xz_joint_slides_and_turns_in_its_plane() {
    let gravity = DVec3::new(0.5, -G, -0.3);
    let mut world = Builder::new("puck");
    world.gravity(gravity);
    let object = world.object("");
    let puck = body(object, "puck", 1.5, DVec3::ZERO, DVec3::new(0.1, 0.15, 0.1));
    object.plane_xz("plane", puck);
    let model = world.build().unwrap();
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation
            .set_joint_state(0, &[0.0; 3], &[1.0, -2.0, 1.0])
            .unwrap();
        simulation
            .controls()
            .set_force(0, &[0.6, 0.0, 0.3])
            .unwrap();
        simulation.step(1000);
        let outputs = simulation.outputs();
        let a = DVec3::new(gravity.x + 0.6 / 1.5, 0.0, gravity.z);
        // In impulse the plane is a spring of an eighth of the frequency of small steps.
        let sag = if method == IMPULSE {
            G * (H * 8.0 / TAU).powi(2)
        } else {
            0.0
        };
        let expected = DVec3::new(1.0, -sag, -2.0) + gone(1000, a);
        near(
            format!("{method:?} place"),
            outputs.body_position(0, BodyId(0)),
            expected,
            1e-9,
        );
        let spin = gone(1000, DVec3::Y * 0.3 / 0.15).y;
        close(
            format!("{method:?} angle"),
            outputs.joint_position(0)[2],
            1.0 + spin,
            1e-9,
        );
        let (force, torque) = outputs.reaction(0, JointId(0));
        // The push is the joint's, too.
        near(
            format!("{method:?} force"),
            force,
            DVec3::new(0.6, G * 1.5, 0.0),
            1e-6,
        );
        near(
            format!("{method:?} torque"),
            torque,
            DVec3::new(0.0, 0.3, 0.0),
            1e-6,
        );
    }
}

/// A planar body as a d6 joint (x, y, turn about z) flies as a free one.
#[test]
fn d6_joint_with_a_plane_of_freedom_flies() {
    let mut world = Builder::new("planar");
    let object = world.object("");
    let plate = body(
        object,
        "plate",
        1.5,
        DVec3::ZERO,
        DVec3::new(0.1, 0.2, 0.25),
    );
    let axes = [
        Axis::linear(DVec3::X),
        Axis::linear(DVec3::Y),
        Axis::angular(DVec3::Z),
    ];
    object.d6("plane", plate, &axes);
    let model = world.build().unwrap();
    for method in SOLVERS {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation
            .set_joint_state(0, &[0.0; 3], &[2.0, 5.0, 3.0])
            .unwrap();
        simulation.step(1000);
        let outputs = simulation.outputs();
        let expected = DVec3::new(2.0, 5.0, 0.0) + gone(1000, DVec3::NEG_Y * G);
        near(
            format!("{method:?} place"),
            outputs.body_position(0, BodyId(0)),
            expected,
            1e-9,
        );
        close(
            format!("{method:?} angle"),
            outputs.joint_position(0)[2],
            3.0,
            1e-9,
        );
    }
}

/// With all six axes a d6 joint holds nothing: its centre flies, and its angular momentum stays,
/// featherstone's to its order, xpbd's to rounding.
#[test]
fn d6_joint_with_all_axes_is_free() {
    let mut world = Builder::new("six");
    let object = world.object("");
    let moments = DVec3::new(0.1, 0.2, 0.25);
    let plate = body(object, "plate", 1.5, DVec3::ZERO, moments);
    let linear = [DVec3::X, DVec3::Y, DVec3::Z].map(Axis::linear);
    let angular = [DVec3::X, DVec3::Y, DVec3::Z].map(Axis::angular);
    object.d6("six", plate, &[linear, angular].concat());
    let model = world.build().unwrap();
    for (method, tolerance) in [(RK4, 1e-9), (XPBD, 1e-12)] {
        let mut simulation = method.simulate::<f64>(&model, H);
        simulation
            .set_joint_state(0, &[0.0; 6], &[2.0, 5.0, -1.0, 1.0, 2.0, -0.5])
            .unwrap();
        let spin = |simulation: &mut Simulation<f64>| {
            let outputs = simulation.outputs();
            let p = outputs.body_position(0, BodyId(0));
            outputs.angular_momentum(0) - p.cross(outputs.momentum(0))
        };
        let before = spin(&mut simulation);
        simulation.step(1000);
        near(
            format!("{method:?} spin"),
            spin(&mut simulation),
            before,
            tolerance,
        );
        let n = 1000.0;
        let late = if method == XPBD { H } else { 0.0 };
        let fallen = -0.5 * G * n * H * (n * H + late);
        let expected = DVec3::new(2.0, 5.0 + fallen, -1.0);
        let place = simulation.outputs().body_position(0, BodyId(0));
        near(format!("{method:?} place"), place, expected, 1e-9);
    }
}

/// Joints of every count of axes, in one chain under gravity; all solvers tend to the same motion,
/// each at its order.
fn menagerie(axes: &[Axis]) -> Model {
    let mut world = Builder::new("menagerie");
    let object = world.object("");
    let moments = DVec3::new(0.05, 0.03, 0.04);
    let first = body(object, "first", 1.2, DVec3::new(0.2, -0.1, 0.1), moments);
    let second = body(object, "second", 0.7, DVec3::new(0.1, 0.2, -0.1), moments);
    object.revolute("hinge", first, DVec3::Z);
    let place = Pose::new(DVec3::new(0.4, 0.0, 0.1), DQuat::from_rotation_x(0.4));
    let inner = Pose::new(DVec3::new(-0.1, 0.1, 0.0), DQuat::from_rotation_y(-0.3));
    object
        .d6("d6", second, axes)
        .parent(first)
        .frames(place, inner);
    world.build().unwrap()
}

#[test]
fn all_solvers_tend_to_the_same_motion_of_d6_joints() {
    let [x, y, z] = [DVec3::X, DVec3::Y, DVec3::Z];
    let oblique = DVec3::new(1.0, 2.0, 0.5).normalize();
    let cases = [
        vec![Axis::angular(x), Axis::angular(y)],
        vec![Axis::angular(oblique), Axis::angular(z)],
        vec![Axis::angular(z), Axis::angular(x), Axis::angular(y)],
        vec![Axis::linear(oblique), Axis::angular(z)],
        vec![
            Axis::linear(x),
            Axis::linear(y),
            Axis::angular(y),
            Axis::angular(z),
        ],
        vec![Axis::linear(x), Axis::linear(y), Axis::linear(z)],
        vec![Axis::linear(y)],
    ];
    for axes in cases {
        let model = menagerie(&axes);
        let n = model.degrees_of_freedom();
        let run = |method: Method, h: f64| {
            let mut simulation = method.simulate::<f64>(&model, h);
            let velocity: Vec<f64> = (0..n).map(|i| 0.8 - 0.5 * i as f64).collect();
            simulation
                .set_joint_state(0, &vec![0.2; n], &velocity)
                .unwrap();
            simulation.step((0.5 / h).round() as usize);
            let outputs = simulation.outputs();
            [outputs.joint_position(0), outputs.joint_velocity(0)].concat()
        };
        let reference = run(RK4, 1.0 / 8192.0);
        for method in SOLVERS {
            let error = |h: f64| {
                let found = run(method, h);
                found
                    .iter()
                    .zip(&reference)
                    .map(|(a, b)| (a - b).abs())
                    .fold(0.0, f64::max)
            };
            let kinds: Vec<_> = axes.iter().map(|a| a.kind).collect();
            vanishes(
                format!("{method:?} {kinds:?}"),
                1.0,
                0.15,
                1.0 / 2048.0,
                error,
            );
        }
    }
}

/// Two bodies fixed together swing as one: a compound pendulum with the sum of masses and of
/// moments about the hinge, and they stay together.
#[test]
fn fixed_joint_makes_one_body_of_two() {
    let (m, l, i) = PENDULUM;
    let (m2, l2, i2) = (0.9, 0.7, 0.02);
    let mut world = Builder::new("compound");
    let object = world.object("");
    let rod = body(
        object,
        "rod",
        m,
        DVec3::new(0.0, -l, 0.0),
        DVec3::new(i, 0.01, i),
    );
    // Its frame is turned: the fixed joint's child frame turns it back.
    let bob = body(object, "bob", m2, DVec3::ZERO, DVec3::splat(i2));
    object.revolute("hinge", rod, DVec3::Z);
    let turned = Pose::new(DVec3::ZERO, DQuat::from_rotation_y(FRAC_PI_2));
    object
        .fixed("weld", bob)
        .parent(rod)
        .frames(Pose::at(DVec3::new(0.0, -l2, 0.0)), turned);
    let model = world.build().unwrap();
    let inertia = i + m * l * l + i2 + m2 * l2 * l2;
    let w = (G * (m * l + m2 * l2) / inertia).sqrt();
    let start = 1.0_f64;
    let t = TAU / w / agm(1.0, (start / 2.0).cos());
    for (method, order, steps) in [(EULER, 2.0, 400.0), (RK4, 4.0, 200.0), (XPBD, 2.0, 4000.0)] {
        let error = |h: f64| {
            let mut simulation = method.simulate::<f64>(&model, h);
            simulation.set_joint_state(0, &[start], &[0.0]).unwrap();
            simulation.step((t / h).round() as usize);
            let outputs = simulation.outputs();
            let (rod, bob) = (
                outputs.body_pose(0, BodyId(0)),
                outputs.body_pose(0, BodyId(1)),
            );
            let weld = rod.point(DVec3::new(0.0, -l2, 0.0));
            // xpbd leaves what gravity and the swing moved in a substep, g h² and (w θ)² l h².
            let tolerance = 2.0 * G * h * h * f64::from(u8::from(method == XPBD)) + 1e-12;
            near("weld", bob.position, weld, tolerance);
            (outputs.joint_position(0)[0] - start).hypot(outputs.joint_velocity(0)[0] / w)
        };
        vanishes(format!("{method:?} compound"), order, 0.1, t / steps, error);
    }
}
