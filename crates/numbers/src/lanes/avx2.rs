//! AVX2 with FMA: two registers, masks as registers of ones and zeros.

#![allow(unsafe_code)] // instructions of a set that dispatch has detected

use super::table::{each, instructions, lanes};
use crate::{LANES, Quad};
use core::arch::asm;
use core::arch::x86_64::*;

const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;

lanes! {
    "avx2,fma"
    F32x16([__m256; 2]) of f32;
    quads(load_quads, store_quads);
    splat(x) = _mm256_set1_ps(x);
    operators {
        Add add(a, b) = _mm256_add_ps(a, b);
        Sub sub(a, b) = _mm256_sub_ps(a, b);
        Mul mul(a, b) = _mm256_mul_ps(a, b);
        Div div(a, b) = _mm256_div_ps(a, b);
        Neg neg(a) = _mm256_xor_ps(a, _mm256_set1_ps(-0.0));
    }
    functions {
        fma(a, b, c) = _mm256_fmadd_ps(a, b, c);
        sqrt(a) = _mm256_sqrt_ps(a);
        abs(a) = _mm256_andnot_ps(_mm256_set1_ps(-0.0), a);
        min(a, b) = _mm256_min_ps(a, b);
        max(a, b) = _mm256_max_ps(a, b);
        floor(a) = _mm256_floor_ps(a);
        round(a) = _mm256_round_ps::<NEAREST>(a);
    }
    bits {
        and(a, b) = _mm256_and_ps(a, b);
        or(a, b) = _mm256_or_ps(a, b);
        shift_up(a) = _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_castps_si256(a)));
        shift_down(a) = _mm256_castsi256_ps(_mm256_srli_epi32::<23>(_mm256_castps_si256(a)));
    }
    comparisons {
        lt(a, b) = _mm256_cmp_ps::<_CMP_LT_OQ>(a, b);
        le(a, b) = _mm256_cmp_ps::<_CMP_LE_OQ>(a, b);
        same(a, b) = _mm256_cmp_ps::<_CMP_EQ_OQ>(a, b);
    }
    select(mask, yes, no) = _mm256_blendv_ps(no, yes, mask);

    Mask32x16([__m256; 2]);
    splat(value) = _mm256_castsi256_ps(_mm256_set1_epi32(-i32::from(value)));
    operators {
        BitAnd bitand(a, b) = _mm256_and_ps(a, b);
        BitOr bitor(a, b) = _mm256_or_ps(a, b);
        Not not(a) = _mm256_xor_ps(a, _mm256_castsi256_ps(_mm256_set1_epi32(-1)));
    }
    any(a) = _mm256_movemask_ps(a) != 0;
    all(a) = _mm256_movemask_ps(a) == 0xff;
}

lanes! {
    "avx2,fma"
    F64x8([__m256d; 2]) of f64;
    splat(x) = _mm256_set1_pd(x);
    operators {
        Add add(a, b) = _mm256_add_pd(a, b);
        Sub sub(a, b) = _mm256_sub_pd(a, b);
        Mul mul(a, b) = _mm256_mul_pd(a, b);
        Div div(a, b) = _mm256_div_pd(a, b);
        Neg neg(a) = _mm256_xor_pd(a, _mm256_set1_pd(-0.0));
    }
    functions {
        fma(a, b, c) = _mm256_fmadd_pd(a, b, c);
        sqrt(a) = _mm256_sqrt_pd(a);
        abs(a) = _mm256_andnot_pd(_mm256_set1_pd(-0.0), a);
        min(a, b) = _mm256_min_pd(a, b);
        max(a, b) = _mm256_max_pd(a, b);
        floor(a) = _mm256_floor_pd(a);
        round(a) = _mm256_round_pd::<NEAREST>(a);
    }
    bits {
        and(a, b) = _mm256_and_pd(a, b);
        or(a, b) = _mm256_or_pd(a, b);
        shift_up(a) = _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(a)));
        shift_down(a) = _mm256_castsi256_pd(_mm256_srli_epi64::<52>(_mm256_castpd_si256(a)));
    }
    comparisons {
        lt(a, b) = _mm256_cmp_pd::<_CMP_LT_OQ>(a, b);
        le(a, b) = _mm256_cmp_pd::<_CMP_LE_OQ>(a, b);
        same(a, b) = _mm256_cmp_pd::<_CMP_EQ_OQ>(a, b);
    }
    select(mask, yes, no) = _mm256_blendv_pd(no, yes, mask);

    Mask64x8([__m256d; 2]);
    splat(value) = _mm256_castsi256_pd(_mm256_set1_epi64x(-i64::from(value)));
    operators {
        BitAnd bitand(a, b) = _mm256_and_pd(a, b);
        BitOr bitor(a, b) = _mm256_or_pd(a, b);
        Not not(a) = _mm256_xor_pd(a, _mm256_castsi256_pd(_mm256_set1_epi64x(-1)));
    }
    any(a) = _mm256_movemask_pd(a) != 0;
    all(a) = _mm256_movemask_pd(a) == 0xf;
}

