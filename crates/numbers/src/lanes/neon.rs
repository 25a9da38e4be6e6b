//! NEON, which every 64-bit Arm has: four registers, masks as ones and zeros.
//!
//! The hardware's own minimum answers NaN where either is NaN, so minimum and
//! maximum are a comparison and a selection.

#![allow(unsafe_code)] // intrinsics of an instruction set that dispatch has detected

use super::{Bits, BitsRegister, Pair, Wide, register};
use core::arch::aarch64::*;

/// Sixteen `f32`.
pub type F32x16 = Wide<Pair<Pair<float32x4_t>>>;
/// Eight `f64`.
pub type F64x8 = Wide<Pair<Pair<float64x2_t>>>;

use vreinterpretq_f32_u32 as single;
use vreinterpretq_f64_u64 as double;
use vreinterpretq_u32_f32 as bits32;
use vreinterpretq_u64_f64 as bits64;

register! { float32x4_t: f32, 4, Bits<Self>;
    splat(x) = vdupq_n_f32(x);
    add(a, b) = vaddq_f32(a, b);
    sub(a, b) = vsubq_f32(a, b);
    mul(a, b) = vmulq_f32(a, b);
    div(a, b) = vdivq_f32(a, b);
    fma(a, b, c) = vfmaq_f32(c, a, b);
    sqrt(a) = vsqrtq_f32(a);
    min(a, b) = vbslq_f32(vcltq_f32(a, b), a, b);
    max(a, b) = vbslq_f32(vcgtq_f32(a, b), a, b);
    floor(a) = vrndmq_f32(a);
    round(a) = vrndnq_f32(a);
    lt(a, b) = Bits(single(vcltq_f32(a, b)));
    le(a, b) = Bits(single(vcleq_f32(a, b)));
    eq(a, b) = Bits(single(vceqq_f32(a, b)));
    select(mask, yes, no) = vbslq_f32(bits32(mask.0), yes, no);
    and(a, b) = single(vandq_u32(bits32(a), bits32(b)));
    or(a, b) = single(vorrq_u32(bits32(a), bits32(b)));
    xor(a, b) = single(veorq_u32(bits32(a), bits32(b)));
    to_exponent(a) = single(vshlq_n_u32::<23>(bits32(a)));
    from_exponent(a) = single(vshrq_n_u32::<23>(bits32(a)));
}

register! { float64x2_t: f64, 2, Bits<Self>;
    splat(x) = vdupq_n_f64(x);
    add(a, b) = vaddq_f64(a, b);
    sub(a, b) = vsubq_f64(a, b);
    mul(a, b) = vmulq_f64(a, b);
    div(a, b) = vdivq_f64(a, b);
    fma(a, b, c) = vfmaq_f64(c, a, b);
    sqrt(a) = vsqrtq_f64(a);
    min(a, b) = vbslq_f64(vcltq_f64(a, b), a, b);
    max(a, b) = vbslq_f64(vcgtq_f64(a, b), a, b);
    floor(a) = vrndmq_f64(a);
    round(a) = vrndnq_f64(a);
    lt(a, b) = Bits(double(vcltq_f64(a, b)));
    le(a, b) = Bits(double(vcleq_f64(a, b)));
    eq(a, b) = Bits(double(vceqq_f64(a, b)));
    select(mask, yes, no) = vbslq_f64(bits64(mask.0), yes, no);
    and(a, b) = double(vandq_u64(bits64(a), bits64(b)));
    or(a, b) = double(vorrq_u64(bits64(a), bits64(b)));
    xor(a, b) = double(veorq_u64(bits64(a), bits64(b)));
    to_exponent(a) = double(vshlq_n_u64::<52>(bits64(a)));
    from_exponent(a) = double(vshrq_n_u64::<52>(bits64(a)));
}

impl BitsRegister for float32x4_t {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        // SAFETY: every 64-bit Arm has NEON.
        unsafe { vmaxvq_u32(bits32(mask)) != 0 }
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        // SAFETY: every 64-bit Arm has NEON.
        unsafe { vminvq_u32(bits32(mask)) != 0 }
    }
}

impl BitsRegister for float64x2_t {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        // SAFETY: every 64-bit Arm has NEON.
        unsafe { vmaxvq_u32(vreinterpretq_u32_f64(mask)) != 0 }
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        // SAFETY: every 64-bit Arm has NEON.
        unsafe { vminvq_u32(vreinterpretq_u32_f64(mask)) != 0 }
    }
}
