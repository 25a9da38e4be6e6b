//! The stated error bounds of the elementary functions, over their whole range.

use core::f64::consts::{FRAC_PI_2, PI};
use kinetarium_numbers::{Float, Lanes, functions};

/// Error of `found` in units of the last place of `exact`, less the error of `exact`.
///
/// The standard library's functions in `f64` are exact for `f32`; for `f64` they
/// err by up to one unit themselves.
fn ulp<T: Float>(found: T, exact: f64) -> f64 {
    let (digits, smallest) = if T::DOUBLE { (53, -1022) } else { (24, -126) };
    let exponent = (exact.abs().log2().floor() as i32).max(smallest);
    // 2^(1 − digits) · 2^exponent in two factors, for subnormal results.
    let error = (found.to_f64() - exact) * 2f64.powi(digits - 1 - exponent / 2);
    (error * 2f64.powi(exponent / 2 - exponent)).abs() - if T::DOUBLE { 1.0 } else { 0.0 }
}

/// `n` points from `low` to `high`, rounded to `T`.
fn linear<T: Float>(low: f64, high: f64, n: usize) -> impl Iterator<Item = T> {
    (0..=n).map(move |i| T::from_f64(low + (high - low) * (i as f64 / n as f64)))
}

/// `n` points from 10^`low` to 10^`high`, evenly by magnitude, rounded to `T`.
fn decades<T: Float>(low: f64, high: f64, n: usize) -> impl Iterator<Item = T> {
    linear::<f64>(low, high, n).map(|e| T::from_f64(10f64.powf(e)))
}

/// Applies a function of one number read as `R`.
fn apply<R: Lanes>(f: fn(R) -> R, x: R::Scalar) -> R::Scalar {
    bytemuck::cast_slice(&[f(R::splat(x))])[0]
}

const N: usize = 200_000;

/// Sine and cosine of x/2, up to a common sign.
fn half_angle<R: Lanes>(x: R::Scalar, bound: f64) {
    let s = apply::<R>(|x| functions::half_sin_cos(x).0, x).to_f64();
    let c = apply::<R>(|x| functions::half_sin_cos(x).1, x).to_f64();
    let (exact_s, exact_c) = (0.5 * x.to_f64()).sin_cos();
    let sign = (s * exact_s + c * exact_c).signum();
    assert!(
        (sign * s - exact_s).abs() < bound && (sign * c - exact_c).abs() < bound,
        "half of {x:?}: {s}, {c}, not ±({exact_s}, {exact_c})"
    );
}

fn trigonometric<R: Lanes>() {
    let range = if R::Scalar::DOUBLE { 1e6 } else { 1e4 };
    let one_ulp = if R::Scalar::DOUBLE {
        f64::EPSILON
    } else {
        f64::from(f32::EPSILON)
    };
    for x in linear::<R::Scalar>(-range, range, N) {
        let (s, c) = (apply::<R>(functions::sin, x), apply::<R>(functions::cos, x));
        let (exact_s, exact_c) = x.to_f64().sin_cos();
        assert!(
            (s.to_f64() - exact_s).abs() < one_ulp,
            "sin {x:?} = {s:?}, not {exact_s}"
        );
        assert!(
            (c.to_f64() - exact_c).abs() < one_ulp,
            "cos {x:?} = {c:?}, not {exact_c}"
        );
        half_angle::<R>(x, 2.0 * one_ulp);
    }
    for x in linear::<R::Scalar>(-PI, PI, N) {
        half_angle::<R>(x, 1.5 * one_ulp);
    }
    for x in linear::<R::Scalar>(-0.785, 0.785, N) {
        let (s, c) = (apply::<R>(functions::sin, x), apply::<R>(functions::cos, x));
        assert!(ulp(s, x.to_f64().sin()) < 2.0, "sin {x:?} = {s:?}");
        assert!(ulp(c, x.to_f64().cos()) < 2.0, "cos {x:?} = {c:?}");
    }
    for x in linear::<R::Scalar>(-1.0, 1.0, N).chain(decades(-30.0, 0.0, N)) {
        let (a, b) = (
            apply::<R>(functions::acos, x),
            apply::<R>(functions::asin, x),
        );
        assert!(ulp(a, x.to_f64().acos()) < 4.0, "acos {x:?} = {a:?}");
        assert!(ulp(b, x.to_f64().asin()) < 4.0, "asin {x:?} = {b:?}");
    }
}

