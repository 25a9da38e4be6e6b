//! Which triangles may come into a box that stands at any angle.
//!
//! Two convex solids are apart where a plane lies between them. Of the planes that may (Gottschalk, Lin & Manocha
//! 1996, "OBBTree", name those of two boxes) these are tried: the triangle's own, those through its edges at a right
//! angle to it, and the sides of the box. So a few pass that are apart, by planes along an edge of each.

use super::Triangle;
use glam::{DMat3, DVec3};

/// A box in the frame of a mesh.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientedBox {
    /// Where its middle is, from that of the mesh [m].
    pub center: DVec3,
    /// Its axes, unit vectors, as columns.
    pub axes: DMat3,
    /// Half of its sizes along them [m].
    pub half: DVec3,
}

impl OrientedBox {
    /// False only where it and a triangle are apart.
    pub fn may_meet(&self, t: &Triangle) -> bool {
        let to_box = self.axes.transpose();
        let width = |d: DVec3| (to_box * d).abs().dot(self.half);
        let corners = t.corners().map(|corner| corner - self.center);
        let (normal, edges) = (t.normal(), t.edges());
        let off_plane = normal.dot(corners[0]).abs() > width(normal);
        let beyond = |edge: usize| -edges[edge].dot(corners[edge]) > width(edges[edge]);
        if off_plane || (0..3).any(beyond) {
            return false;
        }
        let [a, b, c] = corners.map(|corner| to_box * corner);
        let meets = a.min(b).min(c).cmple(self.half) & a.max(b).max(c).cmpge(-self.half);
        meets.all()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use model::TriangleMesh;

    /// All that have a point in the box pass, and most of those that only the box about it meets do not.
    #[test]
    fn what_meets_passes() {
        let mut random = fastrand::Rng::with_seed(5);
        let mut vector = || DVec3::from_array([0; 3].map(|_| 2.0 * random.f64() - 1.0));
        let (mut meet, mut pass, mut near) = (0, 0, 0);
        for _ in 0..20_000 {
            let corners = [0; 3].map(|_| vector());
            let Ok(mesh) = TriangleMesh::new(&corners, &[[0, 1, 2]]) else {
                continue;
            };
            let triangle = Triangle::all(&mesh)[0];
            let around = OrientedBox {
                center: vector(),
                axes: DMat3::from_quat(DQuat::from_scaled_axis(3.0 * vector())),
                half: 0.02 + 0.4 * vector().abs(),
            };
            let [a, b, c] = triangle.corners();
            let inside = |p: DVec3| {
                let p = around.axes.transpose() * (p - around.center);
                p.abs().cmple(around.half).all()
            };
            let points = (0..=20).flat_map(|i| (0..=20 - i).map(move |j| (i, j)));
            let point = |(i, j): (i32, i32)| {
                let (s, t) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                a + s * (b - a) + t * (c - a)
            };
            let meets = points.map(point).any(inside);
            let passes = around.may_meet(&triangle);
            assert!(passes || !meets, "{around:?} {triangle:?}");
            let [low, high] = triangle.bounds();
            let half = around.axes.abs() * around.half;
            let boxes = low.cmple(around.center + half) & high.cmpge(around.center - half);
            meet += usize::from(meets);
            pass += usize::from(passes);
            near += usize::from(boxes.all());
        }
        assert!(
            meet > 1000 && pass - meet < (near - meet) / 2,
            "{meet} of {pass} of {near}"
        );
    }
}
