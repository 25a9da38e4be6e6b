//! Forward dynamics of trees by the articulated-body algorithm.
//!
//! Featherstone, *Rigid Body Dynamics Algorithms* (2008), §7.3 and table 7.1, in
//! world axes about one point, so that the transforms drop out and a degree of
//! freedom is a rank-1 update. Inwards, for each node and its axes last to first:
//!
//! ```text
//! Iᴬ = I + Σ Iᴬ_child      p = v ×* I v + Σ p_child + Iᴬ c
//! U = Iᴬ S      D = Sᵀ U + armature + implicit      u = τ − Sᵀ p
//! Iᴬ ← Iᴬ − U Uᵀ / D      p ← p + U u / D
//! ```
//!
//! and outwards, with the world accelerating at −g:
//!
//! ```text
//! a = a_parent      q̈ = (u − Uᵀ a) / D,  a ← a + S q̈      a ← a + c
//! ```
//!
//! Departure from the source: a joint of several degrees of freedom is eliminated
//! axis by axis, which is its block Cholesky factorisation written out, and c is
//! added once per node.

use super::kinematics::{momentum, world_inertia};
use super::tables::{Tables, arrival, dof, frame, node_link};
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Machine, Real, Vec3};

/// Smallest D, so that a massless node does not divide by zero.
const TINY: f64 = 1e-20;

/// Accelerations of all degrees of freedom into `dof::ACCELERATION`, and of all nodes.
///
/// Needs [`kinematics`](super::kinematics::kinematics) and [`forces`](super::force::forces).
#[inline(always)]
pub(crate) fn articulated_body<M: Machine>(k: &mut M, t: &Tables) {
    inwards(k, t);
    outwards(k, t);
}

#[inline(always)]
fn inwards<M: Machine>(k: &mut M, t: &Tables) {
    for i in k.range_down(k.index(t.nodes)) {
        let n = i.offset(t.trees);
        let (m, c, i) = world_inertia(k, t.node, n, k.pose(t.frame, n, frame::PLACE));
        let twist = k.spatial(t.frame, n, frame::TWIST);
        let mut inertia = Inertia::rigid(m, c, i).hold(k);
        let mut p = twist.cross_force(momentum(m, c, i, twist)).hold(k);
        for _ in k.when(k.equals(k.link(t.node_links, n, node_link::CARRIES), 1)) {
            inertia.set(inertia.get() + k.inertia(t.frame, n, frame::INERTIA));
            p.set(p.get() + k.spatial(t.frame, n, frame::FORCE));
        }
        p.set(p.get() + inertia.get().apply(k.spatial(t.frame, n, frame::BIAS)));
        let first = k.link(t.node_links, n, node_link::DOF_BEGIN);
        for j in k.range_down(k.link(t.node_links, n, node_link::DOF_COUNT)) {
            let v = first.plus(j);
            let s = k.spatial(t.dof, v, dof::AXIS);
            let a = inertia.get();
            let u_vector = a.apply(s);
            let d = s.dot(u_vector) + k.load(t.dof, v, dof::IMPLICIT);
            let inverse = d.max(M::R::lit(TINY)).recip();
            let u = k.load(t.dof, v, dof::TAU) - s.dot(p.get());
            inertia.set(a.minus_outer(u_vector, inverse));
            let moved = u_vector.fma(u * inverse, p.get());
            p.set(moved);
            k.store_spatial(t.dof, v, dof::U, u_vector);
            k.store(t.dof, v, dof::INVERSE, inverse);
            k.store(t.dof, v, dof::FORCE, u);
        }
        pass_on(k, t, n, inertia.get(), p.get());
    }
}

/// Adds to the parent's sums; the first child to arrive starts them.
#[inline(always)]
fn pass_on<M: Machine>(k: &mut M, t: &Tables, n: M::I, i: Inertia<M::R>, p: Spatial<M::R>) {
    let parent = k.link(t.node_links, n, node_link::PARENT);
    let arrival = k.link(t.node_links, n, node_link::ARRIVAL);
    for _ in k.when(k.equals(arrival, arrival::FIRST)) {
        k.store_inertia(t.frame, parent, frame::INERTIA, i);
        k.store_spatial(t.frame, parent, frame::FORCE, p);
    }
    for _ in k.when(k.equals(arrival, arrival::LATER)) {
        let sum = k.inertia(t.frame, parent, frame::INERTIA) + i;
        k.store_inertia(t.frame, parent, frame::INERTIA, sum);
        let sum = k.spatial(t.frame, parent, frame::FORCE) + p;
        k.store_spatial(t.frame, parent, frame::FORCE, sum);
    }
}

#[inline(always)]
fn outwards<M: Machine>(k: &mut M, t: &Tables) {
    let up = Spatial::new(Vec3::zero(), -k.vec3(t.world, k.index(0), 0));
    for tree in k.count(t.trees) {
        k.store_spatial(t.frame, tree, frame::ACCELERATION, up);
    }
    for n in k.range(k.index(t.trees), k.index(t.trees + t.nodes)) {
        let parent = k.link(t.node_links, n, node_link::PARENT);
        let mut a = k.spatial(t.frame, parent, frame::ACCELERATION).hold(k);
        let first = k.link(t.node_links, n, node_link::DOF_BEGIN);
        let count = k.link(t.node_links, n, node_link::DOF_COUNT);
        for v in k.range(first, first.plus(count)) {
            let u = k.load(t.dof, v, dof::FORCE) - k.spatial(t.dof, v, dof::U).dot(a.get());
            let acceleration = u * k.load(t.dof, v, dof::INVERSE);
            k.store(t.dof, v, dof::ACCELERATION, acceleration);
            let moved = k.spatial(t.dof, v, dof::AXIS).fma(acceleration, a.get());
            a.set(moved);
        }
        let a = a.get() + k.spatial(t.frame, n, frame::BIAS);
        k.store_spatial(t.frame, n, frame::ACCELERATION, a);
    }
}
