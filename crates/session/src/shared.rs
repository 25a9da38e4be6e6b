//! A simulation of a program, which pages watch and steer while the program goes on with it.

use crate::hands::Subject;
use numbers::Float;
use parking_lot::{Mutex, MutexGuard};
use sim::{Diverged, Simulation, SimulationError};
use std::fmt;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// A simulation that a program holds and steps, on any thread, while a [`Session`](crate::Session) about it
/// shows it to pages. Who holds it longest owns it: the session does not keep it alive.
///
/// The session takes it for some milliseconds at a time, or for one time step where that takes longer, and
/// then lets a program that waits go first.
///
/// ```
/// use kinetarium_session::{Session, Shared};
/// use sim::{Simulation, SimulationSettings};
///
/// let model = model::examples::room()?;
/// let shared = Shared::new(Simulation::<f64>::new(model, SimulationSettings::new(4, 0.002))?);
/// let mut session = Session::of_program(&shared, || 0.0);
/// shared.change().step(10);
/// session.receive(r#"{"type": "step", "steps": 5}"#);
/// while session.advance() {}
/// assert!((shared.read().time(0) - 15.0 * 0.002).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Shared<T: Float> {
    subject: Mutex<Subject<T>>,
    changes: AtomicU64,
}

/// A shared simulation, for as long as this value lives. Nobody else has it meanwhile.
pub struct Guard<'a, T: Float>(MutexGuard<'a, Subject<T>>);

impl<T: Float> Shared<T> {
    /// Shares a simulation.
    pub fn new(simulation: Simulation<T>) -> Arc<Self> {
        Arc::new(Self {
            subject: Mutex::new(Subject::new(simulation)),
            changes: AtomicU64::new(0),
        })
    }
    /// The simulation, to be stepped or set. What has changed is shown once the guard is dropped.
    pub fn change(&self) -> Guard<'_, T> {
        let guard = self.read();
        self.changes.fetch_add(1, Relaxed);
        guard
    }
    /// The simulation, to be read: pages are shown nothing new.
    pub fn read(&self) -> Guard<'_, T> {
        Guard(self.subject.lock())
    }
    /// For the session.
    pub(crate) fn lock(&self) -> MutexGuard<'_, Subject<T>> {
        self.subject.lock()
    }
    /// How often it has been taken to be changed.
    pub(crate) fn changes(&self) -> u64 {
        self.changes.load(Relaxed)
    }
}

impl<T: Float> Guard<'_, T> {
    /// As [`Simulation::step`], under the hands of those who draw and push bodies on a page.
    pub fn step(&mut self, steps: usize) -> &[Diverged] {
        let stepped = self.try_step(steps);
        stepped.unwrap_or_else(|error| panic!("{error}"))
    }
    /// As [`Simulation::try_step`], likewise.
    ///
    /// # Errors
    /// As there.
    pub fn try_step(&mut self, steps: usize) -> Result<&[Diverged], SimulationError> {
        self.0.step(steps)
    }
}

impl<T: Float> Deref for Guard<'_, T> {
    type Target = Simulation<T>;
    fn deref(&self) -> &Simulation<T> {
        &self.0.simulation
    }
}

impl<T: Float> DerefMut for Guard<'_, T> {
    fn deref_mut(&mut self) -> &mut Simulation<T> {
        &mut self.0.simulation
    }
}

impl<T: Float> fmt::Debug for Guard<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.simulation.fmt(f)
    }
}

impl<T: Float> fmt::Debug for Shared<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Shared").finish_non_exhaustive()
    }
}
