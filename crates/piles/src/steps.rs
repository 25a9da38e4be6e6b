//! Steps of batches of worlds, of which several are submitted before anything is read.

use crate::Card;
use crate::batch::Batch;
use crate::card::{Commands, NUMBER};
use crate::kernels::Kernels;
use crate::pace::{self, MOST_ROUNDS, STEPS, Told, Turn, UNCOLOURED};
use crate::plan::{BLOCK, Plan, flag, of_world, status, stopped};
use crate::room::{Own, Room};
use crate::scene::Scene;
use rigid::impulse::ContactTables;
use rigid::impulse::blow::ROUNDS as BLOWS;
use sim::DeviceError;
use std::iter::once;

/// What steps have room for.
#[derive(Debug)]
pub(crate) struct Steps<C: Card> {
    pub plan: Plan,
    pub room: Room<C>,
    /// Into how many parts steps are cut that the room is ready for.
    cut: usize,
    /// The states of a batch before a step that is cut into parts.
    before: Option<C::Buffer>,
    /// What kernels bind of the batch of this first world, the one that was stepped last.
    own: Option<(usize, Own<C>)>,
    staging: C::Staging,
    /// While stages are timed.
    pub clock: Option<C::Clock>,
}

/// Pairs of each shape and contacts of each body that there is room for at first.
pub(crate) const PAIRS: u32 = 8;
pub(crate) const CONTACTS: u32 = 4;

impl<C: Card> Steps<C> {
    pub fn new(card: &C, scene: &Scene, kernels: &Kernels<C>) -> Result<Self, DeviceError> {
        let mut plan = scene.plan;
        let near = scene.groups.iter().flat_map(|group| group.triangles);
        plan.most_near = near.max().unwrap_or(0) as u32;
        if plan.most_near > 0 {
            plan.mesh_pairs = BLOCK.min(scene.most_pairs(card, true));
        }
        let mut pairs = PAIRS * plan.shapes + BLOCK;
        let mut contacts = CONTACTS * plan.bodies + BLOCK;
        let room = loop {
            plan.pairs = pairs.min(scene.most_pairs(card, false));
            plan.contacts = contacts.min(most_contacts(card));
            match Room::new(card, scene, kernels, &mut plan) {
                Ok(room) => break room,
                // Fewer worlds at a time may do with less.
                Err(_) if pairs.max(contacts) > BLOCK => {
                    (pairs, contacts) = (pairs / 2, contacts / 2)
                }
                Err(error) => return Err(error),
            }
        };
        Ok(Self {
            room,
            plan,
            cut: 0,
            before: None,
            own: None,
            staging: C::Staging::default(),
            clock: None,
        })
    }

    /// After a scene has other constants.
    pub fn renew(&mut self, card: &C, scene: &Scene) -> Result<(), DeviceError> {
        self.plan = self.plan.with_constants_of(&scene.plan);
        self.room.renew(card, scene, &self.plan)
    }

    /// Takes some of the steps that worlds of a batch have yet to take. Returns those, counted from its first, of which the
    /// next step is the processor's.
    pub fn take(
        &mut self,
        card: &C,
        scene: &Scene,
        kernels: &Kernels<C>,
        batch: &mut Batch<C>,
    ) -> Result<Vec<usize>, DeviceError> {
        let mut turn = pace::turn(scene, batch);
        while turn.parts > 1 && !self.keeps(card, scene, &turn) {
            if !batch.pace.fewer(&turn) {
                return Ok(turn.worlds);
            }
            turn = pace::turn(scene, batch);
        }
        let told = self.submit(card, scene, kernels, batch, &turn)?;
        let flags = told.of(status::FLAG);
        let mut taken = 0;
        let mut left_to_processor = Vec::new();
        let mut stops = 0;
        for &world in &turn.worlds {
            let asked = batch.left[world].min(turn.steps);
            let steps = asked - told.of_world(world, of_world::LEFT) as usize;
            batch.left[world] -= steps;
            taken = steps.max(taken);
            let why = told.of_world(world, of_world::STOPPED);
            stops |= why & !stopped::DONE;
            if why & stopped::OTHER_PARTS != 0 {
                batch.parts[world] = told.of_world(world, of_world::NEEDED) as usize;
            }
            if why & stopped::PROCESSOR != 0 {
                left_to_processor.push(world);
            }
        }
        let pace = &mut batch.pace;
        if turn.parts == 1 {
            pace.steps = match flags == 0 && left_to_processor.is_empty() {
                true => STEPS.min(2 * pace.steps),
                false => taken.max(1),
            };
        }
        pace.uncoloured.clear();
        if flags & UNCOLOURED != 0 && turn.parts == 1 && stops == 0 {
            let left = turn.worlds.iter().filter(|world| batch.left[**world] > 0);
            pace.uncoloured.extend(left);
        }
        if flags == 0 && stops == 0 && taken == 0 {
            return Err(card.failed("it took no step and gave no reason"));
        }
        if flags != 0 {
            // What a step without enough of anything has told besides is of no worth; but that is told before colours.
            if flags & !UNCOLOURED != 0 {
                left_to_processor.clear();
            }
            if !self.adapt(card, scene, kernels, batch, (&turn, stops), &told) {
                let behind = turn.worlds.into_iter();
                return Ok(behind.filter(|world| batch.left[*world] > 0).collect());
            }
            return Ok(left_to_processor);
        }
        if taken > 0 {
            batch.pace.learn(&told, taken);
        }
        Ok(left_to_processor)
    }

