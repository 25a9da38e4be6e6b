//! Numbers of many worlds, in blocks: `[block][offset][lane]`.

use crate::Float;
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// One cache line, so that every lane register loads aligned.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
struct Line([u8; 64]);

/// `worlds` worlds of `length` numbers each, in blocks of `width` worlds.
///
/// A world's number at `offset` lies at `(block · length + offset) · width + lane`
/// with `block = world / width` and `lane = world % width`. The lanes of the last
/// block that belong to no world are kept, and written by [`fill`](Memory::fill).
#[derive(Clone, Debug)]
pub struct Memory<T> {
    lines: Vec<Line>,
    worlds: usize,
    length: usize,
    width: usize,
    scalar: core::marker::PhantomData<T>,
}

/// Neighbouring worlds in one block.
struct Run {
    block: usize,
    lanes: Range<usize>,
    /// Where they begin among the worlds that were asked for.
    at: usize,
}

impl<T: Float> Memory<T> {
    /// Zeros for `worlds` worlds of `length` numbers, `width` worlds a block.
    pub fn new(worlds: usize, length: usize, width: usize) -> Self {
        let bytes = worlds.div_ceil(width) * length * width * size_of::<T>();
        Self {
            lines: vec![Line([0; 64]); bytes.div_ceil(64)],
            worlds,
            length,
            width,
            scalar: core::marker::PhantomData,
        }
    }
    /// Numbers per world.
    pub fn length(&self) -> usize {
        self.length
    }
    /// Worlds per block.
    pub fn width(&self) -> usize {
        self.width
    }
    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.worlds
    }
    /// Number of blocks.
    pub fn blocks(&self) -> usize {
        self.worlds.div_ceil(self.width)
    }
    /// All numbers, block after block.
    pub fn scalars(&self) -> &[T] {
        &bytemuck::cast_slice(&self.lines)[..self.blocks() * self.length * self.width]
    }
    /// All numbers, block after block.
    pub fn scalars_mut(&mut self) -> &mut [T] {
        let n = self.blocks() * self.length * self.width;
        &mut bytemuck::cast_slice_mut(&mut self.lines)[..n]
    }
    /// Scalars in one block.
    pub fn block_size(&self) -> usize {
        self.length * self.width
    }
    /// The scalars of one block.
    pub fn block(&self, block: usize) -> &[T] {
        &self.scalars()[block * self.block_size()..][..self.block_size()]
    }
    /// Where a world's number lies in [`scalars`](Memory::scalars).
    pub fn position(&self, world: usize, offset: usize) -> usize {
        debug_assert!(offset < self.length);
        (world / self.width * self.length + offset) * self.width + world % self.width
    }
    /// A world's number.
    pub fn get(&self, world: usize, offset: usize) -> T {
        self.scalars()[self.position(world, offset)]
    }
    /// Copies neighbouring numbers of a world, from that at `offset` on, as many as `out` has room for.
    ///
    /// Panics where they are not all there.
    pub fn copy(&self, world: usize, offset: usize, out: &mut [T]) {
        let (block, lane) = (self.block(world / self.width), world % self.width);
        let lanes = block[offset * self.width..][..out.len() * self.width].chunks_exact(self.width);
        for (x, lanes) in out.iter_mut().zip(lanes) {
            *x = lanes[lane];
        }
    }
    /// Sets a world's number.
    pub fn set(&mut self, world: usize, offset: usize, x: T) {
        let i = self.position(world, offset);
        self.scalars_mut()[i] = x;
    }
    /// The numbers at these offsets of worlds from the first on, world after world: `out[world − first][offset]`,
    /// of as many as `out` has room for.
    ///
    /// Panics where `out` has room for no whole number of worlds, or for more than there are.
    pub fn gather(&self, first: usize, offsets: &[usize], out: &mut [T]) {
        if offsets.is_empty() {
            return;
        }
        assert_eq!(out.len() % offsets.len(), 0);
        assert!(first + out.len() / offsets.len() <= self.worlds);
        for (i, row) in out.chunks_exact_mut(offsets.len()).enumerate() {
            let world = first + i;
            let (block, lane) = (self.block(world / self.width), world % self.width);
            for (x, offset) in row.iter_mut().zip(offsets) {
                *x = block[offset * self.width + lane];
            }
        }
    }
    /// Sets what [`gather`](Memory::gather) gives of all worlds.
    ///
    /// Panics where `numbers` has another length than worlds times offsets.
    pub fn scatter(&mut self, offsets: &[usize], numbers: &[T]) {
        assert_eq!(numbers.len(), self.worlds * offsets.len());
        if offsets.is_empty() {
            return;
        }
        let (width, size) = (self.width, self.block_size());
        let blocks = self.scalars_mut();
        for (world, row) in numbers.chunks_exact(offsets.len()).enumerate() {
            let block = &mut blocks[world / width * size..][..size];
            for (x, offset) in row.iter().zip(offsets) {
                block[offset * width + world % width] = *x;
            }
        }
    }
    /// The numbers at these offsets of some worlds, as devices hold them: `[offset][world]`, in rows of `width` numbers,
    /// whose ends are zero where there are fewer worlds.
    ///
    /// Panics where there are more worlds than `width`, or than this has.
    pub fn rows(&self, offsets: Range<usize>, worlds: Range<usize>, width: usize) -> Vec<T> {
        let mut rows = vec![T::zero(); offsets.len() * width];
        for run in self.runs(worlds) {
            let block = self.block(run.block);
            for (row, offset) in rows.chunks_exact_mut(width).zip(offsets.clone()) {
                let from = &block[offset * self.width..][run.lanes.clone()];
                row[run.at..][..from.len()].copy_from_slice(from);
            }
        }
        rows
    }
    /// Sets what [`rows`](Memory::rows) gives.
    ///
    /// Panics as it does.
    pub fn set_rows(&mut self, offsets: Range<usize>, worlds: Range<usize>, rows: &[T]) {
        if offsets.is_empty() {
            return;
        }
        let (row_width, width, size) = (rows.len() / offsets.len(), self.width, self.block_size());
        let runs: Vec<_> = self.runs(worlds).collect();
        let blocks = self.scalars_mut();
        for run in runs {
            let block = &mut blocks[run.block * size..][..size];
            for (row, offset) in rows.chunks_exact(row_width).zip(offsets.clone()) {
                let to = &mut block[offset * width..][run.lanes.clone()];
                to.copy_from_slice(&row[run.at..][..to.len()]);
            }
        }
    }
    /// Some worlds as they lie in blocks.
    fn runs(&self, worlds: Range<usize>) -> impl Iterator<Item = Run> + use<T> {
        let width = self.width;
        (worlds.start / width..worlds.end.div_ceil(width)).map(move |block| {
            let begin = worlds.start.max(block * width);
            let end = worlds.end.min((block + 1) * width);
            Run {
                block,
                lanes: begin - block * width..end - block * width,
                at: begin - worlds.start,
            }
        })
    }
    /// Sets the number at `offset` of every world, and of the spare lanes.
    pub fn fill(&mut self, offset: usize, x: T) {
        for world in 0..self.blocks() * self.width {
            self.set(world, offset, x);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_scattered_is_gathered() {
        for (worlds, width) in [(1, 1), (5, 4), (8, 4), (3, 16)] {
            let mut memory = Memory::<f32>::new(worlds, 7, width);
            let offsets = [6, 1, 2];
            let numbers: Vec<_> = (0..worlds * 3).map(|i| 1.0 + i as f32).collect();
            memory.scatter(&offsets, &numbers);
            let mut found = vec![0.0; numbers.len()];
            memory.gather(0, &offsets, &mut found);
            assert_eq!(found, numbers);
            memory.gather(worlds / 2, &offsets, &mut found[worlds / 2 * 3..]);
            assert_eq!(found, numbers);
            memory.gather(worlds - 1, &offsets, &mut found[..3]);
            assert_eq!(found[..3], numbers[(worlds - 1) * 3..]);
            for world in 0..worlds {
                assert_eq!(memory.get(world, 6), numbers[3 * world]);
                assert_eq!(memory.get(world, 2), numbers[3 * world + 2]);
                assert_eq!(memory.get(world, 0), 0.0);
            }
        }
    }

    #[test]
    fn rows_go_to_a_device_and_come_back() {
        for (width, count) in [(1, 7), (4, 7), (16, 7), (7, 7), (4, 8)] {
            let mut memory = Memory::<f32>::new(count, 3, width);
            for world in 0..count {
                for offset in 0..3 {
                    memory.set(world, offset, (10 * offset + world) as f32);
                }
            }
            // Five worlds and the rest, in rows of five.
            let mut back = Memory::<f32>::new(count, 3, width);
            for worlds in [0..5, 5..count] {
                let rows = memory.rows(1..3, worlds.clone(), 5);
                assert_eq!(rows.len(), 10);
                assert_eq!(rows[5], 20.0 + worlds.start as f32);
                back.set_rows(1..3, worlds, &rows);
            }
            for world in 0..count {
                assert_eq!(back.get(world, 0), 0.0);
                assert_eq!(back.get(world, 1), (10 + world) as f32);
                assert_eq!(back.get(world, 2), (20 + world) as f32);
            }
        }
    }
}
