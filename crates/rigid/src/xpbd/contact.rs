//! Contacts: points that push and rub, by Gauss–Seidel.
//!
//! A point of contact x with unit normal n, found at the distance φ₀ at the start of a substep,
//! is taken to be at φ = φ₀ + h uₙ at its end; u is the velocity of B at x less that of A. In the
//! delta form a correction Δx of a body also adds Δx/h to its velocity, so that the way of the
//! points over the substep is h u however often they are corrected; nothing is detected again.
//!
//! Normal: a spring k, a damper d and an added mass m' beyond the surface, with uₙ⁻ the velocity
//! before the substep, λₙ = h² fₙ = −h² (k φ + d uₙ + m' (uₙ − uₙ⁻) / h) ≥ 0. With
//! g = h² k + h d + m' [kg] and β = 1 − h² k / g this is XPBD with compliance and damping (Macklin
//! et al. 2016, eqs. 18 and 26), multiplied through by k,
//!
//! ```text
//! (w + 1/g) Δλₙ = −(φ − φ*) − λₙ/g      λₙ ≥ 0      φ* = β φ₀ + m' h uₙ⁻ / g
//! ```
//!
//! Where the surface is not reached yet, φ₀ > 0, spring and damper act on the part of the way that is beyond it, and m'
//! on the change of speed as ever: φ* = m' (φ₀ + h uₙ⁻) / g, at most 0. Aimed at the surface itself, g, most of which is
//! m', would take the fall's speed in one substep, however short.
//!
//! where the accumulated λₙ is what is kept from pulling, not its change. w is the inverse mass of
//! both bodies along n (Müller et al. 2020, eqs. 2–3).
//!
//! Friction: the tangential way of the points over the substep is undone as far as Coulomb's cone
//! lets it, |λₜ| ≤ μ λₙ (Müller et al. 2020, §3.5): what sticks and what slides is one law. Both
//! tangents take one step, with the larger of their inverse masses, and are shortened together. Where surfaces resist
//! more while they stick, the speed at which they slide when the substep begins decides on μ ([`cone`](crate::cone)).
//!
//! Torsional and rolling friction: torques of the point against the relative spin along the normal
//! and across it, found like friction from the turn h Δω over the substep, |τₙ| ≤ rₜ λₙ and
//! |τₜ| ≤ rᵣ λₙ. The coefficients are lengths, MuJoCo's second and third.
//!
//! Restitution: what came faster than [`RESTING`] g h before the substep is stopped at the
//! surface as if it were rigid, and leaves it in a last round that changes only velocities, with
//! uₙ = −e uₙ⁻ (Müller et al. 2020, §3.6); where nothing is jointed, with what gravity adds to uₙ⁻ on the way
//! ([`restitution`](crate::restitution)). So a bounce leaves e² of the energy, to rounding, and never more.
//!
//! What comes too fast for the spring to stop it before it is through is stopped as if it were rigid. The speed
//! (φ* − φ₀)/h with which an overlap alone would part is at most [`PUSH_OUT`], or [`GROWTH`] times the h f / g that
//! balances what the point bore in the substep before: what begins deep inside is not shot out, and a spring is a spring.
//!
//! Warm start: where the same features rest on each other, λ starts at that of the last substep.
//! Carried over, it and the sinking x are a resonator where sweeps settle only a share r of an
//! error: s² x = l, (s + r (1 + 1/(w g))) l = −r (s + 1 − β) x decays exactly if
//! r (1 + 1/(w g)) > 1 − β. So the damper is taken as large as that needs for r = [`SETTLED`]:
//! g ≥ h² k / r − 1/w. It does not change where bodies rest.
//!
//! Where there are joints, what a contact stops of its body is little of what the body carries. So λ is kept there however
//! fast the point comes, and adds up from substep to substep to what stops all; of a point that parts with uₙ⁻ it keeps the
//! share s / uₙ⁻, s = [`RESTING`] g h, lest it throws back what it has stopped.
//!
//! Departure from the sources: instead of a velocity pass for all contacts, which would deaden
//! soft ones, the damper takes what penetration would add to velocities.

use super::body::{Solid, arms, inverse_inertias};
use super::joint::arm_inertia;
use super::tables::{Tables, global, mass};
use crate::cone;
use crate::contacts::{PUSH_OUT, Places, Touch, found, pair_field, sense, slot, slot_link};
use crate::restitution::late;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Real, SymMat3, Vec3};

