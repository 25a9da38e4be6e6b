//! Targets that drives follow with a lag stay where they have come to when joints are moved.

use glam::DVec3;
use kinetarium_sim::{Simulation, SimulationSettings, SolverKind};
use model::{Builder, Drive, Geometry, Model};

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

/// Moved to where its target has come to, an arm stays there.
#[test]
fn moved_joints_keep_the_targets_of_their_drives() {
    for solver in [
        SolverKind::Featherstone,
        SolverKind::Xpbd,
        SolverKind::Impulse,
    ] {
        for ball in [false, true] {
            let settings = SimulationSettings {
                solver,
                ..SimulationSettings::new(2, 0.002)
            };
            let mut sim = Simulation::<f64>::new(arm(ball), settings).unwrap();
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
