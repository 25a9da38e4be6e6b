//! What a ray meets first.
//!
//! Solids and the triangles of meshes are met exactly, in double precision ([`collide::ray`]); boxes
//! about them, in single precision and grown by its error, tell which to try.

use crate::meshes::Triangles;
use crate::queries::scene::{ROUNDING, Solid};
use crate::queries::{Seen, View, check_direction, check_most, check_point};
use crate::{Simulation, SimulationError};
use collide::ray::{Line, Sheared};
use glam::{DVec3, Vec3};
use model::{BodyId, ShapeId};
use numbers::Float;
use space::{Bvh, Cast, Space};

/// A ray in a world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts [m], world axes.
    pub origin: DVec3,
    /// Where it goes, world axes; of any length but zero.
    pub direction: DVec3,
    /// What is farther from the origin [m] is not met; may be infinite.
    pub max_distance: f64,
}

/// Where a ray first meets a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayHit {
    /// The shape; of equally near ones the first.
    pub shape: ShapeId,
    /// From the ray's origin [m]; 0 where that lies in the shape.
    pub distance: f64,
    /// The point [m], world axes.
    pub position: DVec3,
    /// Unit vector out of the shape's surface, world axes; against the ray where its origin lies in
    /// the shape. Of a mesh: on the side that the ray comes from.
    pub normal: DVec3,
}

impl Ray {
    /// The same with a direction of unit length.
    #[inline]
    fn checked(self, index: usize) -> Result<Self, SimulationError> {
        let query = ("ray", index);
        check_point(query, "origin", self.origin)?;
        let direction = check_direction(query, self.direction)?;
        check_most(query, self.max_distance)?;
        Ok(Self { direction, ..self })
    }
}

/// Where a ray first meets a row of a scene, or a triangle.
#[derive(Clone, Copy)]
struct Met {
    object: u32,
    /// From the ray's origin [m].
    distance: f64,
    /// Out of the surface in its own frame, of any length; of a triangle on its front. Zero where the origin is inside.
    normal: DVec3,
}

impl Met {
    fn is_before(&self, other: &Self) -> bool {
        let order = self.distance.total_cmp(&other.distance);
        order.then(self.object.cmp(&other.object)).is_lt()
    }
}

impl Solid<'_> {
    /// Where a ray, whose direction has unit length, meets the shape, which is a row of the scene.
    #[inline]
    fn meet(&self, row: u32, ray: &Ray) -> Result<Option<Met>, SimulationError> {
        match self.triangles {
            Some(triangles) => self.meet_mesh(triangles, row, ray),
            None => Ok(self.meet_solid(row, ray)),
        }
    }

    /// Its line is measured from the point nearest to the solid's centre, so that far origins cost no
    /// more digits than they must.
    #[inline]
    fn meet_solid(&self, row: u32, ray: &Ray) -> Option<Met> {
        let turn = self.pose.orientation.conjugate();
        let origin = turn * (ray.origin - self.pose.position);
        let direction = turn * ray.direction;
        let foot = -origin.dot(direction);
        let line = Line {
            origin: origin + foot * direction,
            direction,
        };
        let span = line.within(self.geometry())?;
        let (enter, leave) = (foot + span.enter, foot + span.leave);
        if leave < 0.0 || enter > ray.max_distance {
            return None;
        }
        let (distance, normal) = if enter > 0.0 {
            (enter, span.normal)
        } else {
            (0.0, DVec3::ZERO)
        };
        Some(Met {
            object: row,
            distance,
            normal,
        })
    }

    /// The ray is looked at from where it enters the ball about the mesh, for the same reason.
    fn meet_mesh(
        &self,
        triangles: &Triangles,
        row: u32,
        ray: &Ray,
    ) -> Result<Option<Met>, SimulationError> {
        let inverse = self.frame().inverse();
        let (origin, direction) = (inverse.point(ray.origin), inverse.direction(ray.direction));
        let radius = self.radius();
        let start = (-origin.dot(direction) - radius).max(0.0);
        let near = Ray {
            origin: origin + start * direction,
            direction,
            max_distance: ray.max_distance - start,
        };
        let line = Sheared::new(&Line {
            origin: near.origin,
            direction,
        });
        let cross = |triangle: u32| {
            let distance = line.crosses(triangles.corners(triangle))?;
            let met = Met {
                object: triangle,
                distance,
                normal: triangles.normal(triangle),
            };
            (0.0..=near.max_distance).contains(&distance).then_some(met)
        };
        let met = first(&triangles.space, radius, &near, |t| Ok(cross(t)))?;
        Ok(met.map(|met| Met {
            object: row,
            distance: start + met.distance,
            // The side that the ray comes from.
            normal: met.normal * -met.normal.dot(direction).signum(),
        }))
    }

    #[inline]
    fn hit(&self, met: &Met, ray: &Ray) -> RayHit {
        RayHit {
            shape: self.shape,
            distance: met.distance,
            position: ray.origin + met.distance * ray.direction,
            normal: self
                .pose
                .direction(met.normal)
                .try_normalize()
                .unwrap_or(-ray.direction),
        }
    }
}

