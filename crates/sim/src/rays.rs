//! What a ray meets first.
//!
//! Solids and the triangles of meshes are met exactly, in double precision ([`collide::ray`]); boxes
//! about them, in single precision and grown by its error, tell which to try.

use crate::Simulation;
use crate::error::{MOST_MOTION, SimulationError, index, length};
use crate::meshes::Triangles;
use collide::ray::{Line, Sheared};
use glam::{DVec3, Vec3};
use model::{BodyId, Geometry, Pose, Shape, ShapeId};
use numbers::Float;
use rayon::prelude::*;
use space::{Aabb, Bvh, Cast, Space};
use std::sync::Arc;

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

/// Shortest and longest direction that is taken.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

impl Ray {
    /// The same with a direction of unit length.
    fn checked(self, index: usize) -> Result<Self, SimulationError> {
        let refuse = |what, value: String, remedy| {
            Err(SimulationError::Ray {
                index,
                what,
                value,
                remedy,
            })
        };
        if !(self.origin.abs().max_element() <= MOST_MOTION && self.origin.is_finite()) {
            let origin = self.origin.to_string();
            return refuse("origin", origin, "finite and within 1e9 m along each axis");
        }
        let length = self.direction.length();
        if !LENGTHS.contains(&length) {
            let direction = self.direction.to_string();
            return refuse("direction", direction, "of a length from 1e-12 to 1e12");
        }
        if self.max_distance.is_nan() || self.max_distance < 0.0 {
            let most = self.max_distance.to_string();
            return refuse("largest distance", most, "0 or more, in metres");
        }
        Ok(Self {
            direction: self.direction / length,
            ..self
        })
    }
}

/// A shape where it is.
#[derive(Clone, Debug)]
struct Solid<'a> {
    shape: ShapeId,
    geometry: &'a Geometry,
    /// If it is a mesh.
    triangles: Option<Arc<Triangles>>,
    pose: Pose,
}

impl<'a> Solid<'a> {
    fn new(
        shape: ShapeId,
        of: &'a Shape,
        triangles: Option<Arc<Triangles>>,
        bodies: &[Pose],
    ) -> Result<Self, SimulationError> {
        if matches!(of.geometry, Geometry::MeshFile { .. }) {
            return Err(SimulationError::RayMesh {
                shape: shape.0,
                name: of.name.clone(),
            });
        }
        let carrier = of.body.map_or(Pose::IDENTITY, |body| bodies[body.0]);
        Ok(Self {
            shape,
            geometry: &of.geometry,
            triangles,
            pose: carrier * of.pose,
        })
    }

    /// Where a ray, whose direction has unit length, meets the shape.
    fn meet(&self, ray: &Ray) -> Result<Option<RayHit>, SimulationError> {
        match &self.triangles {
            Some(triangles) => self.meet_mesh(triangles, ray),
            None => Ok(self.meet_solid(ray)),
        }
    }

    /// Its line is measured from the point nearest to the solid's centre, so that far origins cost no
    /// more digits than they must.
    fn meet_solid(&self, ray: &Ray) -> Option<RayHit> {
        let inverse = self.pose.inverse();
        let (origin, direction) = (inverse.point(ray.origin), inverse.direction(ray.direction));
        let foot = -origin.dot(direction);
        let line = Line {
            origin: origin + foot * direction,
            direction,
        };
        let span = line.within(self.geometry)?;
        let (enter, leave) = (foot + span.enter, foot + span.leave);
        if leave < 0.0 || enter > ray.max_distance {
            return None;
        }
        let (distance, normal) = if enter > 0.0 {
            (enter, self.pose.direction(span.normal).normalize())
        } else {
            (0.0, -ray.direction)
        };
        Some(RayHit {
            shape: self.shape,
            distance,
            position: ray.origin + distance * ray.direction,
            normal,
        })
    }

