//! Matrices of three by three: general, and symmetric.

use crate::{Real, Vec3};
use core::ops::{Add, Mul, Sub};

/// A matrix by columns.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Mat3<R> {
    pub x: Vec3<R>,
    pub y: Vec3<R>,
    pub z: Vec3<R>,
}

impl<R: Real> Mat3<R> {
    /// From columns.
    #[inline(always)]
    pub fn from_columns(x: Vec3<R>, y: Vec3<R>, z: Vec3<R>) -> Self {
        Self { x, y, z }
    }
    /// The unit matrix.
    #[inline(always)]
    pub fn identity() -> Self {
        let (o, i) = (R::zero(), R::one());
        Self::from_columns(Vec3::new(i, o, o), Vec3::new(o, i, o), Vec3::new(o, o, i))
    }
    /// The matrix of `v ×`.
    #[inline(always)]
    pub fn skew(v: Vec3<R>) -> Self {
        let o = R::zero();
        Self::from_columns(
            Vec3::new(o, v.z, -v.y),
            Vec3::new(-v.z, o, v.x),
            Vec3::new(v.y, -v.x, o),
        )
    }
    /// The transpose.
    #[inline(always)]
    pub fn transpose(self) -> Self {
        Self::from_columns(
            Vec3::new(self.x.x, self.y.x, self.z.x),
            Vec3::new(self.x.y, self.y.y, self.z.y),
            Vec3::new(self.x.z, self.y.z, self.z.z),
        )
    }
    /// Transpose times vector.
    #[inline(always)]
    pub fn transpose_mul(self, v: Vec3<R>) -> Vec3<R> {
        Vec3::new(self.x.dot(v), self.y.dot(v), self.z.dot(v))
    }
    /// `self · v + c`.
    #[inline(always)]
    pub fn mul_plus(self, v: Vec3<R>, c: Vec3<R>) -> Vec3<R> {
        self.x.fma(v.x, self.y.fma(v.y, self.z.fma(v.z, c)))
    }
    /// Solves M x = b by Cramer's rule, for a well-conditioned M with a positive determinant; those below `tiny` count
    /// as `tiny`.
    #[inline(always)]
    pub fn solve_well(self, b: Vec3<R>, tiny: R) -> Vec3<R> {
        let dual = Self::from_columns(
            self.y.cross(self.z),
            self.z.cross(self.x),
            self.x.cross(self.y),
        );
        dual.transpose_mul(b) * self.x.dot(dual.x).max(tiny).recip()
    }
    /// `selfᵀ · v + c`.
    #[inline(always)]
    pub fn transpose_mul_plus(self, v: Vec3<R>, c: Vec3<R>) -> Vec3<R> {
        Vec3::new(
            self.x.dot_plus(v, c.x),
            self.y.dot_plus(v, c.y),
            self.z.dot_plus(v, c.z),
        )
    }
}

impl<R: Real> Mul<Vec3<R>> for Mat3<R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn mul(self, v: Vec3<R>) -> Vec3<R> {
        self.x.fma(v.x, self.y.fma(v.y, self.z * v.z))
    }
}

impl<R: Real> Mul for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self::from_columns(self * b.x, self * b.y, self * b.z)
    }
}

impl<R: Real> Sub for Mat3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::from_columns(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

/// A symmetric matrix: six numbers.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct SymMat3<R> {
    pub xx: R,
    pub yy: R,
    pub zz: R,
    pub xy: R,
    pub xz: R,
    pub yz: R,
}

