//! Contacts with what does not move, as implicit impedances inside the articulated-body algorithm.
//!
//! A point of contact x with unit normal n, at a distance φ, pushes its node with
//!
//! ```text
//! f = cₙ (u* − uₙ') n − cₜ uₜ'        u' = u⁰ + h (Δa + Δα × x)
//! ```
//!
//! u' is the velocity of the node at x at the end of the step of length h, u⁰ what it would be if
//! every q̈ were zero, and Δa what the q̈ add ([`articulated_body`](super::articulated_body)).
//!
//! What passes a point that stands still has the spatial acceleration a + α × x; what goes along with a contact that moves
//! on with ẋ has ω × ẋ more (Featherstone 2008, §2.11), which does not vanish with h where the surface has m'. At a corner
//! ẋ is the body's own velocity there, zero while it pivots; a ball is touched below its centre however it turns, and ẋ is
//! that of its centre. So, where the normal stays as it is, ẋ is the velocity at the centre of curvature: ρ beyond the
//! surface for spheres and capsules, and at the surface for corners and edges. What turns a cylinder or a cone about its
//! axis does not move its contacts, be they on its side, rims or faces. A rim that precesses, and ellipsoids, whose radius
//! is taken to be the distance of the centre, are not exact, nor are faces on what sticks out. Only on free roots and wheels
//! ([`wheel`](super::wheel)) do contacts go along; on other nodes ẋ = 0, as a foot's that stands. So
//!
//! ```text
//! f = f⁰ − h C (Δa + Δα × x)      C = cₜ 1 + (cₙ − cₜ) n nᵀ      f⁰ = f at u' = u⁰
//! ```
//!
//! and a contact adds h C, a mass that depends on direction, at x to its node's articulated
//! inertia, and −f⁰ to its bias force. It is solved exactly with the tree, however stiff.
//!
//! Normal: a spring k, a damper d and an added mass m' beyond the surface,
//! −k (φ + h uₙ') − d ((1 − θ) uₙ + θ uₙ') − m' (uₙ' − uₙ) / h with the velocity u before the step, have
//! cₙ = h k + θ d + m' / h and u* = ((m' / h − (1 − θ) d) uₙ − k φ) / cₙ; θ = (3 m' + h d) / (6 m' + h d),
//! see [`limit`](super::limit). Where the surface is not reached yet, spring and damper act on the part
//! of the step's way that is beyond it, φ + h uₙ', and m' on the change of speed as ever:
//! u* = (m' / h uₙ − (h k + θ d) φ / h) / cₙ, at most −φ / h. Without m' that reaches the surface
//! exactly; with it, a fall is not stopped there at once by a law that yields for several steps. A bounce
//! has [`HARD`] m / h for cₙ, and for u* what −e uₙ is at the surface ([`restitution`](crate::restitution)). So has what
//! comes too fast for the spring to stop it before it is through, with u* = 0 at the surface. What overlaps has u* ≤ [`PUSH_OUT`], or more by and by where that does not bear
//! the load: what begins deep inside is not shot out.
//!
//! Friction: cₜ = μ fₙ / |uₜ'|, at most [`STICK`] m / h, where the point sticks; the same for both
//! tangents, so that friction opposes the motion exactly. Which points press, and how much they
//! rub, is settled by passes over the whole algorithm, at most `Settings::contact_passes`. cₜ is kept
//! from step to step, of what slides at the speed that it is about to have ([`foreseen`]), so that what rests or
//! slides needs one pass, and its friction errs by second order in h; a new contact starts without
//! friction, so that what is not settled yet slips for a moment rather than grips.
//!
//! Where surfaces resist more while they stick, the speed at which they slide when the step begins decides on μ
//! ([`cone`](crate::cone)).
//!
//! Torsional and rolling friction are torques alike ([`turning`](super::turning)).
//!
//! Departures from Coulomb's law: a point that sticks creeps with fₜ / cₜ, some 0.1 mm/s under its
//! body's weight at 3 ms; in a step that needs more passes than there are, friction exceeds the cone
//! in the ratio of the slip found to that foreseen: of the points on which an ant under random controls presses, by more
//! than 2 % at 31 % and by half at 3 %, with two passes. A point may pull for that one step, with up to [`PULL`] weights. More
//! would give a body that is drawn to the surface the energy of its way, so further passes let go of it.
//! A world in which a stop was taken for the wrong thing goes on once more: it errs by all of the stop's force.

