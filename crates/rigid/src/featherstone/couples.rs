//! Pairs of nodes that may touch, and the degrees of freedom that move either.

use super::tables::{Forest, couple_link};
use crate::contacts::ContactPlan;

/// The pairs as flat lists, and where each slot between moving bodies finds its own.
#[derive(Clone, Debug, Default)]
pub(super) struct Couples {
    /// Fields of [`couple_link`].
    pub couples: Vec<[usize; couple_link::WIDTH]>,
    /// Degree of freedom, entry.
    pub paths: Vec<(usize, usize)>,
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
        let first_name = self.names.len();
        let mut couple = [0; couple_link::WIDTH];
        (couple[couple_link::GROUP_A], couple[couple_link::GROUP_B]) = (groups[0], groups[1]);
        for (side, row) in rows.into_iter().enumerate() {
            couple[couple_link::NODE_A + side] = row;
            couple[couple_link::A_BEGIN + 2 * side] = self.paths.len();
            for dof in path(forest, row - forest.bases.len()) {
                let known = self.names[first_name..].iter().position(|d| *d == dof);
                let entry = known.unwrap_or_else(|| {
                    self.names.push(dof);
                    self.names.len() - 1 - first_name
                });
                self.paths.push((dof, entry));
            }
            couple[couple_link::A_END + 2 * side] = self.paths.len();
        }
        couple[couple_link::ENTRY_BEGIN] = first_name;
        couple[couple_link::ENTRIES] = self.names.len() - first_name;
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
