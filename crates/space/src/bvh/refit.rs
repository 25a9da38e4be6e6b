//! The same tree about boxes that have moved.

use super::{Bvh, NONE, NOWHERE, OBJECT};
use crate::{Boxes, Structure};

/// A tree is rebuilt when its nodes' areas, which the chance of visiting them
/// is proportional to, have grown by this factor since it was built.
const WORN: f32 = 1.5;

impl Bvh {
    /// Fits every box, children before parents; rebuilds a tree that has worn out.
    pub(super) fn refit(&mut self, boxes: &Boxes) {
        if self.order.is_empty() {
            self.find_order();
        }
        let mut area = 0.0;
        for &i in self.order.iter().rev() {
            let node = &mut self.nodes[i as usize];
            for slot in 0..4 {
                let child = node.child[slot];
                if child & OBJECT != 0 && child != NONE {
                    node.set_box(slot, boxes.get(child & !OBJECT));
                }
            }
            let (bounds, parent) = (node.bounds(), node.parent);
            if parent != NOWHERE {
                area += bounds.half_area();
                self.nodes[parent as usize / 4].set_box(parent as usize % 4, &bounds);
            }
        }
        if area > WORN * self.built_area.max(f32::MIN_POSITIVE) {
            *self = Self::build(boxes);
        }
    }

    /// Lists the nodes in use from the root down.
    pub(super) fn find_order(&mut self) {
        self.order.push(0);
        let mut next = 0;
        while let Some(&i) = self.order.get(next) {
            let children = self.nodes[i as usize].child;
            self.order
                .extend(children.iter().filter(|c| *c & OBJECT == 0));
            next += 1;
        }
    }

    /// Sum of the areas of all nodes but the root, in the order of a refit.
    pub(super) fn inner_area(&self) -> f32 {
        let inner = self.order.iter().rev().filter(|i| **i != 0);
        inner
            .map(|i| self.nodes[*i as usize].bounds().half_area())
            .sum()
    }
}