impl<R: Real> SymMat3<R> {
    /// From the diagonal (xx, yy, zz) and the off-diagonal (xy, xz, yz).
    #[inline(always)]
    pub fn new(diagonal: Vec3<R>, off: Vec3<R>) -> Self {
        Self {
            xx: diagonal.x,
            yy: diagonal.y,
            zz: diagonal.z,
            xy: off.x,
            xz: off.y,
            yz: off.z,
        }
    }
    /// From xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    pub fn from_array([xx, yy, zz, xy, xz, yz]: [R; 6]) -> Self {
        Self {
            xx,
            yy,
            zz,
            xy,
            xz,
            yz,
        }
    }
    /// Sum of the diagonal.
    #[inline(always)]
    pub fn trace(self) -> R {
        self.xx + self.yy + self.zz
    }
    /// xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    pub fn to_array(self) -> [R; 6] {
        [self.xx, self.yy, self.zz, self.xy, self.xz, self.yz]
    }
    /// The null matrix.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::new(Vec3::zero(), Vec3::zero())
    }
    /// `s` on the diagonal.
    #[inline(always)]
    pub fn diagonal(s: R) -> Self {
        Self::new(Vec3::splat(s), Vec3::zero())
    }
    /// All entries times `s`.
    #[inline(always)]
    pub fn scaled(self, s: R) -> Self {
        Self {
            xx: self.xx * s,
            yy: self.yy * s,
            zz: self.zz * s,
            xy: self.xy * s,
            xz: self.xz * s,
            yz: self.yz * s,
        }
    }
    /// `v vᵀ · s`.
    #[inline(always)]
    pub fn outer(v: Vec3<R>, s: R) -> Self {
        let t = v * s;
        Self {
            xx: v.x * t.x,
            yy: v.y * t.y,
            zz: v.z * t.z,
            xy: v.x * t.y,
            xz: v.x * t.z,
            yz: v.y * t.z,
        }
    }
    /// `self − v vᵀ · s`.
    #[inline(always)]
    pub fn minus_outer(self, v: Vec3<R>, s: R) -> Self {
        let t = v * s;
        Self {
            xx: v.x.fnma(t.x, self.xx),
            yy: v.y.fnma(t.y, self.yy),
            zz: v.z.fnma(t.z, self.zz),
            xy: v.x.fnma(t.y, self.xy),
            xz: v.x.fnma(t.z, self.xz),
            yz: v.y.fnma(t.z, self.yz),
        }
    }
    /// R D Rᵀ for a diagonal D: a matrix with eigenvalues `d` along the columns of `r`.
    #[inline(always)]
    pub fn rotated_diagonal(r: Mat3<R>, d: Vec3<R>) -> Self {
        Self::outer(r.x, d.x) + Self::outer(r.y, d.y) + Self::outer(r.z, d.z)
    }
    /// R S Rᵀ.
    #[inline(always)]
    pub fn rotated(self, r: Mat3<R>) -> Self {
        // B = R S; then the six entries of B Rᵀ.
        let (sx, sy, sz) = self.columns();
        let (bx, by, bz) = (r * sx, r * sy, r * sz);
        let b = [
            Vec3::new(bx.x, by.x, bz.x),
            Vec3::new(bx.y, by.y, bz.y),
            Vec3::new(bx.z, by.z, bz.z),
        ];
        let rt = r.transpose();
        Self {
            xx: b[0].dot(rt.x),
            yy: b[1].dot(rt.y),
            zz: b[2].dot(rt.z),
            xy: b[0].dot(rt.y),
            xz: b[0].dot(rt.z),
            yz: b[1].dot(rt.z),
        }
    }
    /// The columns.
    #[inline(always)]
    pub fn columns(self) -> (Vec3<R>, Vec3<R>, Vec3<R>) {
        (
            Vec3::new(self.xx, self.xy, self.xz),
            Vec3::new(self.xy, self.yy, self.yz),
            Vec3::new(self.xz, self.yz, self.zz),
        )
    }
    /// `self · v + c`.
    #[inline(always)]
    pub fn mul_plus(self, v: Vec3<R>, c: Vec3<R>) -> Vec3<R> {
        self.to_mat3().mul_plus(v, c)
    }
    /// As a general matrix.
    #[inline(always)]
    pub fn to_mat3(self) -> Mat3<R> {
        let (x, y, z) = self.columns();
        Mat3::from_columns(x, y, z)
    }
    /// Solves S x = b by Cramer's rule, with one division; determinants below `tiny` count as `tiny`.
    ///
    /// For well-conditioned S; [`solve`](SymMat3::solve) loses less where S is nearly singular.
    #[inline(always)]
    pub fn solve_well(self, b: Vec3<R>, tiny: R) -> Vec3<R> {
        let c = Self {
            xx: self.yz.fnma(self.yz, self.yy * self.zz),
            yy: self.xz.fnma(self.xz, self.xx * self.zz),
            zz: self.xy.fnma(self.xy, self.xx * self.yy),
            xy: self.xy.fnma(self.zz, self.xz * self.yz),
            xz: self.xz.fnma(self.yy, self.xy * self.yz),
            yz: self.yz.fnma(self.xx, self.xy * self.xz),
        };
        let determinant = self.xx.fma(c.xx, self.xy.fma(c.xy, self.xz * c.xz));
        (c * b) * determinant.max(tiny).recip()
    }
    /// Cholesky's L D Lᵀ of a positive definite S; pivots below `tiny` count as `tiny`.
    #[inline(always)]
    pub fn factor(self, tiny: R) -> Cholesky3<R> {
        let d0 = self.xx.max(tiny).recip();
        let l1 = self.xy * d0;
        let l2 = self.xz * d0;
        let d1 = l1.fnma(self.xy, self.yy).max(tiny).recip();
        let t = l1.fnma(self.xz, self.yz);
        let l3 = t * d1;
        let d2 = l3.fnma(t, l2.fnma(self.xz, self.zz)).max(tiny).recip();
        Cholesky3 {
            inverse_d: Vec3::new(d0, d1, d2),
            l: Vec3::new(l1, l2, l3),
        }
    }
    /// Solves S x = b for a positive definite S; pivots below `tiny` count as `tiny`.
    #[inline(always)]
    pub fn solve(self, b: Vec3<R>, tiny: R) -> Vec3<R> {
        self.factor(tiny).solve(b)
    }
}

