//! The impulses of one contact of two bodies.
//!
//! With the arms r of a point, normal n from A to B, gap C, and the relative velocity there
//! u = v_B + ω_B × r_B − v_A − ω_A × r_A, whose response to an impulse P is
//!
//! ```text
//! K P = (1/m_A + 1/m_B) P + (I_A⁻¹ (r_A × P)) × r_A + (I_B⁻¹ (r_B × P)) × r_B
//! ```
//!
//! each point in turn changes its normal impulse λ so that
//!
//! ```text
//! apart (C > 0):    n·u + C/h ≥ 0                          (it may close, not more)
//! overlapping:      n·u + β C + γ λ ≥ 0,  β = k / (c + h k),  γ = 1 / (h (c + h k))
//! Δλ = −(n·u + bias + γ λ) / (n·K n + γ),   λ + Δλ ≥ 0
//! ```
//!
//! which is a spring k with a damper c, implicit in time (Catto, *Soft Constraints*, 2011). Surfaces
//! in N/m are that spring, which what is apart may reach within the small step as well (n·u + C/h +
//! γ λ ≥ 0), and are left alone when relaxing; for a step in which something comes too fast for them they are as all
//! others. These do not give way: k is the stiffest that small steps can follow, c = T k makes an overlap close with the
//! time constant T, and when relaxing β and γ are zero, so that what was pushed apart keeps no speed from it. Friction
//! follows, for the contact as a whole (`friction`).

use super::friction;
use super::layout::RESTING;
use super::tables::{ContactTables, global, manifold, point, row};
use crate::cone;
use numbers::machine::{Held, Hold};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Real, SymMat3, Vec3};

/// Highest frequency of a spring, per small step: at twice that, walls of boxes sway.
const FASTEST: f64 = 0.125;

/// Share of the way through each other on which a spring has to stop two shapes.
const PASSABLE: f64 = 0.5;

/// Small steps within which an overlap closes, at least.
const CALM: f64 = 8.0;

/// Share of what it would take to stop them for which points count in the centre of pressure besides what they bear.
const SLIGHT: f64 = 1e-4;

/// Speed [m/s] that points have besides for that, lest those at rest count for nothing.
const STILL: f64 = 0.01;

/// Gap [m] from which on a point is none.
pub const NOWHERE: f64 = 1e6;

/// What a unit impulse does to the bodies of a contact.
#[derive(Clone, Copy)]
pub(super) struct Response<R> {
    /// 1/m_A + 1/m_B.
    pub masses: R,
    pub inertia: [SymMat3<R>; 2],
    pub arms: [Vec3<R>; 2],
}

impl<R: Real> Response<R> {
    /// K P.
    #[inline(always)]
    fn to(&self, p: Vec3<R>) -> Vec3<R> {
        let [ra, rb] = self.arms;
        let a = (self.inertia[0] * ra.cross(p)).cross(ra);
        let b = (self.inertia[1] * rb.cross(p)).cross(rb);
        p.fma(self.masses, a + b)
    }
    /// The largest eigenvalue of K in the plane across n.
    #[inline(always)]
    pub fn across(&self, n: Vec3<R>) -> R {
        let s = n.any_orthogonal();
        let t = n.cross(s);
        let (ks, kt) = (self.to(s), self.to(t));
        let half = R::lit(0.5);
        let mean = half * (s.dot(ks) + t.dot(kt));
        let apart = half * (s.dot(ks) - t.dot(kt));
        mean + apart.fma(apart, s.dot(kt).squared()).sqrt()
    }
}

/// How two bodies have moved since the step began.
#[derive(Clone, Copy)]
pub(super) struct Moved<R> {
    /// B against A.
    shift: Vec3<R>,
    /// Shares of the shift that lengthen the arm of A, and shorten that of B.
    shares: [R; 2],
}

