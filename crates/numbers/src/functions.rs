//! Elementary functions, branch-free, over any [`Real`].
//!
//! Each reduces its argument to a short interval, evaluates a polynomial there,
//! and undoes the reduction by selection. The polynomial is short for `f32` and
//! long for `f64`. Coefficients: S. Moshier, *Cephes* (1989), files `sinf.c`,
//! `expf.c` for `f32`; Sun Microsystems, *fdlibm* (1993), files `k_sin.c`, `k_cos.c`,
//! `s_atan.c`, `e_log.c`, and FreeBSD's `s_atanf.c`, `e_logf.c`. The
//! reductions are those of J.-M. Muller, *Elementary Functions* (3rd ed. 2016),
//! chapter 11.
//!
//! Bounds are in units of the last place (ulp) of the result, with a fused
//! multiply-add and without, and are checked in `tests/functions.rs`. A NaN
//! argument gives NaN.

use crate::{Float, Real};

/// The constant for the precision of `R`.
#[inline(always)]
fn by_precision<R: Real>(single: f64, double: f64) -> R {
    R::lit(if R::Scalar::DOUBLE { double } else { single })
}

/// Horner's scheme; the coefficient of the highest power comes first.
#[inline(always)]
fn polynomial<R: Real, const N: usize>(x: R, coefficients: [f64; N]) -> R {
    let mut sum = R::lit(coefficients[0]);
    for c in &coefficients[1..] {
        sum = sum.fma(x, R::lit(*c));
    }
    sum
}

/// `(sin x, cos x)`, x in radians.
///
/// For |x| ≤ 10⁴ (`f32`) or 10⁶ (`f64`): absolute error below 1 ulp of 1, and
/// relative error below 2 ulp for |x| ≤ π/4. Beyond, the error grows with |x|.
#[inline(always)]
pub fn sin_cos<R: Real>(x: R) -> (R, R) {
    // Cody & Waite: π/2 in three parts; q times the first is exact.
    let q = (x * R::lit(core::f64::consts::FRAC_2_PI)).round();
    let a = by_precision(1.5703125, 1.570_796_326_734_125_6);
    let b = by_precision(4.837_512_969_970_703e-4, 6.077_100_506_506_192e-11);
    let c = by_precision(7.549_789_954_891_882e-8, 3.521_559_865_183_2e-27);
    let r = q.fnma(c, q.fnma(b, q.fnma(a, x)));

    let z = r * r;
    let (s, c) = if R::Scalar::DOUBLE {
        let s = [
            1.589_690_995_211_55e-10,
            -2.505_076_025_340_686_3e-8,
            2.755_731_370_707_006_8e-6,
            -1.984_126_982_985_795e-4,
            8.333_333_333_322_49e-3,
            -1.666_666_666_666_663_2e-1,
        ];
        let c = [
            -1.135_964_755_778_819_5e-11,
            2.087_572_321_298_175e-9,
            -2.755_731_435_139_066_3e-7,
            2.480_158_728_947_673e-5,
            -1.388_888_888_887_411e-3,
            4.166_666_666_666_66e-2,
        ];
        (polynomial(z, s), polynomial(z, c))
    } else {
        let s = [-1.951_529_589_1e-4, 8.332_160_873_6e-3, -1.666_665_461_1e-1];
        let c = [
            2.443_315_711_809_948e-5,
            -1.388_731_625_493_765e-3,
            4.166_664_568_298_827e-2,
        ];
        (polynomial(z, s), polynomial(z, c))
    };
    let sin = (r * z).fma(s, r);
    let cos = (z * z).fma(c, z.fma(R::lit(-0.5), R::one()));

    // Quadrant 0, 1, 2 or 3: swapped in 1 and 3; sine negative in 2 and 3, cosine in 1 and 2.
    let j = (q * R::lit(0.25)).floor().fma(R::lit(-4.0), q);
    let swap = (j - R::lit(2.0)).abs().same(R::one());
    let (sin, cos) = (R::select(swap, cos, sin), R::select(swap, sin, cos));
    let sin = R::select(j.gt(R::lit(1.5)), -sin, sin);
    let cos = R::select((j - R::lit(1.5)).abs().lt(R::one()), -cos, cos);
    (sin, cos)
}