/// Approach slower than this many g h does not bounce, and may start from the last multiplier; anyone may where the model
/// has joints.
const RESTING: f64 = 2.0;
/// By how much a force may grow from substep to substep where the spring would push out faster than [`PUSH_OUT`].
const GROWTH: f64 = 1.5;
/// Share of an error that the sweeps of a substep settle at least.
const SETTLED: f64 = 0.05;
/// Speed [m/s] up to which points rest on each other where nothing has weight.
const STILL: f64 = 1e-9;
/// Divisors below this are of what cannot move, or is not there.
const TINY: f64 = 1e-18;

/// Fields of [`Tables::touching`], a row for each slot.
pub(crate) mod touching {
    /// From the centres of A and B to the point, 3 each.
    pub const ARMS: usize = 0;
    /// φ₀ − φ* [m].
    pub const GAP: usize = 6;
    // 1/g [1/kg], and the reciprocals of w + 1/g and of the tangential w [kg], follow.
    /// h times the speed to leave with, towards each other [m], and 1 where the point bounces.
    pub const BOUNCE: usize = 10;
    /// λₙ and λₜ [kg·m], 4.
    pub const LAMBDA: usize = 12;
    pub const WIDTH: usize = 16;
}

/// Fields of [`Tables::grip`], a row for each slot where any surface resists twisting or rolling.
pub(crate) mod grip {
    // Reciprocals of the inverse moments along the normal and across it [kg·m²].
    /// Torque·h² against twisting and rolling [kg·m²], 3.
    pub const LAMBDA: usize = 2;
    pub const WIDTH: usize = 5;
}

impl<M: Machine> Places<M> for Tables {
    #[inline(always)]
    fn place(&self, k: &M, carrier: M::I) -> Pose<M::R> {
        k.pose(self.pose, k.link(self.carrier_links, carrier, 0), 0)
    }
    #[inline(always)]
    fn twist(&self, k: &M, carrier: M::I) -> Spatial<M::R> {
        let row = k.link(self.carrier_links, carrier, 0);
        let (p, v) = (k.vec3(self.pose, row, 0), k.spatial(self.twist, row, 0));
        Spatial::new(v.angular, v.linear - v.angular.cross(p))
    }
    #[inline(always)]
    fn origin(&self, _: &M, _: M::I) -> Vec3<M::R> {
        Vec3::zero()
    }
}

/// One of the two bodies of a contact.
#[derive(Clone, Copy)]
struct Side<R> {
    twist: Spatial<R>,
    /// 1/m.
    m: R,
    /// I⁻¹, world axes.
    i: SymMat3<R>,
    /// From its centre to the point.
    arm: Vec3<R>,
}

impl<R: Real> Side<R> {
    #[inline(always)]
    fn load<M: Machine<R = R>>(k: &M, t: &Tables, row: M::I, arm: Vec3<R>) -> Self {
        Self {
            twist: k.spatial(t.twist, row, 0),
            m: k.load(t.mass, row, mass::INVERSE),
            i: k.sym(t.inverse_inertia, row, 0),
            arm,
        }
    }
    /// Takes an impulse [N·s] at the point.
    #[inline(always)]
    fn pushed(self, impulse: Vec3<R>) -> Self {
        let Spatial { angular, linear } = self.twist;
        let angular = angular + self.i * self.arm.cross(impulse);
        Self {
            twist: Spatial::new(angular, impulse.fma(self.m, linear)),
            ..self
        }
    }
    /// Takes an angular impulse [N·m·s].
    #[inline(always)]
    fn turned(self, impulse: Vec3<R>) -> Self {
        let Spatial { angular, linear } = self.twist;
        Self {
            twist: Spatial::new(angular + self.i * impulse, linear),
            ..self
        }
    }
    #[inline(always)]
    fn store<M: Machine<R = R>>(self, k: &mut M, t: &Tables, row: M::I, mask: R::Mask) {
        let (now, old) = (self.twist, k.spatial(t.twist, row, 0));
        let angular = Vec3::select(mask, now.angular, old.angular);
        let linear = Vec3::select(mask, now.linear, old.linear);
        k.store_spatial(t.twist, row, 0, Spatial::new(angular, linear));
    }
}

/// Velocity of a motion about a centre at an arm from it.
#[inline(always)]
fn at<R: Real>(v: Spatial<R>, arm: Vec3<R>) -> Vec3<R> {
    v.linear + v.angular.cross(arm)
}

