//! W worlds of one solver in a card's memory.
//!
//! A binding of a card has a largest size, so that worlds lie in *parts* of equal size, each with buffers of its
//! own; scratch is the invocations', each of which steps one world after the other.

use crate::instrument::Reading;
use crate::memory::{Staging, buffer, filled};
use crate::pipeline::OPTIONS;
use crate::placement::Placement;
use crate::{Gpu, GpuError};
use model::{CollisionFilter, Model};
use numbers::Memory;
use numbers::trace::PrintOptions;
use piles::{NUMBER, Need, Piles, TooLarge, WORKGROUP};
use records::{Instruments, Programs};
use rigid::impulse::Impulse;
use rigid::{Instrument, Lanes, Lengths, Report, Solver};
use sim::{Constants, Device, DeviceError, DeviceWorlds, Processor};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Worlds on a card. Reading waits for what was asked before; nothing else does.
#[derive(Debug)]
pub struct Worlds {
    gpu: Gpu,
    programs: Programs,
    worlds: usize,
    width: usize,
    lanes: Lanes,
    parts: Vec<Part>,
    scratch: wgpu::Buffer,
    links: wgpu::Buffer,
    /// One set for all worlds; each part has its own where worlds differ.
    parameters: wgpu::Buffer,
    /// Room for those of each part, from when it was asked for until they are written.
    reserved: OnceLock<Vec<wgpu::Buffer>>,
    /// Of the step, then of each report, once they were wanted.
    kernels: [Option<wgpu::ComputePipeline>; 5],
    /// What they see of each part, by the rounds of a launch, once these were wanted.
    bound: HashMap<usize, Vec<wgpu::BindGroup>>,
    /// What instruments were read by.
    readings: Instruments<Reading>,
}

/// Numbers of a world that are read.
#[derive(Clone, Copy, Debug)]
enum Held {
    State,
    Output,
    /// What was read by the instrument in this row.
    Read(usize),
}

/// Some of the worlds.
#[derive(Debug)]
pub(crate) struct Part {
    worlds: Range<usize>,
    state: wgpu::Buffer,
    pub input: wgpu::Buffer,
    pub output: wgpu::Buffer,
    /// Where worlds have parameters of their own.
    parameters: Option<wgpu::Buffer>,
    staging: Staging,
}

impl Device<f32> for Gpu {
    fn name(&self) -> String {
        Gpu::name(self).to_owned()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        worlds: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        let programs = Programs::record(solver).map_err(GpuError::from)?;
        Ok(Box::new(Worlds::new(self, programs, worlds)?))
    }
    fn runs_impulse(&self) -> bool {
        true
    }
    fn has_failed(&self) -> bool {
        // One that was lost meanwhile tells when it is asked how far it is.
        let told = self.device().poll(wgpu::PollType::Poll);
        told.is_err() || self.check().is_err()
    }
    fn place_piles(
        &self,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Option<Box<dyn DeviceWorlds<f32>>>, DeviceError> {
        let placed = Piles::new(self, impulse, model, filter, worlds)?;
        Ok(Some(Box::new(placed)))
    }
}

impl From<GpuError> for DeviceError {
    fn from(error: GpuError) -> Self {
        Self::new(error)
    }
}

impl Worlds {
    /// Takes memory for worlds of a solver. What they hold is zero until it is written.
    ///
    /// # Errors
    /// One world, or what all have in common, is larger than a buffer of the card; its memory is full; it has failed before.
    pub fn new(gpu: &Gpu, programs: Programs, worlds: usize) -> Result<Self, GpuError> {
        gpu.check()?;
        let lengths = programs.lengths;
        let (width, lanes) = spread(gpu, lengths, worlds)?;
        for numbers in [programs.parameters.len(), programs.links.len()] {
            fits(gpu, Need::Model, numbers)?;
        }
        let of = |numbers: usize| buffer(gpu, numbers as u64 * width as u64);
        let parts = (0..worlds.div_ceil(width)).map(|part| {
            Ok(Part {
                worlds: part * width..worlds.min((part + 1) * width),
                state: of(lengths.state)?,
                input: of(lengths.input)?,
                output: of(lengths.output)?,
                parameters: None,
                staging: Staging::default(),
            })
        });
        let numbers: Vec<_> = programs.parameters.iter().map(|x| *x as f32).collect();
        Ok(Self {
            parts: parts.collect::<Result<_, GpuError>>()?,
            scratch: buffer(gpu, lanes.scratch as u64)?,
            lanes,
            links: filled(gpu, &programs.links)?,
            parameters: filled(gpu, &numbers)?,
            reserved: OnceLock::new(),
            kernels: Default::default(),
            bound: HashMap::new(),
            readings: Instruments::default(),
            gpu: gpu.clone(),
            programs,
            worlds,
            width,
        })
    }

