//! When sensors are due.
//!
//! Sample k of a rate r is due at time k/r of a world, and is taken at the first step at or after: with
//! steps of h, the latest sample that is due after n of them is k = ⌊n h r⌋. Counting steps, not adding up
//! times, keeps rounding out.

/// A due time so little after a step, in periods, counts as reached.
const SLACK: f64 = 1e-6;

/// The samples of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Clock {
    /// Samples per second [Hz], or one at every step.
    pub rate: Option<f64>,
}

impl Clock {
    /// Samples in a step of h [s].
    fn per_step(self, h: f64) -> f64 {
        self.rate.map_or(1.0, |rate| rate * h)
    }
    /// The latest sample that is due at a time [s].
    pub fn sample(self, time: f64, h: f64) -> u64 {
        let steps = (time / h).round();
        (steps * self.per_step(h) + SLACK) as u64
    }
    /// Time between two samples [s].
    pub fn period(self, h: f64) -> f64 {
        self.rate.map_or(h, f64::recip)
    }
    /// How many steps, at least one, until a later sample than this is due.
    pub fn steps_until_next(self, time: f64, h: f64, sample: u64) -> usize {
        let next = ((sample + 1) as f64 - SLACK) / self.per_step(h);
        (next.ceil() - (time / h).round()).max(1.0) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::Clock;

    /// Steps at which a sensor is sampled, found by asking at each, must be those found ahead.
    fn due(rate: Option<f64>, h: f64, steps: usize) -> Vec<usize> {
        let clock = Clock { rate };
        let mut last = None;
        let mut ahead = 0;
        let mut due = Vec::new();
        for step in 0..steps {
            let time = step as f64 * h;
            let sample = clock.sample(time, h);
            if last != Some(sample) {
                assert_eq!(step, ahead, "rate {rate:?}, step {h}");
                ahead = step + clock.steps_until_next(time, h, sample);
                due.push(step);
                last = Some(sample);
            }
        }
        due
    }

    #[test]
    fn a_tenth_of_the_rate_is_every_tenth_step() {
        let tens: Vec<usize> = (0..200).map(|i| 10 * i).collect();
        assert_eq!(due(Some(50.0), 0.002, 2000), tens);
    }

    #[test]
    fn other_rates_are_due_at_the_first_step_at_or_after() {
        // 300 Hz at 1 kHz: due at 3.33, 6.67, 10, … steps.
        assert_eq!(due(Some(300.0), 0.001, 11), [0, 4, 7, 10]);
        assert_eq!(due(None, 0.001, 4), [0, 1, 2, 3]);
        assert_eq!(due(Some(1e5), 0.001, 4), [0, 1, 2, 3]);
        for rate in [1.0, 7.0, 30.0, 333.0, 999.0, 1000.0 / 3.0] {
            let found = due(Some(rate), 0.001, 5000);
            assert_eq!(found.len(), (rate * 4.999 + 1e-6) as usize + 1, "{rate}");
        }
    }
}
