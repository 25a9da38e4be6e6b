//! Couplings of two joints, as gears and mimics are: one row each, on the tree's factor.
//!
//! A coupling holds φ = q_A − offset − ratio q_B at the end of the step, q' = q + h q̇'; its impulse λ [N·s or
//! N·m·s] acts along A's axis, and −ratio λ along B's:
//!
//! ```text
//! r = φ/h + q̇_A' − ratio q̇_B' = 0        (y · y) Δλ = −r
//! ```
//!
//! with y of [`factor`](super::factor), whose walks start with these two in place of wrenches. λ starts at that of
//! the last step.

use super::contact::rate;
use super::factor::{Path, response};
use super::tables::{Tables, dof};
use crate::tables::Filler;
use model::{Coupling, Model};
use numbers::machine::space::{Parameter, Scratch, State};
use numbers::machine::{Held, Hold, Index, Links};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real, Table};

/// Smallest response of a row.
const STIFFEST: f64 = 1e-12;

/// Fields of [`CouplingTables::links`].
mod coupling_link {
    /// Row of [`Tables::couple_links`].
    pub const COUPLE: usize = 0;
    /// First row of the coupling's entries.
    pub const ENTRY: usize = 1;
    /// Which of them is of A's degree of freedom, and which of B's.
    pub const START_A: usize = 2;
    pub const START_B: usize = 3;
    /// Degrees of freedom and coordinates of A and B.
    pub const DOF_A: usize = 4;
    pub const DOF_B: usize = 5;
    pub const COORDINATE_A: usize = 6;
    pub const COORDINATE_B: usize = 7;
    pub const WIDTH: usize = 8;
}

