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
//! | cast | O(layers of cells on the way) |
//! | nearest | O(cells nearer than the answer) |
//! | memory | 44 bytes a listing (a box of cell size has 1 to 8), and 4 bytes a bucket |

use crate::cast::{SLACK, Sweep};
use crate::{Aabb, Boxes, Pair, Structure, pairs};
use glam::{IVec3, Vec3};

/// A box that spans more cells than this along an axis is large.
const MOST_CELLS: i32 = 4;
/// Cells beyond ±this are one with the last: 20 bits an axis make a key.
const FARTHEST_CELL: f32 = 500_000.0;
const END: u32 = u32::MAX;

/// An object in a cell.
#[derive(Clone, Copy, Debug)]
struct Listing {
    cell: IVec3,
    object: u32,
    aabb: Aabb,
    /// The next in the same bucket.
    next: u32,
}

/// A hashed grid; see the module's text.
#[derive(Clone, Debug)]
pub struct Grid {
    /// Cells per metre.
    scale: f32,
    /// Per bucket, its first listing.
    first: Vec<u32>,
    listings: Vec<Listing>,
    free: Vec<u32>,
    /// Objects that span too many cells, in no order.
    large: Vec<u32>,
    /// The cells in use lie within.
    lowest: IVec3,
    highest: IVec3,
    /// Objects in cells.
    small: usize,
}
