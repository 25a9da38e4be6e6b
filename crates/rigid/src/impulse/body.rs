//! A body between contacts: forces, motion within a step, and the step's end.
//!
//! Gyroscopic torque acts as an acceleration α for the length H = n h of the step, which turns a free body by
//! exp(H w) with the mean spin w (`gyroscopic`); then the spin is set to what the angular momentum L, and
//! the impulses that changed it, make of the new orientation q':
//!
//! ```text
//! Σ h (ω + k h α) = H w,  k = 1 … n,  so  α = 2 n / (n + 1) · (w − ω) / H
//! L = I(q) (ω − H α)    ω' = I(q')⁻¹ L
//! ```

use super::tables::{BodyTables, global, grip, mass, row};
use crate::gyroscopic::mean_turn;
use numbers::{Machine, Quat, Real, SymMat3, Vec3};

/// What pushes a body from outside: force f and torque τ of its free joint become those about its centre, in world axes.
///
/// ```text
/// F = R_f f     T = R τ + r × F
/// ```
#[inline(always)]
pub fn push<M: Machine>(k: &mut M, t: &BodyTables) {
    let only = k.index(0);
    let own = k.quat(t.body, only, row::ORIENTATION);
    let frame = k.pose(t.grip, only, grip::FRAME);
    let f = k.vec3(t.body, only, row::WRENCH);
    let force = k.quat(t.grip, only, grip::FORCE_FRAME).rotate(f);
    let torque = (own * frame.q).rotate(k.vec3(t.body, only, row::WRENCH + 3));
    let arm = own.rotate(frame.p);
    k.store_vec3(t.body, only, row::WRENCH, force);
    k.store_vec3(t.body, only, row::WRENCH + 3, torque + arm.cross(force));
}

/// The beginning of a step: inverse inertia and accelerations.
#[inline(always)]
pub fn begin<M: Machine>(k: &mut M, t: &BodyTables) {
    let only = k.index(0);
    let q = k.quat(t.body, only, row::ORIENTATION);
    let moving: [M::R; 6] = k.read(t.body, only, row::VELOCITY);
    let m = k.load(t.mass, only, mass::INVERSE);
    let inverse_moments = k.vec3(t.mass, only, mass::INVERSE_MOMENTS);
    let i = SymMat3::rotated_diagonal(q.to_mat3(), inverse_moments);
    let spin = q.rotate_inverse(k.vec3(t.body, only, row::SPIN));
    let [h, rate, n] = k.read(t.global, only, global::STEP);
    let moments = SymMat3::new(k.vec3(t.mass, only, mass::MOMENTS), Vec3::zero());
    let mean = mean_turn(moments, spin, h * n);
    let often = M::R::lit(2.0) * rate / (n + M::R::one());
    let gyroscopic = q.rotate((mean - spin) * often);
    let force = k.vec3(t.body, only, row::WRENCH);
    let torque = k.vec3(t.body, only, row::WRENCH + 3);
    let gravity = k.vec3(t.global, only, global::GRAVITY);
    k.write(t.body, only, row::FREE, moving);
    k.store_vec3(t.body, only, row::SHIFT, Vec3::zero());
    k.store_vec3(t.body, only, row::TURN, Vec3::zero());
    k.store(t.body, only, row::INVERSE_MASS, m);
    k.store_sym(t.body, only, row::INVERSE_INERTIA, i);
    k.store_vec3(t.body, only, row::ACCELERATION, force.fma(m, gravity));
    k.store_vec3(t.body, only, row::ACCELERATION + 3, i * torque + gyroscopic);
}

/// The beginning of a small step: what acts for h, and with it, as the contacts gave `again` times in
/// the small step before.
#[inline(always)]
pub fn advance<M: Machine>(k: &mut M, t: &BodyTables, again: M::R) {
    let only = k.index(0);
    let h = k.load(t.global, only, global::STEP);
    let (v, w) = (
        k.vec3(t.body, only, row::VELOCITY),
        k.vec3(t.body, only, row::SPIN),
    );
    let given = v - k.vec3(t.body, only, row::FREE);
    let turned = w - k.vec3(t.body, only, row::FREE + 3);
    let free = k.vec3(t.body, only, row::ACCELERATION).fma(h, v);
    let spin = k.vec3(t.body, only, row::ACCELERATION + 3).fma(h, w);
    k.store_vec3(t.body, only, row::FREE, free);
    k.store_vec3(t.body, only, row::FREE + 3, spin);
    k.store_vec3(t.body, only, row::VELOCITY, given.fma(again, free));
    k.store_vec3(t.body, only, row::SPIN, turned.fma(again, spin));
}

/// Takes what contacts have given, v − v_free, out of the free velocity's place, and puts v_free there again: done before
/// blows and after them, it makes these part of the free velocity, which the next small step does not give again.
#[inline(always)]
pub fn part<M: Machine>(k: &mut M, t: &BodyTables) {
    let only = k.index(0);
    for (free, now) in [(row::FREE, row::VELOCITY), (row::FREE + 3, row::SPIN)] {
        let other = k.vec3(t.body, only, now) - k.vec3(t.body, only, free);
        k.store_vec3(t.body, only, free, other);
    }
}

/// Moves for h.
#[inline(always)]
pub fn drift<M: Machine>(k: &mut M, t: &BodyTables) {
    let only = k.index(0);
    let h = k.load(t.global, only, global::STEP);
    let shift = k.vec3(t.body, only, row::SHIFT);
    let turn = k.vec3(t.body, only, row::TURN);
    let shift = k.vec3(t.body, only, row::VELOCITY).fma(h, shift);
    let turn = k.vec3(t.body, only, row::SPIN).fma(h, turn);
    k.store_vec3(t.body, only, row::SHIFT, shift);
    k.store_vec3(t.body, only, row::TURN, turn);
}

/// The end of a step: the new place, and the spin that belongs to it.
#[inline(always)]
pub fn finish<M: Machine>(k: &mut M, t: &BodyTables) {
    let only = k.index(0);
    let long = k.load(t.global, only, global::STEP) * k.load(t.global, only, global::STEPS);
    let (moments, inverse) = (
        k.vec3(t.mass, only, mass::MOMENTS),
        k.vec3(t.mass, only, mass::INVERSE_MOMENTS),
    );
    let q = k.quat(t.body, only, row::ORIENTATION);
    let before = q.rotate_inverse(k.vec3(t.body, only, row::SPIN));
    let torque = q
        .rotate_inverse(k.vec3(t.body, only, row::WRENCH + 3))
        .times(inverse);
    let all = q.rotate_inverse(k.vec3(t.body, only, row::ACCELERATION + 3));
    let gyroscopic = all - torque;
    let l = q.rotate(gyroscopic.fma(-long, before).times(moments));
    let q = (Quat::exp(k.vec3(t.body, only, row::TURN)) * q).normalized();
    let w = q.rotate(q.rotate_inverse(l).times(inverse));
    let center = k.vec3(t.body, only, row::CENTER) + k.vec3(t.body, only, row::SHIFT);
    k.store_vec3(t.body, only, row::CENTER, center);
    k.store_quat(t.body, only, row::ORIENTATION, q);
    k.store_vec3(t.body, only, row::SPIN, w);
}
