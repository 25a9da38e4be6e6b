//! Contacts begin with the impulses that they had in the step before.

use super::world::{MANY, World};
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::Cached;
use rigid::impulse::pair::solid;

/// Points nearer than this share of the larger shape's radius, of one pair, are the same.
const SAME_PLACE: f64 = 0.05;

impl<T: Float> World<'_, T> {
    /// Gives contacts, which are in order, the impulses that their points had before.
    pub fn recall(&self, state: &[T], contacts: &mut [Cached<T>]) {
        if self.team == 1 || contacts.len() < MANY * self.team {
            return self.recall_run(state, contacts);
        }
        let part = contacts.len().div_ceil(self.team);
        let parts = contacts.par_chunks_mut(part);
        parts.for_each(|part| self.recall_run(state, part));
    }

    /// The same for a run of them.
    fn recall_run(&self, state: &[T], contacts: &mut [Cached<T>]) {
        let impulse = self.impulse();
        let all = impulse.remembered(state);
        let first = contacts.first().map_or([0; 2], Cached::key);
        let (mut next, mut end) = (0, all);
        while next < end {
            let middle = usize::midpoint(next, end);
            if impulse.recall(middle, state).key() < first {
                next = middle + 1;
            } else {
                end = middle;
            }
        }
        for contact in contacts {
            let key = contact.key();
            while next < all && impulse.recall(next, state).key() < key {
                next += 1;
            }
            if next < all && impulse.recall(next, state).key() == key {
                let [a, b] = contact.shapes.map(|s| self.radius(s));
                let old = impulse.recall(next, state);
                old.warm(contact, SAME_PLACE * a.max(b));
                next += 1;
            }
        }
    }

    /// Radius [m] of a shape; 0 of what has no end.
    fn radius(&self, shape: u32) -> f64 {
        let solid = self.impulse().solid_of(shape as usize, self.parameters);
        solid[solid::RADIUS].to_f64()
    }
}