    /// The ray is looked at from where it enters the ball about the mesh, for the same reason.
    fn meet_mesh(
        &self,
        triangles: &Triangles,
        ray: &Ray,
    ) -> Result<Option<RayHit>, SimulationError> {
        let frame = self.pose * Pose::at(self.geometry.center());
        let inverse = frame.inverse();
        let (origin, direction) = (inverse.point(ray.origin), inverse.direction(ray.direction));
        let radius = self.geometry.half_extents().map_or(0.0, DVec3::length);
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
            let normal = triangles.normal(triangle);
            let hit = RayHit {
                shape: self.shape,
                distance,
                position: ray.origin + (start + distance) * ray.direction,
                normal: self
                    .pose
                    .direction(normal * -normal.dot(direction).signum()),
            };
            (0.0..=near.max_distance).contains(&distance).then_some(hit)
        };
        let hit = first(&triangles.space, radius, &near, |t| Ok(cross(t)))?;
        Ok(hit.map(|hit| RayHit {
            distance: start + hit.distance,
            ..hit
        }))
    }

    /// A box about it along the world's axes: |R| times that along its own.
    fn around(&self) -> Aabb {
        let Some(half) = self.geometry.half_extents() else {
            return Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY);
        };
        let axes = DVec3::AXES.map(|axis| self.pose.direction(axis).abs());
        let reach = axes[0] * half.x + axes[1] * half.y + axes[2] * half.z;
        let center = self.pose.point(self.geometry.center());
        Aabb::enclosing(center - reach, center + reach)
    }
}

/// The nearer; of equally near ones that of the first shape.
fn nearer(a: RayHit, b: RayHit) -> RayHit {
    let b_is = b
        .distance
        .total_cmp(&a.distance)
        .then(b.shape.cmp(&a.shape));
    if b_is.is_lt() { b } else { a }
}

/// Solids and the boxes about them.
struct Scene<'a> {
    solids: Vec<Solid<'a>>,
    space: Space<Bvh>,
    /// No coordinate of a box that ends is larger [m].
    reach: f64,
}

/// In single precision origin, direction and times are off by so large a share of all lengths, at
/// most. (Each rounds by 6e-8.)
const ROUNDING: f64 = 1e-6;

impl<'a> Scene<'a> {
    fn new(solids: Vec<Solid<'a>>) -> Result<Self, SimulationError> {
        let boxes: Vec<_> = solids.iter().map(Solid::around).collect();
        let corners = boxes.iter().flat_map(|b| [b.min, b.max]);
        let sizes = corners.map(|corner| f64::from(corner.abs().max_element()));
        let reach = sizes.filter(|size| size.is_finite()).fold(0.0, f64::max);
        Ok(Self {
            space: Space::new(&boxes)?,
            solids,
            reach,
        })
    }

    fn first(&self, ray: &Ray) -> Result<Option<RayHit>, SimulationError> {
        let meet = |solid: u32| self.solids[solid as usize].meet(ray);
        first(&self.space, self.reach, ray, meet)
    }
}

