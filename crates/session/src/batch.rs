//! How many steps are made at once, between two looks at the clock.
//!
//! A batch doubles while it takes a short part of the time that it may take, and halves where it takes more. On the
//! processor that is a part of the slice of time that there is; a look at a graphics card costs as much as many
//! steps, and the longer the more the card draws besides, so that a batch there may take longer.

/// Steps at once, at most.
const MOST: u64 = 1 << 16;
/// Share of the time that a batch may take below which it doubles.
const SHORT: f64 = 0.4;

/// The present length of a batch.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Batch {
    pub steps: u64,
}

impl Default for Batch {
    fn default() -> Self {
        Self { steps: 1 }
    }
}

impl Batch {
    /// So many steps at once have taken so long, of the time that they may take [s].
    pub fn took(&mut self, steps: u64, time: f64, most: f64) {
        if time > most {
            self.steps = (steps / 2).max(1);
        } else if time < SHORT * most && steps == self.steps {
            self.steps = (2 * steps).min(MOST);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_batch_settles_below_the_time_that_it_may_take() {
        for (wait, step) in [(0.0, 1e-6), (0.0, 1e-3), (2e-3, 1e-6), (2e-3, 1e-3)] {
            let mut batch = Batch::default();
            let time = |n: u64| wait + n as f64 * step;
            for _ in 0..100 {
                batch.took(batch.steps, time(batch.steps), 0.01);
            }
            let (own, twice) = (time(batch.steps), time(2 * batch.steps));
            assert!(own <= 0.01 && twice > SHORT * 0.01, "{batch:?}, {own} s");
        }
    }

    #[test]
    fn one_that_was_cut_short_tells_only_that_it_was_too_long() {
        let mut batch = Batch { steps: 64 };
        batch.took(3, 1e-6, 0.01);
        assert_eq!(batch.steps, 64);
        batch.took(3, 0.02, 0.01);
        assert_eq!(batch.steps, 1);
        batch.took(1, 0.02, 0.01);
        assert_eq!(batch.steps, 1);
    }
}
