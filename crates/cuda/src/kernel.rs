//! Kernels, and what is launched. Rust cannot see that what they are given is what they take: it is looked after here.

#![allow(unsafe_code)]

use crate::compiler::BLOCK;
use crate::piles::Bindings;
use crate::{Cuda, CudaError, wgsl};
use cudarc::driver::{CudaFunction, CudaSlice, LaunchConfig, PushKernelArg};
use numbers::trace::{PIECE, PrintOptions, Program};
use std::ops::Range;

/// So many threads, at least.
fn threads(count: u32) -> LaunchConfig {
    shape(count.div_ceil(BLOCK), BLOCK)
}

/// So many blocks of so many threads.
fn shape(blocks: u32, threads: u32) -> LaunchConfig {
    LaunchConfig {
        grid_dim: (blocks, 1, 1),
        block_dim: (threads, 1, 1),
        shared_mem_bytes: 0,
    }
}

/// A record, compiled.
#[derive(Clone, Debug)]
pub(crate) struct Kernel(CudaFunction);

impl Kernel {
    pub fn new(card: &Cuda, program: &Program, options: &PrintOptions) -> Result<Self, CudaError> {
        let text = program.to_cuda(options);
        Ok(Self(card.function(&text, "step")?))
    }
}

/// An entry point of a text, compiled: it sees as many buffers as the text binds.
#[derive(Clone, Debug)]
pub struct Bound {
    function: CudaFunction,
    /// Threads in a block.
    size: u32,
    buffers: usize,
}

impl Bound {
    /// Those of a WGSL text of these names.
    pub(crate) fn all<const N: usize>(
        card: &Cuda,
        text: &str,
        names: [&str; N],
    ) -> Result<[Self; N], CudaError> {
        let translated = card.translated(text)?;
        let mut all = Vec::with_capacity(N);
        for name in names {
            let size = translated.threads.get(name).copied();
            let size = size.ok_or_else(|| CudaError::Read(format!("no entry point `{name}`")))?;
            all.push(Self {
                function: card.function(&translated.text, &wgsl::kernel_name(name))?,
                size,
                buffers: translated.buffers,
            });
        }
        let all = <[Self; N]>::try_from(all);
        all.map_err(|_| CudaError::Read("other entry points than were asked for".to_owned()))
    }
    /// Runs it in so many blocks, or in as many of these as stand at an address, which must be that of a word of the card's.
    pub(crate) fn run(
        &self,
        card: &Cuda,
        bindings: &Bindings,
        blocks: u32,
        told: Option<u64>,
    ) -> Result<(), CudaError> {
        assert_eq!(bindings.places.len(), self.buffers);
        if blocks == 0 {
            return Ok(());
        }
        let mut launch = card.stream().launch_builder(&self.function);
        bindings.places.iter().for_each(|place| {
            launch.arg(place);
        });
        let told = told.unwrap_or(0);
        launch.arg(&told);
        // Safety: these are the parameters of what `wgsl` prints, in their order: a pointer for each buffer, which its
        // bindings keep, and the number of blocks, if any. What is read and written there is what the WGSL reads and writes:
        // texts of `piles`, which stay within their buffers.
        card.told(unsafe { launch.launch(shape(blocks, self.size)) })?;
        Ok(())
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
        // within the lengths that its record gives, times the worlds, state in whole pieces, and scratch as its lanes have
        // it, as `Worlds` allocates them.
        card.told(unsafe { launch.launch(threads(self.lanes)) })?;
        Ok(())
    }
}

/// What copies numbers of worlds that lie in pieces.
fn copier(card: &Cuda, name: &str) -> Result<CudaFunction, CudaError> {
    card.function(include_str!("placement.cu"), name)
}

/// Numbers of a state that lies in pieces.
pub(crate) fn state_numbers(numbers: usize, worlds: usize) -> usize {
    numbers * worlds.next_multiple_of(PIECE as usize)
}

/// The columns of some worlds, each with so many numbers: `columns[number][i]` of world `places[i]`.
pub(crate) struct Placement<'a> {
    pub places: &'a [u32],
    pub columns: &'a [f32],
    /// Worlds whose numbers lie together: all of them where a memory has no pieces.
    pub piece: usize,
}

impl Placement<'_> {
    /// Writes them into a memory of so many worlds.
    pub fn write(
        &self,
        card: &Cuda,
        worlds: usize,
        memory: &mut CudaSlice<f32>,
    ) -> Result<(), CudaError> {
        let place = copier(card, "place")?;
        let (count, numbers) = (self.places.len(), self.columns.len() / self.places.len());
        let inside = self.places.iter().all(|world| (*world as usize) < worlds);
        assert!(inside && numbers * worlds.next_multiple_of(self.piece) <= memory.len());
        let [count, numbers, piece] = [count, numbers, self.piece].map(|n| n as u32);
        let (columns, places) = (card.filled(self.columns)?, card.filled(self.places)?);
        let mut launch = card.stream().launch_builder(&place);
        launch.arg(memory).arg(&columns).arg(&places);
        launch.arg(&count).arg(&numbers).arg(&piece);
        // Safety: these are the parameters of `place`, in their order, which writes where was just looked.
        card.told(unsafe { launch.launch(threads(count)) })?;
        Ok(())
    }
}

/// Copies rows of the state of so many worlds, each with so many numbers, one row after the other.
pub(crate) fn gather(
    card: &Cuda,
    rows: Range<usize>,
    [numbers, worlds]: [usize; 2],
    state: &CudaSlice<f32>,
    into: &mut CudaSlice<f32>,
) -> Result<(), CudaError> {
    let gather = copier(card, "gather")?;
    assert!(rows.end <= numbers && state_numbers(numbers, worlds) <= state.len());
    assert!(rows.len() * worlds <= into.len());
    let [first, count, numbers, worlds] =
        [rows.start, rows.len(), numbers, worlds].map(|n| n as u32);
    let mut launch = card.stream().launch_builder(&gather);
    launch.arg(state).arg(into);
    launch.arg(&first).arg(&count).arg(&numbers).arg(&worlds);
    launch.arg(&PIECE);
    // Safety: these are the parameters of `gather`, in their order, which reads and writes where was just looked.
    card.told(unsafe { launch.launch(threads(worlds)) })?;
    Ok(())
}
