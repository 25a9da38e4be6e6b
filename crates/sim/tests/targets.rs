//! What joints that are moved, or pushed, keep: the targets that their drives follow with a lag, and of what is pushed all
//! but velocities.

use glam::{DQuat, DVec3};
use kinetarium_sim::{Event, EventKind, Simulation, SimulationSettings, SolverKind, Watch};
use model::{BodyId, Builder, Drive, Geometry, Model, Pose, Shape};

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
fn slope() -> Model {
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
    world.build().unwrap()
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

        let mut sim = simulate(slope(), solver);
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
