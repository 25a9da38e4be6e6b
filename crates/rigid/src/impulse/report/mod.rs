//! What a world looks like from outside.
//!
//! Of each thing, a body, a joint or a contact, a kernel tells from what it is given: numbers of the state, then constants.
//! Who gives it these, and where what it tells goes, is the host's business.

mod body;
mod contact;
mod free;

pub use super::joint::{TieReport, tell_tie};
pub use body::{BodyReport, SUMS, tell_body};
pub use contact::{ContactReport, collider, tell_contact};
pub use free::{FreeReport, tell_free};

use super::layout::{Impulse, State, WORLD, pose_at};
use super::tables::mass;
use crate::Report;
use crate::output::{body_acceleration, contact as told_contact, total};
use collide::FAR;
use numbers::{Cpu, Float, PerWorld};
use std::ops::Range;

/// What is told of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Thing {
    /// A body of the model.
    Body(usize),
    /// A free joint to the world, along which nothing acts.
    Free(usize),
    /// Any other joint.
    Tie(usize),
    /// A contact that the world remembers.
    Contact(usize),
}

/// Numbers that a kernel is given, works with, and tells of a thing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[allow(missing_docs)]
pub struct ReportLengths {
    pub given: usize,
    pub state: usize,
    pub told: usize,
}

/// Ranges of a state that a thing is told of by, at most.
pub const RANGES: usize = 4;

impl Impulse {
    /// How many free joints there are to the world, along which nothing acts.
    pub fn free_joints(&self) -> usize {
        self.free.len()
    }
    /// How many bodies the model has.
    pub fn model_bodies(&self) -> usize {
        self.rows.len()
    }
    /// The numbers of a state that a thing is told of by, range by range; the last ones may be empty.
    pub fn given_of_state(&self, thing: Thing) -> [Range<usize>; RANGES] {
        let row = |row: u32| self.state.at(row as usize, 0)..self.state.at(row as usize + 1, 0);
        let long = self.given_in.at(0, 1)..self.given_in.at(0, 2);
        match thing {
            Thing::Body(id) => [row(self.rows[id]), long, 0..0, 0..0],
            Thing::Free(i) => [row(self.rows[self.free[i].body.0]), long, 0..0, 0..0],
            Thing::Tie(tie) => {
                let [a, b] = self.ties.list[tie].rows;
                [row(a), row(b), self.tied_state(tie), long]
            }
            Thing::Contact(i) => {
                let contact = self.memory.at(i, 0)..self.memory.at(i + 1, 0);
                [contact, long, 0..0, 0..0]
            }
        }
    }
    /// The constants that it is told of by, which come behind these.
    pub fn given_constants<T: Float>(
        &self,
        thing: Thing,
        parameters: &[T],
        mut give: impl FnMut(f64),
    ) {
        match thing {
            Thing::Body(id) => {
                let frame = self.frame.at(id, 0)..self.frame.at(id + 1, 0);
                parameters[frame].iter().for_each(|x| give(x.to_f64()));
                match self.rows[id] {
                    // What does not move has no mass here.
                    WORLD => (0..mass::WIDTH).for_each(|_| give(0.0)),
                    row => {
                        let own = self.mass_of(row as usize, parameters).iter();
                        own.for_each(|x| give(x.to_f64()));
                    }
                }
                let gravity = self.gravity(parameters).iter();
                gravity.for_each(|x| give(x.to_f64()));
            }
            Thing::Free(i) => {
                let free = &self.free[i];
                let inner = pose_at(parameters, self.frame.at(free.body.0, 0));
                for pose in [free.parent_frame, inner * free.child_frame] {
                    pose.position.to_array().into_iter().for_each(&mut give);
                    pose.orientation.to_array().into_iter().for_each(&mut give);
                }
            }
            Thing::Tie(tie) => self.given_constants_of_tie(tie, parameters, give),
            Thing::Contact(_) => {}
        }
    }
    /// Where in the output what is told of a body or a joint belongs: number by number, then its place.
    pub fn told_places(&self, thing: Thing, mut place: impl FnMut(usize, usize)) {
        let mut row = |from: usize, to: usize, numbers: usize| {
            (0..numbers).for_each(|i| place(from + i, to + i));
        };
        let output = &self.output;
        match thing {
            Thing::Body(id) => {
                let t = BodyReport::new();
                row(t.motion.start(), output.body.at(id, 0), crate::body::WIDTH);
                let at = output.body_acceleration.at(id, 0);
                row(t.acceleration.start(), at, body_acceleration::WIDTH);
                if let Some(asleep) = output.asleep {
                    row(t.asleep.start(), asleep.at(id, 0), 1);
                }
            }
            Thing::Free(i) => {
                let (t, free) = (FreeReport::new(), &self.free[i]);
                row(
                    t.position.start(),
                    output.position.at(free.coordinate, 0),
                    7,
                );
                row(t.velocity.start(), output.velocity.at(free.dof, 0), 6);
                row(
                    t.acceleration.start(),
                    output.acceleration.at(free.dof, 0),
                    6,
                );
                let reaction = output.reaction.at(free.joint.0, 0);
                row(t.reaction.start(), reaction, crate::reaction::WIDTH);
            }
            Thing::Tie(tie) => self.told_places_of_tie(tie, row),
            Thing::Contact(_) => {}
        }
    }
    /// Where in the output what is told of a point of a contact belongs, in a row of its own, and what is told of its shapes.
    pub fn told_places_of_point(
        &self,
        point: usize,
        row: usize,
        mut place: impl FnMut(usize, usize),
    ) {
        let (t, output) = (ContactReport::new(), &self.output);
        let [own, torque] = [0, told_contact::WIDTH].map(|field| t.points.at(point, field));
        let at = output.contact.at(row, 0);
        (0..told_contact::WIDTH).for_each(|i| place(own + i, at + i));
        if let Some(torques) = output.contact_torque {
            (0..3).for_each(|i| place(torque + i, torques.at(row, i)));
        }
        (0..2).for_each(|i| place(t.shapes.at(0, i), output.touching.at(row, i)));
    }
    /// Where the output tells of a row that there is no contact: its place, and what is put there.
    pub fn told_apart(&self, row: usize) -> (usize, f64) {
        (self.output.contact.at(row, told_contact::DISTANCE), FAR)
    }
    /// Where the output has the contacts of a world.
    pub fn told_contacts(&self) -> Range<usize> {
        self.output.contact.start()..self.output.contacts_end()
    }
    /// Where the output has the sums of a world, as [`SUMS`] are told of bodies.
    pub fn told_sums(&self) -> Range<usize> {
        let at = self.output.total.at(0, total::KINETIC);
        at..at + SUMS
    }
    /// Where it has how many contacts there was no room for.
    pub fn told_capped(&self) -> usize {
        self.output.total.at(0, total::CAPPED)
    }