/// The two bodies of a contact; its normal points to B.
#[derive(Clone, Copy)]
struct Sides<R, I> {
    a: Side<R>,
    b: Side<R>,
    rows: [I; 2],
}

impl<R: Real, I: Copy> Sides<R, I> {
    #[inline(always)]
    fn velocity(&self) -> Vec3<R> {
        at(self.b.twist, self.b.arm) - at(self.a.twist, self.a.arm)
    }
    /// Angular velocity of B against A.
    #[inline(always)]
    fn spin(&self) -> Vec3<R> {
        self.b.twist.angular - self.a.twist.angular
    }
    #[inline(always)]
    fn pushed(self, impulse: Vec3<R>) -> Self {
        Self {
            a: self.a.pushed(-impulse),
            b: self.b.pushed(impulse),
            ..self
        }
    }
    #[inline(always)]
    fn turned(self, impulse: Vec3<R>) -> Self {
        Self {
            a: self.a.turned(-impulse),
            b: self.b.turned(impulse),
            ..self
        }
    }
    #[inline(always)]
    fn store<M: Machine<R = R, I = I>>(self, k: &mut M, t: &Tables, mask: R::Mask) {
        self.a.store(k, t, self.rows[0], mask);
        self.b.store(k, t, self.rows[1], mask);
    }
    /// Inverse masses along the normal, and the larger one across it.
    #[inline(always)]
    fn weights(&self, n: Vec3<R>) -> (R, R) {
        let (a, b) = (self.a, self.b);
        let turning = arm_inertia(a.i, a.arm) + arm_inertia(b.i, b.arm);
        let (along, across) = along_and_across(turning, n);
        (a.m + b.m + along, a.m + b.m + across)
    }
    /// Moments about the normal, and the smaller one across it [kg·m²].
    #[inline(always)]
    fn moments(&self, n: Vec3<R>) -> [R; 2] {
        let (along, across) = along_and_across(self.a.i + self.b.i, n);
        let tiny = R::lit(TINY);
        [along.max(tiny).recip(), across.max(tiny).recip()]
    }
}

/// What a symmetric matrix has along a unit vector, and at most across it.
#[inline(always)]
fn along_and_across<R: Real>(s: SymMat3<R>, n: Vec3<R>) -> (R, R) {
    let one = n.any_orthogonal();
    let two = n.cross(one);
    let (first, second) = (s * one, s * two);
    let (xx, yy, xy) = (one.dot(first), two.dot(second), one.dot(second));
    let half = R::lit(0.5);
    let difference = half * (xx - yy);
    let larger = half.fma(xx + yy, difference.fma(difference, xy.squared()).sqrt());
    (n.dot(s * n), larger)
}

/// Prepares the contacts of a substep, after the flight of the bodies, and starts with what the
/// last substep ended with.
#[inline(always)]
pub(crate) fn meet<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    inverse_inertias(k, t);
    save(k, t);
    for list in k.count(found::SOLID) {
        for place in t.contacts.found.places(k, list) {
            let s = t.contacts.found.row(k, place);
            k.write(t.touching, s, touching::LAMBDA, [M::R::zero(); 4]);
            if t.grips {
                k.store_vec3(t.grip, s, grip::LAMBDA, Vec3::zero());
            }
            approach(k, t, s, h);
        }
    }
}

