//! Points and boxes swept along a line.
//!
//! A box with half extents h that moves from o by t·d meets a resting box just
//! when the point o + t·d meets the resting box grown by h (the Minkowski sum).
//! So a ray cast, a box cast and a sphere cast are one query. Per axis, the grown
//! box is entered and left at
//!
//! ```text
//! t = (min − (o + h)) / d   and   t = (max − (o − h)) / d,
//! ```
//!
//! and it is hit where the latest entry precedes the earliest exit (Kay and
//! Kajiya 1986). Traversals multiply by 1/d instead, and allow for the rounding
//! as Ize 2013, "Robust BVH ray traversal", does: they may visit a box in vain
//! but miss none that [`Cast::against`] hits.

use crate::{Aabb, SpaceError};
use glam::Vec3;

/// A ray, or a shape that moves without turning.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cast {
    origin: Vec3,
    direction: Vec3,
    half: Vec3,
    limit: f32,
}

impl Cast {
    /// A ray from `origin` [m] along `direction` (any length).
    ///
    /// Times are in units of `direction`: at time t the ray is at `origin + t · direction`.
    /// A component of `direction` that is smaller than 10⁻¹² of the largest is taken as 0.
    ///
    /// # Errors
    /// A number is NaN or infinite, `origin` is beyond 10¹⁵ m, or the largest
    /// component of `direction` is outside 10⁻¹²…10¹².
    pub fn ray(origin: Vec3, direction: Vec3) -> Result<Self, SpaceError> {
        Self::aabb(origin, Vec3::ZERO, direction)
    }

    /// A sphere about `center` with `radius` [m]. A test (see [`CastTest`](crate::CastTest))
    /// decides on exact hits; candidates are found by the box about the sphere.
    ///
    /// # Errors
    /// As [`ray`](Cast::ray), or `radius` is negative or not finite.
    pub fn sphere(center: Vec3, radius: f32, direction: Vec3) -> Result<Self, SpaceError> {
        Self::aabb(center, Vec3::splat(radius), direction)
    }

    /// A box about `center` with half extents `half` [m].
    ///
    /// # Errors
    /// As [`ray`](Cast::ray), or a half extent is negative or not finite.
    #[inline]
    pub fn aabb(center: Vec3, half: Vec3, direction: Vec3) -> Result<Self, SpaceError> {
        let refuse = |what, value: Vec3, remedy| {
            let value = value.to_string();
            Err(SpaceError::Query {
                what,
                value,
                remedy,
            })
        };
        if !Aabb::new(center, center).is_bounded() {
            return refuse("origin", center, "finite, and within 1e15 m");
        }
        if !Aabb::new(Vec3::ZERO, half).is_bounded() || half.min_element() < 0.0 {
            return refuse("half extent", half, "finite and not negative");
        }
        let longest = direction.abs().max_element();
        if direction.is_nan() || !(1e-12..=1e12).contains(&longest) {
            return refuse("direction", direction, "finite and about of unit length");
        }
        let negligible = direction.abs().cmplt(Vec3::splat(1e-12 * longest));
        Ok(Self {
            origin: center,
            direction: Vec3::select(negligible, Vec3::ZERO, direction),
            half,
            limit: f32::MAX,
        })
    }

    /// The same, but hits later than `limit` do not count. Without it, none is too late.
    #[must_use]
    pub fn until(mut self, limit: f32) -> Self {
        self.limit = limit.min(f32::MAX);
        self
    }

    /// Where it starts [m]: the ray's origin, the shape's centre.
    pub fn origin(&self) -> Vec3 {
        self.origin
    }
    /// What it moves by in unit time [m].
    pub fn direction(&self) -> Vec3 {
        self.direction
    }
    /// Half extents [m]; 0 for a ray.
    pub fn half(&self) -> Vec3 {
        self.half
    }
    /// Hits later than this do not count.
    pub fn limit(&self) -> f32 {
        self.limit
    }
    /// Where it is at a time [m].
    pub fn at(&self, time: f32) -> Vec3 {
        self.origin + time * self.direction
    }

    /// The first time, at least 0 and at most `limit`, at which it touches the box.
    pub fn against(&self, aabb: &Aabb, limit: f32) -> Option<f32> {
        let upper = self.origin + self.half;
        let lower = self.origin - self.half;
        let (mut enter, mut leave) = (0.0_f32, limit);
        for axis in 0..3 {
            let d = self.direction[axis];
            if d == 0.0 {
                if !(aabb.min[axis] <= upper[axis] && aabb.max[axis] >= lower[axis]) {
                    return None;
                }
                continue;
            }
            let a = (aabb.min[axis] - upper[axis]) / d;
            let b = (aabb.max[axis] - lower[axis]) / d;
            let (first, last) = if d > 0.0 { (a, b) } else { (b, a) };
            enter = enter.max(first);
            leave = leave.min(last);
        }
        (enter <= leave).then_some(enter)
    }
}

/// Covers the few roundings between a traversal's times and exact ones.
pub(crate) const SLACK: f32 = 1.0 + 1.0 / (1 << 20) as f32;

/// A cast made ready for many boxes: per axis, entry `(min − upper)·inverse` and
/// exit `(max − lower)·inverse` (or the other way round), rounded outwards.
#[derive(Clone, Copy, Debug)]
pub struct Sweep {
    pub(crate) upper: Vec3,
    pub(crate) lower: Vec3,
    pub(crate) inverse: Vec3,
}

impl Sweep {
    #[inline]
    pub(crate) fn new(cast: &Cast) -> Self {
        let Cast {
            origin: o,
            direction: d,
            half: h,
            ..
        } = *cast;
        let rests = d.cmpeq(Vec3::ZERO);
        // Along an axis of no motion all times are inside or none is: the pad,
        // times the largest number, is later than any time.
        let pad = Vec3::select(rests, (o.abs() + h) * 1e-6 + 1e-9, Vec3::ZERO);
        Self {
            upper: (o + h).map(f32::next_up) + pad,
            lower: (o - h).map(f32::next_down) - pad,
            inverse: Vec3::select(rests, Vec3::MAX, d.recip()),
        }
    }

    /// Where it moves to in unit time.
    pub(crate) fn direction(&self) -> Vec3 {
        Vec3::select(
            self.inverse.cmpeq(Vec3::MAX),
            Vec3::ZERO,
            self.inverse.recip(),
        )
    }

    /// A lower bound of the time at which the box, which is not inside out, is met, if
    /// it may be met by `limit`.
    #[inline(always)]
    pub(crate) fn enters(&self, aabb: &Aabb, limit: f32) -> Option<f32> {
        let a = (aabb.min - self.upper) * self.inverse;
        let b = (aabb.max - self.lower) * self.inverse;
        let enter = a.min(b).max_element().max(0.0);
        let leave = a.max(b).min_element().min(limit);
        (enter <= leave * SLACK).then_some(enter)
    }
}
