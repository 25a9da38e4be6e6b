//! Scalars as registers of one lane, and arrays of them: for any machine.
//!
//! There may be no fused multiply-add here, so `fma` rounds twice; nor an
//! instruction that rounds to a whole number, so sums do it. Operations on arrays
//! are functions of their own, each a loop that the compiler turns into what
//! vectors the machine has; inlined into a kernel, such loops would be scalar code
//! of many times the size.

use super::{Layout, Register, Wide};
use crate::{LanesMask, Mask, Real};
use core::ops::{BitAnd, BitOr, Not};

/// `N` scalars; `Wide<T>` is one.
pub type Array<T, const N: usize> = Wide<[T; N]>;
/// Sixteen `f32`.
pub type F32x16 = Array<f32, 16>;
/// Eight `f64`.
pub type F64x8 = Array<f64, 8>;

macro_rules! scalar {
    ($t:ident, $mantissa:literal) => {
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
            #[inline(always)]
            fn sqrt(a: Self) -> Self {
                Real::sqrt(a)
            }
            #[inline(always)]
            fn min(a: Self, b: Self) -> Self {
                Real::min(a, b)
            }
            #[inline(always)]
            fn max(a: Self, b: Self) -> Self {
                Real::max(a, b)
            }
            #[inline(always)]
            fn lt(a: Self, b: Self) -> bool {
                a < b
            }
            #[inline(always)]
            fn le(a: Self, b: Self) -> bool {
                a <= b
            }
            #[inline(always)]
            fn eq(a: Self, b: Self) -> bool {
                a == b
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                Real::select(mask, yes, no)
            }
            #[inline(always)]
            fn round(a: Self) -> Self {
                // Beside `whole` there is no room for a fraction; larger numbers have none.
                let (size, whole) = (Real::abs(a), $t::WHOLE);
                let rounded = Real::copysign((size + whole) - whole, a);
                Real::select(size < whole, rounded, a)
            }
            #[inline(always)]
            fn floor(a: Self) -> Self {
                let rounded = <Self as Register>::round(a);
                Real::select(rounded > a, rounded - 1.0, rounded)
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

scalar!(f32, 23);
scalar!(f64, 52);

/// Instructions on each element.
macro_rules! each {
    ($($name:ident($first:ident $(, $arg:ident)*);)+) => {$(
        #[inline(never)]
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
        #[inline(never)]
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

    #[inline(never)]
    fn splat(x: V::Scalar) -> Self {
        [V::splat(x); N]
    }
    #[inline(never)]
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
    #[inline(never)]
    fn bitand(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] & other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> BitOr for Each<M, N> {
    type Output = Self;
    #[inline(never)]
    fn bitor(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] | other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Not for Each<M, N> {
    type Output = Self;
    #[inline(never)]
    fn not(mut self) -> Self {
        for i in 0..N {
            self.0[i] = !self.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Mask for Each<M, N> {
    #[inline(never)]
    fn splat(value: bool) -> Self {
        Self([M::splat(value); N])
    }
}

impl<M: LanesMask, const N: usize> LanesMask for Each<M, N> {
    #[inline(never)]
    fn any(self) -> bool {
        let mut any = false;
        for i in 0..N {
            any |= self.0[i].any();
        }
        any
    }
    #[inline(never)]
    fn all(self) -> bool {
        let mut all = true;
        for i in 0..N {
            all &= self.0[i].all();
        }
        all
    }
}
