//! Trees that halve a set again and again, by cuts of some kind; for scenes that rest.
//!
//! A cut lies at the median of the centres. Since boxes may reach across, nothing
//! is split: a node keeps how far its left half reaches up along the cut's normal,
//! and its right half down (Ooi, McDonell, Sacks-Davis 1987, "Spatial kd-tree").
//! So each object is in one leaf. Costs stand with the kinds of cuts:
//! [`kd_tree`](crate::kd_tree) and [`bsp`](crate::bsp).

use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use crate::{Aabb, Boxes, Structure};
use glam::Vec3;

/// Objects in a leaf, at most.
const LEAF: usize = 4;

/// An object in a leaf.
#[derive(Clone, Copy, Debug)]
pub struct Item {
    pub(crate) aabb: Aabb,
    object: u32,
}

/// How a sweep moves along a cut's normal.
pub struct Motion {
    /// Where its lower end starts.
    pub low: f32,
    /// Where its upper end starts.
    pub high: f32,
    /// The inverse of its speed, rounded down where that matters to the left half.
    pub inverse_left: f32,
    /// The inverse of its speed, rounded up where that matters to the right half.
    pub inverse_right: f32,
}

/// A direction across which a set is halved.
pub trait Cut: Copy + Send + Sync {
    /// Name of the tree.
    const NAME: &'static str;
    /// A lower bound of the distance between a point and a node, as it is known on the way down.
    type Gap: Copy + Default;

    /// The direction for a set.
    fn across(items: &[Item]) -> Self;
    /// Where a point lies along the direction.
    fn height(self, point: Vec3) -> f32;
    /// What a box covers along the direction, rounded outwards.
    fn shadow(self, aabb: &Aabb) -> (f32, f32);
    /// How a sweep moves along the direction.
    fn motion(self, sweep: &Sweep) -> Motion;
    /// Takes into account a gap along the direction, if it is more than 0.
    fn widen(self, gap: Self::Gap, along: f32) -> Self::Gap;
    /// Square of the distance.
    fn square(gap: Self::Gap) -> f32;
}

#[derive(Clone, Copy, Debug)]
enum Node<C> {
    Leaf {
        first: u32,
        end: u32,
    },
    /// The left half follows.
    Split {
        cut: C,
        left_max: f32,
        right_min: f32,
        right: u32,
    },
}

/// A tree of halves, by cuts of kind `C`.
#[derive(Clone, Debug)]
pub struct Halves<C> {
    nodes: Vec<Node<C>>,
    /// Leaf by leaf.
    items: Vec<Item>,
}

/// Appends the tree over `items`, the first of which is `first` of all.
fn grow<C: Cut>(items: &mut [Item], first: u32, nodes: &mut Vec<Node<C>>) {
    let at = nodes.len();
    nodes.push(Node::Leaf {
        first,
        end: first + items.len() as u32,
    });
    if items.len() <= LEAF {
        return;
    }
    let cut = C::across(items);
    let middle = items.len() / 2;
    items.select_nth_unstable_by(middle, |x, y| {
        let (a, b) = (cut.height(x.aabb.center()), cut.height(y.aabb.center()));
        a.total_cmp(&b).then(x.object.cmp(&y.object))
    });
    let (left, right) = items.split_at_mut(middle);
    let left_max = left
        .iter()
        .fold(f32::NEG_INFINITY, |m, i| m.max(cut.shadow(&i.aabb).1));
    let right_min = right
        .iter()
        .fold(f32::INFINITY, |m, i| m.min(cut.shadow(&i.aabb).0));
    grow(left, first, nodes);
    nodes[at] = Node::Split {
        cut,
        left_max,
        right_min,
        right: nodes.len() as u32,
    };
    grow(right, first + middle as u32, nodes);
}

impl<C> Halves<C> {
    /// The objects of a leaf.
    fn leaf(&self, first: u32, end: u32) -> &[Item] {
        &self.items[first as usize..end as usize]
    }
}

impl<C: Cut> Structure for Halves<C> {
    const NAME: &'static str = C::NAME;

    fn build(boxes: &Boxes) -> Self {
        let item = |(object, b): (u32, &Aabb)| Item { aabb: *b, object };
        let mut items: Vec<Item> = boxes.bounded().map(item).collect();
        let mut nodes = Vec::with_capacity(items.len());
        grow(&mut items, 0, &mut nodes);
        Self { nodes, items }
    }

    fn relocated(&mut self, boxes: &Boxes, _: u32, _: &Aabb) {
        *self = Self::build(boxes);
    }

    fn overlap(&self, _: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let mut stack = Stack::<u32, 64>::with(0);
        while let Some(at) = stack.pop() {
            match self.nodes[at as usize] {
                Node::Leaf { first, end } => {
                    let leaf = self.leaf(first, end).iter();
                    leaf.filter(|i| i.aabb.overlaps(region))
                        .for_each(|i| visit(i.object));
                }
                Node::Split {
                    cut,
                    left_max,
                    right_min,
                    right,
                } => {
                    let (low, high) = cut.shadow(region);
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

    /// Carries the times between which the sweep is in the node.
    fn sweep(&self, _: &Boxes, sweep: &Sweep, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
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
                    cut,
                    left_max,
                    right_min,
                    right,
                } => {
                    let motion = cut.motion(sweep);
                    let out_of_left = (left_max - motion.low) * motion.inverse_left;
                    let into_right = (right_min - motion.high) * motion.inverse_right;
                    let left = match motion.inverse_left > 0.0 {
                        true => (at + 1, enter, leave.min(out_of_left)),
                        false => (at + 1, enter.max(out_of_left), leave),
                    };
                    let upwards = motion.inverse_right > 0.0;
                    let right = match upwards {
                        true => (right, enter.max(into_right), leave),
                        false => (right, enter, leave.min(into_right)),
                    };
                    let (near, far) = if upwards {
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

    fn approach(&self, _: &Boxes, point: Vec3, mut limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        let here = Aabb::new(point, point);
        let mut stack = Stack::<(u32, C::Gap), 64>::with((0, C::Gap::default()));
        while let Some((at, gap)) = stack.pop() {
            if C::square(gap) > limit * SLACK {
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
                    cut,
                    left_max,
                    right_min,
                    right,
                } => {
                    let (low, high) = cut.shadow(&here);
                    let left = (at + 1, cut.widen(gap, low - left_max));
                    let right = (right, cut.widen(gap, right_min - high));
                    // Where both are near, the side on which the point lies.
                    let is_left = low + high < left_max + right_min;
                    let (near, far) = if is_left {
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
