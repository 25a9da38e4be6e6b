//! Contacts between bodies that move: impulses by projected Gauss–Seidel on the tree's own factor.
//!
//! The rows of each point of contact are [on the tree's factor](super::factor). Its impulses λ [N·s] start at
//! those of the last step, which act as forces while the contacts with the ground are settled; z = Yᵀ Δλ is for
//! what is added to them. A pass over the rows, whose velocities are u⁰ + y · z, solves
//!
//! ```text
//! normal    uₙ + λₙ / (h cₙ) = u*,  λₙ ≥ 0
//! friction  uₜ = 0,  |λₜ| ≤ μ λₙ
//! ```
//!
//! one contact after the other (Jourdan, Alart & Jean 1998; cₙ and u* as in
//! [`contact`](super::contact)). Both tangents take one scalar step, and are shortened together. What joints that
//! close loops ([`closing`](super::closing)) and couplings ([`coupling`](super::coupling)) lock is solved at once at the
//! end of each pass ([`locked`](super::locked)).
//!
//! Departures from the exact solution: as many passes as `Settings::contact_iterations`; contacts with
//! the ground give way to what is added as springs do, but neither open nor close by it in that step;
//! a contact that did not press takes part if the two come half of the gap nearer without impulses, or
//! almost meet, so that one which only the impulses of others close begins a step late.

use super::closing;
use super::contact::{self, at, bias, impedance, law, load, rate};
use super::coupling;
use super::factor::{self, Keep, Path, response, seen_from_a};
use super::locked;
use super::tables::{Tables, frame, node, touch_link};
use super::turning;
use crate::contacts::{found, slot, slot_link};
use numbers::machine::space::Scratch;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Mat3, Real, Table, Vec3};

/// Smallest response of a row [1/kg], so that two bodies that cannot move do not divide by zero.
const STIFFEST: f64 = 1e-12;

/// Change of an impulse, as a share of the largest, that needs no further pass.
const SMALL: f64 = 1e-3;

/// Speed, in g h, by which two are taken to meet though they do not quite.
const ALMOST: f64 = 2.0;

/// Fields of [`Tables::impulse`], a row for each slot between bodies that move.
pub(crate) mod impulse {
    /// u⁰ along the normal and both tangents, 3.
    pub const VELOCITY: usize = 0;
    /// u*, and 1 / (h cₙ).
    pub const TARGET: usize = 3;
    /// Reciprocal responses: of the normal row with its softness, of a tangent.
    pub const RESPONSE: usize = 5;
    /// λ, 3.
    pub const LAMBDA: usize = 7;
    /// First tangent, 3.
    pub const TANGENT: usize = 10;
    pub const WIDTH: usize = 13;
}

/// Normal and two tangents (Duff et al. 2017, listing 3), the first of them kept from step to step
/// by the normal alone.
#[inline(always)]
fn basis<R: Real>(n: Vec3<R>) -> Mat3<R> {
    let sign = R::one().copysign(n.z);
    let a = -(sign + n.z).recip();
    let b = n.x * n.y * a;
    let first = Vec3::new(R::one() + sign * n.x * n.x * a, sign * b, -(sign * n.x));
    let second = Vec3::new(b, sign + n.y * n.y * a, -n.y);
    Mat3::from_columns(n, first, second)
}

/// Lets the forces of the last step act where the same features touch still.
///
/// The passes over the contacts with the ground then know what presses on them.
#[inline(always)]
pub(crate) fn begin<M: Machine>(k: &mut M, t: &Tables) {
    factor::clear(k, t);
    closing::press(k, t);
    coupling::press(k, t);
    for place in between(k, t) {
        let s = t.contacts.found.row(k, place);
        if t.strangers {
            center(k, t, s);
        }
        let (f, same) = (kept(k, t, s), same(k, t, s));
        press(k, t, s, f, same);
    }
}

/// Lets the forces of [`Tables::kept`] act, which [`contact::recall`](super::contact::recall) has read.
#[inline(always)]
pub(crate) fn recall<M: Machine>(k: &mut M, t: &Tables) {
    factor::clear(k, t);
    closing::press(k, t);
    coupling::press(k, t);
    for place in between(k, t) {
        let s = t.contacts.found.row(k, place);
        let (f, known) = (k.vec3(t.load, s, load::FORCE_0), t.kept.known(k, s));
        press(k, t, s, f, known);
    }
}

