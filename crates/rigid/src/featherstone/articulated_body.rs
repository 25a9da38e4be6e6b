//! Forward dynamics of trees by the articulated-body algorithm.
//!
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), §7.3 and table 7.1, in
//! world axes about one point, so that the transforms drop out and a degree of
//! freedom is a rank-1 update. Inwards, for each node and its axes last to first:
//!
//! ```text
//! Iᴬ = I + Σ Iᴬ_child      p = I b + v ×* I v + Σ p_child
//! U = Iᴬ S      D = Sᵀ U + armature + implicit      u = τ − Sᵀ p
//! Iᴬ ← Iᴬ − U Uᵀ / D      p ← p + U u / D
//! ```
//!
//! and outwards:
//!
//! ```text
//! a = a_parent      δ = (u − Uᵀ a) / D,  a ← a + S δ      q̈ = q̈⁻ + δ
//! ```
//!
//! What is solved for is δ, by how much the accelerations differ from q̈⁻, those of the step before: b holds S q̈⁻, and τ
//! lacks q̈⁻ times all that opposes q̈. It is the same q̈, but for rounding. Stops and dry friction, whose laws depend on it, are
//! guessed on the way inwards by what a joint does whose parent has no δ; that its parent has no q̈ is far from true of what
//! falls: of a humanoid's steps under random torques 15 % needed a second pass over the tree, and 2 % do now. Where there is
//! nothing to guess q̈⁻ is 0; and where there are contacts, loops or couplings, whose passes do not end with q̈ for certain.
//!
//! Departures from the source: a joint of several degrees of freedom is eliminated
//! axis by axis, which is its block Cholesky factorisation written out. The
//! velocity-product accelerations are summed along the tree beforehand, with gravity,
//! to b, the acceleration where every q̈ is q̈⁻; so they meet only the rigid
//! inertia of each node, never the articulated one, and a is what the δ add to b.
//! A root that floats freely is solved at once, Iᴬ a = S⁻ᵀ τ − p.

use super::contact;
use super::friction;
use super::kinematics::{Course, begins, newton_euler, visited, world_inertia};
use super::limit;
use super::tables::{Tables, arrival, carries, dof, frame, node, node_link, own};
use crate::gyroscopic::mean_torque;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Cell, Machine, Mat3, Real, Vec3};

/// Smallest armature and pivot, so that a massless node does not divide by zero.
pub(crate) const TINY: f64 = 1e-20;

/// Accelerations of all degrees of freedom into `dof::ACCELERATION`, and of all nodes, under
/// contacts that are implicit over `h` [s], and friction of joints and
/// [gyroscopic torques](crate::gyroscopic) that are over `implicit` [s].
///
/// Needs [`kinematics`](super::kinematics::kinematics), [`forces`](super::force::forces), [`limit::begin`] and [`friction::begin`],
/// and, where there are contacts, these found or recalled, and [`by_themselves`].
#[inline(always)]
pub(crate) fn articulated_body<M: Machine, const CONTACTS: bool>(
    k: &mut M,
    t: &Tables,
    h: M::R,
    implicit: M::R,
) {
    inwards::<M, CONTACTS>(k, t, h, implicit);
    outwards(k, t);
}

