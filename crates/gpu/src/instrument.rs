//! What reads an instrument in worlds on a card.

use crate::memory::{buffer, filled};
use crate::pipeline::OPTIONS;
use crate::worlds::{Part, most_numbers};
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
    pub buffers: Buffers,
    /// Which of their own constants worlds have, if they have any.
    pub version: Option<u64>,
}

/// What reads worlds.
#[derive(Debug)]
pub(crate) struct Way {
    pub kernel: wgpu::ComputePipeline,
    /// What it sees of each part of the worlds.
    pub seen: Vec<wgpu::BindGroup>,
    /// Of each part, or those that all have. Behind them, of worlds that are listed, stands the list.
    links: Vec<wgpu::Buffer>,
}

/// What all ways of reading have in common.
#[derive(Debug)]
pub(crate) struct Buffers {
    scratch: wgpu::Buffer,
    /// Of each part, its constants, or those that all have.
    pub parameters: Vec<wgpu::Buffer>,
    /// Of each part, what was read.
    pub numbers: Vec<wgpu::Buffer>,
}

impl Buffers {
    /// A way to read parts of so many worlds.
    fn way(
        &self,
        gpu: &Gpu,
        (parts, width): (&[Part], usize),
        kernel: wgpu::ComputePipeline,
        links: Vec<wgpu::Buffer>,
    ) -> Way {
        let launch = gpu.uniform(&[width as u32, 1]);
        let own = self.numbers.iter().zip(&self.parameters).zip(&links);
        // What the solver is told and has reported is what this kernel is given.
        let seen = parts.iter().zip(own).map(|(part, ((read, own), links))| {
            let (input, output) = (&part.input, &part.output);
            let buffers = [input, output, read, &self.scratch, own, links, &launch];
            gpu.bindings(gpu.layout(), &buffers)
        });
        Way {
            seen: seen.collect(),
            kernel,
            links,
        }
    }
}

impl Reading {
    /// Of parts of so many worlds, which may have constants of their own; none where numbers do not fit in a buffer,
    /// or where loops are cut that are as long.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn new(
        gpu: &Gpu,
        instrument: &Instrument,
        (parts, width): (&[Part], usize),
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
        let of_each_part = |numbers: usize| {
            let buffers = parts.iter().map(|_| buffer(gpu, numbers as u64));
            buffers.collect::<Result<Vec<_>, _>>()
        };
        let parameters = if own {
            of_each_part(constants)?
        } else {
            let numbers: Vec<_> = sheet.parameters.iter().map(|x| *x as f32).collect();
            vec![filled(gpu, &numbers)?; parts.len()]
        };
        let buffers = Buffers {
            scratch: buffer(gpu, lanes.scratch as u64)?,
            parameters,
            numbers: of_each_part(numbers)?,
        };
        let kernel = gpu.printed(&records::instrument(instrument)?, &options(lanes, own))?;
        let links = vec![filled(gpu, &sheet.links)?; parts.len()];
        Ok(Some(Self {
            all: buffers.way(gpu, (parts, width), kernel, links),
            few: None,
            lanes,
            buffers,
            version: own.then_some(0),
        }))
    }

    /// Lists the worlds of each part, of so many, that are to be read.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn list(
        &mut self,
        gpu: &Gpu,
        instrument: &Instrument,
        (parts, width): (&[Part], usize),
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
                let with_lists = parts.iter().map(|_| filled(gpu, &with_room));
                let with_lists = with_lists.collect::<Result<_, _>>()?;
                let kernel = gpu.printed(&records::instrument(instrument)?, &options)?;
                none.insert(self.buffers.way(gpu, (parts, width), kernel, with_lists))
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
