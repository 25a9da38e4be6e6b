//! Binary space partition by planes of any direction; for scenes that rest.
//!
//! Space is halved by planes again and again (Fuchs, Kedem, Naylor 1980, "On
//! visible surface generation by a priori tree structures"). Here a plane lies
//! at the median of the centres along their principal axis, the direction of
//! their largest variance, so that rows and walls aslant to the axes are cut
//! across. Nothing is split: as in the k-d tree beside, each half keeps a plane
//! of its own, up to which its boxes reach.
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n), about twice a k-d tree's |
//! | update, insert, remove, relocate | as build |
//! | query | O(log n + answers) for boxes that overlap little |
//! | memory | about 42 bytes an object |

use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use crate::{Aabb, Boxes, Structure};
use glam::Vec3;

/// Objects in a leaf, at most.
const LEAF: usize = 4;
/// Covers the rounding of a box's extent along a direction, as a share of the terms.
const ROUNDING: f32 = 1e-6;

#[derive(Clone, Copy, Debug)]
enum Node {
    Leaf {
        first: u32,
        end: u32,
    },
    /// The left half follows.
    Split {
        /// Of unit length.
        normal: Vec3,
        left_max: f32,
        right_min: f32,
        right: u32,
    },
}

#[derive(Clone, Copy, Debug)]
struct Item {
    aabb: Aabb,
    object: u32,
}

/// A binary space partition; see the module's text.
#[derive(Clone, Debug)]
pub struct Bsp {
    nodes: Vec<Node>,
    /// Leaf by leaf.
    items: Vec<Item>,
}

/// The interval that a box covers along a direction, rounded outwards.
fn shadow(aabb: &Aabb, normal: Vec3) -> (f32, f32) {
    let (center, half) = (aabb.center(), 0.5 * aabb.extent());
    let middle = center.dot(normal);
    let reach = half.dot(normal.abs());
    let reach = reach + ROUNDING * (center.abs().dot(normal.abs()) + reach);
    (middle - reach, middle + reach)
}

/// The direction of the largest variance of the centres, by power iteration.
fn principal_axis(items: &[Item]) -> Vec3 {
    let scale = 1.0 / items.len() as f32;
    let mean = items
        .iter()
        .fold(Vec3::ZERO, |sum, i| sum + scale * i.aabb.center());
    let mut covariance = [Vec3::ZERO; 3];
    for item in items {
        let off = item.aabb.center() - mean;
        for axis in 0..3 {
            covariance[axis] += scale * off[axis] * off;
        }
    }
    let diagonal = Vec3::from_array(std::array::from_fn(|i| covariance[i][i]));
    let mut axis = covariance[diagonal.max_position()].normalize_or(Vec3::X);
    for _ in 0..8 {
        let next = Vec3::from_array(covariance.map(|row| row.dot(axis)));
        axis = next.normalize_or(axis);
    }
    axis
}

/// Appends the tree over `items`, the first of which is `first` of all.
fn grow(items: &mut [Item], first: u32, nodes: &mut Vec<Node>) {
    let at = nodes.len();
    nodes.push(Node::Leaf {
        first,
        end: first + items.len() as u32,
    });
    if items.len() <= LEAF {
        return;
    }
    let normal = principal_axis(items);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |x, y| {
        let (a, b) = (x.aabb.center().dot(normal), y.aabb.center().dot(normal));
        a.total_cmp(&b).then(x.object.cmp(&y.object))
    });
    let (left, right) = items.split_at_mut(middle);
    let left_max = left
        .iter()
        .fold(f32::NEG_INFINITY, |m, i| m.max(shadow(&i.aabb, normal).1));
    let right_min = right
        .iter()
        .fold(f32::INFINITY, |m, i| m.min(shadow(&i.aabb, normal).0));
    grow(left, first, nodes);
    nodes[at] = Node::Split {
        normal,
        left_max,
        right_min,
        right: nodes.len() as u32,
    };
    grow(right, first + middle as u32, nodes);
}

/// What is left of the times `enter..leave` where `start + slope · t ≤ bound`.
fn below(bound: f32, start: f32, slope: f32, (enter, leave): (f32, f32)) -> (f32, f32) {
    let time = (bound - start) / slope;
    if slope > 0.0 {
        (enter, leave.min(time))
    } else if slope < 0.0 {
        (enter.max(time), leave)
    } else if start <= bound {
        (enter, leave)
    } else {
        (f32::INFINITY, leave)
    }
}