fn angle_of_point<R: Lanes>() {
    let atan2 = |y: R::Scalar, x: R::Scalar| -> R::Scalar {
        bytemuck::cast_slice(&[functions::atan2(R::splat(y), R::splat(x))])[0]
    };
    for angle in linear::<f64>(-PI, PI, N) {
        for length in [1e-20, 0.3, 1e18] {
            let y = R::Scalar::from_f64(length * angle.sin());
            let x = R::Scalar::from_f64(length * angle.cos());
            let (found, exact) = (atan2(y, x), y.to_f64().atan2(x.to_f64()));
            assert!(
                ulp(found, exact) < 3.0,
                "atan2({y:?}, {x:?}) = {found:?}, not {exact}"
            );
        }
    }
    let t = R::Scalar::from_f64;
    let pi = t(PI);
    assert_eq!(atan2(t(0.0), t(0.0)), t(0.0));
    assert_eq!(atan2(t(0.0), t(2.0)), t(0.0));
    assert_eq!(atan2(t(0.0), t(-2.0)), pi);
    assert_eq!(atan2(t(-0.0), t(-2.0)), -pi);
    assert_eq!(atan2(t(3.0), t(0.0)), t(FRAC_PI_2));
    assert!(!atan2(t(f64::NAN), t(1.0)).finite() && !atan2(t(1.0), t(f64::NAN)).finite());
}

fn exponential<R: Lanes>() {
    let (low, high) = if R::Scalar::DOUBLE {
        (-745.0, 709.7)
    } else {
        (-103.0, 88.7)
    };
    for x in linear::<R::Scalar>(low, high, N).chain(linear(-1.0, 1.0, N)) {
        let found = apply::<R>(functions::exp, x);
        assert!(ulp(found, x.to_f64().exp()) < 2.0, "exp {x:?} = {found:?}");
    }
    let (low, high) = if R::Scalar::DOUBLE {
        (-323.0, 308.0)
    } else {
        (-44.0, 38.0)
    };
    for x in decades::<R::Scalar>(low, high, N).chain(linear(0.5, 2.0, N)) {
        let found = apply::<R>(functions::log, x);
        assert!(ulp(found, x.to_f64().ln()) < 2.0, "log {x:?} = {found:?}");
    }
    let at = |f: fn(R) -> R, x: f64| apply::<R>(f, R::Scalar::from_f64(x)).to_f64();
    assert_eq!(at(functions::exp, f64::NEG_INFINITY), 0.0);
    assert_eq!(at(functions::exp, f64::INFINITY), f64::INFINITY);
    assert_eq!(at(functions::log, 0.0), f64::NEG_INFINITY);
    assert_eq!(at(functions::log, f64::INFINITY), f64::INFINITY);
    assert_eq!(at(functions::log, 1.0), 0.0);
    for x in [-1.0, f64::NEG_INFINITY, f64::NAN] {
        assert!(at(functions::log, x).is_nan());
    }
    for f in [
        functions::sin,
        functions::cos,
        functions::acos,
        functions::asin,
        functions::exp,
        |x| functions::half_sin_cos(x).0,
    ] {
        assert!(at(f, f64::NAN).is_nan());
    }
}

fn power<R: Lanes>() {
    let pow = |x: R::Scalar, y: R::Scalar| -> R::Scalar {
        bytemuck::cast_slice(&[functions::pow(R::splat(x), R::splat(y))])[0]
    };
    for x in decades::<R::Scalar>(-6.0, 6.0, N / 100) {
        for y in linear::<R::Scalar>(-5.0, 5.0, 100) {
            let exponent = y.to_f64() * x.to_f64().ln();
            let (found, exact) = (pow(x, y), x.to_f64().powf(y.to_f64()));
            let bound = 3.0 + 2.0 * exponent.abs();
            assert!(
                ulp(found, exact) < bound,
                "{x:?} ^ {y:?} = {found:?}, not {exact}"
            );
        }
    }
    let t = R::Scalar::from_f64;
    assert_eq!(pow(t(0.0), t(0.0)), t(1.0));
    assert_eq!(pow(t(-3.0), t(0.0)), t(1.0));
    assert_eq!(pow(t(0.0), t(0.5)), t(0.0));
    assert_eq!(pow(t(0.0), t(-0.5)), t(f64::INFINITY));
    assert!(!pow(t(-2.0), t(0.5)).finite());
}

macro_rules! bounds {
    ($($name:ident: $t:ty;)*) => {$(
        #[test]
        fn $name() {
            trigonometric::<$t>();
            angle_of_point::<$t>();
            exponential::<$t>();
            power::<$t>();
        }
    )*};
}

bounds! {
    single: f32;
    double: f64;
    single_unfused: <f32 as Float>::Unfused;
    double_unfused: <f64 as Float>::Unfused;
}
