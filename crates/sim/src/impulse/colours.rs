//! Contacts of one colour share no body, and can be solved side by side.
//!
//! Greedy colouring in the order of the contacts: each takes the first colour that none of its two
//! bodies has yet. What does not move takes no part. The order, and with it the outcome, is that of
//! the pairs of shapes, whatever the number of threads and lanes.

use rigid::impulse::WORLD;
use std::ops::Range;

/// Contacts that find no place among so many colours are solved one by one.
const MOST: usize = 64;

/// Contacts, batch by batch.
#[derive(Debug, Default)]
pub(super) struct Colours {
    /// Contacts in the order in which they are solved.
    order: Vec<u32>,
    /// Of each batch: its contacts in `order`.
    pub batches: Vec<Range<usize>>,
    /// Of each colour: its batches.
    pub colours: Vec<Range<usize>>,
    /// Whether the last of them is no colour, and its batches must be solved in turn.
    pub uncoloured: bool,
    /// Of each contact: its lane, counted through all batches.
    places: Vec<u32>,
    used: Vec<u64>,
    keys: Vec<u32>,
    counts: Vec<usize>,
}

impl Colours {
    /// The contacts of a batch.
    pub fn batch(&self, batch: usize) -> &[u32] {
        &self.order[self.batches[batch].clone()]
    }

    /// Of each contact, in order: its lane, counted through all batches.
    pub fn places(&self) -> &[u32] {
        &self.places
    }

    /// Colours contacts, given the rows of their bodies and their numbers of points; `width` of one
    /// colour make a batch, those of like numbers of points together as far as that fills it.
    pub fn paint(&mut self, contacts: &[([u32; 2], usize)], bodies: usize, width: usize) {
        self.used.clear();
        self.used.resize(bodies, 0);
        self.keys.clear();
        for (rows, points) in contacts {
            let colour = self.colour(*rows);
            self.keys.push((colour * POINTS + points) as u32);
        }
        self.sort();
        self.cut(width);
        self.place(width);
    }

    /// The first colour that is free at both bodies, or [`MOST`].
    fn colour(&mut self, rows: [u32; 2]) -> usize {
        let used = |row: u32| {
            if row == WORLD {
                0
            } else {
                self.used[row as usize]
            }
        };
        let free = !(used(rows[0]) | used(rows[1]));
        let colour = free.trailing_zeros() as usize;
        if colour < MOST {
            for row in rows.into_iter().filter(|row| *row != WORLD) {
                self.used[row as usize] |= 1 << colour;
            }
        }
        colour
    }

    /// Puts the contacts in the order of their keys; those of one key stay in order.
    fn sort(&mut self) {
        let keys = (MOST + 1) * POINTS;
        self.counts.clear();
        self.counts.resize(keys + 1, 0);
        for key in &self.keys {
            self.counts[*key as usize + 1] += 1;
        }
        for key in 0..keys {
            self.counts[key + 1] += self.counts[key];
        }
        self.order.clear();
        self.order.resize(self.keys.len(), 0);
        for (contact, key) in self.keys.iter().enumerate() {
            let next = &mut self.counts[*key as usize];
            self.order[*next] = contact as u32;
            *next += 1;
        }
    }

    /// Tells contacts where they are.
    fn place(&mut self, width: usize) {
        self.places.resize(self.order.len(), 0);
        for (batch, members) in self.batches.iter().enumerate() {
            for (lane, contact) in self.order[members.clone()].iter().enumerate() {
                self.places[*contact as usize] = (batch * width + lane) as u32;
            }
        }
    }

    /// Batches of one colour each; what has no colour is one by one.
    fn cut(&mut self, width: usize) {
        self.batches.clear();
        self.colours.clear();
        self.uncoloured = false;
        let colour_of = |contact: &u32| self.keys[*contact as usize] as usize / POINTS;
        let mut begin = 0;
        for run in self.order.chunk_by(|a, b| colour_of(a) == colour_of(b)) {
            let end = begin + run.len();
            self.uncoloured = colour_of(&run[0]) == MOST;
            let width = if self.uncoloured { 1 } else { width };
            let first = self.batches.len();
            let cuts = (begin..end).step_by(width);
            self.batches
                .extend(cuts.map(|at| at..(at + width).min(end)));
            self.colours.push(first..self.batches.len());
            begin = end;
        }
    }
}

/// One more than the points that a contact can have.
const POINTS: usize = rigid::impulse::POINTS + 1;

#[cfg(test)]
mod tests {
    use super::*;

    /// A star of contacts with one body: each has a colour of its own, beyond 64 as well.
    #[test]
    fn contacts_of_one_body_never_share_a_colour() {
        let contacts: Vec<_> = (2..102).map(|i| ([1, i], 1)).collect();
        let mut colours = Colours::default();
        colours.paint(&contacts, 102, 16);
        assert_eq!(colours.colours.len(), MOST + 1);
        assert!(colours.uncoloured && colours.colours[MOST].len() == 100 - MOST);
        assert!(colours.batches.iter().all(|b| b.len() == 1));
        for batch in 0..100 {
            let contact = colours.batch(batch)[0] as usize;
            assert_eq!(colours.places()[contact] as usize, 16 * batch);
        }
        let mut all: Vec<_> = (0..100).flat_map(|b| colours.batch(b).to_vec()).collect();
        all.sort_unstable();
        assert_eq!(all, (0..100).collect::<Vec<_>>());
    }

    /// A row of bodies needs two colours; with the ground, which is shared, three.
    #[test]
    fn the_ground_is_shared() {
        let chain = (1..40_u32).map(|i| ([i, i + 1], 4));
        let ground = (1..41_u32).map(|i| ([WORLD, i], 4));
        let contacts: Vec<_> = chain.chain(ground).collect();
        let mut colours = Colours::default();
        colours.paint(&contacts, 41, 8);
        assert_eq!(colours.colours.len(), 3);
        for range in &colours.colours {
            let mut seen = std::collections::HashSet::new();
            for contact in range.clone().flat_map(|batch| colours.batch(batch)) {
                for row in contacts[*contact as usize].0 {
                    assert!(row == WORLD || seen.insert(row), "body {row} twice");
                }
            }
        }
    }
}
