//! Loose octree.
//!
//! Each octant stands for a box twice its size, so that an object belongs to the
//! one octant that holds its centre and is at least as large as it, and a short
//! motion seldom takes it elsewhere (Ulrich 2000, "Loose octrees", Game
//! Programming Gems 1). An octant is divided when it holds more than a few
//! objects that would fit into an eighth of it.
//!
//! | | cost |
//! |---|---|
//! | build | O(n · depth) |
//! | update | O(n), and O(depth) for each object that leaves its octant |
//! | insert, remove, relocate | O(depth) |
//! | query | O(log n + answers) for objects spread evenly; the depth grows with their crowding |
//! | memory | about 40 bytes an object |

use crate::cast::{SLACK, Sweep};
use crate::stack::Stack;
use crate::{Aabb, Boxes, Structure};
use glam::Vec3;

const NONE: u32 = u32::MAX;
const ROOT: u32 = 0;
/// An octant is divided when at least so many of its objects would fit into its eighths.
const CAPACITY: u32 = 8;
/// The smallest octant is the root's size divided by 2 to this power.
const DEEPEST: u32 = 20;

#[derive(Clone, Copy, Debug)]
struct Octant {
    center: Vec3,
    /// Half of the cube's edge; the loose cube's is twice as long.
    half: f32,
    parent: u32,
    /// The first of eight, or [`NONE`].
    children: u32,
    /// The first of its own objects, or [`NONE`].
    first: u32,
    /// How many these are.
    own: u32,
    /// How many they are with those below.
    objects: u32,
}

/// Where an object hangs.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// [`NONE`] if the object is not in the tree.
    octant: u32,
    previous: u32,
    next: u32,
}

const NOWHERE: Place = Place {
    octant: NONE,
    previous: NONE,
    next: NONE,
};

/// A loose octree; see [the module](self).
#[derive(Clone, Debug)]
pub struct Octree {
    /// The root is first. It also holds what lies outside of it.
    octants: Vec<Octant>,
    places: Vec<Place>,
    /// How many objects the root may hold before all is built anew,
    tolerated: u32,
    /// and how many octants there may be: those that objects have left are not given back one by one.
    most_octants: usize,
}

fn half_size(aabb: &Aabb) -> f32 {
    0.5 * aabb.extent().max_element()
}

impl Octant {
    fn new(center: Vec3, half: f32, parent: u32) -> Self {
        Self {
            center,
            half,
            parent,
            children: NONE,
            first: NONE,
            own: 0,
            objects: 0,
        }
    }

    /// The box that holds all objects below, with room for rounding.
    fn loose(&self) -> Aabb {
        let pad = 1e-6 * self.center.abs().max_element();
        Aabb::around(self.center, Vec3::splat(2.001 * self.half + pad))
    }

    /// Whether an object belongs here or below.
    fn holds(&self, aabb: &Aabb) -> bool {
        let off = (aabb.center() - self.center).abs().max_element();
        off <= self.half && half_size(aabb) <= self.half
    }

    /// Which eighth holds a point.
    fn eighth(&self, point: Vec3) -> u32 {
        point.cmpgt(self.center).bitmask()
    }
}

impl Octree {
    /// Whether an object could belong to an eighth of an octant.
    fn is_small(&self, at: u32, aabb: &Aabb) -> bool {
        2.0 * half_size(aabb) <= self.octants[at as usize].half
    }

    /// The octant that an object belongs to, as the tree now is, and its depth.
    fn find(&self, aabb: &Aabb) -> (u32, u32) {
        let (mut at, mut depth) = (ROOT, 0);
        if !self.octants[0].holds(aabb) {
            return (ROOT, 0);
        }
        while self.octants[at as usize].children != NONE && self.is_small(at, aabb) {
            let octant = &self.octants[at as usize];
            at = octant.children + octant.eighth(aabb.center());
            depth += 1;
        }
        (at, depth)
    }

