//! Uniform grid of cells, hashed.
//!
//! A box is listed in each cell that it touches; cells are buckets of a hash
//! table, so that space may be empty and without bounds (Teschner et al. 2003,
//! "Optimized spatial hashing for collision detection of deformable objects").
//! A pair that shares several cells is reported in one alone: the one that holds
//! the lower corner of its overlap.
//!
//! Cells are as large as most boxes. Boxes of many cells would be in all of
//! them; they are kept in a list that every query runs through, so a grid is for
//! objects of like size.
//!
//! | | cost |
//! |---|---|
//! | build, update | O(n + listings) |
//! | insert, remove, relocate | O(cells touched) |
//! | pairs | O(n · boxes in a cell) |
//! | cast | O(layers of cells on the way), at most O(n) |
//! | nearest | O(cells nearer than the answer), at most O(n) |
//! | memory | 44 bytes a listing (a box of the usual size has 1 to 8), and 4 to 8 for its bucket |

mod shell;
mod way;

use crate::cast::{SLACK, Sweep};
use crate::{Aabb, Boxes, Pair, Structure, pairs};
use glam::Vec3;
use shell::Shell;
use way::Way;

/// A box that touches more cells is large.
const MOST_CELLS: i64 = 27;
/// Cells beyond ±this are one with the last. The number of all fits 63 bits.
const LAST_CELL: i32 = (1 << 20) - 1;
const END: u32 = u32::MAX;

type Cell = [i32; 3];

/// An object in a cell.
#[derive(Clone, Copy, Debug)]
struct Listing {
    cell: Cell,
    object: u32,
    /// Inside out where the listing is free.
    aabb: Aabb,
    /// The next in the same bucket, or [`END`].
    next: u32,
}

/// A hashed grid; see [the module](self).
#[derive(Clone, Debug)]
pub struct Grid {
    /// Cells per metre.
    scale: f32,
    /// Per bucket, its first listing, or [`END`]. A power of two of them.
    first: Vec<u32>,
    listings: Vec<Listing>,
    free: Vec<u32>,
    /// Objects that touch too many cells, in order.
    large: Vec<u32>,
    /// All boxes in cells have been within.
    bounds: Aabb,
}

/// The edge of a cell [m]: twice the median box, if that does not leave space
/// all but empty: there shall be no more than 8³ cells an object.
fn cell_size(boxes: &Boxes) -> f32 {
    let mut sizes: Vec<f32> = boxes
        .bounded()
        .map(|(_, b)| b.extent().max_element())
        .collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let middle = sizes.len() / 2;
    let (_, median, _) = sizes.select_nth_unstable_by(middle, f32::total_cmp);
    let whole = boxes
        .bounded()
        .fold(Aabb::EMPTY, |all, (_, b)| all.union(b))
        .extent();
    let spacing = (whole / (boxes.count() as f32).cbrt()).max_element();
    (2.0 * *median)
        .max(spacing / 8.0)
        .max(f32::MIN_POSITIVE / f32::EPSILON)
}

impl Grid {
    fn empty(scale: f32, buckets: usize) -> Self {
        Self {
            scale,
            first: vec![END; buckets.next_power_of_two()],
            listings: Vec::new(),
            free: Vec::new(),
            large: Vec::new(),
            bounds: Aabb::EMPTY,
        }
    }

    /// The cell of a point. Monotone in each coordinate, whatever the rounding, and
    /// so a box touches just the cells from that of its lower to that of its upper corner.
    #[inline]
    fn cell(&self, point: Vec3) -> Cell {
        (point * self.scale)
            .floor()
            .to_array()
            .map(|x| (x as i32).clamp(-LAST_CELL, LAST_CELL))
    }

    #[inline]
    fn bucket(&self, [x, y, z]: Cell) -> usize {
        let mix = (x as u32).wrapping_mul(73_856_093)
            ^ (y as u32).wrapping_mul(19_349_663)
            ^ (z as u32).wrapping_mul(83_492_791);
        mix as usize & (self.first.len() - 1)
    }

    /// The cells that a box touches, or nothing if it is large.
    #[inline]
    fn touched(&self, aabb: &Aabb) -> Option<impl Iterator<Item = Cell> + use<>> {
        let (low, high) = (self.cell(aabb.min), self.cell(aabb.max));
        (count(low, high) <= MOST_CELLS).then(|| cells(low, high))
    }

    /// The one cell in which an overlap of two boxes is reported.
    #[inline]
    fn home(&self, a: &Aabb, b: &Aabb) -> Cell {
        self.cell(a.min.max(b.min))
    }

    /// Listings of a bucket.
    #[inline]
    fn chain(&self, first: u32) -> impl Iterator<Item = &Listing> {
        std::iter::successors(self.listings.get(first as usize), |l| {
            self.listings.get(l.next as usize)
        })
    }

