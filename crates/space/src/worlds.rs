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

use crate::{Aabb, Pair, Space, SpaceError, Structure};
use glam::DVec3;
use numbers::dispatch::{Isa, Job, run_registers};
use numbers::{Float, Lanes, LanesMask, Memory, Real, Vec3};
use rayon::prelude::*;

/// Numbers of a box: lower corner, then upper corner.
const BOX: usize = 6;
/// Numbers of a ray: origin, direction, limit of the time.
const RAY: usize = 7;
/// Numbers of a hit: time, object.
const HIT: usize = 2;

/// A box in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneBox<R> {
    /// Lower corner.
    pub min: Vec3<R>,
    /// Upper corner.
    pub max: Vec3<R>,
}

impl<R: Real> LaneBox<R> {
    /// From lower corner and upper corner.
    #[inline(always)]
    pub fn read(x: [R; BOX]) -> Self {
        Self {
            min: Vec3::new(x[0], x[1], x[2]),
            max: Vec3::new(x[3], x[4], x[5]),
        }
    }

    /// In which lanes the boxes are not farther apart than `margin` along any axis.
    #[inline(always)]
    pub fn is_near(&self, other: &Self, margin: R) -> R::Mask {
        let beside = |a: R, b: R| a.le(b + margin);
        beside(self.min.x, other.max.x)
            & beside(other.min.x, self.max.x)
            & beside(self.min.y, other.max.y)
            & beside(other.min.y, self.max.y)
            & beside(self.min.z, other.max.z)
            & beside(other.min.z, self.max.z)
    }
}

/// A ray in each lane, made ready for many boxes.
#[derive(Clone, Copy, Debug)]
pub struct LaneRay<R> {
    lower: Vec3<R>,
    upper: Vec3<R>,
    inverse: Vec3<R>,
}

impl<R: Real> LaneRay<R> {
    /// From origin and direction; a component of the direction below 10⁻²⁰ counts as none.
    ///
    /// Along an axis of no motion, all times are within a box or none is: the origin is
    /// spread by a part in 10⁶, and 10⁻⁹ m, and the speed's inverse is 10³⁰.
    #[inline(always)]
    pub fn new(origin: Vec3<R>, direction: Vec3<R>) -> Self {
        let axis = |o: R, d: R| {
            let rests = d.abs().lt(R::lit(1e-20));
            let pad = R::select(rests, o.abs().fma(R::lit(1e-6), R::lit(1e-9)), R::zero());
            let inverse = R::select(rests, R::lit(1e30), R::select(rests, R::one(), d).recip());
            (o - pad, o + pad, inverse)
        };
        let x = axis(origin.x, direction.x);
        let y = axis(origin.y, direction.y);
        let z = axis(origin.z, direction.z);
        Self {
            lower: Vec3::new(x.0, y.0, z.0),
            upper: Vec3::new(x.1, y.1, z.1),
            inverse: Vec3::new(x.2, y.2, z.2),
        }
    }

    /// When the box is entered, at least 0, and in which lanes that is by `limit`.
    #[inline(always)]
    pub fn enter(&self, aabb: &LaneBox<R>, limit: R) -> (R, R::Mask) {
        let axis = |min: R, max: R, upper: R, lower: R, inverse: R| {
            let (a, b) = ((min - upper) * inverse, (max - lower) * inverse);
            (a.min(b), a.max(b))
        };
        let x = axis(
            aabb.min.x,
            aabb.max.x,
            self.upper.x,
            self.lower.x,
            self.inverse.x,
        );
        let y = axis(
            aabb.min.y,
            aabb.max.y,
            self.upper.y,
            self.lower.y,
            self.inverse.y,
        );
        let z = axis(
            aabb.min.z,
            aabb.max.z,
            self.upper.z,
            self.lower.z,
            self.inverse.z,
        );
        let enter = x.0.max(y.0).max(z.0.max(R::zero()));
        let leave = x.1.min(y.1).min(z.1.min(limit));
        // An inside-out box is met nowhere.
        (enter, enter.le(leave) & aabb.min.x.le(aabb.max.x))
    }
}

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

/// Rays in W worlds, as many in each.
#[derive(Clone, Debug)]
pub struct WorldRays<T>(Memory<T>);