use super::gauss_seidel;
use super::limit::late_damping;
use super::tables::{Tables, frame, node, step};
use super::turning;
use crate::cone;
use crate::contacts::{
    PUSH_OUT, Places, found, pair_field, pair_link, placed_field, round, sense, shape_link, slot,
    slot_link, touches,
};
use crate::restitution::early;
use numbers::machine::{Held, Hold};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Cell, Machine, Pose, Real, SymMat3, Vec3};

/// Normal impedance of a bounce, in masses per step.
const HARD: f64 = 1e4;
/// Tangential impedance of a point that sticks, in masses per step.
pub(crate) const STICK: f64 = 300.0;
/// Approach slower than this many g h does not bounce.
const RESTING: f64 = 2.0;
/// What is no farther away [m] is guessed to touch: the distance of what rests on a surface is rounding, of either sign.
const TOUCHING: f64 = 1e-7;
/// Excess of the friction cone, as a share, that needs no further pass.
const EXCESS: f64 = 0.02;
/// What rubs less than this share of what sticks, slides.
const SLIDES: f64 = 0.999;
/// Pull that may stand where passes run out, in weights of the mass that the contact moves.
const PULL: f64 = 10.0;
/// By how much a force may grow from step to step where the spring would push out faster than [`PUSH_OUT`].
const GROWTH: f64 = 1.5;
/// Speed [m/s] below which a division by it is no use.
const STILL: f64 = 1e-9;

/// Fields of [`Tables::load`], a row for each slot.
pub(crate) mod load {
    /// f⁰, 3.
    pub const FORCE_0: usize = 0;
    /// cₙ and cₜ, zero where the point does not press.
    pub const IMPEDANCE: usize = 3;
    /// u⁰, 3.
    pub const VELOCITY_0: usize = 5;
    /// u*.
    pub const TARGET: usize = 8;
    // cₙ if the point pressed follows u*.
    /// f, 3.
    pub const FORCE: usize = 10;
    // cₙ and cₜ that f came from follow.
    pub const WIDTH: usize = 15;
}

/// Fields of [`Tables::law`], a row for each pair: what its law comes to over a step.
pub(crate) mod law {
    /// μ.
    pub const FRICTION: usize = 0;
    // 1 / m of the mass that the contact moves, and cₜ where the point sticks, follow.
    /// e.
    pub const RESTITUTION: usize = 3;
    // k, then cₙ and its reciprocal, m' / h, m' / h − (1 − θ) d, and cₙ of a bounce follow.
    /// The fastest approach [m/s] that k stops.
    pub const FASTEST: usize = 10;
    /// μₛ.
    pub const STICKING: usize = 11;
    pub const WIDTH: usize = 12;
}

/// The fields of [`law`], of a row of the contacts' pairs from [`pair_field::FRICTION`] on.
pub(crate) fn law_over(
    [friction, restitution, k, d, mass, added]: [f64; 6],
    [fastest, sticking]: [f64; 2],
    h: f64,
) -> [f64; law::WIDTH] {
    let (late, inertia) = (late_damping(d, added, h), added / h);
    let c = h * k + late + inertia;
    let (stick, hard) = (STICK * mass / h, HARD * mass / h);
    let kept = inertia - (d - late);
    let softness = c.max(STILL).recip();
    [
        friction,
        mass.recip(),
        stick,
        restitution,
        k,
        c,
        softness,
        inertia,
        kept,
        hard,
        fastest,
        sticking,
    ]
}

