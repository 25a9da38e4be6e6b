//! Convex solids with flat faces.
//!
//! Quickhull (Barber, Dobkin & Huhdanpaa, The Quickhull algorithm for convex hulls, 1996): from a
//! tetrahedron on, a point outside replaces the facets that it sees by a cone to their horizon; each
//! point still outside waits at the facet that it is farthest above. Which facets a point sees is
//! told by exact signs (Shewchuk, Adaptive precision floating-point arithmetic, 1997), so that the
//! surface is closed whatever the points; a point in the plane of a facet does not see it.
//!
//! Departure from the source: points nearer to the hull than [`NEAR`] are left out, so that the
//! rounding of a file's numbers makes no corners in flat faces.

use glam::DVec3;
use robust::{Coord3D, orient3d};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::Arc;
use thiserror::Error;

/// The convex hull of points, in the frame of its shape. Copies share their corners.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Surface", into = "Surface")]
pub struct Hull(Arc<Surface>);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Surface {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    center: DVec3,
}

/// Why points have no convex hull.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum HullError {
    /// A coordinate is infinite or not a number.
    #[error("point {point} of the hull is at {position}: give finite coordinates")]
    NotFinite {
        /// Which point.
        point: usize,
        /// Its coordinates.
        position: DVec3,
    },
    /// Larger or smaller than anything that moves.
    #[error(
        "the points of the hull reach over {extent:e} m: give from 1e-9 to 1e9 m; check the units"
    )]
    Extent {
        /// How far [m].
        extent: f64,
    },
    /// A solid has at least four corners.
    #[error("a convex hull needs 4 points or more, and {points} different ones were given")]
    TooFew {
        /// How many different points there are.
        points: usize,
    },
    /// The points lie in a plane or on a line.
    #[error(
        "the {points} points of the hull lie in one plane within {thickness:.1e} m, over {extent:.1e} m: \
         give it a thickness"
    )]
    Flat {
        /// How many points there are.
        points: usize,
        /// Their distance from a plane [m].
        thickness: f64,
        /// Their distance from each other [m].
        extent: f64,
    },
    /// A hull is looked through corner by corner.
    #[error("the hull has {corners} corners, and at most {most} are taken: simplify it")]
    TooManyCorners {
        /// How many corners it has.
        corners: usize,
        /// How many it may have.
        most: usize,
    },
}

/// Smallest extent [m].
const SMALLEST: f64 = 1e-9;
/// Largest coordinate [m].
const FARTHEST: f64 = 1e9;
/// Distance from the hull, against the extent of the points, within which a point is on it.
const NEAR: f64 = 1e-6;
/// Most corners.
const MOST_CORNERS: usize = 4096;

impl From<Hull> for Surface {
    fn from(hull: Hull) -> Self {
        Arc::unwrap_or_clone(hull.0)
    }
}

/// What was written comes back as it was, if it can have been a hull.
impl TryFrom<Surface> for Hull {
    type Error = HullError;
    fn try_from(surface: Surface) -> Result<Self, HullError> {
        let hull = Self::new(&surface.vertices)?;
        let corners = 0..surface.vertices.len() as u32;
        let corners_exist = surface
            .triangles
            .iter()
            .flatten()
            .all(|v| corners.contains(v));
        Ok(if corners_exist && surface.center.is_finite() {
            Self(Arc::new(surface))
        } else {
            hull
        })
    }
}

