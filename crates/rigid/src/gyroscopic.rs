//! The gyroscopic torque of a body that nothing holds, over a step.
//!
//! ω × I ω of the step's beginning gives a body that is no ball energy. That of a mean spin w of the step does no work,
//! since the momentum L = I ω changes across w, and so I w · (ω' − ω) = w · (L' − L) = 0:
//!
//! ```text
//! w = (ω + ω')/2     L' − L = −c w × (L' + L)     so     F(w) = I (w − ω) + c w × I w = 0
//! ```
//!
//! With c = h/2 it is the implicit midpoint rule of Euler's equations (Hairer, Lubich, Wanner, *Geometric Numerical
//! Integration*, 2006, §VII.5). With c = tan(h |w| / 2) / |w| it turns L in the body's axes by exp(−h w) (Rodrigues), so
//! that a body that turns by h w keeps both its energy and L in the world. Newton's method, from w = ω on, has
//! ∂F/∂w = I + c ([w×] I − [(I w)×]), in which c is held.
//!
//! A body that turns by more than [`FAR`] in a step, for which this is no approximation (there ∂F/∂w may be singular), has
//! the w of a shorter one. Other torques of the step do not enter w, which is of first order with them.

use numbers::{Mat3, Real, SymMat3, Vec3};

/// Newton's steps: with c = h/2 the error falls with h ω to the fourth, to the eighth and so on, with the other to the
/// fourth, the seventh, by three more each time.
const STEPS: usize = 2;

/// The way [rad] that a step is looked at for, at most.
const FAR: f64 = 1.5;

/// Divisors below this are of what is not there.
const TINY: f64 = 1e-30;

/// w × I w with w by the midpoint rule, of a body with inertia I and spin ω along the same axes; ω × I ω where h is 0. What
/// that of a shorter step changes is spread over all of it.
#[inline(always)]
pub(crate) fn mean_torque<R: Real>(inertia: SymMat3<R>, spin: Vec3<R>, h: R) -> Vec3<R> {
    let (i, mut w) = (relative(inertia), spin);
    let half = half_of(h, spin);
    for _ in 0..STEPS {
        w = newton(i, spin, w, half);
    }
    let share = (half + half) / h.max(R::lit(TINY));
    let torque = w.cross(inertia * w);
    Vec3::select(h.gt(R::zero()), torque * share, torque)
}

/// w of a body that turns by h w, by no more than a quarter of a turn.
#[inline(always)]
pub(crate) fn mean_turn<R: Real>(i: SymMat3<R>, spin: Vec3<R>, h: R) -> Vec3<R> {
    let half = half_of(h, spin);
    let (i, mut w) = (relative(i), spin);
    for _ in 0..STEPS {
        let x2 = ((half * half) * w.length_squared()).min(R::lit(0.64));
        w = newton(i, spin, w, half * tan_ratio(x2));
    }
    w
}

/// h / 2, but of no more than [`FAR`].
#[inline(always)]
fn half_of<R: Real>(h: R, spin: Vec3<R>) -> R {
    let fits = R::lit(FAR) / spin.length().max(R::lit(TINY));
    h.min(fits) * R::lit(0.5)
}

/// tan(x) / x of x², for x up to 0.8 within 1 %, and for x up to 0.25 within 1e-6.
#[inline(always)]
fn tan_ratio<R: Real>(x2: R) -> R {
    R::lit(17.0 / 315.0)
        .fma(x2, R::lit(2.0 / 15.0))
        .fma(x2, R::lit(1.0 / 3.0))
        .fma(x2, R::one())
}

/// Only ratios of moments count; so small ones lose nothing.
#[inline(always)]
fn relative<R: Real>(i: SymMat3<R>) -> SymMat3<R> {
    i.scaled(i.trace().max(R::lit(TINY)).recip())
}

/// The next w of Newton's method.
#[inline(always)]
fn newton<R: Real>(i: SymMat3<R>, spin: Vec3<R>, w: Vec3<R>, c: R) -> Vec3<R> {
    let (matrix, l) = (i.to_mat3(), i * w);
    let off = w.cross(l).fma(c, i * (w - spin));
    let turned = Mat3::from_columns(
        w.cross(matrix.x).fma(c, matrix.x),
        w.cross(matrix.y).fma(c, matrix.y),
        w.cross(matrix.z).fma(c, matrix.z),
    );
    w - (turned - Mat3::skew(l * c)).solve_well(off, R::lit(TINY))
}
