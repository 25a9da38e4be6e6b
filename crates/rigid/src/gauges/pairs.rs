//! What shapes do to each other: whether they press or overlap, and their forces, in the contacts of the last step.

use super::rows::{Notes, Rows};
use super::touch::meets;
use super::{FLAGS, Reported, Told, reported};
use crate::output::contact;
use crate::tables::Filler;
use model::ShapeId;
use numbers::machine::space::Input;
use numbers::{Cell, Machine, Real, Table};

/// Pairs of shapes, and the rows of contacts that may be theirs.
#[derive(Default)]
pub(super) struct PairNotes {
    flags: Notes<5, 2>,
    forces: Notes<5, 0>,
    rows: Notes<1, 1>,
}

/// Where they lie. FIRST and END are those of `rows`, TO is the first number told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Pairs {
    contacts: Table<Input, { contact::WIDTH }>,
    /// The shapes of each contact, where they change from step to step.
    found: Option<Table<Input, 2>>,
    /// FIRST, END, the two SHAPES, TO; what it counts where they press, and where they overlap.
    flags: Rows<5, 2>,
    /// FIRST, END, the two SHAPES, TO.
    forces: Rows<5, 0>,
    /// CONTACT; 1 if its force is on the second shape, −1 if it is on the first.
    rows: Rows<1, 1>,
}

impl PairNotes {
    /// Notes the contacts of a pair; returns its links.
    fn pair(&mut self, all: &Reported<'_>, [a, b]: [ShapeId; 2], to: usize) -> [usize; 5] {
        let first = self.rows.len();
        for row in 0..all.outputs.contacts {
            let sign = match all.contact_shapes.get(row) {
                Some(shapes) if *shapes == [a, b] => 1.0,
                Some(shapes) if *shapes == [b, a] => -1.0,
                Some(_) => continue,
                None => 0.0,
            };
            self.rows.add([row], [sign]);
        }
        [first, self.rows.len(), a.0, b.0, to]
    }
    /// Whether they press, from a number on.
    pub fn presses(&mut self, all: &Reported<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        self.flags((all, pairs), to, |counts| [counts, 0.0]);
    }
    /// Whether they overlap.
    pub fn overlaps(&mut self, all: &Reported<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        self.flags((all, pairs), to, |counts| [0.0, counts]);
    }
    fn flags(
        &mut self,
        (all, pairs): (&Reported<'_>, &[[ShapeId; 2]]),
        to: usize,
        counts: fn(f64) -> [f64; 2],
    ) {
        for (i, &pair) in pairs.iter().enumerate() {
            let links = self.pair(all, pair, to + i / FLAGS);
            self.flags.add(links, counts(flag(i)));
        }
    }
    /// Their forces.
    pub fn forces(&mut self, all: &Reported<'_>, pairs: &[[ShapeId; 2]], to: usize) {
        for (i, &pair) in pairs.iter().enumerate() {
            let links = self.pair(all, pair, to + 3 * i);
            self.forces.add(links, []);
        }
    }
    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        self.flags.len() + self.forces.len() + self.rows.len()
    }
    pub fn place(&self, all: &Reported<'_>, [parameters, links]: [&mut usize; 2]) -> Pairs {
        let outputs = all.outputs;
        Pairs {
            contacts: reported(outputs.contact),
            found: outputs.names_contacts().then(|| reported(outputs.touching)),
            flags: self.flags.place(parameters, links),
            forces: self.forces.place(parameters, links),
            rows: self.rows.place(parameters, links),
        }
    }
}

/// What the flag of one of several counts in its number.
pub(super) fn flag(row: usize) -> f64 {
    f64::from(1 << (row % FLAGS))
}

impl Pairs {
    pub fn fill(&self, notes: &PairNotes, f: &mut Filler) {
        self.flags.fill(&notes.flags, f);
        self.forces.fill(&notes.forces, f);
        self.rows.fill(&notes.rows, f);
    }

    /// Whether the force of the contact in this row of `rows` is on the second shape (1), or on the first (−1); 0 if it is of
    /// others.
    #[inline(always)]
    fn sign<M: Machine>(&self, k: &M, [row, contact]: [M::I; 2], [a, b]: [M::I; 2]) -> M::R {
        let Some(touching) = self.found else {
            return k.load(self.rows.numbers, row, 0);
        };
        let [first, second] = k.read(touching, contact, 0);
        let [a, b] = [k.number(a), k.number(b)];
        let (one, zero) = (M::R::one(), M::R::zero());
        let turned = M::R::select(first.same(b) & second.same(a), -one, zero);
        M::R::select(first.same(a) & second.same(b), one, turned)
    }

    /// Tells Σ flags, and Σ ± f.
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, told: Told) {
        let zero = M::R::zero();
        for pair in self.flags.all(k) {
            let [first, end, a, b, to] = self.flags.links(k, pair);
            let [presses, overlaps] = self.flags.numbers(k, pair);
            let mut flag = k.cell(zero);
            for row in k.range(first, end) {
                let [contact] = self.rows.links(k, row);
                let is_theirs = !self.sign(k, [row, contact], [a, b]).same(zero);
                let distance = k.load(self.contacts, contact, contact::DISTANCE);
                let [fx, fy, fz] = k.read(self.contacts, contact, contact::FORCE);
                let pushes = fx.abs().max(fy.abs()).max(fz.abs()).gt(zero);
                let within = M::R::select(distance.le(zero), overlaps, zero);
                let counts = M::R::select(pushes, presses.max(within), within);
                let met = is_theirs & meets(distance);
                flag.write(flag.read().max(M::R::select(met, counts, zero)));
            }
            k.add(told, to, 0, flag.read());
        }
        for pair in self.forces.all(k) {
            let [first, end, a, b, to] = self.forces.links(k, pair);
            for row in k.range(first, end) {
                let [contact] = self.rows.links(k, row);
                let met = meets(k.load(self.contacts, contact, contact::DISTANCE));
                if let Some(_branch) = k.if_any(met) {
                    let sign = self.sign(k, [row, contact], [a, b]);
                    let sign = M::R::select(met, sign, zero);
                    let force = k.vec3(self.contacts, contact, contact::FORCE);
                    k.add_vec3(told, to, 0, force * sign);
                }
            }
        }
    }
}
