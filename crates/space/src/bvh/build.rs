//! From scratch: top-down, by the binned surface-area heuristic.
//!
//! Splitting a set S into L and R costs, up to constants, A(L)·|L| + A(R)·|R|
//! with the boxes' areas A, since A(L)/A(S) is the chance that a line through
//! S's box meets L's (MacDonald and Booth 1990). The best of 16 planes along
//! each axis is taken (Wald 2007, "On fast construction of SAH-based bounding
//! volume hierarchies"). Of a node's parts the one with the largest area is
//! split again until there are four.

use super::{Bvh, NOWHERE, Node, OBJECT};
use crate::Aabb;
use crate::Boxes;
use glam::Vec3A;
use numbers::dispatch::Isa;
use rayon::prelude::*;

const BINS: usize = 16;
/// Sets larger than this are built by several threads.
const PARALLEL: usize = 8192;

#[derive(Clone, Copy, Debug)]
struct Extent {
    min: Vec3A,
    max: Vec3A,
}

impl Extent {
    const EMPTY: Self = Self {
        min: Vec3A::INFINITY,
        max: Vec3A::NEG_INFINITY,
    };

    #[inline(always)]
    fn union(self, other: Self) -> Self {
        Self {
            min: self.min.min(other.min),
            max: self.max.max(other.max),
        }
    }
    #[inline(always)]
    fn include(&mut self, point: Vec3A) {
        *self = self.union(Self {
            min: point,
            max: point,
        });
    }
    #[inline(always)]
    fn half_area(self) -> f32 {
        let e = (self.max - self.min).max(Vec3A::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }
    fn aabb(self) -> Aabb {
        Aabb::new(self.min.into(), self.max.into())
    }
}

/// An object to be placed.
#[derive(Clone, Copy, Debug)]
struct Item {
    extent: Extent,
    object: u32,
}

impl Item {
    /// Twice the centre.
    #[inline(always)]
    fn center(&self) -> Vec3A {
        self.extent.min + self.extent.max
    }
}

/// Neighbouring items, and the box about them.
struct Part<'a> {
    items: &'a mut [Item],
    extent: Extent,
}

pub(super) fn build(boxes: &Boxes) -> Bvh {
    let mut items: Vec<Item> = boxes
        .bounded()
        .map(|(object, b)| Item {
            extent: Extent {
                min: b.min.into(),
                max: b.max.into(),
            },
            object,
        })
        .collect();
    let extent = items.iter().fold(Extent::EMPTY, |e, i| e.union(i.extent));
    let mut nodes = Vec::with_capacity(items.len() / 2 + 1);
    subtree(
        &mut Part {
            items: &mut items,
            extent,
        },
        &mut nodes,
    );
    let mut bvh = Bvh {
        order: (0..nodes.len() as u32).collect(),
        nodes,
        free: Vec::new(),
        place: vec![NOWHERE; boxes.all().len()],
        built_area: 0.0,
        isa: Isa::detect(),
    };
    bvh.connect();
    bvh.built_area = bvh.inner_area();
    bvh
}

impl Bvh {
    /// Tells nodes their parents, and objects their places.
    fn connect(&mut self) {
        for i in 0..self.nodes.len() {
            for slot in 0..4 {
                let child = self.nodes[i].child[slot];
                self.attach((4 * i + slot) as u32, child);
            }
        }
    }
}

/// Appends the tree over a part to `nodes`, its root first.
fn subtree(part: &mut Part, nodes: &mut Vec<Node>) {
    let root = nodes.len();
    let mut node = Node {
        objects: part.items.len() as u32,
        ..Node::EMPTY
    };
    nodes.push(node);
    let parallel = part.items.len() > PARALLEL;
    let mut parts = quarters(part);
    let mut trees: [Vec<Node>; 4] = Default::default();
    if parallel {
        parts
            .par_iter_mut()
            .zip(&mut trees)
            .for_each(|(part, tree)| {
                if let Some(part) = part.as_mut().filter(|p| p.items.len() > 1) {
                    subtree(part, tree);
                }
            });
    }
    for (slot, part) in parts.iter_mut().flatten().enumerate() {
        let aabb = part.extent.aabb();
        if let [item] = part.items {
            node.set(slot, item.object | OBJECT, &aabb);
            continue;
        }
        let start = nodes.len() as u32;
        node.set(slot, start, &aabb);
        if parallel {
            nodes.extend(trees[slot].iter().map(|n| n.shifted(start)));
        } else {
            subtree(part, nodes);
        }
    }
    nodes[root] = node;
}

