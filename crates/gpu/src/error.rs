//! What can go wrong on a card.

use numbers::trace::{TraceError, WgslError};
use piles::TooLarge;
use thiserror::Error;

/// Why worlds do not run on a card.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// No card suits the choice.
    #[error(transparent)]
    NoCard(#[from] adapter::NoCard),
    /// The card refuses.
    #[error("the graphics card cannot be used: {0}; run on the CPU")]
    Refused(#[from] wgpu::RequestDeviceError),
    /// The kernel cannot be recorded.
    #[error("the solver's kernel cannot be recorded: {0}")]
    Record(#[from] TraceError),
    /// The record has no WGSL.
    #[error("the solver's kernel cannot be written in WGSL: {0}")]
    Wgsl(#[from] WgslError),
    /// A buffer is too small.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    /// The card's memory is full.
    #[error(
        "the memory of the card `{card}` does not hold {bytes} bytes more: simulate fewer worlds"
    )]
    Memory {
        /// What was asked for.
        bytes: u64,
        /// Its name.
        card: String,
    },
    /// The card failed or is gone; what it held is lost.
    #[error(
        "the card `{card}` failed: {reason}; open the card anew and go back to a snapshot there, or on the device cpu"
    )]
    Failed {
        /// Its name.
        card: String,
        /// What it said.
        reason: String,
    },
}