impl<R: Real> Moved<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &ContactTables, masses: [R; 2]) -> Self {
        let (a, b) = (k.index(0), k.index(1));
        let share = masses[1] / (masses[0] + masses[1]).max(R::lit(1e-30));
        Self {
            shift: k.vec3(t.body, b, row::SHIFT) - k.vec3(t.body, a, row::SHIFT),
            shares: [share, R::one() - share],
        }
    }
    /// Arms now, given those when the step began: their ends meet.
    #[inline(always)]
    pub fn meet(&self, arms: [Vec3<R>; 2]) -> [Vec3<R>; 2] {
        [
            self.shift.fma(self.shares[0], arms[0]),
            self.shift.fma(-self.shares[1], arms[1]),
        ]
    }
    /// B against A since the step began.
    #[inline(always)]
    pub fn shift(&self) -> Vec3<R> {
        self.shift
    }
    /// The arms of a point now.
    #[inline(always)]
    pub fn arms<M: Machine<R = R>>(&self, k: &M, t: &ContactTables, i: M::I) -> [Vec3<R>; 2] {
        self.meet([
            k.vec3(t.point, i, point::ARM_A),
            k.vec3(t.point, i, point::ARM_B),
        ])
    }
}

/// A direction n at a point of contact.
#[derive(Clone, Copy)]
pub(super) struct Along<R> {
    n: Vec3<R>,
    /// r_A × n and r_B × n.
    levers: [Vec3<R>; 2],
    /// I_A⁻¹ (r_A × n) and I_B⁻¹ (r_B × n). They do not wait for the velocities, which each point in turn changes.
    turns: [Vec3<R>; 2],
}

impl<R: Real> Along<R> {
    /// n·u of bodies that move so.
    #[inline(always)]
    pub fn speed(&self, [a, b]: [Spatial<R>; 2]) -> R {
        let turning = self.levers[1].dot(b.angular) - self.levers[0].dot(a.angular);
        self.n.dot(b.linear - a.linear) + turning
    }
}

/// The bodies of a contact, changed by impulses.
pub(super) struct Pair<M: Machine> {
    masses: [M::R; 2],
    inertia: [SymMat3<M::R>; 2],
    a: <Spatial<M::R> as Hold<M>>::Held,
    b: <Spatial<M::R> as Hold<M>>::Held,
}

#[inline(always)]
fn motion<M: Machine>(k: &M, t: &ContactTables, body: M::I) -> Spatial<M::R> {
    Spatial::new(
        k.vec3(t.body, body, row::SPIN),
        k.vec3(t.body, body, row::VELOCITY),
    )
}

#[inline(always)]
fn store_motion<M: Machine>(k: &mut M, t: &ContactTables, body: M::I, motion: Spatial<M::R>) {
    k.store_vec3(t.body, body, row::SPIN, motion.angular);
    k.store_vec3(t.body, body, row::VELOCITY, motion.linear);
}

/// Velocity of the point of a body at an arm from its centre.
#[inline(always)]
fn velocity_at<R: Real>(motion: Spatial<R>, arm: Vec3<R>) -> Vec3<R> {
    motion.linear + motion.angular.cross(arm)
}

