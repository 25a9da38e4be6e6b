//! A recorded kernel does what the kernel does, and prints as valid WGSL.

use kinetarium_numbers::machine::space::{Input, Kind, Output, Parameter, Scratch, State};
use kinetarium_numbers::machine::{Held, Hold, Index, Links};
use kinetarium_numbers::trace::{
    self, InterpretError, Operations, Program, TraceError, Tracer, WgslError, WgslOptions,
};
use kinetarium_numbers::{Cpu, Machine, Mask, Quat, Real, Shared, Table, Vec3};
use proptest::prelude::*;

/// The memories of one world.
#[derive(Clone, Debug, Default)]
struct World {
    state: Vec<f32>,
    input: Vec<f32>,
    output: Vec<f32>,
    scratch: Vec<f32>,
    parameters: Vec<f32>,
    links: Vec<u32>,
}

impl World {
    fn cpu(&mut self) -> Cpu<'_, f32, Shared<'_, f32>> {
        Cpu {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: Shared(&self.parameters),
            links: &self.links,
        }
    }

    /// What a kernel can write, as bits, every NaN as the same NaN.
    fn bits(&self) -> Vec<u32> {
        let numbers = [&self.state, &self.output, &self.scratch];
        let canonical = |x: &f32| {
            if x.is_nan() {
                f32::NAN.to_bits()
            } else {
                x.to_bits()
            }
        };
        numbers.into_iter().flatten().map(canonical).collect()
    }
}

/// Parses and validates a shader as wgpu would.
fn validate(shader: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(shader)
        .unwrap_or_else(|e| panic!("{}", e.emit_to_string(shader)));
    naga::valid::Validator::new(
        naga::valid::ValidationFlags::all(),
        naga::valid::Capabilities::default(),
    )
    .validate(&module)
    .unwrap_or_else(|e| panic!("{}", e.emit_to_string(shader)));
    module
}

/// Runs a kernel and its record on copies of a world, demands the same bits and
/// valid WGSL, and gives the record and the world afterwards.
macro_rules! agree {
    ($world:expr, $kernel:ident($($argument:expr),* $(,)?)) => {{
        let mut expected = $world.clone();
        $kernel(&mut expected.cpu(), $($argument),*);
        let program = trace::record(|k| $kernel(k, $($argument),*)).unwrap();
        let mut found = $world.clone();
        program.interpret(&mut found.cpu()).unwrap();
        assert_eq!(expected.bits(), found.bits());
        for parameters_per_world in [false, true] {
            let options = WgslOptions { parameters_per_world, ..WgslOptions::default() };
            validate(&program.to_wgsl(&options).unwrap());
        }
        (program, expected)
    }};
}

/// Numbers that try the corners of every operation.
const CORNERS: [f32; 18] = [
    0.0,
    -0.0,
    1.0,
    -1.0,
    0.5,
    2.5,
    -3.5,
    1e-3,
    7.3,
    -123.456,
    8388609.0,
    1e30,
    -1e-30,
    1e-40,
    f32::MAX,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

const OPERATIONS: usize = 32;

/// Every operation of `Real` and of its mask on each pair of inputs.
fn every_operation<M: Machine>(k: &mut M, inputs: Table<Input>, results: Table<Output>, n: usize) {
    let one = M::R::one();
    for i in k.count(n) {
        let (a, b, c) = (
            k.load(inputs, i, 0),
            k.load(inputs, i, 1),
            k.load(inputs, i, 2),
        );
        let flag = |mask| M::R::select(mask, one, M::R::zero());
        let (fraction, exponent) = a.frexp();
        let mut sum = a;
        sum += b;
        let mut difference = a;
        difference -= b;
        let mut product = a;
        product *= b;
        let values: [M::R; OPERATIONS] = [
            a + b,
            a - b,
            a * b,
            a / b,
            -a,
            a.fma(b, c),
            a.fnma(b, c),
            a.sqrt(),
            a.abs(),
            a.min(b),
            a.max(b),
            a.clamp(b, c),
            a.floor(),
            a.round(),
            a.copysign(b),
            a.ldexp(b),
            fraction,
            exponent,
            a.squared(),
            a.recip(),
            flag(a.lt(b)),
            flag(a.le(b)),
            flag(a.gt(b)),
            flag(a.ge(b)),
            flag(a.same(b)),
            flag(a.lt(b) & b.lt(c)),
            flag(a.lt(b) | b.lt(c)),
            flag(!a.lt(b)),
            M::R::select(a.lt(b), b, c),
            sum,
            difference,
            product,
        ];
        for (field, value) in values.into_iter().enumerate() {
            k.store(results, i, field, value);
        }
    }
}

#[test]
fn every_operation_has_the_bits_of_f32() {
    let mut world = World::default();
    for a in CORNERS {
        for b in CORNERS {
            world.input.extend([a, b, 0.75 * b]);
        }
    }
    let n = world.input.len() / 3;
    world.output = vec![0.0; n * OPERATIONS];
    let inputs = Table::place(&mut 0, n, 3);
    let results = Table::place(&mut 0, n, OPERATIONS);
    let (program, _) = agree!(world, every_operation(inputs, results, n));
    assert_eq!(program.operations().stores, OPERATIONS);
}
