//! WebAssembly's 128-bit vectors: four of them, masks as ones and zeros.
//!
//! There is no fused multiply-add whose rounding is fixed, so `fma` rounds twice.
//! `pmin(a, b)` is `b < a ? b : a`, hence the swapped operands.

#![allow(unsafe_code)] // in the table's expansion; these instructions are safe

use super::table::{each, instructions, lanes};
use core::arch::wasm32::*;

lanes! {
    "simd128"
    F32x16([v128; 4]) of f32;
    splat(x) = f32x4_splat(x);
    operators {
        Add add(a, b) = f32x4_add(a, b);
        Sub sub(a, b) = f32x4_sub(a, b);
        Mul mul(a, b) = f32x4_mul(a, b);
        Div div(a, b) = f32x4_div(a, b);
        Neg neg(a) = f32x4_neg(a);
    }
    functions {
        fma(a, b, c) = f32x4_add(f32x4_mul(a, b), c);
        sqrt(a) = f32x4_sqrt(a);
        abs(a) = f32x4_abs(a);
        min(a, b) = f32x4_pmin(b, a);
        max(a, b) = f32x4_pmax(b, a);
        floor(a) = f32x4_floor(a);
        round(a) = f32x4_nearest(a);
    }
    bits {
        and(a, b) = v128_and(a, b);
        or(a, b) = v128_or(a, b);
        shift_up(a) = u32x4_shl(a, 23);
        shift_down(a) = u32x4_shr(a, 23);
    }
    comparisons {
        lt(a, b) = f32x4_lt(a, b);
        le(a, b) = f32x4_le(a, b);
        same(a, b) = f32x4_eq(a, b);
    }
    select(mask, yes, no) = v128_bitselect(yes, no, mask);

    Mask32x16([v128; 4]);
    splat(value) = i32x4_splat(-i32::from(value));
    operators {
        BitAnd bitand(a, b) = v128_and(a, b);
        BitOr bitor(a, b) = v128_or(a, b);
        Not not(a) = v128_not(a);
    }
    any(a) = v128_any_true(a);
    all(a) = u32x4_all_true(a);
}

lanes! {
    "simd128"
    F64x8([v128; 4]) of f64;
    splat(x) = f64x2_splat(x);
    operators {
        Add add(a, b) = f64x2_add(a, b);
        Sub sub(a, b) = f64x2_sub(a, b);
        Mul mul(a, b) = f64x2_mul(a, b);
        Div div(a, b) = f64x2_div(a, b);
        Neg neg(a) = f64x2_neg(a);
    }
    functions {
        fma(a, b, c) = f64x2_add(f64x2_mul(a, b), c);
        sqrt(a) = f64x2_sqrt(a);
        abs(a) = f64x2_abs(a);
        min(a, b) = f64x2_pmin(b, a);
        max(a, b) = f64x2_pmax(b, a);
        floor(a) = f64x2_floor(a);
        round(a) = f64x2_nearest(a);
    }
    bits {
        and(a, b) = v128_and(a, b);
        or(a, b) = v128_or(a, b);
        shift_up(a) = u64x2_shl(a, 52);
        shift_down(a) = u64x2_shr(a, 52);
    }
    comparisons {
        lt(a, b) = f64x2_lt(a, b);
        le(a, b) = f64x2_le(a, b);
        same(a, b) = f64x2_eq(a, b);
    }
    select(mask, yes, no) = v128_bitselect(yes, no, mask);

    Mask64x8([v128; 4]);
    splat(value) = i64x2_splat(-i64::from(value));
    operators {
        BitAnd bitand(a, b) = v128_and(a, b);
        BitOr bitor(a, b) = v128_or(a, b);
        Not not(a) = v128_not(a);
    }
    any(a) = v128_any_true(a);
    all(a) = u64x2_all_true(a);
}
