//! Inverse dynamics by the recursive Newton–Euler algorithm.
//!
//! The forces τ under which a tree moves with given accelerations:
//! τ = M(q) q̈ + b(q, q̇). Featherstone, *Rigid Body Dynamics Algorithms* (2008),
//! §5.3 and table 5.1, in world axes about one point, so that the transforms drop
//! out. Outwards, with b the acceleration where every q̈ is zero, gravity included:
//!
//! ```text
//! a = a_parent + Σ S q̈        f = I (a + b) + v ×* I v
//! ```
//!
//! and inwards:
//!
//! ```text
//! τ = Sᵀ f + armature q̈           f_parent ← f_parent + f
//! ```
//!
//! With q̈ = 0 it is the bias force b: weight, Coriolis and centrifugal forces.

use super::super::tables::frame;
use super::tables::{DynamicsTables, dof_link};
use crate::featherstone::kinematics::{kinematics, newton_euler, world_inertia};
use crate::featherstone::tables::{Tables, dof, node_link};
use numbers::Machine;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;

/// Forces for the accelerations in `acceleration` into `force`.
#[inline(always)]
pub(crate) fn inverse_dynamics<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables) {
    kinematics(k, t);
    outwards(k, t, d);
    inwards(k, t, d);
}

/// Fills `acceleration` and `force` of all nodes; the world's rows of `force` start at zero.
#[inline(always)]
fn outwards<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables) {
    for tree in k.count(t.trees) {
        k.store_spatial(t.frame, tree, frame::ACCELERATION, Spatial::zero());
        k.store_spatial(t.frame, tree, frame::FORCE, Spatial::zero());
    }
    for n in k.range(k.index(t.trees), k.index(t.trees + t.nodes)) {
        let parent = k.link(t.node_links, n, node_link::PARENT);
        let mut a = k.spatial(t.frame, parent, frame::ACCELERATION).hold(k);
        let first = k.link(t.node_links, n, node_link::DOF_BEGIN);
        let count = k.link(t.node_links, n, node_link::DOF_COUNT);
        for v in k.range(first, first.plus(count)) {
            let rate = k.load(d.acceleration, v, 0);
            let moved = k.spatial(t.dof, v, dof::AXIS).fma(rate, a.get());
            a.set(moved);
        }
        let (a, v) = (a.get(), k.spatial(t.frame, n, frame::TWIST));
        let (m, c, i) = world_inertia(k, t.node, n, k.pose(t.frame, n, frame::PLACE));
        let f = newton_euler(m, c, i, v, a + k.spatial(t.frame, n, frame::BIAS));
        k.store_spatial(t.frame, n, frame::ACCELERATION, a);
        k.store_spatial(t.frame, n, frame::FORCE, f);
    }
}

#[inline(always)]
fn inwards<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables) {
    for i in k.range_down(k.index(t.nodes)) {
        let n = i.offset(t.trees);
        let parent = k.link(t.node_links, n, node_link::PARENT);
        let sum = k.spatial(t.frame, parent, frame::FORCE) + k.spatial(t.frame, n, frame::FORCE);
        k.store_spatial(t.frame, parent, frame::FORCE, sum);
    }
    for v in k.count(t.dofs) {
        let f = k.spatial(
            t.frame,
            k.link(d.dof_links, v, dof_link::NODE),
            frame::FORCE,
        );
        let rotor = t.forces.armature(k, v) * k.load(d.acceleration, v, 0);
        let tau = k.spatial(t.dof, v, dof::AXIS).dot(f) + rotor;
        k.store(d.force, v, 0, tau);
    }
}