impl Hull {
    /// Of points [m]; those inside are dropped.
    ///
    /// # Errors
    /// Numbers that are not finite, fewer than four different points, points within a millionth of
    /// their extent of a plane, more than 4096 corners.
    pub fn new(points: &[DVec3]) -> Result<Self, HullError> {
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            let position = points[point];
            return Err(HullError::NotFinite { point, position });
        }
        let mut different = points.to_vec();
        different.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).expect("finite"));
        different.dedup();
        let mut quickhull = Quickhull::new(&different)?;
        quickhull.run();
        quickhull.hull()
    }

    /// Corners [m].
    pub fn vertices(&self) -> &[DVec3] {
        &self.0.vertices
    }
    /// Faces as triangles, counter-clockwise as seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }
    /// Centre of its volume [m], which is inside.
    pub fn center(&self) -> DVec3 {
        self.0.center
    }
    /// Corners [m] from the centre.
    pub fn arms(&self) -> impl Iterator<Item = DVec3> {
        self.vertices().iter().map(|v| *v - self.center())
    }
    /// Half of the box about the centre that holds it, along the axes of its frame [m].
    pub fn half_extents(&self) -> DVec3 {
        self.arms().map(DVec3::abs).fold(DVec3::ZERO, DVec3::max)
    }
    /// Half of the least distance between a face and the corner opposite [m]: how thin it is, whatever its axes.
    pub fn half_width(&self) -> f64 {
        let widths = self.faces().map(|[a, b, c]| {
            let normal = (b - a).cross(c - a).normalize_or_zero();
            let depths = self.vertices().iter().map(|v| normal.dot(a - *v));
            depths.fold(0.0, f64::max)
        });
        0.5 * widths.filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min)
    }
    /// Radius of the ball about the centre that holds it [m].
    pub fn radius(&self) -> f64 {
        self.arms().map(DVec3::length).fold(0.0, f64::max)
    }
    /// The corners of each of [`triangles`](Self::triangles) [m].
    pub fn faces(&self) -> impl Iterator<Item = [DVec3; 3]> + Clone {
        let corner = |v: u32| self.vertices()[v as usize];
        self.triangles().iter().map(move |t| t.map(corner))
    }

    fn closed(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let mut surface = Surface {
            vertices,
            triangles,
            center: DVec3::ZERO,
        };
        // Tetrahedra from one corner o to each face: their centres, by their volumes.
        let o = surface.vertices[0];
        let (mut volume, mut moment) = (0.0, DVec3::ZERO);
        for t in &surface.triangles {
            let [a, b, c] = t.map(|v| surface.vertices[v as usize] - o);
            let part = a.dot(b.cross(c));
            volume += part;
            moment += part * (a + b + c) / 4.0;
        }
        surface.center = o + moment / volume;
        Self(Arc::new(surface))
    }
}

struct Quickhull<'a> {
    points: &'a [DVec3],
    facets: Vec<Facet>,
    /// The facet to the left of an edge, as seen from outside.
    left: HashMap<[usize; 2], usize>,
    extent: f64,
}

struct Facet {
    /// Counter-clockwise, as seen from outside.
    corners: [usize; 3],
    /// Twice its area [m²].
    area: f64,
    /// Points that are outside, and farther above it than above others that were made with it.
    outside: Vec<usize>,
    /// On the hull so far.
    stands: bool,
}

impl Facet {
    fn edges(&self) -> [[usize; 2]; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]]
    }
}

impl<'a> Quickhull<'a> {
    /// A tetrahedron of points that lie far apart.
    fn new(points: &'a [DVec3]) -> Result<Self, HullError> {
        let count = points.len();
        if count < 4 {
            return Err(HullError::TooFew { points: count });
        }
        let largest = points
            .iter()
            .fold(0.0, |m: f64, p| m.max(p.abs().max_element()));
        let first = points[0];
        let extent = points
            .iter()
            .fold(0.0, |m: f64, p| m.max(p.distance(first)));
        let strange = |x: &f64| !(SMALLEST..=FARTHEST).contains(x);
        if let Some(extent) = [largest, extent].into_iter().find(strange) {
            return Err(HullError::Extent { extent });
        }
        let mut quickhull = Self {
            points,
            facets: Vec::new(),
            left: HashMap::new(),
            extent,
        };
        let all = || 0..count;
        let b = quickhull.farthest(all(), 0, |p| p.distance(first));
        let along = (points[b] - first).normalize();
        let c = quickhull.farthest(all(), 0, |p| (p - first).cross(along).length());
        let normal = (points[c] - first).cross(along).normalize_or_zero();
        let d = quickhull.farthest(all(), 0, |p| (p - first).dot(normal).abs());
        let thickness = (points[d] - first).dot(normal).abs();
        let [b, c] = if quickhull.above([0, b, c], d) > 0.0 {
            [c, b]
        } else {
            [b, c]
        };
        if thickness <= NEAR * extent || quickhull.above([0, b, c], d) == 0.0 {
            return Err(HullError::Flat {
                points: count,
                thickness,
                extent,
            });
        }
        for corners in [[0, b, c], [b, 0, d], [c, b, d], [0, c, d]] {
            quickhull.add(corners);
        }
        quickhull.assign(all().collect(), 0);
        Ok(quickhull)
    }

