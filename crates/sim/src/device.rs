//! Worlds in the memory of a device, such as a graphics card.
//!
//! A device runs the kernels of a solver from their records. It keeps the state from step to step; controls
//! go there when they have changed, and what is read comes back when it is asked for. Which numbers are known on
//! both sides is kept here.

use crate::controls::Changes;
use crate::engine::Task;
use crate::ranges::Ranges;
use model::{CollisionFilter, Model};
use numbers::{Float, Memory};
use rigid::impulse::Impulse;
use rigid::{Instrument, Report, Solver};
use std::ops::Range;
use std::sync::Arc;

/// What runs the kernels of solvers in a memory of its own.
pub trait Device<T: Float>: Send + Sync {
    /// Its name.
    fn name(&self) -> String;
    /// Takes memory for worlds of a solver. What they hold is not known until it is written.
    ///
    /// # Errors
    /// Whatever keeps the device from it: too little memory, a kernel that it does not take.
    fn place(
        &self,
        solver: Solver<'_>,
        worlds: usize,
    ) -> Result<Box<dyn DeviceWorlds<T>>, DeviceError>;
    /// Whether it runs `impulse`, so that `auto` may take that.
    fn runs_impulse(&self) -> bool {
        false
    }
    /// Whether it has failed, as far as it tells at once: no worlds can be placed there any more.
    fn has_failed(&self) -> bool {
        false
    }
    /// The same for worlds of `impulse`, of a model in which shapes touch as the filter has it; none where the device does
    /// not run them.
    ///
    /// # Errors
    /// As [`place`](Self::place); what the model has and the device lacks.
    fn place_piles(
        &self,
        _impulse: &Impulse,
        _model: &Model,
        _filter: Option<&CollisionFilter>,
        _worlds: usize,
    ) -> Result<Option<Box<dyn DeviceWorlds<T>>>, DeviceError> {
        Ok(None)
    }
}

/// Takes so many substeps of a world on the processor, given its number and its state.
pub type Processor<'a, T> = dyn FnMut(usize, usize, &mut [T]) + 'a;

/// Worlds of one solver on a device.
///
/// Numbers go to and fro in memories of all worlds, of any width. Calls take effect in the order in which they
/// are made. Whatever fails: the device has failed as a whole, and what it held is lost.
pub trait DeviceWorlds<T: Float>: Send + Sync {
    /// Sets the state of all worlds.
    fn write_state(&mut self, state: &Memory<T>) -> Result<(), DeviceError>;
    /// Sets the state of some worlds, none of them twice, from that of all.
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<T>) -> Result<(), DeviceError>;
    /// Sets some numbers of the controls of all worlds, of which there are some.
    fn write_input(&mut self, rows: Range<usize>, input: &Memory<T>) -> Result<(), DeviceError>;
    /// Gives these worlds, none of them twice, constants of their own from those of all, in place of those that they have.
    /// The first time all worlds get theirs, in place of those of the solver.
    fn write_parameters(
        &mut self,
        worlds: &[usize],
        parameters: &Memory<T>,
    ) -> Result<(), DeviceError>;
    /// Advances all worlds by so many substeps; those that the device leaves to the processor are taken there.
    fn step(
        &mut self,
        substeps: usize,
        processor: &mut Processor<'_, T>,
    ) -> Result<(), DeviceError>;
    /// Whether worlds can have these constants of their own, each of another world, besides those that were written. A
    /// device may take the room for them, for [`write_parameters`](Self::write_parameters).
    ///
    /// # Errors
    /// They cannot.
    fn takes(&self, _parameters: &[&[f64]]) -> Result<(), DeviceError> {
        Ok(())
    }
    /// How many substeps of all worlds together it has left to the processor so far.
    fn left(&self) -> u64 {
        0
    }
    /// Begins to measure what the stages of its steps, and what it tells, take, where it has a clock.
    fn start_clock(&mut self) {}
    /// Ends that: what stages have taken, in their order.
    fn stop_clock(&mut self) -> Vec<Stage> {
        Vec::new()
    }
    /// Fills the output of all worlds from their state and controls, or makes ready to do so for those of its numbers that
    /// are read before the next step.
    fn report(&mut self, report: Report) -> Result<(), DeviceError>;
    /// Copies these numbers of the state of all worlds; the others of `state` stay.
    fn read_state(
        &mut self,
        rows: &[Range<usize>],
        state: &mut Memory<T>,
    ) -> Result<(), DeviceError>;
    /// Copies these numbers of the output of all worlds, ranges in their order that do not meet; of the others, some
    /// may be set, too, to what they are now.
    fn read_output(
        &mut self,
        rows: &[Range<usize>],
        output: &mut Memory<T>,
    ) -> Result<(), DeviceError>;
    /// Whether it reads instruments.
    fn measures(&self) -> bool {
        false
    }
    /// Reads an instrument in these worlds, in their order and none of them twice, as the last report has them, with
    /// constants of each world if they have their own, and copies its numbers; those of other worlds may be set, too.
    /// Whether it has: it may leave some to the processor, as it does where it reads none.
    fn measure(
        &mut self,
        _instrument: &Arc<Instrument>,
        _own: Option<&Constants<T>>,
        _worlds: &[usize],
        _numbers: &mut Memory<T>,
    ) -> Result<bool, DeviceError> {
        Ok(false)
    }
    /// Where the controls of all worlds lie, `[number][world]`, if other libraries can get at them; once all that was
    /// asked for is done.
    fn input_address(&self) -> Result<Option<Address>, DeviceError> {
        Ok(None)
    }
    /// Copies these numbers of the controls of all worlds, which others have set where they lie; the others of `input`
    /// stay. Asked for only where an address of them was given.
    fn read_input(
        &mut self,
        _rows: &[Range<usize>],
        _input: &mut Memory<T>,
    ) -> Result<(), DeviceError> {
        Ok(())
    }
    /// Where the output of all worlds lies, as the controls.
    fn output_address(&self) -> Result<Option<Address>, DeviceError> {
        Ok(None)
    }
}