    /// Has room for the states of a turn whose steps are cut into parts; false where the card has none.
    fn keeps(&mut self, card: &C, scene: &Scene, turn: &Turn) -> bool {
        let numbers = (turn.worlds.len() * scene.impulse.lengths().state) as u64;
        let fits = |before: &C::Buffer| C::room(before) >= numbers;
        if !self.before.as_ref().is_some_and(fits) {
            self.before = card.buffer(numbers).ok();
        }
        self.before.is_some()
    }

    /// Makes room for what a step has found too little for, has more of it launched, or has fewer worlds stepped at once;
    /// false where only the processor can take the step.
    fn adapt(
        &mut self,
        card: &C,
        scene: &Scene,
        kernels: &Kernels<C>,
        batch: &mut Batch<C>,
        (turn, stops): (&Turn, u32),
        told: &Told,
    ) -> bool {
        let flags = told.of(status::FLAG);
        let pace = &mut batch.pace;
        pace.colours.at_least(told.of(status::COLOURED) as usize);
        if flags & flag::MORE_ROOM != 0 {
            // There, colours of the attempt are not known.
            pace.uncoloured.clear();
            return self.grow(card, scene, kernels, told) || pace.fewer(turn);
        }
        if flags & flag::MORE_ROUNDS != 0 {
            // Where it cannot go on from where it ended, more rounds than there are would not settle it.
            let goes_on = !pace.uncoloured.is_empty() || stops != 0;
            if pace.rounds == MOST_ROUNDS && !goes_on {
                return pace.fewer(turn);
            }
            pace.rounds = MOST_ROUNDS.min(2 * pace.rounds);
        }
        if flags & flag::MORE_BLOWS != 0 {
            let more = (2 * pace.blows.count).max(2);
            pace.blows.at_least(BLOWS.min(more));
        }
        true
    }

    /// What is told after the steps of a turn.
    fn submit(
        &mut self,
        card: &C,
        scene: &Scene,
        kernels: &Kernels<C>,
        batch: &mut Batch<C>,
        turn: &Turn,
    ) -> Result<Told, DeviceError> {
        let parts = turn.parts;
        if batch.ready(card, scene, parts)? {
            self.own = None;
        }
        if self.cut != parts {
            self.room.cut(card, scene, parts)?;
            self.cut = parts;
        }
        let first = batch.worlds.start;
        let known = self.own.take().filter(|(of, _)| *of == first);
        let (_, own) = known.unwrap_or_else(|| (first, self.room.of(card, kernels, batch)));
        let status = &self.room.buffers.status;
        let begin = pace::begin(&self.plan, batch, turn);
        card.write(status, 0, bytemuck::cast_slice(&begin))?;
        let mut clock = self.clock.take();
        let mut todo = card.commands(clock.as_mut());
        // Of a world that is the nth of the turn, where its state belongs; it is kept at that of the nth of all.
        if let (true, Some(before)) = (parts > 1, &self.before) {
            for (nth, world) in turn.worlds.iter().enumerate() {
                let kept = batch.numbers(scene, nth).start;
                todo.copy(&batch.state, batch.numbers(scene, *world), before, kept);
            }
        }
        let mut asked = Ok(());
        for step in 0..turn.steps {
            if step > 0 {
                // The card takes that one while this one is written down.
                asked = asked.and(card.submit(todo));
                todo = card.commands(clock.as_mut());
            }
            for part in 0..parts {
                self.encode(&mut todo, kernels, scene, &own, batch, (parts, part));
            }
        }
        self.own = Some((first, own));
        let mut told = Told(Vec::new());
        let words = once(0..begin.len());
        let fetched = card.fetch(todo, &mut self.staging, status, words, |words| {
            told.0 = words.iter().map(|word| word.to_bits()).collect();
        });
        self.clock = clock;
        asked.and(fetched)?;
        if let (true, Some(before)) = (parts > 1, &self.before) {
            let mut todo = card.commands(None);
            for (nth, world) in turn.worlds.iter().enumerate() {
                if told.of_world(*world, of_world::LEFT) > 0 {
                    let own = batch.numbers(scene, *world).start;
                    todo.copy(before, batch.numbers(scene, nth), &batch.state, own);
                }
            }
            card.submit(todo)?;
        }
        Ok(told)
    }

    /// Makes room for what a step has found too little for, and some more, or none more; false where the card has not
    /// even that.
    fn grow(&mut self, card: &C, scene: &Scene, kernels: &Kernels<C>, told: &Told) -> bool {
        let flags = told.of(status::FLAG);
        let rooms = [1, 0].map(|more| {
            let enough = |n: u32| n + more * (n / 4);
            let mut plan = self.plan;
            if flags & flag::MORE_PAIRS != 0 {
                plan.pairs = enough(told.of(status::PAIRS));
            } else if flags & flag::MORE_MESH_PAIRS != 0 {
                plan.mesh_pairs = enough(told.of(status::MESH_PAIRS));
            } else {
                plan.contacts = enough(told.of(status::CONTACTS) + told.of(status::ENDED));
            }
            plan
        });
        for mut plan in rooms {
            if let Ok(room) = Room::new(card, scene, kernels, &mut plan) {
                (self.plan, self.room, self.cut) = (plan, room, 0);
                self.own = None;
                return true;
            }
        }
        false
    }
}

/// Contacts whose numbers fit into a buffer of a card.
fn most_contacts(card: &impl Card) -> u32 {
    let bytes = ContactTables::new().length as u64 * NUMBER;
    u32::try_from(card.most_bytes() / bytes).unwrap_or(u32::MAX)
}
