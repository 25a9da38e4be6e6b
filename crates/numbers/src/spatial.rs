//! Six-dimensional vectors and inertias, about one point and in one frame.
//!
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), chapter 2. The angular
//! part comes first. Everything is expressed in world axes about one inertial
//! point, so that no transforms are needed between bodies.

use crate::{Mat3, Real, SymMat3, Vec3};
use core::ops::{Add, Mul, Neg, Sub};

/// A motion vector (ω, v) or a force vector (n, f).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Spatial<R> {
    /// Angular velocity [rad/s], or moment [N·m].
    pub angular: Vec3<R>,
    /// Linear velocity at the reference point [m/s], or force [N].
    pub linear: Vec3<R>,
}

impl<R: Real> Spatial<R> {
    /// From both parts.
    #[inline(always)]
    pub fn new(angular: Vec3<R>, linear: Vec3<R>) -> Self {
        Self { angular, linear }
    }
    /// The null vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(Vec3::zero(), Vec3::zero())
    }
    /// From the angular and the linear components.
    #[inline(always)]
    pub fn from_array([a, b, c, x, y, z]: [R; 6]) -> Self {
        Self::new(Vec3::new(a, b, c), Vec3::new(x, y, z))
    }
    /// The angular and the linear components.
    #[inline(always)]
    pub fn to_array(self) -> [R; 6] {
        let (a, l) = (self.angular, self.linear);
        [a.x, a.y, a.z, l.x, l.y, l.z]
    }
    /// Power of a force on a motion.
    #[inline(always)]
    pub fn dot(self, b: Self) -> R {
        self.angular.dot(b.angular) + self.linear.dot(b.linear)
    }
    /// [`dot`](Self::dot) plus `c`, which is ready sooner than the two one after the other.
    #[inline(always)]
    pub fn dot_plus(self, b: Self, c: R) -> R {
        self.angular.dot_plus(b.angular, c) + self.linear.dot(b.linear)
    }
    /// `self · s + c`.
    #[inline(always)]
    pub fn fma(self, s: R, c: Self) -> Self {
        Self::new(self.angular.fma(s, c.angular), self.linear.fma(s, c.linear))
    }
    /// Motion × motion (2.31): (ω × m, ω × m₀ + v × m).
    #[inline(always)]
    pub fn cross_motion(self, m: Self) -> Self {
        Self::new(
            self.angular.cross(m.angular),
            self.angular
                .cross_plus(m.linear, self.linear.cross(m.angular)),
        )
    }
    /// [`cross_motion`](Self::cross_motion) plus `c`.
    #[inline(always)]
    pub fn cross_motion_plus(self, m: Self, c: Self) -> Self {
        let turned = self.linear.cross_plus(m.angular, c.linear);
        Self::new(
            self.angular.cross_plus(m.angular, c.angular),
            self.angular.cross_plus(m.linear, turned),
        )
    }
    /// Motion ×* force (2.32): (ω × n + v × f, ω × f).
    #[inline(always)]
    pub fn cross_force(self, f: Self) -> Self {
        Self::new(
            self.angular
                .cross_plus(f.angular, self.linear.cross(f.linear)),
            self.angular.cross(f.linear),
        )
    }
}

impl<R: Real> Add for Spatial<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.angular + b.angular, self.linear + b.linear)
    }
}

impl<R: Real> Sub for Spatial<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.angular - b.angular, self.linear - b.linear)
    }
}

impl<R: Real> Mul<R> for Spatial<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Self::new(self.angular * s, self.linear * s)
    }
}

impl<R: Real> Neg for Spatial<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.angular, -self.linear)
    }
}

/// A symmetric 6 × 6 inertia, rigid or articulated:
///
/// ```text
/// ⎡ I   H ⎤   moment   ← angular, linear
/// ⎣ Hᵀ  M ⎦   force
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Inertia<R> {
    /// Rotational block I [kg·m²].
    pub i: SymMat3<R>,
    /// Coupling block H [kg·m].
    pub h: Mat3<R>,
    /// Mass block M [kg].
    pub m: SymMat3<R>,
}

