//! What a world looks like from outside.

use super::axis::{Pull, measure};
use super::joint::Ends;
use super::reaction::{clear, through};
use super::tables::{
    Tables, axis_field, axis_link, body_link, global, inbound, joint_link, mass, row_link,
};
use crate::contacts::report_torques;
use crate::output::{body, body_acceleration, reaction, total};
use numbers::functions::wrap;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real, Vec3};

/// Fills the output of every lane from its state. Changes no state.
#[inline(always)]
pub(crate) fn report<M: Machine>(k: &mut M, t: &Tables) {
    contacts(k, t);
    body_accelerations(k, t);
    reactions(k, t);
    sums(k, t);
}

/// Placements and velocities of bodies and joints only.
#[inline(always)]
pub(crate) fn motion<M: Machine>(k: &mut M, t: &Tables) {
    bodies(k, t);
    joints(k, t);
}

/// Coordinates and velocities of joints only, which follow from their bodies.
#[inline(always)]
pub(crate) fn joints<M: Machine>(k: &mut M, t: &Tables) {
    axes(k, t);
    balls(k, t);
    frees(k, t);
}

/// The same, and the contacts of the last step.
#[inline(always)]
pub(crate) fn contacts<M: Machine>(k: &mut M, t: &Tables) {
    motion(k, t);
    if t.touches() {
        t.kept.report(k, t.output.contact);
        let torques = (t.gripped, t.contacts.sensed);
        report_torques(k, &t.kept, torques, t.output.contact_torque);
    }
}

#[inline(always)]
fn bodies<M: Machine>(k: &mut M, t: &Tables) {
    for i in k.count(t.bodies) {
        let id = k.link(t.body_links, i, body_link::BODY);
        let row = k.link(t.body_links, i, body_link::ROW);
        let (own, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let pose = own * k.pose(t.body, i, 0);
        let v = twist.linear + twist.angular.cross(pose.p - own.p);
        k.store_vec3(t.output.body, id, body::POSITION, pose.p);
        k.store_quat(t.output.body, id, body::ORIENTATION, pose.q);
        k.store_vec3(t.output.body, id, body::VELOCITY, v);
        k.store_vec3(t.output.body, id, body::ANGULAR_VELOCITY, twist.angular);
    }
}

/// Accelerations of all bodies: change of velocity over the last substep, and ω × (ω × r) at the arm r of
/// the body's frame.
#[inline(always)]
fn body_accelerations<M: Machine>(k: &mut M, t: &Tables) {
    let per = k.load(t.led, k.index(0), 0).recip();
    for i in k.count(t.bodies) {
        let id = k.link(t.body_links, i, body_link::BODY);
        let row = k.link(t.body_links, i, body_link::ROW);
        let (own, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let change = (twist - k.spatial(t.before, row, 0)) * per;
        let arm = own.q.rotate(k.pose(t.body, i, 0).p);
        let inward = twist.angular.cross(twist.angular.cross(arm));
        let linear = change.linear + change.angular.cross(arm) + inward;
        k.store_vec3(
            t.output.body_acceleration,
            id,
            body_acceleration::LINEAR,
            linear,
        );
        k.store_vec3(
            t.output.body_acceleration,
            id,
            body_acceleration::ANGULAR,
            change.angular,
        );
    }
}

/// The same pair of bodies, moving as they did before the last substep.
#[inline(always)]
fn before<M: Machine>(k: &M, t: &Tables, ends: Ends<M::R, M::I>) -> Ends<M::R, M::I> {
    let mut past = ends;
    past.a.twist = k.spatial(t.before, ends.row_a, 0);
    past.b.twist = k.spatial(t.before, ends.row_b, 0);
    past
}

#[inline(always)]
fn axes<M: Machine>(k: &mut M, t: &Tables) {
    let h = k.load(t.led, k.index(0), 0);
    for g in k.count(t.groups) {
        measure(k, t, g);
    }
    for row in k.count(t.axes) {
        let q = k.link(t.axis_links, row, axis_link::COORDINATE);
        let v = k.link(t.axis_links, row, axis_link::DOF);
        if let Some(_branch) = k.when(k.less(v, k.index(t.input.dofs()))) {
            let ends = Ends::load(k, t, k.link(t.axis_links, row, axis_link::JOINT));
            let past = Pull::load(k, t, row).rate(&before(k, t, ends));
            let rate = k.load(t.axis, row, axis_field::RATE);
            let mut value = k.cell(k.load(t.axis, row, axis_field::VALUE));
            if let Some(_branch) = k.when(k.equals(k.link(t.axis_links, row, axis_link::TURNS), 1))
            {
                value.write(wrap(value.read()));
            }
            k.store(t.output.position, q, 0, value.read());
            k.store(t.output.velocity, v, 0, rate);
            k.store(t.output.acceleration, v, 0, (rate - past) / h);
        }
    }
}

#[inline(always)]
fn balls<M: Machine>(k: &mut M, t: &Tables) {
    let h = k.load(t.led, k.index(0), 0);
    for i in k.count(t.balls) {
        let (q, v) = (k.link(t.ball_links, i, 1), k.link(t.ball_links, i, 2));
        let ends = Ends::load(k, t, k.link(t.ball_links, i, 0));
        let (qa, qb) = ends.frames(k, t, k.link(t.ball_links, i, 0));
        let past = before(k, t, ends);
        let now = qb.rotate_inverse(spin(&ends));
        let change = now - qb.rotate_inverse(spin(&past));
        k.store_quat(t.output.position, q, 0, qa.conjugate() * qb);
        k.store_vec3(t.output.velocity, v, 0, now);
        k.store_vec3(t.output.acceleration, v, 0, change * h.recip());
    }
}

/// Angular velocity of B against A.
#[inline(always)]
fn spin<R: Real, I: Index>(ends: &Ends<R, I>) -> Vec3<R> {
    ends.b.twist.angular - ends.a.twist.angular
}

/// Velocity of B's anchor against A.
#[inline(always)]
fn drift<R: Real, I: Index>(ends: &Ends<R, I>, rb: Vec3<R>) -> Vec3<R> {
    let ra = ends.b.pose.p + rb - ends.a.pose.p;
    let (a, b) = (ends.a.twist, ends.b.twist);
    (b.linear + b.angular.cross(rb)) - (a.linear + a.angular.cross(ra))
}

#[inline(always)]
fn frees<M: Machine>(k: &mut M, t: &Tables) {
    let h = k.load(t.led, k.index(0), 0);
    for i in k.count(t.frees) {
        let j = k.link(t.free_links, i, 0);
        let (q, v) = (k.link(t.free_links, i, 1), k.link(t.free_links, i, 2));
        let ends = Ends::load(k, t, j);
        let past = before(k, t, ends);
        let (qa, qb) = ends.frames(k, t, j);
        let (_, rb, gap) = ends.arms(k, t, j);
        let linear = qa.rotate_inverse(drift(&ends, rb));
        let angular = qb.rotate_inverse(spin(&ends));
        let linear_change = linear - qa.rotate_inverse(drift(&past, rb));
        let angular_change = angular - qb.rotate_inverse(spin(&past));
        k.store_vec3(t.output.position, q, 0, qa.rotate_inverse(gap));
        k.store_quat(t.output.position, q.offset(3), 0, qa.conjugate() * qb);
        k.store_vec3(t.output.velocity, v, 0, linear);
        k.store_vec3(t.output.velocity, v.offset(3), 0, angular);
        k.store_vec3(t.output.acceleration, v, 0, linear_change * h.recip());
        k.store_vec3(
            t.output.acceleration,
            v.offset(3),
            0,
            angular_change * h.recip(),
        );
    }
}

/// A multiplier is an impulse times h: f = λ / h².
#[inline(always)]
fn reactions<M: Machine>(k: &mut M, t: &Tables) {
    let h = k.load(t.led, k.index(0), 0);
    for j in k.count(t.joints) {
        store_reaction(k, t, j, Spatial::zero(), h);
    }
    for c in k.count(t.closings) {
        let lambda = k.spatial(t.multiplier, c, 0);
        store_reaction(k, t, k.link(t.closing_links, c, 0), lambda, h);
    }
    clear(k, t);
    for i in k.range_down(k.index(t.rows - 1)) {
        let row = i.offset(1);
        let kind = k.link(t.row_links, row, row_link::INBOUND);
        if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ROOT))) {
            let lambda = through(k, t, row, k.spatial(t.moved, row, 0));
            store_reaction(k, t, k.link(t.row_links, row, row_link::JOINT), lambda, h);
        }
    }
}

