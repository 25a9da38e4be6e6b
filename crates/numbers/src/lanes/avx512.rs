//! AVX-512 F and DQ: all lanes in one register, masks in mask registers.

#![allow(unsafe_code)] // instructions of a set that dispatch has detected

use super::table::{each, instructions, lanes};
use crate::{LANES, Quad};
use core::arch::asm;
use core::arch::x86_64::*;

const FLOOR: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;

lanes! {
    "avx512f,avx512dq"
    F32x16([__m512; 1]) of f32;
    quads(load_quads, store_quads);
    splat(x) = _mm512_set1_ps(x);
    operators {
        Add add(a, b) = _mm512_add_ps(a, b);
        Sub sub(a, b) = _mm512_sub_ps(a, b);
        Mul mul(a, b) = _mm512_mul_ps(a, b);
        Div div(a, b) = _mm512_div_ps(a, b);
        Neg neg(a) = _mm512_xor_ps(a, _mm512_set1_ps(-0.0));
    }
    functions {
        fma(a, b, c) = _mm512_fmadd_ps(a, b, c);
        sqrt(a) = _mm512_sqrt_ps(a);
        abs(a) = _mm512_andnot_ps(_mm512_set1_ps(-0.0), a);
        min(a, b) = _mm512_min_ps(a, b);
        max(a, b) = _mm512_max_ps(a, b);
        floor(a) = _mm512_roundscale_ps::<FLOOR>(a);
        round(a) = _mm512_roundscale_ps::<NEAREST>(a);
    }
    bits {
        and(a, b) = _mm512_and_ps(a, b);
        or(a, b) = _mm512_or_ps(a, b);
        shift_up(a) = _mm512_castsi512_ps(_mm512_slli_epi32::<23>(_mm512_castps_si512(a)));
        shift_down(a) = _mm512_castsi512_ps(_mm512_srli_epi32::<23>(_mm512_castps_si512(a)));
    }
    comparisons {
        lt(a, b) = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
        le(a, b) = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
        same(a, b) = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b);
    }
    select(mask, yes, no) = _mm512_mask_blend_ps(mask, no, yes);

    Mask32x16([__mmask16; 1]);
    splat(value) = if value { __mmask16::MAX } else { 0 };
    operators {
        BitAnd bitand(a, b) = a & b;
        BitOr bitor(a, b) = a | b;
        Not not(a) = !a;
    }
    any(a) = a != 0;
    all(a) = a == __mmask16::MAX;
}

lanes! {
    "avx512f,avx512dq"
    F64x8([__m512d; 1]) of f64;
    splat(x) = _mm512_set1_pd(x);
    operators {
        Add add(a, b) = _mm512_add_pd(a, b);
        Sub sub(a, b) = _mm512_sub_pd(a, b);
        Mul mul(a, b) = _mm512_mul_pd(a, b);
        Div div(a, b) = _mm512_div_pd(a, b);
        Neg neg(a) = _mm512_xor_pd(a, _mm512_set1_pd(-0.0));
    }
    functions {
        fma(a, b, c) = _mm512_fmadd_pd(a, b, c);
        sqrt(a) = _mm512_sqrt_pd(a);
        abs(a) = _mm512_andnot_pd(_mm512_set1_pd(-0.0), a);
        min(a, b) = _mm512_min_pd(a, b);
        max(a, b) = _mm512_max_pd(a, b);
        floor(a) = _mm512_roundscale_pd::<FLOOR>(a);
        round(a) = _mm512_roundscale_pd::<NEAREST>(a);
    }
    bits {
        and(a, b) = _mm512_and_pd(a, b);
        or(a, b) = _mm512_or_pd(a, b);
        shift_up(a) = _mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_castpd_si512(a)));
        shift_down(a) = _mm512_castsi512_pd(_mm512_srli_epi64::<52>(_mm512_castpd_si512(a)));
    }
    comparisons {
        lt(a, b) = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b);
        le(a, b) = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
        same(a, b) = _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, b);
    }
    select(mask, yes, no) = _mm512_mask_blend_pd(mask, no, yes);

    Mask64x8([__mmask8; 1]);
    splat(value) = if value { __mmask8::MAX } else { 0 };
    operators {
        BitAnd bitand(a, b) = a & b;
        BitOr bitor(a, b) = a | b;
        Not not(a) = !a;
    }
    any(a) = a != 0;
    all(a) = a == __mmask8::MAX;
}

