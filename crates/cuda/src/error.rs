//! What can go wrong on a card.

use numbers::trace::{TraceError, WgslError};
use piles::TooLarge;
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
    /// The card is older than what kernels are compiled for.
    #[error(
        "the card `{card}` has compute capability {}.{}, and kernels need {}.{}, as cards since Turing (2018) have it: run \
         on the devices gpu (cards of any maker) or cpu",
        .found.0, .found.1, .needed.0, .needed.1
    )]
    TooOld {
        /// Its name.
        card: String,
        /// Its compute capability, major and minor.
        found: (i32, i32),
        /// What there has to be.
        needed: (i32, i32),
    },
    /// The driver does not open the card.
    #[error(
        "the card `{card}` cannot be opened: {reason}; see whether `nvidia-smi` lists it, or run on the devices gpu (cards \
         of any maker) or cpu"
    )]
    Refused {
        /// Its name, or which one it is.
        card: String,
        /// What the driver said.
        reason: String,
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
    /// The driver does not load what NVRTC made of the kernel.
    #[error(
        "the driver of the card `{card}` does not load the solver's kernel: {reason}; update the driver, or install an \
         NVRTC that is not newer than it"
    )]
    Load {
        /// The card's name.
        card: String,
        /// What the driver said.
        reason: String,
    },
    /// Kernels cannot count so many.
    #[error("of this model, {most} worlds fit into one simulation on a card, not {worlds}")]
    TooMany {
        /// What was asked for.
        worlds: usize,
        /// What there can be.
        most: usize,
    },
    /// Kernels cannot count so many constants.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
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
    /// The card failed or is gone; what it held is lost, and the process gets no other hold of it.
    #[error(
        "the card `{card}` failed: {reason}; go back to a snapshot on the device cpu, or in a new process"
    )]
    Failed {
        /// Its name.
        card: String,
        /// What it said.
        reason: String,
    },
}
