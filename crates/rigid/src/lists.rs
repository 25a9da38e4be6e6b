//! Rows listed as a kernel finds them.
//!
//! Of a large table, few rows matter in a step: of a humanoid's 190 slots for contacts, some fifteen in any of
//! sixteen worlds. Lists name those, in the order in which they are found, so that what follows goes through no
//! others. Worlds that stand side by side in lanes share a list: it names what any of them needs, and masks keep
//! the others out.

use crate::tables::Filler;
use numbers::machine::space::Scratch;
use numbers::machine::{Index, Links};
use numbers::{Machine, Real, Table};

/// Several lists, one after the other in one table, each with room for so many rows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Lists {
    /// How many rows each list names now.
    length: Table<Scratch>,
    rows: Table<Scratch>,
    /// Where each list begins.
    first: Links,
}

impl Lists {
    /// Lists that have room for `capacities` rows.
    pub fn place(capacities: &[usize], links: &mut usize, scratch: &mut usize) -> Self {
        Self {
            length: Table::place(scratch, capacities.len()),
            rows: Table::place(scratch, capacities.iter().sum()),
            first: Links::place(links, capacities.len()),
        }
    }
    /// Writes where each list begins.
    pub fn fill(&self, capacities: &[usize], f: &mut Filler) {
        for list in 0..capacities.len() {
            f.link(self.first, list, 0, capacities[..list].iter().sum());
        }
    }
    /// Where the length of a list lies in the scratch.
    pub fn length_at(&self, list: usize) -> usize {
        self.length.at(list, 0)
    }
    /// Empties a list.
    #[inline(always)]
    pub fn clear<M: Machine>(&self, k: &mut M, list: usize) {
        k.store(self.length, k.index(list), 0, M::R::zero());
    }
    /// Names one more row.
    #[inline(always)]
    pub fn append<M: Machine>(&self, k: &mut M, list: M::I, row: M::I) {
        let length = k.load(self.length, list, 0);
        let place = k.link(self.first, list, 0).plus(k.whole(length));
        k.store(self.rows, place, 0, k.number(row));
        k.store(self.length, list, 0, length + M::R::one());
    }
    /// Where the rows of a list stand, for [`row`](Self::row).
    #[inline(always)]
    pub fn places<M: Machine>(&self, k: &M, list: M::I) -> M::Rounds {
        let first = k.link(self.first, list, 0);
        let length = k.whole(k.load(self.length, list, 0));
        k.range(first, first.plus(length))
    }
    /// The row that stands there.
    #[inline(always)]
    pub fn row<M: Machine>(&self, k: &M, place: M::I) -> M::I {
        k.whole(k.load(self.rows, place, 0))
    }
}
