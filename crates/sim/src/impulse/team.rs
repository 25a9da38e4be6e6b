//! Threads that work on one world, in step.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Where threads wait for each other.
#[derive(Debug)]
pub(super) struct Barrier {
    members: usize,
    arrived: AtomicUsize,
    round: AtomicUsize,
}

/// Turns that a waiting thread makes before it lets others run.
const PATIENCE: usize = 1 << 14;

impl Barrier {
    pub fn new(members: usize) -> Self {
        Self {
            members,
            arrived: AtomicUsize::new(0),
            round: AtomicUsize::new(0),
        }
    }
    /// Returns when all have come, and all that they wrote before can be read.
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
            if turns < PATIENCE {
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
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
            work(&barrier, share);
        }
    });
}
