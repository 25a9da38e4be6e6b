//! The mass matrix by the composite-rigid-body algorithm.
//!
//! M(q) with kinetic energy ½ q̇ᵀ M q̇. Featherstone, *Rigid Body Dynamics
//! Algorithms* (2008), §6.2 and table 6.2, in world axes about one point, so that
//! the transforms drop out. A node and all it carries move as one body:
//!
//! ```text
//! Iᶜ = I + Σ Iᶜ_child
//! M_ij = M_ji = S_jᵀ Iᶜ(i) S_i   for every j on the path from i to the world
//! M_ii ← M_ii + armature          all other entries are 0
//! ```

use super::super::tables::frame;
use super::tables::{DynamicsTables, dof_link, path_link};
use crate::featherstone::kinematics::{kinematics, world_inertia};
use crate::featherstone::tables::{Tables, dof, node_link};
use numbers::machine::Index;
use numbers::spatial::Inertia;
use numbers::{Machine, Real, SymMat3, Vec3};

/// The mass matrix of the present coordinates into `mass_matrix`.
#[inline(always)]
pub(crate) fn mass_matrix<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables) {
    kinematics(k, t);
    composite_inertias(k, t);
    for entry in k.count(t.dofs * t.dofs) {
        k.store(d.mass_matrix, entry, 0, M::R::zero());
    }
    for i in k.count(t.dofs) {
        let inertia = k.inertia(
            t.frame,
            k.link(d.dof_links, i, dof_link::NODE),
            frame::INERTIA,
        );
        let f = inertia.apply(k.spatial(t.dof, i, dof::AXIS));
        let begin = k.link(d.dof_links, i, dof_link::PATH_BEGIN);
        let end = k.link(d.dof_links, i, dof_link::PATH_END);
        for p in k.range(begin, end) {
            let j = k.link(d.path_links, p, path_link::DOF);
            let m = f.dot(k.spatial(t.dof, j, dof::AXIS));
            k.store(
                d.mass_matrix,
                k.link(d.path_links, p, path_link::ENTRY),
                0,
                m,
            );
            k.store(
                d.mass_matrix,
                k.link(d.path_links, p, path_link::MIRROR),
                0,
                m,
            );
        }
        let diagonal = k.link(d.dof_links, i, dof_link::DIAGONAL);
        let armature = t.forces.armature(k, i);
        k.add(d.mass_matrix, diagonal, 0, armature);
    }
}

/// Iᶜ of all nodes into `inertia`; the world's rows hold what each tree weighs.
#[inline(always)]
fn composite_inertias<M: Machine>(k: &mut M, t: &Tables) {
    let nothing = Inertia::rigid(M::R::zero(), Vec3::zero(), SymMat3::zero());
    for tree in k.count(t.trees) {
        k.store_inertia(t.frame, tree, frame::INERTIA, nothing);
    }
    for n in k.range(k.index(t.trees), k.index(t.trees + t.nodes)) {
        let (m, c, i) = world_inertia(k, t.node, n, k.pose(t.frame, n, frame::PLACE));
        k.store_inertia(t.frame, n, frame::INERTIA, Inertia::rigid(m, c, i));
    }
    for i in k.range_down(k.index(t.nodes)) {
        let n = i.offset(t.trees);
        let parent = k.link(t.node_links, n, node_link::PARENT);
        let sum =
            k.inertia(t.frame, parent, frame::INERTIA) + k.inertia(t.frame, n, frame::INERTIA);
        k.store_inertia(t.frame, parent, frame::INERTIA, sum);
    }
}
