//! `f32` and `f64` as numbers of one lane.

use crate::lanes;
use crate::real::{Float, Lanes, LanesMask, Mask, Real};
use core::sync::atomic::{AtomicU32, AtomicU64};

impl Mask for bool {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
}

impl LanesMask for bool {
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
}

macro_rules! scalar {
    ($t:ident, $bits:ident, $atom:ident, $lanes:ident, $double:expr, $mantissa:expr, $bias:expr, $max:expr) => {
        impl Real for $t {
            type Scalar = $t;
            type Mask = bool;

            #[inline(always)]
            fn lit(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn splat(x: Self) -> Self {
                x
            }
            #[inline(always)]
            fn fma(self, b: Self, c: Self) -> Self {
                self.mul_add(b, c)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $t::floor(self)
            }
            #[inline(always)]
            fn round(self) -> Self {
                $t::round_ties_even(self)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $t::copysign(self, sign)
            }
            #[inline(always)]
            fn ldexp(self, n: Self) -> Self {
                // Two factors, so that each is a normal power of two.
                let n = Real::clamp(n, -2.0 * $max, 2.0 * $max) as i32;
                let half = n >> 1;
                let power = |e: i32| $t::from_bits(((e + $bias) as $bits) << $mantissa);
                self * power(half) * power(n - half)
            }
            #[inline(always)]
            fn frexp(self) -> (Self, Self) {
                let bits = self.to_bits();
                let field = ((1 as $bits) << ($bits::BITS - 1 - $mantissa)) - 1;
                let exponent = ((bits >> $mantissa) & field) as i32 - $bias;
                let one = ($bias as $bits) << $mantissa;
                let m = $t::from_bits((bits & !(field << $mantissa)) | one);
                (m, exponent as $t)
            }
            #[inline(always)]
            fn lt(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn le(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn same(self, other: Self) -> bool {
                self == other
            }
            #[inline(always)]
            fn select(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }

        impl Lanes for $t {
            const WIDTH: usize = 1;
        }

        impl Float for $t {
            const DOUBLE: bool = $double;
            const BLOCK: usize = <Self::Portable as Lanes>::WIDTH;
            #[cfg(target_arch = "x86_64")]
            type Avx512 = lanes::avx512::$lanes;
            #[cfg(target_arch = "x86_64")]
            type Avx2 = lanes::avx2::$lanes;
            #[cfg(target_arch = "aarch64")]
            type Neon = lanes::neon::$lanes;
            #[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
            type Simd128 = lanes::simd128::$lanes;
            type Portable = lanes::array::$lanes;
            type Unfused = lanes::array::Unfused<$t>;
            type Atom = $atom;
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $t
            }
            #[inline(always)]
            fn finite(self) -> bool {
                self.is_finite()
            }
        }
    };
}

scalar!(f32, u32, AtomicU32, F32x16, false, 23, 127, 126.0);
scalar!(f64, u64, AtomicU64, F64x8, true, 52, 1023, 1022.0);
