//! Convex hulls of points, and convex pieces of meshes: both are a user's explicit choice.

use crate::mesh::TriangleMesh;
use glam::DVec3;
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::{try_convex_hull, vhacd};

/// A convex solid with flat faces.
#[derive(Clone, Debug, PartialEq)]
pub struct ConvexHull {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// Why points have no convex hull.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HullError {
    /// A coordinate is infinite or not a number.
    #[error("point {point} of the hull is at {position}: give finite coordinates")]
    NotFinite {
        /// Which point.
        point: usize,
        /// Its coordinates.
        position: DVec3,
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
         give it a thickness, or use a mesh"
    )]
    Flat {
        /// How many points there are.
        points: usize,
        /// Their distance from a plane [m].
        thickness: f64,
        /// Their distance from each other [m].
        extent: f64,
    },
    /// The computation gave up.
    #[error(
        "the convex hull of {points} points cannot be computed: {reason}; remove points that almost coincide"
    )]
    Failed {
        /// How many points there are.
        points: usize,
        /// What was found wrong.
        reason: String,
    },
}

/// Thickness, against the extent, below which points lie in a plane.
const FLAT: f64 = 1e-9;

impl ConvexHull {
    /// Of points [m]; those inside are dropped.
    ///
    /// # Errors
    /// Numbers that are not finite, fewer than four different points, or points in one plane.
    pub fn new(points: &[DVec3]) -> Result<Self, HullError> {
        if let Some(point) = points.iter().position(|p| !p.is_finite()) {
            let position = points[point];
            return Err(HullError::NotFinite { point, position });
        }
        let mut different = points.to_vec();
        different.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).expect("finite"));
        different.dedup();
        let points = different.len();
        if points < 4 {
            return Err(HullError::TooFew { points });
        }
        let (thickness, extent) = thickness(&different);
        if thickness <= FLAT * extent {
            return Err(HullError::Flat {
                points,
                thickness,
                extent,
            });
        }
        let input: Vec<_> = different
            .iter()
            .map(|p| Vector::new(p.x, p.y, p.z))
            .collect();
        let failed = |reason: String| HullError::Failed { points, reason };
        let (vertices, triangles) = try_convex_hull(&input).map_err(|e| failed(e.to_string()))?;
        let vertices = vertices.iter().map(|v| DVec3::new(v.x, v.y, v.z)).collect();
        Ok(Self {
            vertices,
            triangles,
        })
    }

    /// Corners [m].
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }
    /// Faces as triangles, counter-clockwise as seen from outside.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
    /// The same about the middle of its bounding box, and that middle [m]. Kernels take the
    /// origin of a hull's frame to be inside of it.
    pub fn centered(&self) -> (Self, DVec3) {
        let (low, high) = bounds(&self.vertices);
        let middle = (low + high) * 0.5;
        let vertices = self.vertices.iter().map(|v| *v - middle).collect();
        let triangles = self.triangles.clone();
        (
            Self {
                vertices,
                triangles,
            },
            middle,
        )
    }
    /// Half extents of the bounding box of a hull that is [`centered`](Self::centered) [m]: its size for
    /// the kernels.
    pub fn half_extents(&self) -> DVec3 {
        let (low, high) = bounds(&self.vertices);
        high.max(-low)
    }
}

impl TriangleMesh {
    /// The convex hull of all vertices: what was hollow is filled.
    ///
    /// # Errors
    /// A mesh that lies in one plane.
    pub fn convex_hull(&self) -> Result<ConvexHull, HullError> {
        ConvexHull::new(self.vertices())
    }

    /// Convex pieces that together are nearly the mesh: approximate convex decomposition (Mamou &
    /// Ghorbel, A simple and efficient approach for 3D mesh approximate convex decomposition, ICIP 2009).
    ///
    /// `concavity` in 0…1 is how much hollowness a piece may keep, and `resolution` the number of
    /// voxels along the longest side; 0.01 and 64 are good first choices. Pieces without
    /// thickness are left out.
    ///
    /// # Errors
    /// No piece has a thickness.
    pub fn convex_decomposition(
        &self,
        concavity: f64,
        resolution: u32,
    ) -> Result<Vec<ConvexHull>, HullError> {
        let parameters = vhacd::VHACDParameters {
            concavity: concavity.clamp(0.0, 1.0),
            resolution: resolution.max(8),
            ..Default::default()
        };
        let vertices: Vec<_> = self
            .vertices()
            .iter()
            .map(|p| Vector::new(p.x, p.y, p.z))
            .collect();
        let found = vhacd::VHACD::decompose(&parameters, &vertices, self.triangles(), true);
        let pieces = found.compute_exact_convex_hulls(&vertices, self.triangles());
        let hull = |(corners, _): &(Vec<Vector>, Vec<[u32; 3]>)| {
            let corners: Vec<_> = corners.iter().map(|v| DVec3::new(v.x, v.y, v.z)).collect();
            ConvexHull::new(&corners)
        };
        let (hulls, errors): (Vec<_>, Vec<_>) = pieces.iter().map(hull).partition(Result::is_ok);
        let hulls: Vec<_> = hulls.into_iter().flatten().collect();
        match errors.into_iter().next() {
            Some(Err(error)) if hulls.is_empty() => Err(error),
            _ if hulls.is_empty() => Err(HullError::TooFew { points: 0 }),
            _ => Ok(hulls),
        }
    }
}

/// Lowest and highest coordinates.
fn bounds(points: &[DVec3]) -> (DVec3, DVec3) {
    let low = points.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = points.iter().copied().fold(DVec3::NEG_INFINITY, DVec3::max);
    (low, high)
}

/// How far points are from a plane through three of them that lie far apart, and from each other.
fn thickness(points: &[DVec3]) -> (f64, f64) {
    let first = points[0];
    let farthest = |measure: &dyn Fn(DVec3) -> f64| {
        let nearer = |a: DVec3, b: DVec3| if measure(a) < measure(b) { b } else { a };
        points.iter().copied().fold(first, nearer)
    };
    let second = farthest(&|p| (p - first).length());
    let extent = (second - first).length();
    let along = (second - first) / extent;
    let third = farthest(&|p| (p - first).cross(along).length());
    let normal = (third - first).cross(along).normalize_or_zero();
    let fourth = farthest(&|p| (p - first).dot(normal).abs());
    ((fourth - first).dot(normal).abs(), extent)
}
