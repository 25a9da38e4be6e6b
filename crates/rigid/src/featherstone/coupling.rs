//! Couplings of two joints, as gears and mimics are: one row each, on the tree's factor.
//!
//! A coupling holds φ = q_A − offset − ratio q_B at the end of the step, q' = q + h q̇'. What is left of that, and is
//! to be zero, is
//!
//! ```text
//! r = φ/h + q̇_A' − ratio q̇_B'
//! ```
//!
//! which [`locked`](super::locked) solves, for as much of φ as a step [takes](super::tied::Pace). The impulse λ
//! [N·s or N·m·s] of the row acts along A's axis, and −ratio λ along B's: with these, in place of wrenches, start the
//! walks that find y ([`factor`](super::factor)).

use super::contact::rate;
use super::factor::{Path, response};
use super::tables::{Tables, dof};
use super::tied::{self, Pace, Tied};
use crate::tables::Filler;
use model::{AxisKind, Coupling, Model};
use numbers::machine::space::Parameter;
use numbers::machine::{Held, Hold, Links};
use numbers::spatial::Spatial;
use numbers::{Machine, Real, Table};

/// Fields of [`CouplingTables::links`].
mod coupling_link {
    /// Row of [`Tables::couple_links`].
    pub const COUPLE: usize = 0;
    /// Row of [`LockedTables`](super::super::locked::LockedTables).
    pub const LOCKED: usize = 1;
    /// Which of the path's entries is of A's degree of freedom, and which of B's.
    pub const START_A: usize = 2;
    pub const START_B: usize = 3;
    /// Degrees of freedom and coordinates of A and B.
    pub const DOF_A: usize = 4;
    pub const DOF_B: usize = 5;
    pub const COORDINATE_A: usize = 6;
    pub const COORDINATE_B: usize = 7;
    pub const WIDTH: usize = 8;
}

/// Layout of the couplings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CouplingTables {
    pub count: usize,
    /// Ratio, offset, and the [`Pace`] of A's coordinate.
    coupling: Table<Parameter, 4>,
    /// See [`coupling_link`].
    links: Links<{ coupling_link::WIDTH }>,
}

/// Where a coupling's joints are, as the tables take it.
#[derive(Clone, Debug)]
pub(super) struct Coupled {
    /// Trees and rows of both joints' nodes.
    pub groups: [usize; 2],
    pub rows: [usize; 2],
    /// Pair of nodes, row among those that are locked, and which entries of the path are the joints' own.
    pub couple: usize,
    pub locked: usize,
    pub starts: [usize; 2],
    /// What hangs together by this and others.
    pub tied: Tied,
}

impl CouplingTables {
    pub fn place(count: usize, parameters: &mut usize, links: &mut usize) -> Self {
        Self {
            count,
            coupling: Table::place(parameters, count),
            links: Links::place(links, count),
        }
    }

    /// Writes a row, for steps of `h` [s].
    pub(super) fn fill(
        &self,
        i: usize,
        at: &Coupled,
        model: &Model,
        coupling: &Coupling,
        h: f64,
        f: &mut Filler,
    ) {
        let [pace, other] = [coupling.joint, coupling.other].map(|joint| {
            let pace = match model.joints[joint.0].axes[0].kind {
                AxisKind::Angular => Pace::turns(&at.tied, h),
                AxisKind::Linear => Pace::shifts(&at.tied, h),
            };
            pace.numbers()
        });
        // Either of both may be what moves, where B has a part in it.
        let ratio = coupling.ratio.abs();
        let pace = [0, 1].map(|i: usize| match ratio > 0.0 {
            true => pace[i].min(ratio * other[i]),
            false => pace[i],
        });
        f.numbers(self.coupling, i, 0, &[coupling.ratio, coupling.offset]);
        f.numbers(self.coupling, i, 2, &pace);
        let joints = [coupling.joint, coupling.other];
        let [dof_a, dof_b] = joints.map(|j| model.dof_range(j).start);
        let [coordinate_a, coordinate_b] = joints.map(|j| model.coordinate_range(j).start);
        let links = [
            (coupling_link::COUPLE, at.couple),
            (coupling_link::LOCKED, at.locked),
            (coupling_link::START_A, at.starts[0]),
            (coupling_link::START_B, at.starts[1]),
            (coupling_link::DOF_A, dof_a),
            (coupling_link::DOF_B, dof_b),
            (coupling_link::COORDINATE_A, coordinate_a),
            (coupling_link::COORDINATE_B, coordinate_b),
        ];
        for (field, x) in links {
            f.link(self.links, i, field, x);
        }
    }
}

