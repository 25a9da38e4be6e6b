//! Several worlds side by side: 16 of `f32`, 8 of `f64`, per instruction set.
//!
//! Each instruction set has one file, a table of its instructions: it implements
//! [`Register`] for the hardware's registers. [`Pair`] joins two registers to a
//! wider one, and [`Wide`] reads any of them as a number.
//!
//! | file | 16 of `f32` | 8 of `f64` | fused |
//! |---|---|---|---|
//! | `avx512` | 1 register | 1 | yes |
//! | `avx2` | 2 | 2 | yes |
//! | `neon` | 4 | 4 | yes |
//! | `simd128` | 4 | 4 | no |
//! | `array` | 16 scalars | 8 | no |
//!
//! # Safety
//!
//! A lane type may only be used on a machine that has its instructions. The
//! entries in [`dispatch`](crate::dispatch) see to it: they are the one place
//! where a job meets a lane type, and they are entered after detection only.

use crate::{Float, Lanes, LanesMask, Mask, Real};
use bytemuck::{Pod, Zeroable};
use core::fmt::Debug;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

pub mod array;
#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
#[cfg(target_arch = "aarch64")]
pub mod neon;
pub mod pair;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub mod simd128;

pub use pair::Pair;

/// The instructions that lanes are made of. Rounding and NaN as in [`Real`].
#[allow(missing_docs)]
pub trait Register: Copy + Debug {
    type Scalar: Layout;
    type Mask: LanesMask;
    const WIDTH: usize;

    fn splat(x: Self::Scalar) -> Self;
    fn add(a: Self, b: Self) -> Self;
    fn sub(a: Self, b: Self) -> Self;
    fn mul(a: Self, b: Self) -> Self;
    fn div(a: Self, b: Self) -> Self;
    fn fma(a: Self, b: Self, c: Self) -> Self;
    fn sqrt(a: Self) -> Self;
    fn min(a: Self, b: Self) -> Self;
    fn max(a: Self, b: Self) -> Self;
    fn floor(a: Self) -> Self;
    fn round(a: Self) -> Self;
    fn lt(a: Self, b: Self) -> Self::Mask;
    fn le(a: Self, b: Self) -> Self::Mask;
    fn eq(a: Self, b: Self) -> Self::Mask;
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Bit by bit.
    fn and(a: Self, b: Self) -> Self;
    /// Bit by bit.
    fn or(a: Self, b: Self) -> Self;
    /// Bit by bit.
    fn xor(a: Self, b: Self) -> Self;
    /// The lowest bits move up to the exponent; higher ones are lost.
    fn to_exponent(a: Self) -> Self;
    /// The exponent, and the sign above it, move down to the lowest bits.
    fn from_exponent(a: Self) -> Self;
}

/// Writes a table of instructions out as a [`Register`].
macro_rules! register {
    ($register:ty: $scalar:ty, $width:literal, $mask:ty;
     $($name:ident($($arg:ident),+) = $body:expr;)+) => {
        // Of the intrinsics, those that every machine of the architecture has are safe.
        #[allow(unused_unsafe)]
        impl $crate::lanes::Register for $register {
            type Scalar = $scalar;
            type Mask = $mask;
            const WIDTH: usize = $width;
            $(register! { @ $name($($arg),+) = $body })+
        }
    };
    (@ splat($x:ident) = $body:expr) => {
        #[inline(always)]
        fn splat($x: Self::Scalar) -> Self {
            // SAFETY: the instruction exists here; see the module.
            unsafe { $body }
        }
    };
    (@ select($m:ident, $a:ident, $b:ident) = $body:expr) => {
        #[inline(always)]
        fn select($m: Self::Mask, $a: Self, $b: Self) -> Self {
            // SAFETY: the instruction exists here; see the module.
            unsafe { $body }
        }
    };
    (@ lt $($rest:tt)+) => { register! { @compare lt $($rest)+ } };
    (@ le $($rest:tt)+) => { register! { @compare le $($rest)+ } };
    (@ eq $($rest:tt)+) => { register! { @compare eq $($rest)+ } };
    (@compare $name:ident($a:ident, $b:ident) = $body:expr) => {
        #[inline(always)]
        fn $name($a: Self, $b: Self) -> Self::Mask {
            // SAFETY: the instruction exists here; see the module.
            unsafe { $body }
        }
    };
    (@ $name:ident($($arg:ident),+) = $body:expr) => {
        #[inline(always)]
        fn $name($($arg: Self),+) -> Self {
            // SAFETY: the instruction exists here; see the module.
            unsafe { $body }
        }
    };
}
use register;

/// Where sign, exponent and fraction lie in a scalar (IEEE 754, binary32 and binary64).
#[allow(missing_docs)]
pub trait Layout: Float {
    const SIGN: Self;
    /// All bits but the sign.
    const MAGNITUDE: Self;
    /// Sign and fraction.
    const FRACTION: Self;
    /// The bits of the exponent, moved down.
    const EXPONENT: Self;
    /// The number whose last place is 1: its lowest bits count whole numbers.
    const WHOLE: Self;
    /// What is added to the exponent before it is stored.
    const BIAS: Self;
    /// Exponent of the smallest normal number, without its sign.
    const LIMIT: Self;
}

impl Layout for f32 {
    const SIGN: Self = -0.0;
    const MAGNITUDE: Self = Self::from_bits(0x7fff_ffff);
    const FRACTION: Self = Self::from_bits(0x807f_ffff);
    const EXPONENT: Self = Self::from_bits(0xff);
    const WHOLE: Self = 8_388_608.0;
    const BIAS: Self = 127.0;
    const LIMIT: Self = 126.0;
}

