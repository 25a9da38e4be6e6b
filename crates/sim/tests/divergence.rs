//! A world that leaves the finite numbers stops where it last was, and no other notices.

mod scene;

use kinetarium_sim::{Diverged, Simulation, SimulationSettings};
use model::Model;
use numbers::Float;
use scene::{BOTH, METHODS, TIME_STEP, chain, hash, hashes, mixed, motion, scatter, scattered};

const WORLDS: usize = 21;
/// The one that is led astray; worlds before and after it are in its block.
const LOST: usize = 5;

/// What leads a world astray.
#[derive(Clone, Copy, Debug)]
enum Cause {
    /// The last velocity is this.
    Speed(f64),
    /// The force on the last degree of freedom is this.
    Force(f64),
}

fn lead_astray<T: Float>(simulation: &mut Simulation<T>, world: usize, cause: Cause) {
    let dofs = simulation.model().degrees_of_freedom();
    match cause {
        Cause::Speed(v) => {
            let (position, mut velocity) = joint_state(simulation, world);
            velocity[dofs - 1] = v;
            simulation
                .set_joint_state(world, &position, &velocity)
                .unwrap();
        }
        Cause::Force(f) => simulation
            .controls()
            .set_dof_force(world, dofs - 1, f)
            .unwrap(),
    }
}

fn joint_state<T: Float>(simulation: &mut Simulation<T>, world: usize) -> (Vec<f64>, Vec<f64>) {
    let outputs = simulation.outputs();
    (outputs.joint_position(world), outputs.joint_velocity(world))
}

/// Every number that is reported of a world.
fn all_outputs<T: Float>(simulation: &mut Simulation<T>, world: usize) -> Vec<f64> {
    let mut all = motion(simulation, world);
    let joints = simulation.model().joints.len();
    let outputs = simulation.outputs();
    all.extend(outputs.joint_acceleration(world));
    for joint in 0..joints {
        let (force, torque) = outputs.reaction(world, model::JointId(joint));
        all.extend([force.to_array(), torque.to_array()].concat());
    }
    all.extend([
        outputs.kinetic_energy(world),
        outputs.potential_energy(world),
    ]);
    all.extend(outputs.momentum(world).to_array());
    all.extend(outputs.angular_momentum(world).to_array());
    all
}

/// One world of many diverges: it is found once, stands still with its time, and can be reset;
/// all others move as if it were not there.
fn stops_alone<T: Float>(model: &Model, settings: SimulationSettings, cause: Cause) {
    let case = format!("{} in {settings:?}, {cause:?}", model.name);
    let mut untouched = scattered::<T>(model, settings, |w| w);
    untouched.step(40);

    let mut simulation = scattered::<T>(model, settings, |w| w);
    simulation.step(10);
    lead_astray(&mut simulation, LOST, cause);
    let started = simulation.time(LOST);
    let before = motion(&mut simulation, LOST);

    let time = started + TIME_STEP;
    let found = [Diverged { world: LOST, time }];
    assert_eq!(simulation.step(1), found, "{case}");
    assert_eq!(simulation.step(10), [], "{case}: reported twice");
    assert_eq!(simulation.diverged(), found, "{case}");
    assert_eq!(simulation.time(LOST), time, "{case}");
    // Position-based dynamics measures joint coordinates from its bodies, joint by joint not
    // quite closed, and anew in the substep that is taken back.
    let coordinates = before.len() - 13 * model.bodies.len();
    let after = motion(&mut simulation, LOST);
    assert_eq!(
        after[coordinates..],
        before[coordinates..],
        "{case}: not at its last state"
    );
    for (a, b) in after.iter().zip(&before) {
        assert!(
            (a - b).abs() <= 1e-3 * (1.0 + b.abs()),
            "{case}: not at its last state: {a} was {b}"
        );
    }
    let outputs = all_outputs(&mut simulation, LOST);
    assert!(outputs.iter().all(|x| x.is_finite()), "{case}: {outputs:?}");

    simulation.step(19);
    for world in (0..WORLDS).filter(|&w| w != LOST) {
        let (found, expected) = (hash(&mut simulation, world), hash(&mut untouched, world));
        assert_eq!(found, expected, "{case}: world {world}");
    }

    simulation.reset(&[LOST]).unwrap();
    assert_eq!(simulation.diverged(), [], "{case}");
    assert_eq!(simulation.time(LOST), 0.0, "{case}");
    scatter(&mut simulation, LOST, LOST);
    assert_eq!(simulation.step(40), [], "{case}");
    assert_eq!(
        hash(&mut simulation, LOST),
        hash(&mut untouched, LOST),
        "{case}: after reset"
    );
}

fn all_stop_alone(model: &Model) {
    for method in METHODS {
        let lanes = method.settings(WORLDS);
        for cause in [Cause::Speed(1e8), Cause::Speed(-1e9), Cause::Force(1e30)] {
            for settings in [
                lanes,
                SimulationSettings {
                    scalar: true,
                    ..lanes
                },
            ] {
                stops_alone::<f32>(model, settings, cause);
                stops_alone::<f64>(model, settings, cause);
            }
        }
    }
}

#[test]
fn a_world_of_a_chain_stops_alone() {
    all_stop_alone(&chain());
}

#[test]
fn a_world_of_a_mixed_tree_stops_alone() {
    all_stop_alone(&mixed());
}

