//! Blows: what meets faster than it rests, and parts again.
//!
//! Contacts that press share a blow out among them, and what they have shared cannot be bounced back: a row of balls
//! that touch would take the speed of the first as one body. So blows are struck first, at the beginning of a small step
//! in which, or in the relaxation after which, surfaces would be stopped, C + 2 h n·u < 0, one contact after the other, again and again until nothing meets faster
//! than it rests: what a blow hands to a body, the next one hands on with all of its speed. Of the laws for impacts at
//! once, this is the one that a cradle obeys (Smith et al., *Reflections on Simultaneous Impact*, 2012: reflections
//! contact by contact; Newton's and Poisson's laws for all of them together throw the struck row forwards as one).
//!
//! The points of one contact are struck together, so that what falls flat stays flat. Those that come with w = −n·u > 0
//! leave with v' by impulses λ ≥ 0, found by Gauss–Seidel for n·u + A λ ≥ v'. They are scaled so that energy keeps
//! the law, however far the sweeps have come:
//!
//! ```text
//! s = Σ λ (w + v') / λᵀA λ     ΔE = ½ s² λᵀA λ − s Σ λ w = −½ s Σ λ (w − v') ≤ 0
//! ```
//!
//! A blow comes before its time, at the gap C (`restitution`): v' ≤ w is e w for what is at the
//! surface and does not accelerate. Friction follows from the blow's own impulse, within its own limit.
//!
//! Bodies that are struck at once by several contacts take the blows in the order of colours, which is the same
//! whatever the threads and lanes, but not symmetric.

use super::contact::{Moved, Pair};
use super::friction;
use super::tables::{ContactTables, global, manifold, point, row};
use crate::restitution::early;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real};

/// Rounds in which blows are handed on within a small step, at most.
pub const ROUNDS: usize = 16;

/// Sweeps over the points of a contact.
const SWEEPS: usize = 4;

/// What free motion adds to the velocities of the points in a small step, from what it has just added to those of the
/// bodies; tells whether any contact could be struck within the step.
#[inline(always)]
pub fn foresee<M: Machine>(k: &mut M, t: &ContactTables) {
    let only = k.index(0);
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let restitution = k.load(t.manifold, only, manifold::RESTITUTION);
    let resting = k.load(t.global, only, global::RESTING);
    let steps = k.load(t.global, only, global::STEPS);
    let zero = M::R::zero();
    let pair = Pair::load(k, t);
    let mut fastest = k.cell(zero);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let arms = [
            k.vec3(t.point, i, point::ARM_A),
            k.vec3(t.point, i, point::ARM_B),
        ];
        let speed = pair.speed(&pair.along(normal, arms));
        let gain = speed - k.load(t.point, i, point::GAIN);
        k.store(t.point, i, point::GAIN, gain);
        let latest = steps.fma(gain.min(zero), speed);
        fastest.write(fastest.read().min(latest));
    }
    let may = fastest.read().lt(-resting) & restitution.gt(zero);
    k.store(
        t.manifold,
        only,
        manifold::STRUCK,
        M::R::select(may, M::R::one(), zero),
    );
}

/// Strikes the points that meet; tells whether there were any.
#[inline(always)]
pub fn strike<M: Machine>(k: &mut M, t: &ContactTables) {
    let only = k.index(0);
    let (zero, one) = (M::R::zero(), M::R::one());
    let mut pair = Pair::load(k, t);
    let moved = Moved::load(k, t, pair.masses());
    meet(k, t, &pair, &moved);
    let struck = k.load(t.manifold, only, manifold::STRUCK).gt(zero);
    if let Some(_branch) = k.if_any(struck) {
        let before = pair.motions();
        let normal = k.vec3(t.manifold, only, manifold::NORMAL);
        for i in k.range(only, k.link(t.points, only, 0)) {
            let along = pair.along(normal, moved.arms(k, t, i));
            pair.give(&along, k.load(t.point, i, point::BLOW));
        }
        scale(k, t, &mut pair, &moved, before);
        if let Some(_branch) = k.when(k.less(k.index(1), k.link(t.points, only, 0))) {
            for _ in k.count(SWEEPS) {
                sweep(k, t, &mut pair, &moved);
            }
            scale(k, t, &mut pair, &moved, before);
        }
        let (mut load, mut moment) = (k.cell(zero), k.cell(zero));
        for i in k.range(only, k.link(t.points, only, 0)) {
            let blow = k.load(t.point, i, point::BLOW);
            let [spread, sum] = k.read(t.point, i, point::SPREAD);
            k.store(t.point, i, point::SUM, sum + blow);
            load.write(load.read() + blow);
            moment.write(spread.fma(blow, moment.read()));
        }
        friction::strike(k, t, &mut pair, &moved, [load.read(), moment.read()]);
    }
    k.store(
        t.manifold,
        only,
        manifold::STRUCK,
        M::R::select(struck, one, zero),
    );
    pair.store(k, t);
}