impl Layout for f64 {
    const SIGN: Self = -0.0;
    const MAGNITUDE: Self = Self::from_bits(0x7fff_ffff_ffff_ffff);
    const FRACTION: Self = Self::from_bits(0x800f_ffff_ffff_ffff);
    const EXPONENT: Self = Self::from_bits(0x7ff);
    const WHOLE: Self = 4_503_599_627_370_496.0;
    const BIAS: Self = 1023.0;
    const LIMIT: Self = 1022.0;
}

/// A register read as a number.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct Wide<V>(V);

impl<V: Register> Default for Wide<V> {
    #[inline(always)]
    fn default() -> Self {
        Self::zero()
    }
}

macro_rules! operator {
    ($($trait:ident $name:ident, $assign_trait:ident $assign:ident;)+) => {$(
        impl<V: Register> $trait for Wide<V> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(V::$name(self.0, other.0))
            }
        }
        impl<V: Register> $assign_trait for Wide<V> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                self.0 = V::$name(self.0, other.0);
            }
        }
    )+};
}

operator! {
    Add add, AddAssign add_assign;
    Sub sub, SubAssign sub_assign;
    Mul mul, MulAssign mul_assign;
}

impl<V: Register> Div for Wide<V> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        Self(V::div(self.0, other.0))
    }
}

impl<V: Register> Neg for Wide<V> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(V::xor(self.0, V::splat(V::Scalar::SIGN)))
    }
}

impl<V: Register> Wide<V> {
    /// 2ⁿ for a whole n of a normal power: n + bias, counted in the lowest bits, moved up.
    #[inline(always)]
    fn power_of_two(n: Self) -> Self {
        let counted = n + Self::splat(V::Scalar::WHOLE + V::Scalar::BIAS);
        Self(V::to_exponent(counted.0))
    }
}

impl<V: Register> Real for Wide<V> {
    type Scalar = V::Scalar;
    type Mask = V::Mask;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self::splat(V::Scalar::from_f64(x))
    }
    #[inline(always)]
    fn splat(x: V::Scalar) -> Self {
        Self(V::splat(x))
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        Self(V::fma(self.0, b.0, c.0))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(V::sqrt(self.0))
    }
    #[inline(always)]
    fn abs(self) -> Self {
        Self(V::and(self.0, V::splat(V::Scalar::MAGNITUDE)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(V::min(self.0, other.0))
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(V::max(self.0, other.0))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(V::floor(self.0))
    }
    #[inline(always)]
    fn round(self) -> Self {
        Self(V::round(self.0))
    }
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        let sign = V::and(sign.0, V::splat(V::Scalar::SIGN));
        Self(V::or(self.abs().0, sign))
    }
    #[inline(always)]
    fn ldexp(self, n: Self) -> Self {
        // Two factors, so that each is a normal power of two.
        let limit = Self::splat(V::Scalar::LIMIT + V::Scalar::LIMIT);
        let n = n.clamp(-limit, limit);
        let half = (n * Self::lit(0.5)).floor();
        self * Self::power_of_two(half) * Self::power_of_two(n - half)
    }
    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let fraction = V::and(self.0, V::splat(V::Scalar::FRACTION));
        let m = V::or(fraction, V::splat(V::Scalar::lit(1.0)));
        let exponent = V::and(V::from_exponent(self.0), V::splat(V::Scalar::EXPONENT));
        let counted = V::or(exponent, V::splat(V::Scalar::WHOLE));
        let e = Self(counted) - Self::splat(V::Scalar::WHOLE + V::Scalar::BIAS);
        (Self(m), e)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> V::Mask {
        V::lt(self.0, other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> V::Mask {
        V::le(self.0, other.0)
    }
    #[inline(always)]
    fn same(self, other: Self) -> V::Mask {
        V::eq(self.0, other.0)
    }
    #[inline(always)]
    fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        Self(V::select(mask, yes.0, no.0))
    }
}

impl<V: Register + Pod> Lanes for Wide<V> {
    const WIDTH: usize = V::WIDTH;
}

/// A truth per lane as a register: all ones, or all zeros.
#[derive(Clone, Copy, Debug)]
pub struct Bits<V>(V);

/// A [`Register`] whose comparisons answer with ones and zeros.
pub trait BitsRegister: Register<Mask = Bits<Self>> {
    /// True where some lane is ones.
    fn any(mask: Self) -> bool;
    /// True where all lanes are ones.
    fn all(mask: Self) -> bool;
}

impl<V: BitsRegister> BitAnd for Bits<V> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(V::and(self.0, other.0))
    }
}

impl<V: BitsRegister> BitOr for Bits<V> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(V::or(self.0, other.0))
    }
}

impl<V: BitsRegister> Not for Bits<V> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(V::xor(self.0, Self::splat(true).0))
    }
}

impl<V: BitsRegister> Mask for Bits<V> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        let zero = V::splat(V::Scalar::lit(0.0));
        if value { V::eq(zero, zero) } else { Self(zero) }
    }
}

impl<V: BitsRegister> LanesMask for Bits<V> {
    #[inline(always)]
    fn any(self) -> bool {
        V::any(self.0)
    }
    #[inline(always)]
    fn all(self) -> bool {
        V::all(self.0)
    }
}
