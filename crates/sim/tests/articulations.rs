//! Jointed bodies that touch, by `impulse`: people who fall, chains that hit, sleep, and what is refused.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind, Watch};
use model::examples::{Start, chain, ragdolls};
use model::{
    Actuator, Axis, BodyId, Builder, Drive, Geometry, JointKind, Model, Object, Pose, Shape,
};
use numbers::Float;
use std::f64::consts::{FRAC_PI_2, TAU};

const G: f64 = 9.81;
/// A step H [s], and a small one.
const STEP: f64 = 0.002;
const SMALL: f64 = STEP / 8.0;

fn settings() -> SimulationSettings {
    let mut settings = SimulationSettings::new(1, STEP);
    settings.solver = SolverKind::Impulse;
    settings.threads = 1;
    settings
}

fn simulate<T: Float>(model: &Model) -> Simulation<T> {
    Simulation::new(model.clone(), settings()).unwrap()
}

fn ground(world: &mut Builder) {
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
}

/// Largest distance [m] of the two anchors of a joint.
fn gap<T: Float>(simulation: &mut Simulation<T>) -> f64 {
    let model = simulation.model().clone();
    let outputs = simulation.outputs();
    let holding = model.joints.iter().filter(|j| j.kind != JointKind::Free);
    let gaps = holding.map(|joint| {
        let parent = joint
            .parent
            .map_or(Pose::IDENTITY, |p| outputs.body_pose(0, p));
        let child = outputs.body_pose(0, joint.child);
        let anchor = parent.point(joint.parent_frame.position);
        anchor.distance(child.point(joint.child_frame.position))
    });
    gaps.fold(0.0, f64::max)
}

fn bodies(model: &Model) -> impl Iterator<Item = BodyId> + use<> {
    (0..model.bodies.len()).map(BodyId)
}

fn sleepers<T: Float>(simulation: &mut Simulation<T>) -> usize {
    let ids = bodies(simulation.model());
    let outputs = simulation.outputs();
    ids.filter(|id| outputs.asleep(0, *id)).count()
}

/// Four people fall on the floor and on each other: their joints hold, nothing sinks in, and after 8 s all
/// of them sleep. Knees and elbows bend backwards by no more than stops of 500 N·m/rad give to a person's
/// weight, 600 N, at the length of a shin.
#[test]
fn people_fall_and_sleep() {
    let model = ragdolls(4).unwrap();
    let mut simulation = simulate::<f32>(&model);
    let hinges: Vec<_> = model
        .joints
        .iter()
        .enumerate()
        .filter(|(_, joint)| joint.kind == JointKind::Revolute)
        .map(|(i, _)| model.coordinate_range(model::JointId(i)).start)
        .collect();
    for _ in 0..400 {
        simulation.step(10);
        let open = gap(&mut simulation);
        assert!(open < 2e-3, "a joint gapes by {open}");
        let outputs = simulation.outputs();
        let angles = outputs.joint_position(0);
        for &hinge in &hinges {
            assert!(angles[hinge] > -0.5, "a limb bends to {}", angles[hinge]);
        }
        let deepest = outputs.contacts(0).map(|c| -c.distance).fold(0.0, f64::max);
        assert!(deepest < 0.01, "{deepest} m deep");
    }
    assert_eq!(sleepers(&mut simulation), model.bodies.len());
    assert!(gap(&mut simulation) < 1e-4);
}

