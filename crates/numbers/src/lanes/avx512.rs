//! AVX-512F: all lanes in one register, masks in mask registers.

#![allow(unsafe_code)] // intrinsics of an instruction set that dispatch has detected

use super::{Wide, register};
use crate::{LanesMask, Mask};
use core::arch::x86_64::*;

/// Sixteen `f32`.
pub type F32x16 = Wide<__m512>;
/// Eight `f64`.
pub type F64x8 = Wide<__m512d>;

const FLOOR: i32 = _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC;
const NEAREST: i32 = _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC;

register! { __m512: f32, 16, __mmask16;
    splat(x) = _mm512_set1_ps(x);
    add(a, b) = _mm512_add_ps(a, b);
    sub(a, b) = _mm512_sub_ps(a, b);
    mul(a, b) = _mm512_mul_ps(a, b);
    div(a, b) = _mm512_div_ps(a, b);
    fma(a, b, c) = _mm512_fmadd_ps(a, b, c);
    sqrt(a) = _mm512_sqrt_ps(a);
    min(a, b) = _mm512_min_ps(a, b);
    max(a, b) = _mm512_max_ps(a, b);
    floor(a) = _mm512_roundscale_ps::<FLOOR>(a);
    round(a) = _mm512_roundscale_ps::<NEAREST>(a);
    lt(a, b) = _mm512_cmp_ps_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm512_cmp_ps_mask::<_CMP_LE_OQ>(a, b);
    eq(a, b) = _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(a, b);
    select(mask, yes, no) = _mm512_mask_blend_ps(mask, no, yes);
    and(a, b) = _mm512_and_ps(a, b);
    or(a, b) = _mm512_or_ps(a, b);
    xor(a, b) = _mm512_xor_ps(a, b);
    to_exponent(a) = _mm512_castsi512_ps(_mm512_slli_epi32::<23>(_mm512_castps_si512(a)));
    from_exponent(a) = _mm512_castsi512_ps(_mm512_srli_epi32::<23>(_mm512_castps_si512(a)));
}

register! { __m512d: f64, 8, __mmask8;
    splat(x) = _mm512_set1_pd(x);
    add(a, b) = _mm512_add_pd(a, b);
    sub(a, b) = _mm512_sub_pd(a, b);
    mul(a, b) = _mm512_mul_pd(a, b);
    div(a, b) = _mm512_div_pd(a, b);
    fma(a, b, c) = _mm512_fmadd_pd(a, b, c);
    sqrt(a) = _mm512_sqrt_pd(a);
    min(a, b) = _mm512_min_pd(a, b);
    max(a, b) = _mm512_max_pd(a, b);
    floor(a) = _mm512_roundscale_pd::<FLOOR>(a);
    round(a) = _mm512_roundscale_pd::<NEAREST>(a);
    lt(a, b) = _mm512_cmp_pd_mask::<_CMP_LT_OQ>(a, b);
    le(a, b) = _mm512_cmp_pd_mask::<_CMP_LE_OQ>(a, b);
    eq(a, b) = _mm512_cmp_pd_mask::<_CMP_EQ_OQ>(a, b);
    select(mask, yes, no) = _mm512_mask_blend_pd(mask, no, yes);
    and(a, b) = _mm512_and_pd(a, b);
    or(a, b) = _mm512_or_pd(a, b);
    xor(a, b) = _mm512_xor_pd(a, b);
    to_exponent(a) = _mm512_castsi512_pd(_mm512_slli_epi64::<52>(_mm512_castpd_si512(a)));
    from_exponent(a) = _mm512_castsi512_pd(_mm512_srli_epi64::<52>(_mm512_castpd_si512(a)));
}

/// A bit per lane.
macro_rules! mask {
    ($mask:ty) => {
        impl Mask for $mask {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                if value { Self::MAX } else { 0 }
            }
        }
        impl LanesMask for $mask {
            #[inline(always)]
            fn any(self) -> bool {
                self != 0
            }
            #[inline(always)]
            fn all(self) -> bool {
                self == Self::MAX
            }
        }
    };
}

mask!(__mmask16);
mask!(__mmask8);