impl<M: Machine> Places<M> for Tables {
    #[inline(always)]
    fn place(&self, k: &M, row: M::I) -> Pose<M::R> {
        k.pose(self.frame, row, frame::PLACE)
    }
    #[inline(always)]
    fn twist(&self, k: &M, row: M::I) -> Spatial<M::R> {
        k.spatial(self.frame, row, frame::TWIST)
    }
    #[inline(always)]
    fn origin(&self, k: &M, group: M::I) -> Vec3<M::R> {
        k.vec3(self.point, group, 0)
    }
}

/// Which of the contacts found may press within a step of `h` [s], at first sight.
#[inline(always)]
pub(crate) fn meet<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    release_all(k, t);
    for place in fixed(k, t) {
        let s = t.contacts.found.row(k, place);
        approach(k, t, s, h);
    }
}

/// No point presses.
#[inline(always)]
fn release_all<M: Machine>(k: &mut M, t: &Tables) {
    for s in k.count(t.contacts.between) {
        k.store(t.on, s, 0, M::R::zero());
    }
}

/// Where the contacts with what does not move are listed.
#[inline(always)]
fn fixed<M: Machine>(k: &M, t: &Tables) -> M::Rounds {
    t.contacts.found.places(k, k.index(found::FIXED))
}

/// Velocity of a motion at a point.
#[inline(always)]
pub(crate) fn at<R: Real>(v: Spatial<R>, x: Vec3<R>) -> Vec3<R> {
    v.linear + v.angular.cross(x)
}

/// Acceleration of a node at a contact where every q̈ is zero, less gravity: of a free root or a wheel, of what goes along
/// with the point of contact. `side` is 0 for the node that the normal points to, and 1 for the other, which sees it at x.
#[inline(always)]
pub(crate) fn bias<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    side: usize,
    node: M::I,
    x: Vec3<M::R>,
) -> Vec3<M::R> {
    let mut a = at(k.spatial(t.frame, node, frame::BIAS), x).hold(k);
    let rolls = k.load(t.node, node, node::ROLLS).gt(M::R::zero());
    if let Some(_branch) = k.if_any(rolls) {
        let v = k.spatial(t.frame, node, frame::TWIST);
        let goes = goes_along(k, t, s, side, v, x);
        let (along, stays) = (v.angular.cross_plus(goes, a.get()), a.get());
        a.set(Vec3::select(rolls, along, stays));
    }
    a.get()
}

/// Velocity of the point at which a shape that moves with v is touched, as if its normal stayed: ẋ.
#[inline(always)]
fn goes_along<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    side: usize,
    v: Spatial<M::R>,
    x: Vec3<M::R>,
) -> Vec3<M::R> {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let shape = k.link(t.contacts.pair_links, pair, pair_link::SIDES + side);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let distance = k.load(t.contacts.slot, s, slot::DISTANCE);
    let rounding = k.load(t.contacts.pair, pair, pair_field::ROUNDING + side);
    // The contact is midway between the surfaces.
    let inwards = distance.min(M::R::zero()).fma(M::R::lit(0.5), rounding);
    let inwards = n * if side == 0 { inwards } else { -inwards };
    let mut along = at(v, x + inwards).hold(k);
    let round = k.link(t.contacts.shape_links, shape, shape_link::ROUND);
    if let Some(_branch) = k.when(k.less(k.index(round::NOT), round)) {
        let place = k.pose(t.contacts.placed, shape, placed_field::POSITION);
        let surface = k.vec3(t.contacts.slot, s, slot::POSITION) + inwards;
        let axis = place
            .q
            .rotate(Vec3::new(M::R::zero(), M::R::one(), M::R::zero()));
        let mut turn = (axis * axis.dot(v.angular)).hold(k);
        if let Some(_branch) = k.when(k.equals(round, round::ABOUT_ALL)) {
            turn.set(v.angular);
        }
        along.set(turn.get().cross_plus(place.p - surface, along.get()));
    }
    along.get()
}

