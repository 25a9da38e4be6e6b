//! What every solver is.

use crate::contacts::{narrow_phase, narrow_phase_in_parts};
use crate::{ContactTables, Featherstone, Integrator, OutputTables, TouchingFeatherstone, Xpbd};
use model::{Model, ShapeId};
use numbers::Machine;
use numbers::trace::PIECE;
use std::any::Any;
use std::ops::Range;

/// Numbers per world in each memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub struct Lengths {
    pub state: usize,
    pub input: usize,
    pub output: usize,
    pub scratch: usize,
}

/// Invocations of a card that step worlds side by side, each of them one world after the other, and their scratch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Lanes {
    /// How many: whole workgroups.
    pub count: usize,
    /// Numbers of scratch of each, where scratch lies in pieces (`PrintOptions::pieces`); none where worlds do not fill a
    /// workgroup, and it lies as their input does.
    pub pieces: Option<u32>,
    /// Numbers of scratch in all.
    pub scratch: usize,
}

/// Most invocations: what they have of scratch, worlds beyond them share.
const MOST_LANES: usize = 65_536;

impl Lengths {
    /// Numbers of the memory of which each world has most, at least 1: what says how many worlds fit into a buffer.
    pub fn longest(&self) -> usize {
        self.state.max(self.input).max(self.output).max(1)
    }
    /// The invocations that step so many worlds, in workgroups of that size, with at most so many numbers of scratch; none
    /// if that is too little.
    pub fn lanes(&self, worlds: usize, workgroup: usize, most: usize) -> Option<Lanes> {
        if worlds < workgroup {
            let scratch = self.scratch * worlds;
            let few = Lanes {
                count: workgroup,
                pieces: None,
                scratch,
            };
            return (scratch <= most).then_some(few);
        }
        debug_assert!(
            workgroup.is_multiple_of(PIECE as usize),
            "{workgroup} lanes"
        );
        let room = most / self.scratch.max(1);
        let lanes = worlds.next_multiple_of(workgroup).min(MOST_LANES).min(room);
        let count = lanes - lanes % workgroup;
        (count > 0).then_some(Lanes {
            count,
            pieces: Some(self.scratch as u32),
            scratch: self.scratch * count,
        })
    }
}

/// How to step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Time step [s].
    pub time_step: f64,
    /// Substeps per step; a solver's own step is `time_step / substeps`.
    pub substeps: usize,
    /// Passes over all constraints per substep; `xpbd` only.
    pub iterations: usize,
    /// How a `featherstone` step advances the state.
    pub integrator: Integrator,
    /// Passes of a `featherstone` step over the contacts, at most; it ends as soon as all agree.
    /// One more is made where a limit was taken to act and does not, or the other way round, and a few where a point is
    /// left that pulls with ten times a body's weight.
    pub contact_passes: usize,
    /// Passes of projected Gauss–Seidel over the contacts between bodies that move; `xpbd`: over all
    /// contacts, in each pass over the constraints; `impulse`: small steps, of one pass each.
    pub contact_iterations: usize,
    /// A world in which a speed exceeds this [m/s or rad/s] has diverged.
    pub speed_limit: f64,
    /// Bodies slower than this [m/s] for half a second sleep until touched; `impulse` only. 0: never.
    pub sleep_speed: f64,
    /// Factor on every position correction; `xpbd` only. 1 is the plain method.
    pub relaxation: f64,
    /// Rate at which bodies lose angular velocity [1/s]; `xpbd` only.
    pub angular_damping: f64,
    /// Largest correction of a joint per pass [m]; `xpbd` only. Reported when it bites.
    pub displacement_cap: f64,
    /// Largest force of a joint [N]; `xpbd` only. Reported when it bites.
    pub force_cap: f64,
}