impl Bsp {
    fn leaf(&self, first: u32, end: u32) -> &[Item] {
        &self.items[first as usize..end as usize]
    }
}

impl Structure for Bsp {
    const NAME: &'static str = "bsp";

    fn build(boxes: &Boxes) -> Self {
        let mut items: Vec<Item> = boxes
            .bounded()
            .map(|(object, b)| Item { aabb: *b, object })
            .collect();
        let mut nodes = Vec::with_capacity(items.len());
        grow(&mut items, 0, &mut nodes);
        Self { nodes, items }
    }

    fn overlap(&self, _: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let mut stack = Stack::<u32, 64>::with(0);
        while let Some(at) = stack.pop() {
            match self.nodes[at as usize] {
                Node::Leaf { first, end } => {
                    let met = self
                        .leaf(first, end)
                        .iter()
                        .filter(|i| i.aabb.overlaps(region));
                    met.for_each(|i| visit(i.object));
                }
                Node::Split {
                    normal,
                    left_max,
                    right_min,
                    right,
                } => {
                    let (low, high) = shadow(region, normal);
                    if high >= right_min {
                        stack.push(right);
                    }
                    if low <= left_max {
                        stack.push(at + 1);
                    }
                }
            }
        }
    }

    /// Carries the times between which the sweep is in the node. Speeds along a
    /// normal are rounded so that it comes in earlier and goes out later.
    fn sweep(&self, _: &Boxes, sweep: &Sweep, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let direction = sweep.direction();
        let start = Aabb::new(sweep.lower, sweep.upper);
        let mut stack = Stack::<(u32, f32, f32), 64>::with((0, 0.0, f32::MAX));
        while let Some((at, enter, leave)) = stack.pop() {
            if enter > leave.min(limit) * SLACK {
                continue;
            }
            match self.nodes[at as usize] {
                Node::Leaf { first, end } => {
                    for item in self.leaf(first, end) {
                        if sweep.enters(&item.aabb, limit).is_some() {
                            limit = visit(item.object);
                        }
                    }
                }
                Node::Split {
                    normal,
                    left_max,
                    right_min,
                    right,
                } => {
                    let (low, high) = shadow(&start, normal);
                    let speed = direction.dot(normal);
                    let error = ROUNDING * direction.abs().dot(normal.abs());
                    let of_left = below(left_max, low, speed - error, (enter, leave));
                    let of_right = below(-right_min, -high, -speed - error, (enter, leave));
                    let left = (at + 1, of_left.0, of_left.1);
                    let right = (right, of_right.0, of_right.1);
                    let (near, far) = if speed > 0.0 {
                        (left, right)
                    } else {
                        (right, left)
                    };
                    stack.push(far);
                    stack.push(near);
                }
            }
        }
    }

    /// Carries the widest gap between the point and a plane about the node.
    fn approach(&self, _: &Boxes, point: Vec3, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let here = Aabb::new(point, point);
        let mut stack = Stack::<(u32, f32), 64>::with((0, 0.0));
        while let Some((at, gap)) = stack.pop() {
            if gap * gap > limit * SLACK {
                continue;
            }
            match self.nodes[at as usize] {
                Node::Leaf { first, end } => {
                    for item in self.leaf(first, end) {
                        if item.aabb.distance_squared(point) <= limit * SLACK {
                            limit = visit(item.object);
                        }
                    }
                }
                Node::Split {
                    normal,
                    left_max,
                    right_min,
                    right,
                } => {
                    let (low, high) = shadow(&here, normal);
                    // The normal is of unit length but for rounding.
                    let shorter = 1.0 - ROUNDING;
                    let left = (at + 1, gap.max(shorter * (low - left_max)));
                    let right = (right, gap.max(shorter * (right_min - high)));
                    let left_first = low + high < left_max + right_min;
                    let (near, far) = if left_first {
                        (left, right)
                    } else {
                        (right, left)
                    };
                    stack.push(far);
                    stack.push(near);
                }
            }
        }
    }

    fn memory(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.items[..])
    }
}