/// Fills the row of a slot that may come to press within the step.
#[inline(always)]
fn approach<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) {
    let distance = k.load(t.contacts.slot, s, slot::DISTANCE);
    let near = touches(distance);
    let (zero, one) = (M::R::zero(), M::R::one());
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let gravity = k.vec3(t.world, k.index(0), 0);
    if t.thin {
        center(k, t, s, k.load(t.law, pair, law::FASTEST));
    }
    let x = k.vec3(t.contacts.slot, s, slot::POSITION);
    let v = at(k.spatial(t.frame, node, frame::TWIST), x);
    let a = bias(k, t, s, 0, node, x) + gravity;
    let u0 = a.fma(h, v);
    let (speed, u0_n) = (n.dot(v), n.dot(u0));

    let known = t.kept.known(k, s);
    let borne = n.dot(t.kept.force(k, s));
    let pressed = borne.gt(zero);
    let borne = M::R::select(known, borne, zero);
    let gained = -(n.dot(gravity) * h);
    let (target, c) = impedance(k, t, pair, distance, [speed, gained], borne, h);
    let reaches = u0_n.lt(M::R::lit(TOUCHING).fma(rate(k, t), target));
    let on = M::R::select(near & ((known & pressed) | reaches), one, zero);
    k.store_vec3(t.load, s, load::VELOCITY_0, u0);
    k.write(t.load, s, load::TARGET, [target, c]);
    let grip = M::R::select(known, k.load(t.grip, s, 0), zero);
    if t.contacts.sticks {
        stick(k, t, s, pair, n.fma(-speed, v), h);
    }
    press(k, t, s, on, c, grip);
    if t.grips {
        turning::approach(k, t, s, known, on, h);
    }
}

/// Decides by the slip [m/s] of a slot's surfaces whether they stick in this step.
#[inline(always)]
pub(crate) fn stick<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    pair: M::I,
    slip: Vec3<M::R>,
    h: M::R,
) {
    let coefficients = [
        k.load(t.law, pair, law::FRICTION),
        k.load(t.law, pair, law::STICKING),
    ];
    let fall = k.vec3(t.world, k.index(0), 0).length() * h;
    let friction = cone::friction(coefficients, slip.length_squared(), fall);
    k.store(t.cone, s, 0, friction);
}

/// The coefficient of friction of a slot in this step.
#[inline(always)]
pub(crate) fn friction<M: Machine>(k: &M, t: &Tables, s: M::I, pair: M::I) -> M::R {
    if t.contacts.sticks {
        k.load(t.cone, s, 0)
    } else {
        k.load(t.law, pair, law::FRICTION)
    }
}

/// Centre of mass of a node.
#[inline(always)]
pub(crate) fn center_of<M: Machine>(k: &M, t: &Tables, node: M::I) -> Vec3<M::R> {
    let place = k.pose(t.frame, node, frame::PLACE);
    place.point(k.vec3(t.node, node, node::CENTER))
}

/// What is too fast would, stopped at a corner, turn past it within the step: so it is stopped before its centre of mass.
#[inline(always)]
fn center<M: Machine>(k: &mut M, t: &Tables, s: M::I, fastest: M::R) {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let (x, n) = (
        k.vec3(t.contacts.slot, s, slot::POSITION),
        k.vec3(t.contacts.slot, s, slot::NORMAL),
    );
    let motion = k.spatial(t.frame, node, frame::TWIST);
    let fast = n.dot(at(motion, x)).lt(-fastest);
    if let Some(_branch) = k.if_any(fast) {
        let c = center_of(k, t, node);
        let flies = fast & n.dot(at(motion, c)).lt(-fastest);
        let before = n.fma(n.dot(x - c), c);
        let stopped = Vec3::select(flies, before, x);
        k.store_vec3(t.contacts.slot, s, slot::POSITION, stopped);
    }
}

