//! A recorded kernel does what the kernel does, and prints as valid WGSL.

use kinetarium_numbers::machine::space::{Input, Kind, Output, Parameter, Scratch, State};
use kinetarium_numbers::machine::{Cell, Held, Hold, Index, Links};
use kinetarium_numbers::trace::{
    self, InterpretError, Operations, PrintOptions, Program, TraceError, Tracer, WgslError,
};
use kinetarium_numbers::{Cpu, Machine, Mask, Real, Shared, Table, Vec3, functions};
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
            let options = PrintOptions { parameters_per_world, ..PrintOptions::default() };
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
fn every_operation<M: Machine>(
    k: &mut M,
    inputs: Table<Input, 3>,
    results: Table<Output, OPERATIONS>,
    n: usize,
) {
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
    let inputs = Table::place(&mut 0, n);
    let results = Table::place(&mut 0, n);
    let (program, _) = agree!(world, every_operation(inputs, results, n));
    assert_eq!(program.operations().stores, OPERATIONS);
}

const FUNCTIONS: usize = 10;

/// The elementary functions at each input.
fn every_function<M: Machine>(
    k: &mut M,
    inputs: Table<Input, 2>,
    results: Table<Output, FUNCTIONS>,
    n: usize,
) {
    for i in k.count(n) {
        let (x, y) = (k.load(inputs, i, 0), k.load(inputs, i, 1));
        let (sin, cos) = functions::sin_cos(x);
        let values: [M::R; FUNCTIONS] = [
            sin,
            cos,
            functions::sin(x),
            functions::cos(x),
            functions::atan2(y, x),
            functions::acos(x),
            functions::asin(x),
            functions::exp(x),
            functions::log(x),
            functions::pow(x, y),
        ];
        for (field, value) in values.into_iter().enumerate() {
            k.store(results, i, field, value);
        }
    }
}

#[test]
fn elementary_functions_have_the_bits_of_f32() {
    let mut world = World::default();
    for i in -20..20 {
        for y in [-2.5, -1.0, -0.3, 0.0, 0.7, 40.0] {
            world.input.extend([0.37 * i as f32, y]);
        }
    }
    let n = world.input.len() / 2;
    world.output = vec![0.0; n * FUNCTIONS];
    let inputs = Table::place(&mut 0, n);
    let results = Table::place(&mut 0, n);
    let (_, after) = agree!(world, every_function(inputs, results, n));
    let half = after.output[(20 * 6 + 4) * FUNCTIONS + 1];
    assert_eq!(half, 1.0, "cos 0");
}

/// A tree of bodies: row 0 of the poses is the world, body b lies in row b + 1.
#[derive(Clone, Copy)]
struct Tree {
    /// row of the parent's pose
    parents: Links,
    /// pose in the parent
    local: Table<Parameter, 7>,
    poses: Table<State, 7>,
    /// own weight, weight of the subtree
    weights: Table<Scratch, 2>,
    n: usize,
}

/// Poses from the root to the leaves, weights from the leaves to the root.
fn tree<M: Machine>(k: &mut M, t: Tree) {
    let spin = Vec3::new(M::R::lit(0.1), M::R::lit(-0.2), M::R::lit(0.3));
    for b in k.count(t.n) {
        let parent = k.link(t.parents, b, 0);
        let above = k.pose(t.poses, parent, 0);
        let mut pose = above * k.pose(t.local, b, 0);
        pose.q = pose.q.integrate(spin, M::R::lit(0.25));
        k.store_pose(t.poses, b.offset(1), 0, pose);
        k.store(t.weights, b.offset(1), 1, k.load(t.weights, b.offset(1), 0));
    }
    for b in k.range_down(k.index(t.n)) {
        let parent = k.link(t.parents, b, 0);
        let weight = k.load(t.weights, b.offset(1), 1);
        k.add(t.weights, parent, 1, weight);
    }
}

