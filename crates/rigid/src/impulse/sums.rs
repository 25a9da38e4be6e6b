//! What a contact gave in a step that was cut into parts.
//!
//! It gives loads s along its normal n at its points p, and, at their middle m, friction: a drag d and a twist t. About
//! a place o that is
//!
//! ```text
//! P = d + Σ n s     L = t + (m − o) × d + Σ (p − o) × n s
//! ```
//!
//! What it gave in the parts before, P' and L' about m, comes to it: loads to the nearest points, and to friction what
//! keeps force and torque the same, as points and normals have moved:
//!
//! ```text
//! s ← s + Σ s'     d ← P + P' − Σ n s     t ← L + L' − Σ (p − m) × n s
//! ```

use super::memory::{REMEMBERED, remembered};
use super::tables::POINTS;
use numbers::machine::space::{Space, State};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real, Table, Vec3};

/// Tables of [`add`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SumTables {
    /// The contact now, and what it was in the part before: see [`remembered`].
    pub contact: Table<State, { REMEMBERED }>,
}

impl SumTables {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        Self {
            contact: Table::place(&mut 0, 2),
        }
    }
}

impl Default for SumTables {
    fn default() -> Self {
        Self::new()
    }
}

/// A contact as it stands in its row.
pub(super) struct Given<R: Real> {
    pub normal: Vec3<R>,
    pub middle: Vec3<R>,
    pub drag: Vec3<R>,
    pub twist: Vec3<R>,
}

/// Field of a point: its position, gap, feature.
pub(super) fn point(i: usize) -> usize {
    remembered::POINT + i * remembered::POINT_WIDTH
}
/// Field of what it gave.
pub(super) fn sum(i: usize) -> usize {
    point(i) + remembered::SUM
}

/// Whether a row has so many points.
#[inline(always)]
pub(super) fn is_point<M: Machine, S: Space>(
    k: &M,
    contact: Table<S, { REMEMBERED }>,
    row: M::I,
    i: usize,
) -> <M::R as Real>::Mask {
    M::R::lit(i as f64).lt(k.load(contact, row, remembered::POINTS))
}

impl<R: Real> Given<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>, S: Space>(
        k: &M,
        contact: Table<S, { REMEMBERED }>,
        row: M::I,
    ) -> Self {
        let mut middle = Vec3::zero();
        for i in 0..POINTS {
            let share = R::select(is_point(k, contact, row, i), R::one(), R::zero());
            middle += k.vec3(contact, row, point(i)) * share;
        }
        let count = k.load(contact, row, remembered::POINTS).max(R::one());
        Self {
            normal: k.vec3(contact, row, remembered::NORMAL),
            middle: middle * (R::one() / count),
            drag: k.vec3(contact, row, remembered::DRAG_SUM),
            twist: k.vec3(contact, row, remembered::TWIST_SUM),
        }
    }
    /// L and P about a place, of the loads that stand in the row.
    #[inline(always)]
    fn about<M: Machine<R = R>>(
        &self,
        k: &M,
        t: &SumTables,
        row: M::I,
        place: Vec3<R>,
    ) -> Spatial<R> {
        let turning = self.twist + (self.middle - place).cross(self.drag);
        let mut all = Spatial::new(turning, self.drag);
        for i in 0..POINTS {
            let load = k.load(t.contact, row, sum(i));
            let load = R::select(is_point(k, t.contact, row, i), load, R::zero());
            let load = self.normal * load;
            let arm = k.vec3(t.contact, row, point(i)) - place;
            all = all + Spatial::new(arm.cross(load), load);
        }
        all
    }
}

/// Adds to a contact what it gave in the parts before.
#[inline(always)]
pub fn add<M: Machine>(k: &mut M, t: &SumTables) {
    let (now, before) = (k.index(0), k.index(1));
    let own = Given::load(k, t.contact, now);
    let other = Given::load(k, t.contact, before);
    let place = own.middle;
    let all = own.about(k, t, now, place) + other.about(k, t, before, place);
    for j in 0..POINTS {
        share_out(k, t, j);
    }
    let loads = Given {
        drag: Vec3::zero(),
        twist: Vec3::zero(),
        ..own
    };
    let rest = all - loads.about(k, t, now, place);
    k.store_vec3(t.contact, now, remembered::DRAG_SUM, rest.linear);
    k.store_vec3(t.contact, now, remembered::TWIST_SUM, rest.angular);
}

/// Gives the load of a point of before to the nearest one of now.
#[inline(always)]
fn share_out<M: Machine>(k: &mut M, t: &SumTables, j: usize) {
    let (now, before) = (k.index(0), k.index(1));
    let load = k.load(t.contact, before, sum(j));
    let load = M::R::select(is_point(k, t.contact, before, j), load, M::R::zero());
    let place = k.vec3(t.contact, before, point(j));
    let (mut least, mut nearest) = (k.cell(M::R::lit(FAR)), k.cell(M::R::zero()));
    for i in 0..POINTS {
        let apart = (k.vec3(t.contact, now, point(i)) - place).length_squared();
        let nearer = is_point(k, t.contact, now, i) & apart.lt(least.read());
        least.write(M::R::select(nearer, apart, least.read()));
        nearest.write(M::R::select(nearer, M::R::lit(i as f64), nearest.read()));
    }
    for i in 0..POINTS {
        let takes = nearest.read().same(M::R::lit(i as f64));
        let had = k.load(t.contact, now, sum(i));
        k.store(t.contact, now, sum(i), M::R::select(takes, had + load, had));
    }
}

/// Farther than any two points, squared [m²].
const FAR: f64 = 1e30;