/// The row of a slot, and its start.
#[inline(always)]
fn approach<M: Machine>(k: &mut M, t: &Tables, s: M::I, h: M::R) {
    let rows = k.link_row::<_, 2>(t.touch_links, s);
    let [x, y, z, l, m, n, distance, feature] = k.read(t.contacts.slot, s, 0);
    let (x, n) = (Vec3::new(x, y, z), Vec3::new(l, m, n));
    let arm_a = x - k.vec3(t.saved_pose, rows[0], 0);
    let arm_b = x - k.vec3(t.saved_pose, rows[1], 0);
    let (a, b) = (
        k.spatial(t.before, rows[0], 0),
        k.spatial(t.before, rows[1], 0),
    );
    let u = at(b, arm_b) - at(a, arm_a);
    let speed = n.dot(u);
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    if t.contacts.sticks {
        stick(k, t, s, pair, n.fma(-speed, u), h);
    }
    let fastest = k.load(t.contacts.pair, pair, pair_field::FASTEST);
    // Stopped at a corner, it would turn past it within the step: so the lighter is stopped before its centre of mass.
    let flies = n.dot(b.linear - a.linear).lt(-fastest);
    let m_a = k.load(t.mass, rows[0], mass::INVERSE);
    let m_b = k.load(t.mass, rows[1], mass::INVERSE);
    let lighter = Vec3::select(m_b.ge(m_a), arm_b, arm_a);
    let aside = n.fma(-n.dot(lighter), lighter);
    let aside = Vec3::select(flies, aside, Vec3::zero());
    let (arm_a, arm_b) = (arm_a - aside, arm_b - aside);
    k.store_vec3(t.touching, s, touching::ARMS, arm_a);
    k.store_vec3(t.touching, s, touching::ARMS + 3, arm_b);
    let sides = Sides {
        a: Side::load(k, t, rows[0], arm_a),
        b: Side::load(k, t, rows[1], arm_b),
        rows,
    };
    let gained = if t.jointed {
        M::R::zero()
    } else {
        let given_a = k.spatial(t.unpushed, rows[0], 0) - a;
        let given_b = k.spatial(t.unpushed, rows[1], 0) - b;
        n.dot(at(given_a, arm_a) - at(given_b, arm_b))
    };
    let row = law(k, t, s, h, sides.weights(n), distance, [speed, gained]);
    k.write(t.touching, s, touching::GAP, row);
    if t.grips {
        k.write(t.grip, s, 0, sides.moments(n));
    }
    let same = t.kept.same(k, s, feature) & t.contacts.near(k, s);
    let slow = slow(k, t, h);
    let warm = if t.jointed {
        let slow = slow.max(M::R::lit(STILL));
        (same, slow * speed.max(slow).recip())
    } else {
        (same & speed.abs().le(slow), M::R::one())
    };
    start(k, t, s, h, sides, n, warm);
}

/// Decides by the slip [m/s] of a slot's surfaces whether they stick in this substep.
#[inline(always)]
fn stick<M: Machine>(k: &mut M, t: &Tables, s: M::I, pair: M::I, slip: Vec3<M::R>, h: M::R) {
    let coefficients = [
        k.load(t.contacts.pair, pair, pair_field::FRICTION),
        k.load(t.contacts.pair, pair, pair_field::STICKING),
    ];
    let fall = k.vec3(t.global, k.index(0), global::GRAVITY).length() * h;
    let friction = cone::friction(coefficients, slip.length_squared(), fall);
    k.store(t.cone, s, 0, friction);
}

/// Speed [m/s] up to which points rest on each other.
#[inline(always)]
fn slow<M: Machine>(k: &M, t: &Tables, h: M::R) -> M::R {
    let gravity = k.vec3(t.global, k.index(0), global::GRAVITY);
    gravity.length() * h * M::R::lit(RESTING)
}

/// The fields of a row from [`touching::GAP`] on, for inverse masses along and across the normal, of
/// a point at a `distance` [m] that came with a `speed` [m/s] along it, and gains so much in a free substep.
#[inline(always)]
fn law<M: Machine>(
    k: &M,
    t: &Tables,
    s: M::I,
    h: M::R,
    (along, across): (M::R, M::R),
    distance: M::R,
    [speed, gained]: [M::R; 2],
) -> [M::R; 6] {
    let (zero, one, tiny) = (M::R::zero(), M::R::one(), M::R::lit(TINY));
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let [_, restitution, stiffness, damping, _, added] =
        k.read(t.contacts.pair, pair, pair_field::FRICTION);
    let bounces = restitution.gt(zero) & speed.lt(-slow(k, t, h));
    let fastest = k.load(t.contacts.pair, pair, pair_field::FASTEST);
    let rigid = bounces | speed.lt(-fastest);
    let spring = h.squared() * stiffness;
    let least = spring * M::R::lit(1.0 / SETTLED) - along.max(tiny).recip();
    let g = (h.fma(damping, spring) + added).max(least).max(tiny);
    let share = M::R::select(rigid, one, (g - spring) / g);
    let beyond = distance.gt(zero);
    let inertia = added * h.fma(speed, distance.max(zero)) / g;
    let inertia = M::R::select(beyond, inertia.min(zero), inertia);
    let inertia = M::R::select(rigid, zero, inertia);
    let gap = distance - share.fma(distance.min(zero), inertia);
    let mut leave = k.cell(zero);
    if let Some(_branch) = k.if_any(bounces) {
        leave.write(late(restitution, -speed, gained, distance * h.recip()));
    }
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let borne = M::R::select(t.kept.known(k, s), n.dot(t.kept.force(k, s)), zero);
    let softness = M::R::select(rigid, zero, g.recip());
    let bearing = h * softness * borne * M::R::lit(GROWTH);
    let pushed = h * bearing.max(M::R::lit(PUSH_OUT));
    [
        gap.max(-pushed),
        softness,
        (along + softness).max(tiny).recip(),
        across.max(tiny).recip(),
        -(leave.read() * h),
        M::R::select(bounces, one, zero),
    ]
}