/// Fields of [`CouplingTables::row`].
mod row {
    /// r without what the impulses add.
    pub const RESIDUAL: usize = 0;
    // 1 / y · y follows.
    /// λ.
    pub const LAMBDA: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Layout of the couplings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CouplingTables {
    pub count: usize,
    /// Ratio, offset.
    coupling: Table<Parameter, 2>,
    /// See [`coupling_link`].
    links: Links<{ coupling_link::WIDTH }>,
    /// Force [N or N·m] along A's axis in the last step.
    force: Table<State>,
    /// See [`row`].
    row: Table<Scratch, { row::WIDTH }>,
    /// y, for each entry of each coupling.
    entry: Table<Scratch>,
}

/// Where a coupling's joints are, as the tables take it.
#[derive(Clone, Debug)]
pub(super) struct Coupled {
    /// Trees and rows of both joints' nodes.
    pub groups: [usize; 2],
    pub rows: [usize; 2],
    /// Pair of nodes, first row of its entries, and which of these are the joints' own.
    pub couple: usize,
    pub entry: usize,
    pub starts: [usize; 2],
}

impl CouplingTables {
    pub fn place(
        [count, entries]: [usize; 2],
        state: &mut usize,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> Self {
        Self {
            count,
            coupling: Table::place(parameters, count),
            links: Links::place(links, count),
            force: Table::place(state, count),
            row: Table::place(scratch, count),
            entry: Table::place(scratch, entries),
        }
    }

    /// Writes a row.
    pub(super) fn fill(
        &self,
        i: usize,
        at: &Coupled,
        model: &Model,
        coupling: &Coupling,
        f: &mut Filler,
    ) {
        f.numbers(self.coupling, i, 0, &[coupling.ratio, coupling.offset]);
        let joints = [coupling.joint, coupling.other];
        let [dof_a, dof_b] = joints.map(|j| model.dof_range(j).start);
        let [coordinate_a, coordinate_b] = joints.map(|j| model.coordinate_range(j).start);
        let links = [
            (coupling_link::COUPLE, at.couple),
            (coupling_link::ENTRY, at.entry),
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
        let force = k.load(t.couplings.force, c, 0);
        let a = k.link(t.couplings.links, c, coupling_link::DOF_A);
        let b = k.link(t.couplings.links, c, coupling_link::DOF_B);
        k.add(t.dof, a, dof::TAU, force);
        k.add(t.dof, b, dof::TAU, -(ratio * force));
    }
}

/// Residuals, y and responses of all couplings. Needs the accelerations under the forces of [`press`].
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
        let speed = ratio.fnma(speed(k, t, b, h), speed(k, t, a, h));
        let square = responses(k, t, c, ratio);
        let response = square.max(M::R::lit(STIFFEST)).recip();
        let lambda = k.load(t.couplings.force, c, 0) * h;
        let row = [error.fma(rate, speed), response, lambda];
        k.write(t.couplings.row, c, row::RESIDUAL, row);
    }
}

/// q̇ + h q̈.
#[inline(always)]
fn speed<M: Machine>(k: &M, t: &Tables, v: M::I, h: M::R) -> M::R {
    let faster = k.load(t.dof, v, dof::ACCELERATION);
    h.fma(faster, k.load(t.velocity, v, 0))
}

/// y; returns its square.
#[inline(always)]
fn responses<M: Machine>(k: &mut M, t: &Tables, c: M::I, ratio: M::R) -> M::R {
    let path = Path::of(k, t, k.link(t.couplings.links, c, coupling_link::COUPLE));
    let first = k.link(t.couplings.links, c, coupling_link::ENTRY);
    for i in path.entries(k) {
        k.store(t.couplings.entry, first.plus(i), 0, M::R::zero());
    }
    let start_a = k.link(t.couplings.links, c, coupling_link::START_A);
    let start_b = k.link(t.couplings.links, c, coupling_link::START_B);
    k.add(t.couplings.entry, first.plus(start_a), 0, M::R::one());
    k.add(t.couplings.entry, first.plus(start_b), 0, -ratio);
    let mut square = k.cell(M::R::zero());
    let mut a = Spatial::zero().hold(k);
    walk(k, t, path, first, path.own_of_a(k), &mut a, &mut square);
    let mut b = Spatial::zero().hold(k);
    walk(k, t, path, first, path.own_of_b(), &mut b, &mut square);
    let mut both = (a.get() + b.get()).hold(k);
    walk(k, t, path, first, path.shared(), &mut both, &mut square);
    square.read()
}

/// Walks inwards along some of a path's entries, which hold forces along their degrees of freedom and get y.
#[inline(always)]
fn walk<M: Machine>(
    k: &mut M,
    t: &Tables,
    path: Path<M::I>,
    first: M::I,
    [from, to]: [M::I; 2],
    wrench: &mut Spatial<M::Cell>,
    square: &mut M::Cell,
) {
    for i in k.range(from, to) {
        let v = path.dof(k, t, i);
        let own = k.load(t.couplings.entry, first.plus(i), 0);
        let along = k.spatial(t.dof, v, dof::AXIS).dot_plus(wrench.get(), own);
        let share = -(along * k.load(t.dof, v, dof::INVERSE));
        wrench.set(k.spatial(t.dof, v, dof::U).fma(share, wrench.get()));
        let y = along * k.load(t.response, v, response::ROOT);
        k.store(t.couplings.entry, first.plus(i), 0, y);
        square.write(y.fma(y, square.read()));
    }
}

/// One coupling of one pass, where `on` is 1; squares of the change of its impulse, and of the impulse.
#[inline(always)]
pub(super) fn relax<M: Machine>(k: &mut M, t: &Tables, c: M::I, on: M::R) -> (M::R, M::R) {
    let path = Path::of(k, t, k.link(t.couplings.links, c, coupling_link::COUPLE));
    let first = k.link(t.couplings.links, c, coupling_link::ENTRY);
    let [residual, response, lambda] = k.read(t.couplings.row, c, row::RESIDUAL);
    let mut r = k.cell(residual);
    for i in path.entries(k) {
        let z = k.load(t.response, path.dof(k, t, i), response::Z);
        let y = k.load(t.couplings.entry, first.plus(i), 0);
        r.write(y.fma(z, r.read()));
    }
    let step = -(r.read() * response * on);
    let lambda = lambda + step;
    k.store(t.couplings.row, c, row::LAMBDA, lambda);
    for i in path.entries(k) {
        let v = path.dof(k, t, i);
        let y = k.load(t.couplings.entry, first.plus(i), 0);
        k.add(t.response, v, response::Z, y * step);
    }
    (step.squared(), lambda.squared())
}

/// Keeps the forces of the step for the next.
#[inline(always)]
pub(super) fn keep<M: Machine>(k: &mut M, t: &Tables) {
    let rate = rate(k, t);
    for c in k.count(t.couplings.count) {
        let force = k.load(t.couplings.row, c, row::LAMBDA) * rate;
        k.store(t.couplings.force, c, 0, force);
    }
}

/// Forgets the forces of the lanes of `lost`.
#[inline(always)]
pub(super) fn forget<M: Machine>(k: &mut M, t: &Tables, lost: <M::R as Real>::Mask) {
    for c in k.count(t.couplings.count) {
        k.store_where(lost, t.couplings.force, c, 0, M::R::zero());
    }
}
