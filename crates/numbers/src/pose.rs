//! Position and orientation together.

use crate::{Quat, Real, Vec3};
use core::ops::Mul;

/// A rigid placement: rotate by `q`, then translate by `p`.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Pose<R> {
    /// Position [m].
    pub p: Vec3<R>,
    /// Orientation, a unit quaternion.
    pub q: Quat<R>,
}

impl<R: Real> Pose<R> {
    /// From position and orientation.
    #[inline(always)]
    pub fn new(p: Vec3<R>, q: Quat<R>) -> Self {
        Self { p, q }
    }
    /// At the origin, unturned.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::new(Vec3::zero(), Quat::identity())
    }
    /// A point of this frame, in the outer frame.
    #[inline(always)]
    pub fn point(self, x: Vec3<R>) -> Vec3<R> {
        self.q.rotate(x) + self.p
    }
    /// The placement that undoes this one.
    #[inline(always)]
    pub fn inverse(self) -> Self {
        let q = self.q.conjugate();
        Self::new(-q.rotate(self.p), q)
    }
}

impl<R: Real> Mul for Pose<R> {
    type Output = Self;
    /// First `b`, then `self`.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self::new(self.point(b.p), self.q * b.q)
    }
}
