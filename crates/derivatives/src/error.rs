//! Why a step cannot be linearised.

use sim::SimulationError;

/// Why a step has no derivative here. The simulation is as before.
#[derive(Debug, thiserror::Error)]
pub enum LinearizeError {
    /// The call makes no sense.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The solver's state is not that of the joints.
    #[error(
        "the solver `{solver}` does not support derivatives: use the solver `featherstone`, whose state \
         is that of the joints"
    )]
    Solver {
        /// Name of the solver.
        solver: &'static str,
    },
    /// A world that stands still has no step.
    #[error(
        "world {world} has diverged: reset it, or give it another state, before its step is linearised"
    )]
    Diverged {
        /// Which world.
        world: usize,
    },
    /// The step itself leaves the finite numbers, or the speed limit.
    #[error(
        "world {world} diverges in the step that is linearised: its speeds leave the speed limit of {limit} \
         or the finite numbers; take a smaller time step, or another state"
    )]
    Diverges {
        /// Which world.
        world: usize,
        /// Largest speed allowed [m/s or rad/s].
        limit: f64,
    },
}
