//! Words that all invocations of a launch see.

use crate::Card;
use sim::DeviceError;

/// So many of them, which go to the card where they have changed.
#[derive(Debug)]
pub struct Uniform<C: Card, const N: usize> {
    pub buffer: C::Buffer,
    words: [u32; N],
}

impl<C: Card, const N: usize> Uniform<C, N> {
    pub fn new(card: &C) -> Result<Self, DeviceError> {
        let words = [0; N];
        let buffer = card.uniform(&words)?;
        Ok(Self { buffer, words })
    }
    pub fn set(&mut self, card: &C, numbers: [usize; N]) -> Result<(), DeviceError> {
        let words = numbers.map(|n| n as u32);
        if words != self.words {
            card.write(&self.buffer, 0, bytemuck::cast_slice(&words))?;
            self.words = words;
        }
        Ok(())
    }
}
