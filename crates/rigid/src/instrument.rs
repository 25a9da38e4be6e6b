//! Kernels that read what a solver has reported, and tell numbers of each world.

use crate::tables::Filler;
use crate::{Gauges, Lengths, Rangefinder};

/// What is read of worlds beside their solver, where they are.
#[expect(clippy::large_enum_variant, reason = "few, and shared by `Arc`")]
#[derive(Clone, Debug, PartialEq)]
pub enum Instrument {
    /// How far rays get.
    Rangefinder(Rangefinder),
    /// What sensors of joints, bodies and contacts read.
    Gauges(Gauges),
}

impl Instrument {
    /// What it is compiled to.
    pub fn sheet(&self) -> &Sheet {
        match self {
            Self::Rangefinder(finder) => finder.sheet(),
            Self::Gauges(gauges) => gauges.sheet(),
        }
    }
}

/// What an instrument is compiled to, beside its tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Sheet {
    /// Numbers of each world, but for those that the solver tells and is told.
    pub lengths: Lengths,
    /// How often its loops go round at most, all together.
    pub rounds: usize,
    /// The constants.
    pub parameters: Vec<f64>,
    /// The structure.
    pub links: Vec<u32>,
}

impl Sheet {
    /// Of so many numbers that are told, and of scratch.
    pub(crate) fn new(filled: Filler, [output, scratch]: [usize; 2], rounds: usize) -> Self {
        Self {
            lengths: Lengths {
                state: 0,
                input: 0,
                output,
                scratch,
            },
            rounds,
            parameters: filled.parameters,
            links: filled.links,
        }
    }
}
