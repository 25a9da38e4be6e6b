//! What reads an instrument in worlds on a card.

use crate::compiler::BLOCK;
use crate::kernel::Kernel;
use crate::worlds::MOST;
use crate::{Cuda, CudaError};
use cudarc::driver::CudaSlice;
use numbers::trace::PrintOptions;
use rigid::{Instrument, Lanes};

/// An instrument in a card's memory.
#[derive(Debug)]
pub(crate) struct Reading {
    pub kernel: Kernel,
    pub lanes: Lanes,
    pub scratch: CudaSlice<f32>,
    /// One set of constants for all worlds, or one for each.
    pub parameters: CudaSlice<f32>,
    /// Which of their own constants worlds have, if they have any.
    pub version: Option<u64>,
    pub links: CudaSlice<u32>,
    /// What was read.
    pub numbers: CudaSlice<f32>,
}

impl Reading {
    /// Of so many worlds, which may have constants of their own; none where numbers are more than kernels can count.
    ///
    /// # Errors
    /// The card's memory is full; it has failed before.
    pub fn new(
        card: &Cuda,
        instrument: &Instrument,
        worlds: usize,
        own: bool,
    ) -> Result<Option<Self>, CudaError> {
        let sheet = instrument.sheet();
        let lanes = sheet.lengths.lanes(worlds, BLOCK as usize, MOST);
        let constants = sheet.parameters.len();
        let longest = sheet.lengths.output.max(if own { constants } else { 0 });
        let Some(lanes) = lanes.filter(|_| longest.saturating_mul(worlds) <= MOST) else {
            return Ok(None);
        };
        let options = PrintOptions {
            workgroup_size: BLOCK,
            parameters_per_world: own,
            pieces: lanes.pieces,
            ..PrintOptions::default()
        };
        let parameters = if own {
            card.memory(constants * worlds)?
        } else {
            let numbers: Vec<_> = sheet.parameters.iter().map(|x| *x as f32).collect();
            card.filled(&numbers)?
        };
        Ok(Some(Self {
            kernel: Kernel::new(card, &records::instrument(instrument)?, &options)?,
            scratch: card.memory(lanes.scratch)?,
            parameters,
            version: own.then_some(0),
            links: card.filled(&sheet.links)?,
            numbers: card.memory(sheet.lengths.output * worlds)?,
            lanes,
        }))
    }
}
