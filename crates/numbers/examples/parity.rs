//! Every operation, on every instruction set of this machine, bit for bit as in plain scalars.
//!
//! `cargo run --example parity` prints the number of checks and of failures. It
//! needs no test harness, so that it also runs under an emulator or WebAssembly.

use kinetarium_numbers::dispatch::{self, Isa, Job};
use kinetarium_numbers::{Float, Lanes, LanesMask, Mask, Quat, Real, Vec3, functions};
use std::process::ExitCode;

/// Operands of all operations: special values in all pairs, then random ones.
fn operands<T: Float>() -> [Vec<T>; 3] {
    let (tiny, huge) = if T::DOUBLE {
        (f64::MIN_POSITIVE, f64::MAX)
    } else {
        (f64::from(f32::MIN_POSITIVE), f64::from(f32::MAX))
    };
    let mut special = vec![f64::NAN, -f64::NAN];
    for x in [
        0.0,
        0.1,
        0.5,
        1.0,
        1.5,
        2.0,
        2.5,
        100.3,
        300.0,
        1e7,
        8_388_609.0,
        1e10,
    ] {
        special.extend([x, -x]);
    }
    for x in [
        tiny,
        tiny / 8.0,
        tiny * 0.999,
        huge,
        huge / 3.0,
        f64::INFINITY,
    ] {
        special.extend([x, -x]);
    }
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let [mut a, mut b, mut c] = [const { Vec::new() }; 3];
    for &x in &special {
        for &y in &special {
            a.push(T::from_f64(x));
            b.push(T::from_f64(y));
            c.push(T::from_f64(special[random.below(special.len())]));
        }
    }
    for i in 0..20_000 {
        let scale = if i % 2 == 0 { 4.0 } else { 80.0 };
        for operand in [&mut a, &mut b, &mut c] {
            operand.push(T::from_f64(
                random.symmetric() * (random.symmetric() * scale).exp(),
            ));
        }
    }
    let whole = a.len() / 16 * 16;
    for operand in [&mut a, &mut b, &mut c] {
        operand.truncate(whole);
    }
    [a, b, c]
}

/// Knuth's MMIX generator.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        self.0 >> 11
    }
    fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }
    /// Evenly in (−1, 1).
    fn symmetric(&mut self) -> f64 {
        self.next() as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// All operations on all operands; answers the results by operation.
struct Operations<'a, T>(&'a [Vec<T>; 3]);

impl<T: Float> Job for Operations<'_, T> {
    type Scalar = T;
    type Output = Vec<(&'static str, Vec<T>)>;

    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) -> Self::Output {
        let [a, b, c] = [0, 1, 2].map(|k| registers::<R>(&self.0[k]));
        let mut results = Vec::new();
        macro_rules! operations {
            ($($name:literal: |$x:ident, $y:ident, $z:ident| $body:expr;)+) => {$({
                let mut out: Vec<R> = Vec::with_capacity(a.len());
                for i in 0..a.len() {
                    let ($x, $y, $z) = (a[i], b[i], c[i]);
                    out.push($body);
                }
                results.push(($name, bytemuck::cast_slice(&out).to_vec()));
            })+};
        }
        operations! {
            "add": |x, y, _z| x + y;
            "sub": |x, y, _z| x - y;
            "mul": |x, y, _z| x * y;
            "div": |x, y, _z| x / y;
            "neg": |x, _y, _z| -x;
            "add_assign": |x, y, _z| { let mut s = x; s += y; s };
            "sub_assign": |x, y, _z| { let mut s = x; s -= y; s };
            "mul_assign": |x, y, _z| { let mut s = x; s *= y; s };
            "fma": |x, y, z| x.fma(y, z);
            "fnma": |x, y, z| x.fnma(y, z);
            "recip": |x, _y, _z| x.recip();
            "sqrt": |x, _y, _z| x.sqrt();
            "abs": |x, _y, _z| x.abs();
            "min": |x, y, _z| x.min(y);
            "max": |x, y, _z| x.max(y);
            "clamp": |x, y, z| x.clamp(y, z);
            "floor": |x, _y, _z| x.floor();
            "round": |x, _y, _z| x.round();
            "copysign": |x, y, _z| x.copysign(y);
            "ldexp": |x, y, _z| x.ldexp(y.round());
            "frexp fraction": |x, _y, _z| x.frexp().0;
            "frexp exponent": |x, _y, _z| x.frexp().1;
            "lit": |_x, _y, _z| R::lit(0.1);
            "splat": |_x, _y, _z| R::splat(T::from_f64(0.1));
            "lt": |x, y, _z| indicator(x.lt(y));
            "le": |x, y, _z| indicator(x.le(y));
            "gt": |x, y, _z| indicator(x.gt(y));
            "ge": |x, y, _z| indicator(x.ge(y));
            "same": |x, y, _z| indicator(x.same(y));
            "select": |x, y, z| R::select(x.lt(y), y, z);
            "mask and": |x, y, z| indicator(x.lt(y) & y.lt(z));
            "mask or": |x, y, z| indicator(x.lt(y) | y.lt(z));
            "mask not": |x, y, _z| indicator(!x.lt(y));
            "mask true": |_x, _y, _z| indicator::<R>(Mask::splat(true));
            "mask false": |_x, _y, _z| indicator::<R>(Mask::splat(false));
            "any and all": |x, y, _z| any_and_all_agree(x.lt(y));
            "sin": |x, _y, _z| functions::sin(x);
            "half_sin": |x, _y, _z| functions::half_sin_cos(x).0;
            "half_cos": |x, _y, _z| functions::half_sin_cos(x).1;
            "cos": |x, _y, _z| functions::cos(x);
            "atan2": |x, y, _z| functions::atan2(x, y);
            "acos": |x, _y, _z| functions::acos(x);
            "asin": |x, _y, _z| functions::asin(x);
            "exp": |x, _y, _z| functions::exp(x);
            "log": |x, _y, _z| functions::log(x);
            "pow": |x, y, _z| functions::pow(x.abs(), y);
            "quaternion": |x, y, z| Quat::exp(Vec3::new(x, y, z)).rotate(Vec3::new(z, x, y)).y;
        }
        results
    }
}

