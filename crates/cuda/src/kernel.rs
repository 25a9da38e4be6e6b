//! Kernels, and what is launched. Rust cannot see that what they are given is what they take: it is looked after here.

#![allow(unsafe_code)]

use crate::compiler::{self, BLOCK};
use crate::{Cuda, CudaError};
use cudarc::driver::{CudaFunction, CudaSlice, LaunchConfig, PushKernelArg};
use numbers::trace::Program;

/// So many threads, at least.
fn threads(count: u32) -> LaunchConfig {
    LaunchConfig {
        grid_dim: (count.div_ceil(BLOCK), 1, 1),
        block_dim: (BLOCK, 1, 1),
        shared_mem_bytes: 0,
    }
}

/// A record, compiled.
#[derive(Clone, Debug)]
pub(crate) struct Kernel(CudaFunction);

impl Kernel {
    pub fn new(
        card: &Cuda,
        program: &Program,
        parameters_per_world: bool,
        pieces: Option<u32>,
    ) -> Result<Self, CudaError> {
        let text = compiler::text(program, parameters_per_world, pieces);
        Ok(Self(card.function(&text, "step")?))
    }
}

/// What a kernel sees: memories as long as the tables of its record need.
pub(crate) struct Launch<'a> {
    pub state: &'a mut CudaSlice<f32>,
    pub input: &'a CudaSlice<f32>,
    pub output: &'a mut CudaSlice<f32>,
    pub scratch: &'a mut CudaSlice<f32>,
    pub parameters: &'a CudaSlice<f32>,
    pub links: &'a CudaSlice<u32>,
    pub worlds: u32,
    /// Threads.
    pub lanes: u32,
    /// How often the kernel runs, one time after the other.
    pub rounds: u32,
}

impl Launch<'_> {
    pub fn run(self, card: &Cuda, kernel: &Kernel) -> Result<(), CudaError> {
        card.check()?;
        let mut launch = card.stream().launch_builder(&kernel.0);
        launch.arg(self.state).arg(self.input).arg(self.output);
        launch.arg(self.scratch).arg(self.parameters);
        launch.arg(self.links).arg(&self.worlds).arg(&self.rounds);
        // Safety: these are the parameters of what `to_cuda` prints, in their order. It reads and writes the memories
        // within the lengths that its record gives, times the worlds, and scratch as its lanes have it, as `Worlds` allocates them.
        card.told(unsafe { launch.launch(threads(self.lanes)) })?;
        Ok(())
    }
}

/// The columns of some of so many worlds: `columns[number][i]` of world `places[i]`.
pub(crate) struct Placement<'a> {
    pub places: &'a [u32],
    pub columns: &'a [f32],
    pub worlds: u32,
}

impl Placement<'_> {
    /// Writes them.
    pub fn write(&self, card: &Cuda, state: &mut CudaSlice<f32>) -> Result<(), CudaError> {
        let place = card.function(include_str!("placement.cu"), "place")?;
        let (count, numbers) = (self.places.len(), self.columns.len() / self.places.len());
        let inside = self.places.iter().all(|world| *world < self.worlds);
        assert!(inside && numbers * self.worlds as usize <= state.len());
        let (count, numbers) = (count as u32, numbers as u32);
        let (columns, places) = (card.filled(self.columns)?, card.filled(self.places)?);
        let mut launch = card.stream().launch_builder(&place);
        launch.arg(state).arg(&columns).arg(&places);
        launch.arg(&count).arg(&numbers).arg(&self.worlds);
        // Safety: these are the parameters of `place`, in their order, which writes where was just looked.
        card.told(unsafe { launch.launch(threads(count)) })?;
        Ok(())
    }
}
