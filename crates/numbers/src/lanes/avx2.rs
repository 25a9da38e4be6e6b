//! AVX2 with FMA: two registers, masks as registers of ones and zeros.

#![allow(unsafe_code)] // intrinsics of an instruction set that dispatch has detected

use super::{Bits, BitsRegister, Pair, Wide, register};
use core::arch::x86_64::*;

/// Sixteen `f32`.
pub type F32x16 = Wide<Pair<__m256>>;
/// Eight `f64`.
pub type F64x8 = Wide<Pair<__m256d>>;

register! { __m256: f32, 8, Bits<Self>;
    splat(x) = _mm256_set1_ps(x);
    add(a, b) = _mm256_add_ps(a, b);
    sub(a, b) = _mm256_sub_ps(a, b);
    mul(a, b) = _mm256_mul_ps(a, b);
    div(a, b) = _mm256_div_ps(a, b);
    fma(a, b, c) = _mm256_fmadd_ps(a, b, c);
    sqrt(a) = _mm256_sqrt_ps(a);
    min(a, b) = _mm256_min_ps(a, b);
    max(a, b) = _mm256_max_ps(a, b);
    floor(a) = _mm256_floor_ps(a);
    round(a) = _mm256_round_ps::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
    lt(a, b) = Bits(_mm256_cmp_ps::<_CMP_LT_OQ>(a, b));
    le(a, b) = Bits(_mm256_cmp_ps::<_CMP_LE_OQ>(a, b));
    eq(a, b) = Bits(_mm256_cmp_ps::<_CMP_EQ_OQ>(a, b));
    select(mask, yes, no) = _mm256_blendv_ps(no, yes, mask.0);
    and(a, b) = _mm256_and_ps(a, b);
    or(a, b) = _mm256_or_ps(a, b);
    xor(a, b) = _mm256_xor_ps(a, b);
    to_exponent(a) = _mm256_castsi256_ps(_mm256_slli_epi32::<23>(_mm256_castps_si256(a)));
    from_exponent(a) = _mm256_castsi256_ps(_mm256_srli_epi32::<23>(_mm256_castps_si256(a)));
}

register! { __m256d: f64, 4, Bits<Self>;
    splat(x) = _mm256_set1_pd(x);
    add(a, b) = _mm256_add_pd(a, b);
    sub(a, b) = _mm256_sub_pd(a, b);
    mul(a, b) = _mm256_mul_pd(a, b);
    div(a, b) = _mm256_div_pd(a, b);
    fma(a, b, c) = _mm256_fmadd_pd(a, b, c);
    sqrt(a) = _mm256_sqrt_pd(a);
    min(a, b) = _mm256_min_pd(a, b);
    max(a, b) = _mm256_max_pd(a, b);
    floor(a) = _mm256_floor_pd(a);
    round(a) = _mm256_round_pd::<{ _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC }>(a);
    lt(a, b) = Bits(_mm256_cmp_pd::<_CMP_LT_OQ>(a, b));
    le(a, b) = Bits(_mm256_cmp_pd::<_CMP_LE_OQ>(a, b));
    eq(a, b) = Bits(_mm256_cmp_pd::<_CMP_EQ_OQ>(a, b));
    select(mask, yes, no) = _mm256_blendv_pd(no, yes, mask.0);
    and(a, b) = _mm256_and_pd(a, b);
    or(a, b) = _mm256_or_pd(a, b);
    xor(a, b) = _mm256_xor_pd(a, b);
    to_exponent(a) = _mm256_castsi256_pd(_mm256_slli_epi64::<52>(_mm256_castpd_si256(a)));
    from_exponent(a) = _mm256_castsi256_pd(_mm256_srli_epi64::<52>(_mm256_castpd_si256(a)));
}

impl BitsRegister for __m256 {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        // SAFETY: the instruction exists here; see the module.
        unsafe { _mm256_movemask_ps(mask) != 0 }
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        // SAFETY: the instruction exists here; see the module.
        unsafe { _mm256_movemask_ps(mask) == 0xff }
    }
}

impl BitsRegister for __m256d {
    #[inline(always)]
    fn any(mask: Self) -> bool {
        // SAFETY: the instruction exists here; see the module.
        unsafe { _mm256_movemask_pd(mask) != 0 }
    }
    #[inline(always)]
    fn all(mask: Self) -> bool {
        // SAFETY: the instruction exists here; see the module.
        unsafe { _mm256_movemask_pd(mask) == 0xf }
    }
}
