//! Rows that hold positions, of joints that close loops and of couplings, solved all at once.
//!
//! Each row has a residual r, what is left of it at the end of the step [m/s or rad/s], and y of
//! [`factor`](super::factor). The impulses λ of all rows together make r zero:
//!
//! ```text
//! r + Y z + α/h² λ = 0        (Y Yᵀ + α/h² 1) Δλ = −(r + Y z + α/h² λ)
//! ```
//!
//! z being what these and the contacts have added so far. Contacts and these rows take turns, a pass each
//! (`gauss_seidel`); that all rows are solved as one, and last, is what keeps them: one after the other, as contacts
//! are, two joints that share a body converge slowly, and λ of the last step, with which a step begins, brings what
//! was missed back larger.
//!
//! The matrix is factored row by row, L D Lᵀ. What of a row no row before it has is its d; where that is as small as
//! rounding, the row hangs on those before it (the tree, or the rest of a loop, holds it already) and is left out:
//! its impulse is zero. Time grows with the cube of the number of rows.
//!
//! Where d is small, what r leaves out, of third order, grows too large. A taut chain that sags by an angle θ has a
//! row with d ~ θ²/m along itself and b = φ/h + ½ h J̇ q̇ ~ ℓ θ²/h, so that the tension r/(h d) of a step is ~ m ℓ/h²
//! however little it sags; but a tension T turns a link like a spring T/ℓ, which steps of h follow only where
//! T ≪ 4 m ℓ/h², and the chain would be whipped until it flies apart. So b moves a row by impulses of no more than
//! m ℓ/(10 h):
//!
//! ```text
//! d ← max(d, min(1, 10 h |b|/ℓ)/m)
//! ```
//!
//! with ℓ and m of a mean body of what is tied together, and b less what the rows before leave of it. What is added to
//! d is α/h² of the row for this step: the damping of Levenberg and Marquardt, which vanishes with the residual and so
//! leaves its order (Yamashita & Fukushima 2001). Rows that move a mean body as a whole, d ≥ 1/m, never have any.

use super::contact::rate;
use super::factor::{Keep, Path, response};
use super::tables::Tables;
use crate::tables::Filler;
use numbers::machine::space::{Parameter, Scratch, State};
use numbers::machine::{Index, Links};
use numbers::{Cell, Float, Machine, Real, Table, Vec3};

/// Share of a response that is rounding.
const NOTHING: [f64; 2] = [2e-5, 1e-11];

/// Fields of [`LockedTables::links`].
mod locked_link {
    /// Row of [`Tables::couple_links`].
    pub const COUPLE: usize = 0;
    /// First of the row's y.
    pub const ENTRY: usize = 1;
    /// First entry of the matrix's row.
    pub const BEGIN: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Fields of [`LockedTables::law`].
mod law {
    /// α/h².
    pub const SOFTNESS: usize = 0;
    /// A response of which a share is as good as none.
    pub const RESPONSE: usize = 1;
    /// 1/m, and 10 h/ℓ.
    pub const FLOOR: usize = 2;
    pub const WIDTH: usize = 4;
}

/// Fields of [`LockedTables::row`].
mod row {
    /// r without what the impulses add.
    pub const RESIDUAL: usize = 0;
    /// λ.
    pub const LAMBDA: usize = 1;
    /// b, until the matrix is factored; −Δλ, while it is solved for.
    pub const STEP: usize = 2;
    /// α/h², and what damps the row.
    pub const SOFTNESS: usize = 3;
    pub const WIDTH: usize = 4;
}

/// Layout of the rows. One more than there are takes what nobody asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LockedTables {
    pub count: usize,
    /// See [`locked_link`].
    links: Links<{ locked_link::WIDTH }>,
    /// See [`law`].
    law: Table<Parameter, { law::WIDTH }>,
    /// λ/h [N or N·m] of the last step.
    force: Table<State>,
    /// See [`row`].
    row: Table<Scratch, { row::WIDTH }>,
    /// y, an entry for each degree of freedom on the path of each row.
    entry: Table<Scratch>,
    /// Y Yᵀ + α/h², then its factor: L below the diagonal, 1/d on it; lower triangle, by rows.
    matrix: Table<Scratch>,
}