/// u* and cₙ of a point that comes with `speed` [m/s] along the normal, of which it gains so much in a free step, and
/// bore a force [N] in the step before.
#[inline(always)]
pub(crate) fn impedance<M: Machine>(
    k: &M,
    t: &Tables,
    pair: M::I,
    distance: M::R,
    [speed, gained]: [M::R; 2],
    borne: M::R,
    h: M::R,
) -> (M::R, M::R) {
    let zero = M::R::zero();
    let [
        restitution,
        stiffness,
        c,
        softness,
        inertia,
        kept,
        hard,
        fastest,
    ] = k.read(t.law, pair, law::RESTITUTION);
    let gravity = k.vec3(t.world, k.index(0), 0);
    let (beyond, reach) = (distance.gt(zero), -(distance * rate(k, t)));
    let within = stiffness.fnma(distance, kept * speed);
    let enters = inertia.fma(speed, (c - inertia) * reach);
    let target = M::R::select(beyond, enters, within) * softness;
    let target = M::R::select(beyond, target.min(reach), target);
    let slow = gravity.length() * h * M::R::lit(-RESTING);
    let strikes = h.fma(speed, distance).lt(zero);
    let falls_in = h.fma(speed - gained, distance).lt(zero);
    let bounces = restitution.gt(zero) & speed.lt(slow) & falls_in;
    let stops = speed.lt(-fastest) & strikes;
    let push_out = (borne * softness * M::R::lit(GROWTH)).max(M::R::lit(PUSH_OUT));
    let target = M::R::select(stops, reach.min(zero), target.min(push_out));
    let mut target = k.cell(target);
    let mut c = k.cell(M::R::select(stops, hard, c));
    if let Some(_branch) = k.if_any(bounces) {
        let (w, lag) = (-speed, gained * M::R::lit(0.5));
        let (leave, rises) = early(restitution, w + lag, gained, distance * rate(k, t));
        let leave = (leave - lag).clamp(zero, w.max(zero));
        let bounces = bounces & rises;
        target.write(M::R::select(bounces, leave, target.read()));
        c.write(M::R::select(bounces, hard, c.read()));
    }
    (target.read(), c.read())
}

/// 1 / h [1/s].
#[inline(always)]
pub(crate) fn rate<M: Machine>(k: &M, t: &Tables) -> M::R {
    k.load(t.step, k.index(0), step::RATE)
}

/// Sets whether a point presses, and with which impedances.
#[inline(always)]
fn press<M: Machine>(k: &mut M, t: &Tables, s: M::I, on: M::R, c_n: M::R, c_t: M::R) {
    let (c_n, c_t) = (c_n * on, c_t * on);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let u0 = k.vec3(t.load, s, load::VELOCITY_0);
    let u0_n = n.dot(u0);
    let target = k.load(t.load, s, load::TARGET);
    let f0 = n * c_n.fma(target - u0_n, c_t * u0_n) - u0 * c_t;
    k.write(t.load, s, load::FORCE_0, [f0.x, f0.y, f0.z, c_n, c_t]);
    k.store(t.on, s, 0, on);
}

/// What a contact adds to its node's articulated inertia, and takes from its bias force.
#[inline(always)]
pub(crate) fn burden<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    h: M::R,
) -> (Inertia<M::R>, Spatial<M::R>) {
    let [fx, fy, fz, c_n, c_t] = k.read(t.load, s, load::FORCE_0);
    let (x, n) = (
        k.vec3(t.contacts.slot, s, slot::POSITION),
        k.vec3(t.contacts.slot, s, slot::NORMAL),
    );
    let f0 = Vec3::new(fx, fy, fz);
    let isotropic = Inertia::rigid(h * c_t, x, SymMat3::zero());
    let e = Spatial::new(x.cross(n), n);
    let inertia = isotropic.minus_outer(e, h * (c_t - c_n));
    let force = Spatial::new(x.cross(f0), f0);
    if t.grips {
        turning::burden(k, t, s, h, inertia, force)
    } else {
        (inertia, force)
    }
}