/// Reads four atomics at once, which is what four relaxed loads do: each number is whole, since it is
/// aligned.
#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn load_quads<const Q: usize>(rows: &[&[Quad<f32>; Q]; LANES], quad: usize) -> [F32x16; 4] {
    assert!(quad < Q);
    let mut lines = [_mm512_setzero_ps(); 4];
    for i in 0..4 {
        // SAFETY: the rows have such a quad, of 16 bytes aligned to as many.
        unsafe {
            asm!(
                "vbroadcastf32x4 {line}, [{a} + {at}]",
                "vinsertf32x4 {line}, {line}, [{b} + {at}], 1",
                "vinsertf32x4 {line}, {line}, [{c} + {at}], 2",
                "vinsertf32x4 {line}, {line}, [{d} + {at}], 3",
                line = out(zmm_reg) lines[i],
                a = in(reg) rows[i],
                b = in(reg) rows[i + 4],
                c = in(reg) rows[i + 8],
                d = in(reg) rows[i + 12],
                at = in(reg) quad * size_of::<Quad<f32>>(),
                options(pure, readonly, nostack, preserves_flags)
            );
        }
    }
    let [a, b, c, d] = transpose(lines);
    [F32x16([a]), F32x16([b]), F32x16([c]), F32x16([d])]
}

/// Writes four atomics at once.
#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn store_quads<const Q: usize>(columns: [F32x16; 4], rows: &[&[Quad<f32>; Q]; LANES], quad: usize) {
    assert!(quad < Q);
    let [a, b, c, d] = columns;
    let lines = transpose([a.0[0], b.0[0], c.0[0], d.0[0]]);
    for i in 0..4 {
        // SAFETY: the rows have such a quad, of 16 bytes aligned to as many, and it is atomic.
        unsafe {
            asm!(
                "vextractf32x4 [{a} + {at}], {line}, 0",
                "vextractf32x4 [{b} + {at}], {line}, 1",
                "vextractf32x4 [{c} + {at}], {line}, 2",
                "vextractf32x4 [{d} + {at}], {line}, 3",
                line = in(zmm_reg) lines[i],
                a = in(reg) rows[i],
                b = in(reg) rows[i + 4],
                c = in(reg) rows[i + 8],
                d = in(reg) rows[i + 12],
                at = in(reg) quad * size_of::<Quad<f32>>(),
                options(nostack, preserves_flags)
            );
        }
    }
}

/// Rows and columns change places in each quarter.
#[inline]
#[target_feature(enable = "avx512f,avx512dq")]
fn transpose([a, b, c, d]: [__m512; 4]) -> [__m512; 4] {
    let (ab, cd) = (_mm512_unpacklo_ps(a, b), _mm512_unpacklo_ps(c, d));
    let (first, third) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
    let (ab, cd) = (_mm512_unpackhi_ps(a, b), _mm512_unpackhi_ps(c, d));
    let (second, fourth) = (_mm512_castps_pd(ab), _mm512_castps_pd(cd));
    [
        _mm512_castpd_ps(_mm512_unpacklo_pd(first, third)),
        _mm512_castpd_ps(_mm512_unpackhi_pd(first, third)),
        _mm512_castpd_ps(_mm512_unpacklo_pd(second, fourth)),
        _mm512_castpd_ps(_mm512_unpackhi_pd(second, fourth)),
    ]
}
