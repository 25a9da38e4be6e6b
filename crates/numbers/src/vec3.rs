//! Vectors of three numbers.

use crate::Real;
use core::ops::{Add, AddAssign, Mul, Neg, Sub, SubAssign};

/// A vector (x, y, z).
#[derive(Clone, Copy, Debug, PartialEq, Default)]
#[allow(missing_docs)]
pub struct Vec3<R> {
    pub x: R,
    pub y: R,
    pub z: R,
}

impl<R: Real> Vec3<R> {
    /// From components.
    #[inline(always)]
    pub fn new(x: R, y: R, z: R) -> Self {
        Self { x, y, z }
    }
    /// All components equal.
    #[inline(always)]
    pub fn splat(x: R) -> Self {
        Self::new(x, x, x)
    }
    /// The null vector.
    #[inline(always)]
    pub fn zero() -> Self {
        Self::splat(R::zero())
    }
    /// The absolute value of each component.
    #[inline(always)]
    pub fn abs(self) -> Self {
        Self::new(self.x.abs(), self.y.abs(), self.z.abs())
    }
    /// Inner product.
    #[inline(always)]
    pub fn dot(self, b: Self) -> R {
        self.x.fma(b.x, self.y.fma(b.y, self.z * b.z))
    }
    /// `self · b + c`, which is ready sooner than the product and then a sum.
    #[inline(always)]
    pub fn dot_plus(self, b: Self, c: R) -> R {
        self.x.fma(b.x, self.y.fma(b.y, self.z.fma(b.z, c)))
    }
    /// Vector product `self × b`.
    #[inline(always)]
    pub fn cross(self, b: Self) -> Self {
        Self::new(
            self.y.fma(b.z, -(self.z * b.y)),
            self.z.fma(b.x, -(self.x * b.z)),
            self.x.fma(b.y, -(self.y * b.x)),
        )
    }
    /// `self × b + c`.
    #[inline(always)]
    pub fn cross_plus(self, b: Self, c: Self) -> Self {
        Self::new(
            self.y.fma(b.z, self.z.fnma(b.y, c.x)),
            self.z.fma(b.x, self.x.fnma(b.z, c.y)),
            self.x.fma(b.y, self.y.fnma(b.x, c.z)),
        )
    }
    /// `self · s + c`.
    #[inline(always)]
    pub fn fma(self, s: R, c: Self) -> Self {
        Self::new(self.x.fma(s, c.x), self.y.fma(s, c.y), self.z.fma(s, c.z))
    }
    /// Componentwise product.
    #[inline(always)]
    pub fn times(self, b: Self) -> Self {
        Self::new(self.x * b.x, self.y * b.y, self.z * b.z)
    }
    /// Squared length.
    #[inline(always)]
    pub fn length_squared(self) -> R {
        self.dot(self)
    }
    /// Length.
    #[inline(always)]
    pub fn length(self) -> R {
        self.length_squared().sqrt()
    }
    /// Unit vector along `self`, or `otherwise` where the length is below 1e-12.
    #[inline(always)]
    pub fn normalized_or(self, otherwise: Self) -> Self {
        let n2 = self.length_squared();
        let tiny = R::lit(1e-24);
        let ok = n2.gt(tiny);
        let s = n2.max(tiny).sqrt().recip();
        Self::select(ok, self * s, otherwise)
    }
    /// Some unit vector at a right angle to the unit vector `self`.
    ///
    /// Crosses with the axis to which `self` is least parallel.
    #[inline(always)]
    pub fn any_orthogonal(self) -> Self {
        let (x, y, z) = (self.x.abs(), self.y.abs(), self.z.abs());
        let use_x = x.le(y) & x.le(z);
        let use_y = !use_x & y.le(z);
        let (o, i) = (R::zero(), R::one());
        let axis = Self::new(
            R::select(use_x, i, o),
            R::select(use_y, i, o),
            R::select(!use_x & !use_y, i, o),
        );
        self.cross(axis).normalized_or(axis)
    }
    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            R::select(mask, yes.x, no.x),
            R::select(mask, yes.y, no.y),
            R::select(mask, yes.z, no.z),
        )
    }
    /// Components in order.
    #[inline(always)]
    pub fn to_array(self) -> [R; 3] {
        [self.x, self.y, self.z]
    }
    /// From components in order.
    #[inline(always)]
    pub fn from_array([x, y, z]: [R; 3]) -> Self {
        Self { x, y, z }
    }
}

impl<R: Real> Add for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.x + b.x, self.y + b.y, self.z + b.z)
    }
}

impl<R: Real> Sub for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.x - b.x, self.y - b.y, self.z - b.z)
    }
}

impl<R: Real> Mul<R> for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, s: R) -> Self {
        Self::new(self.x * s, self.y * s, self.z * s)
    }
}

impl<R: Real> Neg for Vec3<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

impl<R: Real> AddAssign for Vec3<R> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl<R: Real> SubAssign for Vec3<R> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}
