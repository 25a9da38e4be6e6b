//! What shapes do to each other: whether they press or overlap, and their forces, in the contacts of the last step.

use super::contacts::{ContactNotes, Contacts, meets};
use super::rows::{Notes, Rows};
use super::{FLAGS, Reported, Told, flag};
use crate::output::contact;
use crate::tables::Filler;
use model::ShapeId;
use numbers::{Cell, Machine, Real};

/// Pairs of shapes.
#[derive(Default)]
pub(super) struct PairNotes {
    flags: Notes<7, 0>,
    forces: Notes<5, 0>,
}

/// Where they lie. FIRST and END are rows of contacts, TO is the first number told. Nothing of it depends on the numbers of
/// a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pairs {
    /// FIRST, END, the two SHAPES, TO; what it counts where they press, and where they overlap.
    flags: Rows<7, 0>,
    /// FIRST, END, the two SHAPES, TO.
    forces: Rows<5, 0>,
}

/// What is reported, and what is noted of it.
type Of<'a> = (&'a Reported<'a>, &'a mut ContactNotes);

impl PairNotes {
    /// Whether they press, from a number on.
    pub fn presses(&mut self, of: Of<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        self.flags(of, (pairs, to), |counts| [counts, 0]);
    }
    /// Whether they overlap.
    pub fn overlaps(&mut self, of: Of<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        self.flags(of, (pairs, to), |counts| [0, counts]);
    }
    fn flags(
        &mut self,
        (all, contacts): Of<'_>,
        (pairs, to): (&[[ShapeId; 2]], usize),
        counts: fn(usize) -> [usize; 2],
    ) {
        for (i, &[a, b]) in pairs.iter().enumerate() {
            let rows = contacts.of_pair(all, [a, b]);
            let [presses, overlaps] = counts(flag(i));
            let to = to + i / FLAGS;
            let links = [rows.start, rows.end, a.0, b.0, to, presses, overlaps];
            self.flags.add(links, []);
        }
    }
    /// Their forces.
    pub fn forces(&mut self, (all, contacts): Of<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        for (i, &[a, b]) in pairs.iter().enumerate() {
            let rows = contacts.of_pair(all, [a, b]);
            let links = [rows.start, rows.end, a.0, b.0, to + 3 * i];
            self.forces.add(links, []);
        }
    }
    /// How often loops go round, but for contacts.
    pub fn rounds(&self) -> usize {
        self.flags.len() + self.forces.len()
    }
    pub fn place(&self, parameters: &mut usize, links: &mut usize) -> Pairs {
        Pairs {
            flags: self.flags.place(parameters, links),
            forces: self.forces.place(parameters, links),
        }
    }
}

impl Pairs {
    pub fn fill(&self, notes: &PairNotes, f: &mut Filler) {
        self.flags.fill(&notes.flags, f);
        self.forces.fill(&notes.forces, f);
    }

    /// Tells Σ flags, and Σ ± f.
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, contacts: &Contacts, told: Told) {
        let zero = M::R::zero();
        for pair in self.flags.all(k) {
            let [first, end, a, b, to, presses, overlaps] = self.flags.links(k, pair);
            let [presses, overlaps] = [k.number(presses), k.number(overlaps)];
            let mut flag = k.cell(zero);
            for row in k.range(first, end) {
                let [contact, turned] = contacts.rows.links(k, row);
                let distance = k.load(contacts.told, contact, contact::DISTANCE);
                let met = meets(distance);
                if let Some(_branch) = k.if_any(met) {
                    let is_theirs = !sign(k, contacts, [contact, turned], [a, b]).same(zero);
                    let [fx, fy, fz] = k.read(contacts.told, contact, contact::FORCE);
                    let pushes = fx.abs().max(fy.abs()).max(fz.abs()).gt(zero);
                    let within = M::R::select(distance.le(zero), overlaps, zero);
                    let counts = M::R::select(pushes, presses.max(within), within);
                    let counts = M::R::select(is_theirs & met, counts, zero);
                    flag.write(flag.read().max(counts));
                }
            }
            k.add(told, to, 0, flag.read());
        }
        for pair in self.forces.all(k) {
            let [first, end, a, b, to] = self.forces.links(k, pair);
            for row in k.range(first, end) {
                let [contact, turned] = contacts.rows.links(k, row);
                let met = meets(k.load(contacts.told, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = sign(k, contacts, [contact, turned], [a, b]);
                    let sign = M::R::select(met, sign, zero);
                    let force = k.vec3(contacts.told, contact, contact::FORCE);
                    k.add_vec3(told, to, 0, force * sign);
                }
            }
        }
    }
}

/// Whether the force of a contact is on the second of two shapes (1), or on the first (−1); 0 if it is of others.
#[inline(always)]
fn sign<M: Machine>(
    k: &M,
    contacts: &Contacts,
    [contact, turned]: [M::I; 2],
    [a, b]: [M::I; 2],
) -> M::R {
    let Some(found) = contacts.found else {
        return contacts.sign(k, turned);
    };
    let [first, second] = k.read(found, contact, 0);
    let [a, b] = [k.number(a), k.number(b)];
    let (one, zero) = (M::R::one(), M::R::zero());
    let turned = M::R::select(first.same(b) & second.same(a), -one, zero);
    M::R::select(first.same(a) & second.same(b), one, turned)
}
