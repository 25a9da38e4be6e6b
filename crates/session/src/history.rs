//! The recent past, to return to.

use sim::Snapshot;
use std::collections::VecDeque;

/// Most that the recorded states may take [bytes].
const MOST_BYTES: usize = 64 << 20;
/// Most recorded states: a minute, at thirty a second.
const MOST_STATES: usize = 1800;
/// From one recorded state to the next [s].
const EVERY: f64 = 1.0 / 30.0;

/// A state, and when it was.
#[derive(Clone, Debug)]
pub(crate) struct Moment {
    /// Steps since the start.
    pub steps: u64,
    pub snapshot: Snapshot,
}

/// Recorded states in the order of time, the oldest of which make room for new ones.
#[derive(Clone, Debug)]
pub(crate) struct History {
    moments: VecDeque<Moment>,
    /// Time steps from one to the next.
    every: u64,
    most: usize,
}

impl History {
    /// Room for states of so many bytes, of a simulation with a time step [s].
    pub fn new(time_step: f64, bytes: usize) -> Self {
        Self {
            moments: VecDeque::new(),
            every: every(time_step),
            most: (MOST_BYTES / bytes.max(1)).clamp(2, MOST_STATES),
        }
    }
    /// Steps from `steps` until a state is to be recorded.
    pub fn due(&self, steps: u64) -> u64 {
        match self.moments.back() {
            Some(last) => (last.steps + self.every).saturating_sub(steps),
            None => 0,
        }
    }
    /// Records a state, later than all others.
    pub fn record(&mut self, moment: Moment) {
        if self.moments.len() == self.most {
            self.moments.pop_front();
        }
        self.moments.push_back(moment);
    }
    /// Forgets what was later than `steps`: another future begins there.
    pub fn branch(&mut self, steps: u64) {
        while self.moments.back().is_some_and(|m| m.steps > steps) {
            self.moments.pop_back();
        }
    }
    /// Counts in other time steps: of `after` where it was of `before` [s].
    pub fn rescale(&mut self, before: f64, after: f64) {
        for moment in &mut self.moments {
            moment.steps = (moment.steps as f64 * before / after).round() as u64;
        }
        self.every = every(after);
    }
    /// The state nearest to `steps`.
    pub fn nearest(&self, steps: u64) -> Option<&Moment> {
        self.moments.iter().min_by_key(|m| m.steps.abs_diff(steps))
    }
    /// Steps of the first and of the last recorded state.
    pub fn range(&self) -> [u64; 2] {
        let steps = |moment: Option<&Moment>| moment.map_or(0, |m| m.steps);
        [steps(self.moments.front()), steps(self.moments.back())]
    }
}

/// Time steps [s] from one recorded state to the next.
fn every(time_step: f64) -> u64 {
    ((EVERY / time_step).round() as u64).max(1)
}
