//! What reads an instrument in worlds on a card.

use crate::memory::{buffer, filled};
use crate::pipeline::OPTIONS;
use crate::worlds::most_numbers;
use crate::{Gpu, GpuError};
use numbers::trace::PrintOptions;
use piles::WORKGROUP;
use rigid::{Instrument, Lanes};

/// Where loops are cut, a thread's go round so often all together.
const ROUNDS: usize = 65_000;

/// An instrument in a card's memory.
#[derive(Debug)]
pub(crate) struct Reading {
    pub kernel: wgpu::ComputePipeline,
    pub lanes: Lanes,
    pub scratch: wgpu::Buffer,
    /// One set of constants for all worlds, or those of each part of them.
    parameters: Vec<wgpu::Buffer>,
    /// Which of their own constants worlds have, if they have any.
    pub version: Option<u64>,
    pub links: wgpu::Buffer,
    /// Of each part of the worlds, what was read.
    pub numbers: Vec<wgpu::Buffer>,
}

impl Reading {
    /// Of so many parts of so many worlds, which may have constants of their own; none where numbers do not fit in a buffer,
    /// or where loops are cut that are as long.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn new(
        gpu: &Gpu,
        instrument: &Instrument,
        (parts, width): (usize, usize),
        own: bool,
    ) -> Result<Option<Self>, GpuError> {
        let (sheet, most) = (instrument.sheet(), most_numbers(gpu));
        let lanes = sheet.lengths.lanes(width, WORKGROUP as usize, most);
        let constants = sheet.parameters.len() * if own { width } else { 1 };
        let numbers = sheet.lengths.output * width;
        let longest = constants.max(numbers).max(sheet.links.len());
        let is_cut = gpu.cuts_loops() && sheet.rounds > ROUNDS;
        let Some(lanes) = lanes.filter(|_| longest <= most && !is_cut) else {
            return Ok(None);
        };
        let options = PrintOptions {
            parameters_per_world: own,
            pieces: lanes.pieces,
            ..OPTIONS
        };
        let parameters = if own {
            let buffers = (0..parts).map(|_| buffer(gpu, constants as u64));
            buffers.collect::<Result<_, _>>()?
        } else {
            let numbers: Vec<_> = sheet.parameters.iter().map(|x| *x as f32).collect();
            vec![filled(gpu, &numbers)?]
        };
        let numbers = (0..parts).map(|_| buffer(gpu, numbers as u64));
        Ok(Some(Self {
            kernel: gpu.printed(&records::instrument(instrument)?, &options)?,
            scratch: buffer(gpu, lanes.scratch as u64)?,
            parameters,
            version: own.then_some(0),
            links: filled(gpu, &sheet.links)?,
            numbers: numbers.collect::<Result<_, _>>()?,
            lanes,
        }))
    }
    /// The constants of a part.
    pub fn parameters(&self, part: usize) -> &wgpu::Buffer {
        &self.parameters[part.min(self.parameters.len() - 1)]
    }
}
