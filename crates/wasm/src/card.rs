//! The graphics card of the page.
//!
//! The page knows buffers of words, kernels and what these bind, by numbers that it gives them, and nothing of worlds. What
//! waits for the card suspends this module: until that has come back, none of its exports may be called.

use crate::worlds::Worlds;
use model::{CollisionFilter, Model};
use numbers::trace::{TraceError, WgslError};
use piles::{Kind, Piles, TooLarge};
use records::Programs;
use rigid::Solver;
use rigid::impulse::Impulse;
use sim::{Device, DeviceError, DeviceWorlds};
use std::ops::Range;
use std::sync::Arc;

// All answers are 0 where a call has failed, and `failure` says why. Numbers of things are never 0.
#[link(wasm_import_module = "gpu")]
unsafe extern "C" {
    /// Opens the card, unless it is open. Waits.
    safe fn open() -> u32;
    /// Whether nothing has gone wrong.
    safe fn check() -> u32;
    /// Most bytes of a buffer that a kernel sees.
    safe fn most_bytes() -> f64;
    /// Most workgroups of a launch.
    safe fn most_workgroups() -> u32;
    /// Takes memory for so many words; `launches` is 1 where they are to be numbers of workgroups. Waits.
    safe fn buffer(words: u32, launches: u32) -> u32;
    /// A buffer of words that all invocations of a launch see.
    unsafe fn uniform(words: *const u32, count: usize) -> u32;
    /// Takes a text in WGSL.
    unsafe fn text(text: *const u8, length: usize) -> u32;
    /// Begins to compile an entry point of a text, unless it is known. It sees `count` bindings: of each its number, and
    /// its [`Kind`].
    unsafe fn kernel(
        text: u32,
        name: *const u8,
        length: usize,
        seen: *const [u32; 2],
        count: usize,
    ) -> u32;
    /// Waits until all kernels are compiled that were begun.
    safe fn compiled() -> u32;
    /// Buffers by their bindings, of which a kernel sees some.
    unsafe fn bind(buffers: *const u32, count: usize) -> u32;
    /// Lets a thing go.
    safe fn release(number: u32);
    /// Writes words into a buffer, from `at` on.
    unsafe fn write(buffer: u32, at: u32, words: *const u8, count: usize) -> u32;
    /// Asks for all that [`Commands`] have written.
    unsafe fn submit(words: *const u32, count: usize) -> u32;
    /// Copies ranges of a buffer's words, `count` pairs of a start and a length, one after the other. Waits.
    unsafe fn read(buffer: u32, ranges: *const [u32; 2], count: usize, words: *mut f32) -> u32;
    /// Copies why the last call failed, in UTF-8, as far as there is room; how long that is.
    unsafe fn failure(text: *mut u8, room: usize) -> usize;
}

/// Longest reason that is told [bytes].
const MOST_REASON: usize = 500;

/// Why worlds do not run on the card.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CardError {
    #[error("the solver's kernel cannot be recorded: {0}")]
    Record(#[from] TraceError),
    #[error("the solver's kernel cannot be written in WGSL: {0}")]
    Wgsl(#[from] WgslError),
    #[error(
        "{worlds} worlds are too many for the graphics card `{card}`, which takes {most} of this model: simulate fewer, \
         or run on the processor"
    )]
    Worlds {
        worlds: usize,
        most: usize,
        card: String,
    },
    #[error(transparent)]
    TooLarge(#[from] TooLarge),
    #[error("the graphics card `{card}` failed: {reason}")]
    Failed { card: String, reason: String },
}

impl From<CardError> for DeviceError {
    fn from(error: CardError) -> Self {
        Self::new(error)
    }
}

/// A thing of the page, which is let go with this.
#[derive(Debug)]
struct Owned(u32);

impl Drop for Owned {
    fn drop(&mut self) {
        release(self.0);
    }
}

/// Memory of the card, kept while anything binds it.
#[derive(Debug)]
pub(crate) struct Buffer {
    owned: Arc<Owned>,
    /// Words that it has room for.
    pub room: usize,
}

/// The page's number of it: `web/src/transport/kernels.ts`.
fn number(kind: Kind) -> u32 {
    match kind {
        Kind::Written => 0,
        Kind::Read => 1,
        Kind::Uniform => 2,
    }
}

/// What is launched.
#[derive(Clone, Debug)]
pub(crate) struct Kernel(Arc<Owned>);

