//! The points of shapes that are nearest to a point.

use super::scene::{ROUNDING, Solid};
use super::{QueryHit, Seen, View, check_point};
use crate::meshes::Triangles;
use crate::{Simulation, SimulationError};
use collide::distance::{Convex, Outside, nearest_on_triangle, outside};
use glam::DVec3;
use numbers::Float;
use numbers::dispatch::Isa;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Points of neighbouring triangles that are nearer to each other than this share of the mesh are one.
const ONE: f64 = 1e-12;

/// The single precision number that is not smaller.
fn above(distance: f64) -> f32 {
    (distance as f32).next_up()
}

impl Solid<'_> {
    /// Its point nearest to another that is at most so far away [m]; negative distances are inside.
    fn nearest(&self, isa: Isa, point: DVec3, within: f64) -> Option<QueryHit> {
        let Outside { distance, normal } = match self.triangles {
            Some(triangles) => {
                let frame = self.frame();
                let local = frame.inverse().point(point);
                let half = self.geometry().half_extents().unwrap_or(DVec3::ZERO);
                let may_hold = triangles.closed && local.abs().cmple(half).all();
                let reach = if may_hold {
                    f64::INFINITY
                } else {
                    within.max(0.0)
                };
                let found = nearest_of_mesh(triangles, half.length(), local, reach)?;
                Outside {
                    normal: frame.direction(found.normal),
                    ..found
                }
            }
            None => {
                let solid = Convex::new(self.geometry(), self.pose).expect("no mesh");
                outside(isa, &solid, point)
            }
        };
        let hit = QueryHit::of(self, distance, point - distance * normal, normal);
        (distance <= within).then_some(hit)
    }
}

/// The nearest point of a mesh so far, and the sum of its triangles' normals there, each times the angle [rad] that the
/// triangle takes up around it.
struct Nearest {
    distance: f64,
    point: DVec3,
    normals: DVec3,
}

/// How far a point, in the triangles' frame, is from their surface, if not farther than `within` [m].
///
/// It is inside of a closed one where it is behind the sum of the normals of the triangles around the nearest point,
/// each times its angle there: Bærentzen & Aanæs, Signed Distance Computation Using the Angle Weighted Pseudonormal
/// (2005). A surface that ends somewhere has no inside.
fn nearest_of_mesh(
    triangles: &Triangles,
    radius: f64,
    point: DVec3,
    within: f64,
) -> Option<Outside> {
    let far = point.abs().max_element() + radius;
    let (slack, one) = (ROUNDING * far, ONE * far);
    let mut best: Option<Nearest> = None;
    triangles
        .space
        .approach(point.as_vec3(), above(within + slack), |t| {
            let (on, angle) = nearest_on_triangle(triangles.corners(t), point);
            let (distance, normal) = (point.distance(on), angle * triangles.normal(t));
            match &mut best {
                Some(best) if best.point.distance(on) <= one => best.normals += normal,
                Some(best) if best.distance <= distance => {}
                _ => {
                    best = Some(Nearest {
                        distance,
                        point: on,
                        normals: normal,
                    });
                }
            }
            let reach = best.as_ref().map_or(within, |best| best.distance);
            above(reach.min(within) + slack)
        });
    let Nearest {
        distance,
        point: on,
        normals,
    } = best?;
    let out = (point - on).try_normalize().filter(|_| distance > one);
    let is_behind = (point - on).dot(normals) < 0.0;
    let side = if triangles.closed && is_behind {
        -1.0
    } else {
        1.0
    };
    Some(Outside {
        distance: side * distance,
        normal: out.map_or_else(|| normals.normalize_or(DVec3::Y), |out| side * out),
    })
}

/// In the order of [`QueryHit::order`].
struct Ranked(QueryHit);

impl Ord for Ranked {
    fn cmp(&self, other: &Self) -> Ordering {
        self.0.order(&other.0)
    }
}