impl<M: Machine> Pair<M> {
    #[inline(always)]
    pub fn load(k: &M, t: &ContactTables) -> Self {
        let only = k.index(0);
        Self {
            masses: k.read(t.manifold, only, manifold::INVERSE_MASS),
            inertia: [
                k.sym(t.manifold, only, manifold::INVERSE_INERTIA),
                k.sym(t.manifold, only, manifold::INVERSE_INERTIA + 6),
            ],
            a: motion(k, t, only).hold(k),
            b: motion(k, t, k.index(1)).hold(k),
        }
    }
    #[inline(always)]
    pub fn store(self, k: &mut M, t: &ContactTables) {
        let (a, b) = (self.a.get(), self.b.get());
        store_motion(k, t, k.index(0), a);
        store_motion(k, t, k.index(1), b);
    }
    #[inline(always)]
    pub fn along(&self, n: Vec3<M::R>, arms: [Vec3<M::R>; 2]) -> Along<M::R> {
        let levers = [arms[0].cross(n), arms[1].cross(n)];
        let turns = [self.inertia[0] * levers[0], self.inertia[1] * levers[1]];
        Along { n, levers, turns }
    }
    /// 1/m of both.
    #[inline(always)]
    pub fn masses(&self) -> [M::R; 2] {
        self.masses
    }
    /// How the two move.
    #[inline(always)]
    pub fn motions(&self) -> [Spatial<M::R>; 2] {
        [self.a.get(), self.b.get()]
    }
    /// n·u.
    #[inline(always)]
    pub fn speed(&self, along: &Along<M::R>) -> M::R {
        along.speed(self.motions())
    }
    /// n·K n.
    #[inline(always)]
    pub fn compliance(&self, along: &Along<M::R>) -> M::R {
        let a = along.levers[0].dot(along.turns[0]);
        let b = along.levers[1].dot(along.turns[1]);
        (self.masses[0] + self.masses[1] + (a + b)).max(M::R::lit(1e-30))
    }
    /// A share of the way from the motions of `before` to those of now.
    #[inline(always)]
    pub fn go_on(&mut self, before: [Spatial<M::R>; 2], share: M::R) {
        let [a, b] = self.motions();
        self.a.set(before[0] + (a - before[0]) * share);
        self.b.set(before[1] + (b - before[1]) * share);
    }
    /// λ n on B, −λ n on A.
    #[inline(always)]
    pub fn give(&mut self, along: &Along<M::R>, impulse: M::R) {
        let (mut a, mut b) = (self.a.get(), self.b.get());
        a.linear = along.n.fma(-(self.masses[0] * impulse), a.linear);
        b.linear = along.n.fma(self.masses[1] * impulse, b.linear);
        a.angular = along.turns[0].fma(-impulse, a.angular);
        b.angular = along.turns[1].fma(impulse, b.angular);
        self.a.set(a);
        self.b.set(b);
    }
    /// Relative velocity at two arms.
    #[inline(always)]
    pub fn velocity(&self, arms: [Vec3<M::R>; 2]) -> Vec3<M::R> {
        velocity_at(self.b.get(), arms[1]) - velocity_at(self.a.get(), arms[0])
    }
    /// Relative angular velocity.
    #[inline(always)]
    pub fn spin(&self) -> Vec3<M::R> {
        self.b.get().angular - self.a.get().angular
    }
    /// P on B at its arm, −P on A.
    #[inline(always)]
    pub fn push(&mut self, p: Vec3<M::R>, arms: [Vec3<M::R>; 2]) {
        let (mut a, mut b) = (self.a.get(), self.b.get());
        a.linear = p.fma(-self.masses[0], a.linear);
        b.linear = p.fma(self.masses[1], b.linear);
        a.angular -= self.inertia[0] * arms[0].cross(p);
        b.angular += self.inertia[1] * arms[1].cross(p);
        self.a.set(a);
        self.b.set(b);
    }
    /// An angular impulse on B, and the opposite on A.
    #[inline(always)]
    pub fn turn(&mut self, l: Vec3<M::R>) {
        let (mut a, mut b) = (self.a.get(), self.b.get());
        a.angular -= self.inertia[0] * l;
        b.angular += self.inertia[1] * l;
        self.a.set(a);
        self.b.set(b);
    }
    /// What was given again had the arms of the small step before.
    #[inline(always)]
    fn mend_arms(&mut self, k: &M, t: &ContactTables, moved: &Moved<M::R>) {
        let only = k.index(0);
        let since = moved.shift - k.vec3(t.manifold, only, manifold::LAST);
        let torque = since.cross(k.vec3(t.manifold, only, manifold::LAST + 3));
        let (mut a, mut b) = (self.a.get(), self.b.get());
        a.angular -= self.inertia[0] * (torque * moved.shares[0]);
        b.angular -= self.inertia[1] * (torque * moved.shares[1]);
        self.a.set(a);
        self.b.set(b);
    }
}

