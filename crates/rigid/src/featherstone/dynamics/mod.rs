//! Dynamics of trees as functions: mass matrix, inverse and forward dynamics,
//! Jacobians, placements, energy and momentum.
//!
//! The equation of motion of a tree is
//!
//! ```text
//! M(q) q̈ + b(q, q̇) = τ
//! ```
//!
//! [`Dynamics`] answers for one state in `f64`; [`DynamicsKernels`] are the same
//! functions over any [`Machine`], for many worlds in lanes.

mod error;
mod forward_dynamics;
mod inverse_dynamics;
mod jacobian;
mod kernels;
mod mass_matrix;
mod tables;

use crate::output::{body, total};
use crate::{InputTables, Kernels, SolverError};
pub use error::DynamicsError;
use error::finite;
use glam::DVec3;
pub use kernels::DynamicsKernels;
use model::{BodyId, Model, unit_quaternion};
use numbers::{Cpu, Machine, Shared};
use std::ops::Range;
pub use tables::DynamicsTables;

/// Energy and momentum of a tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Totals {
    /// Kinetic energy [J], with that of armatures.
    pub kinetic: f64,
    /// Potential energy [J] of weight and passive springs; zero at the world's origin.
    pub potential: f64,
    /// Linear momentum [kg·m/s] of the bodies, world axes.
    pub momentum: DVec3,
    /// Angular momentum [kg·m²/s] of the bodies about the world's origin, world axes.
    pub angular_momentum: DVec3,
}

/// Dynamics of a tree, for one state at a time.
///
/// Positions have [`Model::coordinates`] numbers, velocities, accelerations and
/// forces [`Model::degrees_of_freedom`] = n, in the model's order and in SI units;
/// matrices come row by row. Quaternions may be of any length but zero. Every function refuses slices of
/// another length and numbers that are not finite, with [`DynamicsError`].
///
/// ```
/// use kinetarium_rigid::Dynamics;
/// use model::examples::{Start, chain};
///
/// let model = chain(3, Start::Horizontal)?;
/// let dynamics = Dynamics::new(&model)?;
/// let q = model.initial_position();
/// let weight = dynamics.inverse_dynamics(&q, &[0.0; 3], &[0.0; 3])?;
/// let falling = dynamics.forward_dynamics(&q, &[0.0; 3], &weight)?;
/// assert!(falling.iter().all(|a| a.abs() < 1e-9)); // held against its weight, it rests
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Dynamics {
    kernels: DynamicsKernels,
    state: Vec<f64>,
    input: Vec<f64>,
    /// Where quaternions lie among the coordinates.
    quaternions: Vec<Range<usize>>,
}

/// The memories of one evaluation.
struct Workspace {
    state: Vec<f64>,
    input: Vec<f64>,
    output: Vec<f64>,
    scratch: Vec<f64>,
}

impl Dynamics {
    /// Compiles a model.
    ///
    /// # Errors
    /// What [`Featherstone::new`](crate::Featherstone::new) refuses: loops, couplings, disabled joints.
    pub fn new(model: &Model) -> Result<Self, SolverError> {
        let kernels = DynamicsKernels::new(model)?;
        let velocity = vec![0.0; model.degrees_of_freedom()];
        let state = kernels.initial(model, &model.initial_position(), &velocity);
        let mut input = InputTables::new(model).initial(model);
        input.resize(kernels.lengths().input, 0.0);
        Ok(Self {
            kernels,
            state,
            input,
            quaternions: model.quaternions().map(|(_, range)| range).collect(),
        })
    }

    /// The same functions over any machine.
    pub fn kernels(&self) -> &DynamicsKernels {
        &self.kernels
    }

    /// M(q), n × n, armatures included: symmetric; kinetic energy is ½ q̇ᵀ M q̇.
    pub fn mass_matrix(&self, position: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        let mut w = self.at(position, None)?;
        self.kernels.mass_matrix(&mut self.machine(&mut w));
        let n = self.dofs();
        Ok(w.output[self.kernels.tables().mass_matrix.at(0, 0)..][..n * n].to_vec())
    }

    /// τ = M(q) q̈ + b(q, q̇) [N or N·m]: what it takes to accelerate so; with q̈ = 0 the bias force.
    pub fn inverse_dynamics(
        &self,
        position: &[f64],
        velocity: &[f64],
        acceleration: &[f64],
    ) -> Result<Vec<f64>, DynamicsError> {
        let mut w = self.at(position, Some(velocity))?;
        finite("accelerations", acceleration, self.dofs())?;
        let tables = self.kernels.tables();
        w.input[tables.acceleration.at(0, 0)..][..acceleration.len()].copy_from_slice(acceleration);
        self.kernels.inverse_dynamics(&mut self.machine(&mut w));
        Ok(w.output[tables.force.at(0, 0)..][..self.dofs()].to_vec())
    }