/// A positive definite matrix as L D Lᵀ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cholesky3<R> {
    inverse_d: Vec3<R>,
    /// Below the diagonal of ones: yx, zx, zy.
    l: Vec3<R>,
}

impl<R: Real> Cholesky3<R> {
    /// Solves L D Lᵀ x = b.
    #[inline(always)]
    pub fn solve(self, b: Vec3<R>) -> Vec3<R> {
        let (d, l) = (self.inverse_d, self.l);
        let y1 = l.x.fnma(b.x, b.y);
        let y2 = l.z.fnma(y1, l.y.fnma(b.x, b.z));
        let z = y2 * d.z;
        let y = l.z.fnma(z, y1 * d.y);
        let x = l.x.fnma(y, l.y.fnma(z, b.x * d.x));
        Vec3::new(x, y, z)
    }
}

impl<R: Real> Mul<Vec3<R>> for SymMat3<R> {
    type Output = Vec3<R>;
    #[inline(always)]
    fn mul(self, v: Vec3<R>) -> Vec3<R> {
        let (x, y, z) = self.columns();
        x.fma(v.x, y.fma(v.y, z * v.z))
    }
}

impl<R: Real> Add for SymMat3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self {
            xx: self.xx + b.xx,
            yy: self.yy + b.yy,
            zz: self.zz + b.zz,
            xy: self.xy + b.xy,
            xz: self.xz + b.xz,
            yz: self.yz + b.yz,
        }
    }
}

impl<R: Real> Sub for SymMat3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self {
            xx: self.xx - b.xx,
            yy: self.yy - b.yy,
            zz: self.zz - b.zz,
            xy: self.xy - b.xy,
            xz: self.xz - b.xz,
            yz: self.yz - b.yz,
        }
    }
}
