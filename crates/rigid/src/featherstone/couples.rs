//! Pairs of nodes that may touch, and the degrees of freedom that move either.

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
}

impl Couples {
    pub fn new(forest: &Forest, plan: &ContactPlan) -> Self {
        let mut all = Self::default();
        for (slot, a, b) in plan.between_slots() {
            let known = all
                .couples
                .iter()
                .position(|c| (c[couple_link::NODE_A], c[couple_link::NODE_B]) == (a.row, b.row));
            let couple = known.unwrap_or_else(|| {
                all.add([a.group, b.group], [a.row, b.row], forest);
                all.couples.len() - 1
            });
            all.slots.push((slot, couple, all.entries));
            all.entries += all.couples[couple][couple_link::ENTRIES];
        }
        all
    }

    fn add(&mut self, groups: [usize; 2], rows: [usize; 2], forest: &Forest) {
        let [a, b] = rows.map(|row| path(forest, row - forest.bases.len()));
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
fn path(forest: &Forest, node: usize) -> Vec<usize> {
    let mut dofs = Vec::new();
    let mut next = Some(node);
    while let Some(n) = next {
        let node = &forest.nodes[n];
        dofs.extend((node.dof..node.dof + node.dofs()).rev());
        next = node.parent;
    }
    dofs
}
