//! Where shapes are: what swept shapes meet, what is near a point, what overlaps.
//!
//! [Boxes](scene) about the shapes, in single precision and grown by its error, tell which to try; these are asked
//! in double precision, as [`collide::distance`] has it.

mod cast;
mod near;
mod overlap;
pub(crate) mod scene;
mod seen;

pub use cast::ShapeCast;
pub use overlap::PlacedShape;
pub use seen::Seen;

use crate::error::{MOST_MOTION, index, length};
use crate::{Simulation, SimulationError};
use collide::{Form, kind};
use glam::DVec3;
use model::{BodyId, Geometry, Pose, ShapeId};
use numbers::Float;
use numbers::dispatch::Isa;
use rayon::prelude::*;
use scene::{Scene, Solid};
use std::cmp::Ordering;

/// A shape that a query found, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QueryHit {
    /// The shape.
    pub shape: ShapeId,
    /// Whose shape it is; none if it is the world's.
    pub body: Option<BodyId>,
    /// How far [m]; what from, each query tells.
    pub distance: f64,
    /// A point of the shape's surface [m], world axes.
    pub position: DVec3,
    /// Unit vector out of the surface there, world axes.
    pub normal: DVec3,
}

impl QueryHit {
    fn of(solid: &Solid<'_>, distance: f64, position: DVec3, normal: DVec3) -> Self {
        Self {
            shape: solid.shape,
            body: solid.of.body,
            distance,
            position,
            normal,
        }
    }
    /// The nearer first; of equally near ones that of the first shape.
    fn order(&self, other: &Self) -> Ordering {
        let nearer = self.distance.total_cmp(&other.distance);
        nearer.then(self.shape.cmp(&other.shape))
    }
}

/// What a query looks at.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    pub scene: &'a Scene,
    pub seen: &'a Seen,
    pub isa: Isa,
}

impl<'a> View<'a> {
    /// The solid in a row of the scene, if it is seen.
    #[inline]
    pub fn solid(&self, row: u32) -> Option<Solid<'a>> {
        let solid = self.scene.solid(row);
        self.seen.sees(solid.of).then_some(solid)
    }
}

/// A thread takes so many queries at a time.
const AT_A_TIME: usize = 32;

impl<T: Float> Simulation<T> {
    /// Answers queries about worlds, in threads and in order: those about `worlds[i]` are the i-th of as many equal parts
    /// of `queries`. `what` they are is told where one cannot be answered.
    pub(crate) fn ask<Q: Sync, A: Send>(
        &mut self,
        what: &'static str,
        (worlds, queries, seen): (&[usize], &[Q], &Seen),
        answer: impl Fn(View<'_>, &Q) -> Result<A, SimulationError> + Sync,
    ) -> Result<Vec<A>, SimulationError> {
        let count = self.worlds();
        worlds.iter().try_for_each(|&w| index("world", w, count))?;
        let each = queries.len() / worlds.len().max(1);
        length("queries of the worlds", queries.len(), each * worlds.len())?;
        self.update_scenes(worlds)?;
        let views = worlds.iter().map(|world| self.view(what, *world, seen));
        let views = views.collect::<Result<Vec<_>, _>>()?;
        let answer = |(i, query): (usize, &Q)| answer(views[i / each], query);
        // Others would have to be woken.
        if queries.len() <= AT_A_TIME {
            return queries.iter().enumerate().map(answer).collect();
        }
        let parts = queries.par_iter().enumerate().with_min_len(AT_A_TIME);
        self.threads.run(|| parts.map(answer).collect())
    }

    /// What a query about one world looks at; `what` it is is told where it cannot be answered.
    #[inline]
    pub(crate) fn look<'a>(
        &'a mut self,
        what: &'static str,
        world: usize,
        seen: &'a Seen,
    ) -> Result<View<'a>, SimulationError> {
        index("world", world, self.worlds())?;
        self.update_scenes(&[world])?;
        self.view(what, world, seen)
    }

    /// As [`look`](Simulation::look), at a world whose scene is of now.
    fn view<'a>(
        &'a self,
        what: &'static str,
        world: usize,
        seen: &'a Seen,
    ) -> Result<View<'a>, SimulationError> {
        seen.check(self.model().bodies.len())?;
        let scene = self.scene(world);
        seen.can_see(what, scene)?;
        Ok(View {
            scene,
            seen,
            isa: self.isa,
        })
    }
}

/// A refusal of a query.
fn refused(
    (query, index): (&'static str, usize),
    what: &'static str,
    value: impl ToString,
    remedy: &'static str,
) -> SimulationError {
    SimulationError::Query {
        query,
        index,
        what,
        value: value.to_string(),
        remedy,
    }
}

/// Refuses a point that is not finite or too far away.
#[inline]
pub(crate) fn check_point(
    query: (&'static str, usize),
    what: &'static str,
    point: DVec3,
) -> Result<(), SimulationError> {
    if point.is_finite() && point.abs().max_element() <= MOST_MOTION {
        return Ok(());
    }
    let remedy = "finite and within 1e9 m along each axis";
    Err(refused(query, what, point, remedy))
}

/// Shortest and longest direction that is taken.
const LENGTHS: std::ops::RangeInclusive<f64> = 1e-12..=1e12;

/// A direction with unit length.
#[inline]
pub(crate) fn check_direction(
    query: (&'static str, usize),
    direction: DVec3,
) -> Result<DVec3, SimulationError> {
    let length = direction.length();
    if LENGTHS.contains(&length) {
        return Ok(direction / length);
    }
    let remedy = "of a length from 1e-12 to 1e12";
    Err(refused(query, "direction", direction, remedy))
}

/// Refuses a largest distance that is negative or no number.
#[inline]
pub(crate) fn check_most(query: (&'static str, usize), most: f64) -> Result<(), SimulationError> {
    if most >= 0.0 {
        return Ok(());
    }
    let remedy = "0 or more, in metres";
    Err(refused(query, "largest distance", most, remedy))
}

/// Refuses what is no convex solid; gives its pose with an orientation of unit length.
fn check_shape(
    query: (&'static str, usize),
    geometry: &Geometry,
    pose: Pose,
) -> Result<Pose, SimulationError> {
    let form = Form::of(geometry);
    let form = form.filter(|form| (kind::SPHERE..kind::CONVEX).contains(&form.kind));
    let Some(form) = form else {
        let value = "a plane or a surface";
        let remedy = "a convex solid: a sphere, capsule, cylinder, cone, box, ellipsoid or hull";
        return Err(refused(query, "shape", value, remedy));
    };
    let (least, most) = (form.size.min_element(), form.size.max_element());
    if !form.size.is_finite() || least <= 0.0 || most > MOST_MOTION {
        let remedy = "positive and at most 1e9 m";
        return Err(refused(query, "half sizes", form.size, remedy));
    }
    if form.kind == kind::CAPSULE && form.size.y < form.size.x {
        let remedy = "at least the radius: it includes the caps";
        return Err(refused(query, "half height", form.size.y, remedy));
    }
    check_pose(query, pose)
}

/// A pose that is somewhere, with an orientation of unit length.
pub(crate) fn check_pose(
    query: (&'static str, usize),
    pose: Pose,
) -> Result<Pose, SimulationError> {
    check_point(query, "position", pose.position)?;
    let length = pose.orientation.length();
    if !LENGTHS.contains(&length) {
        let remedy = "a quaternion x, y, z, w of a length from 1e-12 to 1e12";
        return Err(refused(query, "orientation", pose.orientation, remedy));
    }
    Ok(Pose::new(pose.position, pose.orientation.normalize()))
}
