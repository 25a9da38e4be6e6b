//! Going down the tree.

use super::{Bvh, Node, OBJECT};
use crate::Aabb;
use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use glam::{Vec3, Vec4};
use std::hint::select_unpredictable;

impl Bvh {
    /// Visits the objects below `node` whose boxes overlap `region`.
    #[inline]
    pub(super) fn visit_overlapping(&self, node: u32, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let mut stack = Stack::<u32, 64>::with(node);
        while let Some(node) = stack.pop() {
            let node = &self.nodes[node as usize];
            let mut mask = node.overlapping(region);
            while mask != 0 {
                let child = node.child[mask.trailing_zeros() as usize];
                mask &= mask - 1;
                if child & OBJECT != 0 {
                    visit(child & !OBJECT);
                } else {
                    stack.push(child);
                }
            }
        }
    }

    /// Visits the objects whose boxes a sweep meets, the earliest first.
    #[inline]
    pub(super) fn visit_swept(
        &self,
        sweep: &Sweep,
        limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
    ) {
        let upper = sweep.upper.to_array().map(Vec4::splat);
        let lower = sweep.lower.to_array().map(Vec4::splat);
        let inverse = sweep.inverse.to_array().map(Vec4::splat);
        // Behind means that a sweep enters by the high planes. No processor foresees that of rays at random.
        let behind = sweep.inverse.to_array().map(|i| i < 0.0);
        let first = [0, 1, 2].map(|i| select_unpredictable(behind[i], lower[i], upper[i]));
        let last = [0, 1, 2].map(|i| select_unpredictable(behind[i], upper[i], lower[i]));
        self.visit_in_order(limit, visit, |node, limit| {
            let mut enter = Vec4::ZERO;
            let mut leave = Vec4::splat(limit);
            for axis in 0..3 {
                let (low, high) = (&node.low[axis], &node.high[axis]);
                let near = select_unpredictable(behind[axis], high, low);
                let far = select_unpredictable(behind[axis], low, high);
                enter = enter.max((*near - first[axis]) * inverse[axis]);
                leave = leave.min((*far - last[axis]) * inverse[axis]);
            }
            (enter, enter.cmple(leave * SLACK).bitmask())
        });
    }

    /// Visits the objects whose boxes are near, the nearest first.
    #[inline]
    pub(super) fn visit_near(&self, point: Vec3, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let point = point.to_array().map(Vec4::splat);
        self.visit_in_order(limit, visit, |node, limit| {
            let gap = |axis: usize| {
                let outside = (node.low[axis] - point[axis]).max(point[axis] - node.high[axis]);
                let outside = outside.max(Vec4::ZERO);
                outside * outside
            };
            let square = gap(0) + gap(1) + gap(2);
            // A child that is not there is at infinity.
            let limit = (limit * SLACK).min(f32::MAX);
            (square, square.cmple(Vec4::splat(limit)).bitmask())
        });
    }

    /// Visits objects in the order of a key that is at least 0 and nowhere less
    /// in a child than in its parent. `keys` gives those of a node's children, and
    /// one bit per child whose key is within the limit.
    ///
    /// Which of the four children are met, no processor foresees. So all are put in order, by a
    /// network of comparisons, and stacked, those that are not met as 0: these come last, above the top.
    #[inline(always)]
    fn visit_in_order(
        &self,
        mut limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
        keys: impl Fn(&Node, f32) -> (Vec4, u32),
    ) {
        // Key above, child below: positive floats and their bits have one order.
        let entry = |key: f32, child: u32| u64::from(key.to_bits()) << 32 | u64::from(child);
        let mut stack = Stack::<u64, 64>::with(entry(0.0, 0));
        while let Some(top) = stack.pop() {
            if f32::from_bits((top >> 32) as u32) > limit * SLACK {
                continue;
            }
            let child = top as u32;
            if child & OBJECT != 0 {
                limit = visit(child & !OBJECT);
                continue;
            }
            let node = &self.nodes[child as usize];
            let (key, met) = keys(node, limit);
            let key = key.to_array();
            let of = |slot: usize| {
                let is_met = u64::from(met >> slot & 1).wrapping_neg();
                entry(key[slot], node.child[slot]) & is_met
            };
            let all = farthest_first([of(0), of(1), of(2), of(3)]);
            stack.push_some(all, met.count_ones() as usize);
        }
    }
}

/// In descending order, the nearest last.
#[inline(always)]
fn farthest_first([a, b, c, d]: [u64; 4]) -> [u64; 4] {
    let (a, b) = (a.max(b), a.min(b));
    let (c, d) = (c.max(d), c.min(d));
    let (a, c) = (a.max(c), a.min(c));
    let (b, d) = (b.max(d), b.min(d));
    [a, b.max(c), b.min(c), d]
}