    fn insert(&mut self, boxes: &Boxes, object: u32) {
        let (at, depth) = self.find(boxes.get(object));
        self.count(at, 1);
        self.hang(at, object);
        self.divide(boxes, at, depth);
    }

    fn remove(&mut self, object: u32) {
        self.count(self.places[object as usize].octant, u32::MAX);
        self.unhang(object);
    }

    /// Adds to the number of objects (modulo 2³²) of an octant and of those about it.
    fn count(&mut self, mut at: u32, more: u32) {
        while let Some(octant) = self.octants.get_mut(at as usize) {
            octant.objects = octant.objects.wrapping_add(more);
            at = octant.parent;
        }
    }

    fn hang(&mut self, at: u32, object: u32) {
        let octant = &mut self.octants[at as usize];
        octant.own += 1;
        let next = std::mem::replace(&mut octant.first, object);
        if next != NONE {
            self.places[next as usize].previous = object;
        }
        self.places[object as usize] = Place {
            octant: at,
            previous: NONE,
            next,
        };
    }

    fn unhang(&mut self, object: u32) {
        let Place {
            octant: at,
            previous,
            next,
        } = std::mem::replace(&mut self.places[object as usize], NOWHERE);
        let octant = &mut self.octants[at as usize];
        octant.own -= 1;
        match previous {
            NONE => octant.first = next,
            _ => self.places[previous as usize].next = next,
        }
        if next != NONE {
            self.places[next as usize].previous = previous;
        }
    }

    /// Divides an octant if that pays. It looks when the number of its objects has
    /// doubled, so that large ones are not counted over and over.
    fn divide(&mut self, boxes: &Boxes, at: u32, depth: u32) {
        let octant = self.octants[at as usize];
        let look = octant.own >= CAPACITY && octant.own.is_power_of_two();
        if !look || octant.children != NONE || depth == DEEPEST {
            return;
        }
        let fits = |i: &u32| self.is_small(at, boxes.get(*i)) && octant.holds(boxes.get(*i));
        let small: Vec<u32> = self.own(&octant).filter(fits).collect();
        if small.len() < CAPACITY as usize {
            return;
        }
        let first = self.octants.len() as u32;
        self.octants[at as usize].children = first;
        let half = 0.5 * octant.half;
        for eighth in 0..8 {
            let side = |bit: u32| if eighth & bit == 0 { -half } else { half };
            let center = octant.center + Vec3::new(side(1), side(2), side(4));
            self.octants.push(Octant::new(center, half, at));
        }
        for object in small {
            let child = first + octant.eighth(boxes.get(object).center());
            self.unhang(object);
            self.hang(child, object);
            self.octants[child as usize].objects += 1;
            let deeper = self.find(boxes.get(object));
            self.divide(boxes, deeper.0, deeper.1);
        }
    }

    /// The objects that hang at an octant.
    fn own(&self, octant: &Octant) -> impl Iterator<Item = u32> {
        let listed = |i: u32| (i != NONE).then_some(i);
        std::iter::successors(listed(octant.first), move |i| {
            listed(self.places[*i as usize].next)
        })
    }

    /// Builds anew if too much has gathered in the root, or too many octants may be empty.
    fn look_after(&mut self, boxes: &Boxes) {
        if self.octants[0].own > self.tolerated || self.octants.len() > self.most_octants {
            *self = Self::build(boxes);
        }
    }