    /// Fills as much of the output of a world from its state as is asked for.
    pub fn report<T: Float>(&self, state: &State<'_, T>, asked: Report, output: &mut [T]) {
        let contacts = asked >= Report::Contacts;
        let colliders = contacts.then(|| self.told_colliders());
        let mut teller = Teller::new(self, colliders.unwrap_or_default());
        for i in 0..self.free.len() {
            teller.tell(Thing::Free(i), state, output);
        }
        let mut sums = [0.0; SUMS];
        for tie in 0..self.ties() {
            let energy = TieReport::new().energy;
            let told = teller.tell(Thing::Tie(tie), state, output);
            (0..2).for_each(|i| sums[i] += told[energy.at(0, i)]);
        }
        if asked >= Report::Motion {
            for id in 0..self.rows.len() {
                let own = BodyReport::new().sums;
                let told = teller.tell(Thing::Body(id), state, output);
                (0..SUMS).for_each(|i| sums[i] += told[own.at(0, i)]);
            }
        }
        if contacts {
            self.report_contacts(state, &mut teller, output);
        }
        if asked >= Report::Everything {
            let places = output[self.told_sums()].iter_mut();
            places.zip(sums).for_each(|(to, x)| *to = T::from_f64(x));
            output[self.told_capped()] = T::from_f64(self.forgotten(state.state));
        }
    }

    fn report_contacts<T: Float>(
        &self,
        state: &State<'_, T>,
        teller: &mut Teller<'_>,
        output: &mut [T],
    ) {
        let mut row = 0;
        for i in 0..self.remembered(state.state) {
            let told = teller.tell(Thing::Contact(i), state, output);
            for point in 0..self.recall(i, state.state).points() {
                self.told_places_of_point(point, row, |field, at| {
                    output[at] = T::from_f64(told[field]);
                });
                row += 1;
            }
        }
        for row in row..self.output.contacts {
            let (at, far) = self.told_apart(row);
            output[at] = T::from_f64(far);
        }
    }
    /// What kernels read of colliding shapes: see [`collider`].
    pub fn told_colliders(&self) -> Vec<u32> {
        let shapes = self.shapes.iter();
        let words = shapes.flat_map(|shape| [shape.shape.0 as u32, u32::from(shape.row == WORLD)]);
        words.collect()
    }
}

impl Thing {
    /// Numbers of its kernel.
    pub fn lengths(self) -> ReportLengths {
        match self {
            Self::Body(_) => BodyReport::new().lengths,
            Self::Free(_) => FreeReport::new().lengths,
            Self::Tie(_) => TieReport::new().lengths,
            Self::Contact(_) => ContactReport::new().lengths,
        }
    }
}

/// Runs kernels on the processor, in double precision.
struct Teller<'a> {
    impulse: &'a Impulse,
    colliders: Vec<u32>,
    given: Vec<f64>,
    work: Vec<f64>,
    told: Vec<f64>,
}

impl<'a> Teller<'a> {
    /// Of contacts, with their colliding shapes.
    fn new(impulse: &'a Impulse, colliders: Vec<u32>) -> Self {
        Self {
            impulse,
            colliders,
            given: Vec::new(),
            work: Vec::new(),
            told: Vec::new(),
        }
    }
    /// Tells of a thing; what belongs to the output goes there.
    fn tell<T: Float>(&mut self, thing: Thing, state: &State<'_, T>, output: &mut [T]) -> &[f64] {
        let lengths = thing.lengths();
        self.given.clear();
        for range in self.impulse.given_of_state(thing) {
            let numbers = state.state[range].iter();
            self.given.extend(numbers.map(|x| x.to_f64()));
        }
        let given = &mut self.given;
        self.impulse
            .given_constants(thing, state.parameters, |x| given.push(x));
        self.work.resize(lengths.state, 0.0);
        self.told.resize(lengths.told, 0.0);
        let mut k = Cpu {
            state: &mut self.work,
            input: &self.given,
            output: &mut self.told,
            scratch: &mut [],
            parameters: PerWorld(&[]),
            links: &self.colliders,
        };
        match thing {
            Thing::Body(_) => tell_body(&mut k, &BodyReport::new()),
            Thing::Free(_) => tell_free(&mut k, &FreeReport::new()),
            Thing::Tie(_) => tell_tie(&mut k, &TieReport::new()),
            Thing::Contact(_) => tell_contact(&mut k, &ContactReport::new()),
        }
        let told = &self.told;
        self.impulse
            .told_places(thing, |field, at| output[at] = T::from_f64(told[field]));
        &self.told
    }
}
