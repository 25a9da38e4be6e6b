//! The kernels of the solvers, recorded: what other machines than processors are to run.
//!
//! A crate of its own, and nothing in it is generic, since kernels take long to compile: whoever wants a record
//! shares the one that is compiled here.

#![forbid(unsafe_code)]

mod instruments;
mod piles;

pub use instruments::Instruments;
pub use piles::{JointPrograms, PilePrograms, ReportPrograms};

use numbers::trace::{self, Program, TraceError};
use rigid::{Instrument, Kernels, Lengths, Report, Solver};

/// What a solver does to a world, as records; and all they need but the world's own numbers.
#[derive(Clone, Debug)]
pub struct Programs {
    /// A substep.
    pub step: Program,
    joints: Program,
    motion: Program,
    contacts: Program,
    everything: Program,
    /// Numbers of each world.
    pub lengths: Lengths,
    /// The constants of the model.
    pub parameters: Vec<f64>,
    /// The structure of the model.
    pub links: Vec<u32>,
}

impl Programs {
    /// Records a solver. Kernels for pairs of shapes that the model has none of are not part of it.
    ///
    /// # Errors
    /// The kernels do what a record cannot express.
    pub fn record(solver: Solver<'_>) -> Result<Self, TraceError> {
        match solver {
            Solver::Featherstone(kernels) => Self::of(kernels),
            Solver::TouchingFeatherstone(kernels) => Self::of(kernels),
            Solver::Xpbd(kernels) => Self::of(kernels),
        }
    }
    fn of(kernels: &impl Kernels) -> Result<Self, TraceError> {
        Ok(Self {
            step: trace::record(|k| kernels.step_in_parts(k))?,
            joints: trace::record(|k| kernels.report_joints(k))?,
            motion: trace::record(|k| kernels.report_motion(k))?,
            contacts: trace::record(|k| kernels.report_contacts(k))?,
            everything: trace::record(|k| kernels.report(k))?,
            lengths: kernels.lengths(),
            parameters: kernels.parameters().to_vec(),
            links: kernels.links().to_vec(),
        })
    }
    /// What fills the output from the state.
    pub fn report(&self, report: Report) -> &Program {
        match report {
            Report::Joints => &self.joints,
            Report::Motion => &self.motion,
            Report::Contacts => &self.contacts,
            Report::Everything => &self.everything,
        }
    }
}

/// Records an instrument.
///
/// # Errors
/// The kernel does what a record cannot express.
pub fn instrument(instrument: &Instrument) -> Result<Program, TraceError> {
    match instrument {
        Instrument::Rangefinder(finder) => trace::record(|k| finder.measure(k)),
        Instrument::Gauges(gauges) => trace::record(|k| gauges.measure(k)),
    }
}
