//! Threads that work on one world, stage by stage.
//!
//! The work of a stage lies in parts. Each thread does its own parts first, the same in every stage,
//! since their numbers are in its cache, and then those that others have not begun. A stage is over
//! when all its parts are done, whoever did them: on a busy machine, a thread that does not get its
//! turn costs the others nothing but its help.
//!
//! Stages take microseconds, and a line of memory goes from core to core and back in a tenth of one at best. So no number
//! is written by all: what a part tells the others lies in a line of its own.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, TryLockError};

/// A part of a stage's work.
#[derive(Debug)]
#[repr(align(128))]
pub(super) struct Part<S> {
    /// The last stage in which it was done; the first is 1.
    done: AtomicUsize,
    work: Mutex<S>,
}

impl<S> Part<S> {
    /// Whether it is done in a stage; what was written there can be read then.
    fn is_done(&self, stage: usize) -> bool {
        self.done.load(Ordering::Acquire) >= stage
    }
}

/// Parts that one thread does at a time.
pub(super) type Parts<S> = Vec<Part<S>>;

/// What is still to be done, in parts.
pub(super) fn parts<S>(work: impl Iterator<Item = S>) -> Parts<S> {
    work.map(|work| Part {
        done: AtomicUsize::new(0),
        work: Mutex::new(work),
    })
    .collect()
}

/// One thread of a team.
#[derive(Debug)]
pub(super) struct Member<'a> {
    /// A part will never be done.
    broken: &'a AtomicBool,
    number: usize,
    members: usize,
    stage: usize,
}

/// Turns that a thread waits for others before it takes over their parts.
const PATIENCE: usize = 1 << 6;
/// Turns that it then waits for parts that others have begun, before it lets others run.
const MORE_PATIENCE: usize = 1 << 8;

impl Member<'_> {
    /// Does all parts of the next stage, with the others. All that they wrote can be read then.
    ///
    /// # Panics
    /// If another thread has.
    pub fn stage<S>(&mut self, parts: &[Part<S>], work: impl Fn(&mut S)) {
        self.stage += 1;
        let cut = |member: usize| parts.len() * member / self.members;
        for part in &parts[cut(self.number)..cut(self.number + 1)] {
            self.attempt(part, &work);
        }
        if self.wait(parts, PATIENCE) {
            return;
        }
        loop {
            for part in parts {
                self.attempt(part, &work);
            }
            if self.wait(parts, MORE_PATIENCE) {
                return;
            }
            std::thread::yield_now();
        }
    }

    /// Whether the stage is over, after so many turns at most.
    fn wait<S>(&self, mut parts: &[Part<S>], turns: usize) -> bool {
        for _ in 0..turns {
            while let [first, rest @ ..] = parts
                && first.is_done(self.stage)
            {
                parts = rest;
            }
            if parts.is_empty() {
                return true;
            }
            std::hint::spin_loop();
        }
        let broken = self.broken.load(Ordering::Relaxed);
        assert!(!broken, "a thread of the team has panicked");
        false
    }

    /// Does a part, unless another thread has begun it.
    fn attempt<S>(&self, part: &Part<S>, work: impl Fn(&mut S)) {
        if part.is_done(self.stage) {
            return;
        }
        let mut own = match part.work.try_lock() {
            Ok(own) => own,
            Err(TryLockError::WouldBlock) => return,
            Err(TryLockError::Poisoned(_)) => panic!("a thread of the team has panicked"),
        };
        // Another may have done it in between.
        if !part.is_done(self.stage) {
            let _guard = Guard(self.broken);
            work(&mut own);
            part.done.store(self.stage, Ordering::Release);
        }
    }
}

/// Tells the others when a thread panics, instead of leaving them to wait.
struct Guard<'a>(&'a AtomicBool);

impl Drop for Guard<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(true, Ordering::Relaxed);
        }
    }
}

