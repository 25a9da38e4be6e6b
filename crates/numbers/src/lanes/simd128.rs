//! WebAssembly's 128-bit vectors: four of them, masks as ones and zeros.
//!
//! There is no fused multiply-add whose rounding is fixed, so `fma` rounds twice.
//! `pmin(a, b)` is `b < a ? b : a`, hence the swapped operands.

#![allow(unsafe_code)] // in the table's expansion; these intrinsics are safe

use super::{Bits, BitsRegister, Pair, Wide, register};
use bytemuck::{Pod, Zeroable};
use core::arch::wasm32::*;

/// Sixteen `f32`.
pub type F32x16 = Wide<Pair<Pair<F32x4>>>;
/// Eight `f64`.
pub type F64x8 = Wide<Pair<Pair<F64x2>>>;

/// Four `f32`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct F32x4(v128);

/// Two `f64`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct F64x2(v128);

register! { F32x4: f32, 4, Bits<Self>;
    splat(x) = F32x4(f32x4_splat(x));
    add(a, b) = F32x4(f32x4_add(a.0, b.0));
    sub(a, b) = F32x4(f32x4_sub(a.0, b.0));
    mul(a, b) = F32x4(f32x4_mul(a.0, b.0));
    div(a, b) = F32x4(f32x4_div(a.0, b.0));
    fma(a, b, c) = F32x4(f32x4_add(f32x4_mul(a.0, b.0), c.0));
    sqrt(a) = F32x4(f32x4_sqrt(a.0));
    min(a, b) = F32x4(f32x4_pmin(b.0, a.0));
    max(a, b) = F32x4(f32x4_pmax(b.0, a.0));
    floor(a) = F32x4(f32x4_floor(a.0));
    round(a) = F32x4(f32x4_nearest(a.0));
    lt(a, b) = Bits(F32x4(f32x4_lt(a.0, b.0)));
    le(a, b) = Bits(F32x4(f32x4_le(a.0, b.0)));
    eq(a, b) = Bits(F32x4(f32x4_eq(a.0, b.0)));
    select(mask, yes, no) = F32x4(v128_bitselect(yes.0, no.0, mask.0.0));
    and(a, b) = F32x4(v128_and(a.0, b.0));
    or(a, b) = F32x4(v128_or(a.0, b.0));
    xor(a, b) = F32x4(v128_xor(a.0, b.0));
    to_exponent(a) = F32x4(u32x4_shl(a.0, 23));
    from_exponent(a) = F32x4(u32x4_shr(a.0, 23));
}

register! { F64x2: f64, 2, Bits<Self>;
    splat(x) = F64x2(f64x2_splat(x));
    add(a, b) = F64x2(f64x2_add(a.0, b.0));
    sub(a, b) = F64x2(f64x2_sub(a.0, b.0));
    mul(a, b) = F64x2(f64x2_mul(a.0, b.0));
    div(a, b) = F64x2(f64x2_div(a.0, b.0));
    fma(a, b, c) = F64x2(f64x2_add(f64x2_mul(a.0, b.0), c.0));
    sqrt(a) = F64x2(f64x2_sqrt(a.0));
    min(a, b) = F64x2(f64x2_pmin(b.0, a.0));
    max(a, b) = F64x2(f64x2_pmax(b.0, a.0));
    floor(a) = F64x2(f64x2_floor(a.0));
    round(a) = F64x2(f64x2_nearest(a.0));
    lt(a, b) = Bits(F64x2(f64x2_lt(a.0, b.0)));
    le(a, b) = Bits(F64x2(f64x2_le(a.0, b.0)));
    eq(a, b) = Bits(F64x2(f64x2_eq(a.0, b.0)));
    select(mask, yes, no) = F64x2(v128_bitselect(yes.0, no.0, mask.0.0));
    and(a, b) = F64x2(v128_and(a.0, b.0));
    or(a, b) = F64x2(v128_or(a.0, b.0));
    xor(a, b) = F64x2(v128_xor(a.0, b.0));
    to_exponent(a) = F64x2(u64x2_shl(a.0, 52));
    from_exponent(a) = F64x2(u64x2_shr(a.0, 52));
}

impl BitsRegister for F32x4 {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        v128_any_true(mask.0)
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        u32x4_all_true(mask.0)
    }
}

impl BitsRegister for F64x2 {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        v128_any_true(mask.0)
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        u64x2_all_true(mask.0)
    }
}
