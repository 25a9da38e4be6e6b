//! Boxes along the axes.

use glam::{DVec3, Vec3};

/// An axis-aligned box, faces included, in metres.
///
/// It may have no extent, and it may be unbounded: a half-space `y ≤ 0` has
/// `min = −∞` and `max = (∞, 0, ∞)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Lower corner.
    pub min: Vec3,
    /// Upper corner; nowhere below `min`.
    pub max: Vec3,
}

impl Aabb {
    /// Contains nothing, overlaps nothing; the neutral element of [`union`](Aabb::union).
    pub const EMPTY: Self = Self {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
    };

    /// From lower to upper corner.
    #[inline]
    pub const fn new(min: Vec3, max: Vec3) -> Self {
        Self { min, max }
    }

    /// About a centre, with half extents.
    #[inline]
    pub fn around(center: Vec3, half: Vec3) -> Self {
        Self::new(center - half, center + half)
    }

    /// The smallest box in single precision that holds one in double precision.
    pub fn enclosing(min: DVec3, max: DVec3) -> Self {
        let below = |x: f64| {
            if f64::from(x as f32) > x {
                (x as f32).next_down()
            } else {
                x as f32
            }
        };
        let above = |x: f64| -below(-x);
        Self::new(
            Vec3::new(below(min.x), below(min.y), below(min.z)),
            Vec3::new(above(max.x), above(max.y), above(max.z)),
        )
    }

    /// The smallest box that holds both.
    #[inline]
    pub fn union(&self, other: &Self) -> Self {
        Self::new(self.min.min(other.min), self.max.max(other.max))
    }

    /// Whether they have a point in common; touching counts.
    #[inline]
    pub fn overlaps(&self, other: &Self) -> bool {
        // `&`, not `&&`: six comparisons are cheaper than a mispredicted branch.
        (self.min.x <= other.max.x)
            & (self.max.x >= other.min.x)
            & (self.min.y <= other.max.y)
            & (self.max.y >= other.min.y)
            & (self.min.z <= other.max.z)
            & (self.max.z >= other.min.z)
    }

    /// Whether it holds all of another.
    #[inline]
    pub fn contains(&self, other: &Self) -> bool {
        (self.min.cmple(other.min) & self.max.cmpge(other.max)).all()
    }

    /// Grown by `margin` [m] on every side.
    #[inline]
    pub fn padded(&self, margin: f32) -> Self {
        Self::new(self.min - margin, self.max + margin)
    }

    /// The middle.
    #[inline]
    pub fn center(&self) -> Vec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// Length of each edge.
    #[inline]
    pub fn extent(&self) -> Vec3 {
        self.max - self.min
    }

    /// Half of the surface: the chance that a random line meets the box is
    /// proportional to it. Negative extents count as none.
    #[inline]
    pub fn half_area(&self) -> f32 {
        let e = self.extent().max(Vec3::ZERO);
        e.x * e.y + e.y * e.z + e.z * e.x
    }

    /// The point of the box nearest to `point`.
    #[inline]
    pub fn closest_point(&self, point: Vec3) -> Vec3 {
        point.max(self.min).min(self.max)
    }

    /// Square of the distance from `point` to the box; 0 inside.
    #[inline]
    pub fn distance_squared(&self, point: Vec3) -> f32 {
        point.distance_squared(self.closest_point(point))
    }

    /// No coordinate is NaN, or so large that its square is not a number.
    #[inline]
    pub(crate) fn is_bounded(&self) -> bool {
        let most = Vec3::splat(FARTHEST);
        (self.min.abs().cmple(most) & self.max.abs().cmple(most)).all()
    }
}

/// Boxes that reach farther [m] count as unbounded.
pub(crate) const FARTHEST: f32 = 1e15;