    /// Visits objects, those in octants with a low key first. `key` is that of a
    /// box, if it is within the limit.
    #[inline(always)]
    fn visit_in_order(
        &self,
        boxes: &Boxes,
        mut limit: f32,
        visit: &mut impl FnMut(u32) -> f32,
        key: impl Fn(&Aabb, f32) -> Option<f32>,
    ) {
        let mut stack = Stack::<(f32, u32), 128>::with((0.0, ROOT));
        while let Some((at_key, at)) = stack.pop() {
            if at_key > limit * SLACK {
                continue;
            }
            let octant = &self.octants[at as usize];
            for object in self.own(octant) {
                if key(boxes.get(object), limit).is_some() {
                    limit = visit(object);
                }
            }
            if octant.children == NONE {
                continue;
            }
            let mut met = [(0.0, 0); 8];
            let mut count = 0;
            for child in octant.children..octant.children + 8 {
                let octant = &self.octants[child as usize];
                if octant.objects > 0
                    && let Some(key) = key(&octant.loose(), limit)
                {
                    met[count] = (key, child);
                    count += 1;
                }
            }
            met[..count].sort_unstable_by(|x, y| y.0.total_cmp(&x.0).then(y.1.cmp(&x.1)));
            met[..count].iter().for_each(|entry| stack.push(*entry));
        }
    }
}

impl Structure for Octree {
    const NAME: &'static str = "octree";

    fn build(boxes: &Boxes) -> Self {
        let centers = boxes.bounded().map(|(_, b)| b.center());
        let whole = centers.fold(Aabb::EMPTY, |all, c| all.union(&Aabb::new(c, c)));
        let (center, half) = match whole.min.x <= whole.max.x {
            true => (whole.center(), half_size(&whole).max(f32::MIN_POSITIVE)),
            false => (Vec3::ZERO, 1.0),
        };
        let mut tree = Self {
            octants: vec![Octant::new(center, 1.001 * half, NONE)],
            places: vec![NOWHERE; boxes.all().len()],
            tolerated: u32::MAX,
            most_octants: usize::MAX,
        };
        boxes.bounded().for_each(|(i, _)| tree.insert(boxes, i));
        tree.tolerated = 64 + 2 * tree.octants[0].own + boxes.count() as u32 / 8;
        tree.most_octants = 64 + 2 * tree.octants.len() + boxes.count() / 8;
        tree
    }

    fn refresh(&mut self, boxes: &Boxes) {
        for (object, aabb) in boxes.bounded() {
            let at = self.places[object as usize].octant;
            if at == ROOT || !self.octants[at as usize].holds(aabb) {
                self.remove(object);
                self.insert(boxes, object);
            }
        }
        self.look_after(boxes);
    }

    fn inserted(&mut self, boxes: &Boxes, object: u32) {
        self.places.resize(boxes.all().len(), NOWHERE);
        self.insert(boxes, object);
        self.look_after(boxes);
    }

    fn removed(&mut self, _: &Boxes, object: u32, _: &Aabb) {
        self.remove(object);
    }

    fn overlap(&self, boxes: &Boxes, region: &Aabb, visit: &mut impl FnMut(u32)) {
        let mut stack = Stack::<u32, 128>::with(ROOT);
        while let Some(at) = stack.pop() {
            let octant = &self.octants[at as usize];
            self.own(octant)
                .filter(|i| boxes.get(*i).overlaps(region))
                .for_each(&mut *visit);
            if octant.children == NONE {
                continue;
            }
            for child in octant.children..octant.children + 8 {
                let octant = &self.octants[child as usize];
                if octant.objects > 0 && octant.loose().overlaps(region) {
                    stack.push(child);
                }
            }
        }
    }

    fn sweep(&self, boxes: &Boxes, sweep: &Sweep, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        self.visit_in_order(boxes, limit, visit, |aabb, limit| sweep.enters(aabb, limit));
    }

    fn approach(&self, boxes: &Boxes, point: Vec3, limit: f32, visit: &mut impl FnMut(u32) -> f32) {
        self.visit_in_order(boxes, limit, visit, |aabb, limit| {
            let square = aabb.distance_squared(point);
            (square <= limit * SLACK).then_some(square)
        });
    }

    fn memory(&self) -> usize {
        size_of_val(&self.octants[..]) + size_of_val(&self.places[..])
    }
}
