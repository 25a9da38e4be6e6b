//! Numbers of things on their way from states to the kernels that tell of these.

use crate::Card;
use crate::card::{Commands, WORKGROUP, filled, sized};
use crate::seen::seen;
use crate::uniform::Uniform;
use rigid::impulse::report::RANGES;
use sim::DeviceError;
use std::ops::Range;

/// The WGSL that brings them there.
pub fn text() -> String {
    format!(
        "const RANGES: u32 = {RANGES}u;\n{}",
        include_str!("give.wgsl")
    )
}

/// What brings them there.
#[derive(Debug)]
pub struct Give<C: Card> {
    layout: C::Layout,
    kernel: C::Kernel,
}

impl<C: Card> Give<C> {
    pub fn new(card: &C) -> Result<Self, DeviceError> {
        let (text, layout) = (text(), card.layout(2, 2));
        let [kernel] = card.entries(&text, seen(&text, ["give"]), &layout)?;
        Ok(Self { layout, kernel })
    }
}

/// Ranges of a state in which the numbers of a thing stand.
pub type Ranges = [Range<usize>; RANGES];

/// Numbers of things of one kind.
#[derive(Debug)]
pub struct Gathered<C: Card> {
    /// How long the ranges of each are, and where those of each begin.
    pub places: C::Buffer,
    /// Constants of each.
    pub width: usize,
    launch: Uniform<C, 6>,
    /// Their numbers, `[number][thing]`.
    pub given: C::Buffer,
}

/// Which things: the first, how many, how many a world has, and how many sets of constants each world has, 0 where all share
/// them.
#[derive(Clone, Copy, Debug)]
pub struct Which {
    pub first: usize,
    pub count: usize,
    pub own: usize,
    pub sets: usize,
}

impl<C: Card> Gathered<C> {
    /// Of things with these ranges of a world's state, and so many constants; with room for so many at once.
    pub fn new(
        card: &C,
        things: &[Ranges],
        width: usize,
        room: usize,
    ) -> Result<Self, DeviceError> {
        let numbers = lengths(things).iter().sum::<usize>() + width;
        Ok(Self {
            places: filled(card, &places(things))?,
            width,
            launch: Uniform::new(card)?,
            given: sized(card, (numbers * room) as u64)?,
        })
    }
    /// Gathers the numbers of some of them, from states of so many numbers, and constants.
    pub fn gather(
        &mut self,
        card: &C,
        give: &Give<C>,
        todo: &mut C::Commands<'_>,
        ((states, numbers), constants): ((&C::Buffer, usize), &C::Buffer),
        which: Which,
    ) -> Result<(), DeviceError> {
        let Which {
            first,
            count,
            own,
            sets,
        } = which;
        let launch = [first, count, own, numbers, self.width, sets];
        self.launch.set(card, launch)?;
        let buffers = [
            states,
            &self.given,
            &self.places,
            constants,
            &self.launch.buffer,
        ];
        let bindings = card.bind(&give.layout, &buffers);
        todo.run(&give.kernel, &bindings, (count as u32).div_ceil(WORKGROUP));
        Ok(())
    }
}

fn lengths(things: &[Ranges]) -> [usize; RANGES] {
    let first = things.first();
    first.map_or([0; RANGES], |ranges| ranges.each_ref().map(Range::len))
}

/// How long the ranges of each are, then where those of each begin.
pub fn places(things: &[Ranges]) -> Vec<u32> {
    let starts = things.iter().flatten().map(|range| range.start);
    let all = lengths(things).into_iter().chain(starts);
    all.map(|n| n as u32).collect()
}