impl<R: Real> Inertia<R> {
    /// Of nothing.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::from_array([R::zero(); 21])
    }
    /// A rigid body of mass `m` [kg] whose centre lies at `c` [m] from the point,
    /// with inertia `i` [kg·m²] about its centre: I = i + m (c·c 1 − c cᵀ), H = m c×.
    #[inline(always)]
    pub fn rigid(m: R, c: Vec3<R>, i: SymMat3<R>) -> Self {
        let mc = c * m;
        let about_point = SymMat3 {
            xx: mc.y.fma(c.y, mc.z.fma(c.z, i.xx)),
            yy: mc.x.fma(c.x, mc.z.fma(c.z, i.yy)),
            zz: mc.x.fma(c.x, mc.y.fma(c.y, i.zz)),
            xy: mc.x.fnma(c.y, i.xy),
            xz: mc.x.fnma(c.z, i.xz),
            yz: mc.y.fnma(c.z, i.yz),
        };
        Self::from_moments(m, mc, about_point)
    }
    /// A rigid body by its mass [kg], and the first [kg·m] and second [kg·m²] moments of it about the point.
    #[inline(always)]
    pub fn from_moments(m: R, mc: Vec3<R>, i: SymMat3<R>) -> Self {
        Self {
            i,
            h: Mat3::skew(mc),
            m: SymMat3::diagonal(m),
        }
    }
    /// The first moment of mass [kg·m] of what is rigid.
    #[inline(always)]
    pub fn first_moment(self) -> Vec3<R> {
        Vec3::new(self.h.y.z, self.h.z.x, self.h.x.y)
    }
    /// From I, the columns of H, and M.
    #[inline(always)]
    pub fn from_array(x: [R; 21]) -> Self {
        let [
            a,
            b,
            c,
            d,
            e,
            f,
            h0,
            h1,
            h2,
            h3,
            h4,
            h5,
            h6,
            h7,
            h8,
            u,
            v,
            w,
            p,
            q,
            r,
        ] = x;
        Self {
            i: SymMat3::from_array([a, b, c, d, e, f]),
            h: Mat3::from_columns(
                Vec3::new(h0, h1, h2),
                Vec3::new(h3, h4, h5),
                Vec3::new(h6, h7, h8),
            ),
            m: SymMat3::from_array([u, v, w, p, q, r]),
        }
    }
    /// I, the columns of H, and M.
    #[inline(always)]
    pub fn to_array(self) -> [R; 21] {
        let [a, b, c, d, e, f] = self.i.to_array();
        let [u, v, w, p, q, r] = self.m.to_array();
        let (x, y, z) = (self.h.x, self.h.y, self.h.z);
        [
            a, b, c, d, e, f, x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z, u, v, w, p, q, r,
        ]
    }
    /// Inertia times motion: a force.
    #[inline(always)]
    pub fn apply(self, v: Spatial<R>) -> Spatial<R> {
        Spatial::new(
            self.i.mul_plus(v.angular, self.h * v.linear),
            self.h.transpose_mul_plus(v.angular, self.m * v.linear),
        )
    }
    /// Solves self · (α, a) = (n, f) for a positive definite inertia; pivots below `tiny` count as
    /// `tiny`. The linear block is eliminated first:
    ///
    /// ```text
    /// X = M⁻¹ Hᵀ      (I − H X) α = n − Xᵀ f      a = M⁻¹ f − X α
    /// ```
    #[inline(always)]
    pub fn solve(self, f: Spatial<R>, tiny: R) -> Spatial<R> {
        let (i, h, m) = (self.i, self.h, self.m.factor(tiny));
        let rows = h.transpose();
        let x = Mat3::from_columns(m.solve(rows.x), m.solve(rows.y), m.solve(rows.z));
        let left = SymMat3 {
            xx: (-rows.x).dot_plus(x.x, i.xx),
            yy: (-rows.y).dot_plus(x.y, i.yy),
            zz: (-rows.z).dot_plus(x.z, i.zz),
            xy: (-rows.x).dot_plus(x.y, i.xy),
            xz: (-rows.x).dot_plus(x.z, i.xz),
            yz: (-rows.y).dot_plus(x.z, i.yz),
        };
        let turn = x.transpose_mul_plus(-f.linear, f.angular);
        let angular = left.solve(turn, tiny);
        Spatial::new(angular, x.mul_plus(-angular, m.solve(f.linear)))
    }
    /// `self − u uᵀ s`.
    #[inline(always)]
    pub fn minus_outer(self, u: Spatial<R>, s: R) -> Self {
        let (n, f) = (u.angular, u.linear);
        let t = -(f * s);
        Self {
            i: self.i.minus_outer(n, s),
            h: Mat3::from_columns(
                n.fma(t.x, self.h.x),
                n.fma(t.y, self.h.y),
                n.fma(t.z, self.h.z),
            ),
            m: self.m.minus_outer(f, s),
        }
    }
}

impl<R: Real> Add for Inertia<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self {
            i: self.i + b.i,
            h: Mat3::from_columns(self.h.x + b.h.x, self.h.y + b.h.y, self.h.z + b.h.z),
            m: self.m + b.m,
        }
    }
}
