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
            self.angular.cross(m.linear) + self.linear.cross(m.angular),
        )
    }
    /// Motion ×* force (2.32): (ω × n + v × f, ω × f).
    #[inline(always)]
    pub fn cross_force(self, f: Self) -> Self {
        Self::new(
            self.angular.cross(f.angular) + self.linear.cross(f.linear),
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
    /// A rigid body of mass `m` [kg] whose centre lies at `c` [m] from the point,
    /// with inertia `i` [kg·m²] about its centre: I = i + m (c·c 1 − c cᵀ), H = m c×.
    #[inline(always)]
    pub fn rigid(m: R, c: Vec3<R>, i: SymMat3<R>) -> Self {
        let mc = c * m;
        let steiner = SymMat3::diagonal(mc.dot(c)) - SymMat3::outer(c, m);
        Self {
            i: i + steiner,
            h: Mat3::skew(mc),
            m: SymMat3::diagonal(m),
        }
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
            self.i * v.angular + self.h * v.linear,
            self.h.transpose_mul(v.angular) + self.m * v.linear,
        )
    }
    /// Solves self · a = f for a positive definite inertia by Cholesky's L D Lᵀ; pivots below
    /// `tiny` count as `tiny`.
    #[allow(clippy::needless_range_loop)] // rows and columns, as the algorithm is written
    #[inline(always)]
    pub fn solve(self, f: Spatial<R>, tiny: R) -> Spatial<R> {
        let (i, h, m) = (self.i, self.h, self.m);
        // Lower triangle, the linear rows first: below it lies Hᵀ, whose rows are H's columns.
        let mut l = [
            [m.xx, R::zero(), R::zero(), R::zero(), R::zero(), R::zero()],
            [m.xy, m.yy, R::zero(), R::zero(), R::zero(), R::zero()],
            [m.xz, m.yz, m.zz, R::zero(), R::zero(), R::zero()],
            [h.x.x, h.y.x, h.z.x, i.xx, R::zero(), R::zero()],
            [h.x.y, h.y.y, h.z.y, i.xy, i.yy, R::zero()],
            [h.x.z, h.y.z, h.z.z, i.xz, i.yz, i.zz],
        ];
        let [nx, ny, nz] = f.angular.to_array();
        let [fx, fy, fz] = f.linear.to_array();
        let mut x = [fx, fy, fz, nx, ny, nz];
        for p in 0..6 {
            let inverse = l[p][p].max(tiny).recip();
            for row in p + 1..6 {
                let factor = l[row][p] * inverse;
                for column in p + 1..=row {
                    l[row][column] = factor.fnma(l[column][p], l[row][column]);
                }
                x[row] = factor.fnma(x[p], x[row]);
            }
            // L below the pivot; the pivot's row of x divided by D.
            for row in p + 1..6 {
                l[row][p] *= inverse;
            }
            x[p] *= inverse;
        }
        for row in (0..6).rev() {
            for below in row + 1..6 {
                x[row] = l[below][row].fnma(x[below], x[row]);
            }
        }
        let [fx, fy, fz, nx, ny, nz] = x;
        Spatial::new(Vec3::new(nx, ny, nz), Vec3::new(fx, fy, fz))
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
