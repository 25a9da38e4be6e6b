//! Forward dynamics: accelerations under given forces, and the forces that act.
//!
//! q̈ = M⁻¹ (τ − b), without forming M, by the articulated-body algorithm
//! ([`articulated_body`](crate::featherstone), Featherstone 2008, table 7.1). τ is
//! either given, or the sum of all force laws of the model, taken explicitly.

use super::tables::DynamicsTables;
use crate::featherstone::articulated_body::articulated_body;
use crate::featherstone::force::{bare, forces, smooth_targets};
use crate::featherstone::friction;
use crate::featherstone::kinematics::kinematics;
use crate::featherstone::limit;
use crate::featherstone::tables::{Tables, dof};
use numbers::{Machine, Real};

/// A time [s] after which every drive has followed its target.
const ENDLESS: f64 = 1e30;

/// Accelerations under the forces in the input, and no others, into the output.
#[inline(always)]
pub(crate) fn forward_dynamics<M: Machine>(k: &mut M, t: &Tables) {
    kinematics(k, t);
    for v in k.count(t.dofs) {
        bare(k, t, v);
    }
    let now = M::R::zero();
    articulated_body::<M, false>(k, &t.unhindered(), now, now);
    for v in k.count(t.dofs) {
        let x = k.load(t.dof, v, dof::ACCELERATION);
        k.store(t.output.acceleration, v, 0, x);
    }
}

/// The sum of all force laws into `force`; drives have followed their targets.
#[inline(always)]
pub(crate) fn applied_forces<M: Machine>(k: &mut M, t: &Tables, d: &DynamicsTables) {
    smooth_targets(k, t, M::R::lit(ENDLESS));
    forces(k, t, M::R::zero());
    for v in k.count(t.dofs) {
        let mut tau = k.load(t.dof, v, dof::TAU);
        if t.forces.limits > 0 {
            tau += limit::at_rest(k, t, v);
        }
        if t.forces.frictions > 0 {
            tau += friction::at_rest(k, t, v);
        }
        k.store(d.force, v, 0, tau);
    }
}
