//! Targets of drives, which follow what the controller sets.
//!
//! A target θ* follows its goal θ̂ with the drive's control time T, once in a step, or a part of one, of length H, implicit in
//! time:
//!
//! ```text
//! θ* ← θ* + s (θ̂ − θ*),    s = H/(T + H)
//! q* ← q* exp(s log(q*⁻¹ q̂))                                              of a ball
//! ```
//!
//! Where whole turns do not count, a goal is reached, and a coordinate pulled, the short way round.

use super::super::tables::global;
use super::tables::{JointTables, ROWS, axis, axis_link, joint, law};
use numbers::{Machine, Quat, Real, Vec3};

/// The targets of a joint's drives follow, and the drives' laws pull towards them.
#[inline(always)]
pub fn follow<M: Machine>(k: &mut M, t: &JointTables) {
    let only = k.index(0);
    let now: [M::R; ROWS] = k.read(t.joint, only, joint::TARGET);
    let ball = k.load(t.joint, only, joint::BALL).gt(M::R::zero());
    let turned = follow_ball(k, t, Quat::new(now[0], now[1], now[2], now[3]));
    let turned = [turned.x, turned.y, turned.z, turned.w];
    for row in 0..ROWS {
        let i = k.index(row);
        let [goal, time, reference, turns] = k.read(t.axis, i, axis::GOAL);
        let drives = time.ge(M::R::zero());
        let turns = turns.gt(M::R::zero());
        // The goal by itself first: of many turns less the target, rounding would leave more than those that are near.
        let way = around(around(goal, turns) - now[row], turns);
        let target = way.fma(share(k, t, time), now[row]);
        let kept = if row < 4 { turned[row] } else { now[row] };
        k.store(
            t.joint,
            only,
            joint::TARGET + row,
            M::R::select(ball, kept, target),
        );
        let rest = target - reference;
        // Coordinates along axes, the last three, never turn.
        let rest = if row < 3 {
            let angle = k.load(t.joint, only, joint::ANGLE + row);
            M::R::select(turns, angle + around(rest - angle, turns), rest)
        } else {
            rest
        };
        let rest = M::R::select(ball, M::R::zero(), rest);
        pull(k, t, i, rest, drives);
    }
}

/// A ball's target; as it was where there is no drive.
#[inline(always)]
fn follow_ball<M: Machine>(k: &M, t: &JointTables, now: Quat<M::R>) -> Quat<M::R> {
    let goal = Vec3::new(
        k.load(t.axis, k.index(0), axis::GOAL),
        k.load(t.axis, k.index(1), axis::GOAL),
        k.load(t.axis, k.index(2), axis::GOAL),
    );
    let time = k.load(t.axis, k.index(0), axis::TIME);
    let way = (now.conjugate() * Quat::exp(goal)).log();
    let after = (now * Quat::exp(way * share(k, t, time))).normalized();
    Quat::select(time.ge(M::R::zero()), after, now)
}

/// s; 0 where there is no drive.
#[inline(always)]
fn share<M: Machine>(k: &M, t: &JointTables, time: M::R) -> M::R {
    let [h, _, steps] = k.read(t.global, k.index(0), global::STEP);
    let long = h * steps;
    let share = long / (time.max(M::R::zero()) + long);
    M::R::select(time.ge(M::R::zero()), share, M::R::zero())
}

/// A way, the short way round where whole turns do not count.
#[inline(always)]
pub(super) fn around<R: Real>(way: R, turns: R::Mask) -> R {
    let tau = core::f64::consts::TAU;
    let whole = (way * R::lit(1.0 / tau)).round();
    // In two parts, the first of few digits, so that many turns take away no more than they are.
    let rough = tau as f32;
    let rough = f64::from(f32::from_bits(rough.to_bits() & 0xffff_f000));
    let left = whole.fnma(R::lit(rough), way);
    R::select(turns, whole.fnma(R::lit(tau - rough), left), way)
}

/// The drive's law, the first of its row, has this rest.
#[inline(always)]
fn pull<M: Machine>(
    k: &mut M,
    t: &JointTables,
    row: M::I,
    rest: M::R,
    drives: <M::R as Real>::Mask,
) {
    let first = k.link(t.links, row, axis_link::FIRST);
    let end = k.link(t.links, row, axis_link::END);
    if let Some(_branch) = k.when(k.less(first, end)) {
        let other = k.load(t.law, first, law::REST);
        k.store(t.law, first, law::REST, M::R::select(drives, rest, other));
    }
}
