//! What a shape meets first that moves along a line without turning.

use super::scene::{ROUNDING, Solid, around};
use super::{QueryHit, Seen, View, check_direction, check_most, check_shape};
use crate::meshes::Triangles;
use crate::{Simulation, SimulationError};
use collide::distance::{Convex, Separation, first_touch};
use glam::DVec3;
use model::{Geometry, Pose};
use numbers::Float;
use numbers::dispatch::Isa;
use space::{Bvh, Cast, Space};

/// A shape that moves along a line without turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeCast<'a> {
    /// A convex solid: a sphere, capsule, cylinder, cone, box, ellipsoid or hull.
    pub geometry: &'a Geometry,
    /// Where it starts, world axes; the quaternion is scaled to unit length.
    pub pose: Pose,
    /// Where it goes, world axes; of any length but zero.
    pub direction: DVec3,
    /// What it would have to go farther for [m] is not met; may be infinite.
    pub max_distance: f64,
}

impl ShapeCast<'_> {
    /// The same with a direction and an orientation of unit length.
    fn checked(self, index: usize) -> Result<Self, SimulationError> {
        let query = ("shape cast", index);
        check_most(query, self.max_distance)?;
        Ok(Self {
            pose: check_shape(query, self.geometry, self.pose)?,
            direction: check_direction(query, self.direction)?,
            ..self
        })
    }

    /// The same in another frame, after so much of the way [m].
    fn seen_from(&self, frame: &Pose, gone: f64) -> Self {
        let inverse = frame.inverse();
        let start = Pose::new(
            self.pose.position + gone * self.direction,
            self.pose.orientation,
        );
        Self {
            pose: inverse * start,
            direction: inverse.direction(self.direction),
            max_distance: self.max_distance - gone,
            ..*self
        }
    }

    fn solid(&self) -> Convex<'_> {
        Convex::new(self.geometry, self.pose).expect("checked to be convex")
    }

    /// Visits what may be met of the objects of a space, none of which reaches beyond `reach` [m], with the way [m] that
    /// is gone at least by then; `meet` tells what is, and it is as [`first_touch`] has it. The first of all that are
    /// met, of those that are at once the one most overlapped.
    fn first_of<H>(
        &self,
        space: &Space<Bvh>,
        reach: f64,
        mut meet: impl FnMut(u32, [f64; 2]) -> Result<Option<(f64, H)>, SimulationError>,
        is_better: impl Fn(&(f64, H), &(f64, H)) -> bool,
    ) -> Result<Option<(f64, H)>, SimulationError> {
        let [middle, half] = around(self.geometry, &self.pose);
        let slack = ROUNDING * (middle.abs().max_element() + half.max_element() + reach);
        let half = (half + slack).as_vec3();
        let box_cast = Cast::aabb(middle.as_vec3(), half, self.direction.as_vec3())?
            .until((self.max_distance as f32).next_up());
        let mut best: Option<(f64, H)> = None;
        let mut failed = None;
        space.sweep(&box_cast, |object| {
            let until = best.as_ref().map_or(self.max_distance, |(t, _)| *t);
            let limit = (until as f32).next_up();
            let Some(from) = box_cast.against(space.boxes().get(object), limit) else {
                return limit;
            };
            match meet(object, [f64::from(from), until]) {
                Ok(Some(found)) if best.as_ref().is_none_or(|b| is_better(&found, b)) => {
                    best = Some(found);
                }
                Ok(_) => {}
                Err(error) => failed = Some(error),
            }
            let until = best.as_ref().map_or(self.max_distance, |(t, _)| *t);
            (until as f32).next_up()
        });
        match failed {
            Some(error) => Err(error),
            None => Ok(best),
        }
    }
}

impl Solid<'_> {
    /// Where it is first touched, and how far the cast has gone then.
    fn touched(
        &self,
        isa: Isa,
        cast: &ShapeCast<'_>,
        [from, until]: [f64; 2],
    ) -> Result<Option<(f64, QueryHit)>, SimulationError> {
        let met = match self.triangles {
            Some(triangles) => {
                let near = ShapeCast {
                    max_distance: until - from,
                    ..cast.seen_from(&self.frame(), from)
                };
                let met = first_triangle(isa, triangles, self.radius(), &near)?;
                met.map(|(t, way)| (from + t, self.out_of(&self.frame(), way)))
            }
            None => {
                let target = Convex::new(self.geometry(), self.pose).expect("no mesh");
                let met = first_touch(isa, &cast.solid(), &target, cast.direction, [from, until]);
                met.map(|(t, way)| (t, self.out_of(&Pose::IDENTITY, way)))
            }
        };
        Ok(met.map(|(t, hit)| (t, QueryHit { distance: t, ..hit })))
    }

    /// The end of a way to it, seen from a frame.
    pub(super) fn out_of(&self, frame: &Pose, way: Separation) -> QueryHit {
        let position = frame.point(way.on_b);
        QueryHit::of(self, way.distance, position, frame.direction(-way.normal))
    }
}