impl Node {
    /// The same where nodes start at `start`.
    fn shifted(mut self, start: u32) -> Self {
        for child in self.child.iter_mut().filter(|c| **c & OBJECT == 0) {
            *child += start;
        }
        self
    }
}

/// Splits a part in up to four, of at least one item each; the first ones are taken.
fn quarters<'a>(part: &'a mut Part) -> [Option<Part<'a>>; 4] {
    let whole = Part {
        items: &mut part.items[..],
        extent: part.extent,
    };
    let mut parts = [Some(whole), None, None, None];
    if parts[0].as_ref().is_some_and(|p| p.items.is_empty()) {
        return [None, None, None, None];
    }
    for count in 1..4 {
        let mut widest = None;
        let mut most = -1.0;
        for (i, part) in parts.iter().enumerate() {
            if let Some(part) = part
                && part.items.len() > 1
                && part.extent.half_area() > most
            {
                most = part.extent.half_area();
                widest = Some(i);
            }
        }
        let Some(i) = widest else { break };
        let Some(part) = parts[i].take() else { break };
        let (left, right) = split(part);
        parts[i] = Some(left);
        parts[count] = Some(right);
    }
    parts
}

/// Splits at the plane of the least cost, or in the middle where all centres coincide.
fn split(part: Part) -> (Part, Part) {
    let items = part.items;
    let mut centers = Extent::EMPTY;
    for item in items.iter() {
        centers.include(item.center());
    }
    let bins = items.len().clamp(4, BINS);
    let scale = Vec3A::splat((bins - 1) as f32) / (centers.max - centers.min);
    let scale = Vec3A::select(centers.max.cmpgt(centers.min), scale, Vec3A::ZERO);
    // Rounds to a whole number, which then is the lowest bits.
    const ROUND: Vec3A = Vec3A::splat((1 << 23) as f32);
    let bin = |item: &Item| {
        let whole = (item.center() - centers.min) * scale + ROUND;
        whole.to_array().map(|x| x.to_bits() as usize & (BINS - 1))
    };

    let mut filled = [[(Extent::EMPTY, 0_u32); BINS]; 3];
    for item in items.iter() {
        for (axis, i) in bin(item).into_iter().enumerate() {
            let (extent, count) = &mut filled[axis][i];
            *extent = extent.union(item.extent);
            *count += 1;
        }
    }
    let best = filled
        .iter()
        .enumerate()
        .filter_map(|(axis, f)| best_plane(&f[..bins]).map(|(cost, i)| (cost, axis, i)));
    let best = best.min_by(|x, y| x.0.total_cmp(&y.0));
    let middle = match best {
        Some((_, axis, plane)) => partition(items, |item| bin(item)[axis] < plane),
        None => items.len() / 2,
    };
    let (left, right) = items.split_at_mut(middle);
    (Part::about(left), Part::about(right))
}

impl<'a> Part<'a> {
    fn about(items: &'a mut [Item]) -> Self {
        let extent = items.iter().fold(Extent::EMPTY, |e, i| e.union(i.extent));
        Self { items, extent }
    }
}

/// Cost of the best plane, and the first bin to its right; nothing if all items lie in one bin.
fn best_plane(bins: &[(Extent, u32)]) -> Option<(f32, usize)> {
    let mut from_right = [(0.0_f32, 0_u32); BINS];
    let (mut extent, mut count) = (Extent::EMPTY, 0);
    for i in (1..bins.len()).rev() {
        extent = extent.union(bins[i].0);
        count += bins[i].1;
        from_right[i] = (extent.half_area() * count as f32, count);
    }
    let (mut extent, mut count) = (Extent::EMPTY, 0);
    let mut best = None;
    for i in 1..bins.len() {
        extent = extent.union(bins[i - 1].0);
        count += bins[i - 1].1;
        let (right, count_right) = from_right[i];
        let cost = extent.half_area() * count as f32 + right;
        if count > 0 && count_right > 0 && best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, i));
        }
    }
    best
}

/// Brings the items that are left to the front; returns how many they are.
fn partition(items: &mut [Item], is_left: impl Fn(&Item) -> bool) -> usize {
    let mut left = 0;
    for i in 0..items.len() {
        if is_left(&items[i]) {
            items.swap(left, i);
            left += 1;
        }
    }
    left
}
