//! Rays in many worlds.

use super::lanes::{BOX, LaneBox, LaneRay};
use super::{Worlds, read};
use crate::SpaceError;
use glam::DVec3;
use numbers::dispatch::{Job, run_registers};
use numbers::{Float, Lanes, Memory, Vec3};
use rayon::prelude::*;

/// Numbers of a ray: origin, direction, limit of the time.
const RAY: usize = 7;
/// Numbers of a hit: time, object.
const HIT: usize = 2;

/// Rays in W worlds, as many in each.
#[derive(Clone, Debug)]
pub struct WorldRays<T>(Memory<T>);

/// The hits of [`WorldRays`].
#[derive(Clone, Debug)]
pub struct WorldHits<T>(Memory<T>);

impl<T: Float> Worlds<T> {
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