/// Scalars as registers, which are aligned more strictly.
fn registers<R: Lanes>(scalars: &[R::Scalar]) -> Vec<R> {
    let blocks = scalars.chunks_exact(R::WIDTH);
    blocks
        .map(|block| bytemuck::pod_read_unaligned(bytemuck::cast_slice(block)))
        .collect()
}

/// One where the mask holds, else zero.
#[inline(always)]
fn indicator<R: Real>(mask: R::Mask) -> R {
    R::select(mask, R::one(), R::zero())
}

/// One if `any` and `all` say what the lanes say.
#[inline(always)]
fn any_and_all_agree<R: Lanes>(mask: R::Mask) -> R {
    let lanes = [indicator::<R>(mask)];
    let lanes: &[R::Scalar] = bytemuck::cast_slice(&lanes);
    let held = lanes.iter().filter(|x| **x == R::Scalar::one()).count();
    let right = mask.any() == (held > 0) && mask.all() == (held == R::WIDTH);
    indicator(Mask::splat(right))
}

/// Equal to the bit; a NaN equals any NaN, since its payload is the hardware's choice.
fn same_bits<T: Float>(a: T, b: T) -> bool {
    let (a, b) = (a.to_f64(), b.to_f64());
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

/// Runs all operations on all instruction sets; answers the number of checks and the failures.
fn check<T: Float>() -> (usize, Vec<String>) {
    let operands = operands::<T>();
    let (mut checks, mut failures) = (0, Vec::new());
    for isa in Isa::available() {
        let expected = if isa.fused() {
            Operations(&operands).run::<T>()
        } else {
            Operations(&operands).run::<T::Unfused>()
        };
        let block = dispatch::run_block(isa, Operations(&operands));
        let single = dispatch::run_single(isa, Operations(&operands));
        for (width, found) in [(T::BLOCK, block), (1, single)] {
            for ((name, expected), (_, found)) in expected.iter().zip(&found) {
                for i in 0..expected.len() {
                    checks += 1;
                    if !same_bits(expected[i], found[i]) {
                        let [x, y, z] = [0, 1, 2].map(|k| operands[k][i]);
                        let (e, f) = (expected[i], found[i]);
                        failures.push(format!(
                            "{isa} x {width}: {name}({x:?}, {y:?}, {z:?}) = {f:?}, scalar {e:?}"
                        ));
                    }
                }
            }
        }
    }
    (checks, failures)
}

/// All checks in both precisions.
pub fn check_all() -> (usize, Vec<String>) {
    let (n, mut failures) = check::<f32>();
    let (m, more) = check::<f64>();
    failures.extend(more);
    (n + m, failures)
}

#[allow(dead_code)] // the test that includes this file does not call it
fn main() -> ExitCode {
    let (checks, failures) = check_all();
    for failure in failures.iter().take(20) {
        println!("{failure}");
    }
    let isas: Vec<_> = Isa::available().iter().map(Isa::to_string).collect();
    println!(
        "{}: {checks} checks, {} failed",
        isas.join(", "),
        failures.len()
    );
    if failures.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    }
}