/// The buffers that launches see.
#[derive(Clone, Debug)]
pub(crate) struct Bindings(Arc<Bound>);

#[derive(Debug)]
struct Bound {
    owned: Owned,
    _buffers: Vec<Arc<Owned>>,
}

/// The card of the page.
#[derive(Clone, Debug)]
pub(crate) struct Card {
    pub name: String,
}

impl Card {
    /// That it has failed.
    pub fn failed(&self, reason: impl Into<String>) -> CardError {
        CardError::Failed {
            card: self.name.clone(),
            reason: reason.into(),
        }
    }
    /// What a call has answered, unless that is that it failed.
    fn answered(&self, answer: u32) -> Result<u32, CardError> {
        if answer != 0 {
            return Ok(answer);
        }
        let mut reason = vec![0; MOST_REASON];
        // SAFETY: the page writes at most so many bytes, there.
        let length = unsafe { failure(reason.as_mut_ptr(), reason.len()) };
        reason.truncate(length);
        Err(self.failed(String::from_utf8_lossy(&reason)))
    }
    /// Opens it, unless it is open.
    fn open(&self) -> Result<(), CardError> {
        self.answered(open()).map(|_| ())
    }
    /// An error if anything has gone wrong.
    pub fn check(&self) -> Result<(), CardError> {
        self.answered(check()).map(|_| ())
    }
    /// Most bytes of a buffer that a kernel sees.
    pub fn most_bytes(&self) -> u64 {
        most_bytes() as u64
    }
    /// Most workgroups of a launch.
    pub fn most_workgroups(&self) -> u32 {
        most_workgroups()
    }

    /// A buffer of so many words, or of two, as cards have no empty ones.
    pub fn buffer(&self, words: usize) -> Result<Buffer, CardError> {
        self.buffer_of(words, false)
    }
    /// The same for numbers of workgroups.
    pub fn launches(&self, words: usize) -> Result<Buffer, CardError> {
        self.buffer_of(words, true)
    }
    fn buffer_of(&self, words: usize, launches: bool) -> Result<Buffer, CardError> {
        let room = words.max(2);
        let number = self.answered(buffer(room as u32, launches.into()))?;
        Ok(Buffer {
            owned: Arc::new(Owned(number)),
            room,
        })
    }
    /// A buffer that holds this.
    pub fn filled<T: bytemuck::NoUninit>(&self, words: &[T]) -> Result<Buffer, CardError> {
        let buffer = self.buffer(words.len())?;
        self.write(&buffer, 0, bytemuck::cast_slice(words))?;
        Ok(buffer)
    }
    /// Words that all invocations of a launch see.
    pub fn uniform(&self, words: &[u32]) -> Result<Buffer, CardError> {
        // SAFETY: the page reads so many words, there.
        let number = self.answered(unsafe { uniform(words.as_ptr(), words.len()) })?;
        Ok(Buffer {
            owned: Arc::new(Owned(number)),
            room: words.len(),
        })
    }
    /// Writes words from one on.
    pub fn write(&self, buffer: &Buffer, at: usize, words: &[u8]) -> Result<(), CardError> {
        let count = words.len() / size_of::<u32>();
        // SAFETY: the page reads so many words, there.
        self.answered(unsafe { write(buffer.owned.0, at as u32, words.as_ptr(), count) })?;
        Ok(())
    }

    /// Begins to compile entry points of a text, of which each sees these bindings.
    pub fn begin<const N: usize>(
        &self,
        code: &str,
        entries: [(&str, Vec<(u32, Kind)>); N],
    ) -> Result<[Kernel; N], CardError> {
        // SAFETY: the page reads so many bytes, there.
        let of = Owned(self.answered(unsafe { text(code.as_ptr(), code.len()) })?);
        let begun = entries.map(|(name, sees)| {
            let seen = Vec::from_iter(sees.iter().map(|(at, kind)| [*at, number(*kind)]));
            let (at, length, count) = (name.as_ptr(), name.len(), seen.len());
            // SAFETY: the page reads so many bytes and pairs, there.
            unsafe { kernel(of.0, at, length, seen.as_ptr(), count) }
        });
        // What one call says of the card, all say.
        begun
            .iter()
            .try_for_each(|number| self.answered(*number).map(|_| ()))?;
        Ok(begun.map(|number| Kernel(Arc::new(Owned(number)))))
    }
    /// Waits until all is compiled that was begun.
    pub fn compiled(&self) -> Result<(), CardError> {
        self.answered(compiled()).map(|_| ())
    }
    /// Binds buffers in order. Where that fails, what is launched next fails, too.
    pub fn bind(&self, buffers: &[&Buffer]) -> Bindings {
        let numbers = Vec::from_iter(buffers.iter().map(|buffer| buffer.owned.0));
        // SAFETY: the page reads so many numbers, there.
        let number = unsafe { bind(numbers.as_ptr(), numbers.len()) };
        Bindings(Arc::new(Bound {
            owned: Owned(number),
            _buffers: buffers
                .iter()
                .map(|buffer| Arc::clone(&buffer.owned))
                .collect(),
        }))
    }