/// A row, as the tables take it.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Locked {
    /// Pair of nodes, and first of the row's y.
    pub couple: usize,
    pub entry: usize,
    pub law: Law,
}

/// See [`law`].
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Law {
    /// α/h².
    pub softness: f64,
    /// Response of what moves freely.
    pub response: f64,
    /// 1/m, and 10 h/ℓ; 1/m is zero for a row whose directions stay.
    pub floor: [f64; 2],
}

impl LockedTables {
    pub fn place(
        [count, entries]: [usize; 2],
        state: &mut usize,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> Self {
        let rows = if count > 0 { count + 1 } else { 0 };
        Self {
            count,
            links: Links::place(links, rows),
            law: Table::place(parameters, rows),
            force: Table::place(state, rows),
            row: Table::place(scratch, rows),
            entry: Table::place(scratch, entries),
            matrix: Table::place(scratch, count * (count + 1) / 2),
        }
    }

    pub(super) fn fill(&self, i: usize, locked: &Locked, f: &mut Filler) {
        let Law {
            softness,
            response,
            floor: [floor, rate],
        } = locked.law;
        f.numbers(self.law, i, 0, &[softness, response, floor, rate]);
        f.link(self.links, i, locked_link::COUPLE, locked.couple);
        f.link(self.links, i, locked_link::ENTRY, locked.entry);
        f.link(self.links, i, locked_link::BEGIN, i * (i + 1) / 2);
    }

    /// λ/h of a row in the last step.
    #[inline(always)]
    pub(super) fn force<M: Machine>(&self, k: &M, row: M::I) -> M::R {
        k.load(self.force, row, 0)
    }
    /// The same of three rows.
    #[inline(always)]
    pub(super) fn forces<M: Machine>(&self, k: &M, [x, y, z]: [M::I; 3]) -> Vec3<M::R> {
        Vec3::new(self.force(k, x), self.force(k, y), self.force(k, z))
    }
    /// Sets what is left of a row, and its b.
    #[inline(always)]
    pub(super) fn remains<M: Machine>(&self, k: &mut M, row: M::I, residual: M::R, bent: M::R) {
        k.store(self.row, row, row::RESIDUAL, residual);
        k.store(self.row, row, row::STEP, bent);
    }
    /// Adds to what is left of a row.
    #[inline(always)]
    pub(super) fn gains<M: Machine>(&self, k: &mut M, row: M::I, more: M::R) {
        k.add(self.row, row, row::RESIDUAL, more);
    }
    /// y of a row.
    #[inline(always)]
    pub(super) fn entry<M: Machine>(&self, k: &M, row: M::I, i: M::I) -> M::R {
        let first = k.link(self.links, row, locked_link::ENTRY);
        k.load(self.entry, first.plus(i), 0)
    }
    /// Sets y of a row.
    #[inline(always)]
    pub(super) fn set_entry<M: Machine>(&self, k: &mut M, row: M::I, i: M::I, y: M::R) {
        let first = k.link(self.links, row, locked_link::ENTRY);
        k.store(self.entry, first.plus(i), 0, y);
    }
}

/// Three rows, where their y are kept.
impl<M: Machine> Keep<M> for (LockedTables, [M::I; 3]) {
    #[inline(always)]
    fn keep(&self, k: &mut M, i: M::I, y: Vec3<M::R>) {
        let (t, [a, b, c]) = *self;
        t.set_entry(k, a, i, y.x);
        t.set_entry(k, b, i, y.y);
        t.set_entry(k, c, i, y.z);
    }
}

#[inline(always)]
fn path<M: Machine>(k: &M, t: &Tables, row: M::I) -> Path<M::I> {
    Path::of(k, t, k.link(t.locked.links, row, locked_link::COUPLE))
}

/// The matrix and its factor, given all y, and λ of the last step, which acts already; what rows that are left out
/// had is taken back.
#[inline(always)]
pub(super) fn begin<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for p in k.count(t.locked.count) {
        respond(k, t, p);
    }
    for p in k.count(t.locked.count) {
        factor(k, t, p);
    }
    let zero = M::R::zero();
    for p in k.count(t.locked.count) {
        let begin = k.link(t.locked.links, p, locked_link::BEGIN);
        let lambda = k.load(t.locked.force, p, 0) * h;
        let out = k.load(t.locked.matrix, begin.plus(p), 0).same(zero);
        let kept = M::R::select(out, zero, lambda);
        k.store(t.locked.row, p, row::LAMBDA, kept);
        push(k, t, p, kept - lambda);
    }
}

