//! Trees of bodies in reduced coordinates: Featherstone's articulated-body algorithm.
//!
//! The step, in order: `kinematics` (placements, velocities), `force` (what
//! acts along each degree of freedom), `contact` (what touches what does not move),
//! `articulated_body` (accelerations), `gauss_seidel` (contacts between bodies that
//! move, with `closing`, joints that close loops, and `coupling`, gears, whose rows are `locked`), `integrate` (the
//! next state).
//!
//! [`dynamics`] are the same kernels as functions: mass matrix, inverse dynamics, Jacobians.
//!
//! Limitations: the gyroscopic torque is that of the step's beginning, but of bodies that float freely with
//! semi-implicit Euler (`rigid/src/gyroscopic.rs`); closed loops and
//! couplings with semi-implicit Euler only, in time that grows with the cube of the rows that they lock (nets: use
//! `xpbd`); joints of the tree do not give way; joint limits are springs; a
//! drive's effort is cut at its limit, but not what is given besides. Contacts have no
//! continuous collision beyond a step's own way. Of the blows in a row of bodies that touch, only the first is elastic:
//! the row shares it out in that step (cradles: use `impulse`).

mod articulated_body;
mod closing;
mod contact;
mod couples;
mod coupling;
pub mod dynamics;
mod factor;
mod force;
pub(crate) mod forest;
mod friction;
mod gauss_seidel;
mod integrate;
mod kinematics;
mod limit;
mod locked;
mod report;
pub(crate) mod tables;
mod tied;
mod turning;
mod wheel;

use crate::output::body;
use crate::{ContactTables, Kernels, Lengths, OutputTables, Settings, SolverError};
pub use friction::FRICTION_SPEED;
use model::{Model, ShapeId};
use numbers::machine::space::State;
use numbers::{Cpu, Machine, Shared, Table};
use std::ops::Range;
pub use tables::Tables;
use tables::{NAME, Scope};

/// How a step advances the state; see [`integrate`](self).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Integrator {
    /// First order, symplectic; dampers and limits are taken implicitly, and springs, drives and servos as far as they are too
    /// stiff for the step.
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
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::SemiImplicitEuler,
        Self::ExplicitEuler,
        Self::Verlet,
        Self::RungeKutta4,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::SemiImplicitEuler => "semi_implicit_euler",
            Self::ExplicitEuler => "explicit_euler",
            Self::Verlet => "verlet",
            Self::RungeKutta4 => "runge_kutta_4",
        }
    }
    /// Evaluations of the accelerations per step.
    pub fn stages(self) -> usize {
        match self {
            Self::SemiImplicitEuler | Self::ExplicitEuler => 1,
            Self::Verlet => 2,
            Self::RungeKutta4 => 4,
        }
    }
}

/// Rows locked by loops and couplings up to which this solver is the better choice: time grows with their cube.
const FEW_ROWS: usize = 64;

/// Whether a model is what this solver is for: a tree that is rigid where its joints lock, with few loops.
pub fn suits(model: &Model) -> bool {
    tables::is_rigid(model) && tables::locked_rows(model).is_some_and(|rows| rows <= FEW_ROWS)
}

/// The articulated-body algorithm compiled for a model, with contacts or without.
///
/// Whether bodies touch, or close loops, is a constant, so that what does neither pays nothing, in time and in
/// code.
#[derive(Clone, Debug, PartialEq)]
pub struct ArticulatedBodies<const CONTACTS: bool> {
    pub(crate) tables: Tables,
    pub(crate) integrator: Integrator,
    parameters: Vec<f64>,
    links: Vec<u32>,
    contact_shapes: Vec<[ShapeId; 2]>,
}

/// The solver for trees whose bodies pass through each other.
pub type Featherstone = ArticulatedBodies<false>;

/// The solver for bodies that touch, or close loops.
pub type TouchingFeatherstone = ArticulatedBodies<true>;

impl Featherstone {
    /// Compiles the tree of a model, and leaves its loops open.
    pub(crate) fn of_tree(model: &Model, settings: &Settings) -> Self {
        let compiled = Self::compile(model, Scope::Tree, settings);
        compiled.expect("a tree without contacts has nothing to refuse")
    }
}

