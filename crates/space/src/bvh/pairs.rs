//! All overlapping pairs, by meeting the tree with itself.
//!
//! Two nodes that overlap are opened together, so that pairs far apart are
//! excluded once for whole subtrees.

use super::{Bvh, OBJECT};
use crate::{Pair, pairs};

/// Two subtrees to be compared; the same twice to find the pairs within it.
type Task = (u32, u32);

/// Threads get this many tasks or more, so that they finish together.
const TASKS: usize = 256;

impl Bvh {
    pub(super) fn find_pairs(&self, found: &mut Vec<Pair>) {
        let mut tasks: Vec<Task> = vec![(0, 0)];
        if self.nodes[0].objects > 2000 {
            while (1..TASKS).contains(&tasks.len()) {
                let mut finer = Vec::new();
                tasks
                    .iter()
                    .for_each(|task| self.open(*task, &mut finer, found));
                tasks = finer;
            }
        }
        pairs::gather(tasks.len(), 8, found, |range, found| {
            let mut stack = Vec::with_capacity(256);
            for task in &tasks[range] {
                stack.push(*task);
                while let Some(task) = stack.pop() {
                    self.open(task, &mut stack, found);
                }
            }
        });
    }

    /// Compares the children of two nodes: pairs of objects are found, pairs of nodes become tasks.
    #[inline]
    fn open(&self, (a, b): Task, tasks: &mut Vec<Task>, found: &mut Vec<Pair>) {
        let (x, y) = (&self.nodes[a as usize], &self.nodes[b as usize]);
        for slot in 0..4 {
            let i = x.child[slot];
            let mut mask = y.overlapping(&x.child_box(slot));
            if a == b {
                // Each pair of children once, and a node with itself.
                mask &= !((1 << slot) - 1);
                if i & OBJECT != 0 {
                    mask &= !(1 << slot);
                }
            }
            while mask != 0 {
                let other = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                let j = y.child[other & 3];
                match (i & OBJECT != 0, j & OBJECT != 0) {
                    (true, true) => found.push(Pair::new(i & !OBJECT, j & !OBJECT)),
                    (false, false) => tasks.push((i, j)),
                    (true, false) => self.meet(i & !OBJECT, &x.child_box(slot), j, found),
                    (false, true) => self.meet(j & !OBJECT, &y.child_box(other), i, found),
                }
            }
        }
    }

    /// The pairs of one object with those below a node.
    fn meet(&self, object: u32, aabb: &crate::Aabb, node: u32, found: &mut Vec<Pair>) {
        self.visit_overlapping(node, aabb, &mut |other| {
            found.push(Pair::new(object, other))
        });
    }
}
