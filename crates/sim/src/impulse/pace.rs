//! How many threads a world is worth.
//!
//! More are not always faster: where cores are far apart, or others need them, threads wait for each other for longer than
//! they help. How many there are changes no number. So a world tries half or twice as many now and then, for a few steps,
//! and goes on with those if they were faster.

/// Steps from one trial to the next, and to the first one.
const BETWEEN: usize = 512;
const FIRST: usize = 16;
/// Steps of a trial, and as many before it: the fastest of them counts, since others were disturbed.
const TRIAL: usize = 4;
/// What is to be gained by a change, as a share of the time.
const WORTH: f64 = 0.05;

/// The pace of a world, with one number of threads and another.
#[derive(Debug)]
pub(super) struct Pace {
    /// How often all threads are halved; and in a trial.
    halved: u32,
    tried: u32,
    /// Whether the next trial is with fewer.
    fewer: bool,
    /// Steps to the end of the next trial.
    left: usize,
    /// Times [s] of the fastest steps before and in it.
    fastest: [f64; 2],
}

impl Default for Pace {
    fn default() -> Self {
        Self {
            halved: 0,
            tried: 0,
            fewer: true,
            left: FIRST,
            fastest: [f64::INFINITY; 2],
        }
    }
}

impl Pace {
    /// Threads for the next step, of so many.
    pub fn team(&self, threads: usize) -> usize {
        let halved = if self.is_trial() {
            self.tried
        } else {
            self.halved
        };
        (threads >> halved).max(1)
    }

    fn is_trial(&self) -> bool {
        self.left <= TRIAL
    }

    /// Takes note of the time [s] that the step took, of so many threads.
    pub fn took(&mut self, seconds: f64, threads: usize) {
        if self.left <= 2 * TRIAL {
            let fastest = &mut self.fastest[usize::from(self.is_trial())];
            *fastest = fastest.min(seconds);
        }
        self.left -= 1;
        if self.left == 0 {
            let [before, then] = self.fastest;
            if then < (1.0 - WORTH) * before {
                self.halved = self.tried;
            } else {
                self.fewer = !self.fewer;
            }
            self.fastest = [f64::INFINITY; 2];
            self.left = BETWEEN;
        }
        if self.left == TRIAL {
            self.choose(threads);
        }
    }

    /// What to try next: half as many, or twice, whichever there can be.
    fn choose(&mut self, threads: usize) {
        let can_be_fewer = self.halved < threads.ilog2();
        self.fewer = can_be_fewer && (self.fewer || self.halved == 0);
        self.tried = if self.fewer {
            self.halved + 1
        } else {
            self.halved.saturating_sub(1)
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Threads with which most of so many steps are taken, each of which takes a time by their number and its own.
    fn usual(
        pace: &mut Pace,
        threads: usize,
        steps: usize,
        time: impl Fn(usize, usize) -> f64,
    ) -> usize {
        let mut counts = vec![0; threads + 1];
        for step in 0..steps {
            let team = pace.team(threads);
            counts[team] += 1;
            pace.took(time(team, step), threads);
        }
        let most = counts.iter().max().copied();
        let usual = counts.iter().position(|count| Some(*count) == most);
        usual.unwrap_or_default()
    }

    #[test]
    fn threads_that_help_are_taken() {
        for threads in [2, 3, 8, 12] {
            let mut pace = Pace::default();
            let helps = |team: usize, _| 1.0 / team as f64;
            assert_eq!(usual(&mut pace, threads, 2000, helps), threads);
        }
    }

    #[test]
    fn threads_that_do_not_are_left_out_until_they_do() {
        let mut pace = Pace::default();
        let harms = |team: usize, _| 1.0 + 0.1 * team as f64;
        let helps = |team: usize, _| 1.0 / team as f64;
        assert_eq!(usual(&mut pace, 8, 4000, harms), 1);
        assert_eq!(usual(&mut pace, 8, 4000, helps), 8);
        // Best are four.
        let some = |team: usize, _| 1.0 / team as f64 + 0.06 * team as f64;
        assert_eq!(usual(&mut pace, 8, 4000, some), 4);
    }

    #[test]
    fn a_step_that_is_disturbed_counts_for_nothing() {
        let mut pace = Pace::default();
        let disturbed = |team: usize, step: usize| {
            let usual = 1.0 / team as f64;
            if step.is_multiple_of(3) { 10.0 } else { usual }
        };
        assert_eq!(usual(&mut pace, 2, 4000, disturbed), 2);
    }

    #[test]
    fn one_thread_is_one() {
        let mut pace = Pace::default();
        assert_eq!(usual(&mut pace, 1, 1000, |_, _| 1.0), 1);
    }
}