#[test]
fn links_lead_up_and_down_a_tree() {
    let n = 5;
    let mut world = World {
        links: vec![0, 1, 1, 3, 3],
        ..World::default()
    };
    for b in 0..n {
        let (s, c) = (0.3 * (b + 1) as f32).sin_cos();
        world
            .parameters
            .extend([0.1 * b as f32, 1.0, -0.5, 0.0, s, 0.0, c]);
        world.scratch.extend([0.0, 0.0]);
    }
    world.scratch = vec![0.0, 0.0, 1.0, 0.0, 2.0, 0.0, 4.0, 0.0, 8.0, 0.0, 16.0, 0.0];
    world.state = vec![0.0; 7 * (n + 1)];
    world.state[6] = 1.0;
    let t = Tree {
        parents: Links::place(&mut 0, n),
        local: Table::place(&mut 0, n),
        poses: Table::place(&mut 0, n + 1),
        weights: Table::place(&mut 0, n + 1),
        n,
    };
    let (program, after) = agree!(world, tree(t));
    let subtrees: Vec<f32> = after.scratch.chunks(2).map(|row| row[1]).collect();
    assert_eq!(subtrees, [31.0, 31.0, 2.0, 28.0, 8.0, 16.0]);
    assert_eq!(program.operations().loops, 2);
}

/// Heron's square root of each number in a row whose range is a pair of links,
/// and the sum of the roots: nested loops, cells, an early exit.
fn heron<M: Machine>(
    k: &mut M,
    rows: Links<2>,
    numbers: Table<State, 2>,
    sums: Table<Output>,
    n: usize,
) {
    for i in k.count(n) {
        let mut sum = k.cell(M::R::zero());
        let (from, to) = (k.link(rows, i, 0), k.link(rows, i, 1));
        for j in k.range(from, to) {
            let x = k.load(numbers, j, 0);
            let mut root = k.cell(x.max(M::R::one()));
            let mut rounds = k.cell(M::R::zero());
            for _ in k.count(30) {
                let old = root.read();
                let new = M::R::lit(0.5) * (old + x / old);
                root.write(new);
                if k.finished((new - old).abs().le(M::R::lit(1e-6) * old)) {
                    break;
                }
                rounds.write(rounds.read() + M::R::one());
            }
            k.store(numbers, j, 0, root.read());
            k.store(numbers, j, 1, rounds.read());
            sum.write(sum.read() + root.read());
        }
        k.store(sums, i, 0, sum.read());
    }
}

#[test]
fn cells_carry_values_and_loops_end_early() {
    let world = World {
        links: vec![0, 2, 2, 2, 2, 5],
        state: vec![4.0, 0.0, 9.0, 0.0, 2.0, 0.0, 1e8, 0.0, 0.25, 0.0],
        output: vec![0.0; 3],
        ..World::default()
    };
    let rows = Links::place(&mut 0, 3);
    let numbers = Table::place(&mut 0, 5);
    let sums = Table::place(&mut 0, 3);
    let (program, after) = agree!(world, heron(rows, numbers, sums, 3));
    assert_eq!(after.output[0], 5.0);
    assert_eq!(after.output[1], 0.0, "an empty range has no rounds");
    let rounds: Vec<f32> = after.state.chunks(2).map(|row| row[1]).collect();
    assert!(
        rounds[0] > 2.0 && rounds[0] < rounds[3] && rounds[3] < 30.0,
        "{rounds:?}"
    );
    assert_eq!(program.operations().loops, 3);
}

