//! Rows of numbers that several threads read and write, no row by two at once.
//!
//! Constraints of one colour share no row, so the threads that solve them never meet. That is the
//! caller's promise, not the compiler's knowledge; therefore each number is an atomic, loaded and
//! stored relaxed, which is a plain move. Four that are neighbours move together where the machine can.

use crate::{Float, Lanes};
use core::fmt::Debug;
use core::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// A number that threads share.
pub trait Atom<T>: Debug + Send + Sync {
    /// A new zero.
    #[allow(clippy::declare_interior_mutable_const)] // what is made of it is meant to be new
    const ZERO: Self;
    /// The number.
    fn load(&self) -> T;
    /// Replaces it.
    fn store(&self, x: T);
}

impl Atom<f32> for AtomicU32 {
    const ZERO: Self = Self::new(0);
    #[inline(always)]
    fn load(&self) -> f32 {
        f32::from_bits(AtomicU32::load(self, Ordering::Relaxed))
    }
    #[inline(always)]
    fn store(&self, x: f32) {
        AtomicU32::store(self, x.to_bits(), Ordering::Relaxed);
    }
}

impl Atom<f64> for AtomicU64 {
    const ZERO: Self = Self::new(0);
    #[inline(always)]
    fn load(&self) -> f64 {
        f64::from_bits(AtomicU64::load(self, Ordering::Relaxed))
    }
    #[inline(always)]
    fn store(&self, x: f64) {
        AtomicU64::store(self, x.to_bits(), Ordering::Relaxed);
    }
}

/// Four neighbouring numbers.
#[derive(Debug)]
#[repr(C, align(16))]
pub struct Quad<T: Float>([T::Atom; 4]);

impl<T: Float> Quad<T> {
    /// Zeros.
    #[inline(always)]
    pub const fn zeros() -> Self {
        Self([const { T::Atom::ZERO }; 4])
    }
    /// The numbers.
    #[inline(always)]
    pub fn load(&self) -> [T; 4] {
        let [a, b, c, d] = &self.0;
        [a.load(), b.load(), c.load(), d.load()]
    }
    /// Replaces them.
    #[inline(always)]
    pub fn store(&self, [a, b, c, d]: [T; 4]) {
        self.0[0].store(a);
        self.0[1].store(b);
        self.0[2].store(c);
        self.0[3].store(d);
    }
}

/// One row, which begins with a line of the cache.
#[derive(Debug)]
#[repr(C, align(64))]
struct Row<T: Float, const Q: usize>([Quad<T>; Q]);

impl<T: Float, const Q: usize> Row<T, Q> {
    fn zeros() -> Self {
        Self([const { Quad::zeros() }; Q])
    }
}

/// Rows of `Q` times four numbers.
#[derive(Debug)]
pub struct Rows<T: Float, const Q: usize> {
    rows: Vec<Row<T, Q>>,
}

impl<T: Float, const Q: usize> Default for Rows<T, Q> {
    fn default() -> Self {
        Self { rows: Vec::new() }
    }
}

/// No register has more lanes.
pub const LANES: usize = 16;

impl<T: Float, const Q: usize> Rows<T, Q> {
    /// So many rows; new ones are zero.
    pub fn resize(&mut self, rows: usize) {
        self.rows.resize_with(rows, Row::zeros);
    }
    /// A number.
    #[inline(always)]
    pub fn load(&self, row: usize, field: usize) -> T {
        self.rows[row].0[field / 4].0[field % 4].load()
    }
    /// Replaces a number.
    #[inline(always)]
    pub fn store(&self, row: usize, field: usize, x: T) {
        self.rows[row].0[field / 4].0[field % 4].store(x);
    }
    /// Replaces neighbouring fields of a row.
    #[inline(always)]
    pub fn write(&self, row: usize, field: usize, numbers: &[T]) {
        let quads = &self.rows[row].0;
        for i in 0..numbers.len() {
            quads[(field + i) / 4].0[(field + i) % 4].store(numbers[i]);
        }
    }
    /// As many rows as a register has lanes.
    ///
    /// # Panics
    /// If there are fewer indices than lanes, or no such rows.
    #[inline(always)]
    pub fn pick<R: Lanes<Scalar = T>>(&self, index: &[u32]) -> Picked<'_, T, Q> {
        let first = &self.rows[0].0;
        let mut rows = [first; LANES];
        for lane in 0..R::WIDTH {
            rows[lane] = &self.rows[index[lane] as usize].0;
        }
        Picked { rows, first }
    }
}

