//! What is told of a joint: its coordinates and their rates, what it gave in the last step, and the energy along its axes.
//!
//! With the impulse p and the angular impulse l at B's anchor, of which r is the way there from the child's joint frame, in
//! a step of length H:
//!
//! ```text
//! f = p / H     τ = (l + r × p) / H     V = Σ ½ k (θ − rest)²     T = Σ ½ m θ̇²
//! ```

use super::super::layout::state;
use super::super::report::ReportLengths;
use super::tables::{JointTables, ROWS, axis, joint};
use super::{Rows, TIED_STATE, apart, place_shifts, place_turns};
use crate::output::reaction;
use numbers::functions::wrap;
use numbers::machine::space::{Input, Output};
use numbers::spatial::Spatial;
use numbers::{Machine, Quat, Real, Table, Vec3};

/// Constants of a row, zeros where it is no degree of freedom.
pub(super) mod passive {
    /// What the coordinate is reckoned from [m or rad].
    pub const REFERENCE: usize = 0;
    /// Stiffness [N/m or N·m/rad] and rest [m or rad] of its spring, armature [kg or kg·m²].
    pub const SPRING: usize = 1;
    /// 1 where whole turns do not count.
    pub const TURNS: usize = 4;
    /// Numbers in a row.
    pub const WIDTH: usize = 5;
}

/// Tables of [`tell_tie`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TieReport {
    /// A and B: see [`state`].
    body: Table<Input, { state::WIDTH }>,
    /// What the joint carries from step to step.
    carried: Table<Input, TIED_STATE>,
    /// Length of the step that led here [s].
    long: Table<Input>,
    /// The first fields of [`joint`].
    constants: Table<Input, { joint::CONSTANTS }>,
    /// Origin of the child's joint frame in B's own [m].
    origin: Table<Input, 3>,
    /// [`ROWS`] rows: see [`passive`].
    row: Table<Input, { passive::WIDTH }>,
    /// What is worked with: a joint, and its axes.
    joint: JointTables,
    /// [`ROWS`] coordinates.
    pub value: Table<Output>,
    /// Their rates.
    pub rate: Table<Output>,
    /// The means of the rates of these over the last step.
    pub acceleration: Table<Output>,
    /// Orientation of the child's joint frame in the parent's.
    pub turn: Table<Output, 4>,
    /// See [`reaction`].
    pub reaction: Table<Output, { reaction::WIDTH }>,
    /// Of what moves along the axes, and of springs [J].
    pub energy: Table<Output, 2>,
    /// How many numbers there are.
    pub lengths: ReportLengths,
}

impl TieReport {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut given, mut told) = (0, 0);
        let (given_end, told_end) = (&mut given, &mut told);
        let joint = JointTables::new();
        let mut tables = Self {
            body: Table::place(given_end, 2),
            carried: Table::place(given_end, 1),
            long: Table::place(given_end, 1),
            constants: Table::place(given_end, 1),
            origin: Table::place(given_end, 1),
            row: Table::place(given_end, ROWS),
            value: Table::place(told_end, ROWS),
            rate: Table::place(told_end, ROWS),
            acceleration: Table::place(told_end, ROWS),
            turn: Table::place(told_end, 1),
            reaction: Table::place(told_end, 1),
            energy: Table::place(told_end, 1),
            lengths: ReportLengths::default(),
            joint,
        };
        tables.lengths = ReportLengths {
            given,
            // Without laws, which come last.
            state: joint.law.start(),
            told,
        };
        tables
    }
}

impl Default for TieReport {
    fn default() -> Self {
        Self::new()
    }
}

/// Tells of a joint.
#[inline(always)]
pub fn tell_tie<M: Machine>(k: &mut M, t: &TieReport) {
    let (only, a, b) = (k.index(0), k.index(0), k.index(1));
    let constants: [M::R; joint::CONSTANTS] = k.read(t.constants, only, 0);
    let carried: [M::R; TIED_STATE] = k.read(t.carried, only, 0);
    k.write(t.joint.joint, only, 0, constants);
    k.write(t.joint.joint, only, joint::TARGET, carried);
    // Coordinates of a ball are its turn, not what is left to its target.
    k.store_quat(t.joint.joint, only, joint::TARGET, Quat::identity());

    let (qa, qb) = (
        k.quat(t.body, a, state::ORIENTATION),
        k.quat(t.body, b, state::ORIENTATION),
    );
    let anchor = k.vec3(t.joint.joint, only, joint::ANCHOR_B);
    let rb = qb.rotate(anchor);
    let ra = k.vec3(t.body, b, state::CENTER) - k.vec3(t.body, a, state::CENTER) + rb;
    let gap = ra - qa.rotate(k.vec3(t.joint.joint, only, joint::ANCHOR_A));
    place_turns(k, &t.joint, qa, qb);
    place_shifts(k, &t.joint, qa, gap);
    tell_rows(k, t, [ra, rb]);

    let frame_a = qa * k.quat(t.joint.joint, only, joint::FRAME_A);
    let frame_b = qb * k.quat(t.joint.joint, only, joint::FRAME_B);
    k.store_quat(t.turn, only, 0, frame_a.conjugate() * frame_b);
    let long = k.load(t.long, only, 0);
    let given = k.spatial(t.joint.joint, only, joint::SUM) * (M::R::one() / long);
    let arm = qb.rotate(anchor - k.vec3(t.origin, only, 0));
    let torque = given.angular + arm.cross(given.linear);
    k.store_vec3(t.reaction, only, reaction::FORCE, given.linear);
    k.store_vec3(t.reaction, only, reaction::TORQUE, torque);
}

/// Coordinates, rates, and the energy along them.
#[inline(always)]
fn tell_rows<M: Machine>(k: &mut M, t: &TieReport, arms: [Vec3<M::R>; 2]) {
    let only = k.index(0);
    let half = M::R::lit(0.5);
    let [now, before] = [state::VELOCITY, state::BEFORE].map(|field| motions(k, t, field));
    let changes = [now[0] - before[0], now[1] - before[1]];
    let rows = Rows::load(k, &t.joint);
    // Of the change, not the change of rates, which are rounded.
    let [rates, changes] = [now, changes].map(|of| rows.rates(apart(of, arms)).to_array());
    let long = k.load(t.long, only, 0);
    let (mut kinetic, mut potential) = (M::R::zero(), M::R::zero());
    for i in 0..ROWS {
        let row = k.index(i);
        let [stiffness, rest, armature] = k.read(t.row, row, passive::SPRING);
        let turns = k.load(t.row, row, passive::TURNS).gt(M::R::zero());
        let reference = k.load(t.row, row, passive::REFERENCE);
        let value = k.load(t.joint.axis, row, axis::VALUE) + reference;
        k.store(t.value, row, 0, M::R::select(turns, wrap(value), value));
        k.store(t.rate, row, 0, rates[i]);
        k.store(t.acceleration, row, 0, changes[i] / long);
        kinetic += half * armature * rates[i].squared();
        potential += half * stiffness * (value - rest).squared();
    }
    k.write(t.energy, only, 0, [kinetic, potential]);
}

/// Spins and velocities of A and B, of which those begin with this field.
#[inline(always)]
fn motions<M: Machine>(k: &M, t: &TieReport, field: usize) -> [Spatial<M::R>; 2] {
    [0, 1].map(|body| {
        let body = k.index(body);
        let spin = k.vec3(t.body, body, field + 3);
        Spatial::new(spin, k.vec3(t.body, body, field))
    })
}
