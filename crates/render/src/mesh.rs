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
        let sheared = Sheared::new(line);
        let crosses = |triangle: usize| {
            let distance = sheared.crosses(self.corners[triangle])?;
            let front = self.normals[triangle].dot(line.direction) < 0.0;
            (distance > from && distance < to && front).then_some(distance)
        };
        let test = |t: u32, _: &Cast, _: f32| Some((crosses(t as usize)? - from) as f32);
        let hit = self.tree.cast(&self.cast(line, from, to)?, &test)?;
        let triangle = hit.object as usize;
        Some((crosses(triangle)?, self.normals[triangle]))
    }

    /// Whether a line crosses any triangle, from either side, between two distances [m].
    pub fn any(&self, line: &Line, from: f64, to: f64) -> bool {
        let sheared = Sheared::new(line);
        let crosses = |triangle: u32, _: &Cast, _: f32| {
            let distance = sheared.crosses(self.corners[triangle as usize])?;
            // At the start, so that none is looked for before it.
            (distance > from && distance < to).then_some(0.0)
        };
        let cast = self.cast(line, from, to);
        cast.is_some_and(|cast| self.tree.cast(&cast, &crosses).is_some())
    }

    /// What finds the triangles that may be crossed; its time is from the first distance on.
    fn cast(&self, line: &Line, from: f64, to: f64) -> Option<Cast> {
        let origin = line.origin + from * line.direction;
        let slack = ROUNDING * (origin.abs().max_element() + self.reach);
        let (start, direction) = (origin.as_vec3(), line.direction.as_vec3());
        let cast = Cast::aabb(start, Vec3::splat(slack as f32), direction).ok()?;
        Some(cast.until(((to - from) as f32).next_up()))
    }
}