/// Lets the forces of the last step act.
#[inline(always)]
pub(super) fn press<M: Machine>(k: &mut M, t: &Tables) {
    for c in k.count(t.couplings.count) {
        let ratio = k.load(t.couplings.coupling, c, 0);
        let force = t
            .locked
            .force(k, k.link(t.couplings.links, c, coupling_link::LOCKED));
        let a = k.link(t.couplings.links, c, coupling_link::DOF_A);
        let b = k.link(t.couplings.links, c, coupling_link::DOF_B);
        k.add(t.dof, a, dof::TAU, force);
        k.add(t.dof, b, dof::TAU, -(ratio * force));
    }
}

/// What is left of all couplings without impulses, and their y. Needs the accelerations under the forces of [`press`].
#[inline(always)]
pub(super) fn rows<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let rate = rate(k, t);
    for c in k.count(t.couplings.count) {
        let [ratio, offset] = k.read(t.couplings.coupling, c, 0);
        let a = k.link(t.couplings.links, c, coupling_link::DOF_A);
        let b = k.link(t.couplings.links, c, coupling_link::DOF_B);
        let q_a = k.link(t.couplings.links, c, coupling_link::COORDINATE_A);
        let q_b = k.link(t.couplings.links, c, coupling_link::COORDINATE_B);
        let (q_a, q_b) = (k.load(t.position, q_a, 0), k.load(t.position, q_b, 0));
        let error = ratio.fnma(q_b, q_a - offset);
        let error = error * tied::share(error.abs(), k.read(t.couplings.coupling, c, 2));
        let speed = ratio.fnma(speed(k, t, b, h), speed(k, t, a, h));
        let locked = k.link(t.couplings.links, c, coupling_link::LOCKED);
        t.locked
            .remains(k, locked, error.fma(rate, speed), error * rate);
        responses(k, t, c, locked, ratio);
    }
}

/// q̇ + h q̈.
#[inline(always)]
fn speed<M: Machine>(k: &M, t: &Tables, v: M::I, h: M::R) -> M::R {
    let faster = k.load(t.dof, v, dof::ACCELERATION);
    h.fma(faster, k.load(t.velocity, v, 0))
}

/// y of a coupling's row.
#[inline(always)]
fn responses<M: Machine>(k: &mut M, t: &Tables, c: M::I, locked: M::I, ratio: M::R) {
    let (zero, one) = (M::R::zero(), M::R::one());
    let path = Path::of(k, t, k.link(t.couplings.links, c, coupling_link::COUPLE));
    for i in path.entries(k) {
        t.locked.set_entry(k, locked, i, zero);
    }
    let start = k.link(t.couplings.links, c, coupling_link::START_A);
    t.locked.set_entry(k, locked, start, one);
    let start = k.link(t.couplings.links, c, coupling_link::START_B);
    t.locked.set_entry(k, locked, start, -ratio);
    let mut a = Spatial::zero().hold(k);
    walk(k, t, path, locked, path.own_of_a(k), &mut a);
    let mut b = Spatial::zero().hold(k);
    walk(k, t, path, locked, path.own_of_b(), &mut b);
    let mut both = (a.get() + b.get()).hold(k);
    walk(k, t, path, locked, path.shared(), &mut both);
}

/// Walks inwards along some of a path's entries, which hold forces along their degrees of freedom and get y.
#[inline(always)]
fn walk<M: Machine>(
    k: &mut M,
    t: &Tables,
    path: Path<M::I>,
    locked: M::I,
    [from, to]: [M::I; 2],
    wrench: &mut Spatial<M::Cell>,
) {
    for i in k.range(from, to) {
        let v = path.dof(k, t, i);
        let own = t.locked.entry(k, locked, i);
        let along = k.spatial(t.dof, v, dof::AXIS).dot_plus(wrench.get(), own);
        let share = -(along * k.load(t.dof, v, dof::INVERSE));
        wrench.set(k.spatial(t.dof, v, dof::U).fma(share, wrench.get()));
        let y = along * k.load(t.response, v, response::ROOT);
        t.locked.set_entry(k, locked, i, y);
    }
}