/// Arms, masses and softness of every point, from where it lies and how its bodies stand and move.
#[inline(always)]
pub fn prepare<M: Machine>(k: &mut M, t: &ContactTables) {
    let (only, a, b) = (k.index(0), k.index(0), k.index(1));
    let masses = [
        k.load(t.body, a, row::INVERSE_MASS),
        k.load(t.body, b, row::INVERSE_MASS),
    ];
    let inertia = [
        k.sym(t.body, a, row::INVERSE_INERTIA),
        k.sym(t.body, b, row::INVERSE_INERTIA),
    ];
    k.write(t.manifold, only, manifold::INVERSE_MASS, masses);
    k.store_sym(t.manifold, only, manifold::INVERSE_INERTIA, inertia[0]);
    k.store_sym(t.manifold, only, manifold::INVERSE_INERTIA + 6, inertia[1]);
    k.write(t.manifold, only, manifold::LAST, [M::R::zero(); 6]);
    let ends = [motion(k, t, a), motion(k, t, b)];
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let fast = too_fast(k, t, normal);
    let (mean, pressed) = middles(k, t, normal, ends, masses[0] + masses[1]);
    // All of what is too fast acts at one place.
    let middle = Vec3::select(fast, mean, pressed);
    k.store_vec3(t.manifold, only, manifold::OFFSET, middle - mean);
    let touching = arms_of(k, t, middle);
    let arms = stopping_arms(k, t, normal, touching, fast);
    k.store_vec3(t.manifold, only, manifold::ASIDE, touching[0] - arms[0]);
    let response = Response {
        masses: masses[0] + masses[1],
        inertia,
        arms,
    };
    stiffen(k, t, normal, response);
    friction::prepare(k, t, normal, response);
    let u = velocity_at(ends[1], response.arms[1]) - velocity_at(ends[0], response.arms[0]);
    let slip = normal.fma(-normal.dot(u), u);
    let coefficients = [
        k.load(t.manifold, only, manifold::FRICTION),
        k.load(t.manifold, only, manifold::STICKING),
    ];
    // What is gained by a fall in a whole step, however that is cut.
    let fall = k.load(t.global, only, global::RESTING) * M::R::lit(1.0 / RESTING);
    let friction = cone::friction(coefficients, slip.length_squared(), fall);
    k.store(t.manifold, only, manifold::FRICTION, friction);
    prepare_points(k, t, response, middle, fast);
}

/// The mean of the points, and the centre of pressure: their mean by what they bore in the small step before. Where that is
/// next to nothing, how fast they would get into each other in the step counts.
#[inline(always)]
fn middles<M: Machine>(
    k: &M,
    t: &ContactTables,
    normal: Vec3<M::R>,
    motions: [Spatial<M::R>; 2],
    masses: M::R,
) -> (Vec3<M::R>, Vec3<M::R>) {
    let (only, zero, one) = (k.index(0), M::R::zero(), M::R::one());
    let time = k.load(t.global, only, global::STEP) * k.load(t.global, only, global::STEPS);
    let rate = time.recip();
    let slight = masses.max(M::R::lit(1e-30)).recip() * M::R::lit(SLIGHT);
    let still = M::R::lit(STILL);
    // From the first one on, so that one alone is exactly where it is.
    let origin = k.vec3(t.point, only, point::ARM_A);
    let mut by_number = Mean::new(k);
    let mut by_load = Mean::new(k);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let [x, y, z, gap, load] = k.read(t.point, i, point::ARM_A);
        let at = Vec3::new(x, y, z);
        let arms = arms_of(k, t, at);
        let u = velocity_at(motions[1], arms[1]) - velocity_at(motions[0], arms[0]);
        let closing = -rate.fma(gap.max(zero), normal.dot(u));
        let is = M::R::select(gap.lt(M::R::lit(NOWHERE)), one, zero);
        let at = Vec3::select(is.gt(zero), at - origin, Vec3::zero());
        let load = slight.fma(closing.max(zero) + still, load);
        by_number.add(at, is);
        by_load.add(at, load * is);
    }
    let mean = by_number.or(Vec3::zero());
    (origin + mean, origin + by_load.or(mean))
}

/// A mean of places by their weights.
struct Mean<M: Machine> {
    sum: <Vec3<M::R> as Hold<M>>::Held,
    weight: M::Cell,
}

impl<M: Machine> Mean<M> {
    #[inline(always)]
    fn new(k: &M) -> Self {
        Self {
            sum: Vec3::zero().hold(k),
            weight: k.cell(M::R::zero()),
        }
    }
    #[inline(always)]
    fn add(&mut self, at: Vec3<M::R>, weight: M::R) {
        self.sum.set(at.fma(weight, self.sum.get()));
        self.weight.write(self.weight.read() + weight);
    }
    /// The mean, or the other one where nothing weighs.
    #[inline(always)]
    fn or(&self, other: Vec3<M::R>) -> Vec3<M::R> {
        let (least, weight) = (M::R::lit(1e-20), self.weight.read());
        let mean = self.sum.get() * weight.max(least).recip();
        Vec3::select(weight.gt(least), mean, other)
    }
}

/// From the centres of mass to a point.
#[inline(always)]
fn arms_of<M: Machine>(k: &M, t: &ContactTables, at: Vec3<M::R>) -> [Vec3<M::R>; 2] {
    let (a, b) = (k.index(0), k.index(1));
    [
        at - k.vec3(t.body, a, row::CENTER),
        at - k.vec3(t.body, b, row::CENTER),
    ]
}