/// Force [N] of the last step on B, where the same features touch.
#[inline(always)]
fn kept<M: Machine>(k: &M, t: &Tables, s: M::I) -> Vec3<M::R> {
    Vec3::select(same(k, t, s), t.kept.force(k, s), Vec3::zero())
}

/// Where the same features touch as in the last step.
#[inline(always)]
fn same<M: Machine>(k: &M, t: &Tables, s: M::I) -> <M::R as Real>::Mask {
    let feature = k.load(t.contacts.slot, s, slot::FEATURE);
    t.kept.same(k, s, feature) & t.contacts.near(k, s)
}

/// Adds a force on B, and its reaction on A; and the torque of the last step, in the lanes of `known`.
#[inline(always)]
fn press<M: Machine>(k: &mut M, t: &Tables, s: M::I, f: Vec3<M::R>, known: <M::R as Real>::Mask) {
    let couple = k.link(t.touch_links, s, touch_link::COUPLE);
    let x = k.vec3(t.contacts.slot, s, slot::POSITION);
    let torque = if t.grips {
        turning::kept(k, t, s, known)
    } else {
        Vec3::zero()
    };
    factor::press(k, t, couple, x, Spatial::new(torque, f));
}

/// Normal and tangents of a contact that takes part.
#[inline(always)]
pub(crate) fn directions<M: Machine>(k: &M, t: &Tables, s: M::I) -> Mat3<M::R> {
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let first = k.vec3(t.impulse, s, impulse::TANGENT);
    Mat3::from_columns(n, first, n.cross(first))
}

/// Impulses of the contacts between bodies that move, and of what closes loops, and the accelerations that
/// they add.
///
/// Needs the accelerations under the forces of [`begin`].
#[inline(always)]
pub(crate) fn gauss_seidel<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let (zero, first) = (M::R::zero(), k.index(0));
    let mut any = k.cell(zero);
    t.acting.clear(k, 0);
    for place in between(k, t) {
        let s = t.contacts.found.row(k, place);
        let on = approach(k, t, s, h);
        any.write(any.read().max(on));
        if let Some(_branch) = k.if_any(on.gt(zero)) {
            t.acting.append(k, first, s);
        }
    }
    if t.locked.count > 0 {
        any.write(M::R::one());
    }
    if let Some(_branch) = k.if_any(any.read().gt(zero)) {
        factor::begin(k, t);
        for place in t.acting.places(k, first) {
            let s = t.acting.row(k, place);
            row(k, t, s, h);
        }
        closing::rows(k, t, h);
        coupling::rows(k, t, h);
        locked::begin(k, t, h);
        iterate(k, t);
        locked::keep(k, t);
        factor::respond(k, t);
        contact::give(k, t, h);
    }
}

/// Passes over the contacts, and what closes loops, until nothing changes by more than [`SMALL`].
///
/// A lane that has come so far stands still, so that its bits do not depend on its neighbours'.
#[inline(always)]
fn iterate<M: Machine>(k: &mut M, t: &Tables) {
    let (zero, one) = (M::R::zero(), M::R::one());
    let mut moves = k.cell(one);
    for _ in k.count(t.iterations) {
        let on = moves.read();
        let mut change = k.cell(zero);
        let mut most = k.cell(zero);
        for place in t.acting.places(k, k.index(0)) {
            let s = t.acting.row(k, place);
            if let Some(_branch) = k.if_any((on * k.load(t.takes_part, s, 0)).gt(zero)) {
                let (step, size) = relax(k, t, s, on);
                change.write(change.read().max(step));
                most.write(most.read().max(size));
            }
        }
        if t.locked.count > 0 {
            let (step, size) = locked::solve(k, t, on);
            change.write(change.read().max(step));
            most.write(most.read().max(size));
        }
        let open = change.read().gt(most.read() * M::R::lit(SMALL * SMALL));
        let next = M::R::select(open, on, zero);
        moves.write(next);
        if k.finished(next.same(zero)) {
            break;
        }
    }
}

/// Where the contacts between bodies that move are listed.
#[inline(always)]
pub(crate) fn between<M: Machine>(k: &M, t: &Tables) -> M::Rounds {
    t.contacts.found.places(k, k.index(found::BETWEEN))
}

