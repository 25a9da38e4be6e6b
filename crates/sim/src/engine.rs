//! From a block of worlds in memory to a kernel on a machine.

use model::Model;
use numbers::dispatch::{Isa, Job, run_registers, run_single};
use numbers::{Cpu, Float, Lanes, PerWorld};
use rigid::{Kernels, Lengths, OutputTables};

/// What to do with a block.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Task {
    /// Advance by so many substeps.
    Step(usize),
    /// Fill the output.
    Report,
}

/// One block of worlds: as many as a register has lanes, or one.
pub(crate) struct Block<'a, T> {
    pub state: &'a mut [T],
    pub input: &'a [T],
    pub output: &'a mut [T],
    pub scratch: &'a mut [T],
    /// The constants of the model, in lanes.
    pub parameters: &'a [T],
    pub links: &'a [u32],
}

/// A solver at a precision, with its lane type still to be chosen.
pub(crate) trait Engine<T: Float>: Send + Sync {
    fn name(&self) -> &'static str;
    fn lengths(&self) -> Lengths;
    fn outputs(&self) -> OutputTables;
    fn parameters(&self) -> &[f64];
    fn links(&self) -> &[u32];
    fn alive(&self) -> usize;
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64>;
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]);
    fn take_over(&self, bodies: &[f64], state: &mut [f64]);
    /// Runs a task on a block of [`Isa::width`] worlds, or of one.
    fn run(&self, isa: Isa, single: bool, block: Block<'_, T>, task: Task);
}

impl<K: Kernels, T: Float> Engine<T> for K {
    fn name(&self) -> &'static str {
        Kernels::name(self)
    }
    fn lengths(&self) -> Lengths {
        Kernels::lengths(self)
    }
    fn outputs(&self) -> OutputTables {
        Kernels::outputs(self)
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
    fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        Kernels::take_over(self, bodies, state);
    }
    fn run(&self, isa: Isa, single: bool, block: Block<'_, T>, task: Task) {
        let job = BlockJob {
            kernels: self,
            block,
            task,
        };
        if single {
            run_single(isa, job)
        } else {
            run_registers(isa, job)
        }
    }
}

struct BlockJob<'a, K, T> {
    kernels: &'a K,
    block: Block<'a, T>,
    task: Task,
}

impl<K: Kernels, T: Float> Job for BlockJob<'_, K, T> {
    type Scalar = T;
    type Output = ();

    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let b = self.block;
        let (state, input) = (
            bytemuck::cast_slice_mut(b.state),
            bytemuck::cast_slice(b.input),
        );
        let output = bytemuck::cast_slice_mut(b.output);
        let scratch = bytemuck::cast_slice_mut(b.scratch);
        let parameters = PerWorld::<R>(bytemuck::cast_slice(b.parameters));
        let mut cpu = Cpu {
            state,
            input,
            output,
            scratch,
            parameters,
            links: b.links,
        };
        match self.task {
            Task::Step(substeps) => {
                for _ in 0..substeps {
                    self.kernels.step(&mut cpu);
                }
            }
            Task::Report => self.kernels.report(&mut cpu),
        }
    }
}
