//! What tells of things of one kind.

use crate::card::{BINDINGS, Commands, NUMBER, WORKGROUP, filled, sized};
use crate::constants::are_few;
use crate::report::columns::Place;
use crate::report::gathered::{Gathered, Give, Which};
use crate::report::{AT_ONCE, NUMBERS_AT_ONCE};
use crate::scene::Scene;
use crate::uniform::Uniform;
use crate::{Card, Need, PilesError};
use numbers::trace::{Members, Program};
use rigid::impulse::report::{BodyReport, RANGES, SUMS, Thing, TieReport};
use sim::DeviceError;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Things of one kind, counted.
pub type Kind = fn(usize) -> Thing;

/// Their kernel, and where it works.
#[derive(Debug)]
pub struct Teller<C: Card> {
    pub kind: Kind,
    /// How many each world has, at most.
    pub own: usize,
    pub gathered: Gathered<C>,
    kernel: C::Kernel,
    bindings: C::Bindings,
    launch: Uniform<C, 2>,
    pub told: C::Buffer,
    /// Things that there is room for at once.
    pub room: usize,
    /// Where in the output each number belongs, in this order.
    pub places: Arc<[Place]>,
    /// What is told of it that comes to the first sums: the first number, and how many.
    pub summed: [usize; 2],
    /// Constants, by the first world of the batch where worlds have their own, else by 0; none where they have changed.
    pub constants: BTreeMap<usize, C::Buffer>,
    none: C::Buffer,
}

impl<C: Card> Teller<C> {
    /// Of so many worlds at a time, of which each has so many.
    pub fn new(
        card: &C,
        scene: &Scene,
        program: &Program,
        (kind, own): (Kind, usize),
        worlds: usize,
    ) -> Result<Self, DeviceError> {
        let (impulse, lengths) = (&scene.impulse, kind(0).lengths());
        // Their sums are collected with them.
        let widest = [lengths.given, lengths.state, lengths.told + SUMS];
        let widest = widest.into_iter().max().unwrap_or(1);
        let most = card.most_bytes() / NUMBER / widest as u64;
        let all = (own * worlds).max(1);
        let at_once = AT_ONCE.min(NUMBERS_AT_ONCE / widest).min(most as usize);
        let room = all.min(at_once).max(1);
        let mut width = 0;
        impulse.given_constants(kind(0), impulse.parameters(), |_| width += 1);
        // Which contacts there are is known when they are told of.
        let is_contact = matches!(kind(0), Thing::Contact(_));
        let named = if is_contact { 1 } else { own };
        let things = (0..named).map(|thing| impulse.given_of_state(kind(thing)));
        let things = Vec::from_iter(things);
        let mut gathered = Gathered::new(card, &things, width, room)?;
        if is_contact {
            gathered.places = sized(card, (RANGES * (1 + room)) as u64)?;
        }
        let links = if is_contact {
            impulse.told_colliders()
        } else {
            Vec::new()
        };
        let work = sized(card, (lengths.state * room).max(1) as u64)?;
        let told = sized(card, (lengths.told * room) as u64)?;
        let launch = Uniform::new(card)?;
        let (none, nothing) = (card.buffer(1)?, card.buffer(1)?);
        let links = filled(card, &links)?;
        let bindings: [&C::Buffer; BINDINGS] = [
            &work,
            &gathered.given,
            &told,
            &none,
            &nothing,
            &links,
            &launch.buffer,
        ];
        let bindings = card.bind_kernel(bindings);
        let mut places = Vec::new();
        for thing in 0..named {
            let place = |number, at| places.push(Place { at, thing, number });
            impulse.told_places(kind(thing), place);
        }
        places.sort_unstable_by_key(|place| place.at);
        Ok(Self {
            kind,
            own,
            kernel: card.kernel(program, false, Members::Worlds)?,
            bindings,
            launch,
            gathered,
            told,
            room,
            places: places.into(),
            summed: match kind(0) {
                Thing::Body(_) => [BodyReport::new().sums.start(), SUMS],
                Thing::Tie(_) => [TieReport::new().energy.start(), 2],
                _ => [0; 2],
            },
            constants: BTreeMap::new(),
            none: card.buffer(1)?,
        })
    }

    /// Writes the constants of the things of a batch where they are not there; by what they are found.
    pub fn ready(
        &mut self,
        card: &C,
        scene: &Scene,
        worlds: Range<usize>,
    ) -> Result<Option<usize>, DeviceError> {
        if self.gathered.width == 0 {
            return Ok(None);
        }
        let differ = scene.parameters.differ();
        let key = if differ { worlds.start } else { 0 };
        if self.constants.contains_key(&key) {
            return Ok(Some(key));
        }
        let sets = if differ { worlds } else { 0..1 };
        let numbers = self.constants_of(scene, sets);
        let bytes: &[u8] = bytemuck::cast_slice(&numbers);
        let fits = Need::Parameters.check(bytes.len() as u64, card.most_bytes(), card.name());
        fits.map_err(PilesError::from)?;
        let buffer = card.buffer(numbers.len() as u64)?;
        card.write(&buffer, 0, bytes)?;
        self.constants.insert(key, buffer);
        Ok(Some(key))
    }

    /// Writes the constants of these worlds of a batch; those of all its worlds when they are read next, if these are many.
    pub fn differ(
        &mut self,
        card: &C,
        scene: &Scene,
        batch: &Range<usize>,
        worlds: &[usize],
    ) -> Result<(), DeviceError> {
        if !are_few(worlds.len(), batch.len()) {
            self.constants.remove(&batch.start);
        }
        let Some(buffer) = self.constants.get(&batch.start) else {
            return Ok(());
        };
        for &world in worlds {
            let numbers = self.constants_of(scene, world..world + 1);
            let at = (world - batch.start) * numbers.len();
            card.write(buffer, at as u64, bytemuck::cast_slice(&numbers))?;
        }
        Ok(())
    }
    /// Constants of all things of worlds, one after the other.
    fn constants_of(&self, scene: &Scene, worlds: Range<usize>) -> Vec<f32> {
        let mut numbers = Vec::new();
        for world in worlds {
            let parameters = scene.parameters.of(world);
            for thing in (0..self.own).map(self.kind) {
                let give = |x| numbers.push(x as f32);
                scene.impulse.given_constants(thing, parameters, give);
            }
        }
        numbers
    }

    /// Tells of some of them, from states of so many numbers, and these constants.
    pub fn tell(
        &mut self,
        card: &C,
        give: &Give<C>,
        todo: &mut C::Commands<'_>,
        (states, constants): ((&C::Buffer, usize), Option<usize>),
        which: Which,
    ) -> Result<(), DeviceError> {
        self.launch.set(card, [which.count, 1])?;
        let constants = constants.and_then(|key| self.constants.get(&key));
        let from = (states, constants.unwrap_or(&self.none));
        self.gathered.gather(card, give, todo, from, which)?;
        let groups = (which.count as u32).div_ceil(WORKGROUP);
        todo.run(&self.kernel, &self.bindings, groups);
        Ok(())
    }
}
