//! Threads that work on one world, in step.

use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Where threads wait for each other.
#[derive(Debug)]
pub(super) struct Barrier {
    members: usize,
    arrived: AtomicUsize,
    round: AtomicUsize,
    /// Somebody will never come.
    broken: AtomicBool,
}

/// Turns that a waiting thread makes before it lets others run.
const PATIENCE: usize = 1 << 14;

impl Barrier {
    pub fn new(members: usize) -> Self {
        Self {
            members,
            arrived: AtomicUsize::new(0),
            round: AtomicUsize::new(0),
            broken: AtomicBool::new(false),
        }
    }
    /// Returns when all have come, and all that they wrote before can be read.
    ///
    /// # Panics
    /// If another thread has.
    pub fn wait(&self) {
        if self.members == 1 {
            return;
        }
        let round = self.round.load(Ordering::Acquire);
        if self.arrived.fetch_add(1, Ordering::AcqRel) + 1 == self.members {
            self.arrived.store(0, Ordering::Release);
            self.round.fetch_add(1, Ordering::Release);
            return;
        }
        let mut turns = 0;
        while self.round.load(Ordering::Acquire) == round {
            turns += 1;
            assert!(
                !self.broken.load(Ordering::Relaxed),
                "a thread of the team has panicked"
            );
            if turns < PATIENCE {
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
    }
}

/// Tells the others when a thread panics, instead of leaving them to wait.
struct Guard<'a>(&'a Barrier);

impl Drop for Guard<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.broken.store(true, Ordering::Relaxed);
        }
    }
}

/// Runs `work` with each of the shares, one a thread of the current pool, all at once.
pub(super) fn together<S: Send>(shares: Vec<S>, work: impl Fn(&Barrier, S) + Sync) {
    let barrier = Barrier::new(shares.len());
    if shares.len() == 1 {
        for share in shares {
            work(&barrier, share);
        }
        return;
    }
    let shares: Vec<_> = shares.into_iter().map(|s| Mutex::new(Some(s))).collect();
    rayon::broadcast(|thread| {
        let member = thread.index();
        let share = shares
            .get(member)
            .and_then(|share| share.lock().ok()?.take());
        if let Some(share) = share {
            let _guard = Guard(&barrier);
            work(&barrier, share);
        }
    });
}