/// The same where [`foresee`] has told that a blow may be; elsewhere nothing.
#[inline(always)]
pub fn strike_foreseen<M: Machine>(k: &mut M, t: &ContactTables) {
    let foreseen = k.load(t.manifold, k.index(0), manifold::STRUCK);
    if let Some(_branch) = k.if_any(foreseen.gt(M::R::zero())) {
        strike(k, t);
    }
}

/// Which points meet, with which speeds they are to leave, and a first guess of their impulses: what would stop each alone.
#[inline(always)]
fn meet<M: Machine>(k: &mut M, t: &ContactTables, pair: &Pair<M>, moved: &Moved<M::R>) {
    let only = k.index(0);
    let (zero, one, half) = (M::R::zero(), M::R::one(), M::R::lit(0.5));
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let restitution = k.load(t.manifold, only, manifold::RESTITUTION);
    let resting = k.load(t.global, only, global::RESTING);
    let [h, rate] = k.read(t.global, only, global::STEP);
    let nearer = normal.dot(moved.shift());
    let turns = [
        k.vec3(t.body, only, row::TURN),
        k.vec3(t.body, k.index(1), row::TURN),
    ];
    let mut any = k.cell(zero);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let arms = moved.arms(k, t, i);
        let along = pair.along(normal, arms);
        let speed = pair.speed(&along);
        let tilt = turns[1].cross(arms[1]) - turns[0].cross(arms[0]);
        let gap = k.load(t.point, i, point::GAP) + (nearer + normal.dot(tilt));
        let meets = restitution.gt(zero) & speed.lt(-resting) & (h + h).fma(speed, gap).lt(zero);

        let gained = -k.load(t.point, i, point::GAIN);
        let (w, lag) = (-speed, half * gained);
        let (leave, _) = early(restitution, w - lag, gained, gap * rate);
        let leave = (leave - lag).clamp(zero, w.max(zero));
        let bears = M::R::select(meets, w / pair.compliance(&along), zero);
        k.write(
            t.point,
            i,
            point::BLOW,
            [bears, M::R::select(meets, leave, -one)],
        );
        any.write(any.read().max(bears));
    }
    let any = M::R::select(any.read().gt(zero), one, zero);
    k.store(t.manifold, only, manifold::STRUCK, any);
}

/// One relaxation of the points that meet.
#[inline(always)]
fn sweep<M: Machine>(k: &mut M, t: &ContactTables, pair: &mut Pair<M>, moved: &Moved<M::R>) {
    let only = k.index(0);
    let zero = M::R::zero();
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let along = pair.along(normal, moved.arms(k, t, i));
        let [old, leave] = k.read(t.point, i, point::BLOW);
        let residual = leave - pair.speed(&along);
        let new = (old + residual / pair.compliance(&along)).max(zero);
        let new = M::R::select(leave.lt(zero), zero, new);
        pair.give(&along, new - old);
        k.store(t.point, i, point::BLOW, new);
    }
}

/// Scales the impulses, and what they have made of the motions of `before`, as energy asks.
#[inline(always)]
fn scale<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    pair: &mut Pair<M>,
    moved: &Moved<M::R>,
    before: [Spatial<M::R>; 2],
) {
    let only = k.index(0);
    let (zero, tiny) = (M::R::zero(), M::R::lit(1e-30));
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let (mut wanted, mut made) = (k.cell(zero), k.cell(zero));
    for i in k.range(only, k.link(t.points, only, 0)) {
        let along = pair.along(normal, moved.arms(k, t, i));
        let [blow, leave] = k.read(t.point, i, point::BLOW);
        let was = along.speed(before);
        wanted.write(blow.fma(leave - was, wanted.read()));
        made.write(blow.fma(pair.speed(&along) - was, made.read()));
    }
    let share = wanted.read() / made.read().max(tiny);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let blow = k.load(t.point, i, point::BLOW);
        k.store(t.point, i, point::BLOW, blow * share);
    }
    pair.go_on(before, share);
}
