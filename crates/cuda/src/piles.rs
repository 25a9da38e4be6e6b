//! What piles ask of a card, by CUDA: their WGSL is [read and printed](crate::wgsl) as CUDA C++.

use crate::compiler::BLOCK;
use crate::kernel::Bound;
use crate::{Cuda, CudaError, libraries};
use cudarc::driver::{CudaEvent, CudaSlice, DevicePtr, sys::CUevent_flags::CU_EVENT_DEFAULT};
use numbers::trace::{Members, PrintOptions, Program};
use piles::{BINDINGS, Card, Entry, NUMBER};
use sim::{DeviceError, Stage};
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Words in the card's memory.
#[derive(Clone, Debug)]
pub struct Buffer(Arc<Words>);

#[derive(Debug)]
struct Words {
    memory: Mutex<CudaSlice<u32>>,
    at: u64,
    room: u64,
}

impl Buffer {
    fn new(card: &Cuda, memory: CudaSlice<u32>) -> Self {
        let room = memory.len() as u64;
        let at = memory.device_ptr(card.stream()).0;
        let memory = Mutex::new(memory);
        Self(Arc::new(Words { memory, at, room }))
    }
    /// Whatever a thread that panicked left, it is words.
    fn words(&self) -> MutexGuard<'_, CudaSlice<u32>> {
        self.0.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }
    /// Where a word lies.
    pub(crate) fn at(&self, word: u64) -> u64 {
        self.0.at + word * NUMBER
    }
}

/// Which buffers a kernel sees is known from its text.
#[derive(Debug)]
pub struct Layout;

/// The buffers that a launch sees; they stay for as long.
#[derive(Debug)]
pub struct Bindings {
    pub(crate) places: Vec<u64>,
    _buffers: Vec<Buffer>,
}

impl Bindings {
    fn new(buffers: &[&Buffer]) -> Self {
        Self {
            places: buffers.iter().map(|buffer| buffer.at(0)).collect(),
            _buffers: buffers.iter().copied().cloned().collect(),
        }
    }
}

/// What stages take, by events on the card's stream.
#[derive(Debug, Default)]
pub struct Clock {
    /// Which stage ends with each event, none with the first; and how many launches it had.
    marks: Vec<(Option<&'static str>, u64, CudaEvent)>,
    /// Launches since the last one.
    launches: u64,
    times: Vec<Stage>,
}

impl Clock {
    fn mark(&mut self, card: &Cuda, stage: Option<&'static str>) -> Result<(), CudaError> {
        let event = card.told(card.stream().record_event(Some(CU_EVENT_DEFAULT)))?;
        self.marks
            .push((stage, std::mem::take(&mut self.launches), event));
        Ok(())
    }
    /// Reads the marks of what is done.
    fn read(&mut self, card: &Cuda) -> Result<(), CudaError> {
        for pair in self.marks.windows(2) {
            let [(_, _, before), (Some(name), launches, event)] = pair else {
                continue;
            };
            let stage = Stage {
                name,
                seconds: f64::from(card.told(before.elapsed_ms(event))?) * 1e-3,
                launches: *launches,
            };
            stage.add_to(&mut self.times);
        }
        self.marks.clear();
        Ok(())
    }
}

/// What is asked of a card: at once, and told to have failed at the end.
#[derive(Debug)]
pub struct Commands<'a> {
    card: Cuda,
    clock: Option<&'a mut Clock>,
    /// Whether anything was launched.
    begun: bool,
    asked: Result<(), CudaError>,
}

impl Commands<'_> {
    /// Runs a kernel; with the first of them a stage begins.
    fn launch(&mut self, kernel: &Bound, bindings: &Bindings, blocks: u32, told: Option<u64>) {
        if !std::mem::replace(&mut self.begun, true) {
            self.note(None);
        }
        if let Some(clock) = &mut self.clock {
            clock.launches += 1;
        }
        self.ask(|card| kernel.run(card, bindings, blocks, told));
    }
    fn note(&mut self, stage: Option<&'static str>) {
        if let (Ok(()), Some(clock)) = (&self.asked, &mut self.clock) {
            self.asked = clock.mark(&self.card, stage);
        }
    }
    /// Asks for more, unless something has failed.
    fn ask(&mut self, more: impl FnOnce(&Cuda) -> Result<(), CudaError>) {
        if self.asked.is_ok() {
            self.asked = more(&self.card);
        }
    }
}