/// Each kind of row by its own rule: branches on links, indices and masks.
fn kinds<M: Machine>(k: &mut M, kinds: Links, table: Table<State, 3>, n: usize) {
    let mut total = Vec3::<M::R>::zero().hold(k);
    for i in k.count(n) {
        let kind = k.link(kinds, i, 0);
        let v = k.vec3(table, i, 0);
        if let Some(_branch) = k.when(k.equals(kind, 1)) {
            k.store_vec3(table, i, 0, v * M::R::lit(2.0));
        }
        if let Some(_branch) = k.when(k.less(kind, k.index(1))) {
            let long = v.length().gt(M::R::one());
            if let Some(_branch) = k.if_any(long) {
                k.store_where(long, table, i, 0, v.x.sqrt());
                total.set(total.get() + v);
            }
        }
    }
    if let Some(_branch) = k.when(k.equals(k.index(3), 3)) {
        let row = k.index(n).plus(k.index(0));
        k.store_vec3(table, row, 0, total.get());
    }
    if let Some(_branch) = k.if_any(<M::R as Real>::Mask::splat(false)) {
        k.store(table, k.index(usize::MAX), 0, M::R::one());
    }
    for i in k.range(k.index(3), k.index(3)) {
        k.store(table, i, 0, M::R::lit(99.0));
    }
}

#[test]
fn branches_are_taken_where_they_hold() {
    let world = World {
        links: vec![1, 0, 0, 2],
        state: vec![
            1., 1., 1., 4., 3., 2., 0.1, 0.2, 0.3, 5., 5., 5., 0., 0., 0.,
        ],
        ..World::default()
    };
    let links = Links::place(&mut 0, 4);
    let table = Table::place(&mut 0, 5);
    let (program, after) = agree!(world, kinds(links, table, 4));
    assert_eq!(after.state[..6], [2., 2., 2., 2., 3., 2.]);
    assert_eq!(after.state[6..12], world.state[6..12]);
    assert_eq!(after.state[12..], [4., 3., 2.]);
    let counted = Operations {
        loops: 1,
        branches: 3,
        ..program.operations()
    };
    assert_eq!(
        program.operations(),
        counted,
        "literal branches and empty loops are decided"
    );
}

/// Lists the rows above one by their numbers, last first, then halves what the list names.
fn listed<M: Machine>(k: &mut M, table: Table<State>, list: Table<Scratch>, n: usize) {
    let head = k.index(0);
    k.store(list, head, 0, M::R::zero());
    for i in k.range_down(k.index(n)) {
        let long = k.load(table, i, 0).gt(M::R::one());
        if let Some(_branch) = k.if_any(long) {
            let length = k.load(list, head, 0) + M::R::one();
            k.store(list, k.whole(length), 0, k.number(i));
            k.store(list, head, 0, length);
        }
    }
    for place in k.range(k.index(1), k.whole(k.load(list, head, 0)).offset(1)) {
        let row = k.whole(k.load(list, place, 0));
        let half = k.load(table, row, 0) * M::R::lit(0.5);
        k.store(table, row, 0, half);
    }
}

#[test]
fn a_table_holds_rows() {
    let world = World {
        state: vec![4.0, 1.0, 0.0, 3.0, 16.0],
        scratch: vec![9.0; 6],
        ..World::default()
    };
    let (table, list) = (Table::place(&mut 0, 5), Table::place(&mut 0, 6));
    let (program, after) = agree!(world, listed(table, list, 5));
    assert_eq!(after.state, [2.0, 1.0, 0.0, 1.5, 8.0]);
    assert_eq!(after.scratch, [3.0, 4.0, 3.0, 0.0, 9.0, 9.0]);
    let wgsl = program.to_wgsl(&PrintOptions::default()).unwrap();
    assert!(wgsl.contains("u32(") && wgsl.contains("f32("), "{wgsl}");
}

fn place() -> Table<State> {
    Table::place(&mut 0, 10)
}

