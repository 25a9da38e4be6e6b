//! What is read of many worlds at once beside their solver, by a kernel of its own: in lanes, or on the device that holds
//! them.

use crate::device::{Constants, Remote, each_once};
use crate::engine::Block;
use crate::jobs::Lane;
use crate::scratch::Scratch;
use crate::{Simulation, SimulationError};
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::{Instrument, Report};
use std::collections::HashSet;
use std::sync::Arc;

/// An instrument, and what it has read.
pub(crate) struct Reader<T: Float> {
    instrument: Arc<Instrument>,
    /// Its constants.
    common: Vec<T>,
    /// Those of each world, once they have differed.
    pub own: Option<Constants<T>>,
    scratch: Scratch<T>,
    /// What was read last.
    numbers: Memory<T>,
}

impl<T: Float> Clone for Reader<T> {
    /// With an instrument of its own: a device knows by that whose constants it has.
    fn clone(&self) -> Self {
        Self {
            instrument: Arc::new(Instrument::clone(&self.instrument)),
            common: self.common.clone(),
            own: self.own.clone(),
            scratch: self.scratch.clone(),
            numbers: self.numbers.clone(),
        }
    }
}

impl<T: Float> Reader<T> {
    /// For so many worlds, in blocks of so many.
    pub fn new(instrument: Instrument, worlds: usize, width: usize) -> Self {
        let sheet = instrument.sheet();
        let mut common = Vec::from_iter(sheet.parameters.iter().map(|x| T::from_f64(*x)));
        // Where there are none, one that nobody reads: so they are in common, and need not lie as lanes do.
        common.resize(common.len().max(1), T::zero());
        Self {
            common,
            own: None,
            scratch: Scratch::new(sheet.lengths.scratch, width),
            numbers: Memory::new(worlds, sheet.lengths.output, width),
            instrument: Arc::new(instrument),
        }
    }
    pub fn instrument(&self) -> &Instrument {
        &self.instrument
    }
    /// Numbers of a world.
    pub fn length(&self) -> usize {
        self.numbers.length()
    }
    /// Worlds of a block.
    pub fn width(&self) -> usize {
        self.numbers.width()
    }
    /// Copies numbers that were read of a world, from one of them on.
    pub fn copy(&self, world: usize, from: usize, numbers: &mut [T]) {
        self.numbers.copy(world, from, numbers);
    }
}

impl<T: Float> Simulation<T> {
    /// Whether worlds are on a device that reads instruments.
    pub(crate) fn measures_there(&self) -> bool {
        self.remote.as_ref().is_some_and(Remote::measures)
    }

    /// Reads an instrument in some worlds where they are, of which so much has to be reported. Whether a device has read it;
    /// `false` where there is none.
    pub(crate) fn measure_there(
        &mut self,
        reader: &mut Reader<T>,
        needs: Report,
        worlds: &[usize],
    ) -> Result<bool, SimulationError> {
        if !self.measures_there() {
            return Ok(false);
        }
        self.report(needs)?;
        let own = reader.own.as_ref().filter(|_| self.has_own_models());
        let (remote, instrument) = (self.remote.as_mut(), &reader.instrument);
        let mut worlds = worlds.to_vec();
        each_once(&mut worlds);
        let read = remote.map(|it| it.measure(instrument, own, &worlds, &mut reader.numbers));
        Ok(read.transpose()?.unwrap_or(false))
    }

    /// Reads an instrument here, from what is known of the blocks that hold these worlds.
    pub(crate) fn measure_here(&mut self, reader: &mut Reader<T>, worlds: &[usize]) {
        let (width, size) = (self.output.width(), reader.numbers.block_size());
        let wanted: HashSet<usize> = worlds.iter().map(|world| world / width).collect();
        let lane = Lane {
            isa: self.isa,
            single: width == 1,
        };
        let (output, told) = (&self.output, self.input.block_size());
        let engine = &self.shared.engine;
        let Reader {
            instrument,
            common,
            own,
            scratch,
            numbers: read,
        } = reader;
        let own = own.as_ref().filter(|_| self.has_own_models());
        let measure = |number: usize, input: &mut [T], read: &mut [T]| {
            scratch.lend(|scratch| {
                let mut block = Block {
                    number,
                    state: input,
                    input: output.block(number),
                    output: read,
                    scratch: scratch.scalars_mut(),
                    parameters: own.map_or(&[], |own| own.numbers.block(number)),
                    common: if own.is_some() { &[] } else { common },
                    links: &instrument.sheet().links,
                };
                engine.measure(lane, instrument, &mut block);
            });
        };
        let controls = self.input.scalars_mut().par_chunks_exact_mut(told);
        let blocks = read.scalars_mut().par_chunks_exact_mut(size).zip(controls);
        let blocks = blocks.enumerate().filter(|(i, _)| wanted.contains(i));
        let measure = |(number, (read, input))| measure(number, input, read);
        self.threads.run(|| blocks.for_each(measure));
    }
}