/// Forces under the accelerations just found; changes what presses, sticks or slides against the
/// laws, counts the changes, and finds the largest pull [m/s²] of a point.
#[inline(always)]
pub(crate) fn settle<M: Machine>(
    k: &mut M,
    t: &Tables,
    h: M::R,
    changes: &mut M::Cell,
    pull: &mut M::Cell,
) {
    pull.write(M::R::zero());
    for place in fixed(k, t) {
        let s = t.contacts.found.row(k, place);
        let near = t.contacts.near(k, s);
        let [change, pulls] = settle_one(k, t, s, h);
        let change = M::R::select(near, change, M::R::zero());
        changes.write(changes.read() + change);
        pull.write(pull.read().max(M::R::select(near, pulls, M::R::zero())));
    }
}

#[inline(always)]
fn settle_one<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) -> [M::R; 2] {
    let (zero, one) = (M::R::zero(), M::R::one());
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let (x, n) = (
        k.vec3(t.contacts.slot, s, slot::POSITION),
        k.vec3(t.contacts.slot, s, slot::NORMAL),
    );
    let [c_n, c_t] = k.read(t.load, s, load::IMPEDANCE);
    let on = k.load(t.on, s, 0);
    let u0 = k.vec3(t.load, s, load::VELOCITY_0);
    let [target, c] = k.read(t.load, s, load::TARGET);
    let u = at(k.spatial(t.frame, node, frame::ACCELERATION), x).fma(h, u0);
    let u_n = n.dot(u);
    let u_t = n.fma(-u_n, u);
    let f_n = c_n * (target - u_n);
    let f = n * f_n - u_t * c_t;
    k.write(t.load, s, load::FORCE, [f.x, f.y, f.z, c_n, c_t]);

    let pressed = on.gt(zero);
    let pulls = pressed & f_n.lt(zero);
    let enters = (!pressed) & u_n.lt(target);
    let [friction, light, stick] = k.read(t.law, pair, law::FRICTION);
    let friction = if t.contacts.sticks {
        k.load(t.cone, s, 0)
    } else {
        friction
    };
    let limit = friction * f_n.max(zero);
    // Squares are known long before lengths, and most points have nothing to change.
    let speed2 = u_t.length_squared();
    let [over, under] = excess(limit, c_t, speed2, stick);
    let wrong = pressed & (over | under);
    let changes = pulls | enters | wrong;
    if let Some(_branch) = k.if_any(changes) {
        let before = n.fma(-n.dot(u0), u0).length();
        let next = rubbing(limit, c_t, speed2.sqrt(), before, over, [light * h, stick]);
        let on = M::R::select((pressed & !pulls) | enters, one, zero);
        press(k, t, s, on, c, M::R::select(wrong, next, c_t));
    }
    let mut changes = changes;
    if t.grips {
        let load = f_n.max(zero);
        changes = changes | turning::settle(k, t, s, h, pressed, load);
    }
    [M::R::select(changes, one, zero), -(f_n * light)]
}

/// Whether friction c v is more than its limit, or less without sticking.
#[inline(always)]
pub(crate) fn excess<R: Real>(limit: R, c: R, speed2: R, stick: R) -> [R::Mask; 2] {
    let (limit2, f2) = (limit.squared(), c.squared() * speed2);
    let over = f2.gt(limit2 * R::lit((1.0 + EXCESS) * (1.0 + EXCESS)));
    let under = f2.lt(limit2 * R::lit((1.0 - EXCESS) * (1.0 - EXCESS)));
    [over, under & c.lt(stick * R::lit(SLIDES))]
}

