//! One step of one world, stage by stage.

use super::Piles;
use super::batches::Lanes;
use super::broad_phase::{BroadPhase, Candidate};
use super::colours::Colours;
use super::jobs::{Bodies, BodyRows, BodyStage, Shapes};
use super::joints::JointLanes;
use super::narrow_phase::Scene;
use super::sleep::Sleep;
use super::solve::Solver;
use crate::jobs::Lane;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::pair::{Placed, placed, solid};
use rigid::impulse::{Cached, Impulse, State, WORLD, global, row, state};

/// What a step needs besides the world's state; nothing in it outlives a step but its memory.
pub(super) struct Workspace<T: Float> {
    pub rows: BodyRows<T>,
    pub sleep: Sleep<T>,
    wrenches: Vec<[T; 6]>,
    /// Bodies that are awake, filled up to whole registers.
    pub awake: Vec<u32>,
    pub placed: Vec<Placed<T>>,
    /// Of the world that is stepped.
    pub broad_phase: BroadPhase,
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
            broad_phase: BroadPhase::default(),
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
}

impl<T: Float> World<'_, T> {
    /// Advances the world by a step; a state that would not be finite is not taken.
    pub fn step(&self, state: &mut [T], w: &mut Workspace<T>) {
        let parts = self.parts_of(state);
        for part in 0..parts {
            if state[self.impulse().alive()] > T::zero() {
                World { parts, ..*self }.advance(state, w, part == 0);
            }
        }
    }

    /// Into how many parts a step is cut: bodies that joints hold may turn by no more than [`TURN`] in
    /// each, since their inertia is that of when it began. A chain that cracks like a whip flew apart at
    /// a third of a radian.
    fn parts_of(&self, state: &[T]) -> usize {
        let impulse = self.impulse();
        let spin = |row: u32| {
            let at = impulse.body_state(row as usize) + state::VELOCITY + 3;
            let squares = state[at..at + 3].iter().map(|x| x.to_f64().powi(2));
            squares.sum::<f64>()
        };
        let spins = self.joints().map(|(_, [a, b])| spin(a).max(spin(b)));
        let turn = spins.fold(0.0, f64::max).sqrt() * self.length();
        let steps = self.small_steps();
        let divides = |parts: &usize| steps.is_multiple_of(*parts);
        let short = |parts: &usize| turn <= TURN * *parts as f64;
        (1..steps).filter(divides).find(short).unwrap_or(steps)
    }

    /// Advances the world by a part of a step.
    fn advance(&self, state: &mut [T], w: &mut Workspace<T>, first: bool) {
        let globals = self.impulse().globals(self.parameters, self.parts);
        self.load(state, w);
        self.bodies(w, &globals, BodyStage::Begin);
        self.place(w, &globals);
        if self.find_contacts(state, w, &globals).is_err() {
            return self.give_up(state);
        }
        let solver = Solver {
            impulse: &self.piles.impulse,
            parameters: self.parameters,
            input: self.input,
            length: self.length(),
            small_steps: self.small_steps(),
            lane: self.lane,
            width: self.width(),
            team: self.team,
            globals: &globals,
        };
        self.take_joints(w);
        solver.run(state, w);
        self.bodies(w, &globals, BodyStage::Finish);
        if !self.is_sound(w) {
            return self.give_up(state);
        }
        self.store(state, w, first);
        self.keep_joints(state, w);
        self.rest(state, w);
        if !(w.sleep.frozen.is_empty() && w.sensed.is_empty()) {
            w.contacts.append(&mut w.sleep.frozen);
            w.contacts.append(&mut w.sensed);
            w.contacts.sort_by_key(Cached::key);
        }
        self.impulse().remember(&mut w.contacts, state);
    }

    /// Wakes what a controller moves by joints.
    fn stir(&self, state: &State<'_, T>, w: &mut Workspace<T>) {
        if w.sleep.asleep.contains(&true) {
            for (tie, rows) in self.joints() {
                if self.impulse().stirs(tie, state, self.input) {
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

    fn keep_joints(&self, state: &mut [T], w: &Workspace<T>) {
        for batch in 0..w.joint_colours.batches.len() {
            let members = w.joint_colours.batch(batch).iter();
            let joints = members.map(|member| w.joints[*member as usize] as usize);
            w.joint_lanes.read(batch, joints, self.impulse(), state);
        }
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
    fn small_steps(&self) -> usize {
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
        for body in 1..impulse.rows() {
            let from = &state[impulse.body_state(body)..][..state::WIDTH];
            let wrench = w.wrenches[body];
            let sleeps = w.sleep.load(body, from[state::REST], &wrench);
            for (i, x) in from[state::CENTER..][..7].iter().enumerate() {
                w.rows.store(body, row::CENTER + i, *x);
            }
            for i in 0..6 {
                w.rows
                    .store(body, row::VELOCITY + i, from[state::VELOCITY + i]);
                w.rows.store(body, row::WRENCH + i, wrench[i]);
                if sleeps {
                    w.rows.store(body, row::ACCELERATION + i, T::zero());
                }
            }
        }
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
        let width = self.width();
        let work = |index: &[u32]| {
            self.lane.run(Bodies {
                rows: &w.rows,
                index,
                masses: self.impulse().masses(self.parameters),
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
        w.placed.clear();
        let solids = self.impulse().solids(self.parameters);
        let sizes = solids.chunks_exact(solid::WIDTH).map(|solid| Placed {
            size: [
                solid[solid::SIZE],
                solid[solid::SIZE + 1],
                solid[solid::SIZE + 2],
            ],
            placed: [T::zero(); placed::WIDTH],
        });
        w.placed.extend(sizes);
        self.lane.run(Shapes {
            rows: &w.rows,
            carriers: &self.piles.carriers,
            index: &self.piles.shapes,
            solids,
            globals,
            placed: &mut w.placed,
        });
    }

    /// The contacts of all that is awake, with the impulses that they had before.
    fn find_contacts(
        &self,
        state: &[T],
        w: &mut Workspace<T>,
        globals: &[T; global::WIDTH],
    ) -> Result<(), space::SpaceError> {
        let impulse = self.impulse();
        w.contacts.clear();
        w.candidates.clear();
        if let Some(filter) = &self.piles.filter {
            let (found, parameters) = (&mut w.candidates, self.parameters);
            w.broad_phase
                .find(impulse, filter, &w.placed, parameters, found)?;
        }
        self.remember_sleepers(state, w);
        self.narrow_phase(state, w);
        while self.wake_touched(w) {
            self.wake_up(w);
            self.bodies(w, globals, BodyStage::Begin);
            self.narrow_phase(state, w);
        }
        self.drop_sleepers(w);
        self.recall(state, &mut w.contacts);
        Ok(())
    }

    fn narrow_phase(&self, state: &[T], w: &mut Workspace<T>) {
        let shapes = self.impulse().shapes();
        let awake = |shape: u32| {
            let body = shapes[shape as usize].row;
            body != WORLD && !w.sleep.asleep[body as usize]
        };
        w.pairs.clear();
        let pairs = w
            .candidates
            .iter()
            .filter(|pair| pair.shapes.into_iter().any(awake));
        w.pairs.extend(pairs);
        let scene = Scene {
            impulse: self.impulse(),
            shapes: &w.placed,
            meshes: &self.piles.meshes,
            state,
            parameters: self.parameters,
            lane: self.lane,
            width: self.width(),
            threads: self.team > 1,
        };
        let known = &mut w.broad_phase;
        let are_apart = |pair, gap| known.are_apart(pair, gap);
        let narrow_phase = &self.piles.narrow_phase;
        narrow_phase.find(&scene, &w.pairs, &mut w.found, are_apart);
        w.sensed.clear();
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
        w.awake.iter().all(|&body| {
            (0..6).all(|i| fits(body, row::VELOCITY + i, limit))
                && (0..7).all(|i| fits(body, row::CENTER + i, FARTHEST))
        })
    }

    fn give_up(&self, state: &mut [T]) {
        state[self.impulse().alive()] = T::zero();
    }

    fn store(&self, state: &mut [T], w: &Workspace<T>, first: bool) {
        for &body in w.awake.iter().filter(|body| **body != WORLD) {
            let to = &mut state[self.impulse().body_state(body as usize)..][..state::WIDTH];
            if first {
                to.copy_within(state::VELOCITY..state::VELOCITY + 6, state::BEFORE);
            }
            for (i, x) in to[state::CENTER..][..7].iter_mut().enumerate() {
                *x = w.rows.load(body as usize, row::CENTER + i);
            }
            for (i, x) in to[state::VELOCITY..][..6].iter_mut().enumerate() {
                *x = w.rows.load(body as usize, row::VELOCITY + i);
            }
        }
    }
}

/// Longest turn [rad] of a body that joints hold, while its inertia is taken not to turn.
const TURN: f64 = 0.125;
/// Nothing is farther from the origin [m].
const FARTHEST: f64 = 1e9;
/// Registers of bodies, or contacts, that are worth another thread.
pub(super) const MANY: usize = 16;
