//! The contacts of the last step, kept in the state: to be reported, and to start the next step with.

use crate::output::contact;
use collide::FAR;
use numbers::machine::space::{Output, State};
use numbers::{Machine, Real, Table, Vec3};

/// Fields of a row.
mod row {
    // Point, 3, in the world; unit normal, 3.
    pub const FEATURE: usize = 6;
    /// Force, 3.
    pub const FORCE: usize = 7;
    pub const WIDTH: usize = 10;
}

/// A point of contact.
#[derive(Clone, Copy)]
pub(crate) struct Touch<R> {
    /// Midway between the surfaces, in the world [m].
    pub position: Vec3<R>,
    pub normal: Vec3<R>,
    /// Gap [m], or [`FAR`] where there is no contact.
    pub distance: R,
    pub feature: R,
    /// On the shape that the normal points to [N].
    pub force: Vec3<R>,
}

/// A row for each slot, and its distance apart from the others, as that is all that most slots are asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept {
    slots: usize,
    distance: Table<State>,
    row: Table<State, { row::WIDTH }>,
}

impl Kept {
    pub fn place(end: &mut usize, slots: usize) -> Self {
        Self {
            slots,
            distance: Table::place(end, slots),
            row: Table::place(end, slots),
        }
    }
    /// No contacts.
    pub fn initial(&self, state: &mut [f64]) {
        state[self.distance.start()..][..self.slots].fill(FAR);
    }
    /// True where there was a contact.
    #[inline(always)]
    pub fn known<M: Machine>(&self, k: &M, s: M::I) -> <M::R as Real>::Mask {
        touches(k.load(self.distance, s, 0))
    }
    /// Force [N], where there was a contact.
    #[inline(always)]
    pub fn force<M: Machine>(&self, k: &M, s: M::I) -> Vec3<M::R> {
        k.vec3(self.row, s, row::FORCE)
    }
    /// True where there was a contact of the same features.
    #[inline(always)]
    pub fn same<M: Machine>(&self, k: &M, s: M::I, feature: M::R) -> <M::R as Real>::Mask {
        self.known(k, s) & feature.same(k.load(self.row, s, row::FEATURE))
    }
    /// All of a slot.
    #[inline(always)]
    pub fn touch<M: Machine>(&self, k: &M, s: M::I) -> Touch<M::R> {
        let [x, y, z, l, m, n, feature, fx, fy, fz] = k.read(self.row, s, 0);
        Touch {
            position: Vec3::new(x, y, z),
            normal: Vec3::new(l, m, n),
            distance: k.load(self.distance, s, 0),
            feature,
            force: Vec3::new(fx, fy, fz),
        }
    }
    /// Takes a contact for that of the last step.
    #[inline(always)]
    pub fn keep<M: Machine>(&self, k: &mut M, s: M::I, touch: Touch<M::R>) {
        let ([x, y, z], [l, m, n]) = (touch.position.to_array(), touch.normal.to_array());
        let [fx, fy, fz] = touch.force.to_array();
        k.store(self.distance, s, 0, touch.distance);
        let row = [x, y, z, l, m, n, touch.feature, fx, fy, fz];
        k.write(self.row, s, 0, row);
    }
    /// Forgets all contacts.
    #[inline(always)]
    pub fn clear<M: Machine>(&self, k: &mut M) {
        for s in k.count(self.slots) {
            k.store(self.distance, s, 0, M::R::lit(FAR));
        }
    }
    /// Forgets the contacts of the lanes of `lost`, whose numbers may be none.
    #[inline(always)]
    pub fn forget<M: Machine>(&self, k: &mut M, lost: <M::R as Real>::Mask) {
        let zero = M::R::zero();
        for s in k.count(self.slots) {
            k.store_where(lost, self.distance, s, 0, M::R::lit(FAR));
            for i in 0..row::WIDTH {
                k.store_where(lost, self.row, s, i, zero);
            }
        }
    }
    /// Copies the contacts to the output; of slots that are free, only that they are.
    #[inline(always)]
    pub fn report<M: Machine>(&self, k: &mut M, output: Table<Output, { contact::WIDTH }>) {
        for s in k.count(self.slots) {
            let distance = k.load(self.distance, s, 0);
            k.store(output, s, contact::DISTANCE, distance);
            if let Some(_branch) = k.if_any(touches(distance)) {
                let touch = self.touch(k, s);
                k.store_vec3(output, s, contact::POSITION, touch.position);
                k.store_vec3(output, s, contact::NORMAL, touch.normal);
                k.store(output, s, contact::FEATURE, touch.feature);
                k.store_vec3(output, s, contact::FORCE, touch.force);
            }
        }
    }
}

/// Copies torques of contacts to the output, where it has room for them; those of slots that are free are zero.
#[inline(always)]
pub(crate) fn report_torques<M: Machine>(
    k: &mut M,
    kept: &Kept,
    (torques, slots): (Table<State, 3>, usize),
    output: Option<Table<Output, 3>>,
) {
    if let Some(output) = output {
        for s in k.count(slots) {
            let torque = Vec3::select(kept.known(k, s), k.vec3(torques, s, 0), Vec3::zero());
            k.store_vec3(output, s, 0, torque);
        }
    }
}

/// Forgets the torques of contacts of the lanes of `lost`.
#[inline(always)]
pub(crate) fn forget_torques<M: Machine>(
    k: &mut M,
    (torques, slots): (Table<State, 3>, usize),
    lost: <M::R as Real>::Mask,
) {
    for s in k.count(slots) {
        let torque = Vec3::select(lost, Vec3::zero(), k.vec3(torques, s, 0));
        k.store_vec3(torques, s, 0, torque);
    }
}

/// True where a distance is not that of a slot that is free.
#[inline(always)]
pub(crate) fn touches<R: Real>(distance: R) -> R::Mask {
    distance.lt(R::lit(0.5 * FAR))
}
