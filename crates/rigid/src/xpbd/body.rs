//! Bodies on their own: loading, pushing, and the free flight of a substep.
//!
//! A body that nothing holds keeps its angular momentum L = I ω. Over a substep it
//! turns by the [mean spin](mean_turn) w, and its new
//! rate is that of L at its new orientation, which keeps L and the energy to rounding. In the
//! body's axes, where I is a diagonal:
//!
//! ```text
//! E = exp(h w)    q' = q E    ω' = I⁻¹ E⁻¹ L
//! ```
//!
//! Turns of up to 1 rad per substep are exact to rounding of `f32`; longer ones are not, but keep L.
//!
//! Departure from Müller et al. 2020 (alg. 2), where the gyroscopic torque is
//! taken explicitly.

use super::tables::{Tables, global, mass};
use crate::gyroscopic::mean_turn;
use numbers::machine::{Held, Hold};
use numbers::spatial::Spatial;
use numbers::{Machine, Pose, Quat, Real, SymMat3, Vec3};

/// How far |q|² may be from 1 for its length to be mended in first order.
const NEARBY: f64 = 1e-3;

/// A body as a constraint sees it: own pose, twist at its centre, inverse mass and inertia.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Body<R> {
    pub pose: Pose<R>,
    pub twist: Spatial<R>,
    /// 1/m.
    pub m: R,
    /// I⁻¹, world axes.
    pub i: SymMat3<R>,
    solid: Solid<R>,
}

impl<R: Real> Body<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &Tables, row: M::I) -> Self {
        Self {
            pose: k.pose(t.pose, row, 0),
            twist: k.spatial(t.twist, row, 0),
            m: k.load(t.mass, row, mass::INVERSE),
            i: k.sym(t.inverse_inertia, row, 0),
            solid: Solid::load(k, t, row),
        }
    }
    #[inline(always)]
    pub fn store<M: Machine<R = R>>(&self, k: &mut M, t: &Tables, row: M::I) {
        k.store_pose(t.pose, row, 0, self.pose);
        k.store_spatial(t.twist, row, 0, self.twist);
    }
    /// As it was, where the mask holds.
    #[inline(always)]
    pub fn unless(self, mask: R::Mask, was: Self) -> Self {
        let (pose, twist) = (self.pose, self.twist);
        let p = Vec3::select(mask, was.pose.p, pose.p);
        let q = Quat::select(mask, was.pose.q, pose.q);
        let angular = Vec3::select(mask, was.twist.angular, twist.angular);
        let linear = Vec3::select(mask, was.twist.linear, twist.linear);
        Self {
            pose: Pose::new(p, q),
            twist: Spatial::new(angular, linear),
            ..self
        }
    }
    /// A position impulse: λ [kg·m] through the centre, and its moment [kg·m²]; `more` is added to
    /// the angular momentum [kg·m²/s] without a turn.
    ///
    /// The delta form: what moves the body within the substep also changes its
    /// velocity by the same over h. Returns by how much it moved.
    #[inline(always)]
    pub fn push(
        &mut self,
        linear: Vec3<R>,
        angular: Vec3<R>,
        more: Vec3<R>,
        over_h: R,
    ) -> Spatial<R> {
        let moved = Spatial::new(self.i * angular, linear * self.m);
        let (q, v) = (self.pose.q, self.twist);
        let more = angular.fma(over_h, more);
        let (q, spin) = self.solid.turned(q, v.angular, moved.angular, more);
        self.pose = Pose::new(self.pose.p + moved.linear, q);
        self.twist = Spatial::new(spin, moved.linear.fma(over_h, v.linear));
        moved
    }
}

/// A body as it turns: mass, principal moments of inertia, and their reciprocals.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Solid<R> {
    pub mass: R,
    moments: Vec3<R>,
    inverse: Vec3<R>,
}