/// The hits of [`WorldRays`].
#[derive(Clone, Debug)]
pub struct WorldHits<T>(Memory<T>);

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

    /// Rays for these worlds, `count` in each, that hit nothing until they are set.
    pub fn rays(&self, count: usize) -> WorldRays<T> {
        let mut rays = Memory::new(self.boxes.worlds(), RAY * count, self.boxes.width());
        (0..count).for_each(|ray| rays.fill(RAY * ray + 6, T::from_f64(-1.0)));
        WorldRays(rays)
    }

    /// The first box that each ray meets in its world; of equally early ones, the one
    /// with the lowest index.
    ///
    /// # Errors
    /// The rays were made for other worlds.
    pub fn cast(&self, rays: &WorldRays<T>) -> Result<WorldHits<T>, SpaceError> {
        if (rays.0.worlds(), rays.0.width()) != (self.boxes.worlds(), self.boxes.width()) {
            return Err(SpaceError::Query {
                what: "number of worlds of the rays",
                value: rays.0.worlds().to_string(),
                remedy: "that of the boxes: make the rays with `Worlds::rays`",
            });
        }
        let count = rays.0.length() / RAY;
        let mut hits = Memory::new(rays.0.worlds(), HIT * count, rays.0.width());
        let size = hits.block_size().max(1);
        let blocks = hits.scalars_mut().par_chunks_mut(size).enumerate();
        blocks.for_each(|(block, hits)| {
            let job = CastJob {
                boxes: self.boxes.block(block),
                rays: rays.0.block(block),
                hits,
            };
            run_registers(self.isa, job);
        });
        Ok(WorldHits(hits))
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

impl<T: Float> WorldRays<T> {
    /// Sets one ray of one world. Times are in units of `direction`; hits after `limit` do not count.
    ///
    /// # Errors
    /// A number is NaN or infinite (`limit` may be), the direction is null, or there is no such world or ray.
    pub fn set(
        &mut self,
        world: usize,
        ray: usize,
        origin: DVec3,
        direction: DVec3,
        limit: f64,
    ) -> Result<(), SpaceError> {
        let refuse = |what, value: String, remedy| {
            Err(SpaceError::Query {
                what,
                value,
                remedy,
            })
        };
        if world >= self.0.worlds() || RAY * ray >= self.0.length() {
            return refuse(
                "world and ray",
                format!("{world}, {ray}"),
                "below their numbers",
            );
        }
        if !origin.is_finite() {
            return refuse("origin", origin.to_string(), "finite");
        }
        if !direction.is_finite() || direction.length() < 1e-12 {
            return refuse(
                "direction",
                direction.to_string(),
                "finite and about of unit length",
            );
        }
        if limit.is_nan() {
            return refuse("limit", limit.to_string(), "a number, or infinite");
        }
        let numbers = origin
            .to_array()
            .into_iter()
            .chain(direction.to_array())
            .chain([limit]);
        for (i, x) in numbers.enumerate() {
            self.0.set(world, RAY * ray + i, T::from_f64(x));
        }
        Ok(())
    }

    /// The rays, `[block][ray][origin, direction, limit][lane]`, to write.
    pub fn numbers_mut(&mut self) -> &mut Memory<T> {
        &mut self.0
    }
}

impl<T: Float> WorldHits<T> {
    /// What a ray met first in a world, and when; nothing if it met nothing.
    ///
    /// Panics where there is no such world or ray.
    pub fn get(&self, world: usize, ray: usize) -> Option<(u32, T)> {
        let object = self.0.get(world, HIT * ray + 1).to_f64();
        (object >= 0.0).then(|| (object as u32, self.0.get(world, HIT * ray)))
    }

    /// The hits, `[block][ray][time, object][lane]`; the object is −1 for no hit.
    pub fn numbers(&self) -> &Memory<T> {
        &self.0
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

/// The rays of one block.
struct CastJob<'a, T> {
    boxes: &'a [T],
    rays: &'a [T],
    hits: &'a mut [T],
}

impl<T: Float> Job for CastJob<'_, T> {
    type Scalar = T;
    type Output = ();

    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let boxes: &[R] = bytemuck::cast_slice(self.boxes);
        let rays: &[R] = bytemuck::cast_slice(self.rays);
        let hits: &mut [R] = bytemuck::cast_slice_mut(self.hits);
        for ray in 0..rays.len() / RAY {
            let [x, y, z, u, v, w, limit] = read(rays, ray);
            let swept = LaneRay::new(Vec3::new(x, y, z), Vec3::new(u, v, w));
            let (mut time, mut hit) = (limit, R::lit(-1.0));
            for object in 0..boxes.len() / BOX {
                let (enter, met) = swept.enter(&LaneBox::read(read(boxes, object)), time);
                // The first of equally early ones stays.
                let sooner = met & (enter.lt(time) | hit.lt(R::zero()));
                time = R::select(sooner, enter, time);
                hit = R::select(sooner, R::lit(object as f64), hit);
            }
            hits[HIT * ray] = time;
            hits[HIT * ray + 1] = hit;
        }
    }
}
