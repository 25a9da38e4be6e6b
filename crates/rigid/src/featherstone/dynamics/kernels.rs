//! The kernels of dynamics, to run on any machine.

use super::tables::DynamicsTables;
use super::{forward_dynamics, inverse_dynamics, jacobian, mass_matrix};
use crate::featherstone::tables::Tables;
use crate::{Featherstone, Kernels, Lengths, Settings, SolverError};
use model::Model;
use numbers::Machine;

/// Dynamics compiled for a model: tables, and kernels over any [`Machine`].
///
/// State and parameters lie as those of [`Featherstone`]; what a kernel reads and
/// writes besides lies in [`tables`](Self::tables), behind the solver's own.
/// Every kernel starts from the coordinates and velocities of the state.
#[derive(Clone, Debug, PartialEq)]
pub struct DynamicsKernels {
    pub(super) solver: Featherstone,
    tables: DynamicsTables,
    links: Vec<u32>,
}

impl DynamicsKernels {
    /// Compiles a model.
    ///
    /// # Errors
    /// What [`Featherstone::new`] refuses: loops, couplings, disabled joints.
    pub fn new(model: &Model) -> Result<Self, SolverError> {
        let solver = Featherstone::new(model, &Settings::new(model.time_step))?;
        let mut links = solver.links().to_vec();
        let tables = DynamicsTables::new(&solver.tables, &mut links);
        Ok(Self {
            solver,
            tables,
            links,
        })
    }
    /// Where the numbers of dynamics lie.
    pub fn tables(&self) -> &DynamicsTables {
        &self.tables
    }
    /// Numbers per world in each memory.
    pub fn lengths(&self) -> Lengths {
        Lengths {
            input: self.tables.input_length,
            output: self.tables.output_length,
            ..self.solver.lengths()
        }
    }
    /// The constants of the model.
    pub fn parameters(&self) -> &[f64] {
        self.solver.parameters()
    }
    /// The whole numbers of the model.
    pub fn links(&self) -> &[u32] {
        &self.links
    }
    /// The state of a world whose joints have the given coordinates and velocities.
    pub fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        self.solver.initial(model, position, velocity)
    }

    /// Fills [`mass_matrix`](DynamicsTables::mass_matrix).
    #[inline(always)]
    pub fn mass_matrix<M: Machine>(&self, k: &mut M) {
        let (t, d) = self.copies();
        mass_matrix::mass_matrix(k, &t, &d);
    }
    /// Fills [`force`](DynamicsTables::force) with what it takes to reach
    /// [`acceleration`](DynamicsTables::acceleration).
    #[inline(always)]
    pub fn inverse_dynamics<M: Machine>(&self, k: &mut M) {
        let (t, d) = self.copies();
        inverse_dynamics::inverse_dynamics(k, &t, &d);
    }
    /// Fills [`OutputTables::acceleration`](crate::OutputTables) with the accelerations under
    /// [`InputTables::force`](crate::InputTables) and no other force than weight.
    #[inline(always)]
    pub fn forward_dynamics<M: Machine>(&self, k: &mut M) {
        let (t, _) = self.copies();
        forward_dynamics::forward_dynamics(k, &t);
    }
    /// Fills [`force`](DynamicsTables::force) with the sum of the model's force laws under the
    /// input. Moves the drives' targets in the state all the way to those of the input.
    #[inline(always)]
    pub fn applied_forces<M: Machine>(&self, k: &mut M) {
        let (t, d) = self.copies();
        forward_dynamics::applied_forces(k, &t, &d);
    }
    /// Fills [`jacobian`](DynamicsTables::jacobian) for the [`point`](DynamicsTables::point) of
    /// the model's body `body`, the same body in all worlds.
    #[inline(always)]
    pub fn jacobian<M: Machine>(&self, k: &mut M, body: M::I) {
        let (t, d) = self.copies();
        jacobian::jacobian(k, &t, &d, body);
    }

    /// Copies on the stack: offsets stay in registers, whatever is written meanwhile.
    #[inline(always)]
    fn copies(&self) -> (Tables, DynamicsTables) {
        (self.solver.tables, self.tables)
    }
}