/// A chain with a heavy ball at its end, held out to the side of a wall of boxes.
fn wrecker(times: f64) -> Model {
    let mut world = Builder::new("wrecker");
    ground(&mut world);
    let crane = world.object("crane");
    let (top, link) = (DVec3::new(0.0, 2.6, 0.0), 0.2);
    let sideways = DQuat::from_rotation_z(FRAC_PI_2);
    let mut parent = None;
    for i in 0..10 {
        let start = top - DVec3::X * link * f64::from(i);
        let middle = Pose::new(start - DVec3::X * 0.5 * link, sideways);
        let shape = Geometry::Capsule {
            radius: 0.02,
            half_height: 0.09,
        };
        let body = crane.body(format!("link_{i}")).at(middle);
        let rod = body.shape(shape).mass(0.5).handle();
        let joint = crane.ball(format!("ball_{i}"), rod).at(Pose::at(start));
        if let Some(parent) = parent {
            joint.parent(parent);
        }
        parent = Some(rod);
    }
    let end = top - DVec3::X * 10.0 * link;
    let ball = crane.body("ball").at(Pose::at(end - DVec3::X * 0.2));
    let ball = ball.shape(Geometry::Sphere { radius: 0.2 });
    let ball = ball.mass(0.5 * times).handle();
    let hook = crane.ball("hook", ball).at(Pose::at(end));
    if let Some(parent) = parent {
        hook.parent(parent);
    }
    let wall = world.object("wall");
    for (row, i) in (0..6).flat_map(|row| (0..6).map(move |i| (row, i))) {
        let z = 0.21 * (f64::from(i) - 2.5) + 0.1 * f64::from(row % 2);
        let place = DVec3::new(0.25, 0.1 + 0.2 * f64::from(row), z);
        wall.body(format!("box_{row}_{i}"))
            .at(Pose::at(place))
            .shape(Geometry::Box {
                half: DVec3::splat(0.1),
            });
    }
    world.build().unwrap()
}

/// A ball of ten times the mass of a link shakes the wall, and one of a hundred times breaks it; the chain
/// holds, and energy is only lost.
#[test]
fn a_ball_on_a_chain_breaks_a_wall() {
    for (times, way) in [(10.0, 1e-3), (100.0, 0.2)] {
        let model = wrecker(times);
        let mut simulation = simulate::<f32>(&model);
        let places = |simulation: &mut Simulation<f32>| -> Vec<DVec3> {
            let outputs = simulation.outputs();
            let boxes = bodies(&model).skip(11);
            boxes.map(|id| outputs.body_position(0, id)).collect()
        };
        let before = places(&mut simulation);
        let start = simulation.outputs().energy(0);
        let scale = 0.5 * (10.0 + times) * G * 2.0;
        for _ in 0..300 {
            simulation.step(10);
            let open = gap(&mut simulation);
            assert!(open < 3e-3, "a joint gapes by {open}");
            let gained = simulation.outputs().energy(0) - start;
            assert!(gained < 1e-3 * scale, "{gained} J gained");
        }
        let after = places(&mut simulation);
        let ways = before.iter().zip(&after).map(|(a, b)| a.distance(*b));
        let most = ways.fold(0.0, f64::max);
        assert!(most > way, "{times}: boxes move by {most}");
        assert!(simulation.diverged().is_empty());
    }
}

/// A weight of a thousand times a link's mass hangs on a chain of ten: each joint is a spring of
/// (2π / 8 h)² of the mass that its bodies let it move, at most a link's m, and gives way by F over that.
#[test]
fn a_light_chain_bears_a_heavy_weight() {
    let mut parts = chain(10, Start::Hanging).unwrap().into_parts();
    let heavy = &mut parts.bodies[9];
    heavy.mass *= 1000.0;
    heavy.inertia *= 1000.0;
    let model = Model::new(parts).unwrap();
    let mut simulation = simulate::<f64>(&model);
    simulation.step(1000);
    let force = model.total_mass() * G;
    // Pushed at an end across its centre a rod has a quarter of its mass; along it, all. Hanging: along,
    // and half of it between two.
    let spring = 0.5 * (TAU / (8.0 * SMALL)).powi(2);
    let open = gap(&mut simulation);
    assert!(open < 1.1 * force / spring, "{open}, {}", force / spring);
}

/// Two links on a post, at rest.
fn hanging() -> Model {
    let mut world = Builder::new("hanging");
    ground(&mut world);
    let object = world.object("pendulum");
    let mut parent = None;
    for i in 0..2 {
        let top = DVec3::Y * (2.0 - f64::from(i));
        let body = object.body(format!("link_{i}"));
        body.at(Pose::at(top - DVec3::Y * 0.5));
        let shape = Geometry::Capsule {
            radius: 0.03,
            half_height: 0.4,
        };
        let rod = body.shape(shape).mass(1.0).handle();
        let hinge = object.revolute(format!("hinge_{i}"), rod, DVec3::Z);
        hinge.at(Pose::at(top)).drive(Drive {
            damping: 1.0,
            stiffness: 1.0,
            ..Drive::default()
        });
        if let Some(parent) = parent {
            hinge.parent(parent);
        }
        parent = Some(rod);
    }
    world
        .object("ball")
        .body("ball")
        .at(Pose::at(DVec3::new(3.0, 0.5, 0.0)))
        .shape(Geometry::Sphere { radius: 0.1 });
    world.build().unwrap()
}