/// Runs `work` on so many threads of the current pool. All must go through the same stages; none
/// waits for one that has not begun.
pub(super) fn together(members: usize, work: impl Fn(Member<'_>) + Sync) {
    let broken = AtomicBool::new(false);
    let member = |number| Member {
        broken: &broken,
        number,
        members,
        stage: 0,
    };
    rayon::scope(|scope| {
        for number in 1..members {
            let (work, member) = (&work, &member);
            scope.spawn(move |_| work(member(number)));
        }
        work(member(0));
    });
}

/// Runs `work` while the other threads of the current pool look out for what it shares. Left to themselves they would
/// fall asleep between two stages, and to wake one takes as long as a stage of a small world.
pub(super) fn attended(members: usize, work: impl FnOnce() + Send) {
    let over = AtomicBool::new(false);
    let caller = rayon::current_thread_index();
    rayon::scope(|scope| {
        for _ in 1..members {
            scope.spawn(|_| {
                // The caller may come across this while it waits for others.
                while rayon::current_thread_index() != caller && !over.load(Ordering::Acquire) {
                    if rayon::yield_now() != Some(rayon::Yield::Executed) {
                        std::thread::yield_now();
                    }
                }
            });
        }
        let _over = Over(&over);
        work();
    });
}

/// Says that it is over when it goes out of scope, be it by a panic.
struct Over<'a>(&'a AtomicBool);

impl Drop for Over<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Release);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stages of parts that read what the stage before wrote elsewhere.
    fn sums(members: usize) -> Vec<u64> {
        let numbers: Vec<_> = (0..64).map(|i| AtomicUsize::new(i + 1)).collect();
        let copies: Vec<_> = (0..64).map(|_| AtomicUsize::new(0)).collect();
        let all = parts(0..16_usize);
        together(members, |mut member| {
            for _ in 0..200 {
                let add = |part: &mut usize| {
                    for i in (*part * 4)..(*part * 4 + 4) {
                        let other = numbers[(i * 7 + 5) % 64].load(Ordering::Relaxed);
                        let sum = numbers[i].load(Ordering::Relaxed).wrapping_mul(3) ^ other;
                        copies[i].store(sum, Ordering::Relaxed);
                    }
                };
                member.stage(&all, add);
                member.stage(&all, |part| {
                    for i in (*part * 4)..(*part * 4 + 4) {
                        numbers[i].store(copies[i].load(Ordering::Relaxed), Ordering::Relaxed);
                    }
                });
            }
        });
        numbers
            .iter()
            .map(|n| n.load(Ordering::Relaxed) as u64)
            .collect()
    }

    #[test]
    fn stages_are_in_turn_whatever_the_threads() {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(4).build();
        let pool = pool.expect("threads");
        let alone = sums(1);
        for members in 2..6 {
            assert_eq!(pool.install(|| sums(members)), alone, "{members} members");
        }
    }

    /// Work that shares, and shares what it shares, ends; with more members than threads, too.
    #[test]
    fn those_that_attend_help_and_go() {
        for threads in 1..4 {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let pool = pool.expect("threads");
            for _ in 0..50 {
                let sum = AtomicUsize::new(0);
                pool.install(|| {
                    attended(3, || {
                        for _ in 0..20 {
                            let all = parts(0..4_usize);
                            together(2, |mut member| {
                                member.stage(&all, |part| {
                                    sum.fetch_add(*part, Ordering::Relaxed);
                                });
                            });
                        }
                    });
                });
                assert_eq!(sum.load(Ordering::Relaxed), 20 * 6);
            }
        }
    }

    #[test]
    fn a_panic_reaches_who_is_attended() {
        let run = || attended(2, || panic!("work"));
        assert!(std::panic::catch_unwind(run).is_err());
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        let all = parts(0..8_usize);
        let run = || {
            together(2, |mut member| {
                member.stage(&all, |part| assert!(*part != 5, "part 5"));
                member.stage(&all, |_| {});
            });
        };
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(run));
        assert!(outcome.is_err());
    }
}
