//! Unit quaternions as orientations.

use crate::{Mat3, Real, Vec3, functions};
use core::ops::Mul;

/// A quaternion x i + y j + z k + w, stored x, y, z, w.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Quat<R> {
    pub x: R,
    pub y: R,
    pub z: R,
    pub w: R,
}

impl<R: Real> Quat<R> {
    /// From components.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R, w: R) -> Self {
        Self { x, y, z, w }
    }
    /// No rotation.
    #[inline(always)]
    pub fn identity() -> Self {
        Self::new(R::zero(), R::zero(), R::zero(), R::one())
    }
    /// From the vector part and the scalar part.
    #[inline(always)]
    pub fn from_parts(v: Vec3<R>, w: R) -> Self {
        Self::new(v.x, v.y, v.z, w)
    }
    /// The vector part.
    #[inline(always)]
    pub fn vector(self) -> Vec3<R> {
        Vec3::new(self.x, self.y, self.z)
    }
    /// Rotation by `angle` [rad] about the unit vector `axis`.
    #[inline(always)]
    pub fn from_axis_angle(axis: Vec3<R>, angle: R) -> Self {
        let (s, c) = functions::sin_cos(angle * R::lit(0.5));
        Self::from_parts(axis * s, c)
    }
    /// The inverse rotation.
    #[inline(always)]
    pub fn conjugate(self) -> Self {
        Self::new(-self.x, -self.y, -self.z, self.w)
    }
    /// Inner product of four-vectors.
    #[inline(always)]
    pub fn dot(self, b: Self) -> R {
        self.x
            .fma(b.x, self.y.fma(b.y, self.z.fma(b.z, self.w * b.w)))
    }
    /// Scaled to unit length; the identity where the length is below 1e-12.
    #[inline(always)]
    pub fn normalized(self) -> Self {
        let n2 = self.dot(self);
        let tiny = R::lit(1e-24);
        let s = n2.max(tiny).sqrt().recip();
        let ok = n2.gt(tiny);
        Self::new(
            self.x * s,
            self.y * s,
            self.z * s,
            R::select(ok, self.w * s, R::one()),
        )
    }
    /// `v` rotated: v + 2 w (u × v) + 2 u × (u × v), u the vector part.
    #[inline(always)]
    pub fn rotate(self, v: Vec3<R>) -> Vec3<R> {
        let u = self.vector();
        let t = u.cross(v);
        let t = t + t;
        u.cross_plus(t, t.fma(self.w, v))
    }
    /// `v` rotated by the inverse.
    #[inline(always)]
    pub fn rotate_inverse(self, v: Vec3<R>) -> Vec3<R> {
        self.conjugate().rotate(v)
    }
    /// The rotation matrix.
    #[inline(always)]
    pub fn to_mat3(self) -> Mat3<R> {
        let (x2, y2, z2) = (self.x + self.x, self.y + self.y, self.z + self.z);
        let (xx, yy, zz) = (self.x * x2, self.y * y2, self.z * z2);
        let (xy, xz, yz) = (self.x * y2, self.x * z2, self.y * z2);
        let (wx, wy, wz) = (self.w * x2, self.w * y2, self.w * z2);
        let i = R::one();
        Mat3::from_columns(
            Vec3::new(i - (yy + zz), xy + wz, xz - wy),
            Vec3::new(xy - wz, i - (xx + zz), yz + wx),
            Vec3::new(xz + wy, yz - wx, i - (xx + yy)),
        )
    }
    /// Rotation by the rotation vector `r` [rad]: exact, also for small `r`.
    #[inline(always)]
    pub fn exp(r: Vec3<R>) -> Self {
        let a2 = r.length_squared();
        let small = a2.lt(R::lit(1e-8));
        let a = R::select(small, R::one(), a2).sqrt();
        let (s, c) = functions::sin_cos(a * R::lit(0.5));
        // sin(a/2)/a = 1/2 − a²/48 + O(a⁴)
        let s = R::select(small, a2.fma(R::lit(-1.0 / 48.0), R::lit(0.5)), s / a);
        let c = R::select(small, a2.fma(R::lit(-0.125), R::one()), c);
        Self::from_parts(r * s, c)
    }
    /// [`exp`](Quat::exp) for short rotations: to rounding of `f32` for |r| ≤ 1, without a division.
    ///
    /// The series of sin(a/2)/a and cos(a/2) to a⁶.
    #[inline(always)]
    pub fn exp_short(r: Vec3<R>) -> Self {
        let x = r.length_squared();
        let s = x.fma(R::lit(-1.0 / 645_120.0), R::lit(1.0 / 3840.0));
        let s = x.fma(x.fma(s, R::lit(-1.0 / 48.0)), R::lit(0.5));
        let c = x.fma(R::lit(-1.0 / 46_080.0), R::lit(1.0 / 384.0));
        let c = x.fma(x.fma(c, R::lit(-0.125)), R::one());
        Self::from_parts(r * s, c)
    }
    /// Scaled to unit length in first order of |q|² − 1, without a division.
    #[inline(always)]
    pub fn nearly_normalized(self) -> Self {
        let s = self.dot(self).fma(R::lit(-0.5), R::lit(1.5));
        Self::new(self.x * s, self.y * s, self.z * s, self.w * s)
    }
    /// The rotation vector [rad] of the shorter way round, length at most π.
    #[inline(always)]
    pub fn log(self) -> Vec3<R> {
        let flip = self.w.lt(R::zero());
        let w = self.w.abs();
        let u = Vec3::select(flip, -self.vector(), self.vector());
        let n2 = u.length_squared();
        let small = n2.lt(R::lit(1e-30));
        let n = R::select(small, R::one(), n2).sqrt();
        let angle = R::lit(2.0) * functions::atan2(n, w);
        u * R::select(small, R::lit(2.0), angle / n)
    }
    /// Turned by angular velocity `w` [rad/s, world axes] for time `h` [s]: exp(h w) · self, normalised.
    #[inline(always)]
    pub fn integrate(self, w: Vec3<R>, h: R) -> Self {
        (Self::exp(w * h) * self).normalized()
    }
    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            R::select(mask, yes.x, no.x),
            R::select(mask, yes.y, no.y),
            R::select(mask, yes.z, no.z),
            R::select(mask, yes.w, no.w),
        )
    }
}

impl<R: Real> Mul for Quat<R> {
    type Output = Self;
    /// Hamilton product: first `b`, then `self`.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let a = self;
        Self::new(
            a.w.fma(b.x, a.x.fma(b.w, a.y.fma(b.z, -(a.z * b.y)))),
            a.w.fma(b.y, a.y.fma(b.w, a.z.fma(b.x, -(a.x * b.z)))),
            a.w.fma(b.z, a.z.fma(b.w, a.x.fma(b.y, -(a.y * b.x)))),
            a.w.fma(b.w, -(a.x.fma(b.x, a.y.fma(b.y, a.z * b.z)))),
        )
    }
}