/// Starts a contact with a share of the multipliers of the last substep, where `warm`.
#[inline(always)]
fn start<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    h: M::R,
    sides: Sides<M::R, M::I>,
    n: Vec3<M::R>,
    (warm, share): (<M::R as Real>::Mask, M::R),
) {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let friction = friction_of(k, t, s, pair);
    let last = t.kept.force(k, s) * (h.squared() * share);
    let along = n.dot(last);
    let press = along.max(M::R::zero());
    let rub = within(n.fma(-along, last), friction * press);
    for (i, x) in [press, rub.x, rub.y, rub.z].into_iter().enumerate() {
        k.store_where(warm, t.touching, s, touching::LAMBDA + i, x);
    }
    let impulse = n.fma(press, rub) * h.recip();
    let mut sides = sides.pushed(impulse);
    if t.grips {
        let last = k.vec3(t.gripped, s, 0) * (h.squared() * share);
        let last = bounded(k, t, pair, n, press, last);
        sides = sides.turned(last * h.recip());
        for (i, x) in last.to_array().into_iter().enumerate() {
            k.store_where(warm, t.grip, s, grip::LAMBDA + i, x);
        }
    }
    sides.store(k, t, warm);
}

/// Torque against twisting and rolling of a point that is pressed by λₙ, as far as that bears it.
#[inline(always)]
fn bounded<M: Machine>(
    k: &M,
    t: &Tables,
    pair: M::I,
    n: Vec3<M::R>,
    press: M::R,
    torque: Vec3<M::R>,
) -> Vec3<M::R> {
    let [torsion, rolling] = k.read(t.contacts.pair, pair, pair_field::TORSION);
    let (along, most) = (n.dot(torque), torsion * press);
    let roll = within(n.fma(-along, torque), rolling * press);
    n.fma(along.clamp(-most, most), roll)
}

/// Torsional and rolling friction of a contact that is pressed by λₙ.
#[inline(always)]
fn resist<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    h: M::R,
    sides: Sides<M::R, M::I>,
    press: M::R,
    mask: <M::R as Real>::Mask,
) -> Sides<M::R, M::I> {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let [about, across, x, y, z] = k.read(t.grip, s, 0);
    let (before, spin) = (Vec3::new(x, y, z), sides.spin() * h);
    let along = n.dot(spin);
    let wish = n.fma(-(about * along), before);
    let wish = n.fma(-along, spin).fma(-across, wish);
    let after = bounded(k, t, pair, n, press, wish);
    for (i, x) in after.to_array().into_iter().enumerate() {
        k.store_where(mask, t.grip, s, grip::LAMBDA + i, x);
    }
    sides.turned((after - before) * h.recip())
}

/// The coefficient of friction of a slot in this substep.
#[inline(always)]
fn friction_of<M: Machine>(k: &M, t: &Tables, s: M::I, pair: M::I) -> M::R {
    if t.contacts.sticks {
        k.load(t.cone, s, 0)
    } else {
        k.load(t.contacts.pair, pair, pair_field::FRICTION)
    }
}

/// A vector shortened to a length.
#[inline(always)]
fn within<R: Real>(v: Vec3<R>, most: R) -> Vec3<R> {
    let size = v.length();
    v * R::select(size.gt(most), most / size.max(R::lit(TINY)), R::one())
}

/// Sweeps over all contacts, by which velocities change; `ending` is 1 in the last round, in which
/// bodies leave each other.
#[inline(always)]
pub(crate) fn sweeps<M: Machine>(k: &mut M, t: &Tables, h: M::R, ending: M::R) {
    let ending = ending.gt(M::R::zero());
    for _ in k.count(t.sweeps) {
        for list in k.count(found::SOLID) {
            for place in t.contacts.found.places(k, list) {
                let s = t.contacts.found.row(k, place);
                let [bounces, pressed] = k.read(t.touching, s, touching::BOUNCE + 1);
                let leaves = bounces.gt(M::R::zero()) & pressed.gt(M::R::zero());
                let mask = t.contacts.near(k, s) & ((!ending) | leaves);
                if let Some(_branch) = k.if_any(mask) {
                    relax(k, t, s, h, ending, mask);
                }
            }
        }
    }
}