    /// Worlds that lie side by side in one buffer.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Takes room for constants of each world, unless it has some.
    fn reserve(&self) -> Result<(), GpuError> {
        if self.differing() || self.reserved.get().is_some() {
            return Ok(());
        }
        let numbers = self.programs.parameters.len() * self.width;
        fits(&self.gpu, Need::Parameters, numbers)?;
        let buffers = self.parts.iter().map(|_| buffer(&self.gpu, numbers as u64));
        let buffers = buffers.collect::<Result<_, _>>()?;
        // Who was faster has taken as much.
        let _ = self.reserved.set(buffers);
        Ok(())
    }
    fn differing(&self) -> bool {
        self.parts.iter().any(|part| part.parameters.is_some())
    }
    /// The constants of a part.
    fn own<'a>(&'a self, part: &'a Part) -> &'a wgpu::Buffer {
        part.parameters.as_ref().unwrap_or(&self.parameters)
    }

    /// What fills a report, or makes a step.
    fn kernel(&mut self, report: Option<Report>) -> Result<wgpu::ComputePipeline, GpuError> {
        let i = report.map_or(0, |report| 1 + report as usize);
        if let Some(known) = &self.kernels[i] {
            return Ok(known.clone());
        }
        let step = &self.programs.step;
        let program = report.map_or(step, |report| self.programs.report(report));
        let compiled = self.gpu.printed(
            program,
            &PrintOptions {
                parameters_per_world: self.differing(),
                pieces: self.lanes.pieces,
                ..OPTIONS
            },
        )?;
        self.kernels[i] = Some(compiled.clone());
        Ok(compiled)
    }

    /// Writes these numbers of all worlds.
    fn write<'a>(
        &'a self,
        numbers: Range<usize>,
        memory: &Memory<f32>,
        buffer: impl Fn(usize, &'a Part) -> &'a wgpu::Buffer,
    ) {
        assert_eq!(memory.worlds(), self.worlds, "worlds of a memory");
        let at = (numbers.start * self.width) as u64 * NUMBER;
        for (nth, part) in self.parts.iter().enumerate() {
            let rows = memory.rows(numbers.clone(), part.worlds.clone(), self.width);
            let bytes = bytemuck::cast_slice(&rows);
            self.gpu.queue().write_buffer(buffer(nth, part), at, bytes);
        }
    }

    /// Writes constants of these worlds; those of all, which are known, where they are more than half.
    fn write_own<'a>(
        &'a self,
        worlds: &[usize],
        numbers: Range<usize>,
        memory: &Memory<f32>,
        buffer: impl Fn(usize, &'a Part) -> &'a wgpu::Buffer,
    ) -> Result<(), GpuError> {
        if 2 * worlds.len() <= self.worlds {
            return self.place(worlds, numbers, memory, buffer);
        }
        self.write(numbers, memory, buffer);
        self.gpu.check()
    }
    /// Writes these numbers of some worlds.
    fn place<'a>(
        &'a self,
        worlds: &[usize],
        numbers: Range<usize>,
        memory: &Memory<f32>,
        buffer: impl Fn(usize, &'a Part) -> &'a wgpu::Buffer,
    ) -> Result<(), GpuError> {
        for (nth, part) in self.parts.iter().enumerate() {
            let of_part = worlds.iter().filter(|w| part.worlds.contains(w));
            let of_part: Vec<_> = of_part.copied().collect();
            if of_part.is_empty() {
                continue;
            }
            let number = |i| of_part.iter().map(move |w| memory.get(*w, i));
            let columns: Vec<_> = numbers.clone().flat_map(number).collect();
            let within = of_part.iter().map(|w| (w - part.worlds.start) as u32);
            let placement = Placement {
                worlds: &within.collect::<Vec<_>>(),
                columns: &columns,
                width: self.width,
            };
            placement.write(&self.gpu, buffer(nth, part))?;
        }
        Ok(())
    }

