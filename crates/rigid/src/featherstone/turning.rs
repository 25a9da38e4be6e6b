//! Torsional and rolling friction: torques of a point of contact against the spin of its bodies.
//!
//! With the relative spin ω and the normal force fₙ, lengths rₜ and rᵣ (MuJoCo's second and third coefficient) bound
//! the torques about the normal and across it, |τₙ| ≤ rₜ fₙ and |τₜ| ≤ rᵣ fₙ, as Coulomb's cone bounds friction.
//!
//! Against what does not move they are impedances inside the articulated-body algorithm, as those of
//! [`contact`](super::contact) are:
//!
//! ```text
//! τ = τ⁰ − h C Δα     C = c_r 1 + (c_t − c_r) n nᵀ     τ⁰ = −C ω⁰     c = r fₙ / |ω'|, at most STICK J / h
//! ```
//!
//! with the spin ω⁰ at the end of the step if every q̈ were zero. Between bodies that move they are rows like those of
//! [`gauss_seidel`](super::gauss_seidel), solved after its friction: ω = 0, |λₙ| ≤ rₜ λ, |λₜ| ≤ rᵣ λ.
//!
//! J is that of [`pair_field::INERTIA`](crate::contacts::pair_field::INERTIA).

use super::contact::{STICK, excess, foreseen, rate, rubbing};
use super::factor::{self, Path};
use super::gauss_seidel;
use super::tables::{Tables, couple_link, frame, touch_link};
use crate::contacts::{slot, slot_link};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Cell, Machine, Mat3, Real, SymMat3, Vec3};

/// Smallest response of a row [1/(kg·m²)], and shortest coefficient [m], that divide.
const TINY: f64 = 1e-12;

/// Fields of [`Tables::turn`], a row for each slot of what does not move.
pub(crate) mod turn {
    /// ω⁰, 3.
    pub const SPIN_0: usize = 0;
    /// c_t and c_r, zero where the point does not press.
    pub const IMPEDANCE: usize = 3;
    // τ⁰, 3, follows.
    /// τ, 3.
    pub const TORQUE: usize = 8;
    /// c_t and c_r that τ came from.
    pub const WAS: usize = 11;
    pub const WIDTH: usize = 13;
}

/// Fields of [`Tables::turn_law`], a row for each pair.
pub(crate) mod turn_law {
    /// rₜ and rᵣ [m].
    pub const COEFFICIENTS: usize = 0;
    // 1 / J, and c of what sticks, follow.
    pub const WIDTH: usize = 4;
}

/// Fields of [`Tables::turn_impulse`], a row for each slot between bodies that move.
pub(crate) mod turn_impulse {
    /// ω⁰ along the normal and both tangents, 3.
    pub const SPIN: usize = 0;
    /// Reciprocal responses: about the normal, and across it.
    pub const RESPONSE: usize = 3;
    /// λ, 3.
    pub const LAMBDA: usize = 5;
    pub const WIDTH: usize = 8;
}

/// The fields of [`turn_law`], of the coefficients and J, over a step of `h` [s].
pub(crate) fn turn_law_over(
    [torsion, rolling]: [f64; 2],
    inertia: f64,
    h: f64,
) -> [f64; turn_law::WIDTH] {
    [torsion, rolling, inertia.recip(), STICK * inertia / h]
}

/// Begins with the impedances of the last step, where the point was `known`, and presses where `on` is 1.
#[inline(always)]
pub(crate) fn approach<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    known: <M::R as Real>::Mask,
    on: M::R,
    h: M::R,
) {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let spin = k.spatial(t.frame, node, frame::TWIST).angular;
    let bias = k.spatial(t.frame, node, frame::BIAS).angular;
    k.store_vec3(t.turn, s, turn::SPIN_0, bias.fma(h, spin));
    k.write(t.turn, s, turn::TORQUE, [M::R::zero(); 5]);
    let zero = M::R::zero();
    let [about, across] = k.read(t.turning, s, 0);
    let kept = [
        M::R::select(known, about, zero),
        M::R::select(known, across, zero),
    ];
    press(k, t, s, on, kept);
}

