//! A small kernel through everything that is unsafe or casts memory, for Miri:
//!
//! ```text
//! cargo +nightly miri test -p kinetarium-numbers --test miri
//! ```
//!
//! Miri detects no instruction set by itself; `RUSTFLAGS="-C target-feature=+avx2,+fma"`
//! shows it the AVX2 lanes as well.

use kinetarium_numbers::dispatch::{Isa, Job, run_block, run_single};
use kinetarium_numbers::machine::space::{Parameter, State};
use kinetarium_numbers::machine::{Cell, Links};
use kinetarium_numbers::{
    Cpu, Float, Known, Lanes, Machine, Memory, Parameters, PerWorld, Real, Shared, Table,
};

/// Every instruction of a lane on each of `n` linked rows.
fn kernel<M: Machine>(k: &mut M, rows: Table<State, 4>, gains: Table<Parameter>, links: Links) {
    let n = 3;
    let mut sum = k.cell(M::R::zero());
    for i in k.range_down(k.index(n)) {
        let row = k.link(links, i, 0);
        let [a, b, c, d] = k.read(rows, row, 0);
        let gain = k.load(gains, i, 0);
        let root = ((a * gain - b) / c.max(M::R::one())).abs().sqrt();
        let (fraction, exponent) = root.frexp();
        let whole = (d.floor() + b.round()).min(M::R::lit(9.0));
        let mask = (a.lt(b) & !c.le(d)) | a.same(M::R::zero());
        let e = M::R::select(mask, fraction.ldexp(whole), exponent.copysign(a));
        k.write(rows, row, 0, [root, -a.fma(b, c), e]);
        if let Some(_branch) = k.if_any(mask) {
            k.store_where(mask, rows, row, 3, gain);
        }
        sum.write(sum.read() + e);
        if k.finished(sum.read().gt(M::R::lit(1e6))) {
            break;
        }
    }
    k.store(rows, k.index(n), 0, sum.read());
}

/// The kernel on one block of worlds.
struct Block<'a, T> {
    state: &'a mut [T],
    parameters: &'a [T],
    per_world: bool,
}

const ROWS: usize = 4;
const LINKS: [u32; 3] = [2, 0, 1];

impl<T: Float> Job for Block<'_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let state = bytemuck::cast_slice_mut::<T, R>(self.state);
        if self.per_world {
            let parameters = PerWorld::<R>(bytemuck::cast_slice(self.parameters));
            run(state, parameters);
        } else {
            run(state, Shared::<R>(self.parameters));
        }
    }
}

#[inline(always)]
fn run<R: Known>(state: &mut [R], parameters: impl Parameters<R>) {
    let mut cpu = Cpu {
        state,
        input: &[],
        output: &mut [],
        scratch: &mut [],
        parameters,
        links: &LINKS,
    };
    let (rows, gains) = (Table::place(&mut 0, ROWS), Table::place(&mut 0, 3));
    kernel(&mut cpu, rows, gains, Links::place(&mut 0, 3));
}

/// `worlds` worlds after the kernel, in blocks as wide as a register or in single ones.
fn worlds<T: Float>(isa: Isa, width: usize, per_world: bool) -> Memory<T> {
    let (worlds, length) = (T::BLOCK + 1, 4 * ROWS);
    let wave = |i: usize| T::from_f64((i % 17) as f64 * 0.75 - 4.0);
    let mut state = Memory::new(worlds, length, width);
    for world in 0..worlds {
        (0..length).for_each(|i| state.set(world, i, wave(7 * world + i)));
    }
    let mut parameters = Memory::new(
        if per_world { worlds } else { 1 },
        3,
        if per_world { width } else { 1 },
    );
    (0..3).for_each(|i| parameters.fill(i, wave(5 * i + 2)));
    for b in 0..state.blocks() {
        let size = state.block_size();
        let block = Block {
            state: &mut state.scalars_mut()[b * size..][..size],
            parameters: parameters.block(if per_world { b } else { 0 }),
            per_world,
        };
        if width == 1 {
            run_single(isa, block);
        } else {
            run_block(isa, block);
        }
    }
    state
}

fn blocks_and_singles_agree<T: Float>() {
    for isa in Isa::available() {
        for per_world in [false, true] {
            let block = worlds::<T>(isa, T::BLOCK, per_world);
            let single = worlds::<T>(isa, 1, per_world);
            for world in 0..block.worlds() {
                for i in 0..block.length() {
                    let (a, b) = (block.get(world, i), single.get(world, i));
                    assert!(
                        a.to_f64().to_bits() == b.to_f64().to_bits(),
                        "{isa}: {a:?} {b:?}"
                    );
                }
            }
        }
    }
}

#[test]
fn worlds_of_f32() {
    blocks_and_singles_agree::<f32>();
}

#[test]
fn worlds_of_f64() {
    blocks_and_singles_agree::<f64>();
}