impl Settings {
    /// A time step [s], one substep, one iteration, semi-implicit Euler, no caps.
    pub fn new(time_step: f64) -> Self {
        Self {
            time_step,
            substeps: 1,
            iterations: 1,
            integrator: Integrator::SemiImplicitEuler,
            contact_passes: 2,
            contact_iterations: 8,
            speed_limit: 1e5,
            sleep_speed: 0.01,
            relaxation: 1.0,
            angular_damping: 0.0,
            displacement_cap: f64::INFINITY,
            force_cap: f64::INFINITY,
        }
    }
    /// Length of a solver's own step [s].
    pub fn substep(&self) -> f64 {
        self.time_step / self.substeps as f64
    }
}

/// Why a solver cannot take a model or a setting.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolverError {
    /// A solver of trees alone was given a loop.
    #[error(
        "`{joint}` closes a loop or couples joints, and this takes trees alone: leave it out of the model, or step a \
         simulation, whose solvers take it"
    )]
    ClosedLoop {
        /// Name of the joint or coupling.
        joint: String,
    },
    /// Reduced coordinates cannot let a joint go.
    #[error(
        "joint `{joint}` is disabled, which `featherstone` cannot simulate: use the solver `xpbd`"
    )]
    DisabledJoint {
        /// Name of the joint.
        joint: String,
    },
    /// More shapes may touch than tables have room for.
    #[error(
        "{solver} has room for a contact at every point where two shapes may touch, and the {shapes} shapes of this model \
         have more than {most}: use the solver `impulse`, which finds pairs as they come near, or keep shapes apart by \
         masks, groups or exclusions"
    )]
    TooManyContacts {
        /// Name of the solver.
        solver: &'static str,
        /// How many shapes the model has.
        shapes: usize,
        /// How many points there may be.
        most: usize,
    },
    /// The solver lacks something the model uses.
    #[error("{solver} does not support {what} of `{name}`: {remedy}")]
    Unsupported {
        /// Name of the solver.
        solver: &'static str,
        /// What is not supported.
        what: &'static str,
        /// Joint, body or actuator that uses it.
        name: String,
        /// What to do instead.
        remedy: &'static str,
    },
}