/// c = limit / v of what slides, or sticks. A point that sticks shows no speed to slide with: where that is too much, take
/// that of before, or what the force beyond the limit gives the whole mass, of which `h / m` is told.
#[inline(always)]
pub(crate) fn rubbing<R: Real>(
    limit: R,
    c: R,
    speed: R,
    before: R,
    over: R::Mask,
    [h_per_mass, stick]: [R; 2],
) -> R {
    let breaks = before.max(c.fma(speed, -limit) * h_per_mass);
    let speed = R::select(over, speed.max(breaks), speed);
    (limit / speed.max(R::lit(STILL))).min(stick)
}

/// c to begin the next step with, of what rubbed with `force` and had the speed `before`. If that came by its law, from
/// c `was`, it has slid with force / c, and is to have its limit at the speed that it will have if that goes on changing
/// so. Else c stays as it `is` settled.
#[inline(always)]
pub(crate) fn foreseen<R: Real>(limit: R, [is, was]: [R; 2], force: R, before: R, stick: R) -> R {
    let (still, half) = (R::lit(STILL), R::lit(0.5));
    let after = force * was.max(still).recip();
    let next = (after + (after - before)).max(half * after);
    let slides = is.same(was) & is.lt(stick * R::lit(SLIDES)) & next.gt(still);
    let rubs = (limit * next.max(still).recip()).min(stick);
    R::select(slides, rubs, is)
}

/// True where a point pulls by more than may stand.
#[inline(always)]
pub(crate) fn pulls<M: Machine>(k: &M, t: &Tables, pull: M::R) -> <M::R as Real>::Mask {
    let gravity = k.vec3(t.world, k.index(0), 0);
    pull.gt(gravity.length() * M::R::lit(PULL))
}

/// Lets go of the points that pull, in the lanes of `wrong`. In those of `open` all stays as it was settled, and else as
/// it was when the forces were found, so that these lanes find them again.
#[inline(always)]
pub(crate) fn go_back<M: Machine>(
    k: &mut M,
    t: &Tables,
    open: <M::R as Real>::Mask,
    wrong: <M::R as Real>::Mask,
) {
    let (zero, one) = (M::R::zero(), M::R::one());
    for place in fixed(k, t) {
        let s = t.contacts.found.row(k, place);
        let [fx, fy, fz, was_n, was_t] = k.read(t.load, s, load::FORCE);
        let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
        let pulls = n.dot(Vec3::new(fx, fy, fz)).lt(zero);
        let gone = (wrong & pulls) | was_n.same(zero);
        let (is_on, is_t) = (k.load(t.on, s, 0), k.load(t.load, s, load::IMPEDANCE + 1));
        let on = M::R::select(open, is_on, M::R::select(gone, zero, one));
        let c = k.load(t.load, s, load::TARGET + 1);
        press(k, t, s, on, c, M::R::select(open, is_t, was_t));
        if t.grips {
            turning::go_back(k, t, s, open, on);
        }
    }
}

/// What the forces become by the accelerations that impulses have added.
#[inline(always)]
pub(crate) fn give<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for place in fixed(k, t) {
        let s = t.contacts.found.row(k, place);
        let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
        let (x, n) = (
            k.vec3(t.contacts.slot, s, slot::POSITION),
            k.vec3(t.contacts.slot, s, slot::NORMAL),
        );
        let [fx, fy, fz, c_n, c_t] = k.read(t.load, s, load::FORCE);
        let u = at(k.spatial(t.frame, node, frame::INCREMENT), x) * h;
        let f = Vec3::new(fx, fy, fz) - u * c_t - n * ((c_n - c_t) * n.dot(u));
        k.store_vec3(t.load, s, load::FORCE, f);
        if t.grips {
            turning::give(k, t, s, h);
        }
    }
}

