//! Worlds of one solver on the graphics card of the page, all in one part.

use crate::card::{Bindings, Buffer, Card, CardError, Commands, Kernel};
use numbers::Memory;
use numbers::trace::{PrintOptions, Program};
use piles::{KINDS, NUMBER, Need, WORKGROUP};
use records::Programs;
use rigid::{Lanes, Lengths, Report};
use sim::{DeviceError, DeviceWorlds, Processor};
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::OnceLock;

/// Substeps of one launch: few enough that a card that also draws the page is not taken for hung.
const ROUNDS: usize = 16;

impl Card {
    /// Begins to compile a record that is printed so.
    pub fn printed(&self, program: &Program, options: &PrintOptions) -> Result<Kernel, CardError> {
        let text = program.to_wgsl(&PrintOptions {
            workgroup_size: WORKGROUP,
            ..*options
        })?;
        let [kernel] = self.begin(&text, [("main", (0..).zip(KINDS).collect())])?;
        Ok(kernel)
    }
    /// Numbers of a buffer that a kernel sees, at most.
    fn most_numbers(&self) -> usize {
        (self.most_bytes() / NUMBER) as usize
    }
    /// The invocations that step so many worlds, if buffers take these.
    fn lanes(&self, lengths: Lengths, worlds: usize) -> Result<Lanes, CardError> {
        let numbers = self.most_numbers();
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

/// What is run: a substep, or a report.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Task {
    Step,
    Report(Report),
}

/// Worlds on the card.
#[derive(Debug)]
pub(crate) struct Worlds {
    card: Card,
    programs: Programs,
    kernels: BTreeMap<Task, Kernel>,
    worlds: usize,
    lanes: Lanes,
    state: Buffer,
    input: Buffer,
    output: Buffer,
    scratch: Buffer,
    /// One set for all worlds, or one for each where they differ.
    parameters: Buffer,
    differing: bool,
    /// Room for one for each, where that was asked for.
    reserved: OnceLock<Buffer>,
    links: Buffer,
    /// What kernels bind, by the rounds of a launch.
    bound: BTreeMap<usize, Bindings>,
}

impl Worlds {
    pub fn new(card: &Card, programs: Programs, worlds: usize) -> Result<Self, CardError> {
        let lengths = programs.lengths;
        let lanes = card.lanes(lengths, worlds)?;
        let of = |numbers: usize| card.buffer(numbers * worlds);
        for numbers in [programs.parameters.len(), programs.links.len()] {
            Need::Model.check(numbers as u64 * NUMBER, card.most_bytes(), &card.name)?;
        }
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
            bound: BTreeMap::new(),
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
        let most = self.card.most_numbers() / numbers.max(1);
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
        buffer: &Buffer,
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
        buffer: &Buffer,
        numbers: &[Range<usize>],
        memory: &mut Memory<f32>,
    ) -> Result<(), CardError> {
        let width = self.worlds;
        let ranges = numbers.iter();
        let ranges = ranges.map(|range| range.start * width..range.end * width);
        let rows = self.card.read(buffer, ranges)?;
        let mut rest = &rows[..];
        for range in numbers {
            let (own, others) = rest.split_at(range.len() * width);
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
            let options = PrintOptions {
                parameters_per_world: self.differing,
                pieces: self.lanes.pieces,
                ..PrintOptions::default()
            };
            let kernel = self.card.printed(program, &options)?;
            self.card.compiled()?;
            self.kernels.insert(task, kernel);
        }
        if !self.bound.contains_key(&rounds) {
            let launch = self.card.uniform(&[self.worlds as u32, rounds as u32])?;
            let bindings = self.card.bind(&[
                &self.state,
                &self.input,
                &self.output,
                &self.scratch,
                &self.parameters,
                &self.links,
                &launch,
            ]);
            self.bound.insert(rounds, bindings);
        }
        let groups = self.lanes.count as u32 / WORKGROUP;
        let mut commands = Commands::default();
        for _ in 0..times {
            commands.run(&self.kernels[&task], &self.bound[&rounds], groups);
        }
        self.card.submit(&commands)
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
        Ok(self.write(&self.input, numbers, input)?)
    }
    // Those of all worlds go there: a page gives them all at once.
    fn write_parameters(
        &mut self,
        _: &[usize],
        parameters: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        let numbers = self.programs.parameters.len();
        if !self.differing {
            self.reserve()?;
            self.parameters = self.reserved.take().expect("it was reserved");
            self.differing = true;
            self.kernels.clear();
            self.bound.clear();
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
