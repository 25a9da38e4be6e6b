//! One step of one world, stage by stage.

use super::Piles;
use super::batches::Lanes;
use super::broad_phase::BroadPhase;
use super::colours::Colours;
use super::islands::{Islands, SLEEP_AFTER};
use super::jobs::{Bodies, BodyRows, BodyStage, Shapes};
use super::narrow_phase::Scene;
use super::solve::Solver;
use crate::jobs::Lane;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{Placed, placed, solid};
use rigid::impulse::{Cached, Impulse, State, WORLD, global, row};

/// What a step needs besides the world's state; nothing in it outlives a step but its memory.
pub(super) struct Workspace<T: Float> {
    pub rows: BodyRows<T>,
    /// Which bodies sleep.
    asleep: Vec<bool>,
    wrenches: Vec<[T; 6]>,
    /// Bodies that are awake, filled up to whole registers.
    pub awake: Vec<u32>,
    pub masses: Vec<T>,
    solids: Vec<T>,
    carriers: Vec<u32>,
    index: Vec<u32>,
    placed: Vec<Placed<T>>,
    broad_phase: BroadPhase,
    candidates: Vec<[u32; 2]>,
    pairs: Vec<[u32; 2]>,
    found: Vec<Cached<T>>,
    before: Vec<Cached<T>>,
    /// Contacts between bodies that sleep.
    frozen: Vec<Cached<T>>,
    pub contacts: Vec<Cached<T>>,
    islands: Islands,
    pub colours: Colours,
    /// Bodies and number of points of each contact.
    pub ends: Vec<([u32; 2], usize)>,
    pub lanes: Lanes<T>,
}

impl<T: Float> Default for Workspace<T> {
    fn default() -> Self {
        Self {
            rows: BodyRows::default(),
            asleep: Vec::new(),
            wrenches: Vec::new(),
            awake: Vec::new(),
            masses: Vec::new(),
            solids: Vec::new(),
            carriers: Vec::new(),
            index: Vec::new(),
            placed: Vec::new(),
            broad_phase: BroadPhase::default(),
            candidates: Vec::new(),
            pairs: Vec::new(),
            found: Vec::new(),
            before: Vec::new(),
            frozen: Vec::new(),
            contacts: Vec::new(),
            islands: Islands::default(),
            colours: Colours::default(),
            ends: Vec::new(),
            lanes: Lanes::default(),
        }
    }
}

/// A world, but for its state.
pub(super) struct World<'a, T: Float> {
    pub piles: &'a Piles<T>,
    pub lane: Lane,
    /// Threads that work on it.
    pub team: usize,
    pub input: &'a [T],
    pub parameters: &'a [T],
}

/// Fields of a body's state, in their order.
const BODY: usize = Impulse::BODY_STATE;
const VELOCITY: usize = 7;
const BEFORE: usize = 13;

/// Fastest separation of surfaces that overlap [m/s].
const PUSH_OUT: f64 = 3.0;

