//! What cannot be linearised is refused with a message that says why, and what to do.

mod scene;

use kinetarium_derivatives::linearize;
use model::examples::n_pendula;
use rigid::Integrator;
use scene::settings;
use sim::{Simulation, SimulationSettings, SolverKind};

/// Two worlds of a double pendulum.
fn simulation(spoil: impl FnOnce(&mut SimulationSettings)) -> Simulation<f64> {
    let mut settings = settings(Integrator::SemiImplicitEuler, 1);
    settings.worlds = 2;
    spoil(&mut settings);
    let model = n_pendula(2).expect("a model");
    Simulation::new(model, settings).expect("a simulation")
}

#[track_caller]
fn says(simulation: &mut Simulation<f64>, world: usize, message: &str) {
    let error = linearize(simulation, world).expect_err("an error");
    assert_eq!(error.to_string(), message);
}

#[test]
fn a_world_that_does_not_exist() {
    let message = "world 2 does not exist: there are 2, counted from 0";
    says(&mut simulation(|_| {}), 2, message);
}

#[test]
fn solvers_without_derivatives() {
    for (solver, name) in [(SolverKind::Xpbd, "xpbd"), (SolverKind::Impulse, "impulse")] {
        let message = format!(
            "the solver `{name}` does not support derivatives: use the solver `featherstone`, whose \
             state is that of the joints"
        );
        says(&mut simulation(|s| s.solver = solver), 0, &message);
    }
}

#[test]
fn a_world_that_diverged_and_one_that_will() {
    let mut simulation = simulation(|s| s.step.speed_limit = 10.0);
    let set = simulation.set_joint_state(1, &[0.0; 2], &[30.0, 0.0]);
    set.expect("a state");
    let message = "world 1 diverges in the step that is linearised: its speeds leave the speed limit of 10 \
                   or the finite numbers; take a smaller time step, or another state";
    says(&mut simulation, 1, message);
    simulation.step(1);
    let message =
        "world 1 has diverged: reset it, or give it another state, before its step is linearised";
    says(&mut simulation, 1, message);
    assert!(
        linearize(&mut simulation, 0).is_ok(),
        "its neighbour runs on"
    );
    simulation.reset(&[1]).expect("a world");
    assert!(linearize(&mut simulation, 1).is_ok(), "it runs again");
}

#[test]
fn a_model_without_joints_has_empty_matrices() {
    let mut world = model::Builder::new("still");
    world.object("wall").body("wall").immovable();
    let model = world.build().expect("a model");
    let settings = settings(Integrator::SemiImplicitEuler, 1);
    let mut simulation = Simulation::<f64>::new(model, settings).expect("a simulation");
    let step = linearize(&mut simulation, 0).expect("a linearisation");
    assert_eq!((step.dofs, step.controls, step.state.len()), (0, 0, 0));
}