/// The first triangle that is touched, in their frame; none lies beyond `radius` [m].
fn first_triangle(
    isa: Isa,
    triangles: &Triangles,
    radius: f64,
    cast: &ShapeCast<'_>,
) -> Result<Option<(f64, Separation)>, SimulationError> {
    let solid = cast.solid();
    let meet = |t: u32, span: [f64; 2]| {
        let face = Convex::triangle(triangles.corners(t));
        Ok(first_touch(isa, &solid, &face, cast.direction, span))
    };
    let deeper = |a: &(f64, Separation), b: &(f64, Separation)| {
        let order = a.0.total_cmp(&b.0);
        order.then(a.1.distance.total_cmp(&b.1.distance)).is_lt()
    };
    cast.first_of(&triangles.space, radius, meet, deeper)
}

impl View<'_> {
    fn first_touched(&self, cast: &ShapeCast<'_>) -> Result<Option<QueryHit>, SimulationError> {
        let meet = |row: u32, span: [f64; 2]| match self.solid(row) {
            Some(solid) => solid.touched(self.isa, cast, span),
            None => Ok(None),
        };
        let before = |a: &(f64, QueryHit), b: &(f64, QueryHit)| a.1.order(&b.1).is_lt();
        let best = cast.first_of(&self.scene.space, self.scene.reach, meet, before)?;
        Ok(best.map(|(_, hit)| hit))
    }
}

impl<T: Float> Simulation<T> {
    /// What a convex shape that moves along a line, without turning, first touches in a world.
    ///
    /// `distance` is how far it goes [m]; `position` is where it touches the other shape, and `normal` points out of
    /// that. A shape that it overlaps at the start is met at distance 0; then these two are of the point that is
    /// deepest in it, and the way out is along the normal. Of shapes that are met at once it is the first.
    ///
    /// Shapes are as rays meet them: see [`cast_ray`](Simulation::cast_ray). A mesh is met from both sides; a shape
    /// wholly within a closed one does not touch it.
    ///
    /// # Errors
    /// A world or a body that does not exist; a shape that is no convex solid, or whose sizes are not positive; a
    /// position, orientation, direction or distance that is NaN; a position beyond 1e9 m, a quaternion or a direction of
    /// no length, a negative distance; a mesh that is seen and whose file cannot be read.
    pub fn cast_shape(
        &mut self,
        world: usize,
        cast: ShapeCast<'_>,
        seen: &Seen,
    ) -> Result<Option<QueryHit>, SimulationError> {
        let cast = cast.checked(0)?;
        self.look("swept shapes", world, seen)?.first_touched(&cast)
    }

    /// As [`cast_shape`](Simulation::cast_shape) for many, in threads; answer i belongs to `casts[i]`, and is the same
    /// as if it were asked alone.
    ///
    /// # Errors
    /// As [`cast_shape`](Simulation::cast_shape); of a cast, its place in `casts`.
    pub fn cast_shapes(
        &mut self,
        world: usize,
        casts: &[ShapeCast<'_>],
        seen: &Seen,
    ) -> Result<Vec<Option<QueryHit>>, SimulationError> {
        self.cast_shapes_in_worlds(&[world], casts, seen)
    }

    /// As [`cast_shapes`](Simulation::cast_shapes) in many worlds at once, which threads share: the casts of `worlds[i]`
    /// are the i-th of as many equal parts of `casts`.
    ///
    /// # Errors
    /// As [`cast_shapes`](Simulation::cast_shapes); a number of casts that is no multiple of that of the worlds.
    pub fn cast_shapes_in_worlds(
        &mut self,
        worlds: &[usize],
        casts: &[ShapeCast<'_>],
        seen: &Seen,
    ) -> Result<Vec<Option<QueryHit>>, SimulationError> {
        let casts = casts.iter().enumerate().map(|(i, cast)| cast.checked(i));
        let casts = casts.collect::<Result<Vec<_>, _>>()?;
        self.ask("swept shapes", (worlds, &casts, seen), |view, cast| {
            view.first_touched(cast)
        })
    }
}
