//! What every structure can do; the queries are built on it, once for all.

use crate::cast::Sweep;
use crate::{Aabb, Boxes, Pair, pairs};
use glam::Vec3;

/// Finds candidates among boxes.
///
/// A structure holds the *bounded* objects of a [`Boxes`] and is told of every
/// change. It answers with indices alone; [`Space`](crate::Space) makes queries of them.
/// Its methods are called through `Space`, hence the sealed argument types.
pub trait Structure: Sized + Send + Sync {
    /// Its name, as the bench prints it.
    const NAME: &'static str;

    /// From scratch.
    fn build(boxes: &Boxes) -> Self;

    /// All boxes may have moved; the objects are the same.
    fn refresh(&mut self, boxes: &Boxes) {
        *self = Self::build(boxes);
    }
    /// `object` is new in `boxes`.
    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        let _ = object;
        self.refresh(boxes);
    }
    /// `object`, whose box was `old`, is no longer in `boxes`.
    fn removed(&mut self, boxes: &Boxes, object: u32, old: &Aabb) {
        let _ = (object, old);
        *self = Self::build(boxes);
    }
    /// `object`'s box was `old`, and is a new one in `boxes`.
    fn relocated(&mut self, boxes: &Boxes, object: u32, old: &Aabb) {
        self.removed(boxes, object, old);
        self.inserted(boxes, object);
    }

    /// Visits each object whose box overlaps `region`, once, in any order.
    fn overlap(&self, boxes: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32));

    /// Visits objects that a sweep may meet by the time `limit`, the early ones
    /// first as far as that is cheap. `visit` returns the limit from then on.
    ///
    /// Every object that [`Cast::against`](crate::Cast::against) hits is visited,
    /// others may be, and some more than once.
    fn sweep(&self, boxes: &Boxes, sweep: &Sweep, limit: f32, visit: &mut impl FnMut(u32) -> f32);

    /// As [`sweep`](Structure::sweep) for several; `visit` is told which of them meets the object.
    fn sweep_many(
        &self,
        boxes: &Boxes,
        sweeps: &[Sweep],
        limits: &[f32],
        visit: &mut impl FnMut(usize, u32) -> f32,
    ) {
        for (i, (sweep, limit)) in sweeps.iter().zip(limits).enumerate() {
            self.sweep(boxes, sweep, *limit, &mut |object| visit(i, object));
        }
    }

    /// Visits objects whose box is not farther from `point` than √`limit`, near
    /// ones first as far as that is cheap. `visit` returns the limit from then on.
    ///
    /// Others may be visited, and some more than once.
    fn approach(&self, boxes: &Boxes, point: Vec3, limit: f32, visit: &mut impl FnMut(u32) -> f32);

    /// Appends all pairs that overlap, each once, in an order that depends on the boxes alone.
    fn pairs(&self, boxes: &Boxes, found: &mut Vec<Pair>) {
        pairs::gather(boxes.all().len(), 1024, found, |range, found| {
            for a in range.start as u32..range.end as u32 {
                let aabb = boxes.get(a);
                if aabb.is_bounded() {
                    self.overlap(boxes, aabb, &mut |b| {
                        if a < b {
                            found.push(Pair { a, b });
                        }
                    });
                }
            }
        });
    }

    /// Bytes it holds, boxes not included.
    fn memory(&self) -> usize;
}