#[inline(always)]
fn inwards<M: Machine, const CONTACTS: bool>(k: &mut M, t: &Tables, h: M::R, implicit: M::R) {
    // What a node hands on to its parent, where that is next.
    let mut next = Inertia::zero().hold(k);
    let mut next_p = Spatial::zero().hold(k);
    for i in k.range_down(k.index(t.nodes)) {
        let n = visited(k, t, i);
        let links = k.link_row::<_, { node_link::WIDTH }>(t.node_links, n);
        let (own_inertia, own_p) = if CONTACTS {
            kept(k, t, n)
        } else {
            own(k, t, n, implicit)
        };
        let mut inertia = own_inertia.hold(k);
        let mut p = own_p.hold(k);
        let carries = links[node_link::CARRIES];
        if M::HANDS_ON {
            if let Some(_branch) = k.when(k.equals(carries, carries::ONE)) {
                inertia.set(inertia.get() + next.get());
                p.set(p.get() + next_p.get());
            }
            if let Some(_branch) = k.when(k.equals(carries, carries::MORE)) {
                let (sum_p, sum) = carried(k, t, n);
                inertia.set(inertia.get() + (sum + next.get()));
                p.set(p.get() + (sum_p + next_p.get()));
            }
        } else if let Some(_branch) = k.when(k.less(k.index(carries::NOTHING), carries)) {
            let (carried_p, carried) = carried(k, t, n);
            inertia.set(inertia.get() + carried);
            p.set(p.get() + carried_p);
        }
        if CONTACTS {
            if t.exchanges() {
                p.set(p.get() - k.spatial(t.pressure, n, 0));
            }
            for s in k.range(links[node_link::SLOT_BEGIN], links[node_link::SLOT_END]) {
                if let Some(_branch) = k.if_any(k.load(t.on, s, 0).gt(M::R::zero())) {
                    let (mass, force) = contact::burden(k, t, s, h);
                    inertia.set(inertia.get() + mass);
                    p.set(p.get() - force);
                }
            }
        }
        if let Some(_branch) = k.when(k.equals(links[node_link::FLOATS], 1)) {
            float(k, t, n, inertia.get(), p.get());
        }
        for j in k.range_down(links[node_link::ELIMINATED]) {
            let v = links[node_link::DOF_BEGIN].plus(j);
            let s = k.spatial(t.dof, v, dof::AXIS);
            let a = inertia.get();
            let u_vector = a.apply(s);
            let [tau, opposed] = k.read(t.dof, v, dof::TAU);
            let tau = opposed.fnma(t.before(k, v), tau);
            let mut d = k.cell(s.dot_plus(u_vector, opposed));
            let mut u = k.cell((-s).dot_plus(p.get(), tau));
            if t.forces.frictions > 0 {
                friction::act(k, t, v, implicit, &mut u, &mut d);
            }
            if t.forces.limits > 0 {
                limit::act(k, t, v, &mut u, &mut d);
            }
            let (u, inverse) = (u.read(), d.read().recip());
            inertia.set(a.minus_outer(u_vector, inverse));
            let moved = u_vector.fma(u * inverse, p.get());
            p.set(moved);
            k.store_spatial(t.dof, v, dof::U, u_vector);
            k.write(t.dof, v, dof::FORCE, [u, inverse]);
        }
        if M::HANDS_ON {
            next.set(inertia.get());
            next_p.set(p.get());
        }
        if let Some(_branch) = begins(k, t, n) {
            let (parent, arrival) = (links[node_link::PARENT], links[node_link::ARRIVAL]);
            pass_on(k, t, parent, arrival, inertia.get(), p.get());
        }
    }
}

/// What every node is by itself, which passes that differ in what touches it have in common.
#[inline(always)]
pub(crate) fn by_themselves<M: Machine>(k: &mut M, t: &Tables, implicit: M::R) {
    for n in k.range(k.index(t.trees), k.index(t.trees + t.nodes)) {
        let (inertia, p) = own(k, t, n, implicit);
        k.store_vec3(t.own, n, own::FIRST, inertia.first_moment());
        k.store_sym(t.own, n, own::SECOND, inertia.i);
        k.store_spatial(t.own, n, own::FORCE, p);
    }
}

/// What [`by_themselves`] has found.
#[inline(always)]
fn kept<M: Machine>(k: &M, t: &Tables, n: M::I) -> (Inertia<M::R>, Spatial<M::R>) {
    let m = k.load(t.node, n, node::MASS);
    let (first, second) = (k.vec3(t.own, n, own::FIRST), k.sym(t.own, n, own::SECOND));
    let inertia = Inertia::from_moments(m, first, second);
    (inertia, k.spatial(t.own, n, own::FORCE))
}

/// Inertia of a node without what it carries, and the wrench that moves it where every q̈ is q̈⁻.
#[inline(always)]
fn own<M: Machine>(k: &M, t: &Tables, n: M::I, implicit: M::R) -> (Inertia<M::R>, Spatial<M::R>) {
    let Course { place, twist, bias } = Course::read(k, t, n);
    let (m, c, i) = world_inertia(k, t.node, n, place);
    let mut p = newton_euler(m, c, i, twist, bias).hold(k);
    let alone = k.equals(k.link(t.node_links, n, node_link::ALONE), 1);
    if let Some(_branch) = k.when(alone) {
        let spin = twist.angular;
        let change = mean_torque(i, spin, implicit) - spin.cross(i * spin);
        p.set(p.get() + Spatial::new(change, Vec3::zero()));
    }
    (Inertia::rigid(m, c, i), p.get())
}

/// Bias force and inertia of what a node carries.
#[inline(always)]
fn carried<M: Machine>(k: &M, t: &Tables, n: M::I) -> (Spatial<M::R>, Inertia<M::R>) {
    let [a, b, c, d, e, f, inertia @ ..] = k.read::<_, _, 27>(t.frame, n, frame::FORCE);
    (
        Spatial::from_array([a, b, c, d, e, f]),
        Inertia::from_array(inertia),
    )
}

