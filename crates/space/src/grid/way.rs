//! Cells along a sweep.

use super::{Cell, Grid, LAST_CELL};
use crate::cast::{SLACK, Sweep};
use glam::Vec3;

/// A sweep's way through the grid.
pub(super) struct Way<'a> {
    sweep: &'a Sweep,
    direction: Vec3,
    /// The axis of the fastest motion.
    axis: usize,
    /// When the way through the bounds begins and ends.
    enter: f32,
    leave: f32,
    /// First and last layer along the axis.
    first: i32,
    last: i32,
}

impl<'a> Way<'a> {
    /// Nothing if the sweep does not meet the bounds by the time `limit`.
    pub fn new(grid: &Grid, sweep: &'a Sweep, limit: f32) -> Option<Self> {
        let direction = Vec3::select(
            sweep.inverse.cmpeq(Vec3::MAX),
            Vec3::ZERO,
            sweep.inverse.recip(),
        );
        let axis = direction.abs().max_position();
        let enter = sweep.enters(&grid.bounds, limit)?;
        let b = (grid.bounds.max - sweep.lower) * sweep.inverse;
        let a = (grid.bounds.min - sweep.upper) * sweep.inverse;
        let leave = a.max(b).min_element().min(limit) * SLACK;
        let mut way = Self {
            sweep,
            direction,
            axis,
            enter,
            leave,
            first: 0,
            last: 0,
        };
        let (low, high) = way.range(grid, enter, leave);
        (way.first, way.last) = (low[axis], high[axis]);
        if direction[axis] < 0.0 {
            (way.first, way.last) = (way.last, way.first);
        }
        Some(way)
    }

    pub fn layers(&self) -> i64 {
        i64::from(self.first.abs_diff(self.last)) + 1
    }

    /// The cells covered between two times, within the grid's bounds.
    fn range(&self, grid: &Grid, from: f32, to: f32) -> (Cell, Cell) {
        let (d, sweep) = (self.direction, self.sweep);
        let low = sweep.lower + (d * from).min(d * to);
        let high = sweep.upper + (d * from).max(d * to);
        // Rounding of the products above.
        let pad = 1e-6 * (low.abs().max(high.abs()) + (d * to).abs() + sweep.lower.abs());
        let bounds = &grid.bounds;
        let within = |x: Vec3| x.max(bounds.min).min(bounds.max);
        (grid.cell(within(low - pad)), grid.cell(within(high + pad)))
    }

    /// The cells covered while in the i-th layer; nothing if that is after `limit`.
    pub fn covered(&self, grid: &Grid, i: i64, limit: f32) -> Option<(Cell, Cell)> {
        let (axis, forth) = (self.axis, self.direction[self.axis] > 0.0);
        let layer = if forth {
            self.first + i as i32
        } else {
            self.first - i as i32
        };
        let pad = 1e-6 * (layer.abs() as f32 + 1.0);
        // The last cells have no end.
        let low = if layer == -LAST_CELL {
            f32::NEG_INFINITY
        } else {
            (layer as f32 - pad) / grid.scale
        };
        let high = if layer == LAST_CELL {
            f32::INFINITY
        } else {
            (layer as f32 + 1.0 + pad) / grid.scale
        };
        let inverse = self.sweep.inverse[axis];
        let a = (low - self.sweep.upper[axis]) * inverse;
        let b = (high - self.sweep.lower[axis]) * inverse;
        let (from, to) = if forth { (a, b) } else { (b, a) };
        let (from, to) = (from.max(self.enter), to.min(self.leave).min(limit * SLACK));
        if from > limit * SLACK {
            return None;
        }
        let (mut low, mut high) = self.range(grid, from, to.max(from));
        (low[axis], high[axis]) = (layer, layer);
        Some((low, high))
    }
}
