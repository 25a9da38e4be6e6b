//! Sweep and prune along one axis.
//!
//! Boxes are kept in order of their lower ends along the axis on which they are
//! spread the most, and only those whose intervals overlap there are compared
//! (Baraff 1992, "Dynamic simulation of non-penetrating rigid bodies", section
//! 2.5). Motion between steps is small, so that an insertion sort mends the order.
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n) |
//! | update | O(n + exchanges of neighbours); sorted anew when these are many |
//! | insert, remove, relocate | O(n), a move of memory |
//! | pairs | O(n · m), with m boxes beside a box along the axis: about n^⅔ if spread evenly in space |
//! | query | O(log n + boxes beside the region, or the way, along the axis) |
//! | memory | 32 bytes an object |

use crate::cast::{SLACK, Sweep};
use crate::{Aabb, Boxes, Pair, Structure, pairs};
use glam::Vec3;
use std::cmp::Ordering;

/// An object's box in permuted axes: the one swept along comes first.
#[derive(Clone, Copy, Debug)]
struct Entry {
    aabb: Aabb,
    object: u32,
}

impl Entry {
    /// Lower end first, then index.
    fn order(&self, other: &Self) -> Ordering {
        let ends = self.aabb.min.x.partial_cmp(&other.aabb.min.x);
        ends.unwrap_or(Ordering::Equal)
            .then(self.object.cmp(&other.object))
    }
}

/// Sweep and prune; see [the module](self).
#[derive(Clone, Debug)]
pub struct SweepAndPrune {
    axis: usize,
    /// In order of lower ends.
    entries: Vec<Entry>,
    /// Per entry, the highest upper end of all up to it.
    reach: Vec<f32>,
}

/// An axis is given up for one with more than this times its variance.
const WORTH_TURNING: f32 = 2.0;
/// An update that exchanges more neighbours than this per object sorts anew.
const PATIENCE: usize = 16;

impl SweepAndPrune {
    /// Turns the axes so that the one swept along is x.
    #[inline]
    fn turn(&self, v: Vec3) -> Vec3 {
        match self.axis {
            0 => v,
            1 => Vec3::new(v.y, v.z, v.x),
            _ => Vec3::new(v.z, v.x, v.y),
        }
    }

    fn turn_box(&self, b: &Aabb) -> Aabb {
        Aabb::new(self.turn(b.min), self.turn(b.max))
    }

    fn entry(&self, boxes: &Boxes, object: u32) -> Entry {
        Entry {
            aabb: self.turn_box(boxes.get(object)),
            object,
        }
    }

    fn find_reach(&mut self, from: usize) {
        self.reach.truncate(from);
        let mut most = self.reach.last().copied().unwrap_or(f32::NEG_INFINITY);
        for entry in &self.entries[from..] {
            most = most.max(entry.aabb.max.x);
            self.reach.push(most);
        }
    }

    /// The first entry that, or one before it, reaches up to `x`.
    #[inline]
    fn first_reaching(&self, x: f32) -> usize {
        self.reach.partition_point(|reach| *reach < x)
    }

    /// Insertion sort; false if it gave up.
    fn mend_order(&mut self) -> bool {
        let mut exchanges = PATIENCE * self.entries.len();
        for i in 1..self.entries.len() {
            let entry = self.entries[i];
            let mut j = i;
            while j > 0 && entry.order(&self.entries[j - 1]).is_lt() {
                self.entries[j] = self.entries[j - 1];
                j -= 1;
            }
            self.entries[j] = entry;
            if exchanges < i - j {
                return false;
            }
            exchanges -= i - j;
        }
        true
    }
}

/// Variance of the centres along each axis.
fn variance(boxes: &Boxes) -> Vec3 {
    let (mut sum, mut squares, mut n) = (glam::DVec3::ZERO, glam::DVec3::ZERO, 0.0_f64);
    for (_, aabb) in boxes.bounded() {
        let center = aabb.center().as_dvec3();
        (sum, squares, n) = (sum + center, squares + center * center, n + 1.0);
    }
    let mean = sum / n.max(1.0);
    (squares / n.max(1.0) - mean * mean).as_vec3()
}

impl Structure for SweepAndPrune {
    const NAME: &'static str = "sweep_and_prune";

