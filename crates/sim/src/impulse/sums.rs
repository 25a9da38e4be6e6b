//! What a step gave that was cut into parts.
//!
//! A part knows what its own contacts gave. What they gave in those before goes to the contact of the same two shapes, of
//! the nearest normal. Where there is none any more, the one that was is told once more, and gives nothing.

use super::warm_start::vector;
use super::world::World;
use numbers::Float;
use rigid::impulse::{Cached, SAME_NORMAL};

impl<T: Float> World<'_, T> {
    /// Adds to contacts, which are in order, what was given in the parts before, which the state remembers.
    pub fn add_parts(&self, state: &[T], contacts: &mut Vec<Cached<T>>) {
        if self.first {
            return;
        }
        let found = contacts.len();
        for i in 0..self.impulse().remembered(state) {
            let mut before = self.impulse().recall(i, state).contact();
            if !before.gave() {
                continue;
            }
            let key = before.key();
            let first = contacts[..found].partition_point(|c| c.key() < key);
            let same = contacts[first..found].iter_mut();
            let same = same.take_while(|c| c.key() == key);
            let cosine = |c: &Cached<T>| vector(c.normal).dot(vector(before.normal));
            match same.max_by(|a, b| cosine(a).total_cmp(&cosine(b))) {
                Some(contact) if cosine(contact) > SAME_NORMAL => contact.add(&before),
                _ => {
                    before.end();
                    contacts.push(before);
                }
            }
        }
        if contacts.len() > found {
            contacts.sort_by_key(Cached::key);
        }
    }
}
