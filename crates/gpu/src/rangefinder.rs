//! What casts the rays of a rangefinder in worlds on a card.

use crate::memory::{buffer, filled};
use crate::pipeline::OPTIONS;
use crate::worlds::most_numbers;
use crate::{Gpu, GpuError};
use numbers::trace::PrintOptions;
use piles::WORKGROUP;
use rigid::{Lanes, Rangefinder};

/// A rangefinder in a card's memory.
#[derive(Debug)]
pub(crate) struct Finder {
    pub finder: Rangefinder,
    pub kernel: wgpu::ComputePipeline,
    pub lanes: Lanes,
    pub scratch: wgpu::Buffer,
    pub parameters: wgpu::Buffer,
    pub links: wgpu::Buffer,
    /// Of each part of the worlds, how far its rays got.
    pub distances: Vec<wgpu::Buffer>,
}

impl Finder {
    /// Of so many parts of so many worlds; none where their distances, or the shapes, do not fit in a buffer.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn new(
        gpu: &Gpu,
        finder: &Rangefinder,
        (parts, width): (usize, usize),
    ) -> Result<Option<Self>, GpuError> {
        let (lengths, most) = (finder.lengths(), most_numbers(gpu));
        let lanes = lengths.lanes(width, WORKGROUP as usize, most);
        let constants = finder.parameters().len().max(finder.links().len());
        let Some(lanes) = lanes.filter(|_| lengths.output * width <= most && constants <= most)
        else {
            return Ok(None);
        };
        let options = PrintOptions {
            pieces: lanes.pieces,
            ..OPTIONS
        };
        let numbers: Vec<_> = finder.parameters().iter().map(|x| *x as f32).collect();
        let distances = (0..parts).map(|_| buffer(gpu, (lengths.output * width) as u64));
        Ok(Some(Self {
            kernel: gpu.printed(&records::ranges(finder)?, &options)?,
            scratch: buffer(gpu, lanes.scratch as u64)?,
            parameters: filled(gpu, &numbers)?,
            links: filled(gpu, finder.links())?,
            distances: distances.collect::<Result<_, _>>()?,
            finder: finder.clone(),
            lanes,
        }))
    }
}
