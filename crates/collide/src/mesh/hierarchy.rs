//! Triangles in the order of a tree, cut into groups of clusters of triangles.
//!
//! A kernel in lanes cannot follow pointers, but it can skip: three nested loops, each left out
//! where no lane's solid is near, find the near ones of n triangles in some n^(1/3) tests a level.

use crate::ray::Line;
use glam::DVec3;
use model::TriangleMesh;

/// A box along the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    const EMPTY: Self = Self {
        low: DVec3::INFINITY,
        high: DVec3::NEG_INFINITY,
    };
    /// Low, then high.
    pub fn numbers(&self) -> [f64; 6] {
        let ([a, b, c], [d, e, f]) = (self.low.to_array(), self.high.to_array());
        [a, b, c, d, e, f]
    }
    pub fn and(self, other: Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
        }
    }
    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        let point = |p| Self { low: p, high: p };
        points.into_iter().map(point).fold(Self::EMPTY, Self::and)
    }
    pub fn all(bounds: impl IntoIterator<Item = Self>) -> Self {
        bounds.into_iter().fold(Self::EMPTY, Self::and)
    }
    /// Whether a line passes through, from its origin on.
    pub fn meets(&self, line: &Line) -> bool {
        let (o, d) = (line.origin, line.direction);
        let (mut enter, mut leave) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let (low, high) = (self.low[axis] - o[axis], self.high[axis] - o[axis]);
            if d[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low / d[axis], high / d[axis]);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
        enter <= leave
    }
}

/// Bounds of a triangle.
pub(crate) fn bounds(mesh: &TriangleMesh, triangle: usize) -> Bounds {
    Bounds::of(mesh.corners(triangle))
}

/// The triangles so that neighbours in the list are neighbours in space: split at the median of
/// the longest side, again and again.
pub(crate) fn order(mesh: &TriangleMesh) -> Vec<usize> {
    let middle = |t: usize| {
        let b = bounds(mesh, t);
        (b.low + b.high) * 0.5
    };
    let middles: Vec<_> = (0..mesh.triangles().len()).map(middle).collect();
    let mut order: Vec<_> = (0..middles.len()).collect();
    split(&mut order, &middles);
    order
}

fn split(order: &mut [usize], middles: &[DVec3]) {
    if order.len() <= 2 {
        return;
    }
    let Bounds { low, high } = Bounds::of(order.iter().map(|&t| middles[t]));
    let side = high - low;
    let axis = (0..3).fold(0, |best, i| if side[i] > side[best] { i } else { best });
    let half = order.len() / 2;
    order.select_nth_unstable_by(half, |&a, &b| {
        middles[a][axis]
            .total_cmp(&middles[b][axis])
            .then(a.cmp(&b))
    });
    let (left, right) = order.split_at_mut(half);
    split(left, middles);
    split(right, middles);
}

/// How many triangles a cluster has, and how many clusters a group.
pub(crate) fn fan(triangles: usize) -> usize {
    ((triangles as f64).cbrt().ceil() as usize).max(4)
}
