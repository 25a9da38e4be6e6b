//! Pairs of nodes that may touch, that a joint ties into a loop, or that are coupled, and the degrees of
//! freedom that move either.

use super::closing::Closing;
use super::coupling::Coupled;
use super::forest::Forest;
use super::locked::{Law, Locked};
use super::tables::couple_link;
use crate::contacts::ContactPlan;
use model::Model;
use std::collections::HashMap;

/// A row of what is not locked, until it is known which is spare.
const NONE: usize = usize::MAX;

/// The pairs as flat lists, and where each slot between moving bodies finds its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Couples {
    /// Fields of [`couple_link`].
    pub couples: Vec<[usize; couple_link::WIDTH]>,
    /// Row of each pair, by the rows of its nodes.
    known: HashMap<[usize; 2], usize>,
    /// Degree of freedom of each entry.
    pub names: Vec<usize>,
    /// Slot, pair of nodes, first row of its entries.
    pub slots: Vec<(usize, usize, usize)>,
    /// Rows of entries of all slots together.
    pub entries: usize,
    /// Rows that joints and couplings lock, and one more that takes what is not locked.
    pub locked: Vec<Locked>,
    /// Entries of all of them together.
    pub locked_entries: usize,
}

impl Couples {
    /// Those of a plan of contacts.
    pub fn new(forest: &Forest, plan: &ContactPlan) -> Self {
        let mut all = Self::default();
        for (slot, a, b) in plan.between_slots() {
            let couple = all.of([a.group, b.group], [a.row, b.row], forest);
            all.slots.push((slot, couple, all.entries));
            all.entries += all.couples[couple][couple_link::ENTRIES];
        }
        all
    }

    /// Adds what joints and couplings lock, in steps of `h` [s], and tells them where.
    pub fn lock(
        &mut self,
        forest: &Forest,
        model: &Model,
        closings: &mut [Closing],
        couplings: &mut [Coupled],
        h: f64,
    ) {
        for closing in closings.iter_mut() {
            closing.couple = self.of(closing.groups, closing.rows, forest);
            for (row, locks) in closing.locks.rows().into_iter().enumerate() {
                let law = closing.law(row, &model.joints[closing.joint], h);
                closing.locked[row] = if locks {
                    self.add_row(closing.couple, law)
                } else {
                    NONE
                };
            }
        }
        for coupled in couplings.iter_mut() {
            coupled.couple = self.of(coupled.groups, coupled.rows, forest);
            coupled.locked = self.add_row(coupled.couple, Law::default());
            let couple = self.couples[coupled.couple];
            let (own_a, own) = (couple[couple_link::OWN_A], couple[couple_link::OWN]);
            // Where one joint carries the other, its own entry is the first of the shared ones.
            coupled.starts = [
                if own_a > 0 { 0 } else { own },
                if own > own_a { own_a } else { own },
            ];
        }
        self.add_spare(closings);
    }

    /// A row that takes what is not locked, with room for the longest path.
    fn add_spare(&mut self, closings: &mut [Closing]) {
        if self.locked.is_empty() {
            return;
        }
        let spare = self.locked.len();
        for row in closings.iter_mut().flat_map(|c| &mut c.locked) {
            *row = (*row).min(spare);
        }
        self.locked.push(Locked {
            entry: self.locked_entries,
            ..Locked::default()
        });
        let longest = self.couples.iter().map(|c| c[couple_link::ENTRIES]).max();
        self.locked_entries += longest.unwrap_or(0);
    }

    fn add_row(&mut self, couple: usize, law: Law) -> usize {
        self.locked.push(Locked {
            couple,
            entry: self.locked_entries,
            law,
        });
        self.locked_entries += self.couples[couple][couple_link::ENTRIES];
        self.locked.len() - 1
    }

    /// How many rows are locked.
    pub fn rows(&self) -> usize {
        self.locked.len().saturating_sub(1)
    }

    /// Whether any bodies that move give each other impulses.
    pub fn exchange(&self) -> bool {
        !self.couples.is_empty()
    }

    /// The pair of two nodes, or of a node and the world, given their trees.
    fn of(&mut self, groups: [usize; 2], rows: [usize; 2], forest: &Forest) -> usize {
        if let Some(&couple) = self.known.get(&rows) {
            return couple;
        }
        self.add(groups, rows, forest);
        let couple = self.couples.len() - 1;
        self.known.insert(rows, couple);
        couple
    }

    fn add(&mut self, groups: [usize; 2], rows: [usize; 2], forest: &Forest) {
        let [a, b] = rows.map(|row| path(forest, row.checked_sub(forest.bases.len())));
        let both = a.iter().rev().zip(b.iter().rev());
        let common = both.take_while(|(one, other)| one == other).count();
        let (own_a, own_b) = (a.len() - common, b.len() - common);
        let mut couple = [0; couple_link::WIDTH];
        (couple[couple_link::GROUP_A], couple[couple_link::GROUP_B]) = (groups[0], groups[1]);
        (couple[couple_link::NODE_A], couple[couple_link::NODE_B]) = (rows[0], rows[1]);
        couple[couple_link::ENTRY_BEGIN] = self.names.len();
        couple[couple_link::OWN_A] = own_a;
        couple[couple_link::OWN] = own_a + own_b;
        couple[couple_link::ENTRIES] = own_a + own_b + common;
        self.names.extend(&a[..own_a]);
        self.names.extend(&b[..own_b]);
        self.names.extend(&a[own_a..]);
        self.couples.push(couple);
    }
}

/// The degrees of freedom between a node and the world, in the order in which they are eliminated.
fn path(forest: &Forest, node: Option<usize>) -> Vec<usize> {
    let mut dofs = Vec::new();
    let mut next = node;
    while let Some(n) = next {
        let node = &forest.nodes[n];
        dofs.extend((node.dof..node.dof + node.dofs()).rev());
        next = node.parent;
    }
    dofs
}
