//! What casts the rays of a rangefinder in worlds on a card.

use crate::compiler::BLOCK;
use crate::kernel::Kernel;
use crate::worlds::MOST;
use crate::{Cuda, CudaError};
use cudarc::driver::CudaSlice;
use numbers::trace::PrintOptions;
use rigid::{Lanes, Rangefinder};
use std::sync::{Arc, Weak};

/// A rangefinder in a card's memory.
#[derive(Debug)]
pub(crate) struct Finder {
    finder: Weak<Rangefinder>,
    pub kernel: Kernel,
    pub lanes: Lanes,
    pub scratch: CudaSlice<f32>,
    pub parameters: CudaSlice<f32>,
    pub links: CudaSlice<u32>,
    /// How far its rays got.
    pub distances: CudaSlice<f32>,
}

impl Finder {
    /// Of so many worlds; none where their distances are more than kernels can count.
    ///
    /// # Errors
    /// The card's memory is full; it has failed before.
    pub fn new(
        card: &Cuda,
        finder: &Arc<Rangefinder>,
        worlds: usize,
    ) -> Result<Option<Self>, CudaError> {
        let lengths = finder.lengths();
        let lanes = lengths.lanes(worlds, BLOCK as usize, MOST);
        let Some(lanes) = lanes.filter(|_| lengths.output.saturating_mul(worlds) <= MOST) else {
            return Ok(None);
        };
        let options = PrintOptions {
            workgroup_size: BLOCK,
            pieces: lanes.pieces,
            ..PrintOptions::default()
        };
        let numbers: Vec<_> = finder.parameters().iter().map(|x| *x as f32).collect();
        Ok(Some(Self {
            kernel: Kernel::new(card, &records::ranges(finder)?, &options)?,
            scratch: card.memory(lanes.scratch)?,
            parameters: card.filled(&numbers)?,
            links: card.filled(finder.links())?,
            distances: card.memory(lengths.output * worlds)?,
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
