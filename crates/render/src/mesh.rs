//! Triangles as rays meet them.

use collide::ray::{Line, Sheared};
use glam::{DVec3, Vec3};
use model::TriangleMesh;
use space::{Aabb, Bvh, Cast, Space};

/// Triangles about the middle of their mesh, and a tree of boxes about them.
#[derive(Debug)]
pub(crate) struct Triangles {
    corners: Vec<[DVec3; 3]>,
    normals: Vec<DVec3>,
    tree: Space<Bvh>,
    /// No coordinate is larger [m].
    reach: f64,
}

/// In single precision origin, direction and times are off by so large a share of all lengths, at
/// most. (Each rounds by 6e-8.)
const ROUNDING: f64 = 1e-6;

impl Triangles {
    pub fn new(mesh: &TriangleMesh) -> Self {
        let all = 0..mesh.triangles().len();
        let centered = |t: usize| mesh.corners(t).map(|p| p - mesh.center());
        let corners: Vec<_> = all.clone().map(centered).collect();
        let around = |[a, b, c]: &[DVec3; 3]| Aabb::enclosing(a.min(*b).min(*c), a.max(*b).max(*c));
        let boxes: Vec<_> = corners.iter().map(around).collect();
        Self {
            corners,
            normals: all.map(|t| mesh.normal(t)).collect(),
            tree: Space::new(&boxes).expect("the vertices of a mesh are finite"),
            reach: mesh.half_extents().max_element(),
        }
    }

    /// Corners [m], from the middle of the mesh, and the unit vector out of each triangle.
    #[cfg(feature = "gpu")]
    pub fn all(&self) -> impl Iterator<Item = ([DVec3; 3], DVec3)> {
        self.corners
            .iter()
            .copied()
            .zip(self.normals.iter().copied())
    }

    /// Where a line from the middle's neighbourhood first crosses a triangle's front between two
    /// distances [m], and the front's normal.
    pub fn first(&self, line: &Line, from: f64, to: f64) -> Option<(f64, DVec3)> {
        let front = |t: usize| self.normals[t].dot(line.direction) < 0.0;
        let (triangle, distance) = self.nearest(line, from, to, front)?;
        Some((distance, self.normals[triangle]))
    }

    /// Whether a line crosses any triangle, from either side, between two distances [m].
    pub fn any(&self, line: &Line, from: f64, to: f64) -> bool {
        self.nearest(line, from, to, |_| true).is_some()
    }

    fn nearest(
        &self,
        line: &Line,
        from: f64,
        to: f64,
        counts: impl Fn(usize) -> bool + Sync,
    ) -> Option<(usize, f64)> {
        let sheared = Sheared::new(line);
        let origin = line.origin + from * line.direction;
        let slack = ROUNDING * (origin.abs().max_element() + self.reach);
        let (start, direction) = (origin.as_vec3(), line.direction.as_vec3());
        let cast = Cast::aabb(start, Vec3::splat(slack as f32), direction).ok()?;
        let crosses = |triangle: usize| {
            let distance = sheared.crosses(self.corners[triangle])?;
            (distance > from && distance < to && counts(triangle)).then_some(distance)
        };
        let test =
            |triangle: u32, _: &Cast, _: f32| Some((crosses(triangle as usize)? - from) as f32);
        let cast = cast.until(((to - from) as f32).next_up());
        let triangle = self.tree.cast(&cast, &test)?.object as usize;
        Some((triangle, crosses(triangle)?))
    }
}
