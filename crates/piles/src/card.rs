//! What piles ask of a card.

use crate::{Need, PilesError};
use numbers::trace::{Members, Program};
use sim::{DeviceError, Stage};
use std::fmt::Debug;
use std::iter::{once, repeat_n};
use std::ops::Range;

/// Invocations in a workgroup of a kernel, and of most of what lies between them.
pub const WORKGROUP: u32 = 64;

/// Bytes of a number.
pub const NUMBER: u64 = size_of::<f32>() as u64;

/// Buffers of a [kernel](Card::kernel).
pub const BINDINGS: usize = 7;

/// How a kernel sees a buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It reads and writes it.
    Written,
    /// It only reads it.
    Read,
    /// Words that all invocations of a launch see.
    Uniform,
}

/// What [kernels](Card::kernel) bind: state, input, output, scratch, parameters, links, launch; see
/// [`to_wgsl`](Program::to_wgsl).
pub const KINDS: [Kind; BINDINGS] = [
    Kind::Written,
    Kind::Read,
    Kind::Written,
    Kind::Written,
    Kind::Read,
    Kind::Read,
    Kind::Uniform,
];

/// The kinds of a [layout](Card::layout).
pub fn kinds(written: usize, read: usize) -> Vec<Kind> {
    let kinds = repeat_n(Kind::Written, written).chain(repeat_n(Kind::Read, read));
    kinds.chain(once(Kind::Uniform)).collect()
}

/// An entry point of a WGSL text.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Entry {
    /// Its name.
    pub name: &'static str,
    /// The bindings of the text that it sees, in order.
    pub sees: Vec<u32>,
}

/// A card, by whatever interface. Clones are the same card. What is asked of it is done in this order.
pub trait Card: Clone + Debug + Send + Sync + 'static {
    /// Memory of the card: words of 32 bits.
    type Buffer: Debug + Send + Sync;
    /// Which buffers a text sees.
    type Layout: Debug + Send + Sync;
    /// The buffers that a launch sees.
    type Bindings: Debug + Send + Sync;
    /// What can be launched.
    type Kernel: Clone + Debug + Send + Sync;
    /// Where words wait on their way to the host; kept, as it is large.
    type Staging: Debug + Default + Send + Sync;
    /// What tells how long stages take.
    type Clock: Debug + Send + Sync;
    /// What is asked together.
    type Commands<'a>: Commands<Self>;

    /// Its name.
    fn name(&self) -> &str;
    /// Most bytes of a buffer that a kernel sees.
    fn most_bytes(&self) -> u64;
    /// Most invocations of a launch.
    fn most_invocations(&self) -> u32;
    /// Whether it ends loops that go round too often, and says nothing.
    fn cuts_loops(&self) -> bool {
        false
    }
    /// An error if anything has gone wrong.
    fn check(&self) -> Result<(), DeviceError>;
    /// The error that it has failed.
    fn failed(&self, reason: &str) -> DeviceError;

    /// A buffer of so many words, of which none may be asked for.
    fn buffer(&self, words: u64) -> Result<Self::Buffer, DeviceError>;
    /// The same for numbers of workgroups, three a launch.
    fn launches(&self, words: u64) -> Result<Self::Buffer, DeviceError>;
    /// Words that all invocations of a launch see.
    fn uniform(&self, words: &[u32]) -> Result<Self::Buffer, DeviceError>;
    /// Words that a buffer has room for.
    fn room(buffer: &Self::Buffer) -> u64;
    /// Writes words from one on, a multiple of 4 bytes.
    fn write(&self, buffer: &Self::Buffer, from: u64, bytes: &[u8]) -> Result<(), DeviceError>;

    /// Buffers that are written, then such as are read, then a uniform.
    fn layout(&self, written: usize, read: usize) -> Self::Layout;
    /// Compiles entry points of a WGSL text that binds these, or finds what was compiled, or begins to compile: until worlds
    /// [are placed](crate::Piles::new) nothing is launched, and after that nothing is compiled. The text stays within its
    /// buffers: not every interface sees to that.
    fn entries<const N: usize>(
        &self,
        text: &str,
        entries: [Entry; N],
        layout: &Self::Layout,
    ) -> Result<[Self::Kernel; N], DeviceError>;
    /// Buffers in the order of a layout, of which an entry point sees some.
    fn bind(&self, layout: &Self::Layout, buffers: &[&Self::Buffer]) -> Self::Bindings;
    /// Likewise compiles a record whose members are in [runs](Members::Runs), or worlds of one round.
    fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<Self::Kernel, DeviceError>;
    /// What such a kernel sees, in the order of its [bindings](Program::to_wgsl).
    fn bind_kernel(&self, buffers: [&Self::Buffer; BINDINGS]) -> Self::Bindings;

    /// A clock, if it has one.
    fn clock(&self) -> Option<Self::Clock>;
    /// What stages have taken by it.
    fn times(clock: Self::Clock) -> Vec<Stage>;
    /// Begins to ask for something, some time until it is submitted: nothing else is asked meanwhile, but that what is written
    /// may come before all of it. So each launch of it has words of its own. Marked stages are timed
    /// where there is a clock.
    fn commands<'a>(&self, clock: Option<&'a mut Self::Clock>) -> Self::Commands<'a>;
    /// Asks for it.
    fn submit(&self, commands: Self::Commands<'_>) -> Result<(), DeviceError>;
    /// Asks for it, and reads ranges of a buffer's words, one after the other, once it is done.
    fn fetch(
        &self,
        commands: Self::Commands<'_>,
        staging: &mut Self::Staging,
        buffer: &Self::Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError>;
}

/// What is asked of a card together. What it names is kept until then.
pub trait Commands<C: Card> {
    /// Runs a kernel in so many workgroups.
    fn run(&mut self, kernel: &C::Kernel, bindings: &C::Bindings, workgroups: u32);
    /// Runs one in as many as stand in a buffer of [launches](Card::launches), of which there are at most so many.
    fn run_told(
        &mut self,
        kernel: &C::Kernel,
        bindings: &C::Bindings,
        launches: (&C::Buffer, u32),
        most: u32,
    );
    /// Copies words from one buffer to a place in another one.
    fn copy(&mut self, from: &C::Buffer, words: Range<usize>, to: &C::Buffer, at: usize);
    /// What was run since the mark before belongs to this stage.
    fn mark(&mut self, stage: &'static str);
}

/// A buffer of so many words, if the card takes one that large.
pub(crate) fn sized<C: Card>(card: &C, words: u64) -> Result<C::Buffer, DeviceError> {
    let fits = Need::World.check(words * NUMBER, card.most_bytes(), card.name());
    fits.map_err(PilesError::from)?;
    card.buffer(words)
}

/// A buffer that holds this.
pub(crate) fn filled<C: Card, T: bytemuck::NoUninit>(
    card: &C,
    words: &[T],
) -> Result<C::Buffer, DeviceError> {
    let bytes = bytemuck::cast_slice(words);
    let fits = Need::Model.check(bytes.len() as u64, card.most_bytes(), card.name());
    fits.map_err(PilesError::from)?;
    let buffer = card.buffer(bytes.len() as u64 / NUMBER)?;
    card.write(&buffer, 0, bytes)?;
    Ok(buffer)
}