/// Sine and cosine of half the angle x [rad], up to a sign that both share: either of the two
/// unit quaternions of a turn by x. About half of the work of [`sin_cos`].
///
/// x/2 is reduced by multiples of π, which change both signs, to [−π/2, π/2], where the polynomials
/// are minimax (Remez, absolute error: 5e-9 and 4e-10 for `f32`, 2e-19 and 6e-18 for `f64`).
/// Absolute error below 1.5 ulp of 1 for |x| ≤ π, below 2 ulp for |x| ≤ 10⁴ (`f32`) or 10⁶ (`f64`).
#[inline(always)]
pub fn half_sin_cos<R: Real>(x: R) -> (R, R) {
    // As in `sin_cos`, for π in place of π/2.
    let q = (x * R::lit(0.5 * core::f64::consts::FRAC_1_PI)).round();
    let a = by_precision(3.140625, 3.141_592_653_468_251_2);
    let b = by_precision(9.675_025_939_941_406e-4, 1.215_420_101_301_238_4e-10);
    let c = by_precision(1.509_957_990_978_376_4e-7, 7.043_119_730_366_4e-27);
    let r = q.fnma(c, q.fnma(b, q.fnma(a, x * R::lit(0.5))));

    let z = r * r;
    let (s, c) = if R::Scalar::DOUBLE {
        let s = [
            2.718_450_658_690_686_6e-15,
            -7.642_708_526_601_142e-13,
            1.605_892_766_392_657_6e-10,
            -2.505_210_660_310_411e-8,
            2.755_731_920_774_667_3e-6,
            -1.984_126_984_118_571e-4,
            8.333_333_333_333_113e-3,
            -1.666_666_666_666_666_5e-1,
        ];
        let c = [
            4.616_054_734_742_394e-14,
            -1.146_362_840_469_558_3e-11,
            2.087_659_234_785_104e-9,
            -2.755_731_706_422_541_6e-7,
            2.480_158_728_574_457_4e-5,
            -1.388_888_888_882_987_3e-3,
            4.166_666_666_666_583e-2,
        ];
        (polynomial(z, s), polynomial(z, c))
    } else {
        let s = [
            2.599_979_030_440_725e-6,
            -1.980_658_117_028_782e-4,
            8.333_016_823_844_805e-3,
            -1.666_665_707_756_723_8e-1,
        ];
        let c = [
            -2.619_314_991_582_131e-7,
            2.476_927_247_796_573e-5,
            -1.388_856_868_800_766e-3,
            4.166_665_575_158_175e-2,
        ];
        (polynomial(z, s), polynomial(z, c))
    };
    let sin = (r * z).fma(s, r);
    let cos = (z * z).fma(c, z.fma(R::lit(-0.5), R::one()));
    (sin, cos)
}

/// Sine of x (rad); as [`sin_cos`].
#[inline(always)]
pub fn sin<R: Real>(x: R) -> R {
    sin_cos(x).0
}

/// Cosine of x (rad); as [`sin_cos`].
#[inline(always)]
pub fn cos<R: Real>(x: R) -> R {
    sin_cos(x).1
}

