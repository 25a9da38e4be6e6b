//! Why worlds of piles do not run on a card.

use numbers::trace::TraceError;
use sim::DeviceError;
use std::fmt;
use thiserror::Error;

/// What lies in one buffer of a card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Need {
    /// The numbers of one world, at least.
    World,
    /// The constants that all worlds of a model have in common.
    Model,
    /// Constants of each world, side by side.
    Parameters,
}

impl Need {
    /// Looks whether so many bytes are no more than the card of this name takes at most.
    ///
    /// # Errors
    /// They are more.
    pub fn check(self, bytes: u64, most: u64, card: &str) -> Result<(), TooLarge> {
        if bytes <= most {
            return Ok(());
        }
        Err(TooLarge {
            need: self,
            bytes,
            most,
            card: card.to_owned(),
        })
    }
    /// What to do where they are more.
    fn remedy(self) -> &'static str {
        match self {
            Self::World => "run on the CPU",
            Self::Model => "use meshes of fewer triangles, or run on the CPU",
            Self::Parameters => "simulate fewer worlds",
        }
    }
}

impl fmt::Display for Need {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::World => "a world needs",
            Self::Model => "constants of the model need",
            Self::Parameters => "worlds with constants of their own need",
        })
    }
}

/// A buffer of a card is too small.
#[derive(Debug, Error)]
#[error(
    "{need} {bytes} bytes in one buffer, of which the card `{card}` takes {most}: {}",
    .need.remedy()
)]
#[non_exhaustive]
pub struct TooLarge {
    /// For what.
    pub need: Need,
    /// What that needs.
    pub bytes: u64,
    /// What the card takes.
    pub most: u64,
    /// Its name.
    pub card: String,
}

/// What a model has that a card has not, or not enough of.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PilesError {
    /// A kernel cannot be recorded.
    #[error("the solver's kernel cannot be recorded: {0}")]
    Record(#[from] TraceError),
    /// A buffer is too small.
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
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
