//! Bodies on their own: loading, pushing, and the free flight of a substep.
//!
//! A body that nothing holds keeps its angular momentum L = I ω. Over a substep
//! it turns by the rate at the midpoint, and its new rate is that of L at its
//! new orientation, which is second order and keeps L to rounding:
//!
//! ```text
//! q½ = exp(h/2 ω) q    ω½ = I(q½)⁻¹ L    q' = exp(h ω½) q    ω' = I(q')⁻¹ L
//! ```
//!
//! Turns of up to 1 rad per substep are exact to rounding of `f32`; longer ones are not.
//!
//! Departure from Müller et al. 2020 (alg. 2), where the gyroscopic torque is
//! taken explicitly.

use super::tables::{Tables, global};
use numbers::spatial::Spatial;
use numbers::{Machine, Pose, Quat, Real, SymMat3, Vec3};

/// A body as a constraint sees it: own pose, twist at its centre, inverse mass and inertia.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<R> {
    pub pose: Pose<R>,
    pub twist: Spatial<R>,
    /// 1/m.
    pub m: R,
    /// I⁻¹, world axes.
    pub i: SymMat3<R>,
}

impl<R: Real> Body<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &Tables, row: M::I) -> Self {
        Self {
            pose: k.pose(t.pose, row, 0),
            twist: k.spatial(t.twist, row, 0),
            m: k.load(t.mass, row, 0),
            i: k.sym(t.inverse_inertia, row, 0),
        }
    }
    #[inline(always)]
    pub fn store<M: Machine<R = R>>(&self, k: &mut M, t: &Tables, row: M::I) {
        k.store_pose(t.pose, row, 0, self.pose);
        k.store_spatial(t.twist, row, 0, self.twist);
    }
    /// A position impulse: λ [kg·m] through the centre, and its moment [kg·m²].
    ///
    /// The delta form: what moves the body within the substep also changes its
    /// velocity by the same over h.
    #[inline(always)]
    pub fn push(&mut self, linear: Vec3<R>, angular: Vec3<R>, over_h: R) {
        let (shift, turn) = (linear * self.m, self.i * angular);
        self.pose.p += shift;
        self.pose.q = turned(self.pose.q, turn);
        self.twist = Spatial::new(turn, shift).fma(over_h, self.twist);
    }
    /// An impulse [N·s] through the centre, and its moment [N·m·s]: changes the twist only.
    #[inline(always)]
    pub fn kick(&mut self, linear: Vec3<R>, angular: Vec3<R>) {
        let change = Spatial::new(self.i * angular, linear * self.m);
        self.twist = self.twist + change;
    }
}

/// q ← normalise(q + ½ (r, 0) q): a small rotation r (Müller et al. 2020, eq. 8).
#[inline(always)]
fn turned<R: Real>(q: Quat<R>, r: Vec3<R>) -> Quat<R> {
    let d = Quat::from_parts(r * R::lit(0.5), R::zero()) * q;
    Quat::new(q.x + d.x, q.y + d.y, q.z + d.z, q.w + d.w).nearly_normalized()
}

/// Keeps the poses and twists with which the substep starts.
#[inline(always)]
pub(crate) fn save<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.rows) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        k.store_pose(t.saved_pose, row, 0, pose);
        k.store_spatial(t.before, row, 0, twist);
    }
}

/// Inverse inertias at the present orientations.
#[inline(always)]
pub(crate) fn inverse_inertias<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.rows) {
        let i = SymMat3::rotated_diagonal(k.quat(t.pose, row, 3).to_mat3(), k.vec3(t.mass, row, 1));
        k.store_sym(t.inverse_inertia, row, 0, i);
    }
}

/// Gravity acts; bodies fly. The rotation is done in the body's axes, where I is a
/// diagonal: with L the angular momentum there, δ = exp(h/2 ω) and E = exp(h δ ω½),
/// ω½ = I⁻¹ δ⁻¹ L, q' = q E and ω' = I⁻¹ E⁻¹ L.
#[inline(always)]
pub(crate) fn fly<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let world = k.index(0);
    let gravity = k.vec3(t.global, world, global::GRAVITY);
    let fade = (h * k.load(t.global, world, global::ANGULAR_DAMPING) + M::R::one()).recip();
    for row in k.range(k.index(1), k.index(t.rows)) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let v = gravity.fma(h, twist.linear);
        let inverse = k.vec3(t.mass, row, 1);
        let w = pose.q.rotate_inverse(twist.angular) * fade;
        let l = w.times(k.vec3(t.mass, row, 5));
        let half = Quat::exp_short(w * (h * M::R::lit(0.5)));
        let rate = half.rotate(half.rotate_inverse(l).times(inverse));
        let turn = Quat::exp_short(rate * h);
        let q = (pose.q * turn).normalized();
        let w = q.rotate(turn.rotate_inverse(l).times(inverse));
        k.store_pose(t.pose, row, 0, Pose::new(v.fma(h, pose.p), q));
        k.store_spatial(t.twist, row, 0, Spatial::new(w, v));
        k.store_sym(
            t.inverse_inertia,
            row,
            0,
            SymMat3::rotated_diagonal(q.to_mat3(), inverse),
        );
    }
    // The world's: zero.
    k.store_sym(t.inverse_inertia, world, 0, SymMat3::zero());
}