fn fault(kernel: impl FnOnce(&mut Tracer<'_>)) -> TraceError {
    trace::record(kernel).expect_err("the kernel breaks a rule")
}

#[test]
fn a_value_that_leaves_its_loop_is_an_error() {
    let line = line!() + 3;
    fn kernel<M: Machine>(k: &mut M) {
        let mut last = M::R::zero();
        for i in k.count(3) {
            last = k.load(place(), i, 0);
        }
        k.store(place(), k.index(0), 0, last);
    }
    let error = fault(|k| kernel(k));
    assert!(matches!(error, TraceError::Escaped(_)));
    let message = error.to_string();
    assert!(
        message.contains(&format!("tests/trace.rs:{line}:")),
        "{message}"
    );
    assert!(message.contains("used after that block") && message.contains("`Machine::cell`"));
}

#[test]
fn a_value_that_leaves_its_branch_is_an_error() {
    let error = fault(|k| {
        let x = k.load(place(), k.index(0), 0);
        let mut y = x;
        if let Some(_branch) = k.if_any(x.lt(Real::zero())) {
            y = -x;
        }
        k.store(place(), k.index(0), 0, y);
    });
    assert!(matches!(error, TraceError::Escaped(_)));
}

#[test]
fn an_index_that_leaves_its_loop_is_an_error() {
    let error = fault(|k| {
        let row = k.count(3).map(|i| i.offset(1)).last();
        k.load(place(), row.expect("a round"), 0);
    });
    assert!(matches!(error, TraceError::Escaped(_)));
}

#[test]
fn a_value_carried_to_the_next_round_is_an_error() {
    let error = fault(|k| {
        let mut sum = Real::zero();
        for i in k.count(3) {
            sum += k.load(place(), i, 0);
            k.store(place(), i, 0, sum);
        }
    });
    assert!(matches!(error, TraceError::Escaped(_)));
}

#[test]
fn a_literal_carried_to_the_next_round_is_an_error() {
    let error = fault(|k| {
        let mut sign = Real::one();
        for i in k.count(3) {
            k.store(place(), i, 0, sign);
            sign = -sign;
        }
    });
    assert!(matches!(error, TraceError::Carried(_)));
    assert!(error.to_string().contains("`let mut`"));
}

#[test]
fn leaving_a_loop_by_break_is_an_error() {
    let error = fault(|k| {
        for _ in k.count(3) {
            for i in k.count(3) {
                let x = k.load(place(), i, 0);
                if format!("{x:?}").starts_with('%') {
                    break;
                }
            }
        }
    });
    assert!(matches!(error, TraceError::Unfinished(_)));
    assert!(error.to_string().contains("if k.finished(mask) { break; }"));
}

#[test]
fn overlapping_loops_are_an_error() {
    let error = fault(|k| for _ in k.count(3).zip(k.count(3)) {});
    assert!(matches!(error, TraceError::Unfinished(_)));
    let error = fault(|k| {
        let (mut outer, mut inner) = (k.count(3), k.count(3));
        outer.next();
        inner.next();
        outer.by_ref().for_each(drop);
        inner.by_ref().for_each(drop);
    });
    assert!(matches!(error, TraceError::Unfinished(_)));
}

#[test]
fn finished_in_a_branch_is_an_error() {
    let error = fault(|k| {
        for i in k.count(3) {
            let negative = k.load(place(), i, 0).lt(Real::zero());
            if let Some(_branch) = k.if_any(negative)
                && k.finished(negative)
            {
                break;
            }
        }
    });
    assert!(matches!(error, TraceError::NoLoop(_)));
    assert!(error.to_string().contains("not directly in a loop"));
    let error = fault(|k| assert!(!k.finished(Mask::splat(true))));
    assert!(matches!(error, TraceError::NoLoop(_)));
}

#[test]
fn rows_outside_of_a_memory_stop_the_interpreter() {
    fn reach<M: Machine>(k: &mut M, links: Links) {
        let row = k.link(links, k.index(0), 0);
        let x = k.load(place(), row, 0);
        k.store(place(), row.offset(1), 0, x);
    }
    let program = trace::record(|k| reach(k, Links::place(&mut 0, 1))).unwrap();
    let run = |row: Option<u32>| {
        let mut world = World {
            state: vec![1.0; 3],
            ..World::default()
        };
        world.links.extend(row);
        program.interpret(&mut world.cpu())
    };
    let outside = |offset| {
        Err(InterpretError::OutOfBounds {
            kind: Kind::State,
            offset,
        })
    };
    assert_eq!(run(Some(1)), Ok(()));
    assert_eq!(run(Some(2)), outside(3));
    assert_eq!(run(Some(3)), outside(3));
    assert_eq!(run(Some(u32::MAX)), outside(u64::from(u32::MAX)));
    assert_eq!(run(None), Err(InterpretError::NoLink { offset: 0 }));
    let message = run(Some(7)).unwrap_err().to_string();
    assert!(
        message.contains("offset 7 lies outside of the State memory"),
        "{message}"
    );
}

fn body(shader: &str) -> &str {
    let start = shader.find("fn main").expect("an entry point");
    &shader[start..]
}

#[test]
fn prints_as_one_line_an_instruction() {
    fn kernel<M: Machine>(k: &mut M, rows: Table<State, 3>, scale: Table<Parameter>) {
        for b in k.range_down(k.index(4)) {
            let x = k.load(rows, b, 2);
            let tall = x.gt(M::R::lit(0.1));
            let scaled = x * k.load(scale, k.index(2), 0);
            k.store_where(tall, rows, b, 2, scaled + M::R::lit(-1.5));
            if k.finished(tall) {
                break;
            }
        }
    }
    let mut end = 5;
    let (rows, scale) = (Table::place(&mut end, 4), Table::place(&mut 0, 3));
    let program = trace::record(|k| kernel(k, rows, scale)).unwrap();
    let shader = program.to_wgsl(&PrintOptions::default()).unwrap();
    let expected = "\
fn main(@builtin(global_invocation_id) invocation: vec3<u32>, @builtin(num_workgroups) workgroups: vec3<u32>) {
    let index = invocation.x;
    let worlds = launch.worlds;
    for (var world = index; world < worlds; world += workgroups.x * 64u) {
    for (var nth = 0u; nth < launch.rounds; nth++) {
        for (var i0 = 4u - 1u; i0 < 4u; i0--) {
            let x1 = state[(7u + i0 * 3u) * worlds + world];
            let m2 = 0x1.99999ap-4f < x1;
            let x3 = parameters[2u];
            let x4 = x1 * x3;
            let x5 = x4 + (-1.5f);
            let x6 = state[(7u + i0 * 3u) * worlds + world];
            let x7 = select(x6, x5, m2);
            state[(7u + i0 * 3u) * worlds + world] = x7;
            if (m2) { break; }
        }
    }
    }
}
";
    assert_eq!(body(&shader), expected);
    validate(&shader);
    let cuda = program.to_cuda(&PrintOptions::default());
    let expected = "\
    for (u32 nth = 0u; nth < rounds; nth++) {
        for (u32 i0 = 4u - 1u; i0 < 4u; i0--) {
            const f32 x1 = state[(7u + i0 * 3u) * worlds + world];
            const bool m2 = 0x1.99999ap-4f < x1;
            const f32 x3 = parameters[2u];
            const f32 x4 = x1 * x3;
            const f32 x5 = x4 + (-1.5f);
            const f32 x6 = state[(7u + i0 * 3u) * worlds + world];
            const f32 x7 = select(x6, x5, m2);
            state[(7u + i0 * 3u) * worlds + world] = x7;
            if (m2) { break; }
        }
    }
    }
}
";
    assert!(cuda.ends_with(expected), "{cuda}");
    assert!(cuda.contains("void __launch_bounds__(64) step("));
    let options = PrintOptions {
        workgroup_size: 32,
        parameters_per_world: true,
        ..PrintOptions::default()
    };
    let shader = program.to_wgsl(&options).unwrap();
    assert!(shader.contains("@workgroup_size(32)"));
    assert!(shader.contains("let x3 = parameters[(2u) * worlds + world];"));
    validate(&shader);
}

