//! Slopes of dual numbers against closed forms.

use kinetarium_numbers::machine::{Cpu, Machine, Shared, Table, space};
use kinetarium_numbers::{Dual, Float, Mat3, Quat, Real, SymMat3, Vec3, functions};

type Function<R> = fn(R) -> R;

/// A function as a kernel writes it, its derivative, and where to compare.
struct Case<T: Float> {
    name: &'static str,
    function: Function<Dual<T>>,
    derivative: fn(f64) -> f64,
    from: f64,
    to: f64,
}

macro_rules! case {
    ($name:literal, |$x:ident| $function:expr, |$y:ident| $derivative:expr, $from:expr, $to:expr) => {
        Case {
            name: $name,
            function: |$x| $function,
            derivative: |$y: f64| $derivative,
            from: $from,
            to: $to,
        }
    };
}

fn cases<T: Float>() -> Vec<Case<T>> {
    vec![
        case!("x + x", |x| x + x, |_x| 2.0, -3.0, 3.0),
        case!("x² − x", |x| x * x - x, |x| 2.0 * x - 1.0, -3.0, 3.0),
        case!("1/x", |x| x.recip(), |x| -1.0 / (x * x), 0.1, 3.0),
        case!(
            "x/(1+x²)",
            |x| x / x.fma(x, Dual::one()),
            |x| (1.0 - x * x) / (1.0 + x * x).powi(2),
            -0.9,
            0.9
        ),
        case!(
            "x³ by fma",
            |x| x.squared().fma(x, -x),
            |x| 3.0 * x * x - 1.0,
            -3.0,
            3.0
        ),
        case!("√x", |x| x.sqrt(), |x| 0.5 / x.sqrt(), 0.01, 9.0),
        case!("|x|", |x| x.abs(), |x| x.signum(), -2.0, 2.1),
        case!(
            "min(x, 1)",
            |x| x.min(Dual::one()),
            |x| if x < 1.0 { 1.0 } else { 0.0 },
            -2.0,
            2.1
        ),
        case!(
            "max(x, 1)",
            |x| x.max(Dual::one()),
            |x| if x > 1.0 { 1.0 } else { 0.0 },
            -2.0,
            2.1
        ),
        case!(
            "copysign",
            |x| x.copysign(Dual::lit(-1.0)),
            |x| -x.signum(),
            -2.0,
            2.1
        ),
        case!("x 2⁵", |x| x.ldexp(Dual::lit(5.0)), |_x| 32.0, -2.0, 2.0),
        case!(
            "fraction",
            |x| x.frexp().0,
            |x| 2f64.powf(-x.log2().floor()),
            0.1,
            99.0
        ),
        case!("x − ⌊x⌋", |x| x - x.floor(), |_x| 1.0, -5.0, 5.0),
        case!("x − round x", |x| x - x.round(), |_x| 1.0, -5.0, 5.0),
        case!("sin", |x| functions::sin(x), |x| x.cos(), -20.0, 20.0),
        case!("cos", |x| functions::cos(x), |x| -x.sin(), -20.0, 20.0),
        case!(
            "acos",
            |x| functions::acos(x),
            |x| -1.0 / (1.0 - x * x).sqrt(),
            -0.95,
            0.95
        ),
        case!(
            "asin",
            |x| functions::asin(x),
            |x| 1.0 / (1.0 - x * x).sqrt(),
            -0.95,
            0.95
        ),
        case!(
            "atan",
            |x| functions::atan2(x, Dual::one()),
            |x| 1.0 / (1.0 + x * x),
            -8.0,
            8.0
        ),
        case!(
            "acot",
            |x| functions::atan2(-Dual::one(), x),
            |x| 1.0 / (1.0 + x * x),
            -8.0,
            8.0
        ),
        case!("exp", |x| functions::exp(x), |x| x.exp(), -10.0, 10.0),
        case!("log", |x| functions::log(x), |x| 1.0 / x, 0.01, 50.0),
        case!(
            "x^2.5",
            |x| functions::pow(x, Dual::lit(2.5)),
            |x| 2.5 * x.powf(1.5),
            0.01,
            5.0
        ),
        case!(
            "2^x",
            |x| functions::pow(Dual::lit(2.0), x),
            |x| 2f64.ln() * 2f64.powf(x),
            -5.0,
            5.0
        ),
    ]
}