    fn build(boxes: &Boxes) -> Self {
        let axis = variance(boxes).max_position();
        let mut sweep = Self {
            axis,
            entries: Vec::new(),
            reach: Vec::new(),
        };
        sweep.entries = boxes
            .bounded()
            .map(|(i, _)| sweep.entry(boxes, i))
            .collect();
        sweep.entries.sort_unstable_by(Entry::order);
        sweep.find_reach(0);
        sweep
    }

    fn refresh(&mut self, boxes: &Boxes) {
        let variance = variance(boxes);
        if variance.max_element() > WORTH_TURNING * variance[self.axis] {
            *self = Self::build(boxes);
            return;
        }
        for i in 0..self.entries.len() {
            self.entries[i] = self.entry(boxes, self.entries[i].object);
        }
        if !self.mend_order() {
            self.entries.sort_unstable_by(Entry::order);
        }
        self.find_reach(0);
    }

    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        let entry = self.entry(boxes, object);
        let place = self.entries.partition_point(|e| e.order(&entry).is_lt());
        self.entries.insert(place, entry);
        self.find_reach(place);
    }

    fn removed(&mut self, _: &Boxes, object: u32, old: &Aabb) {
        let entry = Entry {
            aabb: self.turn_box(old),
            object,
        };
        let place = self.entries.partition_point(|e| e.order(&entry).is_lt());
        self.entries.remove(place);
        self.find_reach(place);
    }

    fn overlap(&self, _: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let region = self.turn_box(region);
        for entry in &self.entries[self.first_reaching(region.min.x)..] {
            if entry.aabb.min.x > region.max.x {
                break;
            }
            if entry.aabb.overlaps(&region) {
                visit(entry.object);
            }
        }
    }

    /// Walks the way of the sweep, to where it is too late.
    fn sweep(&self, _: &Boxes, sweep: &Sweep, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let (upper, lower) = (self.turn(sweep.upper), self.turn(sweep.lower));
        let sweep = Sweep {
            upper,
            lower,
            inverse: self.turn(sweep.inverse),
        };
        let mut meet = |entry: &Entry, limit: &mut f32| {
            if sweep.enters(&entry.aabb, *limit).is_some() {
                *limit = visit(entry.object);
            }
        };
        if sweep.inverse.x > 0.0 {
            for entry in &self.entries[self.first_reaching(lower.x)..] {
                if (entry.aabb.min.x - upper.x) * sweep.inverse.x > limit * SLACK {
                    break;
                }
                meet(entry, &mut limit);
            }
        } else {
            let start = self.entries.partition_point(|e| e.aabb.min.x <= upper.x);
            for i in (0..start).rev() {
                if (self.reach[i] - lower.x) * sweep.inverse.x > limit * SLACK {
                    break;
                }
                meet(&self.entries[i], &mut limit);
            }
        }
    }

    /// Walks up and down from the point in turns, to where it is too far.
    fn approach(&self, _: &Boxes, point: Vec3, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let point = self.turn(point);
        let start = self.entries.partition_point(|e| e.aabb.min.x <= point.x);
        let (mut up, mut down) = (start, start);
        loop {
            let gap = |x: f32| x.max(0.0) * x.max(0.0);
            let above = self
                .entries
                .get(up)
                .filter(|e| gap(e.aabb.min.x - point.x) <= limit * SLACK);
            let below = down
                .checked_sub(1)
                .filter(|i| gap(point.x - self.reach[*i]) <= limit * SLACK);
            for entry in above.into_iter().chain(below.map(|i| &self.entries[i])) {
                if entry.aabb.distance_squared(point) <= limit * SLACK {
                    limit = visit(entry.object);
                }
            }
            up = if above.is_some() {
                up + 1
            } else {
                self.entries.len()
            };
            down = below.unwrap_or(0);
            if above.is_none() && below.is_none() {
                break;
            }
        }
    }

    fn pairs(&self, _: &Boxes, found: &mut Vec<Pair>) {
        pairs::gather(self.entries.len(), 512, found, |range, found| {
            for i in range {
                let entry = &self.entries[i];
                for other in &self.entries[i + 1..] {
                    if other.aabb.min.x > entry.aabb.max.x {
                        break;
                    }
                    if entry.aabb.overlaps(&other.aabb) {
                        found.push(Pair::new(entry.object, other.object));
                    }
                }
            }
        });
    }

    fn memory(&self) -> usize {
        size_of_val(&self.entries[..]) + size_of_val(&self.reach[..])
    }
}
