//! Friction of a contact as a whole: against sliding, twisting and rolling.
//!
//! A patch of contact pulls with a force at its centre of pressure and a torque about its normal. Both are bounded
//! by what its points bear, Σλ in all, at distances d from that centre:
//!
//! ```text
//! s² = |drag|² + (twist / d̄)²     d̄ = Σ λ d / Σλ     p = (twist / d̄)² / s²
//! s ≤ μ Σλ (1 − 0.4 p (1 − p))     |pivot| ≤ rₜ Σλ     |roll| ≤ rᵣ Σλ
//! ```
//!
//! (Goyal, Ruina, Papadopoulos, *Planar sliding with dry friction*, 1991. An ellipsoid, s ≤ μ Σλ, is what Howe and Cutkosky,
//! *Practical force-motion models for sliding manipulation*, 1996, take for their limit surface; that of points on a ring is
//! somewhat smaller. rₜ and rᵣ are MuJoCo's second and third coefficient, lengths.) What slides at u and turns at w has
//! drag and twist along
//!
//! ```text
//! −((2 − q) u, (1 + q) d̄² w)     q = d̄² w² / (u² + d̄² w²)
//! ```
//!
//! which is what points on a ring do where one of the two motions is small, half of what an ellipsoid has there.
//! A projected gradient finds it, with the largest step that overshoots neither. Friction at each of four points instead has
//! eight unknowns for three motions.

use super::contact::{Moved, Pair, Response};
use super::tables::{ContactTables, manifold};
use numbers::spatial::Spatial;
use numbers::{Machine, Real, SymMat3, Vec3};

/// By how much the limit of points on a ring lies within the ellipse, over p (1 − p): their drag and twist come to 2/π of
/// the most where both are as large.
const DENT: f64 = 0.4;
/// What sticks goes over into what slides on the first tenth of itself beyond its limit, so that no rounding decides.
const GOING_OVER: f64 = 10.0;
/// A patch whose lever is below this [m] is a point, which turns freely. More than what rounding makes of one.
const POINT: f64 = 1e-5;

/// Where friction acts, and how the bodies resist there.
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

/// The arms of where friction acts now.
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
    add(k, t, drag, twist);
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
    let slip = normal.fma(-normal.dot(u), u);
    let (along, turning) = (normal.dot(given), normal.dot(pair.spin()));
    let (lever, most) = (moment * load.max(M::R::lit(1e-30)).recip(), friction * load);
    let stopping = twist_mass.fnma(turning, along);
    let pivot = stopping.clamp(-(torsion * load), torsion * load);
    let sticks = (slip.fma(-tangent_mass, old), stopping - pivot);
    // The lever was another one when it was given.
    let twisted = (along - pivot).clamp(-(lever * most), lever * most);
    let slides = slides(
        [tangent_mass, twist_mass],
        lever,
        (slip, turning),
        (old, twisted),
    );
    let (drag, twist) = bounded(sticks, slides, most, lever);

    pair.push(drag - old, arms);
    let w = pair.spin();
    let rolled = given - normal * along;
    let rolled = (w - normal * normal.dot(w)).fma(-roll_mass, rolled);
    let turned = normal.fma(pivot + twist, within(rolled, rolling * load));
    pair.turn(turned - given);
    [drag, turned]
}

/// Drag and twist of what slides at u and turns at w, before they are bounded.
#[inline(always)]
fn slides<R: Real>(
    [tangent_mass, twist_mass]: [R; 2],
    lever: R,
    (u, w): (Vec3<R>, R),
    (drag, twist): (Vec3<R>, R),
) -> (Vec3<R>, R) {
    let (one, tiny) = (R::one(), R::lit(1e-30));
    let lever2 = lever.squared();
    let turning2 = lever2 * w.squared();
    let share = turning2 * (turning2 + u.length_squared()).max(tiny).recip();
    let (along, about) = (one + one - share, (one + share) * lever2);
    // The lesser of tangent_mass / along and twist_mass / about, of which the second may be too large to be a number.
    let least = twist_mass * along * tangent_mass.recip();
    let step = twist_mass * about.max(least).recip();
    (u.fma(-(step * along), drag), (step * about).fnma(w, twist))
}

/// What sticks where the patch bears that, and else what slides, as far as it does.
#[inline(always)]
fn bounded<R: Real>(sticks: (Vec3<R>, R), slides: (Vec3<R>, R), most: R, lever: R) -> (Vec3<R>, R) {
    let (zero, one) = (R::zero(), R::one());
    let is_wide = lever.gt(R::lit(POINT));
    let inverse = R::select(is_wide, lever.max(R::lit(POINT)).recip(), zero);
    let over = one - share(sticks, most, inverse).min(one);
    let part = (over * R::lit(GOING_OVER)).min(one);
    let drag = (slides.0 - sticks.0).fma(part, sticks.0);
    let twist = (slides.1 - sticks.1).fma(part, sticks.1);
    let share = share((drag, twist), most, inverse).min(one);
    (drag * share, R::select(is_wide, twist * share, zero))
}

/// Which share of a drag and twist is at the limit.
#[inline(always)]
fn share<R: Real>((drag, twist): (Vec3<R>, R), most: R, inverse: R) -> R {
    let (one, tiny) = (R::one(), R::lit(1e-30));
    let twisting2 = (twist * inverse).squared();
    let size2 = drag.length_squared() + twisting2;
    let p = twisting2 * size2.max(tiny).recip();
    let most = most * (p * (one - p)).fma(R::lit(-DENT), one);
    most * size2.sqrt().max(tiny).recip()
}

/// Adds what is given in a small step to what was given in those before.
#[inline(always)]
pub(super) fn count<M: Machine>(k: &mut M, t: &ContactTables) {
    let only = k.index(0);
    let given = k.spatial(t.manifold, only, manifold::DRAG);
    add(k, t, given.angular, given.linear);
}

/// Adds a drag and a twist to the sums of the step, which are about the mean of the points.
#[inline(always)]
fn add<M: Machine>(k: &mut M, t: &ContactTables, drag: Vec3<M::R>, twist: Vec3<M::R>) {
    let only = k.index(0);
    let turning = k.vec3(t.manifold, only, manifold::OFFSET).cross(drag);
    let given = Spatial::new(drag, twist + turning);
    let sum = k.spatial(t.manifold, only, manifold::DRAG_SUM);
    k.store_spatial(t.manifold, only, manifold::DRAG_SUM, sum + given);
}

/// No longer than `most`.
#[inline(always)]
fn within<R: Real>(v: Vec3<R>, most: R) -> Vec3<R> {
    v * (most / v.length().max(R::lit(1e-30))).min(R::one())
}
