//! Worlds on the graphics card of the page.
//!
//! The page knows buffers of words and kernels, by numbers that it gives them, and nothing of worlds. What waits for
//! the card suspends this module: until that has come back, none of its exports may be called.

use numbers::Memory;
use numbers::trace::{PrintOptions, TraceError, WgslError};
use records::Programs;
use rigid::{Lanes, Lengths, Report, Solver};
use sim::{Device, DeviceError, DeviceWorlds, Processor};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

// All answers are 0 where a call has failed, and `failure` says why.
#[link(wasm_import_module = "gpu")]
unsafe extern "C" {
    /// Opens the card, unless it is open. Waits.
    safe fn open() -> u32;
    /// Most bytes of a buffer that a kernel sees.
    safe fn most_bytes() -> f64;
    /// Takes memory for so many words; its number. Waits.
    safe fn buffer(words: u32) -> u32;
    /// Compiles a text, or finds what was compiled from it; its number. Waits.
    unsafe fn kernel(text: *const u8, length: usize) -> u32;
    /// Lets a buffer or a kernel go.
    safe fn release(number: u32);
    /// Writes words into a buffer, from `at` on.
    unsafe fn write(buffer: u32, at: u32, words: *const u8, count: usize) -> u32;
    /// Runs a kernel so many `times`, over six buffers and the uniform of `worlds` and `rounds`.
    unsafe fn launch(
        kernel: u32,
        buffers: *const u32,
        worlds: u32,
        rounds: u32,
        workgroups: u32,
        times: u32,
    ) -> u32;
    /// Copies ranges of a buffer's words, `count` pairs of a start and a length, one after the other. Waits.
    unsafe fn read(buffer: u32, ranges: *const u32, count: usize, words: *mut u8) -> u32;
    /// Copies why the last call failed, in UTF-8, as far as there is room; how long that is.
    unsafe fn failure(text: *mut u8, room: usize) -> usize;
}

/// Bytes of a number.
const NUMBER: usize = size_of::<f32>();
/// Invocations in a workgroup.
const WORKGROUP: u32 = 64;
/// Substeps of one launch: few enough that a card that also draws the page is not taken for hung.
const ROUNDS: usize = 16;
/// Longest reason that is told [bytes].
const MOST_REASON: usize = 500;

/// Why worlds do not run on the card.
#[derive(Debug, thiserror::Error)]
enum CardError {
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
    #[error("the graphics card `{card}` failed: {reason}")]
    Failed { card: String, reason: String },
}

impl From<CardError> for DeviceError {
    fn from(error: CardError) -> Self {
        Self::new(error)
    }
}

/// The card of the page.
#[derive(Clone, Debug)]
pub(crate) struct Card {
    pub name: String,
}

impl Card {
    /// What a call has answered, unless that is that it failed.
    fn check(&self, answer: u32) -> Result<u32, CardError> {
        if answer != 0 {
            return Ok(answer);
        }
        let mut reason = vec![0; MOST_REASON];
        // SAFETY: the page writes at most so many bytes, there.
        let length = unsafe { failure(reason.as_mut_ptr(), reason.len()) };
        reason.truncate(length);
        Err(CardError::Failed {
            card: self.name.clone(),
            reason: String::from_utf8_lossy(&reason).into_owned(),
        })
    }
    /// A buffer of so many words, or of two, as cards have no empty ones.
    fn buffer(&self, words: usize) -> Result<Owned, CardError> {
        Ok(Owned(self.check(buffer(words.max(2) as u32))?))
    }
    /// A buffer that holds this.
    fn filled<T: bytemuck::NoUninit>(&self, words: &[T]) -> Result<Owned, CardError> {
        let buffer = self.buffer(words.len())?;
        self.write(&buffer, 0, bytemuck::cast_slice(words))?;
        Ok(buffer)
    }
    fn write(&self, buffer: &Owned, at: usize, words: &[u8]) -> Result<(), CardError> {
        let count = words.len() / NUMBER;
        // SAFETY: the page reads so many words, there.
        self.check(unsafe { write(buffer.0, at as u32, words.as_ptr(), count) })?;
        Ok(())
    }
    fn kernel(&self, text: &str) -> Result<Owned, CardError> {
        // SAFETY: the page reads so many bytes, there.
        Ok(Owned(
            self.check(unsafe { kernel(text.as_ptr(), text.len()) })?,
        ))
    }
    /// The invocations that step so many worlds, if buffers take these.
    fn lanes(&self, lengths: Lengths, worlds: usize) -> Result<Lanes, CardError> {
        let numbers = most_bytes() as usize / NUMBER;
        let most = numbers / lengths.longest();
        let lanes = lengths.lanes(worlds, WORKGROUP as usize, numbers);
        lanes
            .filter(|_| worlds <= most)
            .ok_or_else(|| CardError::Worlds {
                worlds,
                most: most.min(numbers / lengths.scratch.max(1)),
                card: self.name.clone(),
            })
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
        self.check(open())?;
        let programs = Programs::record(solver).map_err(CardError::from)?;
        Ok(Box::new(Worlds::new(self, programs, worlds)?))
    }
}

