//! What joints that are moved, or pushed, keep: the targets that their drives follow with a lag, and of what is pushed all
//! but velocities.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Event, EventKind, Simulation, SimulationSettings, SolverKind, Watch};
use model::{BodyId, Builder, Drive, Geometry, JointId, Model, Pose, Shape};
use std::f64::consts::PI;

const SOLVERS: [SolverKind; 3] = [
    SolverKind::Featherstone,
    SolverKind::Xpbd,
    SolverKind::Impulse,
];

fn simulate(model: Model, solver: SolverKind) -> Simulation<f64> {
    let mut settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(2, 0.002)
    };
    settings.step.sleep_speed = 0.0;
    Simulation::new(model, settings).unwrap()
}

fn arm(ball: bool) -> Model {
    let drive = Drive {
        stiffness: 500.0,
        damping: 50.0,
        control_time: 0.5,
        ..Drive::default()
    };
    let mut world = Builder::new("arm");
    world.gravity(DVec3::ZERO);
    let robot = world.object("robot");
    let body = robot.body("arm");
    let body = body
        .shape(Geometry::Sphere { radius: 0.2 })
        .mass(1.0)
        .handle();
    if ball {
        robot.ball("joint", body).drive(drive);
    } else {
        robot.revolute("joint", body, DVec3::X).drive(drive);
    }
    world.build().unwrap()
}

/// A box on a slope of 20°.
fn slope() -> Builder {
    let lean = Pose::new(DVec3::ZERO, DQuat::from_rotation_z(20_f64.to_radians()));
    let mut world = Builder::new("slope");
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane).at(lean));
    let half = DVec3::new(0.2, 0.1, 0.2);
    let body = world.object("box");
    let body = body.body("box").at(lean * Pose::at(DVec3::Y * 0.1));
    body.shape(Geometry::Box { half });
    world
}

/// Moved to where its target has come to, an arm stays there.
#[test]
fn moved_joints_keep_the_targets_of_their_drives() {
    for solver in SOLVERS {
        for ball in [false, true] {
            let mut sim = simulate(arm(ball), solver);
            let goal = 1.0;
            for world in 0..2 {
                sim.controls().set_target(world, 0, goal).unwrap();
            }
            sim.step(4000);
            let there = sim.outputs().joint_position(1);
            let at_rest = vec![0.0; sim.model().degrees_of_freedom()];
            sim.move_joints(1, &there, &at_rest).unwrap();
            sim.step(100);
            let now = sim.outputs().joint_position(1);
            for (now, there) in now.iter().zip(&there) {
                let what = format!("{solver:?}, ball {ball}: {now} for {there}");
                assert!((now - there).abs() < 1e-4, "{what}");
            }
        }
    }
}

/// A push changes velocities, and no more: a push of nothing leaves a robot that follows its target on its way, and a box
/// at rest on a slope there, with its contacts.
#[test]
fn pushed_joints_keep_all_else() {
    for solver in SOLVERS {
        let mut sims = [0, 1].map(|_| {
            let mut sim = simulate(arm(false), solver);
            sim.controls().set_target(0, 0, 1.0).unwrap();
            sim.step(200);
            sim
        });
        for _ in 0..50 {
            let velocity = sims[1].outputs().joint_velocity(0);
            sims[1].set_joint_velocities([(0, &velocity[..])]).unwrap();
            sims.iter_mut().for_each(|sim| {
                sim.step(1);
            });
        }
        let [free, pushed] = sims
            .each_mut()
            .map(|sim| sim.outputs().joint_position(0)[0]);
        let what = format!("{solver:?}: {pushed} for {free}");
        assert!((pushed - free).abs() < 1e-9, "{what}");

        let mut sim = simulate(slope().build().unwrap(), solver);
        sim.step(500);
        sim.watch(Watch::ALL);
        let there = sim.outputs().body_position(0, BodyId(0));
        for _ in 0..200 {
            let velocity = sim.outputs().joint_velocity(0);
            sim.set_joint_velocities([(0, &velocity[..])]).unwrap();
            let pressing = sim
                .outputs()
                .contacts(0)
                .filter(|c| c.force.y > 0.0)
                .count();
            assert!(pressing > 0, "{solver:?}: contacts stay");
            sim.step(1);
        }
        let crept = (sim.outputs().body_position(0, BodyId(0)) - there).length();
        assert!(crept < 1e-4, "{solver:?}: it crept {crept} m");
        let events = sim.drain_events();
        let touched = |event: &Event| matches!(event.kind, EventKind::ContactBegins { .. });
        assert!(!events.iter().any(touched), "{solver:?}: {events:?}");
    }
}

