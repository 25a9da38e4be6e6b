//! Many worlds of the same objects, side by side in lanes.
//!
//! In replicated worlds an object is the same everywhere, only elsewhere. So which
//! pairs may ever meet follows from the topology: it is found once, for all worlds.
//! What is left is to cull, per block of worlds, the pairs that are near in no lane,
//! and that is a comparison of boxes in registers.
//!
//! | | cost for O objects, P pairs, W worlds, L lanes |
//! |---|---|
//! | near pairs | O(P · W / L), in threads |
//! | near a scene shared by all worlds | O(O · W / L), and a query of the scene for each |
//! | casts | O(O · rays · W / L), in threads |
//! | memory | 6 numbers an object and world |

mod cast;
mod lanes;

pub use cast::{WorldHits, WorldRays};
pub use lanes::{LaneBox, LaneRay};

use crate::{Aabb, Pair, Space, SpaceError, Structure};
use glam::DVec3;
use lanes::BOX;
use numbers::dispatch::{Isa, Job, run_registers};
use numbers::{Float, Lanes, LanesMask, Memory};
use rayon::prelude::*;

/// The boxes of W worlds of the same objects.
#[derive(Clone, Debug)]
pub struct Worlds<T> {
    boxes: Memory<T>,
    objects: usize,
    pairs: Vec<Pair>,
    isa: Isa,
}

/// Per block of worlds, what is near in one of its lanes at least.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Near<P> {
    ends: Vec<usize>,
    items: Vec<P>,
}

impl<P> Near<P> {
    fn join(blocks: Vec<Vec<P>>) -> Self {
        let ends = blocks.iter().scan(0, |end, block| {
            *end += block.len();
            Some(*end)
        });
        Self {
            ends: ends.collect(),
            items: blocks.into_iter().flatten().collect(),
        }
    }

    /// What is near in a block, in order.
    pub fn block(&self, block: usize) -> &[P] {
        let start = block.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.items[start..self.ends[block]]
    }
}

/// An object of replicated worlds, and one of a scene that they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ScenePair {
    /// Index of the worlds' object.
    pub object: u32,
    /// Index of the scene's object.
    pub scene: u32,
}

impl<T: Float> Worlds<T> {
    /// For `worlds` worlds of `objects` objects each, which are nowhere until they are
    /// set. Those pairs may meet, in any world, for which `may_meet(a, b)`, asked for all a < b.
    pub fn new(
        worlds: usize,
        objects: usize,
        isa: Isa,
        may_meet: impl Fn(u32, u32) -> bool,
    ) -> Self {
        let mut boxes = Memory::new(worlds, BOX * objects, isa.width::<T>());
        for i in 0..BOX * objects {
            let inside_out = if i % BOX < 3 {
                f64::INFINITY
            } else {
                f64::NEG_INFINITY
            };
            boxes.fill(i, T::from_f64(inside_out));
        }
        let with = |a| (a + 1..objects as u32).map(move |b| Pair { a, b });
        Self {
            boxes,
            objects,
            pairs: (0..objects as u32)
                .flat_map(with)
                .filter(|p| may_meet(p.a, p.b))
                .collect(),
            isa,
        }
    }

    /// The pairs that may meet, in order.
    pub fn candidates(&self) -> &[Pair] {
        &self.pairs
    }

    /// The boxes, `[block][object][lower corner, upper corner][lane]`, to write.
    pub fn boxes_mut(&mut self) -> &mut Memory<T> {
        &mut self.boxes
    }

    /// The boxes, `[block][object][lower corner, upper corner][lane]`.
    pub fn boxes(&self) -> &Memory<T> {
        &self.boxes
    }