/// Where the contacts of a pair resist turning.
#[inline(always)]
fn resists<M: Machine>(k: &M, t: &Tables, pair: M::I) -> <M::R as Real>::Mask {
    let [torsion, rolling] = k.read(t.turn_law, pair, turn_law::COEFFICIENTS);
    (torsion + rolling).gt(M::R::zero())
}

/// Sets the impedances of a point that presses where `on` is 1.
#[inline(always)]
fn press<M: Machine>(k: &mut M, t: &Tables, s: M::I, on: M::R, [about, across]: [M::R; 2]) {
    let (about, across) = (about * on, across * on);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let spin = k.vec3(t.turn, s, turn::SPIN_0);
    let torque = resisted(n, spin, about, across);
    let numbers = [about, across, torque.x, torque.y, torque.z];
    k.write(t.turn, s, turn::IMPEDANCE, numbers);
}

/// −C ω.
#[inline(always)]
fn resisted<R: Real>(n: Vec3<R>, spin: Vec3<R>, about: R, across: R) -> Vec3<R> {
    n * ((across - about) * n.dot(spin)) - spin * across
}

/// Adds to what a point adds to its node's articulated inertia, and to its force, what it adds by its torque.
#[inline(always)]
pub(crate) fn burden<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    h: M::R,
    mut inertia: Inertia<M::R>,
    mut force: Spatial<M::R>,
) -> (Inertia<M::R>, Spatial<M::R>) {
    let [about, across, x, y, z] = k.read(t.turn, s, turn::IMPEDANCE);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let across_all = SymMat3::diagonal(h * across);
    inertia.i = inertia.i + across_all + SymMat3::outer(n, h * (about - across));
    force.angular += Vec3::new(x, y, z);
    (inertia, force)
}

/// Torques under the accelerations just found, of a point that bears `load` [N]; changes the impedances that are
/// against the law, and returns where.
#[inline(always)]
pub(crate) fn settle<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    h: M::R,
    pressed: <M::R as Real>::Mask,
    load: M::R,
) -> <M::R as Real>::Mask {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let mut changes = k.cell(M::R::zero());
    if let Some(_branch) = k.if_any(resists(k, t, pair)) {
        let wrong = settle_one(k, t, s, pair, h, load);
        changes.write(M::R::select(pressed & wrong, M::R::one(), M::R::zero()));
    }
    changes.read().gt(M::R::zero())
}

#[inline(always)]
fn settle_one<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    pair: M::I,
    h: M::R,
    load: M::R,
) -> <M::R as Real>::Mask {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let before = k.vec3(t.turn, s, turn::SPIN_0);
    let [about, across] = k.read(t.turn, s, turn::IMPEDANCE);
    let [torsion, rolling, light, stick] = k.read(t.turn_law, pair, turn_law::COEFFICIENTS);
    let alpha = k.spatial(t.frame, node, frame::ACCELERATION).angular;
    let spin = alpha.fma(h, before);
    let torque = resisted(n, spin, about, across);
    let numbers = [torque.x, torque.y, torque.z, about, across];
    k.write(t.turn, s, turn::TORQUE, numbers);

    let (twist, twist_before) = (n.dot(spin), n.dot(before));
    let rolls = n.fma(-twist, spin).length_squared();
    let rolled = n.fma(-twist_before, before).length();
    let own = [light * h, stick];
    let (twists, about) = turn(
        torsion * load,
        about,
        twist.squared(),
        twist_before.abs(),
        own,
    );
    let (rolls, across) = turn(rolling * load, across, rolls, rolled, own);
    let on = k.load(t.on, s, 0);
    press(k, t, s, on, [about, across]);
    twists | rolls
}

/// Whether an impedance is against its law, and the next one: see [`rubbing`].
#[inline(always)]
fn turn<R: Real>(limit: R, c: R, speed2: R, before: R, own: [R; 2]) -> (R::Mask, R) {
    let [over, under] = excess(limit, c, speed2, own[1]);
    let next = rubbing(limit, c, speed2.sqrt(), before, over, own);
    let wrong = over | under;
    (wrong, R::select(wrong, next, c))
}