/// One contact: normal, then friction, then what resists twisting and rolling.
#[inline(always)]
fn relax<M: Machine>(
    k: &mut M,
    t: &Tables,
    s: M::I,
    h: M::R,
    ending: <M::R as Real>::Mask,
    mask: <M::R as Real>::Mask,
) {
    let pair = k.link(t.contacts.slot_links, s, slot_link::PAIR);
    let friction = friction_of(k, t, s, pair);
    let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
    let [gap, softness, normal, tangent, leave] = k.read(t.touching, s, touching::GAP);
    let [pressed, x, y, z] = k.read(t.touching, s, touching::LAMBDA);
    let (rubbed, over_h) = (Vec3::new(x, y, z), h.recip());
    let rows = k.link_row::<_, 2>(t.touch_links, s);
    let sides = Sides {
        a: Side::load(k, t, rows[0], k.vec3(t.touching, s, touching::ARMS)),
        b: Side::load(k, t, rows[1], k.vec3(t.touching, s, touching::ARMS + 3)),
        rows,
    };

    let c = M::R::select(ending, leave, softness.fma(pressed, gap));
    let c = h.fma(n.dot(sides.velocity()), c);
    let press = c.fnma(normal, pressed).max(M::R::zero());
    let sides = sides.pushed(n * ((press - pressed) * over_h));

    let u = sides.velocity();
    let slip = n.fma(-n.dot(u), u);
    let rub = within(slip.fma(-(h * tangent), rubbed), friction * press);
    let mut sides = sides.pushed((rub - rubbed) * over_h);
    if t.grips {
        sides = resist(k, t, s, h, sides, press, mask);
    }

    sides.store(k, t, mask);
    for (i, x) in [press, rub.x, rub.y, rub.z].into_iter().enumerate() {
        k.store_where(mask, t.touching, s, touching::LAMBDA + i, x);
    }
}

/// Remembers how the bodies move before they are pushed.
#[inline(always)]
pub(crate) fn save<M: Machine>(k: &mut M, t: &Tables) {
    for row in k.range(k.index(1), k.index(t.rows)) {
        let twist = k.spatial(t.twist, row, 0);
        k.store_spatial(t.unpushed, row, 0, twist);
    }
}

/// Moves the bodies by h times what the pushes have changed their velocities by since [`save`].
#[inline(always)]
pub(crate) fn drift<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for row in k.range(k.index(1), k.index(t.rows)) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let moved = (twist - k.spatial(t.unpushed, row, 0)) * h;
        let solid = Solid::load(k, t, row);
        let (q, spin) = solid.turned(pose.q, twist.angular, moved.angular, Vec3::zero());
        k.store_pose(t.pose, row, 0, Pose::new(pose.p + moved.linear, q));
        k.store_spatial(t.twist, row, 0, Spatial::new(spin, twist.linear));
    }
    if t.jointed {
        arms(k, t);
    }
}

/// Keeps the contacts of the substep just made in the state: to be reported, and to start the
/// next one with. As forces and torques, for that may be of another length.
#[inline(always)]
pub(crate) fn keep<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let rate = h.squared().recip();
    t.kept.clear(k);
    for list in k.count(found::SOLID) {
        for place in t.contacts.found.places(k, list) {
            let s = t.contacts.found.row(k, place);
            let n = k.vec3(t.contacts.slot, s, slot::NORMAL);
            let [pressed, rx, ry, rz] = k.read(t.touching, s, touching::LAMBDA);
            let lambda = n.fma(pressed, Vec3::new(rx, ry, rz));
            let touch = t.contacts.touch(k, t, s, lambda * rate);
            // Where it acted, which is not where surfaces met if a centre of mass was stopped.
            let center = k.vec3(t.saved_pose, k.link(t.touch_links, s, 1), 0);
            let arm = k.vec3(t.touching, s, touching::ARMS + 3);
            let position = touch.position + (arm - (touch.position - center));
            t.kept.keep(k, s, Touch { position, ..touch });
            if t.grips {
                let torque = k.vec3(t.grip, s, grip::LAMBDA);
                k.store_vec3(t.gripped, s, 0, torque * rate);
            }
        }
    }
    sense(k, &t.contacts, t, &t.kept);
}
