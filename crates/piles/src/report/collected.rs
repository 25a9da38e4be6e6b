//! Words of several buffers on their way to the host, which waits for them once.

use crate::Card;
use crate::card::{Commands, sized};
use sim::DeviceError;
use std::iter::once;
use std::ops::Range;

/// Words that are collected before they are fetched, if there is more than one part of them.
const MOST: usize = 1 << 24;

/// Words, and what they are.
#[derive(Debug)]
pub struct Collected<C: Card, W> {
    buffer: C::Buffer,
    words: usize,
    parts: Vec<(Range<usize>, W)>,
    staging: C::Staging,
}

impl<C: Card, W> Collected<C, W> {
    pub fn new(card: &C) -> Result<Self, DeviceError> {
        Ok(Self {
            buffer: card.buffer(1)?,
            words: 0,
            parts: Vec::new(),
            staging: C::Staging::default(),
        })
    }
    pub fn clear(&mut self) {
        self.parts.clear();
        self.words = 0;
    }
    pub fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }
    /// Whether so many more words can be collected before those are fetched that have been; if there are none, there will be
    /// room.
    pub fn fits(&mut self, card: &C, more: usize) -> Result<bool, DeviceError> {
        if self.words == 0 {
            self.widen(card, more)?;
        }
        Ok((self.words + more) as u64 <= C::room(&self.buffer))
    }
    /// Makes room for so many, or for the most that are collected; while there are none.
    pub fn reserve(&mut self, card: &C, words: usize) -> Result<(), DeviceError> {
        let most = MOST.min((card.most_bytes() / crate::NUMBER) as usize);
        self.widen(card, words.min(most))
    }
    fn widen(&mut self, card: &C, words: usize) -> Result<(), DeviceError> {
        if C::room(&self.buffer) < words as u64 {
            self.buffer = sized(card, words as u64)?;
        }
        Ok(())
    }
    /// Collects ranges of a buffer's words, for which there is room.
    pub fn add(
        &mut self,
        todo: &mut C::Commands<'_>,
        from: &C::Buffer,
        ranges: impl Iterator<Item = Range<usize>>,
        what: W,
    ) {
        let begin = self.words;
        for range in ranges {
            let length = range.len();
            todo.copy(from, range, &self.buffer, self.words);
            self.words += length;
        }
        self.parts.push((begin..self.words, what));
    }
    /// Fetches all that was collected.
    pub fn fetch(
        &mut self,
        card: &C,
        todo: C::Commands<'_>,
        mut read: impl FnMut(W, &[f32]),
    ) -> Result<(), DeviceError> {
        let parts = std::mem::take(&mut self.parts);
        let words = once(0..std::mem::take(&mut self.words));
        card.fetch(todo, &mut self.staging, &self.buffer, words, |words| {
            for (range, what) in parts {
                read(what, &words[range]);
            }
        })
    }
}