/// Angle of the point (x, y) from the x axis, in [−π, π]. Error below 3 ulp.
///
/// `atan2(±0, x)` is ±0 for x ≥ 0, and for x = −0 too. The sum |x| + |y| must not
/// overflow.
#[inline(always)]
pub fn atan2<R: Real>(y: R, x: R) -> R {
    // First octant: the angle of (far, near). Above π/8, turn by π/4: t = (near − far)/(near + far).
    let steep = x.abs().lt(y.abs());
    let near = R::select(steep, x.abs(), y.abs());
    let far = R::select(steep, y.abs(), x.abs());
    let turn = near.gt(far * R::lit(0.414_213_562_373_095_05));
    let numerator = R::select(turn, near - far, near);
    let denominator = R::select(turn, near + far, far);
    let origin = denominator.same(R::zero());
    let t = numerator / R::select(origin, R::one(), denominator);

    let z = t * t;
    let p = if R::Scalar::DOUBLE {
        let p = [
            -1.628_582_011_536_578_2e-2,
            3.653_157_274_421_691_6e-2,
            -4.976_877_994_615_932e-2,
            5.833_570_133_790_573_5e-2,
            -6.661_073_137_387_531e-2,
            7.691_876_205_044_83e-2,
            -9.090_887_133_436_507e-2,
            1.111_111_040_546_235_6e-1,
            -1.428_571_427_250_346_6e-1,
            1.999_999_999_987_648_3e-1,
            -3.333_333_333_333_293e-1,
        ];
        polynomial(z, p)
    } else {
        let p = [
            -6.168_760_731_8e-2,
            1.064_801_737_7e-1,
            -1.425_363_570_5e-1,
            1.999_915_838_2e-1,
            -3.333_332_836_6e-1,
        ];
        polynomial(z, p)
    };
    let angle = (t * z).fma(p, t);

    // Back to the circle: angle ← k π/4 ± angle, π/4 in two parts.
    let k = R::select(turn, R::one(), R::zero());
    let (k, angle) = (
        R::select(steep, R::lit(2.0) - k, k),
        R::select(steep, -angle, angle),
    );
    let left = x.lt(R::zero());
    let (k, angle) = (
        R::select(left, R::lit(4.0) - k, k),
        R::select(left, -angle, angle),
    );
    let high = R::lit(core::f64::consts::FRAC_PI_4);
    let low = by_precision(-2.185_569_5e-8, 3.061_616_997_868_383e-17);
    k.fma(high, k.fma(low, angle)).copysign(y)
}

/// −1 … 1, and NaN for NaN, which [`Real::clamp`] would replace.
#[inline(always)]
fn within_one<R: Real>(x: R) -> R {
    R::one().min((-R::one()).max(x))
}

/// √(1 − x²) without cancellation near |x| = 1.
#[inline(always)]
fn cathetus<R: Real>(x: R) -> R {
    ((R::one() - x) * (R::one() + x)).sqrt()
}

/// Angle in [0, π] whose cosine is x, clamped to [−1, 1]. Error below 4 ulp.
#[inline(always)]
pub fn acos<R: Real>(x: R) -> R {
    let x = within_one(x);
    atan2(cathetus(x), x)
}

/// Angle in [−π/2, π/2] whose sine is x, clamped to [−1, 1]. Error below 4 ulp.
#[inline(always)]
pub fn asin<R: Real>(x: R) -> R {
    let x = within_one(x);
    atan2(x, cathetus(x))
}

/// ln 2 = high + low; a whole number below 2¹¹ times `high` is exact.
#[inline(always)]
fn ln2<R: Real>() -> (R, R) {
    (
        by_precision(6.931_381_225_6e-1, 6.931_471_803_691_238e-1),
        by_precision(9.058_000_614_5e-6, 1.908_214_929_270_587_7e-10),
    )
}

/// The largest finite number.
#[inline(always)]
fn largest<R: Real>() -> R {
    by_precision(f64::from(f32::MAX), f64::MAX)
}

/// eˣ. Error below 2 ulp; 0 and ∞ beyond the range of the number.
#[inline(always)]
pub fn exp<R: Real>(x: R) -> R {
    // eˣ = 2ⁿ eʳ with |r| ≤ ln 2 / 2.
    let x = by_precision::<R>(-104.0, -746.0).max(x);
    let x = by_precision::<R>(89.0, 710.0).min(x);
    let n = (x * R::lit(core::f64::consts::LOG2_E)).round();
    let (high, low) = ln2();
    let r = n.fnma(low, n.fnma(high, x));
    let p = if R::Scalar::DOUBLE {
        // Taylor's series; the first term left out is below 5e-18.
        let p = [
            1.0 / 6_227_020_800.0,
            1.0 / 479_001_600.0,
            1.0 / 39_916_800.0,
            1.0 / 3_628_800.0,
            1.0 / 362_880.0,
            1.0 / 40_320.0,
            1.0 / 5_040.0,
            1.0 / 720.0,
            1.0 / 120.0,
            1.0 / 24.0,
            1.0 / 6.0,
            0.5,
        ];
        polynomial(r, p)
    } else {
        let p = [
            1.987_569_15e-4,
            1.398_199_950_7e-3,
            8.333_451_907_3e-3,
            4.166_579_589_4e-2,
            1.666_666_545_9e-1,
            5.000_000_120_1e-1,
        ];
        polynomial(r, p)
    };
    ((r * r).fma(p, r) + R::one()).ldexp(n)
}