    /// q̈ = M⁻¹ (τ − b) [m/s² or rad/s²] under the forces τ and weight alone: the model's springs,
    /// dampers, drives, limits and actuators act only through τ; see [`applied_forces`](Self::applied_forces).
    pub fn forward_dynamics(
        &self,
        position: &[f64],
        velocity: &[f64],
        force: &[f64],
    ) -> Result<Vec<f64>, DynamicsError> {
        let mut w = self.at(position, Some(velocity))?;
        finite("forces", force, self.dofs())?;
        let t = &self.kernels.solver.tables;
        w.input[t.input.force.at(0, 0)..][..force.len()].copy_from_slice(force);
        self.kernels.forward_dynamics(&mut self.machine(&mut w));
        Ok(w.output[t.output.acceleration.at(0, 0)..][..self.dofs()].to_vec())
    }

    /// τ [N or N·m] of everything that acts along the degrees of freedom: springs, dampers, drives
    /// (which have followed their targets), limits (but for their inertia), friction, actuators and the
    /// forces of `input`, which lies as [`InputTables`] say.
    pub fn applied_forces(
        &self,
        position: &[f64],
        velocity: &[f64],
        input: &[f64],
    ) -> Result<Vec<f64>, DynamicsError> {
        let mut w = self.at(position, Some(velocity))?;
        finite("inputs", input, self.kernels.solver.tables.input.length)?;
        w.input[..input.len()].copy_from_slice(input);
        self.kernels.applied_forces(&mut self.machine(&mut w));
        Ok(w.output[self.kernels.tables().force.at(0, 0)..][..self.dofs()].to_vec())
    }

    /// J(q), 6 × n, of a point [m] in a body's frame: (ω, ẋ) = J q̇, with the body's angular
    /// velocity ω [rad/s] and the point's velocity ẋ [m/s], both in world axes.
    pub fn jacobian(
        &self,
        position: &[f64],
        body: BodyId,
        point: DVec3,
    ) -> Result<Vec<f64>, DynamicsError> {
        let mut w = self.at(position, None)?;
        finite("coordinates of the point", &point.to_array(), 3)?;
        let bodies = self.kernels.solver.tables.bodies;
        if body.0 >= bodies {
            return Err(DynamicsError::Body {
                body: body.0,
                bodies,
            });
        }
        let tables = self.kernels.tables();
        w.input[tables.point.at(0, 0)..][..3].copy_from_slice(&point.to_array());
        let mut k = self.machine(&mut w);
        let row = k.index(body.0);
        self.kernels.jacobian(&mut k, row);
        let entry = |row: usize, dof: usize| w.output[tables.jacobian.at(dof, row)];
        let n = self.dofs();
        Ok((0..6 * n).map(|i| entry(i / n, i % n)).collect())
    }

    /// Placements and velocities of all bodies: 13 numbers a body, see [`body`].
    pub fn bodies(&self, position: &[f64], velocity: &[f64]) -> Result<Vec<f64>, DynamicsError> {
        let w = self.report(position, velocity)?;
        let t = &self.kernels.solver.tables;
        Ok(w.output[t.output.body.at(0, 0)..][..t.bodies * body::WIDTH].to_vec())
    }

    /// Energy and momentum.
    pub fn totals(&self, position: &[f64], velocity: &[f64]) -> Result<Totals, DynamicsError> {
        let w = self.report(position, velocity)?;
        let row = &w.output[self.kernels.solver.tables.output.total.at(0, 0)..][..total::WIDTH];
        Ok(Totals {
            kinetic: row[total::KINETIC],
            potential: row[total::POTENTIAL],
            momentum: DVec3::from_slice(&row[total::MOMENTUM..]),
            angular_momentum: DVec3::from_slice(&row[total::ANGULAR_MOMENTUM..]),
        })
    }

    fn report(&self, position: &[f64], velocity: &[f64]) -> Result<Workspace, DynamicsError> {
        let mut w = self.at(position, Some(velocity))?;
        self.kernels.solver.report(&mut self.machine(&mut w));
        Ok(w)
    }

    fn dofs(&self) -> usize {
        self.kernels.solver.tables.dofs
    }

    /// Memories that hold a state; without velocities it rests.
    fn at(&self, position: &[f64], velocity: Option<&[f64]>) -> Result<Workspace, DynamicsError> {
        let t = &self.kernels.solver.tables;
        let mut state = self.state.clone();
        finite("coordinates", position, t.coordinates)?;
        let q = &mut state[t.position.at(0, 0)..][..position.len()];
        q.copy_from_slice(position);
        for range in &self.quaternions {
            if !unit_quaternion(&mut q[range.clone()]) {
                return Err(DynamicsError::NoRotation { first: range.start });
            }
        }
        if let Some(velocity) = velocity {
            finite("velocities", velocity, t.dofs)?;
            state[t.velocity.at(0, 0)..][..velocity.len()].copy_from_slice(velocity);
        }
        let lengths = self.kernels.lengths();
        Ok(Workspace {
            state,
            input: self.input.clone(),
            output: vec![0.0; lengths.output],
            scratch: vec![0.0; lengths.scratch],
        })
    }

    fn machine<'a>(&'a self, w: &'a mut Workspace) -> Cpu<'a, f64, Shared<'a, f64>> {
        Cpu {
            state: &mut w.state,
            input: &w.input,
            output: &mut w.output,
            scratch: &mut w.scratch,
            parameters: Shared(self.kernels.parameters()),
            links: self.kernels.links(),
        }
    }
}
