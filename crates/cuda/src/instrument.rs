//! What reads an instrument in worlds on a card.

use crate::compiler::BLOCK;
use crate::kernel::Kernel;
use crate::worlds::MOST;
use crate::{Cuda, CudaError};
use cudarc::driver::CudaSlice;
use numbers::trace::PrintOptions;
use rigid::{Instrument, Lanes};
use std::iter::once;

/// An instrument in a card's memory.
#[derive(Debug)]
pub(crate) struct Reading {
    pub all: Way,
    /// The same of the worlds that are listed, once that was wanted.
    pub few: Option<Way>,
    pub lanes: Lanes,
    pub scratch: CudaSlice<f32>,
    /// One set of constants for all worlds, or one for each.
    pub parameters: CudaSlice<f32>,
    /// Which of their own constants worlds have, if they have any.
    pub version: Option<u64>,
    /// What was read.
    pub numbers: CudaSlice<f32>,
}

/// What reads worlds.
#[derive(Debug)]
pub(crate) struct Way {
    pub kernel: Kernel,
    /// Behind them, of those that are listed, stands the list.
    pub links: CudaSlice<u32>,
}

impl Reading {
    /// Of so many worlds, which may have constants of their own; none where numbers are more than kernels can count.
    ///
    /// # Errors
    /// The card's memory is full; it has failed before.
    pub fn new(
        card: &Cuda,
        instrument: &Instrument,
        worlds: usize,
        own: bool,
    ) -> Result<Option<Self>, CudaError> {
        let sheet = instrument.sheet();
        let lanes = sheet.lengths.lanes(worlds, BLOCK as usize, MOST);
        let constants = sheet.parameters.len();
        let longest = sheet.lengths.output.max(if own { constants } else { 0 });
        let Some(lanes) = lanes.filter(|_| longest.saturating_mul(worlds) <= MOST) else {
            return Ok(None);
        };
        let options = options(lanes, own);
        let parameters = if own {
            card.memory(constants * worlds)?
        } else {
            let numbers: Vec<_> = sheet.parameters.iter().map(|x| *x as f32).collect();
            card.filled(&numbers)?
        };
        Ok(Some(Self {
            all: Way {
                kernel: Kernel::new(card, &records::instrument(instrument)?, &options)?,
                links: card.filled(&sheet.links)?,
            },
            few: None,
            scratch: card.memory(lanes.scratch)?,
            parameters,
            version: own.then_some(0),
            numbers: card.memory(sheet.lengths.output * worlds)?,
            lanes,
        }))
    }

    /// Lists the worlds, of so many in all, that are to be read.
    ///
    /// # Errors
    /// The card's memory is full; it has failed before.
    pub fn list(
        &mut self,
        card: &Cuda,
        instrument: &Instrument,
        worlds: usize,
        list: &[usize],
    ) -> Result<(), CudaError> {
        let links = &instrument.sheet().links;
        let few = match &mut self.few {
            Some(few) => few,
            none => {
                let options = PrintOptions {
                    listed: Some(links.len() as u32),
                    ..options(self.lanes, self.version.is_some())
                };
                none.insert(Way {
                    kernel: Kernel::new(card, &records::instrument(instrument)?, &options)?,
                    links: card.filled(&[links, &vec![0; 1 + worlds][..]].concat())?,
                })
            }
        };
        let list = list.iter().map(|world| *world as u32);
        let words = Vec::from_iter(once(list.len() as u32).chain(list));
        let mut place = few.links.slice_mut(links.len()..links.len() + words.len());
        card.told(card.stream().memcpy_htod(&words, &mut place))
    }
}

/// How an instrument is printed for worlds that have constants of their own, or not.
fn options(lanes: Lanes, own: bool) -> PrintOptions {
    PrintOptions {
        workgroup_size: BLOCK,
        parameters_per_world: own,
        pieces: lanes.pieces,
        ..PrintOptions::default()
    }
}