/// Accelerations of a root that moves freely in the world, and of its six degrees of freedom.
///
/// Its axes are b₁ b₂ b₃, along which it slides, and r₁ r₂ r₃, about which it turns in x:
/// S = ((0, b), (r, x × r)).
#[inline(always)]
fn float<M: Machine>(k: &mut M, t: &Tables, n: M::I, i: Inertia<M::R>, p: Spatial<M::R>) {
    let v = k.link(t.node_links, n, node_link::DOF_BEGIN);
    let x = k.vec3(t.frame, n, frame::PLACE);
    let (y, z) = (v.offset(1), v.offset(2));
    let (rx, ry, rz) = (v.offset(3), v.offset(4), v.offset(5));
    let b = Mat3::from_columns(
        k.vec3(t.dof, v, dof::AXIS + 3),
        k.vec3(t.dof, y, dof::AXIS + 3),
        k.vec3(t.dof, z, dof::AXIS + 3),
    );
    let r = Mat3::from_columns(
        k.vec3(t.dof, rx, dof::AXIS),
        k.vec3(t.dof, ry, dof::AXIS),
        k.vec3(t.dof, rz, dof::AXIS),
    );
    let push = along(k, t, v, dof::TAU);
    let twist = along(k, t, rx, dof::TAU);
    let force = b * push;
    let moment = r * twist + x.cross(force);
    let a = i.solve(Spatial::new(moment, force) - p, M::R::lit(TINY));
    let slide = b.transpose_mul(a.linear - x.cross(a.angular));
    let turn = r.transpose_mul(a.angular);
    let found = [slide.x, slide.y, slide.z, turn.x, turn.y, turn.z];
    let axes = [v, y, z, rx, ry, rz];
    for i in 0..6 {
        let acceleration = t.before(k, axes[i]) + found[i];
        k.store(t.dof, axes[i], dof::ACCELERATION, acceleration);
    }
    k.store_spatial(t.frame, n, frame::ACCELERATION, a);
}

/// A field of three degrees of freedom in turn.
#[inline(always)]
pub(crate) fn along<M: Machine>(k: &M, t: &Tables, v: M::I, field: usize) -> Vec3<M::R> {
    Vec3::new(
        k.load(t.dof, v, field),
        k.load(t.dof, v.offset(1), field),
        k.load(t.dof, v.offset(2), field),
    )
}

/// Adds to the parent's sums; the first child to arrive starts them.
#[inline(always)]
fn pass_on<M: Machine>(
    k: &mut M,
    t: &Tables,
    parent: M::I,
    arrival: M::I,
    i: Inertia<M::R>,
    p: Spatial<M::R>,
) {
    if let Some(_branch) = k.when(k.equals(arrival, arrival::FIRST)) {
        k.store_inertia(t.frame, parent, frame::INERTIA, i);
        k.store_spatial(t.frame, parent, frame::FORCE, p);
    }
    if let Some(_branch) = k.when(k.equals(arrival, arrival::LATER)) {
        let (carried_p, carried) = carried(k, t, parent);
        k.store_inertia(t.frame, parent, frame::INERTIA, carried + i);
        k.store_spatial(t.frame, parent, frame::FORCE, carried_p + p);
    }
}

#[inline(always)]
fn outwards<M: Machine>(k: &mut M, t: &Tables) {
    for tree in k.count(t.trees) {
        k.store_spatial(t.frame, tree, frame::ACCELERATION, Spatial::zero());
    }
    let mut a = Spatial::zero().hold(k);
    for i in k.count(t.nodes) {
        let n = visited(k, t, i);
        let links = k.link_row::<_, { node_link::DOF_COUNT }>(t.node_links, n);
        if let Some(_branch) = begins(k, t, n) {
            let from = links[node_link::ACCELERATES_FROM];
            a.set(k.spatial(t.frame, from, frame::ACCELERATION));
        }
        let (first, count) = (links[node_link::DOF_BEGIN], links[node_link::ELIMINATED]);
        for v in k.range(first, first.plus(count)) {
            let [u, inverse] = k.read(t.dof, v, dof::FORCE);
            let left = (-k.spatial(t.dof, v, dof::U)).dot_plus(a.get(), u);
            let acceleration = left * inverse;
            k.store(t.dof, v, dof::ACCELERATION, t.before(k, v) + acceleration);
            let moved = k.spatial(t.dof, v, dof::AXIS).fma(acceleration, a.get());
            a.set(moved);
        }
        k.store_spatial(t.frame, n, frame::ACCELERATION, a.get());
    }
}
