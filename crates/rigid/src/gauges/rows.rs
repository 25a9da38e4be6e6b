//! Rows of whole numbers and constants, noted one after the other before they have a place.

use crate::tables::Filler;
use numbers::machine::Links;
use numbers::machine::space::Parameter;
use numbers::{Machine, Table};

/// Rows that have no place yet.
#[derive(Clone, Debug)]
pub(super) struct Notes<const L: usize, const P: usize>(Vec<([usize; L], [f64; P])>);

impl<const L: usize, const P: usize> Default for Notes<L, P> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<const L: usize, const P: usize> Notes<L, P> {
    /// Adds a row; returns which it is.
    pub fn add(&mut self, links: [usize; L], numbers: [f64; P]) -> usize {
        self.0.push((links, numbers));
        self.0.len() - 1
    }
    pub fn len(&self) -> usize {
        self.0.len()
    }
    pub fn place(&self, parameters: &mut usize, links: &mut usize) -> Rows<L, P> {
        Rows {
            count: self.0.len(),
            links: Links::place(links, self.0.len()),
            numbers: Table::place(parameters, self.0.len()),
        }
    }
}

/// Where rows lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Rows<const L: usize, const P: usize> {
    pub count: usize,
    pub links: Links<L>,
    pub numbers: Table<Parameter, P>,
}

impl<const L: usize, const P: usize> Rows<L, P> {
    pub fn fill(&self, notes: &Notes<L, P>, f: &mut Filler) {
        for (row, (links, numbers)) in notes.0.iter().enumerate() {
            for (field, link) in links.iter().enumerate() {
                f.link(self.links, row, field, *link);
            }
            f.numbers(self.numbers, row, 0, numbers);
        }
    }
    #[inline(always)]
    pub fn all<M: Machine>(&self, k: &M) -> M::Rounds {
        k.count(self.count)
    }
    #[inline(always)]
    pub fn links<M: Machine>(&self, k: &M, row: M::I) -> [M::I; L] {
        k.link_row(self.links, row)
    }
    #[inline(always)]
    pub fn numbers<M: Machine>(&self, k: &M, row: M::I) -> [M::R; P] {
        k.read(self.numbers, row, 0)
    }
}
