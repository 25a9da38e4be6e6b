//! What reads an instrument in worlds on a card.

use crate::memory::{buffer, filled};
use crate::pipeline::OPTIONS;
use crate::worlds::most_numbers;
use crate::{Gpu, GpuError};
use numbers::trace::PrintOptions;
use piles::{NUMBER, WORKGROUP};
use rigid::{Instrument, Lanes};

/// Where loops are cut, a thread's go round so often all together.
const ROUNDS: usize = 65_000;

/// An instrument in a card's memory.
#[derive(Debug)]
pub(crate) struct Reading {
    all: Way,
    /// The same of the worlds that are listed, once that was wanted.
    few: Option<Way>,
    pub lanes: Lanes,
    pub scratch: wgpu::Buffer,
    /// One set of constants for all worlds, or those of each part of them.
    parameters: Vec<wgpu::Buffer>,
    /// Which of their own constants worlds have, if they have any.
    pub version: Option<u64>,
    /// Of each part of the worlds, what was read.
    pub numbers: Vec<wgpu::Buffer>,
}

/// What reads worlds.
#[derive(Debug)]
pub(crate) struct Way {
    pub kernel: wgpu::ComputePipeline,
    /// One set for all parts, or one for each, behind which its list stands.
    links: Vec<wgpu::Buffer>,
}

impl Way {
    /// The links of a part.
    pub fn links(&self, part: usize) -> &wgpu::Buffer {
        &self.links[part.min(self.links.len() - 1)]
    }
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
        let links = sheet.links.len() + 1 + width;
        let longest = constants.max(numbers).max(links);
        let is_cut = gpu.cuts_loops() && sheet.rounds > ROUNDS;
        let Some(lanes) = lanes.filter(|_| longest <= most && !is_cut) else {
            return Ok(None);
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
            all: Way {
                kernel: gpu.printed(&records::instrument(instrument)?, &options(lanes, own))?,
                links: vec![filled(gpu, &sheet.links)?],
            },
            few: None,
            scratch: buffer(gpu, lanes.scratch as u64)?,
            parameters,
            version: own.then_some(0),
            numbers: numbers.collect::<Result<_, _>>()?,
            lanes,
        }))
    }
    /// The constants of a part.
    pub fn parameters(&self, part: usize) -> &wgpu::Buffer {
        &self.parameters[part.min(self.parameters.len() - 1)]
    }

    /// Lists the worlds of each part, of so many, that are to be read.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn list(
        &mut self,
        gpu: &Gpu,
        instrument: &Instrument,
        width: usize,
        lists: &[Vec<u32>],
    ) -> Result<(), GpuError> {
        let links = &instrument.sheet().links;
        let few = match &mut self.few {
            Some(few) => few,
            none => {
                let options = PrintOptions {
                    listed: Some(links.len() as u32),
                    ..options(self.lanes, self.version.is_some())
                };
                let with_room = [links, &vec![0; 1 + width][..]].concat();
                let buffers = lists.iter().map(|_| filled(gpu, &with_room));
                none.insert(Way {
                    kernel: gpu.printed(&records::instrument(instrument)?, &options)?,
                    links: buffers.collect::<Result<_, _>>()?,
                })
            }
        };
        for (buffer, list) in few.links.iter().zip(lists) {
            let words = [&[list.len() as u32], &list[..]].concat();
            let at = links.len() as u64 * NUMBER;
            let bytes = bytemuck::cast_slice(&words);
            gpu.queue().write_buffer(buffer, at, bytes);
        }
        Ok(())
    }
    /// What reads all worlds, or those that were listed.
    pub fn way(&self, listed: bool) -> &Way {
        self.few.as_ref().filter(|_| listed).unwrap_or(&self.all)
    }
}

/// How an instrument is printed for worlds that have constants of their own, or not.
fn options(lanes: Lanes, own: bool) -> PrintOptions {
    PrintOptions {
        parameters_per_world: own,
        pieces: lanes.pieces,
        ..OPTIONS
    }
}
