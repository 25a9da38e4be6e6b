//! Scalars as registers of one lane, and arrays of them: for any machine.
//!
//! There may be no fused multiply-add here, so `fma` rounds twice.

use super::{Register, Wide};
use crate::{LanesMask, Mask, Real};
use core::ops::{BitAnd, BitOr, Not};

/// `N` scalars; `Wide<T>` is one.
pub type Array<T, const N: usize> = Wide<[T; N]>;
/// Sixteen `f32`.
pub type F32x16 = Array<f32, 16>;
/// Eight `f64`.
pub type F64x8 = Array<f64, 8>;

macro_rules! scalar {
    ($t:ident, $mantissa:literal; unary $($unary:ident)+; binary $($binary:ident)+; compare $($lane:ident $scalar:ident)+) => {
        impl Register for $t {
            type Scalar = $t;
            type Mask = bool;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn splat(x: $t) -> Self {
                x
            }
            #[inline(always)]
            fn add(a: Self, b: Self) -> Self {
                a + b
            }
            #[inline(always)]
            fn sub(a: Self, b: Self) -> Self {
                a - b
            }
            #[inline(always)]
            fn mul(a: Self, b: Self) -> Self {
                a * b
            }
            #[inline(always)]
            fn div(a: Self, b: Self) -> Self {
                a / b
            }
            #[inline(always)]
            fn fma(a: Self, b: Self, c: Self) -> Self {
                a * b + c
            }
            $(#[inline(always)]
            fn $unary(a: Self) -> Self {
                Real::$unary(a)
            })+
            $(#[inline(always)]
            fn $binary(a: Self, b: Self) -> Self {
                Real::$binary(a, b)
            })+
            $(#[inline(always)]
            fn $lane(a: Self, b: Self) -> bool {
                Real::$scalar(a, b)
            })+
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                Real::select(mask, yes, no)
            }
            #[inline(always)]
            fn and(a: Self, b: Self) -> Self {
                $t::from_bits(a.to_bits() & b.to_bits())
            }
            #[inline(always)]
            fn or(a: Self, b: Self) -> Self {
                $t::from_bits(a.to_bits() | b.to_bits())
            }
            #[inline(always)]
            fn xor(a: Self, b: Self) -> Self {
                $t::from_bits(a.to_bits() ^ b.to_bits())
            }
            #[inline(always)]
            fn to_exponent(a: Self) -> Self {
                $t::from_bits(a.to_bits() << $mantissa)
            }
            #[inline(always)]
            fn from_exponent(a: Self) -> Self {
                $t::from_bits(a.to_bits() >> $mantissa)
            }
        }
    };
}

scalar!(f32, 23; unary sqrt floor round; binary min max; compare lt lt le le eq same);
scalar!(f64, 52; unary sqrt floor round; binary min max; compare lt lt le le eq same);

/// Instructions on each element.
macro_rules! each {
    ($($name:ident($first:ident $(, $arg:ident)*);)+) => {$(
        #[inline(always)]
        fn $name($first: Self $(, $arg: Self)*) -> Self {
            let mut out = $first;
            for i in 0..N {
                out[i] = V::$name($first[i] $(, $arg[i])*);
            }
            out
        }
    )+};
}

/// Comparisons of each element.
macro_rules! comparisons {
    ($($name:ident)+) => {$(
        #[inline(always)]
        fn $name(a: Self, b: Self) -> Self::Mask {
            let mut out = Each::splat(false);
            for i in 0..N {
                out.0[i] = V::$name(a[i], b[i]);
            }
            out
        }
    )+};
}

impl<V: Register, const N: usize> Register for [V; N] {
    type Scalar = V::Scalar;
    type Mask = Each<V::Mask, N>;
    const WIDTH: usize = N * V::WIDTH;

    #[inline(always)]
    fn splat(x: V::Scalar) -> Self {
        [V::splat(x); N]
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        let mut out = no;
        for i in 0..N {
            out[i] = V::select(mask.0[i], yes[i], no[i]);
        }
        out
    }
    each! {
        add(a, b);
        sub(a, b);
        mul(a, b);
        div(a, b);
        fma(a, b, c);
        sqrt(a);
        min(a, b);
        max(a, b);
        floor(a);
        round(a);
        and(a, b);
        or(a, b);
        xor(a, b);
        to_exponent(a);
        from_exponent(a);
    }
    comparisons! { lt le eq }
}

/// A truth per element.
#[derive(Clone, Copy, Debug)]
pub struct Each<M, const N: usize>([M; N]);

impl<M: Mask, const N: usize> BitAnd for Each<M, N> {
    type Output = Self;
    #[inline(always)]
    fn bitand(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] & other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> BitOr for Each<M, N> {
    type Output = Self;
    #[inline(always)]
    fn bitor(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] | other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Not for Each<M, N> {
    type Output = Self;
    #[inline(always)]
    fn not(mut self) -> Self {
        for i in 0..N {
            self.0[i] = !self.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Mask for Each<M, N> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([M::splat(value); N])
    }
}

impl<M: LanesMask, const N: usize> LanesMask for Each<M, N> {
    #[inline(always)]
    fn any(self) -> bool {
        let mut any = false;
        for i in 0..N {
            any |= self.0[i].any();
        }
        any
    }
    #[inline(always)]
    fn all(self) -> bool {
        let mut all = true;
        for i in 0..N {
            all &= self.0[i].all();
        }
        all
    }
}