/// Goes back to the impedances that the torque came from, but in the lanes of `open`; presses where `on` is 1.
#[inline(always)]
pub(crate) fn go_back<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    open: <M::R as Real>::Mask,
    on: M::R,
) {
    let [is_about, is_across] = k.read(t.turn, s, turn::IMPEDANCE);
    let [about, across] = k.read(t.turn, s, turn::WAS);
    let next = [
        M::R::select(open, is_about, about),
        M::R::select(open, is_across, across),
    ];
    press(k, t, s, on, next);
}

/// What the torque of a point becomes by the accelerations that impulses have added.
#[inline(always)]
pub(crate) fn give<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let [x, y, z, about, across] = k.read(t.turn, s, turn::TORQUE);
    let spin = k.spatial(t.frame, node, frame::INCREMENT).angular * h;
    let torque = Vec3::new(x, y, z) + resisted(n, spin, about, across);
    k.store_vec3(t.turn, s, turn::TORQUE, torque);
}

/// Keeps the torque of a point, which bears `load` [N], and where it pressed its impedances.
#[inline(always)]
pub(crate) fn keep<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    pressed: <M::R as Real>::Mask,
    load: M::R,
) {
    let zero = M::R::zero();
    let torque = k.vec3(t.turn, s, turn::TORQUE);
    k.store_vec3(t.gripped, s, 0, torque);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let (mut about, mut across) = (k.cell(zero), k.cell(zero));
    if let Some(_branch) = k.if_any(resists(k, t, pair)) {
        let next = foresee(k, t, s, pair, torque, load);
        about.write(next[0]);
        across.write(next[1]);
    }
    let impedance = [
        M::R::select(pressed, about.read(), zero),
        M::R::select(pressed, across.read(), zero),
    ];
    k.write(t.turning, s, 0, impedance);
}

/// Impedances to begin the next step with: see [`foreseen`].
#[inline(always)]
fn foresee<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    pair: M::I,
    torque: Vec3<M::R>,
    load: M::R,
) -> [M::R; 2] {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let spin = k.spatial(t.frame, node, frame::TWIST).angular;
    let [torsion, rolling, _, stick] = k.read(t.turn_law, pair, turn_law::COEFFICIENTS);
    let [about, across] = k.read(t.turn, s, turn::IMPEDANCE);
    let [was_about, was_across] = k.read(t.turn, s, turn::WAS);
    let (twisting, twist) = (n.dot(torque), n.dot(spin));
    let rolling_torque = n.fma(-twisting, torque).length();
    let roll = n.fma(-twist, spin).length();
    let load = load.max(M::R::zero());
    [
        foreseen(
            torsion * load,
            [about, was_about],
            twisting.abs(),
            twist.abs(),
            stick,
        ),
        foreseen(
            rolling * load,
            [across, was_across],
            rolling_torque,
            roll,
            stick,
        ),
    ]
}

/// Takes the torque of the last step for the one that acts now.
#[inline(always)]
pub(crate) fn recall<M: Machine>(k: &mut M, t: &Tables, s: M::I) {
    let torque = kept(k, t, s, t.kept.known(k, s));
    let zero = M::R::zero();
    let numbers = [zero, zero, torque.x, torque.y, torque.z];
    k.write(t.turn, s, turn::IMPEDANCE, numbers);
}

/// Torque [N·m] of the last step on B, in the lanes of a mask.
#[inline(always)]
pub(crate) fn kept<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    same: <M::R as Real>::Mask,
) -> Vec3<M::R> {
    Vec3::select(same, k.vec3(t.gripped, s, 0), Vec3::zero())
}

/// Spin without impulses, responses and λ of a contact between bodies that move, which takes part where `on` is 1.
#[inline(always)]
pub(crate) fn row<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    e: Mat3<M::R>,
    torque: Vec3<M::R>,
    h: M::R,
) {
    let lambda = e.transpose_mul(torque * h);
    k.store_vec3(t.turn_impulse, s, turn_impulse::LAMBDA, lambda);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    if let Some(_branch) = k.if_any(resists(k, t, pair)) {
        row_of(k, t, s, e, h);
    }
}