#[test]
fn scratch_and_state_lie_in_pieces_where_it_is_asked_for() {
    fn kernel<M: Machine>(k: &mut M, table: Table<Scratch>, state: Table<State>) {
        k.store(table, k.index(3), 0, M::R::one());
        k.store(state, k.index(1), 0, M::R::zero());
    }
    let (table, state) = (Table::place(&mut 0, 4), Table::place(&mut 0, 2));
    let program = trace::record(|k| kernel(k, table, state)).unwrap();
    let options = PrintOptions {
        pieces: Some(5),
        state_pieces: Some(2),
        ..PrintOptions::default()
    };
    let [shader, cuda] = [
        program.to_wgsl(&options).unwrap(),
        program.to_cuda(&options),
    ];
    for text in [&shader, &cuda] {
        assert!(
            text.contains("own = (index / 32u) * 160u + index % 32u;"),
            "{text}"
        );
        assert!(
            text.contains("held = (world / 32u) * 64u + world % 32u;"),
            "{text}"
        );
        assert!(text.contains("scratch[(3u) * 32u + own] = 1.0f;"), "{text}");
        assert!(text.contains("state[(1u) * 32u + held] = 0.0f;"), "{text}");
    }
    validate(&shader);
}

#[test]
fn worlds_of_a_list_are_worked_on_where_it_is_asked_for() {
    fn kernel<M: Machine>(k: &mut M, input: Table<Input>, output: Table<Output>) {
        let x = k.load(input, k.index(1), 0);
        k.store(output, k.index(2), 0, x);
    }
    let (input, output) = (Table::place(&mut 0, 2), Table::place(&mut 0, 3));
    let program = trace::record(|k| kernel(k, input, output)).unwrap();
    let options = PrintOptions {
        listed: Some(7),
        ..PrintOptions::default()
    };
    let [shader, cuda] = [
        program.to_wgsl(&options).unwrap(),
        program.to_cuda(&options),
    ];
    for text in [&shader, &cuda] {
        for line in [
            "entries = links[7u];",
            "entry = index; entry < entries; entry += ",
            "world = links[8u + entry];",
            "= input[(1u) * worlds + world];",
            "output[(2u) * entries + entry] = ",
        ] {
            assert!(text.contains(line), "{line} in {text}");
        }
    }
    validate(&shader);
}