#[test]
fn several_worlds_are_reported_when_they_diverge() {
    for method in BOTH {
        let mut simulation = scattered::<f32>(&chain(), method.settings(WORLDS), |w| w);
        lead_astray(&mut simulation, 20, Cause::Force(1e30));
        lead_astray(&mut simulation, 3, Cause::Speed(1e7));
        let both = [3, 20].map(|world| Diverged {
            world,
            time: TIME_STEP,
        });
        assert_eq!(simulation.step(1), both);
        lead_astray(&mut simulation, 0, Cause::Force(1e30));
        let later = Diverged {
            world: 0,
            time: 3.0 * TIME_STEP,
        };
        let found = simulation.step(2).to_vec();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].world, later.world);
        assert!((found[0].time - later.time).abs() < 1e-12);
        assert_eq!(simulation.diverged(), [both[0], both[1], found[0]]);
        simulation.reset_all();
        assert_eq!(simulation.diverged(), []);
        assert_eq!(simulation.step(10), []);
    }
}

/// All joints of every world diverge at the bound of what is taken, whatever the speed limit.
#[test]
fn no_state_or_control_that_is_taken_leaves_the_finite_numbers() {
    for method in METHODS {
        let mut settings = method.settings(WORLDS);
        settings.step.speed_limit = 1e9;
        for model in [mixed(), chain()] {
            let mut simulation = scattered::<f32>(&model, settings, |w| w);
            for world in 0..WORLDS {
                let (mut position, mut velocity) = joint_state(&mut simulation, world);
                for (i, v) in velocity
                    .iter_mut()
                    .enumerate()
                    .filter(|(i, _)| i % 3 == world % 3)
                {
                    *v = if i % 2 == 0 { 1e9 } else { -1e9 };
                }
                if world % 2 == 0 {
                    position[world % model.coordinates()] = 1e9;
                }
                simulation
                    .set_joint_state(world, &position, &velocity)
                    .unwrap();
                let mut controls = simulation.controls();
                for dof in (0..velocity.len()).filter(|i| i % 4 == world % 4) {
                    controls.set_dof_force(world, dof, -1e30).unwrap();
                    controls.set_target(world, dof, 1e9).unwrap();
                    controls.set_target_velocity(world, dof, -1e9).unwrap();
                }
                controls
                    .set_control(world, &vec![1e30; model.actuators.len()])
                    .unwrap();
            }
            for _ in 0..5 {
                simulation.step(1);
                for world in 0..WORLDS {
                    let seen = motion(&mut simulation, world);
                    assert!(
                        seen.iter().all(|x| x.is_finite()),
                        "{method:?} {world}: {seen:?}"
                    );
                }
            }
            assert!(!simulation.diverged().is_empty());
        }
    }
}

#[test]
fn the_speed_limit_is_where_a_world_diverges() {
    for method in BOTH {
        let mut settings = method.settings(2);
        settings.step.speed_limit = 2.0;
        let mut simulation = Simulation::<f64>::new(chain(), settings).unwrap();
        let rest = [0.0; 5];
        // The one falls from the horizontal; the other hangs.
        simulation.set_joint_state(1, &rest, &rest).unwrap();
        while simulation.step(1).is_empty() {
            assert!(
                simulation.time(0) < 1.0,
                "{method:?}: it falls faster than that"
            );
        }
        assert_eq!(simulation.diverged().len(), 1);
        assert_eq!(simulation.diverged()[0].world, 0);
        let speed = simulation.outputs().joint_velocity(0)[0].abs();
        assert!(speed > 1.0 && speed <= 2.0, "{method:?}: {speed}");

        settings.step.speed_limit = 100.0;
        let mut simulation = Simulation::<f64>::new(chain(), settings).unwrap();
        assert_eq!(simulation.step(500), [], "{method:?}");
    }
}

#[test]
fn a_state_that_is_set_runs_again_and_a_model_that_is_set_does_not() {
    for method in BOTH {
        let mut simulation = scattered::<f32>(&mixed(), method.settings(WORLDS), |w| w);
        lead_astray(&mut simulation, LOST, Cause::Speed(1e8));
        simulation.step(1);
        let stopped = hash(&mut simulation, LOST);
        simulation.set_world_model(LOST, &mixed()).unwrap();
        simulation.step(3);
        assert_eq!(simulation.diverged().len(), 1, "{method:?}");
        if method != BOTH[1] {
            assert_eq!(hash(&mut simulation, LOST), stopped);
        }
        assert_eq!(simulation.time(LOST), TIME_STEP);

        scatter(&mut simulation, LOST, 1);
        assert_eq!(simulation.step(3), []);
        assert!(simulation.diverged().is_empty());
        let mut expected = scattered::<f32>(&mixed(), method.settings(WORLDS), |w| w);
        expected.step(3);
        assert_eq!(
            hash(&mut simulation, LOST),
            hash(&mut expected, 1),
            "{method:?}"
        );
    }
}

/// Spare lanes, and worlds that have stopped, cost no other world its bits.
#[test]
fn a_block_in_which_all_but_one_have_stopped_goes_on() {
    for method in BOTH {
        let mut simulation = scattered::<f32>(&mixed(), method.settings(WORLDS), |w| w);
        for world in (0..WORLDS).filter(|&w| w != LOST) {
            lead_astray(&mut simulation, world, Cause::Force(-1e30));
        }
        assert_eq!(simulation.step(40).len(), WORLDS - 1);
        let mut untouched = scattered::<f32>(&mixed(), method.settings(WORLDS), |w| w);
        untouched.step(40);
        assert_eq!(
            hashes(&mut simulation)[LOST],
            hashes(&mut untouched)[LOST],
            "{method:?}"
        );
    }
}