/// Keeps the contacts of the step just made in the state, to be reported.
#[inline(always)]
pub(crate) fn keep<M: Machine>(k: &mut M, t: &Tables) {
    let zero = M::R::zero();
    t.kept.clear(k);
    for place in fixed(k, t) {
        let s = t.contacts.found.row(k, place);
        let force = k.vec3(t.load, s, load::FORCE);
        let touch = t.contacts.touch(k, t, s, force);
        t.kept.keep(k, s, touch);
        let pressed = t.contacts.near(k, s) & k.load(t.on, s, 0).gt(zero);
        let grip = foresee(k, t, s);
        k.store(t.grip, s, 0, M::R::select(pressed, grip, zero));
        if t.grips {
            let normal = k.vec3(t.contacts.slot, s, slot::NORMAL);
            turning::keep(k, t, s, pressed, normal.dot(force));
        }
    }
    for place in gauss_seidel::between(k, t) {
        let s = t.contacts.found.row(k, place);
        let force = gauss_seidel::force(k, t, s);
        let touch = t.contacts.touch(k, t, s, force);
        t.kept.keep(k, s, touch);
        if t.grips {
            let torque = turning::torque(k, t, s, gauss_seidel::directions(k, t, s));
            k.store_vec3(t.gripped, s, 0, torque);
        }
    }
    sense(k, &t.contacts, t, &t.kept);
}

/// cₜ to begin the next step with.
#[inline(always)]
fn foresee<M: Machine>(k: &M, t: &Tables, s: M::I) -> M::R {
    let node = k.link(t.contacts.slot_links, s, slot_link::MOVER);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let (x, n) = (
        k.vec3(t.contacts.slot, s, slot::POSITION),
        k.vec3(t.contacts.slot, s, slot::NORMAL),
    );
    let [fx, fy, fz, _, was] = k.read(t.load, s, load::FORCE);
    let f = Vec3::new(fx, fy, fz);
    let f_n = n.dot(f);
    let v = at(k.spatial(t.frame, node, frame::TWIST), x);
    foreseen(
        friction(k, t, s, pair) * f_n.max(M::R::zero()),
        [k.load(t.load, s, load::IMPEDANCE + 1), was],
        n.fma(-f_n, f).length(),
        n.fma(-n.dot(v), v).length(),
        k.load(t.law, pair, law::FRICTION + 2),
    )
}

/// Takes the contacts of the last step, and their forces, for those that act now.
#[inline(always)]
pub(crate) fn recall<M: Machine>(k: &mut M, t: &Tables) {
    t.contacts.clear(k);
    release_all(k, t);
    for s in k.count(t.contacts.between) {
        let known = t.kept.known(k, s);
        if let Some(_branch) = k.if_any(known) {
            recall_one(k, t, s, found::FIXED);
            k.store(t.on, s, 0, M::R::select(known, M::R::one(), M::R::zero()));
        }
    }
    for s in k.range(k.index(t.contacts.between), k.index(t.contacts.sensed)) {
        if let Some(_branch) = k.if_any(t.kept.known(k, s)) {
            recall_one(k, t, s, found::BETWEEN);
        }
    }
}

#[inline(always)]
fn recall_one<M: Machine>(k: &mut M, t: &Tables, s: M::I, list: usize) {
    let group = k.link(t.contacts.slot_links, s, slot_link::GROUP);
    let touch = t.kept.touch(k, s);
    let force = Vec3::select(t.kept.known(k, s), touch.force, Vec3::zero());
    let [x, y, z] = (touch.position - k.vec3(t.point, group, 0)).to_array();
    let ([l, m, n], [fx, fy, fz]) = (touch.normal.to_array(), force.to_array());
    let slot = [x, y, z, l, m, n, touch.distance, touch.feature];
    k.write(t.contacts.slot, s, slot::POSITION, slot);
    let zero = M::R::zero();
    k.write(t.load, s, load::FORCE_0, [fx, fy, fz, zero, zero]);
    if t.grips && list == found::FIXED {
        turning::recall(k, t, s);
    }
    t.contacts.found.append(k, k.index(list), s);
}