/// Natural logarithm. Error below 2 ulp; −∞ at 0, NaN below.
#[inline(always)]
pub fn log<R: Real>(x: R) -> R {
    // A subnormal number is scaled up first: x = m 2ᵉ with m in [√½, √2).
    let subnormal = x.lt(by_precision(1.175_494_350_822_287_5e-38, f64::MIN_POSITIVE));
    let (m, e) = R::select(subnormal, x * R::lit(18_014_398_509_481_984.0), x).frexp();
    let e = R::select(subnormal, e - R::lit(54.0), e);
    let large = m.gt(R::lit(core::f64::consts::SQRT_2));
    let e = R::select(large, e + R::one(), e);
    let f = R::select(large, m * R::lit(0.5), m) - R::one();

    // ln(1 + f) = f − f²/2 + s (f²/2 + R(s²)), s = f/(2 + f).
    let s = f / (R::lit(2.0) + f);
    let z = s * s;
    let p = if R::Scalar::DOUBLE {
        let p = [
            1.479_819_860_511_658_6e-1,
            1.531_383_769_920_937_3e-1,
            1.818_357_216_161_805e-1,
            2.222_219_843_214_978_4e-1,
            2.857_142_874_366_239e-1,
            3.999_999_999_940_942e-1,
            6.666_666_666_666_735e-1,
        ];
        polynomial(z, p)
    } else {
        let p = [
            0.242_790_788_41,
            0.284_987_866_88,
            0.400_009_721_52,
            0.666_666_626_93,
        ];
        polynomial(z, p)
    };
    let h = f * f * R::lit(0.5);
    let (high, low) = ln2();
    let rest = s.fma(z.fma(p, h), e * low);
    let y = e.fma(high, f - (h - rest));

    let y = R::select(x.gt(largest()), x, y);
    // −1/0 at 0, else 0/0.
    let pole = R::select(x.same(R::zero()), -R::one(), R::zero()) / R::zero();
    R::select(x.gt(R::zero()), y, pole)
}

/// xʸ for x ≥ 0, as exp(y ln x): error below 3 + 2 |y ln x| ulp.
///
/// x⁰ = 1 for every x; 0ʸ is 0 for y > 0 and ∞ for y < 0. NaN for negative x.
#[inline(always)]
pub fn pow<R: Real>(x: R, y: R) -> R {
    // Where x⁰ is not exp(0 ln x), the base is 1.
    let ordinary = x.gt(R::zero()) & x.le(largest());
    let base = R::select(y.same(R::zero()) & !ordinary, R::one(), x);
    exp(y * log(base))
}

/// Neither infinite nor NaN.
///
/// Read from the bits of the exponent: a shader may assume that no number is NaN,
/// and fold a comparison that relies on it.
#[inline(always)]
pub fn finite<R: Real>(x: R) -> R::Mask {
    let beyond = if R::Scalar::DOUBLE { 1023.5 } else { 127.5 };
    x.frexp().1.lt(R::lit(beyond))
}

/// `x` (rad) less whole turns, in [−π, π].
#[inline(always)]
pub fn wrap<R: Real>(x: R) -> R {
    let turns = (x * R::lit(0.5 / core::f64::consts::PI)).round();
    turns.fnma(R::lit(core::f64::consts::TAU), x)
}