/// Constants of an instrument that worlds have for themselves.
#[derive(Clone, Debug)]
pub struct Constants<T> {
    /// Of each world.
    pub numbers: Memory<T>,
    /// Counts up with every change, from 0, where there are none yet.
    pub version: u64,
    /// Of each world, with which version its own changed last.
    pub changed: Vec<u64>,
}

impl<T> Constants<T> {
    /// The worlds of which they have changed since they had this version.
    pub fn since(&self, version: u64) -> Vec<usize> {
        let worlds = 0..self.changed.len();
        worlds.filter(|w| self.changed[*w] > version).collect()
    }
}

/// What a stage has taken on a device, by its clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// Which one.
    pub name: &'static str,
    /// How long it has taken [s].
    pub seconds: f64,
    /// Kernels that were launched.
    pub launches: u64,
}

impl Stage {
    /// Adds it to what stages of its name have taken.
    pub fn add_to(self, stages: &mut Vec<Self>) {
        match stages.iter_mut().find(|stage| stage.name == self.name) {
            Some(known) => {
                known.seconds += self.seconds;
                known.launches += self.launches;
            }
            None => stages.push(self),
        }
    }
}

/// A place in the memory of a CUDA card.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Address {
    /// Which card, as CUDA counts them.
    pub card: usize,
    /// Where, in bytes.
    pub at: u64,
}

/// What a device says went wrong.
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub struct DeviceError(Box<dyn std::error::Error + Send + Sync>);

impl DeviceError {
    /// From what the device says.
    pub fn new(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self(error.into())
    }
}

/// The device's worlds of a simulation, and what the host knows of them or has not told them yet.
pub(crate) struct Remote<T> {
    name: String,
    worlds: Box<dyn DeviceWorlds<T>>,
    /// Numbers of a world's controls there.
    inputs: usize,
    /// Worlds whose state the host has set since it was last told.
    set: Vec<usize>,
    /// Whether the host's state is that of all worlds.
    state_known: bool,
    /// Worlds whose constants the host has set since.
    given: Vec<usize>,
    /// What is known of all that the device has reported.
    output_known: Ranges,
    /// The controls that others may set on the device.
    shared: Vec<Range<usize>>,
}

