//! Kernels that read what a solver has reported, and tell numbers of each world.

use crate::{Gauges, Lengths, Rangefinder};

/// What is read of worlds beside their solver, where they are.
#[derive(Clone, Debug, PartialEq)]
pub enum Instrument {
    /// How far rays get.
    Rangefinder(Rangefinder),
    /// What sensors of joints, bodies and contacts read.
    Gauges(Gauges),
}

impl Instrument {
    /// How often its loops go round at most, all together.
    pub fn rounds(&self) -> usize {
        match self {
            Self::Rangefinder(finder) => finder.rounds(),
            Self::Gauges(gauges) => gauges.rounds(),
        }
    }
    /// Numbers of each world, but for those that the solver tells and is told.
    pub fn lengths(&self) -> Lengths {
        match self {
            Self::Rangefinder(finder) => finder.lengths(),
            Self::Gauges(gauges) => gauges.lengths(),
        }
    }
    /// The constants.
    pub fn parameters(&self) -> &[f64] {
        match self {
            Self::Rangefinder(finder) => finder.parameters(),
            Self::Gauges(gauges) => gauges.parameters(),
        }
    }
    /// The structure.
    pub fn links(&self) -> &[u32] {
        match self {
            Self::Rangefinder(finder) => finder.links(),
            Self::Gauges(gauges) => gauges.links(),
        }
    }
}
