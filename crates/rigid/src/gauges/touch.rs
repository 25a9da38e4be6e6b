//! What touches bodies: sums over the contacts of the last step.

use super::frames::Frames;
use super::rows::{Notes, Rows};
use super::{Reported, Told, reported};
use crate::output::{OutputTables, contact};
use crate::tables::Filler;
use collide::FAR;
use model::{BodyId, Model, ShapeId};
use numbers::machine::Links;
use numbers::machine::space::Input;
use numbers::{Machine, Real, Table};
use std::ops::Range;

/// Bodies that feel, and the rows of contacts that may be theirs.
#[derive(Default)]
pub(super) struct TouchNotes {
    touches: Notes<4, 0>,
    forces: Notes<5, 0>,
    rows: Notes<1, 1>,
}

/// Where they lie. FIRST and END are those of `rows`, TO is the first number told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touches {
    contacts: Table<Input, { contact::WIDTH }>,
    /// The shapes of each contact, where they change from step to step, and the bodies of these.
    found: Option<(Table<Input, 2>, Links)>,
    /// FIRST, END, BODY, TO.
    touches: Rows<4, 0>,
    /// FIRST, END, BODY, FRAME in whose axes it is told, TO.
    forces: Rows<5, 0>,
    /// CONTACT; 1 if its force is on the body, −1 if it is the body's.
    rows: Rows<1, 1>,
}

impl TouchNotes {
    /// Notes the contacts of a body.
    fn rows(&mut self, (model, reported): (&Model, &Reported<'_>), body: BodyId) -> Range<usize> {
        let first = self.rows.len();
        let of = |shape: ShapeId| model.shapes[shape.0].body == Some(body);
        for row in 0..reported.outputs.contacts {
            let sign = match reported.contact_shapes.get(row) {
                Some([_, second]) if of(*second) => 1.0,
                Some([first, _]) if of(*first) => -1.0,
                Some(_) => continue,
                None => 0.0,
            };
            self.rows.add([row], [sign]);
        }
        first..self.rows.len()
    }
    pub fn touch(&mut self, of: (&Model, &Reported<'_>), body: BodyId, to: usize) {
        let Range { start, end } = self.rows(of, body);
        self.touches.add([start, end, body.0, to], []);
    }
    /// In the axes of a frame.
    pub fn force(
        &mut self,
        of: (&Model, &Reported<'_>),
        (body, frame): (BodyId, usize),
        to: usize,
    ) {
        let Range { start, end } = self.rows(of, body);
        self.forces.add([start, end, body.0, frame, to], []);
    }
    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        self.touches.len() + self.forces.len() + self.rows.len()
    }
    pub fn place(
        &self,
        (model, outputs): (&Model, &OutputTables),
        [parameters, links]: [&mut usize; 2],
    ) -> Touches {
        let found = outputs.names_contacts() && self.rows.len() > 0;
        Touches {
            contacts: reported(outputs.contact),
            found: found.then(|| {
                let bodies = Links::place(links, model.shapes.len());
                (reported(outputs.touching), bodies)
            }),
            touches: self.touches.place(parameters, links),
            forces: self.forces.place(parameters, links),
            rows: self.rows.place(parameters, links),
        }
    }
}

impl Touches {
    pub fn fill(&self, notes: &TouchNotes, model: &Model, f: &mut Filler) {
        self.touches.fill(&notes.touches, f);
        self.forces.fill(&notes.forces, f);
        self.rows.fill(&notes.rows, f);
        if let Some((_, bodies)) = self.found {
            for (row, shape) in model.shapes.iter().enumerate() {
                let body = shape.body.map_or(model.bodies.len(), |body| body.0);
                f.link(bodies, row, 0, body);
            }
        }
    }

    /// Whether the force of a contact, in this row of `rows`, is on a body (1), or the body's (−1); 0 if neither.
    #[inline(always)]
    fn sign<M: Machine>(&self, k: &M, [row, contact, body]: [M::I; 3]) -> M::R {
        let Some((touching, bodies)) = self.found else {
            return k.load(self.rows.numbers, row, 0);
        };
        let [first, second] = k.read(touching, contact, 0);
        let is_of = |shape: M::R| {
            let carrier = k.link(bodies, k.whole(shape), 0);
            k.number(carrier).same(k.number(body))
        };
        let minus = M::R::select(is_of(first), -M::R::one(), M::R::zero());
        M::R::select(is_of(second), M::R::one(), minus)
    }

    /// Tells Σ |n · f|, and Σ ± f.
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, frames: &Frames, told: Told) {
        for gauge in self.touches.all(k) {
            let [first, end, body, to] = self.touches.links(k, gauge);
            for row in k.range(first, end) {
                let [contact] = self.rows.links(k, row);
                let met = meets(k.load(self.contacts, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = self.sign(k, [row, contact, body]);
                    let normal = k.vec3(self.contacts, contact, contact::NORMAL);
                    let pressure = normal.dot(k.vec3(self.contacts, contact, contact::FORCE));
                    let pressure = (sign * pressure).abs();
                    k.add(told, to, 0, M::R::select(met, pressure, M::R::zero()));
                }
            }
        }
        for gauge in self.forces.all(k) {
            let [first, end, body, frame, to] = self.forces.links(k, gauge);
            let axes = frames.orientation(k, frame);
            for row in k.range(first, end) {
                let [contact] = self.rows.links(k, row);
                let met = meets(k.load(self.contacts, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = self.sign(k, [row, contact, body]);
                    let sign = M::R::select(met, sign, M::R::zero());
                    let force = k.vec3(self.contacts, contact, contact::FORCE);
                    k.add_vec3(told, to, 0, axes.rotate_inverse(force * sign));
                }
            }
        }
    }
}

/// Where there is a contact now, by its distance.
#[inline(always)]
pub(super) fn meets<R: Real>(distance: R) -> R::Mask {
    distance.lt(R::lit(0.5 * FAR))
}