    /// Listings of a cell.
    #[inline]
    fn in_cell(&self, cell: Cell) -> impl Iterator<Item = &Listing> {
        self.chain(self.first[self.bucket(cell)])
            .filter(move |l| l.cell == cell)
    }

    /// How many comparisons of boxes it takes to find all pairs.
    pub(crate) fn comparisons(&self) -> f32 {
        let length = |first: &u32| self.chain(*first).count() as f32;
        let in_buckets: f32 = self
            .first
            .iter()
            .map(|first| length(first) * length(first))
            .sum();
        in_buckets + self.large.len() as f32 * self.listings.len() as f32
    }

    /// All listings in use.
    fn all(&self) -> impl Iterator<Item = &Listing> {
        self.listings
            .iter()
            .filter(|l| l.aabb.min.x <= l.aabb.max.x)
    }

    /// Lists the objects, which are not large, in the order of buckets, so that neighbours lie together.
    fn list_all(&mut self, boxes: &Boxes, small: &[u32]) {
        let listing = |object: u32| {
            let aabb = *boxes.get(object);
            let cells = cells(self.cell(aabb.min), self.cell(aabb.max));
            cells.map(move |cell| Listing {
                cell,
                object,
                aabb,
                next: END,
            })
        };
        let all: Vec<Listing> = small.iter().flat_map(|i| listing(*i)).collect();
        self.first = vec![END; all.len().next_power_of_two().max(64)];
        let mut start = vec![0_u32; self.first.len() + 1];
        for listing in &all {
            start[self.bucket(listing.cell) + 1] += 1;
        }
        for i in 1..start.len() {
            start[i] += start[i - 1];
        }
        let mut end = start.clone();
        let nowhere = Listing {
            cell: [0; 3],
            object: 0,
            aabb: Aabb::EMPTY,
            next: END,
        };
        self.listings = vec![nowhere; all.len()];
        for mut listing in all {
            let bucket = self.bucket(listing.cell);
            let at = end[bucket];
            end[bucket] += 1;
            listing.next = if end[bucket] < start[bucket + 1] {
                at + 1
            } else {
                END
            };
            self.listings[at as usize] = listing;
        }
        for (first, range) in self.first.iter_mut().zip(start.windows(2)) {
            if range[0] < range[1] {
                *first = range[0];
            }
        }
    }

    /// Visits the cells from `low` to `high`, if they are fewer than the listings; else says no.
    fn visit_cells(&self, low: Cell, high: Cell, visit: &mut impl FnMut(&Listing)) -> bool {
        let few = count(low, high) <= self.listings.len() as i64;
        if few {
            cells(low, high).for_each(|cell| self.in_cell(cell).for_each(&mut *visit));
        }
        few
    }
}

/// Cells from corner to corner.
fn count(low: Cell, high: Cell) -> i64 {
    (0..3)
        .map(|axis| i64::from(high[axis] - low[axis]) + 1)
        .product()
}

fn cells(low: Cell, high: Cell) -> impl Iterator<Item = Cell> {
    let column = move |x, y| (low[2]..=high[2]).map(move |z| [x, y, z]);
    let plane = move |x| (low[1]..=high[1]).flat_map(move |y| column(x, y));
    (low[0]..=high[0]).flat_map(plane)
}

impl Structure for Grid {
    const NAME: &'static str = "grid";

    fn build(boxes: &Boxes) -> Self {
        let mut grid = Self::empty(1.0 / cell_size(boxes), 64);
        let is_small = |i: &u32| grid.touched(boxes.get(*i)).is_some();
        let (small, large): (Vec<u32>, Vec<u32>) =
            boxes.bounded().map(|(i, _)| i).partition(is_small);
        grid.bounds = small
            .iter()
            .fold(Aabb::EMPTY, |all, i| all.union(boxes.get(*i)));
        grid.large = large;
        grid.list_all(boxes, &small);
        grid
    }

