//! What worlds on a card look like from outside.
//!
//! Of each body, joint and contact the kernel of the processor tells (`rigid/src/impulse/report`), from its numbers, which
//! come to lanes before. It is run when something of what it tells is read, and only that comes to the host; sums are taken
//! on the card. Of many things, some are told of at a time, so that there is room. The host waits once for all that is told
//! of bodies and joints, and once for contacts, when it knows how many there are.

mod collected;
mod columns;
mod gathered;
mod part;
mod reading;
mod sums;
mod teller;

use crate::batch::Batch;
use crate::card::Commands;
use crate::scene::Scene;
use crate::{Card, PilesError};
use collected::Collected;
use columns::Columns;
use gathered::{Gathered, Give, Which, places};
use numbers::Memory;
use part::Part;
use reading::{Reading, Words};
use records::ReportPrograms;
use rigid::impulse::report::{SUMS, Thing};
use sim::DeviceError;
use std::iter::once;
use std::ops::Range;
use sums::{Sums, Terms};
use teller::{Kind, Teller};

/// Things that are told of at once, at most, and numbers that their kernel has of one sort for these.
const AT_ONCE: usize = 1 << 16;
const NUMBERS_AT_ONCE: usize = 1 << 22;

/// The WGSL about the kernels that tell: of what they are given, and of sums.
pub(crate) fn texts() -> [String; 2] {
    [gathered::text(), sums::text()]
}

/// Worlds that are told of.
#[derive(Debug)]
pub(crate) struct Told<'a, C: Card> {
    pub card: &'a C,
    pub scene: &'a Scene,
    pub batch: &'a Batch<C>,
}

impl<'a, C: Card> Told<'a, C> {
    /// Where their states are, and how many numbers each has.
    fn states(&self) -> (&'a C::Buffer, usize) {
        (&self.batch.state, self.scene.plan.state_numbers as usize)
    }
}

/// What tells of the worlds of a scene.
#[derive(Debug)]
pub(crate) struct Reports<C: Card> {
    give: Give<C>,
    sums: Sums<C>,
    /// Of bodies, and of joints.
    tellers: Vec<Teller<C>>,
    contacts: Teller<C>,
    /// How many contacts each world remembers, and had no room for.
    counts: Gathered<C>,
    /// What is bound where there are no constants.
    none: C::Buffer,
    collected: Collected<C, Words>,
    /// Of each world, the rows of contacts that the host has been told of.
    known: Vec<usize>,
    pub clock: Option<C::Clock>,
}

impl<C: Card> Reports<C> {
    /// Of all these worlds, so many of them at a time.
    pub fn new(
        card: &C,
        scene: &Scene,
        worlds: usize,
        together: usize,
    ) -> Result<Self, DeviceError> {
        let impulse = &scene.impulse;
        let programs = ReportPrograms::record().map_err(PilesError::from)?;
        let teller = |program, kind, own| Teller::new(card, scene, program, (kind, own), together);
        let kinds: [(_, Kind, _); 3] = [
            (&programs.body, Thing::Body, impulse.model_bodies()),
            (&programs.free, Thing::Free, impulse.free_joints()),
            (&programs.tie, Thing::Tie, impulse.ties()),
        ];
        let kinds = kinds.into_iter().filter(|(_, _, own)| *own > 0);
        let tellers = kinds.map(|(program, kind, own)| teller(program, kind, own));
        let [count, forgotten, _] = impulse.memory_places();
        let numbers = [count..count + 1, forgotten..forgotten + 1, 0..0, 0..0];
        Ok(Self {
            give: Give::new(card)?,
            sums: Sums::new(card)?,
            tellers: tellers.collect::<Result<_, _>>()?,
            contacts: teller(&programs.contact, Thing::Contact, impulse.capacity())?,
            counts: Gathered::new(card, &[numbers], 0, together)?,
            none: card.buffer(1)?,
            collected: Collected::new(card)?,
            known: vec![impulse.outputs().contacts; worlds],
            clock: None,
        })
    }
    /// Constants of these worlds of a batch have changed.
    pub fn differ(
        &mut self,
        card: &C,
        scene: &Scene,
        batch: &Batch<C>,
        worlds: &[usize],
    ) -> Result<(), DeviceError> {
        let mut tellers = self.tellers.iter_mut();
        tellers.try_for_each(|teller| teller.differ(card, scene, &batch.worlds, worlds))
    }

