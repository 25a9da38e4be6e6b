//! Why worlds of piles do not run on a card.

use numbers::trace::TraceError;
use sim::DeviceError;
use thiserror::Error;

/// What a model has that a card has not, or not enough of.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PilesError {
    /// A kernel cannot be recorded.
    #[error("the solver's kernel cannot be recorded: {0}")]
    Record(#[from] TraceError),
    /// One world is too large.
    #[error(
        "a world needs {bytes} bytes in one buffer, of which the card `{card}` takes {most}: run on the CPU"
    )]
    TooLarge {
        /// What a world needs.
        bytes: u64,
        /// What the card takes.
        most: u64,
        /// Its name.
        card: String,
    },
    /// Constants of each world do not fit.
    #[error(
        "worlds with constants of their own need {bytes} bytes in one buffer, of which the card `{card}` takes {most}: \
         simulate fewer worlds"
    )]
    Parameters {
        /// What they need.
        bytes: u64,
        /// What the card takes.
        most: u64,
        /// Its name.
        card: String,
    },
    /// What cards do not know of piles.
    #[error("`impulse` does not support {what} on a graphics card: {remedy}")]
    Unsupported {
        /// What is not supported.
        what: &'static str,
        /// What to do instead.
        remedy: &'static str,
    },
}

impl From<PilesError> for DeviceError {
    fn from(error: PilesError) -> Self {
        Self::new(error)
    }
}
