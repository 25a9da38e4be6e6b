//! The number a kernel is written over.

use crate::rows::{Atom, LANES, Quad};
use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// A truth value per lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// The same truth in every lane.
    fn splat(value: bool) -> Self;
}

/// A real number, or several side by side, or a record of one.
///
/// Every operation is branch-free. On one machine all readings of one
/// precision give the same bits, so each operation pins its rounding: the four
/// operations, [`sqrt`](Real::sqrt) and [`fma`](Real::fma) round once, to
/// nearest even. Where the hardware has no fused multiply-add, `fma` is a
/// product and a sum, rounded twice, in every reading on that machine.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
{
    /// The number in one lane: `f32` or `f64`.
    type Scalar: Float;
    /// The outcome of a comparison.
    type Mask: Mask;

    /// A literal, rounded to the precision of the lane.
    fn lit(x: f64) -> Self;
    /// The same number in every lane.
    fn splat(x: Self::Scalar) -> Self;

    /// `self · b + c`.
    fn fma(self, b: Self, c: Self) -> Self;
    /// Square root; NaN below zero.
    fn sqrt(self) -> Self;
    /// Absolute value: clears the sign bit.
    fn abs(self) -> Self;
    /// `self` where `self < other`, else `other` (so `other` where either is NaN).
    fn min(self, other: Self) -> Self;
    /// `self` where `self > other`, else `other` (so `other` where either is NaN).
    fn max(self, other: Self) -> Self;
    /// Largest whole number not above `self`.
    fn floor(self) -> Self;
    /// Nearest whole number, ties to even.
    fn round(self) -> Self;
    /// Magnitude of `self` with the sign bit of `sign`.
    fn copysign(self, sign: Self) -> Self;
    /// `self · 2ⁿ` for a whole `n`; exact while operand and result are normal.
    ///
    /// `n` beyond ±252 (`f32`) or ±2044 (`f64`) is clamped.
    fn ldexp(self, n: Self) -> Self;
    /// `(m, e)` with `self = m · 2ᵉ` and `|m|` in `[1, 2)`, for a normal number.
    fn frexp(self) -> (Self, Self);

    /// `self < other`; false where either is NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// `self <= other`; false where either is NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// `self == other`; false where either is NaN.
    fn same(self, other: Self) -> Self::Mask;
    /// `yes` where `mask` holds, else `no`. Both are evaluated.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// `self > other`; false where either is NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// `self >= other`; false where either is NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// Zero.
    #[inline(always)]
    fn zero() -> Self {
        Self::lit(0.0)
    }
    /// One.
    #[inline(always)]
    fn one() -> Self {
        Self::lit(1.0)
    }
    /// `self` kept within `[low, high]`.
    #[inline(always)]
    fn clamp(self, low: Self, high: Self) -> Self {
        self.max(low).min(high)
    }
    /// `self²`.
    #[inline(always)]
    fn squared(self) -> Self {
        self * self
    }
    /// `1 / self`.
    #[inline(always)]
    fn recip(self) -> Self {
        Self::one() / self
    }
    /// `c − self · b`.
    #[inline(always)]
    fn fnma(self, b: Self, c: Self) -> Self {
        (-self).fma(b, c)
    }
}

/// The scalar types lanes are made of: `f32` and `f64`.
pub trait Float:
    Real<Scalar = Self, Mask = bool> + Lanes + PartialOrd + Default + Send + Sync + 'static
{
    /// True for `f64`: functions choose the longer polynomial.
    const DOUBLE: bool;
    /// How many worlds stand side by side in one block: 16 for `f32`, 8 for `f64`.
    const BLOCK: usize;
    /// Lanes for AVX-512.
    #[cfg(target_arch = "x86_64")]
    type Avx512: Lanes<Scalar = Self>;
    /// Lanes for AVX2 with FMA.
    #[cfg(target_arch = "x86_64")]
    type Avx2: Lanes<Scalar = Self>;
    /// Lanes for NEON.
    #[cfg(target_arch = "aarch64")]
    type Neon: Lanes<Scalar = Self>;
    /// Lanes for WebAssembly's 128-bit vectors.
    #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
    type Simd128: Lanes<Scalar = Self>;
    /// Lanes for any machine, without a fused multiply-add.
    type Portable: Lanes<Scalar = Self>;
    /// One lane without a fused multiply-add.
    type Unfused: Lanes<Scalar = Self>;
    /// The same number, shared by threads.
    type Atom: Atom<Self>;
    /// As `f64`, exactly.
    fn to_f64(self) -> f64;
    /// From `f64`, rounded to nearest.
    fn from_f64(x: f64) -> Self;
    /// Neither infinite nor NaN.
    fn finite(self) -> bool;
}

/// A [`Mask`] whose truth is known now, not merely recorded.
pub trait LanesMask: Mask {
    /// True in at least one lane.
    fn any(self) -> bool;
    /// True in every lane.
    fn all(self) -> bool;
}

/// A [`Real`] whose value is known now, not merely recorded.
pub trait Known: Real<Mask: LanesMask> {
    /// The number in the first lane.
    fn first(self) -> Self::Scalar;
}

/// A [`Real`] that lives in memory as `WIDTH` neighbouring scalars.
pub trait Lanes: Real<Mask: LanesMask> + bytemuck::Pod {
    /// Number of lanes.
    const WIDTH: usize;
    /// A quad of a row for each lane, as a register for each of its numbers. Rows beyond the lanes are not read.
    ///
    /// # Panics
    /// If rows have no such quad.
    #[inline(always)]
    fn load_quads<const Q: usize>(
        rows: &[&[Quad<Self::Scalar>; Q]; LANES],
        quad: usize,
    ) -> [Self; 4] {
        let mut columns = [Self::zero(); 4];
        let numbers: &mut [Self::Scalar] = bytemuck::cast_slice_mut(&mut columns);
        for lane in 0..Self::WIDTH {
            let row = rows[lane][quad].load();
            for i in 0..4 {
                numbers[i * Self::WIDTH + lane] = row[i];
            }
        }
        columns
    }
    /// Writes them back.
    ///
    /// # Panics
    /// If rows have no such quad.
    #[inline(always)]
    fn store_quads<const Q: usize>(
        columns: [Self; 4],
        rows: &[&[Quad<Self::Scalar>; Q]; LANES],
        quad: usize,
    ) {
        let numbers: &[Self::Scalar] = bytemuck::cast_slice(&columns);
        for lane in 0..Self::WIDTH {
            let width = Self::WIDTH;
            let (a, b) = (numbers[lane], numbers[width + lane]);
            let (c, d) = (numbers[2 * width + lane], numbers[3 * width + lane]);
            rows[lane][quad].store([a, b, c, d]);
        }
    }
}

impl<R: Lanes> Known for R {
    #[inline(always)]
    fn first(self) -> R::Scalar {
        bytemuck::cast_slice(&[self])[0]
    }
}
