//! Many worlds side by side in lanes of `f32`: the solver's report, then the mass matrix.

use kinetarium_rigid::{DynamicsKernels, Featherstone, Kernels};
use numbers::dispatch::{Isa, Job, run_block};
use numbers::{Cpu, Float, Lanes, Memory, Shared};

/// State and input of one world.
pub type World = (Vec<f64>, Vec<f64>);

/// Fills the output of every world with the report and the mass matrix.
pub fn evaluate(
    isa: Isa,
    solver: &Featherstone,
    dynamics: &DynamicsKernels,
    worlds: &[World],
) -> Memory<f32> {
    let (lengths, width) = (dynamics.lengths(), f32::BLOCK);
    let mut state = Memory::new(worlds.len(), lengths.state, width);
    let mut input = Memory::new(worlds.len(), lengths.input, width);
    let mut output = Memory::new(worlds.len(), lengths.output, width);
    let mut scratch = Memory::new(width, lengths.scratch, width);
    for (world, (s, i)) in worlds.iter().enumerate() {
        for (offset, &x) in s.iter().enumerate() {
            state.set(world, offset, x as f32);
        }
        for (offset, &x) in i.iter().enumerate() {
            input.set(world, offset, x as f32);
        }
    }
    let parameters: Vec<f32> = solver.parameters().iter().map(|&x| x as f32).collect();
    let (states, outputs) = (state.block_size(), output.block_size());
    for block in 0..output.blocks() {
        let job = BlockJob {
            solver,
            dynamics,
            state: &mut state.scalars_mut()[block * states..][..states],
            input: input.block(block),
            output: &mut output.scalars_mut()[block * outputs..][..outputs],
            scratch: scratch.scalars_mut(),
            parameters: &parameters,
        };
        run_block(isa, job);
    }
    output
}

struct BlockJob<'a> {
    solver: &'a Featherstone,
    dynamics: &'a DynamicsKernels,
    state: &'a mut [f32],
    input: &'a [f32],
    output: &'a mut [f32],
    scratch: &'a mut [f32],
    parameters: &'a [f32],
}

impl Job for BlockJob<'_> {
    type Scalar = f32;
    type Output = ();

    #[inline(always)]
    fn run<R: Lanes<Scalar = f32>>(self) {
        let mut k = Cpu {
            state: bytemuck::cast_slice_mut(self.state),
            input: bytemuck::cast_slice::<f32, R>(self.input),
            output: bytemuck::cast_slice_mut(self.output),
            scratch: bytemuck::cast_slice_mut(self.scratch),
            parameters: Shared(self.parameters),
            links: self.dynamics.links(),
        };
        self.solver.report(&mut k);
        self.dynamics.mass_matrix(&mut k);
    }
}
