//! Which shapes touch one that is placed somewhere.

use super::scene::{Solid, around};
use super::{QueryHit, Seen, View, check_shape};
use crate::{Simulation, SimulationError};
use collide::distance::{Convex, Separation, separation};
use model::{Geometry, Pose};
use numbers::Float;
use numbers::dispatch::Isa;
use space::Aabb;

/// A shape somewhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlacedShape<'a> {
    /// A convex solid: a sphere, capsule, cylinder, cone, box, ellipsoid or hull.
    pub geometry: &'a Geometry,
    /// Where it is, world axes; the quaternion is scaled to unit length.
    pub pose: Pose,
}

impl PlacedShape<'_> {
    fn checked(self, index: usize) -> Result<Self, SimulationError> {
        let pose = check_shape(("shape", index), self.geometry, self.pose)?;
        Ok(Self { pose, ..self })
    }
    fn solid(&self) -> Convex<'_> {
        Convex::new(self.geometry, self.pose).expect("checked to be convex")
    }
    fn bounds(&self) -> Aabb {
        let [middle, half] = around(self.geometry, &self.pose);
        Aabb::enclosing(middle - half, middle + half)
    }
}

impl Solid<'_> {
    fn overlap(&self, isa: Isa, shape: &PlacedShape<'_>) -> Option<QueryHit> {
        let touches = |way: &Separation| way.distance <= 0.0;
        let Some(triangles) = self.triangles else {
            let target = Convex::new(self.geometry(), self.pose).expect("no mesh");
            let way = separation(isa, &shape.solid(), &target).filter(touches)?;
            return Some(self.out_of(&Pose::IDENTITY, way));
        };
        let frame = self.frame();
        let shape = PlacedShape {
            pose: frame.inverse() * shape.pose,
            ..*shape
        };
        let solid = shape.solid();
        let faces = triangles.space.overlap(&shape.bounds()).into_iter();
        let ways = faces.filter_map(|t| {
            let face = Convex::triangle(triangles.corners(t));
            separation(isa, &solid, &face).filter(touches)
        });
        let deepest = ways.min_by(|a, b| a.distance.total_cmp(&b.distance))?;
        Some(self.out_of(&frame, deepest))
    }
}

impl View<'_> {
    fn overlaps(&self, shape: &PlacedShape<'_>) -> Vec<QueryHit> {
        let near = self.scene.space.overlap(&shape.bounds()).into_iter();
        let solids = near.filter_map(|row| self.solid(row));
        solids
            .filter_map(|solid| solid.overlap(self.isa, shape))
            .collect()
    }
}

impl<T: Float> Simulation<T> {
    /// The shapes of a world that convex shapes overlap or touch, in the order of the model. For many, in threads; answer
    /// i belongs to `shapes[i]`.
    ///
    /// `distance` is 0 or less: how far [m] the two overlap along the way out; `position` is the point of the world's shape
    /// that is deepest in the other, and `normal` points out of the world's shape. The way out is the shortest, except
    /// where the two overlap by more than a tenth of the smaller one: there it is not in up to one of a hundred
    /// poses. Of a mesh these are of the triangle that is overlapped most; a shape wholly within a closed mesh does not
    /// touch it. Shapes are as rays meet them: see [`cast_ray`](Simulation::cast_ray).
    ///
    /// # Errors
    /// A world or a body that does not exist; a shape that is no convex solid, or whose sizes are not positive; a
    /// position or orientation that is NaN, beyond 1e9 m or of no length; a mesh that is seen and is the name of its
    /// file only.
    pub fn overlaps(
        &mut self,
        world: usize,
        shapes: &[PlacedShape<'_>],
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        self.overlaps_in_worlds(&[world], shapes, seen)
    }

    /// As [`overlaps`](Simulation::overlaps) in many worlds at once, which threads share: the shapes of `worlds[i]` are the
    /// i-th of as many equal parts of `shapes`.
    ///
    /// # Errors
    /// As [`overlaps`](Simulation::overlaps); a number of shapes that is no multiple of that of the worlds.
    pub fn overlaps_in_worlds(
        &mut self,
        worlds: &[usize],
        shapes: &[PlacedShape<'_>],
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        let shapes = shapes.iter().enumerate().map(|(i, s)| s.checked(i));
        let shapes = shapes.collect::<Result<Vec<_>, _>>()?;
        self.ask("shapes", (worlds, &shapes, seen), |view, shape| {
            Ok(view.overlaps(shape))
        })
    }
}