/// The nearest of the hits of the objects whose boxes, none of which reaches beyond `reach` [m], a ray
/// meets; of equally near ones that of the first shape.
fn first(
    space: &Space<Bvh>,
    reach: f64,
    ray: &Ray,
    meet: impl Fn(u32) -> Result<Option<RayHit>, SimulationError>,
) -> Result<Option<RayHit>, SimulationError> {
    let slack = ROUNDING * (ray.origin.abs().max_element() + reach);
    let (origin, direction) = (ray.origin.as_vec3(), ray.direction.as_vec3());
    let cast = Cast::aabb(origin, Vec3::splat(slack as f32), direction)?
        .until((ray.max_distance as f32).next_up());
    let mut best: Option<RayHit> = None;
    for near in space.cast_all(&cast, space.boxes()) {
        if best.is_some_and(|best| best.distance < f64::from(near.time)) {
            break;
        }
        let hit = meet(near.object)?;
        best = best.into_iter().chain(hit).reduce(nearer);
    }
    Ok(best)
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
        index("world", world, self.worlds())?;
        let ray = ray.checked(0)?;
        let bodies = self.placements(world)?;
        let meshes = self.triangles(world);
        let solids = self.solids(world, &bodies, meshes, None)?;
        let hits = solids.iter().filter_map(|s| s.meet(&ray).transpose());
        let hits = hits.collect::<Result<Vec<_>, _>>()?;
        Ok(hits.into_iter().reduce(nearer))
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
        index("world", world, self.worlds())?;
        let rays = rays.iter().enumerate().map(|(i, ray)| ray.checked(i));
        let rays = rays.collect::<Result<Vec<_>, _>>()?;
        let bodies = self.placements(world)?;
        let meshes = self.triangles(world);
        let scene = Scene::new(self.solids(world, &bodies, meshes, None)?)?;
        let parts = rays.par_iter().with_min_len(RAYS_AT_A_TIME);
        self.threads
            .run(|| parts.map(|ray| scene.first(ray)).collect())
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
        let count = self.worlds();
        worlds.iter().try_for_each(|&w| index("world", w, count))?;
        let each = rays.len() / worlds.len().max(1);
        length("rays of the worlds", rays.len(), each * worlds.len())?;
        if each == 0 {
            return Ok(Vec::new());
        }
        let rays = rays.iter().enumerate().map(|(i, ray)| ray.checked(i));
        let rays = rays.collect::<Result<Vec<_>, _>>()?;
        let placed: Vec<(usize, Vec<Pose>, _)> = worlds
            .iter()
            .map(|&world| Ok((world, self.placements(world)?, self.triangles(world))))
            .collect::<Result<_, SimulationError>>()?;
        let cast = |((world, bodies, meshes), rays): ((usize, Vec<Pose>, _), &[Ray])| {
            let scene = Scene::new(self.solids(world, &bodies, meshes, except)?)?;
            rays.iter()
                .map(|ray| scene.first(ray))
                .collect::<Result<Vec<_>, SimulationError>>()
        };
        let parts = placed.into_par_iter().zip(rays.par_chunks(each));
        let hits: Result<Vec<_>, _> = self.threads.run(|| parts.map(cast).collect());
        Ok(hits?.concat())
    }

    /// Of each body of a world where it is now, with an orientation of unit length to double precision.
    fn placements(&mut self, world: usize) -> Result<Vec<Pose>, SimulationError> {
        let bodies = (0..self.model().bodies.len()).map(BodyId);
        let outputs = self.try_outputs()?;
        let placed = |body| {
            let orientation = outputs.body_orientation(world, body).normalize();
            Pose::new(outputs.body_position(world, body), orientation)
        };
        Ok(bodies.map(placed).collect())
    }

    /// Of the shapes of a world that are meshes.
    fn triangles(&mut self, world: usize) -> Vec<Option<Arc<Triangles>>> {
        let mut meshes = std::mem::take(&mut self.meshes);
        let shapes = self.shapes(world).iter();
        let triangles = shapes.map(|shape| meshes.of(shape)).collect();
        self.meshes = meshes;
        triangles
    }

    /// The shapes of a world but those of one body, on bodies that are placed so.
    fn solids(
        &self,
        world: usize,
        bodies: &[Pose],
        meshes: Vec<Option<Arc<Triangles>>>,
        except: Option<BodyId>,
    ) -> Result<Vec<Solid<'_>>, SimulationError> {
        let shapes = self.shapes(world).iter().zip(meshes).enumerate();
        shapes
            .filter(|(_, (shape, _))| !shape.sensor && (except.is_none() || shape.body != except))
            .map(|(i, (shape, mesh))| Solid::new(ShapeId(i), shape, mesh, bodies))
            .collect()
    }
}

/// A thread takes so many rays at a time.
const RAYS_AT_A_TIME: usize = 64;
