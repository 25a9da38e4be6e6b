//! k-d tree for objects with extent; for scenes that rest.
//!
//! A set is halved at the median of the centres along the axis on which these
//! are spread the widest (Bentley 1975; Friedman, Bentley, Finkel 1977, "An
//! algorithm for finding best matches in logarithmic expected time"). Since
//! boxes may reach across, a node keeps two planes: how far its left half
//! reaches up, and its right half down (Ooi, McDonell, Sacks-Davis 1987,
//! "Spatial kd-tree"). So each object is in one leaf.
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n) |
//! | update, insert, remove, relocate | as build |
//! | query | O(log n + answers) for boxes that overlap little |
//! | nearest | O(log n) expected: gaps along the axes add up on the way down (Arya, Mount 1993) |
//! | memory | about 36 bytes an object |

use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use crate::{Aabb, Boxes, Structure};
use glam::Vec3;

/// Objects in a leaf, at most.
const LEAF: usize = 4;

#[derive(Clone, Copy, Debug)]
enum Node {
    Leaf {
        first: u32,
        end: u32,
    },
    /// The left half follows.
    Split {
        axis: u8,
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

/// A k-d tree; see the module's text.
#[derive(Clone, Debug)]
pub struct KdTree {
    nodes: Vec<Node>,
    /// Leaf by leaf.
    items: Vec<Item>,
    bounds: Aabb,
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
    let mut centers = Aabb::EMPTY;
    for item in items.iter() {
        let center = item.aabb.center();
        centers = centers.union(&Aabb::new(center, center));
    }
    let axis = centers.extent().max_position();
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |x, y| {
        let (a, b) = (x.aabb.center()[axis], y.aabb.center()[axis]);
        a.total_cmp(&b).then(x.object.cmp(&y.object))
    });
    let (left, right) = items.split_at_mut(middle);
    let left_max = left
        .iter()
        .fold(f32::NEG_INFINITY, |m, i| m.max(i.aabb.max[axis]));
    let right_min = right
        .iter()
        .fold(f32::INFINITY, |m, i| m.min(i.aabb.min[axis]));
    grow(left, first, nodes);
    nodes[at] = Node::Split {
        axis: axis as u8,
        left_max,
        right_min,
        right: nodes.len() as u32,
    };
    grow(right, first + middle as u32, nodes);
}

impl KdTree {
    fn leaf(&self, first: u32, end: u32) -> &[Item] {
        &self.items[first as usize..end as usize]
    }
}

impl Structure for KdTree {
    const NAME: &'static str = "kd_tree";

    fn build(boxes: &Boxes) -> Self {
        let mut items: Vec<Item> = boxes
            .bounded()
            .map(|(object, b)| Item { aabb: *b, object })
            .collect();
        let mut nodes = Vec::with_capacity(items.len());
        grow(&mut items, 0, &mut nodes);
        let bounds = items.iter().fold(Aabb::EMPTY, |all, i| all.union(&i.aabb));
        Self {
            nodes,
            items,
            bounds,
        }
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
                    axis,
                    left_max,
                    right_min,
                    right,
                } => {
                    let axis = usize::from(axis & 3);
                    if region.max[axis] >= right_min {
                        stack.push(right);
                    }
                    if region.min[axis] <= left_max {
                        stack.push(at + 1);
                    }
                }
            }
        }
    }

    /// Carries the times between which the sweep is in the node.
    fn sweep(&self, _: &Boxes, sweep: &Sweep, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let Some(enter) = sweep.enters(&self.bounds, limit) else {
            return;
        };
        let mut stack = Stack::<(u32, f32, f32), 64>::with((0, enter, f32::MAX));
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
                    axis,
                    left_max,
                    right_min,
                    right,
                } => {
                    let axis = usize::from(axis & 3);
                    let inverse = sweep.inverse[axis];
                    let at_left = (left_max - sweep.lower[axis]) * inverse;
                    let at_right = (right_min - sweep.upper[axis]) * inverse;
                    if inverse > 0.0 {
                        stack.push((right, enter.max(at_right), leave));
                        stack.push((at + 1, enter, leave.min(at_left)));
                    } else {
                        stack.push((at + 1, enter.max(at_left), leave));
                        stack.push((right, enter, leave.min(at_right)));
                    }
                }
            }
        }
    }

    /// Carries the gap between the point and the node along each axis.
    fn approach(&self, _: &Boxes, point: Vec3, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let gaps = (self.bounds.closest_point(point) - point).abs();
        let mut stack = Stack::<(u32, Vec3), 64>::with((0, gaps));
        while let Some((at, gaps)) = stack.pop() {
            if gaps.length_squared() > limit * SLACK {
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
                    axis,
                    left_max,
                    right_min,
                    right,
                } => {
                    let axis = usize::from(axis & 3);
                    let (mut of_left, mut of_right) = (gaps, gaps);
                    of_left[axis] = gaps[axis].max(point[axis] - left_max);
                    of_right[axis] = gaps[axis].max(right_min - point[axis]);
                    let (left, right) = ((at + 1, of_left), (right, of_right));
                    // Where both are near, the side on which the point lies.
                    let left_first = 2.0 * point[axis] < left_max + right_min;
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