/// A row of Y Yᵀ + α/h², up to the diagonal: its y are laid out by degree of freedom for the purpose.
#[inline(always)]
fn respond<M: Machine>(k: &mut M, t: &Tables, p: M::I) {
    let own = path(k, t, p);
    for i in own.entries(k) {
        let y = t.locked.entry(k, p, i);
        k.store(t.response, own.dof(k, t, i), response::ROW, y);
    }
    let begin = k.link(t.locked.links, p, locked_link::BEGIN);
    for q in k.range(k.index(0), p.offset(1)) {
        let other = path(k, t, q);
        let mut sum = k.cell(M::R::zero());
        for i in other.entries(k) {
            let y = k.load(t.response, other.dof(k, t, i), response::ROW);
            sum.write(t.locked.entry(k, q, i).fma(y, sum.read()));
        }
        k.store(t.locked.matrix, begin.plus(q), 0, sum.read());
    }
    k.add(
        t.locked.matrix,
        begin.plus(p),
        0,
        k.load(t.locked.law, p, law::SOFTNESS),
    );
    for i in own.entries(k) {
        let v = own.dof(k, t, i);
        k.store(t.response, v, response::ROW, M::R::zero());
    }
}

/// Factors a row: L D from the rows before, then L, what is left of b, and d.
#[inline(always)]
fn factor<M: Machine>(k: &mut M, t: &Tables, p: M::I) {
    let matrix = t.locked.matrix;
    let begin = k.link(t.locked.links, p, locked_link::BEGIN);
    for q in k.range(k.index(0), p) {
        let other = k.link(t.locked.links, q, locked_link::BEGIN);
        let mut x = k.cell(k.load(matrix, begin.plus(q), 0));
        for i in k.range(k.index(0), q) {
            let l = k.load(matrix, other.plus(i), 0);
            x.write(l.fnma(k.load(matrix, begin.plus(i), 0), x.read()));
        }
        k.store(matrix, begin.plus(q), 0, x.read());
    }
    let whole = k.load(matrix, begin.plus(p), 0);
    let mut d = k.cell(whole);
    let mut bent = k.cell(k.load(t.locked.row, p, row::STEP));
    for q in k.range(k.index(0), p) {
        let other = k.link(t.locked.links, q, locked_link::BEGIN);
        let scaled = k.load(matrix, begin.plus(q), 0);
        let l = scaled * k.load(matrix, other.plus(q), 0);
        k.store(matrix, begin.plus(q), 0, l);
        d.write(l.fnma(scaled, d.read()));
        bent.write(l.fnma(k.load(t.locked.row, q, row::STEP), bent.read()));
    }
    let bent = bent.read();
    k.store(t.locked.row, p, row::STEP, bent);
    let share = NOTHING[usize::from(<M::R as Real>::Scalar::DOUBLE)];
    let least = k.load(t.locked.law, p, law::RESPONSE).max(whole) * M::R::lit(share);
    let d = d.read();
    let says = d.gt(least);
    let softness = k.load(t.locked.law, p, law::SOFTNESS);
    let [floor, strain] = k.read(t.locked.law, p, law::FLOOR);
    let floor = (bent.abs() * strain).min(M::R::one()) * floor;
    let damping = (floor - d).max(M::R::zero());
    k.store(t.locked.row, p, row::SOFTNESS, softness + damping);
    let inverse = M::R::select(says, d + damping, M::R::one()).recip();
    let inverse = M::R::select(says, inverse, M::R::zero());
    k.store(matrix, begin.plus(p), 0, inverse);
}