/// Velocities without impulses, u* and softness of a contact that is near; 1 where it takes part.
#[inline(always)]
fn approach<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) -> M::R {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let couple = k.link(t.touch_links, s, touch_link::COUPLE);
    let distance = k.load(t.contacts.slot, s, slot::DISTANCE);
    let e = basis(k.vec3(t.contacts.slot, s, slot::NORMAL));
    let x = k.vec3(t.contacts.slot, s, slot::POSITION);
    let x_a = seen_from_a(k, t, couple, x);
    let [_, _, a, b] = k.link_row::<_, 4>(t.couple_links, couple);
    let (now, other) = (moves(k, t, s, 0, b, x, h), moves(k, t, s, 1, a, x_a, h));
    let (speed, u) = (e.x.dot(now.0 - other.0), e.transpose_mul(now.1 - other.1));
    if t.contacts.sticks {
        let v = now.0 - other.0;
        contact::stick(k, t, s, pair, e.x.fma(-speed, v), h);
    }
    let borne = kept(k, t, s);
    let free = [speed, M::R::zero()];
    let (target, c) = impedance(k, t, pair, distance, free, e.x.dot(borne), h);
    let known = [u.x, u.y, u.z, target, (h * c).recip()];
    k.write(t.impulse, s, impulse::VELOCITY, known);

    let half = distance * M::R::lit(-0.5) * rate(k, t);
    let almost = k.vec3(t.world, k.index(0), 0).length() * h * M::R::lit(ALMOST);
    let meets = u.x.lt(target.max(half) + almost);
    let pressed = borne.length_squared().gt(M::R::zero());
    let on = (meets | pressed) & t.contacts.near(k, s);
    let on = M::R::select(on, M::R::one(), M::R::zero());
    k.store(t.takes_part, s, 0, on);
    on
}

/// What is too fast would, stopped at a corner, turn past the other within the step: so the lighter is stopped before its
/// centre of mass.
#[inline(always)]
fn center<M: Machine>(k: &mut M, t: &Tables, s: M::I) {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let couple = k.link(t.touch_links, s, touch_link::COUPLE);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let x = k.vec3(t.contacts.slot, s, slot::POSITION);
    let x_a = seen_from_a(k, t, couple, x);
    let [_, _, a, b] = k.link_row::<_, 4>(t.couple_links, couple);
    let v_a = k.spatial(t.frame, a, frame::TWIST);
    let v_b = k.spatial(t.frame, b, frame::TWIST);
    let fastest = k.load(t.law, pair, law::FASTEST);
    let fast = n.dot(at(v_b, x) - at(v_a, x_a)).lt(-fastest);
    if let Some(_branch) = k.if_any(fast) {
        let c_a = contact::center_of(k, t, a);
        let c_b = contact::center_of(k, t, b);
        let m_a = k.load(t.node, a, node::MASS);
        let m_b = k.load(t.node, b, node::MASS);
        let flies = n.dot(at(v_b, c_b) - at(v_a, c_a));
        let arm = Vec3::select(m_b.le(m_a), x - c_b, x_a - c_a);
        let aside = n.fma(-n.dot(arm), arm);
        let stopped = Vec3::select(fast & flies.lt(-fastest), x - aside, x);
        k.store_vec3(t.contacts.slot, s, slot::POSITION, stopped);
    }
}

/// The rows of a contact that takes part: y, responses, λ.
#[inline(always)]
fn row<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) {
    let e = basis(k.vec3(t.contacts.slot, s, slot::NORMAL));
    let a = responses(k, t, s, e);
    let tiny = M::R::lit(STIFFEST);
    let softness = k.load(t.impulse, s, impulse::TARGET + 1);
    let on = k.load(t.takes_part, s, 0);
    let normal = on / (a.x + softness).max(tiny);
    let tangent = on / a.y.max(a.z).max(tiny);
    k.write(t.impulse, s, impulse::RESPONSE, [normal, tangent]);
    k.store_vec3(t.impulse, s, impulse::TANGENT, e.y);
    let lambda = e.transpose_mul(kept(k, t, s) * h);
    k.store_vec3(t.impulse, s, impulse::LAMBDA, lambda);
    if t.grips {
        let torque = turning::kept(k, t, s, same(k, t, s));
        turning::row(k, t, s, e, torque, h);
    }
}

/// Three numbers an entry, from a row on.
impl<M: Machine> Keep<M> for (Table<Scratch, 3>, M::I) {
    #[inline(always)]
    fn keep(&self, k: &mut M, i: M::I, y: Vec3<M::R>) {
        k.store_vec3(self.0, self.1.plus(i), 0, y);
    }
}