impl<T: Float> Remote<T> {
    /// Of a simulation whose state and controls are to be told yet.
    pub fn new(
        name: String,
        placed: Box<dyn DeviceWorlds<T>>,
        (worlds, inputs): (usize, usize),
    ) -> Self {
        Self {
            name,
            worlds: placed,
            inputs,
            set: (0..worlds).collect(),
            state_known: true,
            given: Vec::new(),
            output_known: Ranges::default(),
            shared: Vec::new(),
        }
    }
    pub fn name(&self) -> &str {
        &self.name
    }
    /// Where the controls lie, of which others may set these from now on.
    pub fn share_input(&mut self, rows: Range<usize>) -> Result<Option<Address>, DeviceError> {
        let address = self.worlds.input_address()?;
        if address.is_some() && !self.shared.contains(&rows) {
            self.shared.push(rows);
        }
        Ok(address)
    }
    /// Whether others may set controls.
    pub fn shares_input(&self) -> bool {
        !self.shared.is_empty()
    }
    /// Makes known to the host, which has told all it has set, what others have set.
    pub fn read_input(&mut self, input: &mut Memory<T>) -> Result<(), DeviceError> {
        self.worlds.read_input(&self.shared, input)
    }
    /// Where the output lies.
    pub fn output_address(&self) -> Result<Option<Address>, DeviceError> {
        self.worlds.output_address()
    }
    /// The host has set the state of a world.
    pub fn sets_state(&mut self, world: usize) {
        self.set.push(world);
    }
    /// The host has set the constants of a world.
    pub fn sets_parameters(&mut self, world: usize) {
        self.given.push(world);
    }

    /// Tells the device what the host has set.
    pub fn tell(&mut self, host: Host<'_, T>) -> Result<(), DeviceError> {
        if !self.given.is_empty() {
            each_once(&mut self.given);
            self.worlds.write_parameters(&self.given, host.parameters)?;
            self.given.clear();
        }
        for controls in host.changes.take() {
            // The host has room for one at least.
            let numbers = controls.start..controls.end.min(self.inputs);
            if !numbers.is_empty() {
                self.worlds.write_input(numbers, host.input)?;
            }
        }
        each_once(&mut self.set);
        if self.set.len() == host.input.worlds() {
            self.worlds.write_state(host.state)?;
            self.state_known = true;
        } else if !self.set.is_empty() {
            self.worlds.write_worlds(&self.set, host.state)?;
        }
        self.set.clear();
        Ok(())
    }
    /// Whether worlds can have these constants of their own.
    pub fn takes(&self, parameters: &[&[f64]]) -> Result<(), DeviceError> {
        self.worlds.takes(parameters)
    }
    /// How many substeps it has left to the processor.
    pub fn left(&self) -> u64 {
        self.worlds.left()
    }
    /// Begins to measure what stages take.
    pub fn start_clock(&mut self) {
        self.worlds.start_clock();
    }
    /// Ends that.
    pub fn stop_clock(&mut self) -> Vec<Stage> {
        self.worlds.stop_clock()
    }
    /// Performs a task on all worlds, after the host has told all it has set.
    pub fn perform(
        &mut self,
        task: Task,
        processor: &mut Processor<'_, T>,
    ) -> Result<(), DeviceError> {
        debug_assert!(self.set.is_empty());
        match task {
            Task::Step(substeps) => {
                self.state_known = false;
                self.worlds.step(substeps, processor)
            }
            Task::Report(report) => {
                self.output_known.clear();
                self.worlds.report(report)
            }
        }
    }
    /// Makes some numbers of the state of all worlds known to the host, which has told all it has set.
    pub fn read_state(
        &mut self,
        rows: Range<usize>,
        state: &mut Memory<T>,
    ) -> Result<(), DeviceError> {
        debug_assert!(self.set.is_empty());
        if self.state_known {
            return Ok(());
        }
        let all = 0..state.length();
        self.worlds.read_state(std::slice::from_ref(&rows), state)?;
        self.state_known = rows == all;
        Ok(())
    }
    /// Whether it reads instruments.
    pub fn measures(&self) -> bool {
        self.worlds.measures()
    }
    /// Reads an instrument in these worlds as the last report has them.
    pub fn measure(
        &mut self,
        instrument: &Arc<Instrument>,
        own: Option<&Constants<T>>,
        worlds: &[usize],
        numbers: &mut Memory<T>,
    ) -> Result<bool, DeviceError> {
        self.worlds.measure(instrument, own, worlds, numbers)
    }
    /// The same of the output.
    pub fn read_output(
        &mut self,
        numbers: Ranges,
        output: &mut Memory<T>,
    ) -> Result<(), DeviceError> {
        if !self.output_known.covers(&numbers) {
            self.worlds.read_output(numbers.as_slice(), output)?;
            self.output_known.include(numbers);
        }
        Ok(())
    }
}

/// Each of these worlds once, in their order.
pub(crate) fn each_once(worlds: &mut Vec<usize>) {
    worlds.sort_unstable();
    worlds.dedup();
}

/// The numbers of a simulation on the host.
pub(crate) struct Host<'a, T> {
    pub state: &'a Memory<T>,
    pub input: &'a Memory<T>,
    pub changes: &'a mut Changes,
    pub parameters: &'a Memory<T>,
}
