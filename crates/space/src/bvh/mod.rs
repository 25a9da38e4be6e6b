//! Dynamic bounding-volume hierarchy, four children a node.
//!
//! A node holds the boxes of its four children side by side, so that one query
//! meets all four with one register per plane (Wald, Benthin, Boulos 2008,
//! "Getting rid of packets"). Each object is a child somewhere.
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n): binned surface-area heuristic, in threads |
//! | update | O(n) refit; a rebuild when the heuristic's cost has grown by half |
//! | insert, remove, relocate | O(depth) |
//! | query | O(log n + answers) for boxes that overlap little |
//! | memory | about 70 bytes an object |

mod build;
mod edit;
mod packet;
mod pairs;
mod refit;
mod traverse;

use crate::cast::Sweep;
use crate::{Aabb, Boxes, Pair, Structure};
use glam::{Vec3, Vec4};
use numbers::dispatch::Isa;

/// Marks a child that is an object.
const OBJECT: u32 = 1 << 31;
/// Marks a child that is not there.
const NONE: u32 = u32::MAX;
/// Where an object lies that is not in the tree, and the root's parent.
const NOWHERE: u32 = u32::MAX;

/// Four children and their boxes. One that is not there has an inside-out box,
/// which no query meets.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Node {
    /// Lower planes: x, y, z of each child.
    low: [Vec4; 3],
    /// Upper planes.
    high: [Vec4; 3],
    /// [`NONE`], an object with [`OBJECT`], or a node.
    child: [u32; 4],
    /// `4 · node + slot` of the slot this node hangs from; [`NOWHERE`] for the root.
    parent: u32,
    /// Objects below.
    objects: u32,
}

impl Node {
    const EMPTY: Self = Self {
        low: [Vec4::INFINITY; 3],
        high: [Vec4::NEG_INFINITY; 3],
        child: [NONE; 4],
        parent: NOWHERE,
        objects: 0,
    };

    fn set(&mut self, slot: usize, child: u32, aabb: &Aabb) {
        self.child[slot] = child;
        self.set_box(slot, aabb);
    }

    fn set_box(&mut self, slot: usize, aabb: &Aabb) {
        for axis in 0..3 {
            self.low[axis][slot] = aabb.min[axis];
            self.high[axis][slot] = aabb.max[axis];
        }
    }

    fn child_box(&self, slot: usize) -> Aabb {
        Aabb::new(
            Vec3::new(self.low[0][slot], self.low[1][slot], self.low[2][slot]),
            Vec3::new(self.high[0][slot], self.high[1][slot], self.high[2][slot]),
        )
    }

    /// The box about all children.
    fn bounds(&self) -> Aabb {
        Aabb::new(
            Vec3::from_array(self.low.map(|planes| planes.min_element())),
            Vec3::from_array(self.high.map(|planes| planes.max_element())),
        )
    }

    /// One bit per child whose box overlaps `region`.
    #[inline(always)]
    fn overlapping(&self, region: &Aabb) -> u32 {
        let mut mask = self.low[0].cmple(Vec4::splat(region.max.x));
        mask &= self.high[0].cmpge(Vec4::splat(region.min.x));
        mask &= self.low[1].cmple(Vec4::splat(region.max.y));
        mask &= self.high[1].cmpge(Vec4::splat(region.min.y));
        mask &= self.low[2].cmple(Vec4::splat(region.max.z));
        mask &= self.high[2].cmpge(Vec4::splat(region.min.z));
        mask.bitmask()
    }
}

/// A dynamic bounding-volume hierarchy; see [the module](self).
#[derive(Clone, Debug)]
pub struct Bvh {
    /// The root is first.
    nodes: Vec<Node>,
    /// Nodes no longer in use.
    free: Vec<u32>,
    /// Nodes in use, each after its parent; empty when edits have changed it.
    order: Vec<u32>,
    /// Per object, `4 · node + slot`, or [`NOWHERE`].
    place: Vec<u32>,
    /// Sum of all nodes' areas when built, to judge refits by.
    built_area: f32,
    /// For packets of sweeps.
    isa: Isa,
}

impl Structure for Bvh {
    const NAME: &'static str = "bvh";

    fn build(boxes: &Boxes) -> Self {
        build::build(boxes)
    }
    fn refresh(&mut self, boxes: &Boxes) {
        self.refit(boxes);
    }
    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        self.insert(object, boxes.get(object));
    }
    fn removed(&mut self, _: &Boxes, object: u32, _: &Aabb) {
        self.remove(object);
    }
    fn relocated(&mut self, boxes: &Boxes, object: u32, _: &Aabb) {
        self.relocate(object, boxes.get(object));
    }
    fn overlap(&self, _: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        self.visit_overlapping(0, region, visit);
    }
    fn sweep(&self, _: &Boxes, sweep: &Sweep, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        self.visit_swept(sweep, limit, visit);
    }
    fn sweep_many(
        &self,
        _: &Boxes,
        sweeps: &[Sweep],
        limits: &[f32],
        visit: &mut impl FnMut(usize, u32) -> f32,
    ) {
        self.visit_many_swept(sweeps, limits, visit);
    }
    fn approach(&self, _: &Boxes, point: Vec3, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        self.visit_near(point, limit, visit);
    }
    fn pairs(&self, _: &Boxes, found: &mut Vec<Pair>) {
        self.find_pairs(found);
    }
    fn memory(&self) -> usize {
        size_of_val(&self.nodes[..]) + 4 * (self.free.len() + self.order.len() + self.place.len())
    }
}
