//! Rows of numbers that several threads read and write, no row by two at once.
//!
//! Constraints of one colour share no row, so the threads that solve them never meet. That is the
//! caller's promise, not the compiler's knowledge; therefore each number is an atomic, loaded and
//! stored relaxed, which is a plain move.

use crate::{Float, Lanes};
use core::fmt::Debug;
use core::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// A number that threads share.
pub trait Atom<T>: Debug + Default + Send + Sync {
    /// The number.
    fn load(&self) -> T;
    /// Replaces it.
    fn store(&self, x: T);
}

impl Atom<f32> for AtomicU32 {
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
    #[inline(always)]
    fn load(&self) -> f64 {
        f64::from_bits(AtomicU64::load(self, Ordering::Relaxed))
    }
    #[inline(always)]
    fn store(&self, x: f64) {
        AtomicU64::store(self, x.to_bits(), Ordering::Relaxed);
    }
}

/// Rows of `W` numbers.
#[derive(Debug)]
pub struct Rows<T: Float, const W: usize> {
    atoms: Vec<T::Atom>,
}

impl<T: Float, const W: usize> Default for Rows<T, W> {
    fn default() -> Self {
        Self { atoms: Vec::new() }
    }
}

impl<T: Float, const W: usize> Rows<T, W> {
    /// So many rows; new ones are zero.
    pub fn resize(&mut self, rows: usize) {
        self.atoms.resize_with(rows * W, T::Atom::default);
    }
    /// A number.
    #[inline(always)]
    pub fn load(&self, row: usize, field: usize) -> T {
        self.atoms[row * W + field].load()
    }
    /// Replaces a number.
    #[inline(always)]
    pub fn store(&self, row: usize, field: usize, x: T) {
        self.atoms[row * W + field].store(x);
    }
    /// Reads neighbouring fields of as many rows as a register has lanes, a lane each.
    ///
    /// # Panics
    /// If there are fewer rows than lanes.
    #[inline(always)]
    pub fn gather<R: Lanes<Scalar = T>, const N: usize>(
        &self,
        rows: &[u32],
        field: usize,
        registers: &mut [R],
    ) {
        let numbers: &mut [T] = bytemuck::cast_slice_mut(&mut registers[..N]);
        for lane in 0..R::WIDTH {
            let start = rows[lane] as usize * W + field;
            let row = &self.atoms[start..start + N];
            for i in 0..N {
                numbers[i * R::WIDTH + lane] = row[i].load();
            }
        }
    }
    /// Writes back what [`gather`](Self::gather) read, but for row 0.
    ///
    /// # Panics
    /// If there are fewer rows than lanes.
    #[inline(always)]
    pub fn scatter<R: Lanes<Scalar = T>, const N: usize>(
        &self,
        rows: &[u32],
        field: usize,
        registers: &[R],
    ) {
        let numbers: &[T] = bytemuck::cast_slice(&registers[..N]);
        for lane in 0..R::WIDTH {
            if rows[lane] != 0 {
                let start = rows[lane] as usize * W + field;
                let row = &self.atoms[start..start + N];
                for i in 0..N {
                    row[i].store(numbers[i * R::WIDTH + lane]);
                }
            }
        }
    }
}