    /// Reads these numbers of all worlds, of all parts at once.
    fn read(
        &mut self,
        numbers: &[Range<usize>],
        memory: &mut Memory<f32>,
        held: Held,
    ) -> Result<(), GpuError> {
        assert_eq!(memory.worlds(), self.worlds, "worlds of a memory");
        let width = self.width;
        let ranges = numbers.iter().filter(|range| !range.is_empty());
        let ranges = ranges.map(|range| range.start * width..range.end * width);
        let ranges = vec![Vec::from_iter(ranges); self.parts.len()];
        self.fetch(held, &ranges, |nth, mut read| {
            let worlds = nth * width..memory.worlds().min((nth + 1) * width);
            for range in numbers {
                let (own, rest) = read.split_at(range.len() * width);
                memory.set_rows(range.clone(), worlds.clone(), own);
                read = rest;
            }
        })
    }

    /// Reads these ranges of each part, of all parts at once: the nth of them, and its numbers.
    fn fetch(
        &mut self,
        held: Held,
        ranges: &[Vec<Range<usize>>],
        mut read: impl FnMut(usize, &[f32]),
    ) -> Result<(), GpuError> {
        let (gpu, readings) = (&self.gpu, &self.readings);
        let asked = |nth: &usize| !ranges[*nth].is_empty();
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        for nth in (0..ranges.len()).filter(asked) {
            let part = &mut self.parts[nth];
            let from = match held {
                Held::State => &part.state,
                Held::Output => &part.output,
                Held::Read(row) => &readings[row].buffers.numbers[nth],
            };
            let ranges = ranges[nth].iter().cloned();
            part.staging.ask(gpu, &mut encoder, from, ranges)?;
        }
        gpu.queue().submit([encoder.finish()]);
        let map = |nth: usize| Some((nth, self.parts[nth].staging.map()?));
        let mappings = (0..ranges.len()).filter(asked).filter_map(map);
        let mappings: Vec<_> = mappings.collect();
        gpu.wait()?;
        for (nth, mapping) in mappings {
            mapping.read(gpu, |numbers| read(nth, numbers))?;
        }
        Ok(())
    }

    /// Of each part, which of its worlds are among these, which are in order, where they are so few that to list them is
    /// worth its while: a launch has at most half of the workgroups that it has for all.
    fn lists(&self, worlds: &[usize]) -> Option<Vec<Vec<u32>>> {
        let before = |end: usize| worlds.partition_point(|world| *world < end);
        let lists = self.parts.iter().map(|part| {
            let Range { start, end } = part.worlds;
            let own = &worlds[before(start)..before(end)];
            Vec::from_iter(own.iter().map(|world| (world - start) as u32))
        });
        let lists = Vec::from_iter(lists);
        let longest = lists.iter().map(Vec::len).max().unwrap_or(0);
        let groups = |worlds: usize| worlds.div_ceil(WORKGROUP as usize);
        (2 * groups(longest) <= groups(self.width)).then_some(lists)
    }
    /// Copies what was read of the worlds that were listed.
    fn read_listed(
        &mut self,
        row: usize,
        lists: &[Vec<u32>],
        memory: &mut Memory<f32>,
    ) -> Result<(), GpuError> {
        let (numbers, width) = (memory.length(), self.width);
        let range = |list: &Vec<u32>| (!list.is_empty()).then(|| 0..numbers * list.len());
        let ranges = lists.iter().map(|list| Vec::from_iter(range(list)));
        self.fetch(Held::Read(row), &Vec::from_iter(ranges), |part, read| {
            let list = &lists[part];
            for (number, row) in read.chunks_exact(list.len()).take(numbers).enumerate() {
                for (x, within) in row.iter().zip(list) {
                    memory.set(part * width + *within as usize, number, *x);
                }
            }
        })
    }

