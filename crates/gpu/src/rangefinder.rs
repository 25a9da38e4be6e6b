//! What casts the rays of a rangefinder in worlds on a card.

use crate::memory::{buffer, filled};
use crate::pipeline::OPTIONS;
use crate::worlds::most_numbers;
use crate::{Gpu, GpuError};
use numbers::trace::PrintOptions;
use piles::WORKGROUP;
use rigid::{Lanes, Rangefinder};
use std::sync::{Arc, Weak};

/// Where loops are cut, a thread's go round so often all together.
const ROUNDS: usize = 65_000;

/// A rangefinder in a card's memory.
#[derive(Debug)]
pub(crate) struct Finder {
    finder: Weak<Rangefinder>,
    pub kernel: wgpu::ComputePipeline,
    pub lanes: Lanes,
    pub scratch: wgpu::Buffer,
    pub parameters: wgpu::Buffer,
    pub links: wgpu::Buffer,
    /// Of each part of the worlds, how far its rays got.
    pub distances: Vec<wgpu::Buffer>,
}

impl Finder {
    /// Of so many parts of so many worlds; none where their distances, or the shapes, do not fit in a buffer, or where
    /// loops are cut that are as long.
    ///
    /// # Errors
    /// The card is out of memory, or has failed.
    pub fn new(
        gpu: &Gpu,
        finder: &Arc<Rangefinder>,
        (parts, width): (usize, usize),
    ) -> Result<Option<Self>, GpuError> {
        let (lengths, most) = (finder.lengths(), most_numbers(gpu));
        let lanes = lengths.lanes(width, WORKGROUP as usize, most);
        let constants = finder.parameters().len().max(finder.links().len());
        let fits = lengths.output * width <= most && constants <= most;
        let is_cut = gpu.cuts_loops() && finder.rounds() > ROUNDS;
        let Some(lanes) = lanes.filter(|_| fits && !is_cut) else {
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
            finder: Arc::downgrade(finder),
            lanes,
        }))
    }
    /// Whether it is this one's.
    pub fn is_of(&self, finder: &Arc<Rangefinder>) -> bool {
        std::ptr::eq(self.finder.as_ptr(), Arc::as_ptr(finder))
    }
    /// Whether anybody may still cast its rays.
    pub fn lives(&self) -> bool {
        self.finder.strong_count() > 0
    }
}