/// What hangs at rest sleeps; a new target, a force, or a ball that hits one link wakes all of it.
#[test]
fn what_hangs_sleeps_until_it_is_moved() {
    let model = hanging();
    let asleep = || {
        let mut simulation = simulate::<f32>(&model);
        simulation.step(500);
        assert!(sleepers(&mut simulation) >= 2);
        simulation
    };
    let links = |simulation: &mut Simulation<f32>| {
        let outputs = simulation.outputs();
        [0, 1].map(|i| outputs.asleep(0, BodyId(i)))
    };
    let mut simulation = asleep();
    simulation.controls().set_target(0, 1, 0.5).unwrap();
    simulation.step(1);
    assert_eq!(links(&mut simulation), [false; 2], "by a target");

    let mut simulation = asleep();
    simulation.controls().set_dof_force(0, 0, 1.0).unwrap();
    simulation.step(1);
    assert_eq!(links(&mut simulation), [false; 2], "by a force");

    let mut simulation = asleep();
    let mut position = simulation.outputs().joint_position(0);
    let mut velocity = simulation.outputs().joint_velocity(0);
    // Only the ball is set moving; setting a state wakes all, so they have to fall asleep before it comes.
    let free = model.coordinate_range(model::JointId(2)).start;
    position[free] = 12.0;
    velocity[2] = -8.0;
    simulation.set_joint_state(0, &position, &velocity).unwrap();
    simulation.step(400);
    assert_eq!(links(&mut simulation), [true; 2]);
    let mut woken = false;
    for _ in 0..1000 {
        simulation.step(1);
        let [one, other] = links(&mut simulation);
        assert_eq!(one, other, "joints tie them");
        woken |= !one;
    }
    assert!(woken, "by a ball");
}

/// Where whole turns do not count, a target many of them away is reached the short way round, so exactly that what is driven
/// there sleeps: in single precision, the turns must not take away more than they are.
#[test]
fn a_target_many_turns_away_is_reached() {
    let mut world = Builder::new("wheel");
    let object = world.object("");
    let shape = Geometry::Sphere { radius: 0.1 };
    let wheel = object.body("wheel").shape(shape).mass(1.0).handle();
    let drive = Drive {
        stiffness: 2.0,
        damping: 0.3,
        control_time: 0.05,
        ..Drive::default()
    };
    object.revolute("axle", wheel, DVec3::Z).drive(drive);
    let mut simulation = simulate::<f32>(&world.build().unwrap());
    let turns = 12.0 * TAU;
    simulation.controls().set_target(0, 0, turns + 0.3).unwrap();
    simulation.step(1500);
    let angle = simulation.outputs().joint_position(0)[0];
    assert!((angle - 0.3).abs() < 1e-3, "{angle}");
    assert_eq!(sleepers(&mut simulation), 1);
}