    /// The point that is largest by a convex measure. Of equal ones that farthest from `from`, which
    /// is a corner of them all.
    fn farthest(
        &self,
        among: impl Iterator<Item = usize>,
        from: usize,
        measure: impl Fn(DVec3) -> f64,
    ) -> usize {
        let origin = self.points[from];
        let convex = |p: DVec3| measure(p) + 1e-3 * p.distance_squared(origin) / self.extent;
        let larger = |(i, x): (usize, f64), (j, y): (usize, f64)| {
            if y > x { (j, y) } else { (i, x) }
        };
        let measured = among.map(|i| (i, convex(self.points[i])));
        measured.fold((from, f64::NEG_INFINITY), larger).0
    }

    /// Six times the volume of the tetrahedron [m³], of exact sign: positive where the point is
    /// above the triangle, which then runs counter-clockwise.
    fn above(&self, [a, b, c]: [usize; 3], point: usize) -> f64 {
        let [a, b, c, p] = [a, b, c, point].map(|i| {
            let DVec3 { x, y, z } = self.points[i];
            Coord3D { x, y, z }
        });
        -orient3d(a, b, c, p)
    }

    fn add(&mut self, corners: [usize; 3]) {
        let [a, b, c] = corners.map(|i| self.points[i]);
        let facet = Facet {
            corners,
            area: (b - a).cross(c - a).length(),
            outside: Vec::new(),
            stands: true,
        };
        for edge in facet.edges() {
            self.left.insert(edge, self.facets.len());
        }
        self.facets.push(facet);
    }

    /// Gives points to those facets from `first` on that they are farthest above; drops the others.
    fn assign(&mut self, points: Vec<usize>, first: usize) {
        for point in points {
            let height = |f: usize| {
                let facet = &self.facets[f];
                self.above(facet.corners, point) / facet.area
            };
            let heights = (first..self.facets.len()).map(|f| (f, height(f)));
            let highest = heights.max_by(|a, b| a.1.total_cmp(&b.1));
            if let Some((facet, _)) = highest.filter(|h| h.1 > NEAR * self.extent) {
                self.facets[facet].outside.push(point);
            }
        }
    }

    fn run(&mut self) {
        let mut next = 0;
        while next < self.facets.len() {
            let facet = &self.facets[next];
            if facet.stands && !facet.outside.is_empty() {
                let corners = facet.corners;
                let outside = facet.outside.iter().copied();
                let height = |p: DVec3| {
                    let [a, b, c] = corners.map(|i| self.points[i]);
                    (b - a).cross(c - a).dot(p - a) / facet.area
                };
                let point = self.farthest(outside, corners[0], height);
                self.reach(next, point);
            }
            next += 1;
        }
    }

    /// Takes a point into the hull that sees a facet.
    fn reach(&mut self, facet: usize, point: usize) {
        let (mut seen, mut horizon, mut orphans) = (vec![facet], Vec::new(), Vec::new());
        self.facets[facet].stands = false;
        let mut next = 0;
        while next < seen.len() {
            for [a, b] in self.facets[seen[next]].edges() {
                let beyond = self.left[&[b, a]];
                if !self.facets[beyond].stands {
                    continue;
                }
                if self.above(self.facets[beyond].corners, point) > 0.0 {
                    self.facets[beyond].stands = false;
                    seen.push(beyond);
                } else {
                    horizon.push([a, b]);
                }
            }
            next += 1;
        }
        for facet in seen {
            orphans.append(&mut self.facets[facet].outside);
        }
        let first = self.facets.len();
        for [a, b] in horizon {
            self.add([a, b, point]);
        }
        self.assign(orphans, first);
    }

    /// The facets that stand, and their corners.
    fn hull(&self) -> Result<Hull, HullError> {
        let facets = self.facets.iter().filter(|facet| facet.stands);
        let mut used: Vec<_> = facets.clone().flat_map(|facet| facet.corners).collect();
        used.sort_unstable();
        used.dedup();
        if used.len() > MOST_CORNERS {
            return Err(HullError::TooManyCorners {
                corners: used.len(),
                most: MOST_CORNERS,
            });
        }
        let number = |i: usize| used.partition_point(|u| *u < i) as u32;
        let triangles = facets.map(|facet| facet.corners.map(number)).collect();
        let vertices = used.iter().map(|i| self.points[*i]).collect();
        Ok(Hull::closed(vertices, triangles))
    }
}
