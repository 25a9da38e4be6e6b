//! Scratch of the threads, kept from call to call: where shapes are many it is a megabyte, and takes time to clear.

use numbers::{Float, Memory};
use std::sync::{Mutex, PoisonError};

/// Memories that no thread uses now.
pub(crate) struct Scratch<T> {
    length: usize,
    width: usize,
    spare: Mutex<Vec<Memory<T>>>,
}

impl<T: Float> Clone for Scratch<T> {
    /// Another for as long blocks, of which nothing is lent yet.
    fn clone(&self) -> Self {
        Self::new(self.length, self.width)
    }
}

impl<T: Float> Scratch<T> {
    /// For blocks of `width` worlds with `length` numbers each.
    pub fn new(length: usize, width: usize) -> Self {
        Self {
            length: length.max(1),
            width,
            spare: Mutex::new(Vec::new()),
        }
    }
    /// Lends a memory, whatever it holds.
    pub fn lend<R>(&self, work: impl FnOnce(&mut Memory<T>) -> R) -> R {
        let spare = self.spare().pop();
        let mut memory = spare.unwrap_or_else(|| Memory::new(self.width, self.length, self.width));
        let result = work(&mut memory);
        self.spare().push(memory);
        result
    }
    fn spare(&self) -> std::sync::MutexGuard<'_, Vec<Memory<T>>> {
        self.spare.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
