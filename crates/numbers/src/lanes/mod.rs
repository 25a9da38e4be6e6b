//! Several worlds side by side: 16 of `f32`, 8 of `f64`, per instruction set.
//!
//! Each instruction set has one file, a table of its instructions. A number is an
//! array of registers; a macro writes the table out as numbers and masks, every
//! operation at once on all registers, since each layer between a kernel and its
//! instructions would be compiled again wherever a kernel adds or multiplies.
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

use crate::Float;

pub mod array;
#[cfg(target_arch = "x86_64")]
pub mod avx2;
#[cfg(target_arch = "x86_64")]
pub mod avx512;
#[cfg(target_arch = "aarch64")]
pub mod neon;
#[cfg(all(target_arch = "wasm32", target_feature = "simd128"))]
pub mod simd128;
#[allow(unused)] // on a machine of another instruction set
mod table;

/// Where sign, exponent and fraction lie in a scalar (IEEE 754, binary32 and binary64).
#[allow(missing_docs)]
pub trait Layout: Float {
    const SIGN: Self;
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
    const FRACTION: Self = Self::from_bits(0x807f_ffff);
    const EXPONENT: Self = Self::from_bits(0xff);
    const WHOLE: Self = 8_388_608.0;
    const BIAS: Self = 127.0;
    const LIMIT: Self = 126.0;
}

impl Layout for f64 {
    const SIGN: Self = -0.0;
    const FRACTION: Self = Self::from_bits(0x800f_ffff_ffff_ffff);
    const EXPONENT: Self = Self::from_bits(0x7ff);
    const WHOLE: Self = 4_503_599_627_370_496.0;
    const BIAS: Self = 1023.0;
    const LIMIT: Self = 1022.0;
}