    /// Asks for this.
    pub fn submit(&self, Commands { words, .. }: &Commands) -> Result<(), CardError> {
        if words.is_empty() {
            return Ok(());
        }
        // SAFETY: the page reads so many words, there.
        self.answered(unsafe { submit(words.as_ptr(), words.len()) })?;
        Ok(())
    }
    /// Reads ranges of a buffer's words, one after the other, once all is done that was asked for.
    pub fn read(
        &self,
        buffer: &Buffer,
        ranges: impl IntoIterator<Item = Range<usize>>,
    ) -> Result<Vec<f32>, CardError> {
        let pairs = ranges.into_iter();
        let pairs = Vec::from_iter(pairs.map(|range| [range.start, range.len()].map(|n| n as u32)));
        let all: u32 = pairs.iter().map(|[_, length]| length).sum();
        let mut words = vec![0.0; all as usize];
        let (number, to) = (buffer.owned.0, words.as_mut_ptr());
        // SAFETY: the page reads so many pairs, and writes as many words as they say together.
        self.answered(unsafe { read(number, pairs.as_ptr(), pairs.len(), to) })?;
        Ok(words)
    }
}

/// What is asked of the card together, as words that the page reads: `web/src/transport/commands.ts`.
#[derive(Debug, Default)]
pub(crate) struct Commands {
    words: Vec<u32>,
    /// What they name, which the page keeps for as long.
    bound: Vec<Bindings>,
    copied: Vec<Arc<Owned>>,
}

impl Commands {
    const RUN: u32 = 0;
    const RUN_TOLD: u32 = 1;
    const COPY: u32 = 2;

    /// Runs a kernel in so many workgroups.
    pub fn run(&mut self, kernel: &Kernel, bindings: &Bindings, workgroups: u32) {
        let (kernel, bindings) = (kernel.0.0, self.keep(bindings));
        self.words.extend([Self::RUN, kernel, bindings, workgroups]);
    }
    /// Runs one in as many as the nth three words of a buffer say.
    pub fn run_told(&mut self, kernel: &Kernel, bindings: &Bindings, told: &Buffer, nth: u32) {
        let (kernel, bindings, told) = (kernel.0.0, self.keep(bindings), told.owned.0);
        self.words
            .extend([Self::RUN_TOLD, kernel, bindings, told, nth]);
    }
    /// The number of bindings, which are kept.
    fn keep(&mut self, bindings: &Bindings) -> u32 {
        self.bound.push(bindings.clone());
        bindings.0.owned.0
    }
    /// Copies words from one buffer to a place in another one.
    pub fn copy(&mut self, from: &Buffer, words: Range<usize>, to: &Buffer, at: usize) {
        let [start, at, count] = [words.start, at, words.len()].map(|n| n as u32);
        let buffers = [from, to].map(|buffer| Arc::clone(&buffer.owned));
        let [from, to] = buffers.each_ref().map(|buffer| buffer.0);
        self.copied.extend(buffers);
        self.words.extend([Self::COPY, from, start, to, at, count]);
    }
}

impl Device<f32> for Card {
    fn name(&self) -> String {
        self.name.clone()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        worlds: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        self.open()?;
        let programs = Programs::record(solver).map_err(CardError::from)?;
        Ok(Box::new(Worlds::new(self, programs, worlds)?))
    }
    fn runs_impulse(&self) -> bool {
        true
    }
    fn place_piles(
        &self,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Option<Box<dyn DeviceWorlds<f32>>>, DeviceError> {
        self.open()?;
        let placed = Piles::new(self, impulse, model, filter, worlds);
        // Whatever became of these, nothing that was begun is left.
        let compiled = self.compiled();
        let placed = placed?;
        compiled?;
        Ok(Some(Box::new(placed)))
    }
}