    /// Runs a kernel of the solver on every part, `rounds` times in each of so many launches.
    fn launch(
        &mut self,
        kernel: &wgpu::ComputePipeline,
        rounds: usize,
        launches: usize,
    ) -> Result<(), GpuError> {
        if launches == 0 {
            return Ok(());
        }
        if !self.bound.contains_key(&rounds) {
            self.bound.insert(rounds, self.bind(rounds));
        }
        self.run(kernel, self.lanes, launches, &self.bound[&rounds])
    }
    /// What the solver's kernels see of each part in launches of so many rounds.
    fn bind(&self, rounds: usize) -> Vec<wgpu::BindGroup> {
        let launch = self.gpu.uniform(&[self.width as u32, rounds as u32]);
        let seen = |part: &Part| {
            let buffers = [
                &part.state,
                &part.input,
                &part.output,
                &self.scratch,
                part.parameters.as_ref().unwrap_or(&self.parameters),
                &self.links,
                &launch,
            ];
            self.gpu.bindings(self.gpu.layout(), &buffers)
        };
        self.parts.iter().map(seen).collect()
    }
    /// Runs a kernel that sees this of each part.
    fn run(
        &self,
        kernel: &wgpu::ComputePipeline,
        lanes: Lanes,
        launches: usize,
        seen: &[wgpu::BindGroup],
    ) -> Result<(), GpuError> {
        let groups = lanes.count as u32 / WORKGROUP;
        let device = self.gpu.device();
        let mut encoder = device.create_command_encoder(&Default::default());
        for bindings in seen {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(kernel);
            pass.set_bind_group(0, bindings, &[]);
            for _ in 0..launches {
                pass.dispatch_workgroups(groups, 1, 1);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
        self.gpu.check()
    }

    /// The row of what reads an instrument, in worlds with such constants, unless it does not fit.
    fn row_of(
        &mut self,
        instrument: &Arc<Instrument>,
        own: Option<&Constants<f32>>,
    ) -> Result<Option<usize>, GpuError> {
        let (gpu, parts, width) = (&self.gpu, &self.parts, self.width);
        let row = self.readings.row_of(
            instrument,
            |known| known.version.is_some() == own.is_some(),
            || Reading::new(gpu, instrument, (parts, width), own.is_some()),
        )?;
        if let (Some(row), Some(own)) = (row, own) {
            let reading = &self.readings[row];
            let changed = own.since(reading.version.unwrap_or(0));
            let all = 0..own.numbers.length();
            self.write_own(&changed, all, &own.numbers, |nth, _| {
                &reading.buffers.parameters[nth]
            })?;
            self.readings[row].version = Some(own.version);
        }
        Ok(row)
    }
}

impl DeviceWorlds<f32> for Worlds {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        let all = 0..self.programs.lengths.state;
        self.write(all, state, |_, part| &part.state);
        Ok(self.gpu.check()?)
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        let all = 0..self.programs.lengths.state;
        Ok(self.place(worlds, all, state, |_, part| &part.state)?)
    }
    fn write_input(
        &mut self,
        numbers: Range<usize>,
        input: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.write(numbers, input, |_, part| &part.input);
        Ok(self.gpu.check()?)
    }
    fn write_parameters(
        &mut self,
        worlds: &[usize],
        parameters: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.reserve()?;
        let all = 0..self.programs.parameters.len();
        let Some(buffers) = self.reserved.take() else {
            return Ok(self.write_own(worlds, all, parameters, |_, part| self.own(part))?);
        };
        for (part, buffer) in self.parts.iter_mut().zip(buffers) {
            part.parameters = Some(buffer);
        }
        self.kernels = Default::default();
        self.bound.clear();
        self.write(all, parameters, |_, part| self.own(part));
        Ok(self.gpu.check()?)
    }
    fn takes(&self, _: &[&[f64]]) -> Result<(), DeviceError> {
        Ok(self.reserve()?)
    }
    fn step(&mut self, substeps: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        let kernel = self.kernel(None)?;
        let most = self.gpu.rounds();
        let (full, rest) = (substeps / most, substeps % most);
        self.launch(&kernel, most, full)?;
        Ok(self.launch(&kernel, rest, usize::from(rest > 0))?)
    }
    fn report(&mut self, report: Report) -> Result<(), DeviceError> {
        let kernel = self.kernel(Some(report))?;
        Ok(self.launch(&kernel, 1, 1)?)
    }
    fn read_state(
        &mut self,
        numbers: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(self.read(numbers, state, Held::State)?)
    }
    fn read_output(
        &mut self,
        numbers: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(self.read(numbers, output, Held::Output)?)
    }
    fn measures(&self) -> bool {
        true
    }
    fn measure(
        &mut self,
        instrument: &Arc<Instrument>,
        own: Option<&Constants<f32>>,
        worlds: &[usize],
        numbers: &mut Memory<f32>,
    ) -> Result<bool, DeviceError> {
        let Some(row) = self.row_of(instrument, own)? else {
            return Ok(false);
        };
        let lists = self.lists(worlds);
        if let Some(lists) = &lists {
            self.readings[row].list(&self.gpu, instrument, (&self.parts, self.width), lists)?;
        }
        let reading = &self.readings[row];
        let way = reading.way(lists.is_some());
        let longest = lists.iter().flatten().map(Vec::len).max();
        let listed = longest.map(|worlds| worlds.next_multiple_of(WORKGROUP as usize));
        let lanes = Lanes {
            count: listed.unwrap_or(usize::MAX).min(reading.lanes.count),
            ..reading.lanes
        };
        self.run(&way.kernel, lanes, 1, &way.seen)?;
        match lists {
            Some(lists) => self.read_listed(row, &lists, numbers)?,
            None => {
                let all = 0..numbers.length();
                self.read(std::slice::from_ref(&all), numbers, Held::Read(row))?;
            }
        }
        Ok(true)
    }
}

/// Worlds of a part, and the invocations that step them: as few parts as buffers and 32-bit offsets allow, of equal size.
/// Where scratch does not last for a workgroup, parts have no more worlds than it lasts for.
fn spread(gpu: &Gpu, lengths: Lengths, worlds: usize) -> Result<(usize, Lanes), TooLarge> {
    fits(gpu, Need::World, lengths.longest().max(lengths.scratch))?;
    let (most, workgroup) = (most_numbers(gpu), WORKGROUP as usize);
    let (held, stepped) = (most / lengths.longest(), most / lengths.scratch.max(1));
    let widest = if stepped < workgroup {
        held.min(stepped)
    } else {
        held
    };
    let width = worlds.div_ceil(worlds.div_ceil(widest));
    let lanes = lengths.lanes(width, workgroup, most);
    Ok((
        width,
        lanes.expect("scratch lasts for a workgroup, or for so few worlds"),
    ))
}

/// Looks whether a buffer takes so many numbers.
fn fits(gpu: &Gpu, need: Need, numbers: usize) -> Result<(), TooLarge> {
    let [bytes, most] = [numbers, most_numbers(gpu)].map(|n| n as u64 * NUMBER);
    need.check(bytes, most, gpu.name())
}

/// Most numbers of a buffer.
pub(crate) fn most_numbers(gpu: &Gpu) -> usize {
    (gpu.most_bytes() / NUMBER).min(u64::from(u32::MAX)) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::{n_pendula, tower};
    use sim::{Simulation, SimulationSettings, SolverKind};

    #[test]
    #[ignore = "needs a graphics card or Mesa's llvmpipe"]
    fn a_card_that_is_lost_is_told_and_a_snapshot_goes_on() {
        for (model, solver) in [
            (n_pendula(3), SolverKind::Featherstone),
            (tower(2, 0.001), SolverKind::Impulse),
        ] {
            loses(model.unwrap(), solver);
        }
    }

    fn loses(model: Model, solver: SolverKind) {
        let name = std::env::var("KINETARIUM_GPU").unwrap_or_default();
        let gpu = Gpu::open(&name.parse().unwrap()).unwrap();
        let settings = SimulationSettings {
            solver,
            ..SimulationSettings::new(4, 0.002)
        };
        let mut simulation = Simulation::on(&gpu, model.clone(), settings).unwrap();
        simulation.step(50);
        let kept = simulation.snapshot();
        assert!(!gpu.has_failed());
        gpu.device().destroy();
        assert!(gpu.has_failed());
        for _ in 0..2 {
            let told = simulation.try_step(1).unwrap_err().to_string();
            assert!(
                told.contains(gpu.name()) && told.contains("snapshot"),
                "{told}"
            );
        }
        assert!(simulation.try_outputs().is_err());
        assert!(Simulation::on(&gpu, model.clone(), settings).is_err());
        let mut again = Simulation::<f32>::new(model, settings).unwrap();
        again.restore(&kept).unwrap();
        again.step(50);
        assert!(again.diverged().is_empty());
    }
}
