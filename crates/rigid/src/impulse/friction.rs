//! Friction of a contact as a whole: against sliding, twisting and rolling.
//!
//! A patch of contact pulls with a force at its centre and a torque about its normal. Both are bounded
//! by what its points bear, Σλ in all, at distances d from the centre:
//!
//! ```text
//! |drag| ≤ μ Σλ     |twist| ≤ μ Σ λ d + rₜ Σλ     |roll| ≤ rᵣ Σλ
//! ```
//!
//! (Goyal, Ruina, Papadopoulos, *Planar sliding with dry friction*, 1991, with a box for their limit
//! surface; rₜ and rᵣ are MuJoCo's second and third coefficient, lengths.) Friction at each of four
//! points instead has eight unknowns for three motions.

use super::contact::{Moved, Pair, Response};
use super::tables::{ContactTables, manifold};
use numbers::spatial::Spatial;
use numbers::{Machine, Real, SymMat3, Vec3};

/// The centre of the points, and how the bodies resist there.
#[inline(always)]
pub(super) fn prepare<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    normal: Vec3<M::R>,
    response: Response<M::R>,
) {
    let only = k.index(0);
    let tiny = M::R::lit(1e-30);
    let [a, b]: [SymMat3<M::R>; 2] = response.inertia;
    let twist = normal.dot(a * normal + b * normal);
    let masses = [
        response.across(normal).max(tiny).recip(),
        twist.max(tiny).recip(),
        (a.trace() + b.trace()).max(tiny).recip(),
    ];
    let [arm_a, arm_b] = response.arms;
    let drag = k.vec3(t.manifold, only, manifold::DRAG);
    let drag = drag - normal * normal.dot(drag);
    k.store_vec3(t.manifold, only, manifold::ARMS, arm_a);
    k.store_vec3(t.manifold, only, manifold::ARMS + 3, arm_b);
    k.write(t.manifold, only, manifold::TANGENT_MASS, masses);
    k.store_vec3(t.manifold, only, manifold::DRAG, drag);
}

/// The arms of the centre now.
#[inline(always)]
pub(super) fn arms<M: Machine>(k: &M, t: &ContactTables, moved: &Moved<M::R>) -> [Vec3<M::R>; 2] {
    let only = k.index(0);
    moved.meet([
        k.vec3(t.manifold, only, manifold::ARMS),
        k.vec3(t.manifold, only, manifold::ARMS + 3),
    ])
}

/// One relaxation, where the points bear `load` in all, and `moment` is the sum of their loads times
/// their distances.
#[inline(always)]
pub(super) fn solve<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    pair: &mut Pair<M>,
    moved: &Moved<M::R>,
    load: M::R,
    moment: M::R,
) {
    let only = k.index(0);
    let old = [
        k.vec3(t.manifold, only, manifold::DRAG),
        k.vec3(t.manifold, only, manifold::TWIST),
    ];
    let [drag, twist] = rub(k, t, pair, moved, [load, moment], old);
    k.store_vec3(t.manifold, only, manifold::DRAG, drag);
    k.store_vec3(t.manifold, only, manifold::TWIST, twist);
}

/// Friction of a blow, whose points bear so much, and have such a moment.
#[inline(always)]
pub(super) fn strike<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    pair: &mut Pair<M>,
    moved: &Moved<M::R>,
    loads: [M::R; 2],
) {
    let [drag, twist] = rub(k, t, pair, moved, loads, [Vec3::zero(); 2]);
    add(k, t, Spatial::new(drag, twist));
}

/// The drag and twist that `old` and `given` become; the bodies take the differences.
#[inline(always)]
fn rub<M: Machine>(
    k: &M,
    t: &ContactTables,
    pair: &mut Pair<M>,
    moved: &Moved<M::R>,
    [load, moment]: [M::R; 2],
    [old, given]: [Vec3<M::R>; 2],
) -> [Vec3<M::R>; 2] {
    let only = k.index(0);
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let [friction, _, torsion, rolling] = k.read(t.manifold, only, manifold::FRICTION);
    let [tangent_mass, twist_mass, roll_mass] = k.read(t.manifold, only, manifold::TANGENT_MASS);
    let arms = arms(k, t, moved);
    let u = pair.velocity(arms);
    let wish = (u - normal * normal.dot(u)).fma(-tangent_mass, old);
    let drag = within(wish, friction * load);
    pair.push(drag - old, arms);

    let w = pair.spin();
    let (along, turning) = (normal.dot(given), normal.dot(w));
    let most = torsion.fma(load, friction * moment);
    let twist = twist_mass.fnma(turning, along).clamp(-most, most);
    let rolled = given - normal * along;
    let rolled = (w - normal * turning).fma(-roll_mass, rolled);
    let turned = normal.fma(twist, within(rolled, rolling * load));
    pair.turn(turned - given);
    [drag, turned]
}

/// Adds what is given in a small step to what was given in those before.
#[inline(always)]
pub(super) fn count<M: Machine>(k: &mut M, t: &ContactTables) {
    let only = k.index(0);
    add(k, t, k.spatial(t.manifold, only, manifold::DRAG));
}

/// Adds a drag and a twist to the sums of the step.
#[inline(always)]
fn add<M: Machine>(k: &mut M, t: &ContactTables, given: Spatial<M::R>) {
    let only = k.index(0);
    let sum = k.spatial(t.manifold, only, manifold::DRAG_SUM);
    k.store_spatial(t.manifold, only, manifold::DRAG_SUM, sum + given);
}

/// No longer than `most`.
#[inline(always)]
fn within<R: Real>(v: Vec3<R>, most: R) -> Vec3<R> {
    v * (most / v.length().max(R::lit(1e-30))).min(R::one())
}