impl PartialOrd for Ranked {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Ranked {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Ranked {}

impl View<'_> {
    /// The `k` nearest shapes that are not farther than `within` [m], the nearest first.
    fn nearest(&self, point: DVec3, k: usize, within: f64) -> Vec<QueryHit> {
        let slack = ROUNDING * (point.abs().max_element() + self.scene.reach);
        let mut near = BinaryHeap::new();
        // The distance of the last that counts.
        let last = |near: &BinaryHeap<Ranked>| match near.peek() {
            Some(Ranked(hit)) if near.len() == k => hit.distance,
            _ => within,
        };
        self.scene
            .space
            .approach(point.as_vec3(), above(within + slack), |row| {
                let solid = self.solid(row);
                let hit = solid.and_then(|s| s.nearest(self.isa, point, last(&near)));
                if let Some(hit) = hit {
                    near.push(Ranked(hit));
                    if near.len() > k {
                        near.pop();
                    }
                }
                // What is inside is the nearer the deeper it is, and any box about the point may tell of that.
                above(last(&near).max(0.0) + slack)
            });
        let near = near.into_sorted_vec().into_iter();
        near.map(|Ranked(hit)| hit).collect()
    }
}

/// Refuses points that make no sense, and a reach that is negative or no number.
fn check(points: &[DVec3], within: f64) -> Result<(), SimulationError> {
    if within.is_nan() || within < 0.0 {
        return Err(SimulationError::Setting {
            what: "largest distance".into(),
            value: within.to_string(),
            remedy: "0 or more, in metres".into(),
        });
    }
    let mut points = points.iter().enumerate();
    points.try_for_each(|(i, point)| check_point(("point", i), "position", *point))
}

impl<T: Float> Simulation<T> {
    /// Of each shape of a world that is within a distance [m], which may be infinite, of a point: the point of its surface
    /// that is nearest, the nearest shape first. For many points, in threads; answer i belongs to `points[i]` [m], world
    /// axes.
    ///
    /// `distance` is that from the surface, negative where the point is inside; `normal` points out of the surface, along the
    /// way between the two. A closed mesh has an inside, another surface has none. Shapes that hold the point are always
    /// within. Shapes are as rays meet them: see [`cast_ray`](Simulation::cast_ray).
    ///
    /// # Errors
    /// A world or a body that does not exist; a point that is not finite or beyond 1e9 m; a distance that is negative or
    /// NaN; a mesh that is seen and whose file cannot be read.
    pub fn closest_points(
        &mut self,
        world: usize,
        points: &[DVec3],
        within: f64,
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        self.closest_points_in_worlds(&[world], points, within, seen)
    }

    /// As [`closest_points`](Simulation::closest_points) in many worlds at once, which threads share: the points of
    /// `worlds[i]` are the i-th of as many equal parts of `points`.
    ///
    /// # Errors
    /// As [`closest_points`](Simulation::closest_points); a number of points that is no multiple of that of the worlds.
    pub fn closest_points_in_worlds(
        &mut self,
        worlds: &[usize],
        points: &[DVec3],
        within: f64,
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        self.nearest_in_worlds(worlds, points, usize::MAX, within, seen)
    }

    /// As [`closest_points`](Simulation::closest_points), of the `k` nearest shapes only. A shape that holds the point is
    /// the nearer the deeper it does; of equally near ones the first are taken.
    ///
    /// # Errors
    /// As [`closest_points`](Simulation::closest_points); a `k` of 0.
    pub fn nearest(
        &mut self,
        world: usize,
        points: &[DVec3],
        k: usize,
        within: f64,
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        self.nearest_in_worlds(&[world], points, k, within, seen)
    }

    /// As [`nearest`](Simulation::nearest) in many worlds at once, which threads share: the points of `worlds[i]` are the
    /// i-th of as many equal parts of `points`.
    ///
    /// # Errors
    /// As [`nearest`](Simulation::nearest); a number of points that is no multiple of that of the worlds.
    pub fn nearest_in_worlds(
        &mut self,
        worlds: &[usize],
        points: &[DVec3],
        k: usize,
        within: f64,
        seen: &Seen,
    ) -> Result<Vec<Vec<QueryHit>>, SimulationError> {
        check(points, within)?;
        if k == 0 {
            return Err(SimulationError::Setting {
                what: "number of nearest shapes".into(),
                value: k.to_string(),
                remedy: "1 or more".into(),
            });
        }
        self.ask("points", (worlds, points, seen), |view, point| {
            Ok(view.nearest(*point, k, within))
        })
    }
}