fn compare<T: Float>(tolerance: f64) {
    for Case {
        name,
        function,
        derivative,
        from,
        to,
    } in cases::<T>()
    {
        for i in 0..=1000 {
            let x = T::from_f64(from + (to - from) * (f64::from(i) / 1000.0));
            let exact = derivative(x.to_f64());
            let found = function(Dual::variable(x)).slope.to_f64();
            let error = (found - exact).abs() / exact.abs().max(1.0);
            assert!(
                error < tolerance,
                "{name} at {x:?}: slope {found}, not {exact}"
            );
        }
    }
}

#[test]
fn slopes_in_single_precision() {
    compare::<f32>(2e-6);
}

#[test]
fn slopes_in_double_precision() {
    compare::<f64>(1e-14);
}

#[test]
fn kinks_and_poles_stay_finite() {
    let null = Vec3::new(
        Dual::variable(0.0),
        Dual::constant(0.0),
        Dual::constant(0.0),
    );
    assert_eq!(null.length(), Dual::constant(0.0));
    for x in [-1.0, 1.0, 2.0] {
        assert_eq!(functions::acos(Dual::variable(x)).slope, 0.0);
    }
    assert_eq!(
        functions::atan2(Dual::variable(0.0), Dual::constant(0.0)).slope,
        1.0
    );
}

#[test]
fn a_rotation_turns_a_vector_at_its_angular_velocity() {
    // d/dt exp(ω t) r = ω × exp(ω t) r
    let (w, r) = (Vec3::new(0.3, -1.2, 0.7), Vec3::new(1.0, 2.0, -0.5));
    let constant = |v: Vec3<f64>| Vec3::new(v.x, v.y, v.z).to_array().map(Dual::constant);
    let (dual_w, dual_r) = (Vec3::from_array(constant(w)), Vec3::from_array(constant(r)));
    let turned = Quat::exp(dual_w * Dual::variable(0.8)).rotate(dual_r);
    let value = Vec3::from_array(turned.to_array().map(|x| x.value));
    let slope = Vec3::from_array(turned.to_array().map(|x| x.slope));
    assert!((slope - w.cross(value)).length() < 1e-14);
}

#[test]
fn the_slope_of_a_solution_solves_the_differentiated_system() {
    // S x = b with S = S₀ + t 1: S x′ = −x
    let t = Dual::variable(0.5);
    let s = SymMat3::new(
        Vec3::new(Dual::lit(4.0) + t, Dual::lit(5.0) + t, Dual::lit(6.0) + t),
        Vec3::new(Dual::lit(0.5), Dual::lit(-0.3), Dual::lit(0.2)),
    );
    let b = Vec3::new(Dual::lit(1.0), Dual::lit(-2.0), Dual::lit(3.0));
    let x = s.solve(b, Dual::lit(1e-12));
    let plain =
        |v: Vec3<Dual<f64>>, part: fn(Dual<f64>) -> f64| Vec3::from_array(v.to_array().map(part));
    let (value, slope) = (plain(x, |d| d.value), plain(x, |d| d.slope));
    let columns = s.columns();
    let s = Mat3::from_columns(
        plain(columns.0, |d| d.value),
        plain(columns.1, |d| d.value),
        plain(columns.2, |d| d.value),
    );
    assert!((s * slope + value).length() < 1e-14);
}

/// A pendulum of length p₀ under gravity p₁: semi-implicit Euler.
fn pendulum<M: Machine>(
    k: &mut M,
    state: Table<space::State, 2>,
    parameters: Table<space::Parameter, 2>,
) {
    let row = k.index(0);
    let h = M::R::lit(0.01);
    for _ in k.count(100) {
        let rate = k.load(parameters, row, 1) / k.load(parameters, row, 0);
        let acceleration = -(functions::sin(k.load(state, row, 0)) * rate);
        k.add(state, row, 1, acceleration * h);
        let velocity = k.load(state, row, 1);
        k.add(state, row, 0, velocity * h);
    }
}

#[test]
fn a_kernel_runs_on_duals() {
    let state = Table::place(&mut 0, 1);
    let constants = Table::place(&mut 0, 1);
    let run = |start: Dual<f64>| {
        let mut memory = [start, Dual::constant(0.0)];
        let mut cpu = Cpu {
            state: &mut memory,
            input: &[],
            output: &mut [],
            scratch: &mut [],
            parameters: Shared(&[1.0, 9.81]),
            links: &[],
        };
        pendulum(&mut cpu, state, constants);
        memory[0]
    };
    let found = run(Dual::variable(0.7));
    let e = 1e-6;
    let (above, below) = (
        run(Dual::constant(0.7 + e)).value,
        run(Dual::constant(0.7 - e)).value,
    );
    assert!((found.slope - (above - below) / (2.0 * e)).abs() < 1e-8);
}