/// y of the three directions of a contact; returns their squares y · y [1/kg].
#[inline(always)]
fn responses<M: Machine>(k: &mut M, t: &Tables, s: M::I, e: Mat3<M::R>) -> Vec3<M::R> {
    let couple = k.link(t.touch_links, s, touch_link::COUPLE);
    let to = (t.entry, k.link(t.touch_links, s, touch_link::ENTRY));
    let x = k.vec3(t.contacts.slot, s, slot::POSITION);
    let against = Mat3::from_columns(-e.x, -e.y, -e.z);
    let on_a = factor::forces(seen_from_a(k, t, couple, x), against);
    let on_b = factor::forces(x, e);
    factor::rows(k, t, Path::of(k, t, couple), &to, [on_a, on_b])
}

/// Velocity of one side's node at x before the step, and after it without impulses.
#[inline(always)]
fn moves<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    side: usize,
    node: M::I,
    x: Vec3<M::R>,
    h: M::R,
) -> (Vec3<M::R>, Vec3<M::R>) {
    let v = at(k.spatial(t.frame, node, frame::TWIST), x);
    let a = bias(k, t, s, side, node, x) + at(k.spatial(t.frame, node, frame::ACCELERATION), x);
    (v, a.fma(h, v))
}

/// Three velocities of a contact, which were so without impulses and have these y.
#[inline(always)]
pub(crate) fn velocity<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    (entries, first): (Table<Scratch, 3>, M::I),
    without: Vec3<M::R>,
) -> Vec3<M::R> {
    let path = Path::of(k, t, k.link(t.touch_links, s, touch_link::COUPLE));
    let mut velocity = without.hold(k);
    for i in path.entries(k) {
        let v = path.dof(k, t, i);
        let z = k.load(t.response, v, response::Z);
        velocity.set(k.vec3(entries, first.plus(i), 0).fma(z, velocity.get()));
    }
    velocity.get()
}

/// Adds impulses of a contact, of rows with these y, to z.
#[inline(always)]
pub(crate) fn push<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    (entries, first): (Table<Scratch, 3>, M::I),
    lambda: Vec3<M::R>,
) {
    let path = Path::of(k, t, k.link(t.touch_links, s, touch_link::COUPLE));
    for i in path.entries(k) {
        let v = path.dof(k, t, i);
        let y = k.vec3(entries, first.plus(i), 0);
        let z = k.load(t.response, v, response::Z) + y.dot(lambda);
        k.store(t.response, v, response::Z, z);
    }
}

/// One contact of one pass, where `on` is 1; squares of the change of its impulse, and of the impulse.
#[inline(always)]
fn relax<M: Machine>(k: &mut M, t: &Tables, s: M::I, on: M::R) -> (M::R, M::R) {
    let entries = (t.entry, k.link(t.touch_links, s, touch_link::ENTRY));
    let u = velocity(k, t, s, entries, k.vec3(t.impulse, s, impulse::VELOCITY));
    let [target, softness, normal, tangent] = k.read(t.impulse, s, impulse::TARGET);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let friction = contact::friction(k, t, s, pair);
    let old = k.vec3(t.impulse, s, impulse::LAMBDA);

    let zero = M::R::zero();
    let error = softness.fma(old.x, u.x - target);
    let n = normal.fnma(error, old.x).max(zero);
    let (one, two) = (tangent.fnma(u.y, old.y), tangent.fnma(u.z, old.z));
    let length = one.fma(one, two * two).sqrt();
    let limit = friction * n;
    let share = limit / length.max(limit).max(M::R::lit(STIFFEST));
    let new = Vec3::new(n, one * share, two * share);
    let step = (new - old) * on;
    let new = old + step;
    k.store_vec3(t.impulse, s, impulse::LAMBDA, new);
    push(k, t, s, entries, step);
    let mut change = step.length_squared();
    if t.grips {
        change += turning::relax(k, t, s, new.x, on);
    }
    (change, new.length_squared())
}

/// Force [N] on B of a contact that is near.
#[inline(always)]
pub(crate) fn force<M: Machine>(k: &M, t: &Tables, s: M::I) -> Vec3<M::R> {
    let lambda = k.vec3(t.impulse, s, impulse::LAMBDA) * rate(k, t);
    let force = directions(k, t, s) * lambda;
    let on = k.load(t.takes_part, s, 0).gt(M::R::zero());
    Vec3::select(on, force, Vec3::zero())
}
