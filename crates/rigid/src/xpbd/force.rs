//! Forces on free bodies that a controller sets, applied after their flight.
//!
//! Those along coordinates, and torques on balls, act with the laws: see `laws`.

use super::body::inverse_inertias;
use super::joint::Ends;
use super::tables::Tables;
use numbers::machine::Index;
use numbers::{Cell, Machine, Real};

/// Applies the forces of all free joints over a substep. Nothing is computed where no lane has one.
#[inline(always)]
pub(crate) fn forces<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let mut most = k.cell(M::R::zero());
    for i in k.count(t.frees) {
        let v = k.link(t.free_links, i, 2);
        for x in k.read::<_, 1, 6>(t.input.force, v, 0) {
            most.write(most.read().max(x.abs()));
        }
    }
    let none = most.read().same(M::R::zero());
    if let Some(_branch) = k.if_any(!none) {
        inverse_inertias(k, t);
        for i in k.count(t.frees) {
            free(k, t, i, h);
        }
    }
}

/// Force at a free joint's frame, in the parent's joint axes, and torque in the child's.
#[inline(always)]
fn free<M: Machine>(k: &mut M, t: &Tables, i: M::I, h: M::R) {
    let j = k.link(t.free_links, i, 0);
    let v = k.link(t.free_links, i, 2);
    let force = k.vec3(t.input.force, v, 0);
    let torque = k.vec3(t.input.force, v.offset(3), 0);
    let none = (force.length_squared() + torque.length_squared()).same(M::R::zero());
    let (ends, h2) = (Ends::load(k, t, j), h.squared());
    let (qa, qb) = ends.frames(k, t, j);
    let (_, rb, _) = ends.arms(k, t, j);
    let (linear, angular) = (qa.rotate(force) * h2, qb.rotate(torque) * h2);
    let mut pushed = ends;
    pushed.push(linear, angular, rb, h.recip());
    // A push of nothing would round.
    pushed.unless(none, ends).store(k, t);
}
