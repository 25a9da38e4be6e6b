//! Forward derivatives.
//!
//! A dual number a + b ε, with ε² = 0, carries a value and its derivative along one
//! direction through a computation (Clifford 1873; Griewank & Walther, *Evaluating
//! Derivatives*, 2nd ed. 2008, chapter 3). Where a function has a kink or a pole
//! the slope is that of the branch taken, and finite where that is possible:
//!
//! - `min`, `max`, `clamp` and `select` take the slope of the number they take;
//! - `abs` has the slope +1 at +0, and −1 at −0;
//! - `sqrt` has the slope 0 at 0, so that the length of a null vector, and `acos`
//!   at ±1, spread no infinities;
//! - `floor` and `round` have the slope 0, as has the exponent of `frexp`.
//!
//! Elementary functions are differentiated through their polynomials: slopes are
//! right to 2e-6 in `f32` and 1e-14 in `f64`, relative to the larger of the slope
//! and 1 (`tests/dual.rs`).

use crate::{Known, Real};
use core::ops::{Add, AddAssign, Div, Mul, MulAssign, Neg, Sub, SubAssign};

/// Value and derivative: a + b ε with ε² = 0. Comparisons look at the value alone.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Dual<R> {
    /// The value.
    pub value: R,
    /// The derivative along one direction.
    pub slope: R,
}

impl<R: Real> Dual<R> {
    /// From value and slope.
    #[inline(always)]
    pub fn new(value: R, slope: R) -> Self {
        Self { value, slope }
    }
    /// A number that does not vary.
    #[inline(always)]
    pub fn constant(value: R) -> Self {
        Self::new(value, R::zero())
    }
    /// The number along which to differentiate: slope 1.
    #[inline(always)]
    pub fn variable(value: R) -> Self {
        Self::new(value, R::one())
    }
}

impl<R: Real> Add for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self::new(self.value + b.value, self.slope + b.slope)
    }
}

impl<R: Real> Sub for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self::new(self.value - b.value, self.slope - b.slope)
    }
}

impl<R: Real> Mul for Dual<R> {
    type Output = Self;
    /// (a b)′ = a b′ + a′ b.
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        let slope = self.value.fma(b.slope, self.slope * b.value);
        Self::new(self.value * b.value, slope)
    }
}

impl<R: Real> Div for Dual<R> {
    type Output = Self;
    /// (a / b)′ = (a′ − (a / b) b′) / b.
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        let q = self.value / b.value;
        Self::new(q, q.fnma(b.slope, self.slope) / b.value)
    }
}

impl<R: Real> Neg for Dual<R> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self::new(-self.value, -self.slope)
    }
}

impl<R: Real> AddAssign for Dual<R> {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl<R: Real> SubAssign for Dual<R> {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

impl<R: Real> MulAssign for Dual<R> {
    #[inline(always)]
    fn mul_assign(&mut self, b: Self) {
        *self = *self * b;
    }
}

impl<R: Real> Real for Dual<R> {
    type Scalar = R::Scalar;
    type Mask = R::Mask;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::constant(R::lit(x))
    }
    #[inline(always)]
    fn splat(x: R::Scalar) -> Self {
        Self::constant(R::splat(x))
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        let slope = self.value.fma(b.slope, self.slope.fma(b.value, c.slope));
        Self::new(self.value.fma(b.value, c.value), slope)
    }
    /// (√a)′ = a′ / (2 √a).
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let zero = root.same(R::zero());
        let slope = self.slope / R::select(zero, R::one(), root + root);
        Self::new(root, R::select(zero, R::zero(), slope))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        let sign = R::one().copysign(self.value);
        Self::new(self.value.abs(), self.slope * sign)
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        let slope = R::select(self.value.lt(other.value), self.slope, other.slope);
        Self::new(self.value.min(other.value), slope)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        let slope = R::select(self.value.gt(other.value), self.slope, other.slope);
        Self::new(self.value.max(other.value), slope)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self::constant(self.value.round())
    }
    /// The slope turns over where the sign does.
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let turn = R::one().copysign(self.value) * R::one().copysign(sign.value);
        Self::new(self.value.copysign(sign.value), self.slope * turn)
    }
    /// (a 2ⁿ)′ = a′ 2ⁿ: `n` is whole, hence constant.
    #[inline(always)]
    fn ldexp(self, n: Self) -> Self {
        Self::new(self.value.ldexp(n.value), self.slope.ldexp(n.value))
    }
    /// m = a 2⁻ᵉ, hence m′ = a′ 2⁻ᵉ.
    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let (m, e) = self.value.frexp();
        (Self::new(m, self.slope.ldexp(-e)), Self::constant(e))
    }
    #[inline(always)]
    fn lt(self, other: Self) -> R::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn le(self, other: Self) -> R::Mask {
        self.value.le(other.value)
    }
    #[inline(always)]
    fn same(self, other: Self) -> R::Mask {
        self.value.same(other.value)
    }
    #[inline(always)]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self::new(
            R::select(mask, yes.value, no.value),
            R::select(mask, yes.slope, no.slope),
        )
    }
}

impl<R: Known> Known for Dual<R> {
    #[inline(always)]
    fn first(self) -> R::Scalar {
        self.value.first()
    }
}
