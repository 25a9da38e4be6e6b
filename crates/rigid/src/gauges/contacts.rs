//! The contacts of the last step: which of them may be those of two shapes or of a body, and on which side their forces are.

use super::rows::{Notes, Rows};
use super::{Of, Reported, reported};
use crate::output::contact;
use crate::tables::Filler;
use collide::FAR;
use model::{BodyId, ShapeId};
use numbers::machine::space::Input;
use numbers::{Machine, Real, Table};
use std::collections::HashMap;
use std::ops::Range;

/// Rows of contacts, each as often as somebody looks at it.
#[derive(Default)]
pub(super) struct ContactNotes {
    rows: Notes<2, 0>,
    /// Those of all contacts, once they are noted: where shapes change from step to step, everybody goes through them.
    all: Option<Range<usize>>,
    /// The contacts of each two shapes, the lower one first, once they are sorted.
    of_shapes: Option<HashMap<[ShapeId; 2], Vec<usize>>>,
    rounds: usize,
}

impl ContactNotes {
    /// Rows that may be those of two shapes, with their forces on the second.
    pub fn of_pair(&mut self, given: &Reported<'_>, pair: [ShapeId; 2]) -> Range<usize> {
        if given.outputs.names_contacts() {
            return self.of_anything(given);
        }
        let shapes = given.contact_shapes;
        let of_shapes = self.of_shapes.get_or_insert_with(|| by_shapes(shapes));
        let first = self.rows.len();
        for &contact in of_shapes.get(&sorted(pair)).into_iter().flatten() {
            let turned = usize::from(shapes[contact] != pair);
            self.rows.add([contact, turned], []);
        }
        self.since(first)
    }
    /// Rows that may be those of a body, with their forces on it.
    pub fn of_body(&mut self, (model, given): Of<'_>, body: BodyId) -> Range<usize> {
        if given.outputs.names_contacts() {
            return self.of_anything(given);
        }
        let first = self.rows.len();
        let carries = |shape: ShapeId| model.shapes[shape.0].body == Some(body);
        for (contact, [a, b]) in given.contact_shapes.iter().enumerate() {
            if carries(*a) || carries(*b) {
                let turned = usize::from(!carries(*b));
                self.rows.add([contact, turned], []);
            }
        }
        self.since(first)
    }
    fn of_anything(&mut self, given: &Reported<'_>) -> Range<usize> {
        let rows = &mut self.rows;
        let all = self.all.get_or_insert_with(|| {
            let first = rows.len();
            for contact in 0..given.outputs.contacts {
                rows.add([contact, 0], []);
            }
            first..rows.len()
        });
        self.rounds += all.len();
        all.clone()
    }
    /// Rows from this one on.
    fn since(&mut self, first: usize) -> Range<usize> {
        self.rounds += self.rows.len() - first;
        first..self.rows.len()
    }
    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        self.rounds
    }
    pub fn place(&self, all: &Reported<'_>, [parameters, links]: [&mut usize; 2]) -> Contacts {
        let outputs = all.outputs;
        Contacts {
            told: reported(outputs.contact),
            found: outputs.names_contacts().then(|| reported(outputs.touching)),
            rows: self.rows.place(parameters, links),
        }
    }
}

fn sorted([a, b]: [ShapeId; 2]) -> [ShapeId; 2] {
    [a.min(b), a.max(b)]
}

fn by_shapes(shapes: &[[ShapeId; 2]]) -> HashMap<[ShapeId; 2], Vec<usize>> {
    let mut contacts = HashMap::<_, Vec<usize>>::new();
    for (contact, pair) in shapes.iter().enumerate() {
        contacts.entry(sorted(*pair)).or_default().push(contact);
    }
    contacts
}

/// Where they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Contacts {
    pub told: Table<Input, { contact::WIDTH }>,
    /// The shapes of each contact, where they change from step to step.
    pub found: Option<Table<Input, 2>>,
    /// CONTACT; 0 where its force is on whom it is looked at for, 1 where it is theirs.
    pub rows: Rows<2, 0>,
}

impl Contacts {
    pub fn fill(&self, notes: &ContactNotes, f: &mut Filler) {
        self.rows.fill(&notes.rows, f);
    }
    /// Of a force that is turned −1, else 1.
    #[inline(always)]
    pub fn sign<M: Machine>(&self, k: &M, turned: M::I) -> M::R {
        let turned = k.number(turned);
        M::R::one() - (turned + turned)
    }
}

/// Where there is a contact now, by its distance.
#[inline(always)]
pub(super) fn meets<R: Real>(distance: R) -> R::Mask {
    distance.lt(R::lit(0.5 * FAR))
}