/// Rows, a lane each.
#[derive(Debug)]
pub struct Picked<'a, T: Float, const Q: usize> {
    rows: [&'a [Quad<T>; Q]; LANES],
    /// Row 0.
    first: &'a [Quad<T>; Q],
}

impl<T: Float, const Q: usize> Picked<'_, T, Q> {
    /// Reads neighbouring fields.
    #[inline(always)]
    pub fn gather<R: Lanes<Scalar = T>, const N: usize>(&self, field: usize, registers: &mut [R]) {
        for quad in field / 4..(field + N).div_ceil(4) {
            let columns = R::load_quads(&self.rows, quad);
            for at in field.max(4 * quad)..(field + N).min(4 * quad + 4) {
                registers[at - field] = columns[at % 4];
            }
        }
    }
    /// Writes back what [`gather`](Self::gather) read, but for row 0; soonest where it is whole quads.
    #[inline(always)]
    pub fn scatter<R: Lanes<Scalar = T>, const N: usize>(&self, field: usize, registers: &[R]) {
        // Row 0 is everybody's: what would go there goes nowhere.
        let nowhere = [const { Quad::zeros() }; Q];
        let mut lanes: [&[Quad<T>; Q]; LANES] = self.rows;
        for lane in &mut lanes[..R::WIDTH] {
            if core::ptr::eq(*lane, self.first) {
                *lane = &nowhere;
            }
        }
        for quad in field / 4..(field + N).div_ceil(4) {
            if 4 * quad >= field && 4 * quad + 4 <= field + N {
                let columns = &registers[4 * quad - field..][..4];
                let columns = [columns[0], columns[1], columns[2], columns[3]];
                R::store_quads(columns, &lanes, quad);
                continue;
            }
            let numbers: &[T] = bytemuck::cast_slice(registers);
            for at in field.max(4 * quad)..(field + N).min(4 * quad + 4) {
                for lane in 0..R::WIDTH {
                    let x = numbers[(at - field) * R::WIDTH + lane];
                    lanes[lane][quad].0[at % 4].store(x);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dispatch::{Isa, Job, run_block, run_single};

    /// Adds 1 to seven fields of some rows, from the third on.
    struct Raise<'a, T: Float> {
        rows: &'a Rows<T, 3>,
        index: &'a [u32],
    }

    impl<T: Float> Job for Raise<'_, T> {
        type Scalar = T;
        type Output = ();
        #[inline(always)]
        fn run<R: Lanes<Scalar = T>>(self) {
            for index in self.index.chunks_exact(R::WIDTH) {
                let mut registers = [R::zero(); 7];
                let picked = self.rows.pick::<R>(index);
                picked.gather::<R, 7>(2, &mut registers);
                for x in &mut registers {
                    *x += R::one();
                }
                picked.scatter::<R, 7>(2, &registers);
            }
        }
    }

    /// Some rows are raised, others and the rest of these are as they were.
    fn check<T: Float>(run: impl Fn(Raise<'_, T>)) {
        let mut rows = Rows::<T, 3>::default();
        rows.resize(40);
        let number = |row: usize, field: usize| T::from_f64((100 * row + field) as f64);
        for (row, field) in (0..40).flat_map(|row| (0..12).map(move |field| (row, field))) {
            rows.store(row, field, number(row, field));
        }
        let index = [7, 0, 39, 12, 3, 30, 21, 0, 1, 2, 38, 17, 25, 0, 9, 10];
        run(Raise {
            rows: &rows,
            index: &index,
        });
        for (row, field) in (0..40).flat_map(|row| (0..12).map(move |field| (row, field))) {
            let raised = row > 0 && index.contains(&(row as u32)) && (2..9).contains(&field);
            let more = if raised { T::one() } else { T::zero() };
            let now = rows.load(row, field);
            assert!(
                now == number(row, field) + more,
                "row {row}, field {field}: {now:?}"
            );
        }
    }

    #[test]
    fn fields_of_rows_are_read_and_written_on_all_instruction_sets() {
        for isa in Isa::available() {
            check::<f32>(|job| run_block(isa, job));
            check::<f64>(|job| run_block(isa, job));
            check::<f32>(|job| run_single(isa, job));
        }
    }
}