#[test]
fn equal_expressions_are_recorded_once_where_they_are_visible() {
    fn kernel<M: Machine>(k: &mut M, inputs: Table<Input>, table: Table<State, 3>) {
        let zero = k.index(0);
        let outside = k.load(inputs, zero, 0).sqrt();
        k.store(table, zero, 0, outside);
        if let Some(_branch) = k.if_any(outside.lt(M::R::one())) {
            let inside = k.load(inputs, zero, 0).sqrt();
            k.store(table, zero, 1, inside + M::R::one());
        }
        let after = k.load(inputs, zero, 0).sqrt() + M::R::one();
        k.store(table, zero, 2, after);
    }
    let world = World {
        input: vec![0.5],
        state: vec![0.0; 3],
        ..World::default()
    };
    let (inputs, table) = (Table::place(&mut 0, 1), Table::place(&mut 0, 1));
    let (program, _) = agree!(world, kernel(inputs, table));
    let n = program.operations();
    // One root and one comparison; the sum in the branch is not visible after it.
    assert_eq!((n.loads, n.arithmetic, n.stores), (1, 4, 3));
}

#[test]
fn infinities_are_written_by_their_bits_in_cuda() {
    for (x, text) in [
        (f32::INFINITY, "__uint_as_float(0x7f800000u)"),
        (f32::NEG_INFINITY, "__uint_as_float(0xff800000u)"),
        (-0.0, "(-0.0f)"),
    ] {
        let program = trace::record(|k| k.store(place(), k.index(0), 0, Real::splat(x))).unwrap();
        let cuda = program.to_cuda(&PrintOptions::default());
        assert!(cuda.contains(&format!("= {text};")), "{cuda}");
    }
}