    /// Sets one object's box in one world.
    ///
    /// # Errors
    /// The box has a NaN or is inside out, or there is no such world or object.
    pub fn set(
        &mut self,
        world: usize,
        object: usize,
        min: DVec3,
        max: DVec3,
    ) -> Result<(), SpaceError> {
        if object >= self.objects || world >= self.boxes.worlds() {
            return Err(SpaceError::Query {
                what: "world and object",
                value: format!("{world}, {object}"),
                remedy: "below their numbers",
            });
        }
        let aabb = Aabb::enclosing(min, max);
        crate::boxes::check(object, &aabb)?;
        // Single precision rounds outwards.
        let (min, max) = match T::DOUBLE {
            true => (min, max),
            false => (aabb.min.as_dvec3(), aabb.max.as_dvec3()),
        };
        for axis in 0..3 {
            self.boxes
                .set(world, BOX * object + axis, T::from_f64(min[axis]));
            self.boxes
                .set(world, BOX * object + 3 + axis, T::from_f64(max[axis]));
        }
        Ok(())
    }

    /// Of the pairs that may meet, those whose boxes are in some lane of a block not
    /// farther apart than `margin` [m].
    pub fn near(&self, margin: T) -> Near<Pair> {
        let blocks = (0..self.boxes.blocks()).into_par_iter().with_min_len(4);
        let near = blocks.map(|block| {
            let job = NearJob {
                boxes: self.boxes.block(block),
                pairs: &self.pairs,
                margin,
            };
            run_registers(self.isa, job)
        });
        Near::join(near.collect())
    }

    /// Objects (`a`) near those of a scene (`b`) that rests and is the same in all
    /// worlds, in some lane of a block, in order of `a`, then `b`.
    pub fn near_scene<S: Structure>(&self, scene: &Space<S>, margin: T) -> Near<ScenePair> {
        let blocks = (0..self.boxes.blocks()).into_par_iter().with_min_len(4);
        let near = blocks.map(|block| {
            let about = |object| self.about(block, object, margin);
            let met = |a: usize| {
                scene
                    .overlap(&about(a))
                    .into_iter()
                    .map(move |b| ScenePair {
                        object: a as u32,
                        scene: b,
                    })
            };
            (0..self.objects).flat_map(met).collect()
        });
        Near::join(near.collect())
    }

    /// The box about an object in all worlds of a block.
    fn about(&self, block: usize, object: usize, margin: T) -> Aabb {
        let width = self.boxes.width();
        let used = width.min(self.boxes.worlds() - block * width);
        let field = |i: usize| &self.boxes.block(block)[(BOX * object + i) * width..][..used];
        let least = |i| {
            field(i)
                .iter()
                .fold(f64::INFINITY, |m, x| m.min(x.to_f64()))
                - margin.to_f64()
        };
        let most = |i| {
            field(i)
                .iter()
                .fold(f64::NEG_INFINITY, |m, x| m.max(x.to_f64()))
                + margin.to_f64()
        };
        Aabb::enclosing(
            DVec3::new(least(0), least(1), least(2)),
            DVec3::new(most(3), most(4), most(5)),
        )
    }
}

/// `N` neighbouring fields of a row.
#[inline(always)]
fn read<R: Lanes, const N: usize>(fields: &[R], row: usize) -> [R; N] {
    let row: &[R; N] = fields[N * row..][..N].try_into().expect("N fields");
    *row
}

/// The near pairs of one block.
struct NearJob<'a, T> {
    boxes: &'a [T],
    pairs: &'a [Pair],
    margin: T,
}

impl<T: Float> Job for NearJob<'_, T> {
    type Scalar = T;
    type Output = Vec<Pair>;

    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) -> Vec<Pair> {
        let boxes: &[R] = bytemuck::cast_slice(self.boxes);
        let margin = R::splat(self.margin);
        let mut near = Vec::with_capacity(self.pairs.len());
        for pair in self.pairs {
            let a = LaneBox::read(read(boxes, pair.a as usize));
            let b = LaneBox::read(read(boxes, pair.b as usize));
            if a.is_near(&b, margin).any() {
                near.push(*pair);
            }
        }
        near
    }
}
