//! NEON, which every 64-bit Arm has: four registers, masks as ones and zeros.
//!
//! The hardware's own minimum answers NaN where either is NaN, so minimum and
//! maximum are a comparison and a selection.

#![allow(unsafe_code)] // instructions of a set that dispatch has detected

use super::table::{each, instructions, lanes};
use core::arch::aarch64::*;

use vreinterpretq_f32_u32 as single;
use vreinterpretq_f64_u64 as double;
use vreinterpretq_u32_f32 as bits32;
use vreinterpretq_u64_f64 as bits64;

lanes! {
    "neon"
    F32x16([float32x4_t; 4]) of f32;
    splat(x) = vdupq_n_f32(x);
    operators {
        Add add(a, b) = vaddq_f32(a, b);
        Sub sub(a, b) = vsubq_f32(a, b);
        Mul mul(a, b) = vmulq_f32(a, b);
        Div div(a, b) = vdivq_f32(a, b);
        Neg neg(a) = vnegq_f32(a);
    }
    functions {
        fma(a, b, c) = vfmaq_f32(c, a, b);
        sqrt(a) = vsqrtq_f32(a);
        abs(a) = vabsq_f32(a);
        min(a, b) = vbslq_f32(vcltq_f32(a, b), a, b);
        max(a, b) = vbslq_f32(vcgtq_f32(a, b), a, b);
        floor(a) = vrndmq_f32(a);
        round(a) = vrndnq_f32(a);
    }
    bits {
        and(a, b) = single(vandq_u32(bits32(a), bits32(b)));
        or(a, b) = single(vorrq_u32(bits32(a), bits32(b)));
        shift_up(a) = single(vshlq_n_u32::<23>(bits32(a)));
        shift_down(a) = single(vshrq_n_u32::<23>(bits32(a)));
    }
    comparisons {
        lt(a, b) = vcltq_f32(a, b);
        le(a, b) = vcleq_f32(a, b);
        same(a, b) = vceqq_f32(a, b);
    }
    select(mask, yes, no) = vbslq_f32(mask, yes, no);

    Mask32x16([uint32x4_t; 4]);
    splat(value) = vdupq_n_u32(if value { u32::MAX } else { 0 });
    operators {
        BitAnd bitand(a, b) = vandq_u32(a, b);
        BitOr bitor(a, b) = vorrq_u32(a, b);
        Not not(a) = vmvnq_u32(a);
    }
    any(a) = vmaxvq_u32(a) != 0;
    all(a) = vminvq_u32(a) != 0;
}

lanes! {
    "neon"
    F64x8([float64x2_t; 4]) of f64;
    splat(x) = vdupq_n_f64(x);
    operators {
        Add add(a, b) = vaddq_f64(a, b);
        Sub sub(a, b) = vsubq_f64(a, b);
        Mul mul(a, b) = vmulq_f64(a, b);
        Div div(a, b) = vdivq_f64(a, b);
        Neg neg(a) = vnegq_f64(a);
    }
    functions {
        fma(a, b, c) = vfmaq_f64(c, a, b);
        sqrt(a) = vsqrtq_f64(a);
        abs(a) = vabsq_f64(a);
        min(a, b) = vbslq_f64(vcltq_f64(a, b), a, b);
        max(a, b) = vbslq_f64(vcgtq_f64(a, b), a, b);
        floor(a) = vrndmq_f64(a);
        round(a) = vrndnq_f64(a);
    }
    bits {
        and(a, b) = double(vandq_u64(bits64(a), bits64(b)));
        or(a, b) = double(vorrq_u64(bits64(a), bits64(b)));
        shift_up(a) = double(vshlq_n_u64::<52>(bits64(a)));
        shift_down(a) = double(vshrq_n_u64::<52>(bits64(a)));
    }
    comparisons {
        lt(a, b) = vcltq_f64(a, b);
        le(a, b) = vcleq_f64(a, b);
        same(a, b) = vceqq_f64(a, b);
    }
    select(mask, yes, no) = vbslq_f64(mask, yes, no);

    Mask64x8([uint64x2_t; 4]);
    splat(value) = vdupq_n_u64(if value { u64::MAX } else { 0 });
    operators {
        BitAnd bitand(a, b) = vandq_u64(a, b);
        BitOr bitor(a, b) = vorrq_u64(a, b);
        Not not(a) = veorq_u64(a, vdupq_n_u64(u64::MAX));
    }
    any(a) = vmaxvq_u32(vreinterpretq_u32_u64(a)) != 0;
    all(a) = vminvq_u32(vreinterpretq_u32_u64(a)) != 0;
}