/// What drives hold sleeps on in single precision, too: targets come as near to their goals as rounding lets them, those of
/// balls, and those that follow with a control time. A goal that is a little farther away wakes at once.
#[test]
fn what_drives_hold_sleeps_on() {
    let mut world = Builder::new("held");
    let object = world.object("");
    let shape = Geometry::Capsule {
        radius: 0.03,
        half_height: 0.4,
    };
    for i in 0..6 {
        let rod = object.body(format!("rod_{i}")).shape(shape.clone());
        let rod = rod.mass(1.0).handle();
        let joint = if i < 4 {
            object.ball(format!("joint_{i}"), rod)
        } else {
            object.revolute(format!("joint_{i}"), rod, DVec3::Z)
        };
        let top = Pose::at(DVec3::new(3.0 * f64::from(i), 2.0, 0.0));
        joint.frames(top, Pose::at(DVec3::Y * 0.4)).drive(Drive {
            stiffness: 40.0,
            damping: 8.0,
            control_time: f64::from(i % 2) * 0.1,
            ..Drive::default()
        });
    }
    let model = world.build().unwrap();
    let turns = [[0.3, 0.2, 0.1], [-0.2, 0.4, 0.3]];
    let goals = turns.map(|turn| [turn; 2].concat()).concat();
    let goals = [goals, vec![2.0; 2]].concat();
    let mut simulation = simulate::<f32>(&model);
    for (dof, goal) in goals.iter().enumerate() {
        simulation.controls().set_target(0, dof, *goal).unwrap();
    }
    simulation.step(2000);
    simulation.watch(Watch {
        sleep: true,
        ..Watch::default()
    });
    simulation.step(1000);
    assert_eq!(simulation.drain_events(), []);
    assert_eq!(sleepers(&mut simulation), 6);
    for (asleep, joint) in (0..6).rev().zip(0..6) {
        let dof = model.dof_range(model::JointId(joint)).start;
        let goal = goals[dof] + 1e-3;
        simulation.controls().set_target(0, dof, goal).unwrap();
        simulation.step(1);
        assert_eq!(sleepers(&mut simulation), asleep, "joint {joint}");
    }
}

/// A drive against a weight: it stops where k (target − q) = m g l cos q, however soft the joint is; but for what the coordinate
/// goes along with locks that give way, 1.6 h² times the acceleration 1.5 g/(2 l) that there is without a drive, in small
/// steps h.
#[test]
fn a_drive_sags_by_torque_over_stiffness() {
    let mut world = Builder::new("arm");
    world.gravity(DVec3::NEG_Y * G);
    let object = world.object("");
    let rod = Geometry::Capsule {
        radius: 0.02,
        half_height: 0.25,
    };
    let body = object.body("rod").shape(rod).mass(2.0).handle();
    let turned = DQuat::from_rotation_z(FRAC_PI_2);
    object
        .revolute("shoulder", body, DVec3::Z)
        .frames(Pose::IDENTITY, Pose::new(DVec3::Y * 0.25, turned))
        .drive(Drive {
            stiffness: 200.0,
            damping: 20.0,
            target_position: 0.3,
            ..Drive::default()
        });
    let model = world.build().unwrap();
    let mut settings = settings();
    settings.step.sleep_speed = 0.0;
    let mut simulation = Simulation::<f64>::new(model, settings).unwrap();
    simulation.step(5000);
    let outputs = simulation.outputs();
    let q = outputs.joint_position(0)[0];
    let pose = outputs.body_pose(0, BodyId(0));
    let arm = pose.position.x - pose.point(DVec3::Y * 0.25).x;
    let torque = 200.0 * (0.3 - q);
    let small = STEP / 8.0;
    let gives = 1.7 * small * small * 1.5 * G / 0.5;
    let off = torque - 2.0 * G * arm;
    assert!(off.abs() < 200.0 * gives, "{torque} at {q}, off by {off}");
}

/// A bar on two strings, with a motor on its hinge: all that closes loops holds, in any order.
#[test]
fn loops_hold() {
    let mut world = Builder::new("swing");
    let object = world.object("swing");
    let bar = Geometry::Box {
        half: DVec3::new(0.5, 0.05, 0.1),
    };
    let seat = object.body("seat").shape(bar).handle();
    for (name, x) in [("left", -0.4), ("right", 0.4)] {
        object
            .distance(name, seat, 1.0)
            .frames(Pose::at(DVec3::new(x, 1.0, 0.0)), Pose::at(DVec3::X * x));
    }
    let model = world.build().unwrap();
    let mut simulation = simulate::<f64>(&model);
    let mut velocity = [0.0; 6];
    velocity[2] = 2.0;
    simulation
        .set_joint_state(0, &[0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0], &velocity)
        .unwrap();
    // Each string is a spring of an eighth of the frequency of small steps, which a load that comes at once
    // stretches twice as far as at rest; at most, weight and swing.
    let most = 2.0 * (G + 4.0) * (8.0 * SMALL / TAU).powi(2) * 2.0;
    for _ in 0..1000 {
        simulation.step(1);
        let seat = simulation.outputs().body_pose(0, BodyId(0));
        for x in [-0.4, 0.4] {
            let string = seat.point(DVec3::X * x) - DVec3::new(x, 1.0, 0.0);
            assert!((string.length() - 1.0).abs() < most, "{}", string.length());
        }
    }
    assert!(simulation.outputs().body_velocity(0, BodyId(0)).length() > 0.1);
}

