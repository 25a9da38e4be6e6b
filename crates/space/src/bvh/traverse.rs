//! Going down the tree.

use super::{Bvh, NONE, Node, OBJECT};
use crate::Aabb;
use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use glam::{Vec3, Vec4};

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
        // Behind means that a sweep enters by the high planes.
        let behind = sweep.inverse.to_array().map(|i| i < 0.0);
        self.visit_in_order(limit, visit, |node, limit| {
            let mut enter = Vec4::ZERO;
            let mut leave = Vec4::splat(limit);
            for axis in 0..3 {
                let a = (node.low[axis] - upper[axis]) * inverse[axis];
                let b = (node.high[axis] - lower[axis]) * inverse[axis];
                let (a, b) = if behind[axis] { (b, a) } else { (a, b) };
                enter = enter.max(a);
                leave = leave.min(b);
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
    #[inline(always)]
    fn visit_in_order(
        &self,
        mut limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
        keys: impl Fn(&Node, f32) -> (Vec4, u32),
    ) {
        // Key above, child below: positive floats and their bits have one order.
        let entry = |key: f32, child: u32| u64::from(key.to_bits()) << 32 | u64::from(child);
        let mut stack = Stack::<u64, 96>::with(entry(0.0, 0));
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
            let (key, mut mask) = keys(node, limit);
            let key = key.to_array();
            let mut met = [0_u64; 4];
            let mut count = 0;
            while mask != 0 {
                let slot = mask.trailing_zeros() as usize;
                mask &= mask - 1;
                debug_assert!(node.child[slot] != NONE);
                // Sorted as they come, the nearest last.
                let new = entry(key[slot & 3], node.child[slot & 3]);
                let mut i = count;
                while i > 0 && met[i - 1] < new {
                    met[i] = met[i - 1];
                    i -= 1;
                }
                met[i] = new;
                count += 1;
            }
            for &entry in &met[..count] {
                stack.push(entry);
            }
        }
    }
}