impl piles::Commands<Cuda> for Commands<'_> {
    fn run(&mut self, kernel: &Bound, bindings: &Bindings, workgroups: u32) {
        self.launch(kernel, bindings, workgroups, None);
    }
    fn run_told(
        &mut self,
        kernel: &Bound,
        bindings: &Bindings,
        (launches, nth): (&Buffer, u32),
        most: u32,
    ) {
        let told = launches.at(3 * u64::from(nth));
        self.launch(kernel, bindings, most, Some(told));
    }
    fn copy(&mut self, from: &Buffer, words: Range<usize>, to: &Buffer, at: usize) {
        self.ask(|card| {
            let (from, mut to) = (from.words(), to.words());
            let (from, mut to) = (
                from.slice(words.clone()),
                to.slice_mut(at..at + words.len()),
            );
            card.told(card.stream().memcpy_dtod(&from, &mut to))
        });
    }
    fn mark(&mut self, stage: &'static str) {
        self.note(Some(stage));
    }
}

impl Card for Cuda {
    type Buffer = Buffer;
    type Layout = Layout;
    type Bindings = Bindings;
    type Kernel = Bound;
    type Staging = ();
    type Clock = Clock;
    type Commands<'a> = Commands<'a>;

    fn name(&self) -> &str {
        Cuda::name(self)
    }
    fn most_bytes(&self) -> u64 {
        Cuda::most_bytes(self)
    }
    /// So few that all that a step counts fits into 32 bits.
    fn most_invocations(&self) -> u32 {
        1 << 26
    }
    fn check(&self) -> Result<(), DeviceError> {
        Ok(Cuda::check(self)?)
    }
    fn failed(&self, reason: &str) -> DeviceError {
        Cuda::failed(self, reason.to_owned()).into()
    }

    fn buffer(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(Buffer::new(self, self.memory(words.max(2) as usize)?))
    }
    fn launches(&self, words: u64) -> Result<Buffer, DeviceError> {
        self.buffer(words)
    }
    fn uniform(&self, words: &[u32]) -> Result<Buffer, DeviceError> {
        Ok(Buffer::new(self, self.filled(words)?))
    }
    fn room(buffer: &Buffer) -> u64 {
        buffer.0.room
    }
    fn write(&self, buffer: &Buffer, from: u64, bytes: &[u8]) -> Result<(), DeviceError> {
        let words: Vec<u32> = bytemuck::pod_collect_to_vec(bytes);
        let (mut memory, from) = (buffer.words(), from as usize);
        let mut place = memory.slice_mut(from..from + words.len());
        Ok(self.told(self.stream().memcpy_htod(&words, &mut place))?)
    }

    fn layout(&self, _: usize, _: usize) -> Layout {
        Layout
    }
    fn entries<const N: usize>(
        &self,
        text: &str,
        entries: [Entry; N],
        _: &Layout,
    ) -> Result<[Bound; N], DeviceError> {
        let names = entries.map(|entry| entry.name);
        Ok(Bound::all(self, text, names)?)
    }
    fn bind(&self, _: &Layout, buffers: &[&Buffer]) -> Bindings {
        Bindings::new(buffers)
    }
    fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<Bound, DeviceError> {
        let options = PrintOptions {
            workgroup_size: BLOCK,
            parameters_per_world,
            members,
            ..PrintOptions::default()
        };
        let text = program.to_wgsl(&options).map_err(CudaError::from)?;
        let [kernel] = Bound::all(self, &text, ["main"])?;
        Ok(kernel)
    }
    fn bind_kernel(&self, buffers: [&Buffer; BINDINGS]) -> Bindings {
        Bindings::new(&buffers)
    }

    fn clock(&self) -> Option<Clock> {
        libraries::times_events().then(Clock::default)
    }
    fn times(clock: Clock) -> Vec<Stage> {
        clock.times
    }
    fn commands<'a>(&self, clock: Option<&'a mut Clock>) -> Commands<'a> {
        Commands {
            card: self.clone(),
            clock,
            begun: false,
            asked: self.check(),
        }
    }
    fn submit(&self, commands: Commands<'_>) -> Result<(), DeviceError> {
        Ok(commands.asked?)
    }
    fn fetch(
        &self,
        commands: Commands<'_>,
        (): &mut (),
        buffer: &Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError> {
        commands.asked?;
        let mut words = vec![0; ranges.clone().map(|range| range.len()).sum()];
        let (memory, mut rest) = (buffer.words(), &mut words[..]);
        for range in ranges {
            let (own, others) = rest.split_at_mut(range.len());
            self.told(self.stream().memcpy_dtoh(&memory.slice(range), own))?;
            rest = others;
        }
        self.told(self.stream().synchronize())?;
        drop(memory);
        if let Some(clock) = commands.clock {
            clock.read(self)?;
        }
        read(bytemuck::cast_slice(&words));
        Ok(())
    }
}
