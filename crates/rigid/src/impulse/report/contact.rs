//! What is told of a contact: at each of its points the mean force and torque over the last step on the shape that moves.
//!
//! Friction pulls at the middle m of the points p with a drag d and a twist t, and is told of where they are loaded, in
//! proportion to their loads s; alike where a bounce has taken back what they bore:
//!
//! ```text
//! σ = s / Σ s     f = n s + d σ     τ = (t − Σ (p − m) σ × d) σ
//! ```

use super::super::memory::{REMEMBERED, remembered};
use super::super::sums::{Given, is_point, point, sum};
use super::super::tables::POINTS;
use super::ReportLengths;
use crate::output::contact as told;
use collide::FAR;
use numbers::machine::Links;
use numbers::machine::space::{Input, Output};
use numbers::{Machine, Real, Table, Vec3};

/// Whole numbers of a colliding shape.
pub mod collider {
    /// The shape in the model.
    pub const SHAPE: usize = 0;
    /// 1 where it does not move.
    pub const FIXED: usize = 1;
    /// Numbers in a row.
    pub const WIDTH: usize = 2;
}

/// Numbers that are told of a point: those of a row of contacts, then the torque.
const POINT: usize = told::WIDTH + 3;

/// Tables of [`tell_contact`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactReport {
    /// See [`remembered`].
    contact: Table<Input, { REMEMBERED }>,
    /// Length of the step that led here [s].
    long: Table<Input>,
    /// Of all colliding shapes: see [`collider`].
    colliders: Links<{ collider::WIDTH }>,
    /// The shapes in the model, the one that moves last.
    pub shapes: Table<Output, 2>,
    /// How many of the points there are.
    pub count: Table<Output>,
    /// [`POINTS`] rows: those of a row of contacts, then the torque.
    pub points: Table<Output, POINT>,
    /// How many there are.
    pub lengths: ReportLengths,
}

impl ContactReport {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut given, mut told) = (0, 0);
        let (given_end, told_end) = (&mut given, &mut told);
        let mut tables = Self {
            contact: Table::place(given_end, 1),
            long: Table::place(given_end, 1),
            colliders: Links::place(&mut 0, 0),
            shapes: Table::place(told_end, 1),
            count: Table::place(told_end, 1),
            points: Table::place(told_end, POINTS),
            lengths: ReportLengths::default(),
        };
        tables.lengths = ReportLengths {
            given,
            state: 0,
            told,
        };
        tables
    }
}

impl Default for ContactReport {
    fn default() -> Self {
        Self::new()
    }
}

/// Tells of a contact.
#[inline(always)]
pub fn tell_contact<M: Machine>(k: &mut M, t: &ContactReport) {
    let only = k.index(0);
    let (zero, one) = (M::R::zero(), M::R::one());
    let colliders = [0, 1].map(|i| k.whole(k.load(t.contact, only, remembered::SHAPES + i)));
    let shapes = colliders.map(|i| k.number(k.link(t.colliders, i, collider::SHAPE)));
    let fixed = k.number(k.link(t.colliders, colliders[1], collider::FIXED));
    let flips = fixed.gt(zero);
    let sign = M::R::select(flips, -one, one);
    let [a, b] = shapes;
    let shapes = [M::R::select(flips, b, a), M::R::select(flips, a, b)];
    k.write(t.shapes, only, 0, shapes);
    let count = k.load(t.contact, only, remembered::POINTS);
    k.store(t.count, only, 0, count);

    let given = Given::load(k, t.contact, only);
    let mut load = zero;
    for i in 0..POINTS {
        let own = k.load(t.contact, only, sum(i));
        load += M::R::select(is_point(k, t.contact, only, i), own, zero);
    }
    let shares = shares(k, t, load, count);
    let mut arm = Vec3::zero();
    for (i, share) in shares.into_iter().enumerate() {
        arm += (k.vec3(t.contact, only, point(i)) - given.middle) * share;
    }
    let torque = given.twist - arm.cross(given.drag);
    let rate = sign / k.load(t.long, only, 0);
    for (i, share) in shares.into_iter().enumerate() {
        let row = k.index(i);
        let [gap, feature]: [M::R; 2] = k.read(t.contact, only, point(i) + remembered::GAP);
        let gap = M::R::select(is_point(k, t.contact, only, i), gap, M::R::lit(FAR));
        let force = given.normal * k.load(t.contact, only, sum(i)) + given.drag * share;
        let position = k.vec3(t.contact, only, point(i));
        k.store_vec3(t.points, row, told::POSITION, position);
        k.store_vec3(t.points, row, told::NORMAL, given.normal * sign);
        k.write(t.points, row, told::DISTANCE, [gap, feature]);
        k.store_vec3(t.points, row, told::FORCE, force * rate);
        k.store_vec3(t.points, row, told::WIDTH, torque * (share * rate));
    }
}

/// σ of each point, 0 of one that is none, given Σ s and how many there are.
#[inline(always)]
fn shares<M: Machine>(k: &M, t: &ContactReport, load: M::R, count: M::R) -> [M::R; POINTS] {
    let (zero, one) = (M::R::zero(), M::R::one());
    let loaded = load.gt(zero);
    let (whole, alike) = (M::R::select(loaded, load, one), one / count.max(one));
    let mut shares = [zero; POINTS];
    for (i, share) in shares.iter_mut().enumerate() {
        let of_load = k.load(t.contact, k.index(0), sum(i)) / whole;
        let own = M::R::select(loaded, of_load, alike);
        *share = M::R::select(is_point(k, t.contact, k.index(0), i), own, zero);
    }
    shares
}
