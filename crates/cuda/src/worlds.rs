//! W worlds of one solver in a card's memory.
//!
//! There, a world's number at `offset` lies at `offset · W + world`: neighbouring threads read neighbouring words. So it
//! does in the pieces in which state and scratch lie, which others do not share (`numbers::trace::PIECE`).

use crate::compiler::BLOCK;
use crate::instrument::Reading;
use crate::kernel::{Kernel, Launch, Placement, gather, state_numbers};
use crate::{Cuda, CudaError};
use cudarc::driver::CudaSlice;
use model::{CollisionFilter, Model};
use numbers::Memory;
use numbers::trace::{PIECE, PrintOptions};
use piles::{NUMBER, Need, Piles};
use records::{Instruments, Programs};
use rigid::impulse::Impulse;
use rigid::{Instrument, Lanes, Report, Solver};
use sim::{Address, Constants, Device, DeviceError, DeviceWorlds, Processor};
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// Substeps of one launch: many, as a launch costs some microseconds and ends with its last world, and few enough that a card
/// that also draws a desktop is not taken for hung (2 s): 65,536 humanoids with all contacts take an H100 0.15 s.
const ROUNDS: usize = 32;

/// Most numbers of a memory: kernels count in 32 bits.
pub(crate) const MOST: usize = u32::MAX as usize;

/// Worlds on a card. Reading waits for what was asked before; nothing else does.
#[derive(Debug)]
pub struct Worlds {
    card: Cuda,
    programs: Programs,
    worlds: usize,
    lanes: Lanes,
    state: CudaSlice<f32>,
    input: CudaSlice<f32>,
    output: CudaSlice<f32>,
    scratch: CudaSlice<f32>,
    /// Rows of the state that are read.
    rows: CudaSlice<f32>,
    links: CudaSlice<u32>,
    /// One set for all worlds, or one for each.
    parameters: CudaSlice<f32>,
    parameters_per_world: bool,
    /// Room for one set for each, from when it was asked for until they are written.
    reserved: OnceLock<CudaSlice<f32>>,
    /// Of the step, then of each report, once they were wanted.
    kernels: [Option<Kernel>; 5],
    /// What instruments were read by.
    readings: Instruments<Reading>,
}

