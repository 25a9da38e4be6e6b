//! From a block of worlds in memory to a kernel on a machine.

use crate::jobs::{
    self, Lane, begin, contacts, finish, joints, motion, narrow_phase, report, steps,
};
use model::{Model, ShapeId};
use numbers::Float;
use rigid::{Instrument, Kernels, Lengths, OutputTables, Report};
use std::any::Any;
use std::ops::Range;

/// What to do with a block.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Task {
    /// Advance by so many substeps.
    Step(usize),
    /// Fill the output.
    Report(Report),
}

/// One block of worlds: as many as a register has lanes, or one.
pub(crate) struct Block<'a, T> {
    /// Which of its simulation's blocks it is.
    pub number: usize,
    pub state: &'a mut [T],
    pub input: &'a [T],
    pub output: &'a mut [T],
    pub scratch: &'a mut [T],
    /// The constants of the model, in lanes.
    pub parameters: &'a [T],
    /// The same, a number each, where all worlds have them in common; else none.
    pub common: &'a [T],
    pub links: &'a [u32],
}

/// A solver at a precision, with its lane type still to be chosen.
pub(crate) trait Engine<T: Float>: Send + Sync {
    fn name(&self) -> &'static str;
    /// The solver itself.
    fn as_any(&self) -> &dyn Any;
    fn lengths(&self) -> Lengths;
    fn outputs(&self) -> OutputTables;
    fn contact_shapes(&self) -> &[[ShapeId; 2]];
    fn parameters(&self) -> &[f64];
    fn links(&self) -> &[u32];
    fn alive(&self) -> usize;
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64>;
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]);
    fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]);
    /// Where in the state bodies are and move, of solvers for which these are more than coordinates and velocities of joints.
    fn motion(&self) -> Vec<Range<usize>>;
    /// Where in the state the targets lie that drives follow with a lag.
    fn targets(&self) -> Vec<Range<usize>>;
    fn take_over(&self, bodies: &[f64], state: &mut [f64]);
    /// The share of the stiffness along each degree of freedom that acts.
    fn acting(&self, model: &Model) -> Vec<f64> {
        vec![1.0; model.degrees_of_freedom()]
    }
    /// Whether worlds are run one at a time, and several threads can work on one.
    fn shares_a_world(&self) -> bool {
        false
    }
    /// Drops what is kept of a world that has other constants now.
    fn forget(&self, _world: usize) {}
    /// Runs a task on a block, with so many threads of the current pool.
    fn run(&self, lane: Lane, team: usize, block: Block<'_, T>, task: Task);
    /// Reads an instrument: by no solver, but its kernels are compiled with theirs, and never again.
    fn measure(&self, lane: Lane, instrument: &Instrument, block: &mut Block<'_, T>) {
        jobs::measure(lane, instrument, block);
    }
}

impl<K: Kernels, T: Float> Engine<T> for K {
    fn name(&self) -> &'static str {
        Kernels::name(self)
    }
    fn as_any(&self) -> &dyn Any {
        self
    }
    fn lengths(&self) -> Lengths {
        Kernels::lengths(self)
    }
    fn outputs(&self) -> OutputTables {
        Kernels::outputs(self)
    }
    fn contact_shapes(&self) -> &[[ShapeId; 2]] {
        Kernels::contact_shapes(self)
    }
    fn parameters(&self) -> &[f64] {
        Kernels::parameters(self)
    }
    fn links(&self) -> &[u32] {
        Kernels::links(self)
    }
    fn alive(&self) -> usize {
        Kernels::alive(self)
    }
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        Kernels::initial(self, model, position, velocity)
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        Kernels::place(self, position, velocity, state);
    }
    fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]) {
        Kernels::push(self, position, velocities, state);
    }
    fn motion(&self) -> Vec<Range<usize>> {
        Kernels::motion(self)
    }
    fn targets(&self) -> Vec<Range<usize>> {
        Kernels::targets(self)
    }
    fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        Kernels::take_over(self, bodies, state);
    }
    fn run(&self, lane: Lane, _: usize, mut block: Block<'_, T>, task: Task) {
        match task {
            Task::Report(Report::Joints) => joints::run(lane, self, &mut block, 0),
            Task::Report(Report::Motion) => motion::run(lane, self, &mut block, 0),
            Task::Report(Report::Contacts) => contacts::run(lane, self, &mut block, 0),
            Task::Report(Report::Everything) => report::run(lane, self, &mut block, 0),
            Task::Step(substeps) => {
                if K::TOUCHES {
                    for _ in 0..substeps {
                        touching_step(lane, self, &mut block);
                    }
                } else {
                    steps::run(lane, self, &mut block, substeps);
                }
            }
        }
    }
}

/// A substep, with each kernel for pairs as a function of its own.
fn touching_step<K: Kernels, T: Float>(lane: Lane, kernels: &K, block: &mut Block<'_, T>) {
    for stage in 0..kernels.stages() {
        begin::run(lane, kernels, block, stage);
        if let Some(contacts) = kernels.contacts() {
            narrow_phase(lane, contacts, block);
        }
        finish::run(lane, kernels, block, stage);
    }
}