    /// Reads these ranges of the output of the worlds of a batch.
    pub fn read(
        &mut self,
        of: &Told<'_, C>,
        asked: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        let (impulse, worlds) = (&*of.scene.impulse, &of.batch.worlds);
        // What was left by a reading that failed belongs to none.
        self.collected.clear();
        let is_asked = |numbers: Range<usize>| {
            let first = |range: &Range<usize>| range.start.max(numbers.start);
            let mut ranges = asked.iter();
            ranges.any(|range| first(range) < range.end.min(numbers.end))
        };
        let capped = impulse.told_capped();
        let [sums, contacts] = [impulse.told_sums(), impulse.told_contacts()].map(is_asked);
        let counts = contacts || is_asked(capped..capped + 1);
        let tellers = self.tellers.iter();
        let columns = tellers.map(|teller| {
            let told = (teller.kind)(0).lengths().told;
            Columns::of(&teller.places, asked, told)
        });
        let mut reading = Reading {
            impulse,
            first: worlds.start,
            columns: columns.collect(),
            sums: vec![[0.0; SUMS]; worlds.len()],
            counts: vec![[0.0; 2]; worlds.len()],
            rows: vec![0; worlds.len()],
            output,
        };
        let of_sums = if sums { SUMS + 2 } else { 0 };
        let of_things = self.tellers.iter().zip(&reading.columns);
        let of_things = of_things.map(|(teller, columns)| columns.width() * teller.own);
        let of_world = of_sums + of_things.sum::<usize>() + 2;
        self.collected.reserve(of.card, of_world * worlds.len())?;
        for nth in 0..self.tellers.len() {
            self.tell_of_things(of, nth, sums, &mut reading)?;
        }
        if counts {
            self.tell_counts(of, &mut reading)?;
        }
        self.fetch(of, &mut reading)?;
        if sums {
            reading.put_sums();
        }
        if counts {
            reading.put_capped();
        }
        if contacts {
            self.tell_of_contacts(of, &mut reading)?;
        }
        Ok(())
    }

    /// Waits for what was collected.
    fn fetch(&mut self, of: &Told<'_, C>, reading: &mut Reading<'_>) -> Result<(), DeviceError> {
        if self.collected.is_empty() {
            return Ok(());
        }
        let todo = of.card.commands(self.clock.as_mut());
        let taken = |words, read: &[f32]| reading.take(words, read);
        self.collected.fetch(of.card, todo, taken)
    }
    /// The same, where there is no room for so many words more.
    fn make_room(
        &mut self,
        of: &Told<'_, C>,
        words: usize,
        reading: &mut Reading<'_>,
    ) -> Result<(), DeviceError> {
        if !self.collected.fits(of.card, words)? {
            self.fetch(of, reading)?;
            self.collected.fits(of.card, words)?;
        }
        Ok(())
    }