    /// Builds anew when there are more objects than buckets, which also adapts the size of cells.
    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        let aabb = *boxes.get(object);
        if self.large.len() + self.listings.len() > 2 * self.first.len() {
            *self = Self::build(boxes);
            return;
        }
        let Some(cells) = self.touched(&aabb) else {
            let place = self.large.partition_point(|i| *i < object);
            return self.large.insert(place, object);
        };
        self.bounds = self.bounds.union(&aabb);
        for cell in cells {
            let bucket = self.bucket(cell);
            let listing = Listing {
                cell,
                object,
                aabb,
                next: self.first[bucket],
            };
            self.first[bucket] = match self.free.pop() {
                Some(at) => {
                    self.listings[at as usize] = listing;
                    at
                }
                None => {
                    self.listings.push(listing);
                    self.listings.len() as u32 - 1
                }
            };
        }
    }

    fn removed(&mut self, _: &Boxes, object: u32, old: &Aabb) {
        let Some(cells) = self.touched(old) else {
            return self.large.retain(|i| *i != object);
        };
        for cell in cells {
            let bucket = self.bucket(cell);
            let (mut before, mut at) = (None, self.first[bucket]);
            while (
                self.listings[at as usize].object,
                self.listings[at as usize].cell,
            ) != (object, cell)
            {
                before = Some(at);
                at = self.listings[at as usize].next;
            }
            let next = self.listings[at as usize].next;
            match before {
                Some(before) => self.listings[before as usize].next = next,
                None => self.first[bucket] = next,
            }
            self.listings[at as usize].aabb = Aabb::EMPTY;
            self.free.push(at);
        }
    }

    fn overlap(&self, boxes: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let mut meet = |l: &Listing| {
            if l.aabb.overlaps(region) && self.home(&l.aabb, region) == l.cell {
                visit(l.object);
            }
        };
        if !self.visit_cells(self.cell(region.min), self.cell(region.max), &mut meet) {
            self.all().for_each(meet);
        }
        let large = self.large.iter().copied();
        large
            .filter(|i| boxes.get(*i).overlaps(region))
            .for_each(visit);
    }

    /// Walks layer by layer along the axis of the fastest motion; in each, the
    /// cells that the sweep covers while it is in the layer.
    fn sweep(
        &self,
        boxes: &Boxes,
        sweep: &Sweep,
        mut limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
    ) {
        for &i in &self.large {
            if sweep.enters(boxes.get(i), limit).is_some() {
                limit = visit(i);
            }
        }
        let Some(way) = Way::new(self, sweep, limit) else {
            return;
        };
        let mut meet = |l: &Listing, limit: &mut f32| {
            if sweep.enters(&l.aabb, *limit).is_some() {
                *limit = visit(l.object);
            }
        };
        if way.layers() > self.listings.len() as i64 {
            return self.all().for_each(|l| meet(l, &mut limit));
        }
        for i in 0..way.layers() {
            let Some((low, high)) = way.covered(self, i, limit) else {
                break;
            };
            if !self.visit_cells(low, high, &mut |l| meet(l, &mut limit)) {
                return self.all().for_each(|l| meet(l, &mut limit));
            }
        }
    }

    /// Walks outwards in shells of cells about the point's.
    fn approach(
        &self,
        boxes: &Boxes,
        point: Vec3,
        mut limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
    ) {
        for &i in &self.large {
            if boxes.get(i).distance_squared(point) <= limit * SLACK {
                limit = visit(i);
            }
        }
        let mut meet = |l: &Listing, limit: &mut f32| {
            if l.aabb.distance_squared(point) <= *limit * SLACK {
                *limit = visit(l.object);
            }
        };
        let center = self.cell(point);
        let (low, high) = (self.cell(self.bounds.min), self.cell(self.bounds.max));
        let apart = |axis: usize| {
            (low[axis] - center[axis])
                .max(center[axis] - high[axis])
                .max(0)
        };
        let across = |axis: usize| (center[axis] - low[axis]).max(high[axis] - center[axis]);
        let (nearest, farthest) = ((0..3).map(apart).max(), (0..3).map(across).max());
        let mut work = 2 * self.listings.len() as i64;
        for radius in nearest.unwrap_or(0)..=farthest.unwrap_or(0) {
            // A cell less, and a little more, for where in its cell the point is.
            let gap = (radius as f32 * 0.999 - 1.0).max(0.0) / self.scale;
            if gap * gap > limit * SLACK {
                return;
            }
            let shell = Shell::new(center, radius, low, high);
            work -= shell.work();
            if work < 0 {
                return self.all().for_each(|l| meet(l, &mut limit));
            }
            shell.visit(|cell| self.in_cell(cell).for_each(|l| meet(l, &mut limit)));
        }
    }

    fn pairs(&self, boxes: &Boxes, found: &mut Vec<Pair>) {
        pairs::gather(self.first.len(), 4096, found, |buckets, found| {
            for &first in &self.first[buckets] {
                for a in self.chain(first) {
                    for b in self.chain(a.next).filter(|b| b.cell == a.cell) {
                        if a.aabb.overlaps(&b.aabb) && self.home(&a.aabb, &b.aabb) == a.cell {
                            found.push(Pair::new(a.object, b.object));
                        }
                    }
                }
            }
        });
        for &a in &self.large {
            let aabb = boxes.get(a);
            let others = boxes
                .bounded()
                .filter(|(_, b)| b.overlaps(aabb))
                .map(|(b, _)| b);
            let once = others.filter(|b| a < *b || self.large.binary_search(b).is_err());
            found.extend(once.map(|b| Pair::new(a, b)));
        }
    }

    fn memory(&self) -> usize {
        size_of_val(&self.listings[..])
            + 4 * (self.first.len() + self.free.len() + self.large.len())
    }
}