fn refusal(build: impl Fn(&mut Object, [model::BodyHandle; 2])) -> String {
    let mut world = Builder::new("refused");
    let object = world.object("");
    let names = ["one", "other"];
    let pair = names.map(|name| {
        let body = object.body(name);
        body.shape(Geometry::Sphere { radius: 0.1 }).handle()
    });
    build(object, pair);
    let model = world.build().unwrap();
    let refused = Simulation::<f32>::new(model, settings());
    refused.unwrap_err().to_string()
}

#[test]
fn what_impulse_lacks_is_refused() {
    let couples = refusal(|object, [one, other]| {
        let hinges = [("a", one), ("b", other)].map(|(name, body)| {
            let hinge = object.revolute(name, body, DVec3::Z);
            hinge.handle()
        });
        object.couple("gear", hinges[0], hinges[1], 2.0, 0.0);
    });
    assert_eq!(
        couples,
        "impulse does not support the coupling of `gear`: use the solver `featherstone`, or `xpbd`"
    );
    let gives = refusal(|object, [one, _]| {
        object
            .revolute("spring", one, DVec3::Z)
            .compliance(1e-3, 0.0);
    });
    assert_eq!(
        gives,
        "impulse does not support compliance of `spring`: use the solver `xpbd`"
    );
    let oblique = [DVec3::X, DVec3::new(0.6, 0.8, 0.0)].map(Axis::linear);
    let slides = refusal(|object, [one, _]| {
        object.d6("rails", one, &oblique);
    });
    assert_eq!(
        slides,
        "impulse does not support linear axes that are no frame of `rails`: choose them at right \
         angles, a third to the right of two, or use the solver `xpbd`"
    );
    let late = [Axis::angular(DVec3::X), Axis::linear(DVec3::Y)];
    let order = refusal(|object, [one, _]| {
        object.d6("late", one, &late);
    });
    assert_eq!(
        order,
        "impulse does not support a linear axis after an angular one of `late`: order them linear \
         first, or use the solver `featherstone`"
    );
}

/// `auto` takes impulse for things that touch, jointed or not, but not for what is driven, nor for one thing; and for more
/// than others have room for.
#[test]
fn auto_takes_impulse_for_passive_things_that_touch() {
    let solver = |model: Model| {
        let settings = SimulationSettings::new(1, STEP);
        let simulation = Simulation::<f32>::new(model, settings).unwrap();
        simulation.solver().to_owned()
    };
    assert_eq!(solver(ragdolls(2).unwrap()), "impulse");
    assert_eq!(solver(ragdolls(1).unwrap()), "featherstone");
    assert_eq!(solver(chain(3, Start::Hanging).unwrap()), "featherstone");
    assert_eq!(solver(hanging()), "featherstone");
    assert_eq!(solver(wrecker(10.0)), "impulse");
    let mut driven = hanging().into_parts();
    for joint in &mut driven.joints {
        joint
            .dofs
            .iter_mut()
            .for_each(|dof| dof.drive = Drive::default());
    }
    assert_eq!(solver(Model::new(driven.clone()).unwrap()), "impulse");
    driven.actuators = vec![Actuator::motor("motor", model::JointId(0))];
    assert_eq!(solver(Model::new(driven).unwrap()), "featherstone");
    let crowd = |people| {
        let mut crowd = ragdolls(people).unwrap().into_parts();
        let held = crowd
            .joints
            .iter()
            .position(|j| !j.dofs.is_empty() && j.parent.is_some());
        crowd.actuators = vec![Actuator::motor("motor", model::JointId(held.unwrap()))];
        Model::new(crowd).unwrap()
    };
    assert_eq!(solver(crowd(2)), "featherstone");
    assert_eq!(solver(crowd(120)), "impulse");
}