impl Device<f32> for Cuda {
    fn name(&self) -> String {
        Cuda::name(self).to_owned()
    }
    fn place(
        &self,
        solver: Solver<'_>,
        worlds: usize,
    ) -> Result<Box<dyn DeviceWorlds<f32>>, DeviceError> {
        let programs = Programs::record(solver).map_err(CudaError::from)?;
        Ok(Box::new(Worlds::new(self, programs, worlds)?))
    }
    fn runs_impulse(&self) -> bool {
        true
    }
    fn has_failed(&self) -> bool {
        self.check().is_err()
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

impl From<CudaError> for DeviceError {
    fn from(error: CudaError) -> Self {
        Self::new(error)
    }
}

impl Worlds {
    /// Takes memory for worlds of a solver. What they hold is zero until it is written.
    ///
    /// # Errors
    /// They are more than kernels can count; the card's memory is full; it has failed before.
    pub fn new(card: &Cuda, programs: Programs, worlds: usize) -> Result<Self, CudaError> {
        let lengths = programs.lengths;
        let most = MOST / lengths.longest();
        let most = most - most % PIECE as usize;
        let lanes = lengths.lanes(worlds, BLOCK as usize, MOST);
        let Some(lanes) = lanes.filter(|_| worlds <= most) else {
            return Err(CudaError::TooMany { worlds, most });
        };
        let of = |numbers: usize| card.memory(numbers * worlds);
        let numbers: Vec<_> = programs.parameters.iter().map(|x| *x as f32).collect();
        Ok(Self {
            state: card.memory(state_numbers(lengths.state, worlds))?,
            input: of(lengths.input)?,
            output: of(lengths.output)?,
            scratch: card.memory(lanes.scratch)?,
            rows: card.memory(worlds)?,
            lanes,
            links: card.filled(&programs.links)?,
            parameters: card.filled(&numbers)?,
            parameters_per_world: false,
            reserved: OnceLock::new(),
            kernels: Default::default(),
            readings: Instruments::default(),
            card: card.clone(),
            programs,
            worlds,
        })
    }

    /// Takes room for constants of each world, unless it has some.
    fn reserve(&self) -> Result<(), CudaError> {
        if self.parameters_per_world || self.reserved.get().is_some() {
            return Ok(());
        }
        let numbers = self.programs.parameters.len() * self.worlds;
        let [bytes, most] = [numbers, MOST].map(|n| n as u64 * NUMBER);
        Need::Parameters.check(bytes, most, self.card.name())?;
        // Who was faster has taken as much.
        let _ = self.reserved.set(self.card.memory(numbers)?);
        Ok(())
    }
    /// What fills a report, or makes a step.
    fn kernel(&mut self, report: Option<Report>) -> Result<Kernel, CudaError> {
        let i = report.map_or(0, |report| 1 + report as usize);
        if let Some(known) = &self.kernels[i] {
            return Ok(known.clone());
        }
        let step = &self.programs.step;
        let program = report.map_or(step, |report| self.programs.report(report));
        let options = PrintOptions {
            workgroup_size: BLOCK,
            parameters_per_world: self.parameters_per_world,
            pieces: self.lanes.pieces,
            state_pieces: Some(self.programs.lengths.state as u32),
            ..PrintOptions::default()
        };
        let compiled = Kernel::new(&self.card, program, &options)?;
        self.kernels[i] = Some(compiled.clone());
        Ok(compiled)
    }
    /// Runs a kernel on all worlds, `rounds` times in one launch.
    fn launch(&mut self, kernel: &Kernel, rounds: usize) -> Result<(), CudaError> {
        let launch = Launch {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: &self.parameters,
            links: &self.links,
            worlds: self.worlds as u32,
            lanes: self.lanes.count as u32,
            rounds: rounds as u32,
        };
        launch.run(&self.card, kernel)
    }
    /// The row of what reads an instrument, in worlds with such constants, unless its numbers are too many.
    fn row_of(
        &mut self,
        instrument: &Arc<Instrument>,
        own: Option<&Constants<f32>>,
    ) -> Result<Option<usize>, CudaError> {
        let (card, worlds) = (&self.card, self.worlds);
        let row = self.readings.row_of(
            instrument,
            |known| known.version.is_some() == own.is_some(),
            || Reading::new(card, instrument, worlds, own.is_some()),
        )?;
        if let (Some(row), Some(own)) = (row, own) {
            let reading = &mut self.readings[row];
            let changed = own.since(reading.version.unwrap_or(0));
            let all = 0..own.numbers.length();
            write_own(card, &changed, all, &own.numbers, &mut reading.parameters)?;
            reading.version = Some(own.version);
        }
        Ok(row)
    }
    /// The worlds of each piece of the state.
    fn pieces(&self) -> impl Iterator<Item = Range<usize>> + use<> {
        let worlds = self.worlds;
        let begins = (0..worlds).step_by(PIECE as usize);
        begins.map(move |begin| begin..worlds.min(begin + PIECE as usize))
    }
    /// Reads rows of the state.
    fn read_rows(&mut self, rows: Range<usize>, state: &mut Memory<f32>) -> Result<(), CudaError> {
        let (card, size) = (&self.card, [self.programs.lengths.state, self.worlds]);
        let numbers = rows.len() * self.worlds;
        if self.rows.len() < numbers {
            self.rows = card.memory(numbers)?;
        }
        gather(card, rows.clone(), size, &self.state, &mut self.rows)?;
        let read = card.stream().clone_dtoh(&self.rows.slice(..numbers));
        state.set_rows(rows, 0..self.worlds, &card.told(read)?);
        Ok(())
    }
    /// Reads all numbers of all worlds as they lie there.
    fn read_whole_state(&self, state: &mut Memory<f32>) -> Result<(), CudaError> {
        let all = 0..self.programs.lengths.state;
        let numbers = self.card.told(self.card.stream().clone_dtoh(&self.state))?;
        let pieces = numbers.chunks(all.len().max(1) * PIECE as usize);
        for (worlds, piece) in self.pieces().zip(pieces) {
            state.set_rows(all.clone(), worlds, piece);
        }
        Ok(())
    }
}

impl DeviceWorlds<f32> for Worlds {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        self.card.check()?;
        let all = 0..self.programs.lengths.state;
        let of_piece = |worlds| state.rows(all.clone(), worlds, PIECE as usize);
        let numbers: Vec<_> = self.pieces().flat_map(of_piece).collect();
        let stream = self.card.stream();
        let copied = stream.memcpy_htod(&numbers, &mut self.state);
        Ok(self.card.told(copied)?)
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        let (all, to) = (0..self.programs.lengths.state, &mut self.state);
        let piece = PIECE as usize;
        Ok(place(&self.card, worlds, all, state, to, piece)?)
    }
    fn write_input(&mut self, rows: Range<usize>, input: &Memory<f32>) -> Result<(), DeviceError> {
        Ok(write(&self.card, rows, input, &mut self.input)?)
    }
    fn write_parameters(
        &mut self,
        worlds: &[usize],
        parameters: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.reserve()?;
        let (card, all) = (&self.card, 0..self.programs.parameters.len());
        let Some(own) = self.reserved.take() else {
            let own = &mut self.parameters;
            return Ok(write_own(card, worlds, all, parameters, own)?);
        };
        self.parameters = own;
        self.parameters_per_world = true;
        self.kernels = Default::default();
        Ok(write(card, all, parameters, &mut self.parameters)?)
    }
    fn takes(&self, _: &[&[f64]]) -> Result<(), DeviceError> {
        Ok(self.reserve()?)
    }
    fn step(&mut self, substeps: usize, _: &mut Processor<'_, f32>) -> Result<(), DeviceError> {
        let kernel = self.kernel(None)?;
        for done in (0..substeps).step_by(ROUNDS) {
            self.launch(&kernel, ROUNDS.min(substeps - done))?;
        }
        Ok(())
    }
    fn report(&mut self, report: Report) -> Result<(), DeviceError> {
        let kernel = self.kernel(Some(report))?;
        Ok(self.launch(&kernel, 1)?)
    }
    fn read_state(
        &mut self,
        rows: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        self.card.check()?;
        let all = 0..self.programs.lengths.state;
        if rows.contains(&all) {
            return Ok(self.read_whole_state(state)?);
        }
        for rows in rows.iter().filter(|rows| !rows.is_empty()) {
            self.read_rows(rows.clone(), state)?;
        }
        Ok(())
    }
    fn read_output(
        &mut self,
        rows: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(read(&self.card, rows, &self.output, output)?)
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
        let reading = &mut self.readings[row];
        // For more, to list them is not worth its while.
        let blocks = |worlds: usize| worlds.div_ceil(BLOCK as usize);
        let listed = 2 * blocks(worlds.len()) <= blocks(self.worlds);
        if listed {
            reading.list(&self.card, instrument, self.worlds, worlds)?;
        }
        let way = reading.few.as_ref().filter(|_| listed);
        let way = way.unwrap_or(&reading.all);
        let lanes = if listed {
            worlds.len().min(reading.lanes.count)
        } else {
            reading.lanes.count
        };
        let launch = Launch {
            // What the solver is told and has reported is what this kernel is given.
            state: &mut self.input,
            input: &self.output,
            output: &mut reading.numbers,
            scratch: &mut reading.scratch,
            parameters: &reading.parameters,
            links: &way.links,
            worlds: self.worlds as u32,
            lanes: lanes as u32,
            rounds: 1,
        };
        launch.run(&self.card, &way.kernel)?;
        if listed {
            read_listed(&self.card, worlds, &reading.numbers, numbers)?;
        } else {
            let all = 0..numbers.length();
            read(&self.card, &[all], &reading.numbers, numbers)?;
        }
        Ok(true)
    }
    fn input_address(&self) -> Result<Option<Address>, DeviceError> {
        Ok(Some(self.card.address(&self.input)?))
    }
    fn read_input(
        &mut self,
        rows: &[Range<usize>],
        input: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        Ok(read(&self.card, rows, &self.input, input)?)
    }
    fn output_address(&self) -> Result<Option<Address>, DeviceError> {
        Ok(Some(self.card.address(&self.output)?))
    }
}

/// Writes these numbers of all worlds.
fn write(
    card: &Cuda,
    rows: Range<usize>,
    from: &Memory<f32>,
    to: &mut CudaSlice<f32>,
) -> Result<(), CudaError> {
    card.check()?;
    if rows.is_empty() {
        return Ok(());
    }
    let worlds = from.worlds();
    let mut place = to.slice_mut(rows.start * worlds..rows.end * worlds);
    let numbers = from.rows(rows, 0..worlds, worlds);
    card.told(card.stream().memcpy_htod(&numbers, &mut place))
}

/// Writes constants of these worlds; those of all, which are known, where they are more than half.
fn write_own(
    card: &Cuda,
    worlds: &[usize],
    numbers: Range<usize>,
    from: &Memory<f32>,
    to: &mut CudaSlice<f32>,
) -> Result<(), CudaError> {
    if 2 * worlds.len() <= from.worlds() {
        place(card, worlds, numbers, from, to, from.worlds())
    } else {
        write(card, numbers, from, to)
    }
}

/// Writes these numbers, which are all that a memory has, of some worlds, of which so many lie together.
fn place(
    card: &Cuda,
    worlds: &[usize],
    numbers: Range<usize>,
    from: &Memory<f32>,
    to: &mut CudaSlice<f32>,
    piece: usize,
) -> Result<(), CudaError> {
    if worlds.is_empty() || numbers.is_empty() {
        return Ok(());
    }
    let number = |i| worlds.iter().map(move |world| from.get(*world, i));
    let placement = Placement {
        places: &worlds.iter().map(|w| *w as u32).collect::<Vec<_>>(),
        columns: &numbers.flat_map(number).collect::<Vec<_>>(),
        piece,
    };
    placement.write(card, from.worlds(), to)
}

/// Reads these numbers of all worlds.
fn read(
    card: &Cuda,
    rows: &[Range<usize>],
    from: &CudaSlice<f32>,
    to: &mut Memory<f32>,
) -> Result<(), CudaError> {
    card.check()?;
    let worlds = to.worlds();
    for rows in rows.iter().filter(|rows| !rows.is_empty()) {
        let place = from.slice(rows.start * worlds..rows.end * worlds);
        let numbers = card.told(card.stream().clone_dtoh(&place))?;
        to.set_rows(rows.clone(), 0..worlds, &numbers);
    }
    Ok(())
}

/// Reads all numbers of these worlds, which lie together.
fn read_listed(
    card: &Cuda,
    worlds: &[usize],
    from: &CudaSlice<f32>,
    to: &mut Memory<f32>,
) -> Result<(), CudaError> {
    let together = from.slice(..worlds.len() * to.length());
    let numbers = card.told(card.stream().clone_dtoh(&together))?;
    for (number, row) in numbers.chunks_exact(worlds.len()).enumerate() {
        for (x, world) in row.iter().zip(worlds) {
            to.set(*world, number, *x);
        }
    }
    Ok(())
}
