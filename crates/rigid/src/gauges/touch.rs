//! What touches bodies: sums over the contacts of the last step.

use super::contacts::{ContactNotes, Contacts, meets};
use super::frames::Frames;
use super::rows::{Notes, Rows};
use super::{Of, Told};
use crate::output::{OutputTables, contact};
use crate::tables::Filler;
use model::{BodyId, Model};
use numbers::machine::Links;
use numbers::{Machine, Real};

/// Bodies that feel.
#[derive(Default)]
pub(super) struct TouchNotes {
    touches: Notes<4, 0>,
    forces: Notes<5, 0>,
}

/// Where they lie. FIRST and END are rows of contacts, TO is the first number told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Touches {
    /// The bodies of all shapes, where those of contacts change from step to step.
    bodies: Option<Links>,
    /// FIRST, END, BODY, TO.
    touches: Rows<4, 0>,
    /// FIRST, END, BODY, FRAME in whose axes it is told, TO.
    forces: Rows<5, 0>,
}

/// What is reported of a model, and what is noted of its contacts.
type OfContacts<'a> = (Of<'a>, &'a mut ContactNotes);

impl TouchNotes {
    pub fn touch(&mut self, (all, contacts): OfContacts<'_>, body: BodyId, to: usize) {
        let rows = contacts.of_body(all, body);
        self.touches.add([rows.start, rows.end, body.0, to], []);
    }
    /// In the axes of a frame.
    pub fn force(
        &mut self,
        (all, contacts): OfContacts<'_>,
        (body, frame): (BodyId, usize),
        to: usize,
    ) {
        let rows = contacts.of_body(all, body);
        let links = [rows.start, rows.end, body.0, frame, to];
        self.forces.add(links, []);
    }
    /// How often loops go round, but for contacts.
    pub fn rounds(&self) -> usize {
        self.touches.len() + self.forces.len()
    }
    pub fn place(
        &self,
        (model, outputs): (&Model, &OutputTables),
        [parameters, links]: [&mut usize; 2],
    ) -> Touches {
        let found = outputs.names_contacts() && self.rounds() > 0;
        Touches {
            bodies: found.then(|| Links::place(links, model.shapes.len())),
            touches: self.touches.place(parameters, links),
            forces: self.forces.place(parameters, links),
        }
    }
}

impl Touches {
    pub fn fill(&self, notes: &TouchNotes, model: &Model, f: &mut Filler) {
        self.touches.fill(&notes.touches, f);
        self.forces.fill(&notes.forces, f);
        if let Some(bodies) = self.bodies {
            for (row, shape) in model.shapes.iter().enumerate() {
                let body = shape.body.map_or(model.bodies.len(), |body| body.0);
                f.link(bodies, row, 0, body);
            }
        }
    }

    /// Whether the force of a contact is on a body (1), or the body's (−1); 0 if neither.
    #[inline(always)]
    fn sign<M: Machine>(
        &self,
        k: &M,
        contacts: &Contacts,
        [contact, turned, body]: [M::I; 3],
    ) -> M::R {
        let (Some(found), Some(bodies)) = (contacts.found, self.bodies) else {
            return contacts.sign(k, turned);
        };
        let [first, second] = k.read(found, contact, 0);
        let is_of = |shape: M::R| {
            let carrier = k.link(bodies, k.whole(shape), 0);
            k.number(carrier).same(k.number(body))
        };
        let minus = M::R::select(is_of(first), -M::R::one(), M::R::zero());
        M::R::select(is_of(second), M::R::one(), minus)
    }

    /// Tells Σ |n · f|, and Σ ± f.
    #[inline(always)]
    pub fn tell<M: Machine>(
        &self,
        k: &mut M,
        (contacts, frames): (&Contacts, &Frames),
        told: Told,
    ) {
        for gauge in self.touches.all(k) {
            let [first, end, body, to] = self.touches.links(k, gauge);
            for row in k.range(first, end) {
                let [contact, turned] = contacts.rows.links(k, row);
                let met = meets(k.load(contacts.told, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = self.sign(k, contacts, [contact, turned, body]);
                    let normal = k.vec3(contacts.told, contact, contact::NORMAL);
                    let pressure = normal.dot(k.vec3(contacts.told, contact, contact::FORCE));
                    let pressure = (sign * pressure).abs();
                    k.add(told, to, 0, M::R::select(met, pressure, M::R::zero()));
                }
            }
        }
        for gauge in self.forces.all(k) {
            let [first, end, body, frame, to] = self.forces.links(k, gauge);
            let axes = frames.orientation(k, frame);
            for row in k.range(first, end) {
                let [contact, turned] = contacts.rows.links(k, row);
                let met = meets(k.load(contacts.told, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = self.sign(k, contacts, [contact, turned, body]);
                    let sign = M::R::select(met, sign, M::R::zero());
                    let force = k.vec3(contacts.told, contact, contact::FORCE);
                    k.add_vec3(told, to, 0, axes.rotate_inverse(force * sign));
                }
            }
        }
    }
}
