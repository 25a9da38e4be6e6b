//! What a world looks like from outside: placements, velocities, reactions, sums.
//!
//! The wrench w that a joint passes to its child carries the child's own d'Alembert force and the
//! wrenches of the joints that the child carries, less what contacts and joints that close loops, w_c, carry:
//! w = I a + v ×* I v + Σ w_child − Σ w_c, with a less gravity (Featherstone 2008, §5.3).

use super::articulated_body::by_themselves;
use super::closing;
use super::contact;
use super::force::forces;
use super::gauss_seidel;
use super::kinematics::{kinematics, momentum, newton_euler, world_inertia};
use super::limit;
use super::tables::{Tables, body_field, body_link, dof, frame};
use super::turning;
use crate::contacts::{Touch, report_torques};
use crate::output::{body, body_acceleration, reaction, total};
use numbers::functions::wrap;
use numbers::machine::{Held, Hold};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Real, Vec3};

/// Fills the output of every lane from its state. Changes no state.
#[inline(always)]
pub(crate) fn report<M: Machine, const CONTACTS: bool>(k: &mut M, t: &Tables) {
    let now = M::R::zero();
    kinematics(k, t);
    forces(k, t, now);
    if CONTACTS {
        contact::recall(k, t);
        if t.exchanges() {
            gauss_seidel::recall(k, t);
        }
        report_touches(k, t);
        by_themselves(k, t, now);
    }
    limit::under_stops::<M, CONTACTS>(k, t, now, now);
    joints(k, t);
    accelerations(k, t);
    bodies(k, t);
    body_accelerations(k, t);
    wrenches(k, t);
    if CONTACTS {
        relieve(k, t);
        closing::report(k, t);
    }
    reactions(k, t);
    energies(k, t);
}

/// Placements and velocities of bodies and joints only.
#[inline(always)]
pub(crate) fn motion<M: Machine>(k: &mut M, t: &Tables) {
    kinematics(k, t);
    joints(k, t);
    bodies(k, t);
}

/// The same, and the contacts of the last step.
#[inline(always)]
pub(crate) fn contacts<M: Machine, const CONTACTS: bool>(k: &mut M, t: &Tables) {
    motion(k, t);
    if CONTACTS {
        report_touches(k, t);
    }
}

/// What touches what, with which forces and torques.
#[inline(always)]
fn report_touches<M: Machine>(k: &mut M, t: &Tables) {
    t.kept.report(k, t.output.contact);
    let torques = (t.gripped, t.contacts.sensed);
    report_torques(k, &t.kept, torques, t.output.contact_torque);
}

/// Coordinates and velocities of joints only, which are the state.
#[inline(always)]
pub(crate) fn joints<M: Machine>(k: &mut M, t: &Tables) {
    for q in k.count(t.coordinates) {
        let x = k.load(t.position, q, 0);
        k.store(t.output.position, q, 0, x);
    }
    for i in k.count(t.wraps) {
        let q = k.link(t.wrap_links, i, 0);
        let x = wrap(k.load(t.position, q, 0));
        k.store(t.output.position, q, 0, x);
    }
    for v in k.count(t.dofs) {
        let x = k.load(t.velocity, v, 0);
        k.store(t.output.velocity, v, 0, x);
    }
}

#[inline(always)]
fn accelerations<M: Machine>(k: &mut M, t: &Tables) {
    for v in k.count(t.dofs) {
        let x = k.load(t.dof, v, dof::ACCELERATION);
        k.store(t.output.acceleration, v, 0, x);
    }
}

/// Placement of a body from its tree's origin O.
#[inline(always)]
fn placement<M: Machine>(k: &M, t: &Tables, row: M::I) -> Pose<M::R> {
    let n = k.link(t.body_links, row, body_link::NODE);
    k.pose(t.frame, n, frame::PLACE) * k.pose(t.body, row, body_field::PLACE)
}

/// Placements and velocities of all bodies. Needs [`kinematics`](super::kinematics::kinematics).
#[inline(always)]
pub(crate) fn bodies<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.bodies) {
        let id = k.link(t.body_links, row, body_link::BODY);
        let n = k.link(t.body_links, row, body_link::NODE);
        let origin = k.vec3(t.point, k.link(t.body_links, row, body_link::TREE), 0);
        let at = placement(k, t, row);
        let v = k.spatial(t.frame, n, frame::TWIST);
        k.store_vec3(t.output.body, id, body::POSITION, at.p + origin);
        k.store_quat(t.output.body, id, body::ORIENTATION, at.q);
        k.store_vec3(
            t.output.body,
            id,
            body::VELOCITY,
            v.linear + v.angular.cross(at.p),
        );
        k.store_vec3(t.output.body, id, body::ANGULAR_VELOCITY, v.angular);
    }
}

/// Accelerations of all bodies. A spatial acceleration (α, a) about O, plus gravity, is that of the point
/// of the body at O less ω × v there (Featherstone 2008, eq. 2.47), so that a point p of it has
/// a + α × p + ω × (v + ω × p).
#[inline(always)]
fn body_accelerations<M: Machine>(k: &mut M, t: &Tables) {
    let gravity = k.vec3(t.world, k.index(0), 0);
    for row in k.count(t.bodies) {
        let id = k.link(t.body_links, row, body_link::BODY);
        let n = k.link(t.body_links, row, body_link::NODE);
        let at = placement(k, t, row).p;
        let v = k.spatial(t.frame, n, frame::TWIST);
        let a = k.spatial(t.frame, n, frame::BIAS) + k.spatial(t.frame, n, frame::ACCELERATION);
        let passing = v.linear + v.angular.cross(at);
        let linear = a.linear + gravity + a.angular.cross(at) + v.angular.cross(passing);
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
            a.angular,
        );
    }
}

