//! Sums over the things of each world.

use crate::Card;
use crate::card::{Commands, WORKGROUP, sized};
use crate::report::AT_ONCE;
use crate::seen::seen;
use crate::uniform::Uniform;
use sim::DeviceError;

/// Things of which an invocation takes the sum.
const SUMMED: usize = 64;
/// Rounds until the sums of all things that are told of at once are one.
const ROUNDS: usize = AT_ONCE.ilog2().div_ceil(SUMMED.ilog2()) as usize;

/// The WGSL that sums.
pub fn text() -> String {
    format!(
        "const SUMMED: u32 = {SUMMED}u;\n{}",
        include_str!("sum.wgsl")
    )
}

/// What sums, and where.
#[derive(Debug)]
pub struct Sums<C: Card> {
    layout: C::Layout,
    kernel: C::Kernel,
    room: [C::Buffer; 2],
    launches: Vec<Uniform<C, 5>>,
}

/// Numbers of things of some worlds.
#[derive(Clone, Copy, Debug)]
pub struct Terms {
    /// The word where the first number of the first thing stands; those of all things stand side by side.
    pub at: usize,
    /// Things of each world.
    pub own: usize,
    pub worlds: usize,
    pub numbers: usize,
}

impl<C: Card> Sums<C> {
    pub fn new(card: &C) -> Result<Self, DeviceError> {
        let (text, layout) = (text(), card.layout(2, 0));
        let [kernel] = card.entries(&text, seen(&text, ["add"]), &layout)?;
        let launch = |_| Uniform::new(card);
        Ok(Self {
            layout,
            kernel,
            room: [card.buffer(1)?, card.buffer(1)?],
            launches: (0..ROUNDS).map(launch).collect::<Result<_, _>>()?,
        })
    }

    /// Sums over the things of each world; where the sums stand then, `[number][world]`.
    pub fn take<'a>(
        &'a mut self,
        card: &C,
        todo: &mut C::Commands<'_>,
        from: &'a C::Buffer,
        terms: Terms,
    ) -> Result<&'a C::Buffer, DeviceError> {
        let Terms {
            mut at,
            mut own,
            worlds,
            numbers,
        } = terms;
        let words = |own: usize| worlds * own.div_ceil(SUMMED) * numbers;
        for room in &mut self.room {
            if C::room(room) < words(own) as u64 {
                *room = sized(card, words(own) as u64)?;
            }
        }
        let [a, b] = &self.room;
        let mut ways = [from, a, b].into_iter().chain([a, b].into_iter().cycle());
        let mut from = ways.next().unwrap_or(a);
        for (launch, to) in self.launches.iter_mut().zip(ways) {
            launch.set(card, [at, own * worlds, own, worlds, numbers])?;
            let bindings = card.bind(&self.layout, &[from, to, &launch.buffer]);
            let groups = (words(own) as u32).div_ceil(WORKGROUP);
            todo.run(&self.kernel, &bindings, groups);
            (at, own, from) = (0, own.div_ceil(SUMMED), to);
            if own <= 1 {
                break;
            }
        }
        Ok(from)
    }
}
