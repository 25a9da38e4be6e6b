//! Threads that work on one world, stage by stage.
//!
//! The work of a stage lies in parts. Each thread does its own parts first, the same in every stage,
//! since their numbers are in its cache, and then those that others have not begun. A stage is over
//! when all its parts are done, whoever did them: on a busy machine, a thread that does not get its
//! turn costs the others nothing but its help.
//!
//! Stages take microseconds, and a line of memory goes from core to core and back in a tenth of one, or in half of one
//! where they are far apart. So no number is written by all, and what the others wait for lies in a line of its own: how
//! far each thread is, which it writes once in a stage. What guards a part is touched by others only to take it over.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, TryLockError};

/// What lies in lines of the cache of its own.
#[derive(Debug, Default)]
#[repr(align(128))]
struct Line<T>(T);

/// A part of a stage's work.
#[derive(Debug)]
pub(super) struct Part<S>(Line<Mutex<Work<S>>>);

#[derive(Debug)]
struct Work<S> {
    /// The last stage in which it was done; the first is 1.
    done: usize,
    work: S,
}

/// Parts that one thread does at a time.
pub(super) type Parts<S> = Vec<Part<S>>;

/// What is still to be done, in parts.
pub(super) fn parts<S>(work: impl Iterator<Item = S>) -> Parts<S> {
    let part = |work| Part(Line(Mutex::new(Work { done: 0, work })));
    work.map(part).collect()
}

/// One thread of a team.
#[derive(Debug)]
pub(super) struct Member<'a> {
    /// Of each member, the last stage of which its own parts are done, by whomever; or an earlier one.
    reached: &'a [Line<AtomicUsize>],
    /// A part will never be done.
    broken: &'a AtomicBool,
    number: usize,
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
        self.settle(self.number, parts, &work);
        if self.wait(PATIENCE) {
            return;
        }
        loop {
            for member in 0..self.reached.len() {
                if !self.has_reached(member) {
                    self.settle(member, parts, &work);
                }
            }
            if self.wait(MORE_PATIENCE) {
                return;
            }
            std::thread::yield_now();
        }
    }

    /// Whether all parts of a member are done; what was written there can be read then.
    fn has_reached(&self, member: usize) -> bool {
        self.reached[member].0.load(Ordering::Acquire) >= self.stage
    }

    /// Whether the stage is over, after so many turns at most.
    fn wait(&self, turns: usize) -> bool {
        let members = self.reached.len();
        let mut member = 0;
        for _ in 0..turns {
            while member < members && self.has_reached(member) {
                member += 1;
            }
            if member == members {
                return true;
            }
            std::hint::spin_loop();
        }
        let broken = self.broken.load(Ordering::Relaxed);
        assert!(!broken, "a thread of the team has panicked");
        false
    }

    /// Does the parts of a member that nobody has begun, and tells when none is left.
    fn settle<S>(&self, member: usize, parts: &[Part<S>], work: impl Fn(&mut S)) {
        let cut = |member: usize| parts.len() * member / self.reached.len();
        let mut done = true;
        for part in &parts[cut(member)..cut(member + 1)] {
            done &= self.attempt(part, &work);
        }
        if done {
            // A member who is late may tell of an earlier stage once more: then others find out for themselves.
            self.reached[member].0.store(self.stage, Ordering::Release);
        }
    }

    /// Does a part, unless it is done; whether it is, and not in another thread's hands.
    fn attempt<S>(&self, part: &Part<S>, work: impl Fn(&mut S)) -> bool {
        let mut own = match part.0.0.try_lock() {
            Ok(own) => own,
            Err(TryLockError::WouldBlock) => return false,
            Err(TryLockError::Poisoned(_)) => panic!("a thread of the team has panicked"),
        };
        if own.done < self.stage {
            let _guard = Guard(self.broken);
            work(&mut own.work);
            own.done = self.stage;
        }
        true
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
    let reached: Vec<_> = (0..members).map(|_| Line::default()).collect();
    let broken = Line(AtomicBool::new(false));
    let member = |number| Member {
        reached: &reached,
        broken: &broken.0,
        number,
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