#[test]
fn a_push_is_checked_before_anything_moves() {
    let mut sim = simulate(arm(false), SolverKind::Featherstone);
    let fine = [1.0];
    for wrong in [&[f64::NAN][..], &[1.0, 2.0], &[1e10]] {
        let both = [(0, &fine[..]), (1, wrong)];
        assert!(sim.set_joint_velocities(both).is_err());
    }
    assert!(sim.set_joint_velocities([(2, &fine[..])]).is_err());
    assert_eq!(sim.outputs().joint_velocity(0), [0.0]);
    sim.set_joint_velocities([(1, &fine[..])]).unwrap();
    assert_eq!(sim.outputs().joint_velocity(1), [1.0]);
}

/// By `impulse` what sleeps elsewhere sleeps on, and joints bear what they bore.
#[test]
fn a_push_wakes_only_what_it_moves() {
    let drive = Drive {
        stiffness: 500.0,
        damping: 50.0,
        ..Drive::default()
    };
    let mut world = Builder::new("neighbours");
    world.gravity(DVec3::NEG_Y * 9.81);
    let plane = Geometry::Plane {
        half_x: 0.0,
        half_z: 0.0,
    };
    world.object("ground").scenery(Shape::new(plane));
    let object = world.object("object");
    let half = DVec3::splat(0.1);
    object
        .body("box")
        .at(Pose::at(DVec3::Y * 0.1))
        .shape(Geometry::Box { half });
    let at = Pose::at(DVec3::new(5.2, 2.0, 0.0));
    let arm = object.body("arm").at(at);
    let arm = arm
        .shape(Geometry::Sphere { radius: 0.1 })
        .mass(1.0)
        .handle();
    let hinge = object.revolute("hinge", arm, DVec3::Z);
    hinge.at(Pose::at(DVec3::new(5.0, 2.0, 0.0))).drive(drive);
    let settings = SimulationSettings {
        solver: SolverKind::Impulse,
        ..SimulationSettings::new(1, 0.002)
    };
    let mut sim = Simulation::<f32>::new(world.build().unwrap(), settings).unwrap();
    sim.step(1500);
    let model = sim.model().clone();
    let [still, arm] = ["box", "arm"].map(|name| model.body(name).unwrap());
    let hinge = model.joint("hinge").unwrap();
    assert!(
        [still, arm]
            .iter()
            .all(|body| sim.outputs().asleep(0, *body))
    );
    let (there, borne) = (
        sim.outputs().body_pose(0, arm),
        sim.outputs().reaction(0, hinge),
    );
    let mut velocity = sim.outputs().joint_velocity(0);
    velocity[model.dof_range(hinge).start] = 0.5;
    sim.set_joint_velocities([(0, &velocity[..])]).unwrap();
    let outputs = sim.outputs();
    assert!(outputs.asleep(0, still) && !outputs.asleep(0, arm));
    assert_eq!(outputs.body_pose(0, arm), there);
    assert_eq!(outputs.reaction(0, hinge), borne);
    assert!((outputs.body_velocity(0, arm).y - 0.1).abs() < 1e-6);
}

/// Two chains of four rods that fall, nine metres apart.
fn two_chains() -> Model {
    let mut world = Builder::new("two chains");
    for (name, x) in [("left", 0.0), ("right", 9.0)] {
        let object = world.object(name);
        let mut last = None;
        for i in 0..4 {
            let capsule = Geometry::Capsule {
                radius: 0.05,
                half_height: 0.25,
            };
            let rod = object.body(format!("{name} {i}"));
            let across = Pose::new(DVec3::X * 0.25, DQuat::from_rotation_z(-0.5 * PI));
            let rod = rod.shape(Shape::new(capsule).at(across)).mass(1.0).handle();
            let hinge = object.revolute(format!("{name} hinge {i}"), rod, DVec3::Z);
            let start = if i == 0 { x } else { 0.5 };
            hinge.frames(Pose::at(DVec3::X * start), Pose::IDENTITY);
            if let Some(parent) = last.replace(rod) {
                hinge.parent(parent);
            }
        }
    }
    world.build().unwrap()
}