impl<T: Float> World<'_, T> {
    /// Advances the world by a step; a state that would not be finite is not taken.
    pub fn step(&mut self, state: &mut [T], w: &mut Workspace<T>) {
        let globals = self.globals();
        self.load(state, w);
        self.bodies(w, &globals, BodyStage::Begin);
        self.place(w, &globals);
        if self.find_contacts(state, w).is_err() {
            return self.give_up(state);
        }
        let solver = Solver {
            impulse: &self.piles.impulse,
            parameters: self.parameters,
            lane: self.lane,
            width: self.width(),
            team: self.team,
            globals: &globals,
        };
        solver.run(w);
        self.bodies(w, &globals, BodyStage::Finish);
        if !self.is_sound(w) {
            return self.give_up(state);
        }
        self.store(state, w);
        self.rest(state, w);
        self.remember(state, w);
    }

    fn impulse(&self) -> &Impulse {
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
    fn length(&self) -> f64 {
        self.impulse().settings().substep()
    }

    /// Gap [m] that two shapes may close within a step besides what their motion does: what falls
    /// from rest, twice, and room for the pushes of others.
    fn slack(&self) -> f64 {
        2.0 * self.gravity() * self.length().powi(2) + NEARBY
    }
    /// Strength of gravity [m/s²].
    fn gravity(&self) -> f64 {
        let gravity = self.impulse().gravity(self.parameters);
        let squares = gravity.iter().map(|x| x.to_f64().powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// See [`global`].
    fn globals(&self) -> [T; global::WIDTH] {
        let (long, steps) = (
            self.length(),
            self.impulse().settings().contact_iterations as f64,
        );
        let h = long / steps;
        let gravity = self.impulse().gravity(self.parameters);
        let mut globals = [T::zero(); global::WIDTH];
        for (to, x) in globals.iter_mut().zip([h, 1.0 / h, steps]) {
            *to = T::from_f64(x);
        }
        globals[global::GRAVITY..][..3].copy_from_slice(gravity);
        globals[global::PUSH_OUT] = T::from_f64(PUSH_OUT);
        globals[global::RESTING] = T::from_f64(2.0 * self.gravity() * long);
        globals
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
        w.asleep.clear();
        w.asleep.resize(impulse.rows(), false);
        for body in 1..impulse.rows() {
            let from = &state[impulse.body_state(body)..][..BODY];
            for i in 0..7 {
                w.rows.store(body, row::CENTER + i, from[i]);
            }
            for i in 0..6 {
                w.rows.store(body, row::VELOCITY + i, from[VELOCITY + i]);
                w.rows.store(body, row::WRENCH + i, w.wrenches[body][i]);
            }
            let rests = from[Impulse::REST].to_f64() >= SLEEP_AFTER;
            w.asleep[body] = rests && w.wrenches[body] == [T::zero(); 6];
        }
        w.masses.clear();
        for body in 0..impulse.rows() {
            w.masses
                .extend_from_slice(impulse.mass_of(body, self.parameters));
        }
        self.wake_up(w);
        w.solids.clear();
        for shape in 0..impulse.shapes().len() {
            w.solids
                .extend_from_slice(impulse.solid_of(shape, self.parameters));
        }
    }

    /// The list of bodies that are awake.
    fn wake_up(&self, w: &mut Workspace<T>) {
        w.awake.clear();
        let bodies = (1..w.asleep.len()).filter(|body| !w.asleep[*body]);
        w.awake.extend(bodies.map(|body| body as u32));
        let whole = w.awake.len().next_multiple_of(self.width());
        w.awake.resize(whole, WORLD);
    }

    fn bodies(&self, w: &Workspace<T>, globals: &[T; global::WIDTH], stage: BodyStage) {
        let width = self.width();
        let work = |index: &[u32]| {
            self.lane.run(Bodies {
                rows: &w.rows,
                index,
                masses: &w.masses,
                globals,
                stage,
            });
        };
        self.in_shares(&w.awake, width * MANY, work);
    }

    /// Parts of a list, by all threads where that is worth its while.
    fn in_shares(&self, list: &[u32], part: usize, work: impl Fn(&[u32]) + Send + Sync) {
        if self.team > 1 && list.len() > part {
            list.par_chunks(part).for_each(work);
        } else {
            work(list);
        }
    }

    fn place(&self, w: &mut Workspace<T>, globals: &[T; global::WIDTH]) {
        let shapes = self.impulse().shapes();
        let width = self.width();
        let whole = shapes.len().next_multiple_of(width);
        w.carriers.clear();
        w.carriers.extend(shapes.iter().map(|s| s.row));
        w.index.clear();
        w.index.extend(0..shapes.len() as u32);
        if let (Some(&carrier), Some(&last)) = (w.carriers.last(), w.index.last()) {
            w.carriers.resize(whole, carrier);
            w.index.resize(whole, last);
        }
        w.placed.clear();
        let sizes = (0..shapes.len()).map(|i| Placed {
            size: [0, 1, 2].map(|axis| w.solids[i * solid::WIDTH + solid::SIZE + axis]),
            placed: [T::zero(); placed::WIDTH],
        });
        w.placed.extend(sizes);
        self.lane.run(Shapes {
            rows: &w.rows,
            carriers: &w.carriers,
            index: &w.index,
            solids: &w.solids,
            globals,
            placed: &mut w.placed,
        });
    }

    /// The contacts of all that is awake, with the impulses that they had before.
    fn find_contacts(&self, state: &[T], w: &mut Workspace<T>) -> Result<(), space::SpaceError> {
        let impulse = self.impulse();
        let Some(filter) = &self.piles.filter else {
            return Ok(());
        };
        let parameters = self.parameters;
        let found = &mut w.candidates;
        let slack = self.slack();
        w.broad_phase
            .find(impulse, filter, &w.placed, parameters, slack, found)?;
        w.before.clear();
        if w.asleep.contains(&true) {
            let all = 0..impulse.remembered(state);
            w.before
                .extend(all.map(|i| impulse.recall(i, state).contact()));
        }
        self.narrow_phase(w);
        if self.wake_touched(w) {
            self.wake_up(w);
            self.bodies(w, &self.globals(), BodyStage::Begin);
            self.narrow_phase(w);
        }
        self.drop_sleepers(w);
        self.recall(state, &mut w.contacts);
        Ok(())
    }

    fn narrow_phase(&self, w: &mut Workspace<T>) {
        let shapes = self.impulse().shapes();
        let awake = |shape: u32| {
            let body = shapes[shape as usize].row;
            body != WORLD && !w.asleep[body as usize]
        };
        w.pairs.clear();
        let pairs = w
            .candidates
            .iter()
            .filter(|pair| awake(pair[0]) || awake(pair[1]));
        w.pairs.extend(pairs);
        let scene = Scene {
            impulse: self.impulse(),
            shapes: &w.placed,
            parameters: self.parameters,
            slack: T::from_f64(self.slack()),
            lane: self.lane,
            width: self.width(),
            threads: self.team > 1,
        };
        self.piles.narrow_phase.find(&scene, &w.pairs, &mut w.found);
    }

    /// Wakes what is touched by what is awake, with all that it rests on; tells whether any woke.
    fn wake_touched(&self, w: &mut Workspace<T>) -> bool {
        if !w.asleep.contains(&true) {
            return false;
        }
        w.islands.separate(w.asleep.len());
        for contact in &w.before {
            let [a, b] = self.rows_of(contact);
            if a != WORLD && b != WORLD && w.asleep[a as usize] && w.asleep[b as usize] {
                w.islands.join(a, b);
            }
        }
        let mut touched = vec![false; w.asleep.len()];
        for contact in &w.found {
            let [a, b] = self.rows_of(contact);
            for (sleeper, other) in [(a, b), (b, a)] {
                let meets = w.asleep[sleeper as usize] && self.reaches(w, contact, other);
                if sleeper != WORLD && meets {
                    touched[w.islands.of(sleeper) as usize] = true;
                }
            }
        }
        let mut woke = false;
        for body in 1..w.asleep.len() {
            if w.asleep[body] && touched[w.islands.of(body as u32) as usize] {
                w.asleep[body] = false;
                woke = true;
            }
        }
        woke
    }

    /// Whether a body closes the gap of a contact within the step.
    fn reaches(&self, w: &Workspace<T>, contact: &Cached<T>, body: u32) -> bool {
        let way = |axis: usize| w.rows.load(body as usize, row::VELOCITY + axis).to_f64();
        let speed = (0..3).map(|i| way(i).powi(2)).sum::<f64>().sqrt();
        let reach = speed * self.length() + NEARBY;
        contact.points[..contact.count]
            .iter()
            .any(|p| p.gap.to_f64() < reach)
    }

    fn rows_of(&self, contact: &Cached<T>) -> [u32; 2] {
        contact
            .shapes
            .map(|s| self.impulse().shapes()[s as usize].row)
    }

    /// Leaves out contacts with bodies that sleep on, and keeps those among sleepers as they were.
    fn drop_sleepers(&self, w: &mut Workspace<T>) {
        let asleep = &w.asleep;
        let sleeps = |contact: &Cached<T>| {
            let rows = self.rows_of(contact);
            rows.iter()
                .all(|row| *row == WORLD || asleep[*row as usize])
        };
        let disturbs = |contact: &Cached<T>| {
            let rows = self.rows_of(contact);
            rows.iter()
                .any(|row| *row != WORLD && asleep[*row as usize])
        };
        w.frozen.clear();
        w.frozen
            .extend(w.before.iter().filter(|contact| sleeps(contact)));
        std::mem::swap(&mut w.contacts, &mut w.found);
        w.contacts.retain(|contact| !disturbs(contact));
    }

    /// Gives the contacts the impulses that their points had before.
    fn recall(&self, state: &[T], contacts: &mut [Cached<T>]) {
        if self.team == 1 || contacts.len() < MANY * self.team {
            return self.recall_run(state, contacts);
        }
        let part = contacts.len().div_ceil(self.team);
        let parts = contacts.par_chunks_mut(part);
        parts.for_each(|part| self.recall_run(state, part));
    }

    /// The same for a run of them. Both lists are in order.
    fn recall_run(&self, state: &[T], contacts: &mut [Cached<T>]) {
        let impulse = self.impulse();
        let all = impulse.remembered(state);
        let place = |i: usize| ordered(impulse.recall(i, state).shapes());
        let first = contacts.first().map_or([0; 2], |c| ordered(c.shapes));
        let (mut next, mut end) = (0, all);
        while next < end {
            let middle = usize::midpoint(next, end);
            if place(middle) < first {
                next = middle + 1;
            } else {
                end = middle;
            }
        }
        for contact in contacts {
            let key = ordered(contact.shapes);
            while next < all && place(next) < key {
                next += 1;
            }
            if next < all && place(next) == key {
                let [a, b] = contact.shapes.map(|s| self.radius(s as usize));
                impulse
                    .recall(next, state)
                    .warm(contact, SAME_PLACE * a.max(b));
                next += 1;
            }
        }
    }

    /// Radius [m] of a shape; 0 of what has no end.
    fn radius(&self, shape: usize) -> f64 {
        self.impulse().solid_of(shape, self.parameters)[solid::RADIUS].to_f64()
    }

    /// All that is awake is finite and within the speed limit.
    fn is_sound(&self, w: &Workspace<T>) -> bool {
        let limit = self.impulse().settings().speed_limit;
        let fits = |body: u32, field: usize, most: f64| {
            w.rows.load(body as usize, field).to_f64().abs() <= most
        };
        w.awake.iter().all(|&body| {
            (0..6).all(|i| fits(body, row::VELOCITY + i, limit))
                && (0..7).all(|i| fits(body, row::CENTER + i, FARTHEST))
        })
    }

    fn give_up(&self, state: &mut [T]) {
        state[self.impulse().alive()] = T::zero();
    }

    fn store(&self, state: &mut [T], w: &Workspace<T>) {
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let to = &mut state[self.impulse().body_state(body as usize)..][..BODY];
            to.copy_within(VELOCITY..VELOCITY + 6, BEFORE);
            for i in 0..7 {
                to[i] = w.rows.load(body as usize, row::CENTER + i);
            }
            for i in 0..6 {
                to[VELOCITY + i] = w.rows.load(body as usize, row::VELOCITY + i);
            }
        }
    }

    /// Lets islands sleep that have been slow for long enough.
    fn rest(&self, state: &mut [T], w: &mut Workspace<T>) {
        let slow = self.impulse().settings().sleep_speed;
        w.islands.separate(w.asleep.len());
        for contact in &w.contacts {
            let [a, b] = self.rows_of(contact);
            let presses = |i: usize| contact.points[i].impulse > T::zero();
            if a != WORLD && b != WORLD && (0..contact.count).any(presses) {
                w.islands.join(a, b);
            }
        }
        let mut least = vec![f64::INFINITY; w.asleep.len()];
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let island = w.islands.of(body) as usize;
            let at = self.impulse().body_state(body as usize);
            let speed = self.speed(&state[at..][..BODY], body as usize);
            let rest = state[at + Impulse::REST].to_f64() + self.length();
            let rest = if speed < slow {
                rest.min(2.0 * SLEEP_AFTER)
            } else {
                0.0
            };
            state[at + Impulse::REST] = T::from_f64(rest);
            least[island] = least[island].min(rest);
        }
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let at = self.impulse().body_state(body as usize);
            let sleeps = least[w.islands.of(body) as usize] >= SLEEP_AFTER;
            let to = &mut state[at..][..BODY];
            if sleeps {
                to[VELOCITY..VELOCITY + 6].fill(T::zero());
                to[Impulse::REST] = T::from_f64(SLEEP_AFTER);
            } else {
                let awake = to[Impulse::REST].to_f64().min(SLEEP_AFTER - self.length());
                to[Impulse::REST] = T::from_f64(awake.max(0.0));
            }
        }
    }

    /// How fast [m/s] a body's farthest point may be.
    fn speed(&self, body: &[T], row: usize) -> f64 {
        let length = |i: usize| {
            let v = &body[VELOCITY + i..][..3];
            v.iter().map(|x| x.to_f64().powi(2)).sum::<f64>().sqrt()
        };
        length(0) + length(3) * self.piles.radii[row]
    }

    /// Keeps the contacts, by shapes.
    fn remember(&self, state: &mut [T], w: &mut Workspace<T>) {
        if !w.frozen.is_empty() {
            w.contacts.append(&mut w.frozen);
            w.contacts.sort_by_key(|contact| ordered(contact.shapes));
        }
        self.impulse().remember(&w.contacts, state);
    }
}

/// Gap [m] at which two shapes touch even if nothing moves.
const NEARBY: f64 = 1e-4;
/// Nothing is farther from the origin [m].
const FARTHEST: f64 = 1e9;
/// Points nearer than this share of the larger shape's radius, of one pair, are the same.
const SAME_PLACE: f64 = 0.05;
/// Registers of bodies, or contacts, that are worth another thread.
const MANY: usize = 16;

fn ordered([a, b]: [u32; 2]) -> [u32; 2] {
    [a.min(b), a.max(b)]
}
