//! One step of one world, stage by stage.

use super::ahead::ATTEMPTS;
use super::batches::Lanes;
use super::broad_phase::Candidate;
use super::colours::Colours;
use super::jobs::{Bodies, BodyRows, BodyStage, Shapes};
use super::joints::JointLanes;
use super::narrow_phase::Scene;
use super::sleep::Sleep;
use super::solve::Solver;
use super::{Kept, Piles};
use crate::jobs::Lane;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{Placed, placed};
use rigid::impulse::{
    Cached, FARTHEST, FREE_TURN, HELD_TURN, Impulse, REMEMBERED, SLEEP_AFTER, State, WORLD, global,
    row, state,
};

/// What a step needs besides the world's state; nothing in it outlives a step but its memory.
pub(super) struct Workspace<T: Float> {
    pub rows: BodyRows<T>,
    pub sleep: Sleep<T>,
    wrenches: Vec<[T; 6]>,
    /// Bodies that are awake, filled up to whole registers.
    pub awake: Vec<u32>,
    pub placed: Vec<Placed<T>>,
    /// How much farther [m] than foreseen shapes got in the attempts before at this step; none in the first.
    pub ahead: Vec<T>,
    /// Of the world that is stepped.
    pub kept: Kept,
    candidates: Vec<Candidate>,
    pairs: Vec<Candidate>,
    pub found: Vec<Cached<T>>,
    /// Contacts of sensors, which are told but not solved.
    sensed: Vec<Cached<T>>,
    pub contacts: Vec<Cached<T>>,
    pub colours: Colours,
    /// Bodies and number of points of each contact.
    pub ends: Vec<([u32; 2], usize)>,
    pub lanes: Lanes<T>,
    /// Joints of bodies that are awake: their bodies, and which they are.
    pub joint_ends: Vec<([u32; 2], usize)>,
    pub joints: Vec<u32>,
    pub joint_colours: Colours,
    pub joint_lanes: JointLanes<T>,
}

impl<T: Float> Default for Workspace<T> {
    fn default() -> Self {
        Self {
            rows: BodyRows::default(),
            sleep: Sleep::default(),
            wrenches: Vec::new(),
            awake: Vec::new(),
            placed: Vec::new(),
            ahead: Vec::new(),
            kept: Kept::default(),
            candidates: Vec::new(),
            pairs: Vec::new(),
            found: Vec::new(),
            sensed: Vec::new(),
            contacts: Vec::new(),
            colours: Colours::default(),
            ends: Vec::new(),
            lanes: Lanes::default(),
            joint_ends: Vec::new(),
            joints: Vec::new(),
            joint_colours: Colours::default(),
            joint_lanes: JointLanes::default(),
        }
    }
}

/// A world, but for its state.
#[derive(Clone, Copy)]
pub(super) struct World<'a, T: Float> {
    pub piles: &'a Piles<T>,
    pub lane: Lane,
    /// Threads that work on it.
    pub team: usize,
    pub input: &'a [T],
    pub parameters: &'a [T],
    /// Into how many parts the step is cut.
    pub parts: usize,
    /// Whether this is the first of them.
    pub first: bool,
}