#[inline(always)]
fn store_reaction<M: Machine>(k: &mut M, t: &Tables, j: M::I, lambda: Spatial<M::R>, h: M::R) {
    let id = k.link(t.joint_links, j, joint_link::JOINT);
    let f = lambda * h.squared().recip();
    k.store_vec3(t.output.reaction, id, reaction::FORCE, f.linear);
    k.store_vec3(t.output.reaction, id, reaction::TORQUE, f.angular);
}

#[inline(always)]
fn sums<M: Machine>(k: &mut M, t: &Tables) {
    let (world, half) = (k.index(0), M::R::lit(0.5));
    let gravity = k.vec3(t.global, world, global::GRAVITY);
    let mut kinetic = k.cell(M::R::zero());
    let mut potential = k.cell(M::R::zero());
    let mut sum = Spatial::zero().hold(k);
    for row in k.range(k.index(1), k.index(t.rows)) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let m = k.load(t.mass, row, mass::MASS);
        let w = pose.q.rotate_inverse(twist.angular);
        let l = w.times(k.vec3(t.mass, row, mass::MOMENTS));
        let p = twist.linear * m;
        kinetic.write(kinetic.read() + half * (p.dot(twist.linear) + w.dot(l)));
        potential.write(potential.read() - m * gravity.dot(pose.p));
        let angular = pose.q.rotate(l) + pose.p.cross(p);
        sum.set(sum.get() + Spatial::new(angular, p));
    }
    t.laws.energies(k, t, &mut kinetic, &mut potential);
    let sum = sum.get();
    k.store(t.output.total, world, total::KINETIC, kinetic.read());
    k.store(t.output.total, world, total::POTENTIAL, potential.read());
    k.store_vec3(t.output.total, world, total::MOMENTUM, sum.linear);
    k.store_vec3(t.output.total, world, total::ANGULAR_MOMENTUM, sum.angular);
    let capped = k.load(t.capped, world, 0);
    k.store(t.output.total, world, total::CAPPED, capped);
}
