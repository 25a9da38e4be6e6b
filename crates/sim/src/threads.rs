//! The threads that step a simulation.

use crate::SimulationError;
use rayon::{ThreadPool, ThreadPoolBuilder};

/// A pool of threads; or the caller alone where a machine has none, as WebAssembly: work that is shared
/// among threads is then rayon's to run in turn.
pub(crate) struct Threads(Option<ThreadPool>);

impl Threads {
    /// So many; 0 takes one per processor.
    pub fn new(threads: usize) -> Result<Self, SimulationError> {
        if cfg!(target_family = "wasm") {
            return Ok(Self(None));
        }
        let pool = ThreadPoolBuilder::new().num_threads(threads).build();
        match pool {
            Ok(pool) => Ok(Self(Some(pool))),
            Err(error) => Err(SimulationError::Threads {
                threads,
                reason: error.to_string(),
            }),
        }
    }
    /// How many there are.
    pub fn count(&self) -> usize {
        self.0.as_ref().map_or(1, ThreadPool::current_num_threads)
    }
    /// Runs work that may be shared among them.
    pub fn run<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(work),
            None => work(),
        }
    }
}
