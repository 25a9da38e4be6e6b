//! One object at a time.
//!
//! An object is inserted as into an R-tree (Guttman 1984): down along the
//! children whose area grows least, the fewest objects deciding between equals.
//! On the way back, a child and a grandchild change places where that shrinks
//! the box between them (Kensler 2008, "Tree rotations for improving bounding
//! volume hierarchies").

use super::{Bvh, NONE, NOWHERE, Node, OBJECT};
use crate::Aabb;

impl Bvh {
    pub(super) fn insert(&mut self, object: u32, aabb: &Aabb) {
        self.order.clear();
        if self.place.len() <= object as usize {
            self.place.resize(object as usize + 1, NOWHERE);
        }
        let mut at = 0;
        loop {
            let node = &self.nodes[at];
            let empty = (0..4).find(|s| node.child[*s] == NONE);
            let (slot, growth) = self.cheapest_slot(node, aabb);
            if let Some(slot) = empty
                && growth > 0.0
            {
                break self.hang((4 * at + slot) as u32, object | OBJECT, aabb);
            }
            let child = node.child[slot];
            if child & OBJECT == 0 {
                at = child as usize;
                continue;
            }
            let both = self.allocate();
            let old = self.nodes[at].child_box(slot);
            self.hang(4 * both, child, &old);
            self.hang(4 * both + 1, object | OBJECT, aabb);
            self.nodes[both as usize].objects = 1;
            break self.hang((4 * at + slot) as u32, both, &old.union(aabb));
        }
        self.count_up(self.place[object as usize] / 4, 1);
        self.tighten(self.place[object as usize] / 4, true);
    }

    pub(super) fn remove(&mut self, object: u32) {
        self.order.clear();
        let place = std::mem::replace(&mut self.place[object as usize], NOWHERE);
        let at = place / 4;
        self.count_up(at, u32::MAX);
        self.hang(place, NONE, &Aabb::EMPTY);
        let node = self.nodes[at as usize];
        let mut left = (0..4).filter(|s| node.child[*s] != NONE);
        if let (Some(only), None, true) = (left.next(), left.next(), node.parent != NOWHERE) {
            self.hang(node.parent, node.child[only], &node.child_box(only));
            self.free.push(at);
            self.tighten(node.parent / 4, false);
        } else {
            self.tighten(at, false);
        }
    }

    /// A short way is refitted, a long one is a removal and an insertion.
    pub(super) fn relocate(&mut self, object: u32, aabb: &Aabb) {
        let place = self.place[object as usize];
        let node = &mut self.nodes[place as usize / 4];
        if node.bounds().overlaps(aabb) {
            node.set_box(place as usize % 4, aabb);
            self.tighten(place / 4, true);
        } else {
            self.remove(object);
            self.insert(object, aabb);
        }
    }

    /// The child whose area grows least by taking in a box, and by how much.
    /// An object counts with the area of the node that it would become.
    fn cheapest_slot(&self, node: &Node, aabb: &Aabb) -> (usize, f32) {
        let mut best = (0, f32::INFINITY, u32::MAX);
        for slot in (0..4).filter(|s| node.child[*s] != NONE) {
            let (child, old) = (node.child[slot], node.child_box(slot));
            let (area, objects) = match child & OBJECT != 0 {
                true => (0.0, 1),
                false => (old.half_area(), self.nodes[child as usize].objects),
            };
            let growth = old.union(aabb).half_area() - area;
            if (growth, objects) < (best.1, best.2) {
                best = (slot, growth, objects);
            }
        }
        (best.0, best.1)
    }

    /// Puts a child, which may be none, into a slot.
    fn hang(&mut self, place: u32, child: u32, aabb: &Aabb) {
        self.nodes[place as usize / 4].set(place as usize % 4, child, aabb);
        self.attach(place, child);
    }

    /// Tells a child where it hangs.
    pub(super) fn attach(&mut self, place: u32, child: u32) {
        if child == NONE {
        } else if child & OBJECT != 0 {
            self.place[(child & !OBJECT) as usize] = place;
        } else {
            self.nodes[child as usize].parent = place;
        }
    }

    fn allocate(&mut self) -> u32 {
        match self.free.pop() {
            Some(node) => {
                self.nodes[node as usize] = Node::EMPTY;
                node
            }
            None => {
                self.nodes.push(Node::EMPTY);
                self.nodes.len() as u32 - 1
            }
        }
    }

    /// Adds to the number of objects (modulo 2³²) of a node and of those above.
    fn count_up(&mut self, mut at: u32, more: u32) {
        loop {
            let node = &mut self.nodes[at as usize];
            node.objects = node.objects.wrapping_add(more);
            if node.parent == NOWHERE {
                break;
            }
            at = node.parent / 4;
        }
    }

    /// Fits the boxes of a node and of those above, with rotations where asked for.
    fn tighten(&mut self, mut at: u32, rotate: bool) {
        loop {
            if rotate {
                self.rotate(at);
            }
            let node = &self.nodes[at as usize];
            if node.parent == NOWHERE {
                break;
            }
            let (bounds, parent) = (node.bounds(), node.parent);
            self.nodes[parent as usize / 4].set_box(parent as usize % 4, &bounds);
            at = parent / 4;
        }
    }

    /// Swaps the child and the grandchild of `at` that save the most area, if any do.
    fn rotate(&mut self, at: u32) {
        let node = self.nodes[at as usize];
        let mut best = (0.0, 0, 0, 0);
        for inner in (0..4).filter(|s| node.child[*s] & OBJECT == 0) {
            let below = &self.nodes[node.child[inner] as usize];
            let area = node.child_box(inner).half_area();
            for grand in (0..4).filter(|s| below.child[*s] != NONE) {
                let rest = (0..4).filter(|s| *s != grand);
                let rest = rest.fold(Aabb::EMPTY, |b, s| b.union(&below.child_box(s)));
                for other in (0..4).filter(|s| *s != inner && node.child[*s] != NONE) {
                    let saved = area - rest.union(&node.child_box(other)).half_area();
                    if saved > best.0 {
                        best = (saved, inner, grand, other);
                    }
                }
            }
        }
        let (saved, inner, grand, other) = best;
        // Less than rounding is not worth it, and could go on for ever.
        if saved > 1e-6 * node.bounds().half_area() {
            self.swap(at, other, node.child[inner], grand);
        }
    }

    /// Swaps the child `other` of `at` with the child `grand` of `below`, itself a child of `at`.
    fn swap(&mut self, at: u32, other: usize, below: u32, grand: usize) {
        self.order.clear();
        let (up, down) = (self.nodes[at as usize], self.nodes[below as usize]);
        self.hang(
            4 * at + other as u32,
            down.child[grand],
            &down.child_box(grand),
        );
        self.hang(
            4 * below + grand as u32,
            up.child[other],
            &up.child_box(other),
        );
        let lower = &self.nodes[below as usize];
        let objects = lower.child.iter().map(|c| match c {
            c if *c == NONE => 0,
            c if c & OBJECT != 0 => 1,
            c => self.nodes[*c as usize].objects,
        });
        let (objects, bounds, parent) = (objects.sum(), lower.bounds(), lower.parent);
        self.nodes[below as usize].objects = objects;
        self.nodes[at as usize].set_box(parent as usize % 4, &bounds);
    }
}