/// A buffer or a kernel of the page, which is let go with this.
#[derive(Debug)]
struct Owned(u32);

impl Drop for Owned {
    fn drop(&mut self) {
        release(self.0);
    }
}

/// What is run: a substep, or a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Task {
    Step,
    Report(Report),
}

/// Worlds on the card, all in one part.
#[derive(Debug)]
struct Worlds {
    card: Card,
    programs: Programs,
    kernels: BTreeMap<Task, Owned>,
    worlds: usize,
    lanes: Lanes,
    state: Owned,
    input: Owned,
    output: Owned,
    scratch: Owned,
    /// One set for all worlds, or one for each where they differ.
    parameters: Owned,
    differing: bool,
    /// Room for one for each, where that was asked for.
    reserved: OnceLock<Owned>,
    links: Owned,
}

impl Worlds {
    fn new(card: &Card, programs: Programs, worlds: usize) -> Result<Self, CardError> {
        let lengths = programs.lengths;
        let lanes = card.lanes(lengths, worlds)?;
        let of = |numbers: usize| card.buffer(numbers * worlds);
        let parameters: Vec<_> = programs.parameters.iter().map(|x| *x as f32).collect();
        Ok(Self {
            kernels: BTreeMap::new(),
            state: of(lengths.state)?,
            input: of(lengths.input)?,
            output: of(lengths.output)?,
            scratch: card.buffer(lanes.scratch)?,
            lanes,
            parameters: card.filled(&parameters)?,
            differing: false,
            reserved: OnceLock::new(),
            links: card.filled(&programs.links)?,
            card: card.clone(),
            programs,
            worlds,
        })
    }

    /// Takes memory for constants of each world's own, unless they have them.
    fn reserve(&self) -> Result<(), CardError> {
        if self.differing || self.reserved.get().is_some() {
            return Ok(());
        }
        let numbers = self.programs.parameters.len();
        let most = most_bytes() as usize / NUMBER / numbers.max(1);
        if self.worlds > most {
            return Err(CardError::Worlds {
                worlds: self.worlds,
                most,
                card: self.card.name.clone(),
            });
        }
        let buffer = self.card.buffer(numbers * self.worlds)?;
        // Nothing else has filled it meanwhile.
        let _ = self.reserved.set(buffer);
        Ok(())
    }