/// Whether the bodies would get through each other within the step.
#[inline(always)]
fn too_fast<M: Machine>(k: &M, t: &ContactTables, normal: Vec3<M::R>) -> <M::R as Real>::Mask {
    let (only, second) = (k.index(0), k.index(1));
    let u = motion(k, t, second).linear - motion(k, t, only).linear;
    let time = k.load(t.global, only, global::STEP) * k.load(t.global, only, global::STEPS);
    let thickness = k.load(t.manifold, only, manifold::THICKNESS);
    normal.dot(u).fma(time, thickness).lt(M::R::zero())
}

/// Arms of a point; of what is too fast, those of the foot of the lighter one's centre of mass. Stopped at a corner it
/// would turn past it within the step.
#[inline(always)]
fn stopping_arms<M: Machine>(
    k: &M,
    t: &ContactTables,
    normal: Vec3<M::R>,
    arms: [Vec3<M::R>; 2],
    fast: <M::R as Real>::Mask,
) -> [Vec3<M::R>; 2] {
    let (a, b) = (k.index(0), k.index(1));
    let [mass_a, mass_b] = [
        k.load(t.body, a, row::INVERSE_MASS),
        k.load(t.body, b, row::INVERSE_MASS),
    ];
    let lighter = Vec3::select(mass_b.ge(mass_a), arms[1], arms[0]);
    let aside = normal.fma(-normal.dot(lighter), lighter);
    let aside = Vec3::select(fast, aside, Vec3::zero());
    [arms[0] - aside, arms[1] - aside]
}

/// A spring lets in what comes with v by v / ω. Where that is too far, nothing gives way in this step.
#[inline(always)]
fn stiffen<M: Machine>(k: &mut M, t: &ContactTables, normal: Vec3<M::R>, response: Response<M::R>) {
    let (a, b) = (k.index(0), k.index(1));
    let [spring, _, settling] = k.read(t.manifold, a, manifold::SPRING);
    let gives = settling.le(M::R::zero());
    if let Some(_branch) = k.if_any(gives) {
        let [ra, rb] = response.arms;
        let u = velocity_at(motion(k, t, b), rb) - velocity_at(motion(k, t, a), ra);
        let frequency = (spring * normal.dot(response.to(normal))).sqrt();
        let way = k.load(t.manifold, a, manifold::THICKNESS) * M::R::lit(PASSABLE);
        let through = frequency.fma(way, normal.dot(u)).lt(M::R::zero());
        let [h] = k.read(t.global, a, global::STEP);
        k.store_where(gives & through, t.manifold, a, manifold::SETTLING, h);
    }
}

#[inline(always)]
fn prepare_points<M: Machine>(
    k: &mut M,
    t: &ContactTables,
    at_middle: Response<M::R>,
    middle: Vec3<M::R>,
    fast: <M::R as Real>::Mask,
) {
    let only = k.index(0);
    let tiny = M::R::lit(1e-30);
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let [spring, damper, settling] = k.read(t.manifold, only, manifold::SPRING);
    let [h, rate] = k.read(t.global, only, global::STEP);
    let gives = settling.le(M::R::zero());
    let settling = settling.max(h * M::R::lit(CALM));
    let fastest = (rate * M::R::lit(core::f64::consts::TAU * FASTEST)).squared();
    let motions = [motion(k, t, only), motion(k, t, k.index(1))];
    for i in k.range(only, k.link(t.points, only, 0)) {
        let at = k.vec3(t.point, i, point::ARM_A);
        let arms = stopping_arms(k, t, normal, arms_of(k, t, at), fast);
        let response = Response { arms, ..at_middle };
        let compliance = normal.dot(response.to(normal)).max(tiny);
        let hardest = fastest / compliance;
        let stiffness = M::R::select(gives, spring, hardest);
        let damping = M::R::select(gives, damper, hardest * settling);
        let damping = h.fma(stiffness, damping).max(tiny);
        let u = velocity_at(motions[1], arms[1]) - velocity_at(motions[0], arms[0]);
        let spread = (at - middle).length();
        let softness = (h * damping).recip();
        k.store_vec3(t.point, i, point::ARM_A, arms[0]);
        k.store_vec3(t.point, i, point::ARM_B, arms[1]);
        k.store(t.point, i, point::SPREAD, spread);
        k.store(t.point, i, point::GAIN, normal.dot(u));
        let numbers = [compliance, stiffness / damping, softness];
        k.write(t.point, i, point::COMPLIANCE, numbers);
    }
}