/// A solver compiled for a model: tables, and kernels over any machine.
///
/// The numbers of a world lie in the layout that the solver chose; positions
/// and velocities of joints go in through [`initial`](Kernels::initial) and come
/// out through [`report`](Kernels::report) in the layout of
/// [`OutputTables`](crate::OutputTables), the same for all solvers.
///
/// A substep is its stages one after the other, each of them [`begin`](Kernels::begin), the
/// [kernels for pairs](ContactTables::meet), and [`finish`](Kernels::finish). They can run as a whole
/// ([`step`](Kernels::step)) or each as a function of its own: the kernels for pairs together are far
/// larger than any solver, and compilers take much longer for one large function than for many.
pub trait Kernels: Clone + Send + Sync + 'static {
    /// Whether shapes can touch.
    const TOUCHES: bool;
    /// Whether one world's steps are worth compiling for many registers; see
    /// [`Job::MANY_REGISTERS`](numbers::dispatch::Job::MANY_REGISTERS).
    const MANY_REGISTERS: bool;
    /// The solver's name.
    fn name(&self) -> &'static str;
    /// Numbers per world in each memory.
    fn lengths(&self) -> Lengths;
    /// Where the reported numbers lie.
    fn outputs(&self) -> OutputTables;
    /// The shapes of each row of [`OutputTables::contact`]; the normal points to the second.
    fn contact_shapes(&self) -> &[[ShapeId; 2]] {
        &[]
    }
    /// The constants of the model it was compiled for.
    fn parameters(&self) -> &[f64];
    /// The whole numbers of the model: the same for all models of one topology.
    fn links(&self) -> &[u32];
    /// Offset in the state of the number that is 1 while a world runs and 0 once it diverged.
    fn alive(&self) -> usize;
    /// The state of a world whose joints have the given coordinates and velocities.
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64>;
    /// Gives the joints of a state other coordinates and velocities; all else in it stays.
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]);
    /// Changes the velocities of the joints of a state, which have these coordinates, from some to others; all else in it
    /// stays, and what else bodies move by.
    fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]);
    /// Where in the state bodies are and move, of solvers for which these are more than coordinates and velocities of joints.
    fn motion(&self) -> Vec<Range<usize>> {
        Vec::new()
    }
    /// Where in the state the targets lie that drives follow with a lag.
    fn targets(&self) -> Vec<Range<usize>>;
    /// Takes over the state of a model with other numbers, in which the bodies stood and moved
    /// as `bodies` says, 13 numbers each: see [`body`](crate::body).
    fn take_over(&self, bodies: &[f64], state: &mut [f64]);
    /// Where shapes that touch lie; none where they pass through each other.
    fn contacts(&self) -> Option<&ContactTables>;
    /// Stages of a substep.
    fn stages(&self) -> usize;
    /// The first half of a stage: what comes before the contacts are found.
    fn begin<M: Machine>(&self, k: &mut M, stage: M::I);
    /// The second half of a stage, from the contacts on.
    fn finish<M: Machine>(&self, k: &mut M, stage: M::I);
    /// Advances every lane by one substep.
    #[inline(always)]
    fn step<M: Machine>(&self, k: &mut M) {
        for stage in k.count(self.stages()) {
            self.begin(k, stage);
            if Self::TOUCHES
                && let Some(tables) = self.contacts()
            {
                narrow_phase(k, tables);
            }
            self.finish(k, stage);
        }
    }
    /// As [`step`](Kernels::step), in parts that are called: compiled in seconds, where the other takes
    /// minutes, for what need not be fast: machines that record, tests.
    fn step_in_parts<M: Machine>(&self, k: &mut M) {
        #[inline(never)]
        fn begin<K: Kernels, M: Machine>(kernels: &K, k: &mut M, stage: M::I) {
            kernels.begin(k, stage);
        }
        #[inline(never)]
        fn finish<K: Kernels, M: Machine>(kernels: &K, k: &mut M, stage: M::I) {
            kernels.finish(k, stage);
        }
        for stage in k.count(self.stages()) {
            begin(self, k, stage);
            if Self::TOUCHES
                && let Some(tables) = self.contacts()
            {
                narrow_phase_in_parts(k, tables);
            }
            finish(self, k, stage);
        }
    }
    /// Fills in where joints are and how they move; of the rest of the output nothing is said.
    fn report_joints<M: Machine>(&self, k: &mut M);
    /// The same of bodies, too.
    fn report_motion<M: Machine>(&self, k: &mut M);
    /// The same, and the contacts of the last step.
    fn report_contacts<M: Machine>(&self, k: &mut M);
    /// Fills the output from the state.
    fn report<M: Machine>(&self, k: &mut M);
}

/// A solver that other machines than processors can run, with the constants of a model.
#[derive(Clone, Copy, Debug)]
pub enum Solver<'a> {
    /// Trees without contacts.
    Featherstone(&'a Featherstone),
    /// Trees with contacts.
    TouchingFeatherstone(&'a TouchingFeatherstone),
    /// Bodies in maximal coordinates.
    Xpbd(&'a Xpbd),
}

impl<'a> Solver<'a> {
    /// What these kernels are; none of them where they are of another solver.
    pub fn of(kernels: &'a dyn Any) -> Option<Self> {
        let plain = || kernels.downcast_ref().map(Self::Featherstone);
        let touching = || kernels.downcast_ref().map(Self::TouchingFeatherstone);
        let maximal = || kernels.downcast_ref().map(Self::Xpbd);
        plain().or_else(touching).or_else(maximal)
    }
}

/// How much of the output is worked out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Report {
    /// Where joints are, and how they move.
    Joints,
    /// The same of bodies, too.
    Motion,
    /// The same, and the contacts of the last step.
    Contacts,
    /// Everything.
    Everything,
}
