//! Generalised forces that a controller sets, applied at the start of a substep.
//!
//! Nothing is computed where no lane has a force.

use super::axis::{Pull, measure};
use super::body::inverse_inertias;
use super::joint::Ends;
use super::laws::record;
use super::tables::{Tables, axis_link, group_link};
use numbers::machine::Index;
use numbers::{Cell, Machine, Real, Vec3};

/// Applies all generalised forces over a substep.
#[inline(always)]
pub(crate) fn forces<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let mut most = k.cell(M::R::zero());
    for v in k.count(t.input.dofs()) {
        let force = k.load(t.input.force, v, 0).abs();
        most.write(most.read().max(force));
    }
    let none = most.read().same(M::R::zero());
    for _ in k.if_any(!none) {
        inverse_inertias(k, t);
        for g in k.count(t.groups) {
            axes(k, t, g, h);
        }
        for i in k.count(t.balls) {
            ball(k, t, i, h);
        }
        for i in k.count(t.frees) {
            free(k, t, i, h);
        }
    }
}

/// Forces along the axes of one joint.
#[inline(always)]
fn axes<M: Machine>(k: &mut M, t: &Tables, g: M::I, h: M::R) {
    let first = k.link(t.group_links, g, group_link::FIRST);
    let count = k.link(t.group_links, g, group_link::LINEAR);
    let count = count.plus(k.link(t.group_links, g, group_link::ANGULAR));
    for row in k.range(first, first.plus(count)) {
        let v = k.link(t.axis_links, row, axis_link::DOF);
        for _ in k.when(k.less(v, k.index(t.input.dofs()))) {
            let force = k.load(t.input.force, v, 0);
            let none = force.same(M::R::zero());
            for _ in k.if_any(!none) {
                for _ in k.when(k.less(k.index(t.tracked), g.offset(1))) {
                    measure(k, t, g);
                }
                let j = k.link(t.axis_links, row, axis_link::JOINT);
                let mut ends = Ends::load(k, t, j);
                let pull = Pull::load(k, t, row);
                pull.kick(&mut ends, force * h);
                ends.store(k, t);
                record(k, t, j, pull, force * h.squared());
            }
        }
    }
}

/// Torque on a ball's child, in the child's joint axes.
#[inline(always)]
fn ball<M: Machine>(k: &mut M, t: &Tables, i: M::I, h: M::R) {
    let j = k.link(t.ball_links, i, 0);
    let torque = k.vec3(t.input.force, k.link(t.ball_links, i, 2), 0);
    let none = torque.length_squared().same(M::R::zero());
    for _ in k.if_any(!none) {
        let mut ends = Ends::load(k, t, j);
        let (_, qb) = ends.frames(k, t, j);
        ends.kick(Vec3::zero(), qb.rotate(torque) * h, Vec3::zero());
        ends.store(k, t);
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
    for _ in k.if_any(!none) {
        let mut ends = Ends::load(k, t, j);
        let (qa, qb) = ends.frames(k, t, j);
        let (_, rb, _) = ends.arms(k, t, j);
        ends.kick(qa.rotate(force) * h, qb.rotate(torque) * h, rb);
        ends.store(k, t);
    }
}