/// Where a joint is pushed by next to nothing, in each step, everything moves as it would have moved; and other trees do not
/// notice, to the bit, nor do they where it is moved.
#[test]
fn small_pushes_change_little() {
    for solver in SOLVERS {
        let sim = || {
            let settings = SimulationSettings {
                solver,
                contacts: false,
                ..SimulationSettings::new(1, 0.002)
            };
            Simulation::<f64>::new(two_chains(), settings).unwrap()
        };
        let [mut alone, mut pushed, mut moved] = [sim(), sim(), sim()];
        for step in 0..500 {
            let mut velocity = pushed.outputs().joint_velocity(0);
            velocity[3] += 1e-9;
            pushed.set_joint_velocities([(0, &velocity[..])]).unwrap();
            if step % 50 == 0 {
                let outputs = moved.outputs();
                let mut position = outputs.joint_position(0);
                let velocity = outputs.joint_velocity(0);
                position[3] += 1e-9;
                moved.move_joints(0, &position, &velocity).unwrap();
            }
            for sim in [&mut alone, &mut pushed, &mut moved] {
                sim.step(1);
            }
        }
        let ends = [alone, pushed, moved].map(|mut sim| {
            let outputs = sim.outputs();
            (0..8)
                .map(|b| outputs.body_position(0, BodyId(b)))
                .collect::<Vec<_>>()
        });
        let [alone, pushed, moved] = ends;
        for changed in [&pushed, &moved] {
            assert_eq!(alone[4..], changed[4..], "{solver:?}: the other chain");
        }
        for (a, b) in alone[..4].iter().zip(&pushed) {
            assert!(a.distance(*b) < 1e-4, "{solver:?}: {a} {b}");
        }
    }
}

/// What rests by friction goes on, to the bit, where something that it does not touch is moved in each step.
#[test]
fn what_rests_does_not_notice_that_another_is_moved() {
    for solver in SOLVERS {
        let mut world = slope();
        let object = world.object("mark");
        let ball = Shape::new(Geometry::Sphere { radius: 0.1 }).without_contact();
        let mark = object.body("mark").shape(ball).mass(1.0).handle();
        object.prismatic("slide", mark, DVec3::X);
        let model = world.build().unwrap();
        let slide = model.joints.iter().position(|j| j.child.0 == 1).unwrap();
        let at = model.coordinate_range(JointId(slide)).start;
        let [mut alone, mut marked] = [0, 1].map(|_| simulate(model.clone(), solver));
        for step in 0..200 {
            if step >= 100 {
                let outputs = marked.outputs();
                let mut position = outputs.joint_position(0);
                let velocity = outputs.joint_velocity(0);
                position[at] = 0.01 * f64::from(step);
                marked.move_joints(0, &position, &velocity).unwrap();
            }
            alone.step(1);
            marked.step(1);
        }
        let [alone, marked] = [alone, marked].map(|mut sim| {
            let outputs = sim.outputs();
            let moves = outputs.body_velocity(0, BodyId(0));
            (outputs.body_position(0, BodyId(0)), moves)
        });
        assert!(alone.1.length() < 1e-3, "{solver:?}: {alone:?}");
        assert_eq!(alone, marked, "{solver:?}");
    }
}

