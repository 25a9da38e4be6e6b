//! What a simulation asks of a device that does not run all solvers.

use kinetarium_sim::{
    Device, DeviceError, DeviceWorlds, Simulation, SimulationError, SimulationSettings, SolverKind,
};
use model::Model;
use model::examples::{Start, chain, tower};
use rigid::Solver;

/// One that has no memory, and runs no `impulse`.
struct Full;

impl Device<f32> for Full {
    fn name(&self) -> String {
        "full".into()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        _: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        let asked = match solver {
            Solver::Featherstone(_) | Solver::TouchingFeatherstone(_) => "featherstone",
            Solver::Xpbd(_) => "xpbd",
        };
        Err(DeviceError::new(format!("no memory for {asked}")))
    }
}

fn told(model: &Model, solver: SolverKind) -> SimulationError {
    let settings = SimulationSettings {
        solver,
        ..SimulationSettings::new(1, 0.004)
    };
    Simulation::on(&Full, model.clone(), settings)
        .err()
        .unwrap()
}

#[test]
fn auto_takes_what_the_device_runs() {
    let (pile, tree) = (
        tower(3, 0.001).unwrap(),
        chain(3, Start::Horizontal).unwrap(),
    );
    assert_eq!(SolverKind::Auto.pick(&pile, true), SolverKind::Impulse);
    for model in [&pile, &tree] {
        let picked = SolverKind::Auto.pick_on(&Full, model, true);
        assert_eq!(picked, SolverKind::Featherstone);
        let told = told(model, SolverKind::Auto).to_string();
        assert!(told.contains("no memory for featherstone"), "{told}");
    }
}

#[test]
fn a_solver_that_is_named_and_does_not_run_there_is_refused() {
    let told = told(&tower(3, 0.001).unwrap(), SolverKind::Impulse);
    assert!(
        matches!(told, SimulationError::NotOnDevice { .. }),
        "{told}"
    );
    let told = told.to_string();
    assert!(told.contains("impulse") && told.contains("full"), "{told}");
}
