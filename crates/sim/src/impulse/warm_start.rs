//! Contacts begin with the impulses that they had in the step before.
//!
//! Two shapes have one contact, or, where one is a mesh, one for each normal: then each takes over from
//! that of the nearest normal.

use super::world::World;
use collide::kind;
use glam::DVec3;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::{Cached, Recalled, SAME_NORMAL, SAME_PLACE};

impl<T: Float> World<'_, T> {
    /// Gives contacts, which are in order, the impulses that their points had before.
    pub fn recall(&self, state: &[T], contacts: &mut [Cached<T>]) {
        let part = self.part(contacts.len());
        if contacts.len() <= part {
            return self.recall_run(state, contacts);
        }
        let parts = in_parts(contacts, part);
        parts
            .into_par_iter()
            .for_each(|part| self.recall_run(state, part));
    }

    /// The same for a run of them.
    fn recall_run(&self, state: &[T], contacts: &mut [Cached<T>]) {
        let impulse = self.impulse();
        let all = impulse.remembered(state);
        let key_of = |i: usize| impulse.recall(i, state).key();
        let first = contacts.first().map_or([0; 2], Cached::key);
        let (mut next, mut end) = (0, all);
        while next < end {
            let middle = usize::midpoint(next, end);
            if key_of(middle) < first {
                next = middle + 1;
            } else {
                end = middle;
            }
        }
        for pair in contacts.chunk_by_mut(|a, b| a.key() == b.key()) {
            let key = pair[0].key();
            while next < all && key_of(next) < key {
                next += 1;
            }
            let begin = next;
            while next < all && key_of(next) == key {
                next += 1;
            }
            let before = (begin..next).map(|i| impulse.recall(i, state));
            self.recall_pair(before, pair);
        }
    }

    /// The same for the contacts of two shapes.
    fn recall_pair<'a>(
        &self,
        mut before: impl ExactSizeIterator<Item = Recalled<'a, T>> + Clone,
        contacts: &mut [Cached<T>],
    ) {
        let [a, b] = contacts[0].shapes.map(|s| self.radius(s));
        let near = SAME_PLACE * a.max(b);
        if before.len() <= 1 && contacts.len() == 1 {
            if let Some(old) = before.next() {
                old.warm(&mut contacts[0], near);
            }
            return;
        }
        let mut before: Vec<_> = before.map(Some).collect();
        let mut matches = Vec::new();
        for (i, contact) in contacts.iter().enumerate() {
            for (j, old) in before.iter().flatten().enumerate() {
                let cosine = vector(contact.normal).dot(vector(old.normal()));
                matches.push((cosine, i, j));
            }
        }
        matches.sort_by(|x, y| y.0.total_cmp(&x.0));
        let mut cold = vec![true; contacts.len()];
        for (_, i, j) in matches.into_iter().filter(|m| m.0 > SAME_NORMAL) {
            if cold[i]
                && let Some(old) = before[j].take()
            {
                old.warm(&mut contacts[i], near);
                cold[i] = false;
            }
        }
    }

    /// Radius [m] of a solid; 0 of a plane and a mesh.
    fn radius(&self, shape: u32) -> f64 {
        if self.impulse().shapes()[shape as usize].kind == kind::MESH {
            return 0.0;
        }
        self.impulse()
            .radius_of(shape as usize, self.parameters)
            .to_f64()
    }
}

pub(super) fn vector<T: Float>(v: [T; 3]) -> DVec3 {
    DVec3::from_array(v.map(T::to_f64))
}

/// Runs of about `length` contacts; those of two shapes stay together.
fn in_parts<T: Float>(mut rest: &mut [Cached<T>], length: usize) -> Vec<&mut [Cached<T>]> {
    let mut parts = Vec::new();
    while !rest.is_empty() {
        let mut cut = length.min(rest.len());
        while cut < rest.len() && rest[cut].key() == rest[cut - 1].key() {
            cut += 1;
        }
        let (part, others) = rest.split_at_mut(cut);
        parts.push(part);
        rest = others;
    }
    parts
}