#[test]
fn infinities_have_no_wgsl() {
    for (x, text) in [(f32::INFINITY, "inf"), (f32::NAN, "NaN")] {
        let program = trace::record(|k| k.store(place(), k.index(0), 0, Real::splat(x))).unwrap();
        let error = program.to_wgsl(&PrintOptions::default()).unwrap_err();
        assert!(matches!(error, WgslError::NotFinite(_)));
        assert!(error.to_string().contains(text), "{error}");
    }
}

/// The value stored by a program whose one statement stores a literal, as read
/// by naga.
fn read_back(program: &Program) -> f32 {
    let module = validate(&program.to_wgsl(&PrintOptions::default()).unwrap());
    let main = &module.entry_points[0].function;
    stored(&main.body, main).expect("a store of a number")
}

/// The first literal number that a block of a function stores.
fn stored(block: &naga::Block, function: &naga::Function) -> Option<f32> {
    use naga::{Expression, Literal, Statement};
    block.iter().find_map(|statement| match statement {
        Statement::Store { value, .. } => match &function.expressions[*value] {
            Expression::Literal(Literal::F32(x)) => Some(*x),
            _ => None,
        },
        Statement::Loop { body, .. } | Statement::Block(body) => stored(body, function),
        _ => None,
    })
}

/// Straight-line expressions: each step takes three earlier values.
fn straight<M: Machine>(
    k: &mut M,
    inputs: Table<Input, 4>,
    results: Table<Output>,
    steps: &[Step],
) {
    let zero = k.index(0);
    let mut values = vec![M::R::lit(1.5), M::R::lit(-0.25)];
    let inputs: [M::R; 4] = k.read(inputs, zero, 0);
    values.extend(inputs);
    for (operation, places) in steps {
        let [a, b, c] = places.map(|place| values[place.index(values.len())]);
        values.push(match operation {
            0 => a + b,
            1 => a - b,
            2 => a * b,
            3 => a / b,
            4 => a.fma(b, c),
            5 => a.abs().sqrt(),
            6 => a.min(b).max(c),
            7 => M::R::select(a.lt(b) | !b.le(c), c, a),
            8 => a.floor() + b.round(),
            _ => a
                .copysign(b)
                .ldexp(c.clamp(M::R::lit(-3.0), M::R::lit(3.0)).round()),
        });
    }
    k.store(results, zero, 0, values[values.len() - 1]);
}

type Step = (u8, [prop::sample::Index; 3]);

proptest! {
    #[test]
    fn literals_read_back_to_the_same_bits(bits: u32) {
        let x = f32::from_bits(bits);
        prop_assume!(x.is_finite());
        let program = trace::record(|k| k.store(place(), k.index(0), 0, Real::splat(x))).unwrap();
        prop_assert_eq!(read_back(&program).to_bits(), bits);
    }

    #[test]
    fn random_expressions_have_the_bits_of_f32(
        steps in prop::collection::vec((0u8..10, any::<[prop::sample::Index; 3]>()), 1..60),
        input in prop::collection::vec(-100.0f32..100.0, 4),
    ) {
        let world = World { input, output: vec![0.0], ..World::default() };
        let (inputs, results) = (Table::place(&mut 0, 1), Table::place(&mut 0, 1));
        let mut expected = world.clone();
        straight(&mut expected.cpu(), inputs, results, &steps);
        let program = trace::record(|k| straight(k, inputs, results, &steps)).unwrap();
        let mut found = world.clone();
        program.interpret(&mut found.cpu()).unwrap();
        prop_assert_eq!(expected.bits(), found.bits());
        // A literal may fold to an infinity, which has no WGSL.
        if let Ok(shader) = program.to_wgsl(&PrintOptions::default()) {
            validate(&shader);
        }
    }
}