impl TouchingFeatherstone {
    /// Compiles a model whose bodies pass through each other, but whose loops are closed, and couplings hold.
    ///
    /// # Errors
    /// As [`new`](Self::new), shapes aside.
    pub fn without_contacts(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        tables::check(model, Scope::Loops, settings)?;
        Self::compile(model, Scope::Loops, settings)
    }
}

impl<const CONTACTS: bool> ArticulatedBodies<CONTACTS> {
    /// Compiles a model.
    ///
    /// # Errors
    /// A disabled joint of the tree. Without contacts, a joint that closes a loop, and a coupling; with them, these
    /// together with another integrator than semi-implicit Euler, and a shape that no kernel collides.
    pub fn new(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        let scope = if CONTACTS {
            Scope::Contacts
        } else {
            Scope::Tree
        };
        tables::check(model, scope, settings)?;
        Self::compile(model, scope, settings)
    }

    fn compile(model: &Model, scope: Scope, settings: &Settings) -> Result<Self, SolverError> {
        let (tables, filler, contact_shapes) = Tables::new(model, scope, settings)?;
        Ok(Self {
            tables,
            integrator: settings.integrator,
            parameters: filler.parameters,
            links: filler.links,
            contact_shapes,
        })
    }

    /// Where the joint coordinates lie in a world's state, in the model's order.
    pub fn position_table(&self) -> Table<State> {
        self.tables.position
    }
    /// Where the joint velocities lie in a world's state, in the model's order.
    pub fn velocity_table(&self) -> Table<State> {
        self.tables.velocity
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

impl<const CONTACTS: bool> Kernels for ArticulatedBodies<CONTACTS> {
    const TOUCHES: bool = CONTACTS;
    const MANY_REGISTERS: bool = true;
    fn name(&self) -> &'static str {
        NAME
    }
    fn lengths(&self) -> Lengths {
        Lengths {
            state: self.tables.state_length,
            input: self.tables.input.length,
            output: self.tables.output.length,
            scratch: self.tables.scratch_length,
        }
    }
    fn outputs(&self) -> OutputTables {
        self.tables.output
    }
    fn contact_shapes(&self) -> &[[ShapeId; 2]] {
        &self.contact_shapes
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
        self.tables.kept.initial(&mut state);
        self.place(position, velocity, &mut state);
        state
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        state[self.tables.recent.start()..][..self.tables.recents].fill(0.0);
        state[self.tables.position.start()..][..position.len()].copy_from_slice(position);
        state[self.tables.velocity.start()..][..velocity.len()].copy_from_slice(velocity);
    }
    fn push(&self, _: &[f64], [_, velocity]: [&[f64]; 2], state: &mut [f64]) {
        state[self.tables.velocity.start()..][..velocity.len()].copy_from_slice(velocity);
    }
    fn targets(&self) -> Vec<Range<usize>> {
        self.tables.forces.targets()
    }
    /// Joint coordinates and velocities stay as they are.
    fn take_over(&self, _: &[f64], _: &mut [f64]) {}
    fn contacts(&self) -> Option<&ContactTables> {
        CONTACTS.then_some(&self.tables.contacts)
    }
    fn stages(&self) -> usize {
        self.integrator.stages()
    }
    #[inline(always)]
    fn begin<M: Machine>(&self, k: &mut M, stage: M::I) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let tables = self.tables;
        integrate::begin::<M, CONTACTS>(k, &tables, self.integrator, stage);
    }
    #[inline(always)]
    fn finish<M: Machine>(&self, k: &mut M, stage: M::I) {
        let tables = self.tables;
        integrate::finish::<M, CONTACTS>(k, &tables, self.integrator, stage);
    }
    #[inline(always)]
    fn report_joints<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::joints(k, &tables);
    }
    #[inline(always)]
    fn report_motion<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::motion(k, &tables);
    }
    #[inline(always)]
    fn report_contacts<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::contacts::<M, CONTACTS>(k, &tables);
    }
    #[inline(always)]
    fn report<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::report::<M, CONTACTS>(k, &tables);
    }
}