impl<T: Float> World<'_, T> {
    /// Advances the world by a step; a state that would not be finite is not taken.
    pub fn step(&self, state: &mut [T], w: &mut Workspace<T>) {
        self.impulse().fit(state);
        let parts = self.parts_of(state);
        for part in 0..parts {
            if state[self.impulse().alive()] > T::zero() {
                let first = part == 0;
                let world = World {
                    parts,
                    first,
                    ..*self
                };
                world.advance(state, w);
            }
        }
    }

    /// Into how many parts a step is cut. Bodies that joints hold may turn by no more than [`HELD_TURN`] in
    /// each, since their inertia is that of when it began: a chain that cracks like a whip flew apart at
    /// a third of a radian. Others that are no balls about their centres of mass may turn by no more than [`FREE_TURN`],
    /// since their arms are those of then: a rod would be stopped by what it does not reach, and a plank turn past a wall.
    fn parts_of(&self, state: &[T]) -> usize {
        let impulse = self.impulse();
        let spin = |row: u32| {
            let at = impulse.body_state(row as usize) + state::VELOCITY + 3;
            let squares = state[at..at + 3].iter().map(|x| x.to_f64().powi(2));
            squares.sum::<f64>()
        };
        let held = self.joints().map(|(_, [a, b])| spin(a).max(spin(b)));
        let held = held.fold(0.0, f64::max).sqrt();
        let shapes = impulse.shapes().iter().enumerate();
        let moving = shapes.filter(|(_, shape)| shape.row != WORLD);
        // Spin first: it tells nearly all of them apart, and is sooner known.
        let free = moving.fold(0.0_f64, |most, (i, shape)| {
            let spin = spin(shape.row);
            if spin > most && !impulse.is_centred(i, self.parameters) {
                spin
            } else {
                most
            }
        });
        let free = free.sqrt();
        let turn = held.max(free * (HELD_TURN / FREE_TURN)) * self.length();
        let steps = self.small_steps();
        let divides = |parts: &usize| steps.is_multiple_of(*parts);
        let short = |parts: &usize| turn <= HELD_TURN * *parts as f64;
        (1..steps).filter(divides).find(short).unwrap_or(steps)
    }

    /// Advances the world by a part of a step.
    fn advance(&self, state: &mut [T], w: &mut Workspace<T>) {
        w.ahead.clear();
        for attempt in 1..=ATTEMPTS {
            if self.attempt(state, w).is_err() || !self.is_sound(w) {
                return self.give_up(state);
            }
            if attempt == ATTEMPTS || !self.went_farther(state, w) {
                break;
            }
        }
        self.store(state, w);
        self.keep_joints(state, w);
        self.rest(state, w);
        if !(w.sleep.frozen.is_empty() && w.sensed.is_empty()) {
            w.contacts.append(&mut w.sleep.frozen);
            w.contacts.append(&mut w.sensed);
            w.contacts.sort_by_key(Cached::key);
        }
        self.add_parts(state, &mut w.contacts);
        self.remember(state, w);
    }

    /// Moves the bodies in their rows; the state stays.
    fn attempt(&self, state: &[T], w: &mut Workspace<T>) -> Result<(), space::SpaceError> {
        let globals = self.impulse().globals(self.parameters, self.parts);
        self.load(state, w);
        self.bodies(w, &globals, BodyStage::Begin);
        self.find_contacts(state, w, &globals)?;
        let solver = Solver {
            impulse: &self.piles.impulse,
            parameters: self.parameters,
            input: self.input,
            first: self.first,
            small_steps: self.small_steps(),
            lane: self.lane,
            width: self.width(),
            team: self.team,
            globals: &globals,
        };
        self.take_joints(w);
        self.colour(state, w);
        solver.run(state, w);
        self.read_impulses(w);
        self.bodies(w, &globals, BodyStage::Finish);
        Ok(())
    }

    /// Wakes what a controller moves by joints.
    fn stir(&self, state: &State<'_, T>, w: &mut Workspace<T>) {
        if w.sleep.asleep.contains(&true) {
            for (tie, rows) in self.joints() {
                if self.impulse().stirs(tie, state, self.input, self.length()) {
                    w.sleep.wake(rows);
                }
            }
        }
    }

    /// The joints that do anything, with the rows of their bodies.
    pub fn joints(&self) -> impl Iterator<Item = (usize, [u32; 2])> + Clone {
        let all = 0..self.impulse().ties();
        all.filter_map(|tie| Some((tie, self.impulse().tied_rows(tie)?)))
    }

    /// The joints of all that is awake.
    fn take_joints(&self, w: &mut Workspace<T>) {
        w.joints.clear();
        w.joint_ends.clear();
        let awake = |row: &u32| *row != WORLD && !w.sleep.asleep[*row as usize];
        for (tie, rows) in self.joints().filter(|(_, rows)| rows.iter().any(awake)) {
            w.joints.push(tie as u32);
            w.joint_ends.push((rows, 0));
        }
    }

    /// Gives contacts and joints their colours, and contacts the impulses that they had before.
    fn colour(&self, state: &[T], w: &mut Workspace<T>) {
        let (rows, width) = (self.impulse().rows(), self.width());
        w.ends.clear();
        let ends = w.contacts.iter().map(|c| (self.rows_of(c), c.count));
        w.ends.extend(ends);
        let (contacts, colours, joints) = (&mut w.contacts, &mut w.colours, &mut w.joint_colours);
        let mut paint = || {
            colours.paint(&w.ends, rows, width);
            joints.paint(&w.joint_ends, rows, width);
        };
        let mut recall = || self.recall(state, contacts);
        if self.team == 1 {
            paint();
            recall();
        } else {
            // One thread gives colours, since each depends on those before, while others recall.
            rayon::join(paint, recall);
        }
    }

    fn keep_joints(&self, state: &mut [T], w: &Workspace<T>) {
        for batch in 0..w.joint_colours.batches.len() {
            let members = w.joint_colours.batch(batch).iter();
            let joints = members.map(|member| w.joints[*member as usize] as usize);
            w.joint_lanes.read(batch, joints, self.impulse(), state);
        }
        let sleeps = |row: &u32| w.sleep.asleep[*row as usize];
        if w.sleep.asleep.contains(&true) {
            let rests = |(_, rows): &(_, [u32; 2])| rows.iter().all(|r| *r == WORLD || sleeps(r));
            for (tie, _) in self.joints().filter(rests) {
                let steps = self.small_steps();
                self.impulse().persist_tied(tie, self.first, steps, state);
            }
        }
    }

    /// Takes the impulses of the contacts out of their lanes.
    fn read_impulses(&self, w: &mut Workspace<T>) {
        let (lanes, part) = (&w.lanes, self.part(w.contacts.len()));
        let places = w.colours.places().par_chunks(part);
        let contacts = w.contacts.par_chunks_mut(part);
        contacts.zip(places).for_each(|(contacts, places)| {
            for (contact, place) in contacts.iter_mut().zip(places) {
                lanes.read(*place as usize, contact);
            }
        });
    }

    fn remember(&self, state: &mut [T], w: &mut Workspace<T>) {
        let rows = self.impulse().rows_for(&mut w.contacts, state);
        let part = self.part(w.contacts.len());
        let rows = rows.par_chunks_mut(REMEMBERED * part);
        rows.zip(w.contacts.par_chunks(part))
            .for_each(|(rows, contacts)| {
                for (row, contact) in rows.chunks_exact_mut(REMEMBERED).zip(contacts) {
                    contact.write(row);
                }
            });
    }

    /// How many of so many things one thread takes at a time: whole registers.
    pub fn part(&self, things: usize) -> usize {
        if self.team == 1 {
            return things.next_multiple_of(self.width()).max(1);
        }
        let share = things.div_ceil(PARTS * self.team);
        share.max(FEW).next_multiple_of(self.width())
    }

    pub fn impulse(&self) -> &Impulse {
        &self.piles.impulse
    }
    /// Lanes in which bodies, shapes and contacts are worked on.
    fn width(&self) -> usize {
        if self.lane.single {
            1
        } else {
            self.lane.isa.width::<T>()
        }
    }
    /// Length of a step, or of a part of it [s].
    pub fn length(&self) -> f64 {
        self.impulse().settings().substep() / self.parts as f64
    }
    /// How many small steps that has.
    pub fn small_steps(&self) -> usize {
        self.impulse().settings().contact_iterations / self.parts
    }

    /// Bodies from the state to their rows; which of them are awake.
    fn load(&self, state: &[T], w: &mut Workspace<T>) {
        let impulse = self.impulse();
        let numbers = State {
            impulse,
            state,
            parameters: self.parameters,
        };
        impulse.wrenches(&numbers, self.input, &mut w.wrenches);
        w.rows.resize(impulse.rows());
        w.rows.store(0, row::ORIENTATION + 3, T::one());
        w.sleep.clear(impulse.rows());
        let may_sleep = impulse.settings().sleep_speed > 0.0;
        let (rows, wrenches, part) = (&w.rows, &w.wrenches, self.part(impulse.rows()));
        let bodies = w.sleep.bodies(part).enumerate().skip(1);
        bodies.for_each(|(body, (asleep, rest))| {
            let from = &state[impulse.body_state(body)..][..state::WIDTH];
            rows.write(body, row::CENTER, &from[state::CENTER..][..7]);
            rows.write(body, row::VELOCITY, &from[state::VELOCITY..][..6]);
            rows.write(body, row::WRENCH, &wrenches[body]);
            // What is pushed does not sleep.
            if wrenches[body] == [T::zero(); 6] {
                *rest = from[state::REST].to_f64();
                *asleep = may_sleep && *rest >= SLEEP_AFTER;
            }
            if *asleep {
                rows.write(body, row::ACCELERATION, &[T::zero(); 6]);
            }
        });
        self.stir(&numbers, w);
        self.wake_up(w);
    }

    /// The list of bodies that are awake.
    fn wake_up(&self, w: &mut Workspace<T>) {
        w.awake.clear();
        let asleep = &w.sleep.asleep;
        let bodies = (1..asleep.len()).filter(|body| !asleep[*body]);
        w.awake.extend(bodies.map(|body| body as u32));
        let whole = w.awake.len().next_multiple_of(self.width());
        w.awake.resize(whole, WORLD);
    }

    fn bodies(&self, w: &Workspace<T>, globals: &[T; global::WIDTH], stage: BodyStage) {
        let parts = w.awake.par_chunks(self.part(w.awake.len()));
        parts.for_each(|index| {
            self.lane.run(Bodies {
                rows: &w.rows,
                index,
                masses: self.impulse().masses(self.parameters),
                globals,
                stage,
            });
        });
    }

    fn place(&self, w: &mut Workspace<T>, globals: &[T; global::WIDTH]) {
        let (impulse, piles) = (self.impulse(), self.piles);
        let unplaced = Placed {
            size: [T::zero(); 3],
            placed: [T::zero(); placed::WIDTH],
        };
        w.placed.resize(impulse.shapes().len(), unplaced);
        let part = self.part(piles.shapes.len());
        let shapes = piles.carriers.par_chunks(part);
        let shapes = shapes.zip(piles.shapes.par_chunks(part));
        let placed = w.placed.par_chunks_mut(part);
        placed.zip(shapes).for_each(|(placed, (carriers, index))| {
            self.lane.run(Shapes {
                rows: &w.rows,
                carriers,
                index,
                solids: impulse.solids(self.parameters),
                globals,
                placed,
            });
        });
    }

    /// The contacts of all that is awake.
    fn find_contacts(
        &self,
        state: &[T],
        w: &mut Workspace<T>,
        globals: &[T; global::WIDTH],
    ) -> Result<(), space::SpaceError> {
        w.contacts.clear();
        self.remember_sleepers(state, w);
        self.look(state, w, globals)?;
        while self.wake_touched(w) {
            self.wake_up(w);
            self.bodies(w, globals, BodyStage::Begin);
            // What woke falls, and gets farther.
            self.look(state, w, globals)?;
        }
        self.drop_sleepers(w);
        Ok(())
    }

    /// Puts the shapes in their places, and finds which touch.
    fn look(
        &self,
        state: &[T],
        w: &mut Workspace<T>,
        globals: &[T; global::WIDTH],
    ) -> Result<(), space::SpaceError> {
        self.place(w, globals);
        self.look_farther(w);
        w.candidates.clear();
        if let Some(filter) = &self.piles.filter {
            let (impulse, part) = (self.impulse(), self.part(w.placed.len()));
            let found = &mut w.candidates;
            let broad_phase = &mut w.kept.broad_phase;
            broad_phase.find(impulse, filter, &w.placed, self.parameters, part, found)?;
        }
        self.narrow_phase(state, w);
        Ok(())
    }

    fn narrow_phase(&self, state: &[T], w: &mut Workspace<T>) {
        let shapes = self.impulse().shapes();
        let awake = |shape: u32| {
            let body = shapes[shape as usize].row;
            body != WORLD && !w.sleep.asleep[body as usize]
        };
        if w.sleep.asleep.contains(&true) {
            let pairs = w.candidates.iter();
            let pairs = pairs.filter(|pair| pair.shapes.into_iter().any(awake));
            w.pairs.clear();
            w.pairs.extend(pairs);
        } else {
            std::mem::swap(&mut w.pairs, &mut w.candidates);
        }
        let Kept {
            broad_phase,
            mid_phase,
            ..
        } = &mut w.kept;
        let scene = Scene {
            impulse: self.impulse(),
            shapes: &w.placed,
            meshes: &self.piles.meshes,
            ways: broad_phase.ways(),
            state,
            parameters: self.parameters,
            lane: self.lane,
            width: self.width(),
            threads: self.team > 1,
        };
        let narrow_phase = &self.piles.narrow_phase;
        let apart = narrow_phase.find(&scene, &w.pairs, mid_phase, &mut w.found);
        for (pair, gap) in apart {
            broad_phase.are_apart(pair, gap);
        }
        w.sensed.clear();
        if !self.piles.senses {
            return;
        }
        let sensed = w.found.extract_if(.., |contact| self.is_sensed(contact));
        w.sensed.extend(sensed);
    }

    /// Whether a contact is of a sensor.
    pub fn is_sensed(&self, contact: &Cached<T>) -> bool {
        let sensor = |shape: u32| self.impulse().shapes()[shape as usize].sensor;
        contact.shapes.into_iter().any(sensor)
    }

    /// The bodies of a contact.
    pub fn rows_of(&self, contact: &Cached<T>) -> [u32; 2] {
        contact
            .shapes
            .map(|s| self.impulse().shapes()[s as usize].row)
    }

    /// All that is awake is finite and within the speed limit.
    fn is_sound(&self, w: &Workspace<T>) -> bool {
        let limit = self.impulse().settings().speed_limit;
        let fits = |body: u32, field: usize, most: f64| {
            w.rows.load(body as usize, field).to_f64().abs() <= most
        };
        let parts = w.awake.par_chunks(self.part(w.awake.len()));
        parts.all(|bodies| {
            bodies.iter().all(|&body| {
                (0..6).all(|i| fits(body, row::VELOCITY + i, limit))
                    && (0..7).all(|i| fits(body, row::CENTER + i, FARTHEST))
            })
        })
    }

    fn give_up(&self, state: &mut [T]) {
        state[self.impulse().alive()] = T::zero();
    }

    fn store(&self, state: &mut [T], w: &Workspace<T>) {
        let (rows, asleep) = (&w.rows, &w.sleep.asleep);
        let all = &mut state[self.impulse().body_state(0)..][..asleep.len() * state::WIDTH];
        let bodies = all.par_chunks_exact_mut(state::WIDTH).zip(asleep);
        let bodies = bodies.with_min_len(self.part(asleep.len()));
        let bodies = bodies.enumerate().skip(1);
        bodies.for_each(|(body, (to, asleep))| {
            if *asleep {
                return;
            }
            if self.first {
                to.copy_within(state::VELOCITY..state::VELOCITY + 6, state::BEFORE);
            }
            for (i, x) in to[state::CENTER..][..7].iter_mut().enumerate() {
                *x = rows.load(body, row::CENTER + i);
            }
            for (i, x) in to[state::VELOCITY..][..6].iter_mut().enumerate() {
                *x = rows.load(body, row::VELOCITY + i);
            }
            // Where things may sleep, `rest` counts on.
            to[state::REST] = T::zero();
        });
    }
}

/// Parts of a list for each thread.
const PARTS: usize = 2;
/// Fewer things are not worth another thread.
const FEW: usize = 64;