/// The nearest of what the objects, whose boxes do not reach beyond `reach` [m], are met at by a ray; of equally near
/// ones that of the first object.
#[inline]
fn first(
    space: &Space<Bvh>,
    reach: f64,
    ray: &Ray,
    meet: impl Fn(u32) -> Result<Option<Met>, SimulationError>,
) -> Result<Option<Met>, SimulationError> {
    let slack = ROUNDING * (ray.origin.abs().max_element() + reach);
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let cast = Cast::aabb(origin, Vec3::splat(slack as f32), direction)?
        .until((ray.max_distance as f32).next_up());
    let (mut best, mut failed): (Option<Met>, _) = (None, None);
    let mut until = cast.limit();
    space.sweep(&cast, |object| {
        match meet(object) {
            Ok(Some(met)) if best.is_none_or(|best| met.is_before(&best)) => {
                best = Some(met);
                until = (met.distance as f32).next_up();
            }
            Ok(_) => {}
            Err(error) => failed = Some(error),
        }
        until
    });
    failed.map_or(Ok(best), Err)
}

impl View<'_> {
    fn first_met(&self, ray: &Ray) -> Result<Option<RayHit>, SimulationError> {
        let meet = |row| match self.solid(row) {
            Some(solid) => solid.meet(row, ray),
            None => Ok(None),
        };
        let met = first(&self.scene.space, self.scene.reach, ray, meet)?;
        Ok(met.map(|met| self.scene.solid(met.object).hit(&met, ray)))
    }
}

impl<T: Float> Simulation<T> {
    /// What a ray from `origin` [m] along `direction` (world axes, any length but zero) first meets
    /// in a world, up to `max_distance` [m], which may be infinite.
    ///
    /// Rays meet all shapes where they are now, those that collide and those that are only seen, and
    /// their surfaces; they pass through sensors. A plane is the half space below it, whatever part of
    /// it is drawn. A ray whose origin lies in a solid meets it there, at distance 0. A mesh is met from
    /// both sides.
    ///
    /// # Errors
    /// A world that does not exist; an origin, direction or distance that is NaN; an origin beyond
    /// 1e9 m, a direction of no length, a negative distance; a mesh that is the name
    /// of its file only.
    pub fn cast_ray(
        &mut self,
        world: usize,
        origin: DVec3,
        direction: DVec3,
        max_distance: f64,
    ) -> Result<Option<RayHit>, SimulationError> {
        let ray = Ray {
            origin,
            direction,
            max_distance,
        };
        let ray = ray.checked(0)?;
        let seen = Seen::default();
        self.look("rays", world, &seen)?.first_met(&ray)
    }

    /// As [`cast_ray`](Simulation::cast_ray) for many rays in one world, in threads; answer i belongs
    /// to `rays[i]`, and is the same as if it were asked alone.
    ///
    /// # Errors
    /// As [`cast_ray`](Simulation::cast_ray); of a ray, its place in `rays`.
    pub fn cast_rays(
        &mut self,
        world: usize,
        rays: &[Ray],
    ) -> Result<Vec<Option<RayHit>>, SimulationError> {
        self.cast_rays_in_worlds(&[world], rays, None)
    }

    /// As [`cast_rays`](Simulation::cast_rays) in many worlds at once, which threads share: the rays of
    /// `worlds[i]` are the i-th of as many equal parts of `rays`. They pass through the shapes of
    /// `except`, as those of a sensor do through the body that it is mounted on.
    ///
    /// # Errors
    /// As [`cast_rays`](Simulation::cast_rays); a number of rays that is no multiple of that of the worlds.
    pub fn cast_rays_in_worlds(
        &mut self,
        worlds: &[usize],
        rays: &[Ray],
        except: Option<BodyId>,
    ) -> Result<Vec<Option<RayHit>>, SimulationError> {
        let rays = rays.iter().enumerate().map(|(i, ray)| ray.checked(i));
        let rays = rays.collect::<Result<Vec<_>, _>>()?;
        let seen = Seen {
            except: except.into_iter().collect(),
            ..Seen::default()
        };
        self.ask("rays", (worlds, &rays, &seen), |view, ray| {
            view.first_met(ray)
        })
    }
}