/// Gives the impulses that the contact had in the step before.
#[inline(always)]
pub fn warm_start<M: Machine>(k: &mut M, t: &ContactTables) {
    let only = k.index(0);
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let mut pair = Pair::load(k, t);
    for i in k.range(only, k.link(t.points, only, 0)) {
        let arms = [
            k.vec3(t.point, i, point::ARM_A),
            k.vec3(t.point, i, point::ARM_B),
        ];
        let along = pair.along(normal, arms);
        pair.give(&along, k.load(t.point, i, point::IMPULSE));
    }
    let arms = [
        k.vec3(t.manifold, only, manifold::ARMS),
        k.vec3(t.manifold, only, manifold::ARMS + 3),
    ];
    pair.push(k.vec3(t.manifold, only, manifold::DRAG), arms);
    pair.turn(k.vec3(t.manifold, only, manifold::TWIST));
    pair.store(k, t);
}

/// One relaxation of the contact; `pushing` is 1 where surfaces are to be pushed apart, else 0.
#[inline(always)]
pub fn solve<M: Machine>(k: &mut M, t: &ContactTables, pushing: M::R) {
    let (only, second) = (k.index(0), k.index(1));
    let normal = k.vec3(t.manifold, only, manifold::NORMAL);
    let [rate] = k.read(t.global, only, global::RATE);
    let push_out = k.load(t.global, only, global::PUSH_OUT);
    let gives = k
        .load(t.manifold, only, manifold::SETTLING)
        .le(M::R::zero());
    let unbounded = M::R::lit(1e30);
    let pushes = pushing.gt(M::R::zero());
    let stays = gives & !pushes;
    // What is given in a small step is what relaxing leaves of it.
    let counts = M::R::one() - pushing;
    let turns = [
        k.vec3(t.body, only, row::TURN),
        k.vec3(t.body, second, row::TURN),
    ];
    let mut pair = Pair::load(k, t);
    let moved = Moved::load(k, t, pair.masses);
    let nearer = normal.dot(moved.shift);
    if let Some(_branch) = k.if_any(pushes) {
        pair.mend_arms(k, t, &moved);
    }
    let (mut load, mut moment) = (k.cell(M::R::zero()), k.cell(M::R::zero()));
    for i in k.range(only, k.link(t.points, only, 0)) {
        let arms = moved.arms(k, t, i);
        let along = pair.along(normal, arms);
        let tilt = turns[1].cross(arms[1]) - turns[0].cross(arms[0]);
        let [gap, old, spread, sum] = k.read(t.point, i, point::GAP);
        let [compliance, bias, softness] = k.read(t.point, i, point::COMPLIANCE);
        let gap = gap + (nearer + normal.dot(tilt));
        let apart = gap.gt(M::R::zero());
        let pushed = (bias * gap).max(M::R::select(gives, -unbounded, -push_out)) * pushing;
        let wanted = M::R::select(apart, gap * rate, pushed);
        let hard = M::R::select(gives, softness, M::R::zero());
        let soft = M::R::select(apart, hard, softness * pushing);
        let mass = (compliance + soft).recip();
        let residual = pair.speed(&along) + soft.fma(old, wanted);
        let new = mass.fnma(residual, old).max(M::R::zero());
        let new = M::R::select(stays, old, new);
        pair.give(&along, new - old);
        let sum = counts.fma(new, sum);
        k.write(t.point, i, point::IMPULSE, [new, spread, sum]);
        load.write(load.read() + new);
        moment.write(spread.fma(new, moment.read()));
    }
    friction::solve(k, t, &mut pair, &moved, load.read(), moment.read());
    let given = normal.fma(load.read(), k.vec3(t.manifold, only, manifold::DRAG));
    // All lanes push, or none does.
    if let Some(_branch) = k.if_any(pushes) {
        k.store_vec3(t.manifold, only, manifold::LAST, moved.shift);
        k.store_vec3(t.manifold, only, manifold::LAST + 3, given);
    } else {
        friction::count(k, t);
    }
    pair.store(k, t);
}
