//! Pairs of nodes that may touch, that a joint ties into a loop, or that are coupled, and the degrees of freedom that move either.

use super::closing::Closing;
use super::coupling::Coupled;
use super::tables::{Forest, couple_link};
use crate::contacts::ContactPlan;

/// The pairs as flat lists, and where each slot between moving bodies finds its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Couples {
    /// Fields of [`couple_link`].
    pub couples: Vec<[usize; couple_link::WIDTH]>,
    /// Degree of freedom of each entry.
    pub names: Vec<usize>,
    /// Slot, pair of nodes, first row of its entries.
    pub slots: Vec<(usize, usize, usize)>,
    /// Rows of entries of all slots together.
    pub entries: usize,
    /// The same of all joints that close loops, and of all couplings.
    pub closing_entries: usize,
    pub coupling_entries: usize,
}

impl Couples {
    /// Those of a plan of contacts, and of closings and couplings, which are told theirs.
    pub fn new(
        forest: &Forest,
        plan: &ContactPlan,
        closings: &mut [Closing],
        couplings: &mut [Coupled],
    ) -> Self {
        let mut all = Self::default();
        for (slot, a, b) in plan.between_slots() {
            let couple = all.of([a.group, b.group], [a.row, b.row], forest);
            all.slots.push((slot, couple, all.entries));
            all.entries += all.couples[couple][couple_link::ENTRIES];
        }
        for closing in closings {
            closing.couple = all.of(closing.groups, closing.rows, forest);
            closing.entry = all.closing_entries;
            all.closing_entries += all.couples[closing.couple][couple_link::ENTRIES];
        }
        for coupled in couplings {
            coupled.couple = all.of(coupled.groups, coupled.rows, forest);
            coupled.entry = all.coupling_entries;
            let couple = all.couples[coupled.couple];
            let (own_a, own) = (couple[couple_link::OWN_A], couple[couple_link::OWN]);
            // Where one joint carries the other, its own entry is the first of the shared ones.
            coupled.starts = [
                if own_a > 0 { 0 } else { own },
                if own > own_a { own_a } else { own },
            ];
            all.coupling_entries += couple[couple_link::ENTRIES];
        }
        all
    }

    /// Whether any bodies that move give each other impulses.
    pub fn exchange(&self) -> bool {
        !self.couples.is_empty()
    }

    /// The pair of two nodes, or of a node and the world, given their trees.
    fn of(&mut self, groups: [usize; 2], rows: [usize; 2], forest: &Forest) -> usize {
        let nodes =
            |c: &[usize; couple_link::WIDTH]| [c[couple_link::NODE_A], c[couple_link::NODE_B]];
        let known = self.couples.iter().position(|c| nodes(c) == rows);
        known.unwrap_or_else(|| {
            self.add(groups, rows, forest);
            self.couples.len() - 1
        })
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