/// Adds an impulse of a row to z.
#[inline(always)]
fn push<M: Machine>(k: &mut M, t: &Tables, p: M::I, lambda: M::R) {
    let path = path(k, t, p);
    for i in path.entries(k) {
        let more = t.locked.entry(k, p, i) * lambda;
        k.add(t.response, path.dof(k, t, i), response::Z, more);
    }
}

/// All rows, in one pass, where `on` is 1; squares of the largest change of an impulse, and of the largest impulse.
#[inline(always)]
pub(super) fn solve<M: Machine>(k: &mut M, t: &Tables, on: M::R) -> (M::R, M::R) {
    for p in k.count(t.locked.count) {
        let path = path(k, t, p);
        let [residual, lambda] = k.read(t.locked.row, p, row::RESIDUAL);
        let softness = k.load(t.locked.row, p, row::SOFTNESS);
        let mut r = k.cell(softness.fma(lambda, residual));
        for i in path.entries(k) {
            let z = k.load(t.response, path.dof(k, t, i), response::Z);
            r.write(t.locked.entry(k, p, i).fma(z, r.read()));
        }
        // L x = r, row by row.
        let begin = k.link(t.locked.links, p, locked_link::BEGIN);
        for q in k.range(k.index(0), p) {
            let l = k.load(t.locked.matrix, begin.plus(q), 0);
            r.write(l.fnma(k.load(t.locked.row, q, row::STEP), r.read()));
        }
        k.store(t.locked.row, p, row::STEP, r.read());
    }
    for p in k.count(t.locked.count) {
        let begin = k.link(t.locked.links, p, locked_link::BEGIN);
        let inverse = k.load(t.locked.matrix, begin.plus(p), 0);
        let x = k.load(t.locked.row, p, row::STEP) * inverse;
        k.store(t.locked.row, p, row::STEP, x);
    }
    // Lᵀ x = D⁻¹ …, and what comes of it.
    let mut change = k.cell(M::R::zero());
    let mut most = k.cell(M::R::zero());
    for p in k.range_down(k.index(t.locked.count)) {
        let begin = k.link(t.locked.links, p, locked_link::BEGIN);
        let [lambda, x] = k.read(t.locked.row, p, row::LAMBDA);
        for q in k.range(k.index(0), p) {
            let l = k.load(t.locked.matrix, begin.plus(q), 0);
            let less = l.fnma(x, k.load(t.locked.row, q, row::STEP));
            k.store(t.locked.row, q, row::STEP, less);
        }
        let step = -(x * on);
        let lambda = lambda + step;
        k.store(t.locked.row, p, row::LAMBDA, lambda);
        push(k, t, p, step);
        change.write(change.read().max(step.squared()));
        most.write(most.read().max(lambda.squared()));
    }
    (change.read(), most.read())
}

/// Keeps the forces of the step for the next, and to be reported.
#[inline(always)]
pub(super) fn keep<M: Machine>(k: &mut M, t: &Tables) {
    let rate = rate(k, t);
    for p in k.count(t.locked.count) {
        let force = k.load(t.locked.row, p, row::LAMBDA) * rate;
        k.store(t.locked.force, p, 0, force);
    }
}

/// Forgets the forces of the lanes of `lost`.
#[inline(always)]
pub(super) fn forget<M: Machine>(k: &mut M, t: &Tables, lost: <M::R as Real>::Mask) {
    for p in k.count(t.locked.count) {
        k.store_where(lost, t.locked.force, p, 0, M::R::zero());
    }
}
