//! A solver's kernels, recorded.

use numbers::trace::{self, Program, TraceError};
use rigid::Kernels;

/// What a solver does to a world, as records.
#[derive(Clone, Debug)]
pub struct Programs {
    /// A substep.
    pub step: Program,
    /// Where bodies and joints are, and how they move, from the state.
    pub motion: Program,
    /// The same, and the contacts of the last step.
    pub contacts: Program,
    /// The whole output.
    pub report: Program,
}

impl Programs {
    /// Records a solver. Kernels for pairs of shapes that the model has none of are not part of it.
    ///
    /// # Errors
    /// The kernel does what a record cannot express.
    pub fn record(kernels: &impl Kernels) -> Result<Self, TraceError> {
        Ok(Self {
            step: trace::record(|k| kernels.step_in_parts(k))?,
            motion: trace::record(|k| kernels.report_motion(k))?,
            contacts: trace::record(|k| kernels.report_contacts(k))?,
            report: trace::record(|k| kernels.report(k))?,
        })
    }
}