    /// Tells of things of one kind, and takes their sums if these are asked for.
    fn tell_of_things(
        &mut self,
        of: &Told<'_, C>,
        nth: usize,
        sums: bool,
        reading: &mut Reading<'_>,
    ) -> Result<(), DeviceError> {
        let Told { card, scene, batch } = *of;
        let teller = &mut self.tellers[nth];
        let [first_told, numbers] = teller.summed;
        let sums = sums && numbers > 0;
        let width = reading.columns[nth].width();
        if width == 0 && !sums {
            return Ok(());
        }
        let key = teller.ready(card, scene, batch.worlds.clone())?;
        let (own, room) = (teller.own, teller.room);
        let sets = if scene.parameters.differ() { own } else { 0 };
        for part in Part::all(batch.worlds.len(), own, room) {
            let count = part.count();
            let summed = if sums { numbers * part.worlds.len() } else { 0 };
            self.make_room(of, width * count + summed, reading)?;
            let which = Which {
                first: part.worlds.start * own + part.things.start,
                count,
                own,
                sets,
            };
            let teller = &mut self.tellers[nth];
            let mut todo = card.commands(self.clock.as_mut());
            teller.tell(card, &self.give, &mut todo, (of.states(), key), which)?;
            let told = &teller.told;
            let terms = Terms {
                at: first_told * count,
                own: part.things.len(),
                worlds: part.worlds.len(),
                numbers,
            };
            let taken = sums.then(|| self.sums.take(card, &mut todo, told, terms));
            let taken = taken.transpose()?;
            todo.mark("telling");
            if let Some(taken) = taken {
                let what = Words::Sums(part.worlds.clone());
                let words = once(0..summed);
                self.collected.add(&mut todo, taken, words, what);
            }
            let words = reading.columns[nth].words(count);
            let what = Words::Things(nth, part);
            self.collected.add(&mut todo, told, words, what);
            card.submit(todo)?;
        }
        Ok(())
    }

    fn tell_counts(
        &mut self,
        of: &Told<'_, C>,
        reading: &mut Reading<'_>,
    ) -> Result<(), DeviceError> {
        let (card, count) = (of.card, of.batch.worlds.len());
        self.make_room(of, 2 * count, reading)?;
        let which = Which {
            first: 0,
            count,
            own: 1,
            sets: 0,
        };
        let mut todo = card.commands(self.clock.as_mut());
        let (counts, none) = (&mut self.counts, &self.none);
        counts.gather(card, &self.give, &mut todo, (of.states(), none), which)?;
        todo.mark("telling of contacts");
        let words = once(0..2 * count);
        self.collected
            .add(&mut todo, &counts.given, words, Words::Counts);
        card.submit(todo)
    }

    /// Tells of all contacts, of which it is known how many there are.
    fn tell_of_contacts(
        &mut self,
        of: &Told<'_, C>,
        reading: &mut Reading<'_>,
    ) -> Result<(), DeviceError> {
        let (card, (states, state_numbers)) = (of.card, of.states());
        let told = Thing::Contact(0).lengths().told;
        let all = reading.all_contacts();
        self.collected.reserve(card, told * all.len())?;
        for some in all.chunks(self.contacts.room) {
            let count = some.len();
            self.make_room(of, told * count, reading)?;
            let ranges = some.iter().map(|(world, nth)| {
                let ranges = reading.impulse.given_of_state(Thing::Contact(*nth));
                let start = world * state_numbers;
                ranges.map(|range| start + range.start..start + range.end)
            });
            let named = places(&Vec::from_iter(ranges));
            let teller = &mut self.contacts;
            card.write(&teller.gathered.places, 0, bytemuck::cast_slice(&named))?;
            let which = Which {
                first: 0,
                count,
                own: count,
                sets: 0,
            };
            let mut todo = card.commands(self.clock.as_mut());
            teller.tell(card, &self.give, &mut todo, ((states, 0), None), which)?;
            todo.mark("telling of contacts");
            let (words, what) = (once(0..told * count), Words::Contacts(some.to_vec()));
            self.collected.add(&mut todo, &teller.told, words, what);
            card.submit(todo)?;
        }
        self.fetch(of, reading)?;
        for (nth, count) in reading.rows.iter().enumerate() {
            let world = reading.first + nth;
            let known = std::mem::replace(&mut self.known[world], *count);
            for row in *count..known {
                let (at, far) = reading.impulse.told_apart(row);
                reading.output.set(world, at, far as f32);
            }
        }
        Ok(())
    }
}
