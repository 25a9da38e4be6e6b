//! What can go wrong on a card.

use numbers::trace::{TraceError, WgslError};
use thiserror::Error;

/// Why worlds do not run on a card.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum CudaError {
    /// There is no driver.
    #[error(
        "no CUDA driver was found: install NVIDIA's, or run on the devices gpu (cards of any maker) or cpu"
    )]
    NoDriver,
    /// There is nothing that compiles kernels.
    #[error(
        "NVRTC, which compiles kernels for CUDA, was not found: `pip install nvidia-cuda-nvrtc-cu12` or install \
         NVIDIA's CUDA toolkit, and let the path of libraries lead there (LD_LIBRARY_PATH; PATH on Windows)"
    )]
    NoCompiler,
    /// There is no such card.
    #[error("there is no CUDA card {ordinal}; found: {found}")]
    NoCard {
        /// Which was asked for, counted from 0.
        ordinal: usize,
        /// What there is.
        found: String,
    },
    /// The kernel cannot be recorded.
    #[error("the solver's kernel cannot be recorded: {0}")]
    Record(#[from] TraceError),
    /// The record has no WGSL, which those of piles go through.
    #[error("the solver's kernel cannot be written in WGSL: {0}")]
    Wgsl(#[from] WgslError),
    /// A text has what is not read.
    #[error("the solver's WGSL cannot be written as CUDA C++: {0}")]
    Read(String),
    /// NVRTC does not take the kernel.
    #[error("NVRTC does not compile the solver's kernel: {0}")]
    Compile(String),
    /// Kernels cannot count so many.
    #[error("of this model, {most} worlds fit into one simulation on a card, not {worlds}")]
    TooMany {
        /// What was asked for.
        worlds: usize,
        /// What there can be.
        most: usize,
    },
    /// The card's memory is full.
    #[error(
        "the memory of the card `{card}` does not hold {bytes} bytes more: simulate fewer worlds"
    )]
    Memory {
        /// What was asked for.
        bytes: usize,
        /// Its name.
        card: String,
    },
    /// The card failed or is gone; what it held is lost.
    #[error("the card `{card}` failed: {reason}; go back to a snapshot in a new simulation")]
    Failed {
        /// Its name.
        card: String,
        /// What it said.
        reason: String,
    },
}
