//! Trees of bodies in reduced coordinates: Featherstone's articulated-body algorithm.
//!
//! The step, in order: `kinematics` (placements, velocities), `force` (what
//! acts along each degree of freedom), `articulated_body` (accelerations),
//! `integrate` (the next state).
//!
//! [`dynamics`] are the same kernels as functions: mass matrix, inverse dynamics, Jacobians.
//!
//! Limitations: the gyroscopic torque is explicit, so that a slender free body that
//! spins fast (hundreds of rad/s at 2 ms) gains energy, but with Runge–Kutta; no closed
//! loops (use `xpbd`); joint limits are springs; a motor
//! torque larger than its drive's effort limit is cut, not refused.

mod articulated_body;
pub mod dynamics;
mod force;
mod integrate;
mod kinematics;
mod report;
mod tables;

use crate::output::body;
use crate::{Kernels, Lengths, Settings, SolverError};
pub use force::FRICTION_SPEED;
use model::Model;
use numbers::{Cpu, Machine, Shared};
pub use tables::Tables;

/// How a step advances the state; see [`integrate`](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Integrator {
    /// First order, symplectic, with springs, dampers, drives and limits taken implicitly.
    #[default]
    SemiImplicitEuler,
    /// First order; gains energy. A teaching baseline.
    ExplicitEuler,
    /// Second order where forces do not depend on velocity. A teaching baseline.
    Verlet,
    /// Fourth order; all forces explicit.
    RungeKutta4,
}

impl Integrator {
    /// Evaluations of the accelerations per step.
    pub fn stages(self) -> usize {
        match self {
            Self::SemiImplicitEuler | Self::ExplicitEuler => 1,
            Self::Verlet => 2,
            Self::RungeKutta4 => 4,
        }
    }
}

/// The solver, compiled for a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Featherstone {
    pub(crate) tables: Tables,
    pub(crate) integrator: Integrator,
    parameters: Vec<f64>,
    links: Vec<u32>,
}

impl Featherstone {
    /// Compiles a model.
    ///
    /// # Errors
    /// A closed loop, a distance joint, a coupling or a disabled joint.
    pub fn new(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        tables::check(model)?;
        Ok(Self::of_tree(model, settings))
    }

    /// Compiles the tree of a model, and leaves its loops open.
    pub(crate) fn of_tree(model: &Model, settings: &Settings) -> Self {
        let (tables, mut filler) = Tables::new(model);
        filler.numbers(
            tables.step,
            0,
            0,
            &[settings.substep(), settings.speed_limit],
        );
        Self {
            tables,
            integrator: settings.integrator,
            parameters: filler.parameters,
            links: filler.links,
        }
    }

    /// Placements and velocities of all bodies for given joint coordinates and
    /// velocities: 13 numbers a body, see [`body`].
    pub fn bodies(&self, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        let t = &self.tables;
        let mut state = vec![0.0; t.state_length];
        state[t.position.start()..][..position.len()].copy_from_slice(position);
        state[t.velocity.start()..][..velocity.len()].copy_from_slice(velocity);
        let mut output = vec![0.0; t.output.length];
        let mut k = Cpu {
            state: &mut state,
            input: &[],
            output: &mut output,
            scratch: &mut vec![0.0; t.scratch_length],
            parameters: Shared(&self.parameters),
            links: &self.links,
        };
        kinematics::kinematics(&mut k, t);
        report::bodies(&mut k, t);
        output[t.output.body.start()..][..t.bodies * body::WIDTH].to_vec()
    }
}

impl Kernels for Featherstone {
    fn name(&self) -> &'static str {
        "featherstone"
    }
    fn lengths(&self) -> Lengths {
        Lengths {
            state: self.tables.state_length,
            input: self.tables.input.length,
            output: self.tables.output.length,
            scratch: self.tables.scratch_length,
        }
    }
    fn parameters(&self) -> &[f64] {
        &self.parameters
    }
    fn links(&self) -> &[u32] {
        &self.links
    }
    fn alive(&self) -> usize {
        self.tables.alive.at(0, 0)
    }
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.tables.state_length];
        state[self.alive()] = 1.0;
        self.tables.forces.initial(model, &mut state);
        self.place(position, velocity, &mut state);
        state
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        state[self.tables.position.start()..][..position.len()].copy_from_slice(position);
        state[self.tables.velocity.start()..][..velocity.len()].copy_from_slice(velocity);
    }
    /// Joint coordinates and velocities stay as they are.
    fn take_over(&self, _: &[f64], _: &mut [f64]) {}
    #[inline(always)]
    fn step<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        integrate::step(k, &tables, self.integrator);
    }
    #[inline(always)]
    fn report<M: Machine>(&self, k: &mut M) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let tables = self.tables;
        report::report(k, &tables);
    }
}