    /// Writes these numbers of all worlds.
    fn write(
        &self,
        buffer: &Owned,
        numbers: Range<usize>,
        memory: &Memory<f32>,
    ) -> Result<(), CardError> {
        let at = numbers.start * self.worlds;
        let rows = memory.rows(numbers, 0..self.worlds, self.worlds);
        self.card.write(buffer, at, bytemuck::cast_slice(&rows))
    }
    /// Reads these numbers of all worlds, all at once.
    fn read(
        &self,
        buffer: &Owned,
        numbers: &[Range<usize>],
        memory: &mut Memory<f32>,
    ) -> Result<(), CardError> {
        let width = self.worlds;
        let of_words = |range: &Range<usize>| [range.start * width, range.len() * width];
        let ranges: Vec<_> = numbers.iter().map(of_words).collect();
        let pairs: Vec<_> = ranges.iter().flatten().map(|&n| n as u32).collect();
        let all = ranges.iter().map(|[_, length]| length).sum();
        let mut rows = vec![0.0_f32; all];
        let words = rows.as_mut_ptr().cast();
        // SAFETY: the page reads so many pairs, and writes as many words as they say together.
        self.card
            .check(unsafe { read(buffer.0, pairs.as_ptr(), ranges.len(), words) })?;
        let mut rest = &rows[..];
        for (range, [_, length]) in numbers.iter().zip(ranges) {
            let (own, others) = rest.split_at(length);
            memory.set_rows(range.clone(), 0..width, own);
            rest = others;
        }
        Ok(())
    }

    fn run(&mut self, task: Task, rounds: usize, times: usize) -> Result<(), CardError> {
        if times == 0 {
            return Ok(());
        }
        if !self.kernels.contains_key(&task) {
            let program = match task {
                Task::Step => &self.programs.step,
                Task::Report(report) => self.programs.report(report),
            };
            let text = program.to_wgsl(&PrintOptions {
                workgroup_size: WORKGROUP,
                parameters_per_world: self.differing,
                pieces: self.lanes.pieces,
                ..PrintOptions::default()
            })?;
            self.kernels.insert(task, self.card.kernel(&text)?);
        }
        let buffers = [
            &self.state,
            &self.input,
            &self.output,
            &self.scratch,
            &self.parameters,
            &self.links,
        ];
        let buffers = buffers.map(|buffer| buffer.0);
        let (kernel, worlds) = (self.kernels[&task].0, self.worlds as u32);
        let (rounds, times) = (rounds as u32, times as u32);
        let groups = self.lanes.count as u32 / WORKGROUP;
        // SAFETY: the page reads six numbers, there.
        let launched = unsafe { launch(kernel, buffers.as_ptr(), worlds, rounds, groups, times) };
        self.card.check(launched)?;
        Ok(())
    }
}

impl DeviceWorlds<f32> for Worlds {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(self.write(&self.state, 0..self.programs.lengths.state, state)?)
    }
    // Those of all worlds come and go. A session sets all worlds at once, so that this is rare.
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        let length = self.programs.lengths.state;
        let all = 0..length;
        let mut own = Memory::new(self.worlds, length, state.width());
        self.read(&self.state, std::slice::from_ref(&all), &mut own)?;
        for &world in worlds {
            for number in all.clone() {
                own.set(world, number, state.get(world, number));
            }
        }
        self.write_state(&own)
    }
    fn write_input(
        &mut self,
        numbers: Range<usize>,
        input: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        let numbers = numbers.start..numbers.end.min(self.programs.lengths.input);
        Ok(self.write(&self.input, numbers, input)?)
    }
    fn write_parameters(&mut self, parameters: &Memory<f32>) -> Result<(), DeviceError> {
        let numbers = self.programs.parameters.len();
        if !self.differing {
            self.reserve()?;
            self.parameters = self.reserved.take().expect("it was reserved");
            self.differing = true;
            self.kernels.clear();
        }
        Ok(self.write(&self.parameters, 0..numbers, parameters)?)
    }
    fn takes(&self, _: &[&[f64]]) -> Result<(), DeviceError> {
        Ok(self.reserve()?)
    }
    fn step(&mut self, substeps: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        let (full, rest) = (substeps / ROUNDS, substeps % ROUNDS);
        self.run(Task::Step, ROUNDS, full)?;
        Ok(self.run(Task::Step, rest, usize::from(rest > 0))?)
    }
    fn report(&mut self, report: Report) -> Result<(), DeviceError> {
        Ok(self.run(Task::Report(report), 1, 1)?)
    }
    fn read_state(
        &mut self,
        numbers: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(self.read(&self.state, numbers, state)?)
    }
    fn read_output(
        &mut self,
        numbers: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(self.read(&self.output, numbers, output)?)
    }
}