impl<R: Real> Solid<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &Tables, row: M::I) -> Self {
        let [a, b, c, mass, x, y, z] = k.read(t.mass, row, mass::INVERSE_MOMENTS);
        Self {
            mass,
            moments: Vec3::new(x, y, z),
            inverse: Vec3::new(a, b, c),
        }
    }
    /// Orientation and spin after a small turn r, with the angular momentum that it had with `spin`,
    /// and `more`.
    #[inline(always)]
    pub fn turned(
        self,
        q: Quat<R>,
        spin: Vec3<R>,
        r: Vec3<R>,
        more: Vec3<R>,
    ) -> (Quat<R>, Vec3<R>) {
        let after = turned(q, r);
        let (from, to) = (q.to_mat3(), after.to_mat3());
        let l = from * from.transpose_mul(spin).times(self.moments) + more;
        (after, to * to.transpose_mul(l).times(self.inverse))
    }
}

/// q ← normalise(q + ½ (r, 0) q): a small rotation r (Müller et al. 2020, eq. 8).
#[inline(always)]
fn turned<R: Real>(q: Quat<R>, r: Vec3<R>) -> Quat<R> {
    let (half, v) = (r * R::lit(0.5), q.vector());
    let vector = half.fma(q.w, v) + half.cross(v);
    Quat::from_parts(vector, q.w - half.dot(v)).nearly_normalized()
}

/// Inverse inertias at the present orientations.
#[inline(always)]
pub(crate) fn inverse_inertias<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.rows) {
        let i = SymMat3::rotated_diagonal(
            k.quat(t.pose, row, 3).to_mat3(),
            k.vec3(t.mass, row, mass::INVERSE_MOMENTS),
        );
        k.store_sym(t.inverse_inertia, row, 0, i);
    }
}

/// From the centre to the joint that carries a body, for all bodies as they now are.
#[inline(always)]
pub(crate) fn arms<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.count(t.rows) {
        let arm = k
            .quat(t.pose, row, 3)
            .rotate(k.vec3(t.mass, row, mass::ANCHOR));
        k.store_vec3(t.arm, row, 0, arm);
    }
}

/// Scaled to unit length: in first order of |q|² − 1, but where a turn was too long for its series.
#[inline(always)]
fn unit<M: Machine>(k: &M, q: Quat<M::R>) -> Quat<M::R> {
    near_or_unit(k, q, q.nearly_normalized())
}

/// `near` where the length of q is about 1, and q scaled to it elsewhere.
#[inline(always)]
fn near_or_unit<M: Machine>(k: &M, q: Quat<M::R>, near: Quat<M::R>) -> Quat<M::R> {
    let mut unit = near.hold(k);
    let is_near = (q.dot(q) - M::R::one()).abs().le(M::R::lit(NEARBY));
    if let Some(_branch) = k.if_any(!is_near) {
        unit.set(Quat::select(is_near, near, q.normalized()));
    }
    unit.get()
}

/// Gravity acts; bodies fly. What they leave is kept in `saved_pose` and `before`.
#[inline(always)]
pub(crate) fn fly<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let world = k.index(0);
    let gravity = k.vec3(t.global, world, global::GRAVITY);
    let fade = (h * k.load(t.global, world, global::ANGULAR_DAMPING) + M::R::one()).recip();
    k.store_vec3(t.arm, world, 0, Vec3::zero());
    for row in k.range(k.index(1), k.index(t.rows)) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        k.store_pose(t.saved_pose, row, 0, pose);
        k.store_spatial(t.before, row, 0, twist);
        let inverse = k.vec3(t.mass, row, mass::INVERSE_MOMENTS);
        let v = gravity.fma(h, twist.linear);
        let w = pose.q.rotate_inverse(twist.angular) * fade;
        let moments = k.vec3(t.mass, row, mass::MOMENTS);
        let l = w.times(moments);
        let mean = mean_turn(SymMat3::new(moments, Vec3::zero()), w, h);
        let turn = Quat::exp_short(mean * h);
        let turn = near_or_unit(k, turn, turn);
        let q = unit(k, pose.q * turn);
        let w = q.rotate(turn.rotate_inverse(l).times(inverse));
        k.store_pose(t.pose, row, 0, Pose::new(v.fma(h, pose.p), q));
        k.store_spatial(t.twist, row, 0, Spatial::new(w, v));
        k.store_vec3(t.arm, row, 0, q.rotate(k.vec3(t.mass, row, mass::ANCHOR)));
    }
}