/// Where one call names a world twice, all is as if the last entry were the only one.
#[test]
fn the_last_of_two_entries_of_a_world_counts() {
    for solver in SOLVERS {
        let mut sims = [0, 1].map(|_| {
            let mut sim = simulate(two_chains(), solver);
            sim.step(100);
            sim
        });
        for i in [0, 1] {
            let outputs = sims[i].outputs();
            let (position, velocity) = (outputs.joint_position(0), outputs.joint_velocity(0));
            let [elsewhere, faster] = [&position, &velocity].map(|x| {
                let more = x.iter().map(|x| x + 0.3);
                more.collect::<Vec<_>>()
            });
            let (first, last) = (
                (0, &elsewhere[..], &faster[..]),
                (0, &position[..], &velocity[..]),
            );
            let moves = [first, last].into_iter().skip(i);
            sims[i].move_joints_of(moves).unwrap();
            sims[i].step(10);

            let velocity = sims[i].outputs().joint_velocity(0);
            let pushes = [(0, &faster[..]), (0, &velocity[..])].into_iter().skip(i);
            sims[i].set_joint_velocities(pushes).unwrap();
            sims[i].step(10);
        }
        let [twice, once] = sims.each_mut().map(|sim| {
            let outputs = sim.outputs();
            (outputs.joint_position(0), outputs.joint_velocity(0))
        });
        assert_eq!(twice, once, "{solver:?}");
    }
}

/// What is pushed is as fast as it was told to be, and has not been accelerated: a body at rest without weight is not, before
/// a step or after.
#[test]
fn a_push_is_no_acceleration() {
    for solver in SOLVERS {
        let mut world = Builder::new("wheel");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let wheel = object.body("wheel").shape(Geometry::Sphere { radius: 0.1 });
        let wheel = wheel.mass(1.0).handle();
        object.revolute("hinge", wheel, DVec3::Z);
        let mut sim = simulate(world.build().unwrap(), solver);
        sim.step(1);
        sim.set_joint_velocities([(0, &[10.0][..])]).unwrap();
        let outputs = sim.outputs();
        assert!((outputs.joint_velocity(0)[0] - 10.0).abs() < 1e-12);
        assert!(outputs.joint_acceleration(0)[0].abs() < 1e-9, "{solver:?}");
    }
}

/// Two wheels that are geared to each other count their turns: they are where they were set, and what is set of a third joint
/// moves neither. `impulse` has no couplings.
#[test]
fn coupled_wheels_count_turns() {
    for solver in [SolverKind::Featherstone, SolverKind::Xpbd] {
        let mut world = Builder::new("gear");
        world.gravity(DVec3::ZERO);
        let object = world.object("");
        let mut part = |name: &str, x: f64| {
            let ball = Shape::new(Geometry::Sphere { radius: 0.1 });
            let part = object.body(name).shape(ball).mass(1.0);
            (part.handle(), Pose::at(DVec3::X * x))
        };
        let [(a, at_a), (b, at_b), (c, at_c)] = [part("a", 0.0), part("b", 1.0), part("c", 5.0)];
        let at = |pose| (pose, Pose::IDENTITY);
        let frames = [at(at_a), at(at_b), at(at_c)];
        let one = object.revolute("one", a, DVec3::Y);
        let one = one.frames(frames[0].0, frames[0].1).handle();
        let two = object.revolute("two", b, DVec3::Y);
        let two = two.frames(frames[1].0, frames[1].1).handle();
        let slide = object.prismatic("slide", c, DVec3::X);
        slide.frames(frames[2].0, frames[2].1);
        object.couple("gear", two, one, -0.5, 0.0);
        let mut sim = simulate(world.build().unwrap(), solver);
        sim.set_joint_state(0, &[0.0; 3], &[4.0, -2.0, 0.0])
            .unwrap();
        sim.step(1000);
        let before = sim.outputs().joint_position(0);
        assert!(before[0] > 7.0, "{solver:?}: {before:?}");
        let velocity = sim.outputs().joint_velocity(0);
        let set = [before[0], before[1], 0.1];
        sim.move_joints(0, &set, &velocity).unwrap();
        sim.step(50);
        let outputs = sim.outputs();
        let (after, speed) = (outputs.joint_position(0), outputs.joint_velocity(0));
        assert!(
            (after[1] + 0.5 * after[0]).abs() < 1e-3,
            "{solver:?}: {after:?}"
        );
        assert!((speed[0] - 4.0).abs() < 1e-2, "{solver:?}: {speed:?}");
    }
}