/// What it takes to move each body as it moves.
#[inline(always)]
fn wrenches<M: Machine>(k: &mut M, t: &Tables) {
    k.store_spatial(t.wrench, k.index(t.bodies), 0, Spatial::zero());
    for row in k.count(t.bodies) {
        let n = k.link(t.body_links, row, body_link::NODE);
        let origin = k.vec3(t.point, k.link(t.body_links, row, body_link::TREE), 0);
        let at = placement(k, t, row);
        let (v, a) = (
            k.spatial(t.frame, n, frame::TWIST),
            k.spatial(t.frame, n, frame::BIAS) + k.spatial(t.frame, n, frame::ACCELERATION),
        );
        let (m, c, i) = world_inertia(k, t.body, row, at);
        let w = newton_euler(m, c, i, v, a);
        let moment = w.angular + origin.cross(w.linear);
        k.store_spatial(t.wrench, row, 0, Spatial::new(moment, w.linear));
    }
}

/// Takes off the wrenches what the contacts of the last step carry.
#[inline(always)]
fn relieve<M: Machine>(k: &mut M, t: &Tables) {
    for s in k.count(t.contacts.sensed) {
        let known = t.kept.known(k, s);
        if let Some(_branch) = k.if_any(known) {
            let Touch {
                position: x, force, ..
            } = t.kept.touch(k, s);
            let f = Vec3::select(known, force, Vec3::zero());
            let torque = if t.grips {
                turning::kept(k, t, s, known)
            } else {
                Vec3::zero()
            };
            let [one, other] = k.link_row(t.touching_links, s);
            let push = Spatial::new(x.cross_plus(f, torque), f);
            let reacted = k.spatial(t.wrench, one, 0) + push;
            k.store_spatial(t.wrench, one, 0, reacted);
            let relieved = k.spatial(t.wrench, other, 0) - push;
            k.store_spatial(t.wrench, other, 0, relieved);
        }
    }
}

#[inline(always)]
fn reactions<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.range_down(k.index(t.bodies)) {
        let w = k.spatial(t.wrench, row, 0);
        let carrier = k.link(t.body_links, row, body_link::CARRIER);
        if let Some(_branch) = k.when(k.less(carrier, row)) {
            let sum = k.spatial(t.wrench, carrier, 0) + w;
            k.store_spatial(t.wrench, carrier, 0, sum);
        }
        let joint = k.link(t.body_links, row, body_link::JOINT);
        let origin = k.vec3(t.point, k.link(t.body_links, row, body_link::TREE), 0);
        let x = placement(k, t, row).point(k.vec3(t.body, row, body_field::JOINT)) + origin;
        k.store_vec3(t.output.reaction, joint, reaction::FORCE, w.linear);
        k.store_vec3(
            t.output.reaction,
            joint,
            reaction::TORQUE,
            w.angular - x.cross(w.linear),
        );
    }
}

/// Energies and momenta of the bodies; armatures turn with ½ a q̇².
#[inline(always)]
fn energies<M: Machine>(k: &mut M, t: &Tables) {
    let (one, half) = (k.index(0), M::R::lit(0.5));
    let gravity = k.vec3(t.world, one, 0);
    let mut kinetic = k.cell(M::R::zero());
    let mut potential = k.cell(M::R::zero());
    let mut sum = Spatial::zero().hold(k);
    for row in k.count(t.bodies) {
        let n = k.link(t.body_links, row, body_link::NODE);
        let origin = k.vec3(t.point, k.link(t.body_links, row, body_link::TREE), 0);
        let (m, c, i) = world_inertia(k, t.body, row, placement(k, t, row));
        let v = k.spatial(t.frame, n, frame::TWIST);
        let p = momentum(m, c, i, v);
        gather(&mut kinetic, half * v.dot(p));
        gather(&mut potential, -(m * gravity.dot(c + origin)));
        let moved = sum.get() + Spatial::new(p.angular + origin.cross(p.linear), p.linear);
        sum.set(moved);
    }
    for v in k.count(t.dofs) {
        let speed = k.load(t.velocity, v, 0);
        gather(
            &mut kinetic,
            half * t.forces.armature(k, v) * speed.squared(),
        );
    }
    t.forces.spring_energy(k, t, &mut potential);
    let sum = sum.get();
    k.store(t.output.total, one, total::KINETIC, kinetic.read());
    k.store(t.output.total, one, total::POTENTIAL, potential.read());
    k.store_vec3(t.output.total, one, total::MOMENTUM, sum.linear);
    k.store_vec3(t.output.total, one, total::ANGULAR_MOMENTUM, sum.angular);
}

/// Adds to a loop-carried sum.
#[inline(always)]
pub(crate) fn gather<C: Cell>(sum: &mut C, x: C::R) {
    sum.write(sum.read() + x);
}