#[inline(always)]
fn row_of<M: Machine>(k: &mut M, t: &Tables, s: M::I, e: Mat3<M::R>, h: M::R) {
    let couple = k.link(t.touch_links, s, touch_link::COUPLE);
    let spin = e.transpose_mul(
        spin_of(k, t, couple_link::NODE_B, couple, h)
            - spin_of(k, t, couple_link::NODE_A, couple, h),
    );
    let to = (t.turn_entry, k.link(t.touch_links, s, touch_link::ENTRY));
    let against = Mat3::from_columns(-e.x, -e.y, -e.z);
    let wrenches = [factor::moments(against), factor::moments(e)];
    let a = factor::rows(k, t, Path::of(k, t, couple), &to, wrenches);
    let (tiny, on) = (M::R::lit(TINY), k.load(t.takes_part, s, 0));
    let (about, across) = (on / a.x.max(tiny), on / a.y.max(a.z).max(tiny));
    let numbers = [spin.x, spin.y, spin.z, about, across];
    k.write(t.turn_impulse, s, turn_impulse::SPIN, numbers);
}

/// Spin of one side after the step without impulses.
#[inline(always)]
fn spin_of<M: Machine>(k: &M, t: &Tables, side: usize, couple: M::I, h: M::R) -> Vec3<M::R> {
    let node = k.link(t.couple_links, couple, side);
    let a = k.spatial(t.frame, node, frame::BIAS) + k.spatial(t.frame, node, frame::ACCELERATION);
    let spin = k.spatial(t.frame, node, frame::TWIST).angular;
    a.angular.fma(h, spin)
}

/// One relaxation of a contact that bears the impulse `load` [N·s], where `on` is 1; square of the change, as that of a
/// force that the coefficients would make it.
#[inline(always)]
pub(crate) fn relax<M: Machine>(k: &mut M, t: &Tables, s: M::I, load: M::R, on: M::R) -> M::R {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let mut change = k.cell(M::R::zero());
    if let Some(_branch) = k.if_any(resists(k, t, pair)) {
        let changed = relax_one(k, t, s, pair, load, on);
        change.write(changed);
    }
    change.read()
}

#[inline(always)]
fn relax_one<M: Machine>(k: &mut M, t: &Tables, s: M::I, pair: M::I, load: M::R, on: M::R) -> M::R {
    let first = k.link(t.touch_links, s, touch_link::ENTRY);
    let spin = k.vec3(t.turn_impulse, s, turn_impulse::SPIN);
    let spin = gauss_seidel::velocity(k, t, s, (t.turn_entry, first), spin);
    let [about, across] = k.read(t.turn_impulse, s, turn_impulse::RESPONSE);
    let [torsion, rolling] = k.read(t.turn_law, pair, turn_law::COEFFICIENTS);
    let old = k.vec3(t.turn_impulse, s, turn_impulse::LAMBDA);
    let (zero, tiny) = (M::R::zero(), M::R::lit(TINY));
    let most = torsion * load;
    let twist = about.fnma(spin.x, old.x).clamp(-most, most);
    let (one, two) = (across.fnma(spin.y, old.y), across.fnma(spin.z, old.z));
    let length = one.fma(one, two * two).sqrt();
    let limit = rolling * load;
    let share = limit / length.max(limit).max(tiny);
    let new = Vec3::new(twist, one * share, two * share);
    let step = (new - old) * on;
    k.store_vec3(t.turn_impulse, s, turn_impulse::LAMBDA, old + step);
    gauss_seidel::push(k, t, s, (t.turn_entry, first), step);
    let twisted = step.x / torsion.max(tiny);
    let rolled = Vec3::new(zero, step.y, step.z) * rolling.max(tiny).recip();
    twisted.fma(twisted, rolled.length_squared())
}

/// Torque [N·m] on B of a contact between bodies that move.
#[inline(always)]
pub(crate) fn torque<M: Machine>(k: &M, t: &Tables, s: M::I, e: Mat3<M::R>) -> Vec3<M::R> {
    let lambda = k.vec3(t.turn_impulse, s, turn_impulse::LAMBDA) * rate(k, t);
    let on = k.load(t.takes_part, s, 0).gt(M::R::zero());
    Vec3::select(on, e * lambda, Vec3::zero())
}