/// Reads four atomics at once, which is what four relaxed loads do: each number is whole, since it is
/// aligned.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn load_quads<const Q: usize>(rows: &[&[Quad<f32>; Q]; LANES], quad: usize) -> [F32x16; 4] {
    assert!(quad < Q);
    let mut columns = [F32x16([_mm256_setzero_ps(); 2]); 4];
    for half in 0..2 {
        let mut lines = [_mm256_setzero_ps(); 4];
        for i in 0..4 {
            // SAFETY: the rows have such a quad, of 16 bytes aligned to as many.
            unsafe {
                asm!(
                    "vmovaps {line:x}, [{a} + {at}]",
                    "vinsertf128 {line}, {line}, [{b} + {at}], 1",
                    line = out(ymm_reg) lines[i],
                    a = in(reg) rows[8 * half + i],
                    b = in(reg) rows[8 * half + i + 4],
                    at = in(reg) quad * size_of::<Quad<f32>>(),
                    options(pure, readonly, nostack, preserves_flags)
                );
            }
        }
        lines = transpose(lines);
        for i in 0..4 {
            columns[i].0[half] = lines[i];
        }
    }
    columns
}

/// Writes four atomics at once.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn store_quads<const Q: usize>(columns: [F32x16; 4], rows: &[&[Quad<f32>; Q]; LANES], quad: usize) {
    assert!(quad < Q);
    let [a, b, c, d] = columns;
    for half in 0..2 {
        let lines = transpose([a.0[half], b.0[half], c.0[half], d.0[half]]);
        for i in 0..4 {
            // SAFETY: the rows have such a quad, of 16 bytes aligned to as many, and it is atomic.
            unsafe {
                asm!(
                    "vmovaps [{a} + {at}], {line:x}",
                    "vextractf128 [{b} + {at}], {line}, 1",
                    line = in(ymm_reg) lines[i],
                    a = in(reg) rows[8 * half + i],
                    b = in(reg) rows[8 * half + i + 4],
                    at = in(reg) quad * size_of::<Quad<f32>>(),
                    options(nostack, preserves_flags)
                );
            }
        }
    }
}

/// Rows and columns change places in each half.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn transpose([a, b, c, d]: [__m256; 4]) -> [__m256; 4] {
    let (ab, cd) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
    let (first, third) = (_mm256_castps_pd(ab), _mm256_castps_pd(cd));
    let (ab, cd) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
    let (second, fourth) = (_mm256_castps_pd(ab), _mm256_castps_pd(cd));
    [
        _mm256_castpd_ps(_mm256_unpacklo_pd(first, third)),
        _mm256_castpd_ps(_mm256_unpackhi_pd(first, third)),
        _mm256_castpd_ps(_mm256_unpacklo_pd(second, fourth)),
        _mm256_castpd_ps(_mm256_unpackhi_pd(second, fourth)),
    ]
}
