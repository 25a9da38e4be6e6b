//! What joints outside a tree lock, solved as blocks: those that close loops or hold a distance.
//!
//! For a joint of bodies A and B, with an error c of several rows, and a
//! compliance α, the multiplier changes by (Macklin et al. 2016, eq. 18, with all
//! rows of a joint at once):
//!
//! ```text
//! (K + α/h² 1) Δλ = −c − α/h² λ
//! ```
//!
//! K = I_A⁻¹ + I_B⁻¹ for rotations; for positions, with arms r from the centres,
//! K = (1/m_A + 1/m_B) 1 − r_A× I_A⁻¹ r_A× − r_B× I_B⁻¹ r_B× (Müller et al. 2020,
//! eqs. 2–11, as a block). Blocks, not projections along the residual, because
//! only they contract perturbations.
//!
//! A gap that was there before the substep, g = c − h u with u the speed at which it changes, closes at a bounded pace p
//! where it is wider than what turning bodies leave in a substep, h w, with w ≥ |ω_A| r_A + |ω_B| r_B: taken out at once,
//! one of 0.2 m makes 400 m/s in a substep of 0.5 ms, which arms that turn meanwhile do not take back. What the substep has
//! added, h u, goes at once:
//!
//! ```text
//! c ← c − (1 − p h/|g|) g,  |g| > h w
//! ```
//!
//! What gives way has no pace: it is a spring.

use super::body::Body;
use super::tables::{Tables, global, joint_field, joint_link};
use crate::locks::{hold, pace, turns};
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Machine, Mat3, Pose, Quat, Real, SymMat3, Vec3};

/// Pivots below this are of a joint between immovable bodies [1/kg, 1/(kg·m²)].
const TINY: f64 = 1e-18;
/// w [m/s, rad/s], at least.
const DRIFT: f64 = 20.0;
/// A push beyond which there is no cap [kg·m]; its square fits f32.
const MOST: f64 = 1e15;

/// The two bodies of a joint and where it holds them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends<R, I> {
    pub a: Body<R>,
    pub b: Body<R>,
    pub row_a: I,
    pub row_b: I,
}

impl<R: Real, I: Index> Ends<R, I> {
    #[inline(always)]
    pub fn load<M: Machine<R = R, I = I>>(k: &M, t: &Tables, j: I) -> Self {
        let row_a = k.link(t.joint_links, j, joint_link::A);
        let row_b = k.link(t.joint_links, j, joint_link::B);
        Self {
            a: Body::load(k, t, row_a),
            b: Body::load(k, t, row_b),
            row_a,
            row_b,
        }
    }
    #[inline(always)]
    pub fn store<M: Machine<R = R, I = I>>(&self, k: &mut M, t: &Tables) {
        self.a.store(k, t, self.row_a);
        self.b.store(k, t, self.row_b);
    }
    /// A position impulse [kg·m] at B's arm and a moment [kg·m²] from A to B; the impulse is at
    /// the same point of A, which goes with B.
    #[inline(always)]
    pub fn push(&mut self, linear: Vec3<R>, angular: Vec3<R>, rb: Vec3<R>, over_h: R) {
        let ra = self.b.pose.p + rb - self.a.pose.p;
        let reached = angular + ra.cross(linear);
        let more = (self.b.twist.linear - self.a.twist.linear).cross(linear);
        self.a.push(-linear, -reached, more, over_h);
        let reached = angular + rb.cross(linear);
        self.b.push(linear, reached, Vec3::zero(), over_h);
    }
    /// Position impulses [kg·m] at both arms, which keep the angular momentum of the pair: see
    /// `tree`, with the velocity of B's point for u.
    #[inline(always)]
    pub fn shove(&mut self, linear: Vec3<R>, (ra, rb): Arms<R>, over_h: R) {
        let (a, b) = (self.a.twist, self.b.twist);
        let gap = (self.b.pose.p + rb) - (self.a.pose.p + ra);
        let apart = gap.fma(-over_h, b.linear - a.linear);
        let ahead = b.angular.cross(rb);
        let more = (apart + ahead).cross(linear);
        self.a.push(-linear, -ra.cross(linear), more, over_h);
        let more = -ahead.cross(linear);
        self.b.push(linear, rb.cross(linear), more, over_h);
    }
    /// As they were, where the mask holds.
    #[inline(always)]
    pub fn unless(self, mask: R::Mask, were: Self) -> Self {
        Self {
            a: self.a.unless(mask, were.a),
            b: self.b.unless(mask, were.b),
            ..self
        }
    }
    /// Angular frames on both bodies, world axes.
    #[inline(always)]
    pub fn frames<M: Machine<R = R, I = I>>(&self, k: &M, t: &Tables, j: I) -> (Quat<R>, Quat<R>) {
        (
            self.a.pose.q * k.quat(t.joint, j, joint_field::FRAME_A),
            self.b.pose.q * k.quat(t.joint, j, joint_field::FRAME_B),
        )
    }
    /// Arms from the centres to the anchors, and the gap between the anchors.
    #[inline(always)]
    pub fn arms<M: Machine<R = R, I = I>>(
        &self,
        k: &M,
        t: &Tables,
        j: I,
    ) -> (Vec3<R>, Vec3<R>, Vec3<R>) {
        let ra = self
            .a
            .pose
            .q
            .rotate(k.vec3(t.joint, j, joint_field::ANCHOR_A));
        let rb = self
            .b
            .pose
            .q
            .rotate(k.vec3(t.joint, j, joint_field::ANCHOR_B));
        (ra, rb, (self.b.pose.p + rb) - (self.a.pose.p + ra))
    }
}

/// What a joint moves, held from one of its blocks to the next.
struct Pair<M: Machine> {
    a: (Pose<M::Cell>, Spatial<M::Cell>),
    b: (Pose<M::Cell>, Spatial<M::Cell>),
    turn: Vec3<M::Cell>,
    shove: Vec3<M::Cell>,
}

impl<M: Machine> Pair<M> {
    #[inline(always)]
    fn hold(k: &M, ends: &Ends<M::R, M::I>) -> Self {
        Self {
            a: (ends.a.pose.hold(k), ends.a.twist.hold(k)),
            b: (ends.b.pose.hold(k), ends.b.twist.hold(k)),
            turn: Vec3::zero().hold(k),
            shove: Vec3::zero().hold(k),
        }
    }
    /// The bodies as they are now.
    #[inline(always)]
    fn ends(&self, start: &Ends<M::R, M::I>) -> Ends<M::R, M::I> {
        let mut ends = *start;
        (ends.a.pose, ends.a.twist) = (self.a.0.get(), self.a.1.get());
        (ends.b.pose, ends.b.twist) = (self.b.0.get(), self.b.1.get());
        ends
    }
    #[inline(always)]
    fn set(&mut self, ends: &Ends<M::R, M::I>) {
        self.a.0.set(ends.a.pose);
        self.a.1.set(ends.a.twist);
        self.b.0.set(ends.b.pose);
        self.b.1.set(ends.b.twist);
    }
    /// Applies an angular multiplier.
    #[inline(always)]
    fn twist(&mut self, mut ends: Ends<M::R, M::I>, delta: Vec3<M::R>, over_h: M::R) {
        let none = Vec3::zero();
        ends.a.push(none, -delta, none, over_h);
        ends.b.push(none, delta, none, over_h);
        self.set(&ends);
        self.turn.set(delta);
    }
    /// Applies a linear multiplier at two arms.
    #[inline(always)]
    fn shove(
        &mut self,
        mut ends: Ends<M::R, M::I>,
        arms: Arms<M::R>,
        delta: Vec3<M::R>,
        over_h: M::R,
    ) {
        ends.shove(delta, arms, over_h);
        self.set(&ends);
        self.shove.set(delta);
    }
}

/// Arms from the centres of A and B to where a push acts.
type Arms<R> = (Vec3<R>, Vec3<R>);

/// One pass over all closings, in the model's order: rotations, then positions.
#[inline(always)]
pub(crate) fn closings<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let over_h = h.recip();
    for c in k.count(t.closings) {
        let j = k.link(t.closing_links, c, 0);
        let start = Ends::load(k, t, j);
        let mut pair = Pair::hold(k, &start);
        let lambda = k.spatial(t.multiplier, c, 0);
        let [shifts, turns] = k.read(t.joint, j, joint_field::COMPLIANCE);
        let strength = strength(k, t, j);
        let block = Block::new(j, start, [turns, h], lambda.angular);
        let kind = k.link(t.joint_links, j, joint_link::TURNS);
        if let Some(_branch) = k.when(k.equals(kind, turns::ONE)) {
            pair.twist(start, block.revolute(k, t) * strength, over_h);
        }
        if let Some(_branch) = k.when(k.equals(kind, turns::LOCKED)) {
            pair.twist(start, block.fixed(k, t) * strength, over_h);
        }
        if let Some(_branch) = k.when(k.equals(kind, turns::TWO)) {
            pair.twist(start, block.universal(k, t) * strength, over_h);
        }
        let ends = pair.ends(&start);
        let block = Block::new(j, ends, [shifts, h], lambda.linear);
        let kind = k.link(t.joint_links, j, joint_link::HOLD);
        if let Some(_branch) = k.when(k.equals(kind, hold::POINT)) {
            let (arms, delta) = block.point(k, t);
            let delta = capped(k, t, h, &ends, [lambda.linear, delta * strength]);
            pair.shove(ends, arms, delta, over_h);
        }
        if let Some(_branch) = k.when(k.equals(kind, hold::SLIDE)) {
            let (arms, delta) = block.slide(k, t);
            let delta = capped(k, t, h, &ends, [lambda.linear, delta * strength]);
            pair.shove(ends, arms, delta, over_h);
        }
        if let Some(_branch) = k.when(k.equals(kind, hold::DISTANCE)) {
            let (arms, delta) = block.distance(k, t);
            let delta = capped(k, t, h, &ends, [lambda.linear, delta * strength]);
            pair.shove(ends, arms, delta, over_h);
        }
        pair.ends(&start).store(k, t);
        let sum = lambda + Spatial::new(pair.turn.get(), pair.shove.get());
        k.store_spatial(t.multiplier, c, 0, sum);
    }
}

/// Relaxation, or 0 for a joint that does not act.
#[inline(always)]
fn strength<M: Machine>(k: &M, t: &Tables, j: M::I) -> M::R {
    let relaxation = k.load(t.global, k.index(0), global::RELAXATION);
    relaxation * k.load(t.joint, j, joint_field::ENABLED)
}

/// Rows of a joint that are solved at once: its bodies, α/h², and what they have pushed before.
struct Block<M: Machine> {
    j: M::I,
    ends: Ends<M::R, M::I>,
    soft: M::R,
    lambda: Vec3<M::R>,
    h: M::R,
}

impl<M: Machine> Block<M> {
    #[inline(always)]
    fn new(
        j: M::I,
        ends: Ends<M::R, M::I>,
        [compliance, h]: [M::R; 2],
        lambda: Vec3<M::R>,
    ) -> Self {
        Self {
            j,
            ends,
            soft: compliance / h.squared(),
            lambda,
            h,
        }
    }
    /// h u of turns, and of B's anchor against A's, at these arms.
    #[inline(always)]
    fn turned(&self) -> Vec3<M::R> {
        (self.ends.b.twist.angular - self.ends.a.twist.angular) * self.h
    }
    #[inline(always)]
    fn moved(&self, (ra, rb): Arms<M::R>) -> Vec3<M::R> {
        let (a, b) = (self.ends.a.twist, self.ends.b.twist);
        (b.linear + b.angular.cross(rb) - (a.linear + a.angular.cross(ra))) * self.h
    }
    /// How fast the bodies sweep through what is at these distances from them, squared: no less than both together.
    #[inline(always)]
    fn sweep2(&self, [ra2, rb2]: [M::R; 2]) -> M::R {
        let (a, b) = (self.ends.a.twist.angular, self.ends.b.twist.angular);
        let sum = a.length_squared().fma(ra2, b.length_squared() * rb2);
        sum + sum
    }
    /// Which share of a gap that was as wide before the substep is to stay, where bodies sweep so fast.
    #[inline(always)]
    fn stays(&self, wide: M::R, (pace, sweep2): (f64, M::R)) -> M::R {
        let drift = M::R::lit(DRIFT).max(sweep2.sqrt());
        let (zero, most) = (M::R::zero(), self.h * drift);
        let share = M::R::one() - self.h * M::R::lit(pace) / wide.max(most);
        let closes = self.soft.gt(zero) | wide.le(most);
        M::R::select(closes, zero, share)
    }
    /// The paces of turns, and of shifts at these arms, with what bodies sweep.
    #[inline(always)]
    fn turning(&self) -> (f64, M::R) {
        (pace::TURNS, self.sweep2([M::R::one(), M::R::one()]))
    }
    #[inline(always)]
    fn shifting(&self, (ra, rb): Arms<M::R>) -> (f64, M::R) {
        let arms = [ra.length_squared(), rb.length_squared()];
        (pace::SHIFTS, self.sweep2(arms))
    }
    /// The part of a gap that a substep closes, of which it has added some.
    #[inline(always)]
    fn paced(&self, gap: Vec3<M::R>, added: Vec3<M::R>, pace: (f64, M::R)) -> Vec3<M::R> {
        let before = gap - added;
        before.fma(-self.stays(before.length(), pace), gap)
    }
    /// The same of one row.
    #[inline(always)]
    fn paced_row(&self, gap: M::R, added: M::R, pace: (f64, M::R)) -> M::R {
        let before = gap - added;
        before.fma(-self.stays(before.abs(), pace), gap)
    }
    /// Two rows across the axis a: c = a_A × a_B, which turns B's axis back onto A's.
    #[inline(always)]
    fn revolute(&self, k: &M, t: &Tables) -> Vec3<M::R> {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (qa, qb) = ends.frames(k, t, j);
        let frame = qa.to_mat3();
        let c = frame
            .x
            .cross(qb.rotate(Vec3::new(M::R::one(), M::R::zero(), M::R::zero())));
        let turned = self.turned();
        let across = frame.x.fma(-frame.x.dot(turned), turned);
        let c = self.paced(c, across, self.turning());
        let i = ends.a.i + ends.b.i;
        let (u, v) = (frame.y, frame.z);
        let (iu, iv) = (i * u, i * v);
        let (kuu, kuv, kvv) = (u.dot(iu) + soft, u.dot(iv), v.dot(iv) + soft);
        let (cu, cv) = (
            soft.fma(u.dot(lambda), u.dot(c)),
            soft.fma(v.dot(lambda), v.dot(c)),
        );
        let determinant = kuv.fnma(kuv, kuu * kvv).max(M::R::lit(TINY * TINY)).recip();
        let lu = kuv.fnma(cv, kvv * cu) * -determinant;
        let lv = kuv.fnma(cu, kuu * cv) * -determinant;
        u.fma(lu, v * lv)
    }
    /// Three rows: c is the rotation vector from A's frame to B's.
    #[inline(always)]
    fn fixed(&self, k: &M, t: &Tables) -> Vec3<M::R> {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (qa, qb) = ends.frames(k, t, j);
        let c = qa.rotate((qa.conjugate() * qb).log());
        let c = self.paced(c, self.turned(), self.turning());
        let i = ends.a.i + ends.b.i + SymMat3::diagonal(soft);
        let right = -(lambda.fma(soft, c));
        i.solve(right, M::R::lit(TINY))
    }
    /// One row: the angle between the first axis, fixed in A, and the second, fixed in
    /// B, stays. With n = a × b it changes by n̂ · ω, so c = (a · b₀ − a · b) / |n|.
    #[inline(always)]
    fn universal(&self, k: &M, t: &Tables) -> Vec3<M::R> {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (qa, qb) = ends.frames(k, t, j);
        let second = k.vec3(t.joint, j, joint_field::SECOND);
        let a = qa.rotate(Vec3::new(M::R::one(), M::R::zero(), M::R::zero()));
        let b = qb.rotate(second);
        let n = a.cross(b);
        let size = n.length().max(M::R::lit(1e-6));
        let n = n * size.recip();
        let c = (second.x - a.dot(b)) / size;
        let c = self.paced_row(c, n.dot(self.turned()), self.turning());
        let lambda = n.dot(lambda);
        let i = n.dot((ends.a.i + ends.b.i) * n) + soft;
        let delta = -(soft.fma(lambda, c)) / i.max(M::R::lit(TINY));
        n * delta
    }
    /// Three rows: the anchors coincide.
    #[inline(always)]
    fn point(&self, k: &M, t: &Tables) -> (Arms<M::R>, Vec3<M::R>) {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (ra, rb, gap) = ends.arms(k, t, j);
        let block = linear_block(&ends, ra, rb) + SymMat3::diagonal(soft);
        let gap = self.paced(gap, self.moved((ra, rb)), self.shifting((ra, rb)));
        let right = -(lambda.fma(soft, gap));
        ((ra, rb), block.solve_well(right, M::R::lit(TINY * TINY)))
    }
    /// One or two rows: the anchors coincide but along the free directions of the
    /// linear frame, which A carries. Both bodies are pushed at B's anchor, so that
    /// the pair keeps its angular momentum.
    #[inline(always)]
    fn slide(&self, k: &M, t: &Tables) -> (Arms<M::R>, Vec3<M::R>) {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (ra, rb, gap) = ends.arms(k, t, j);
        let ra = ra + gap;
        let frame = (ends.a.pose.q * k.quat(t.joint, j, joint_field::LINEAR_FRAME)).to_mat3();
        let locked = k.vec3(t.joint, j, joint_field::LOCKED);
        let block =
            linear_block(&ends, ra, rb).rotated(frame.transpose()) + SymMat3::diagonal(soft);
        let (x, y, z) = (locked.x, locked.y, locked.z);
        let one = M::R::one();
        // Free rows become 1 · Δλ = 0.
        let block = SymMat3 {
            xx: block.xx * x + (one - x),
            yy: block.yy * y + (one - y),
            zz: block.zz * z + (one - z),
            xy: block.xy * x * y,
            xz: block.xz * x * z,
            yz: block.yz * y * z,
        };
        let along = frame.transpose_mul(gap).times(locked);
        let moved = frame.transpose_mul(self.moved((ra, rb))).times(locked);
        let gap = gap + frame * (self.paced(along, moved, self.shifting((ra, rb))) - along);
        let c = lambda.fma(soft, gap);
        let right = -frame.transpose_mul(c).times(locked);
        let delta = frame * block.solve(right, M::R::lit(TINY));
        ((ra, rb), delta)
    }
    /// One row along the line between the anchors.
    #[inline(always)]
    fn distance(&self, k: &M, t: &Tables) -> (Arms<M::R>, Vec3<M::R>) {
        let Self {
            j,
            ends,
            soft,
            lambda,
            ..
        } = *self;
        let (ra, rb, gap) = ends.arms(k, t, j);
        let zero = M::R::zero();
        let n = gap.normalized_or(Vec3::new(zero, M::R::one(), zero));
        let c = gap.length() - k.load(t.joint, j, joint_field::LENGTH);
        let c = self.paced_row(c, n.dot(self.moved((ra, rb))), self.shifting((ra, rb)));
        let weight = n.dot(linear_block(&ends, ra, rb) * n) + soft;
        let lambda = n.dot(lambda);
        let delta = n * (-(soft.fma(lambda, c)) / weight.max(M::R::lit(TINY)));
        ((ra, rb), delta)
    }
}

/// −r× I⁻¹ r× = r× I⁻¹ (r×)ᵀ: what a push at the arm r does through rotation.
#[inline(always)]
pub(crate) fn arm_inertia<R: Real>(i: SymMat3<R>, r: Vec3<R>) -> SymMat3<R> {
    let (x, y, z) = i.columns();
    // The rows of B = r× I⁻¹ are r × (columns of I⁻¹), read across.
    let (bx, by, bz) = (r.cross(x), r.cross(y), r.cross(z));
    let b = Mat3::from_columns(bx, by, bz).transpose();
    // B (r×)ᵀ: entry (p, q) is (r × row p of B)_q.
    let (p, q, s) = (r.cross(b.x), r.cross(b.y), r.cross(b.z));
    SymMat3 {
        xx: p.x,
        yy: q.y,
        zz: s.z,
        xy: p.y,
        xz: p.z,
        yz: q.z,
    }
}

/// K of a pair of bodies pushed at arms.
#[inline(always)]
fn linear_block<R: Real, I: Index>(ends: &Ends<R, I>, ra: Vec3<R>, rb: Vec3<R>) -> SymMat3<R> {
    arm_inertia(ends.a.i, ra) + arm_inertia(ends.b.i, rb) + SymMat3::diagonal(ends.a.m + ends.b.m)
}

/// What a pass may add to a linear multiplier within the caps. Counts where they bite.
#[inline(always)]
fn capped<M: Machine>(
    k: &mut M,
    t: &Tables,
    h: M::R,
    ends: &Ends<M::R, M::I>,
    [before, delta]: [Vec3<M::R>; 2],
) -> Vec3<M::R> {
    if !t.capped_at_all {
        return delta;
    }
    let (world, one) = (k.index(0), M::R::one());
    let share = within_caps(k, t, h, ends, [before, delta]);
    let over = share.lt(one);
    if let Some(_branch) = k.if_any(over) {
        let count = k.load(t.capped, world, 0) + one;
        k.store_where(over, t.capped, world, 0, count);
    }
    delta * share.min(one)
}

/// The share s by which a pass may push a pair of bodies by N, where the passes before have pushed by P; more than one
/// where all of it is within the caps: |P + s N| ≤ h² × the force cap, |s N| ≤ the displacement cap over the bodies' 1/m.
#[inline(always)]
pub(crate) fn within_caps<M: Machine>(
    k: &M,
    t: &Tables,
    h: M::R,
    ends: &Ends<M::R, M::I>,
    [p, n]: [Vec3<M::R>; 2],
) -> M::R {
    let (world, zero, tiny) = (k.index(0), M::R::zero(), M::R::lit(TINY));
    let by_force = k.load(t.global, world, global::FORCE_CAP) * h.squared();
    let weight = (ends.a.m + ends.b.m).max(tiny);
    let by_shift = k.load(t.global, world, global::DISPLACEMENT_CAP) / weight;
    // Alone, N is within the cap by as much as it is shorter; after P, s solves |P + s N|² = cap².
    let alone = by_force / n.length().max(tiny);
    let (nn, pn) = (n.length_squared().max(tiny), p.dot(n));
    let most = by_force.min(M::R::lit(MOST));
    let left = (most.squared() - p.length_squared()).max(zero);
    let after = ((pn.squared() + nn * left).sqrt() - pn) / nn;
    let first = p.length_squared().same(zero);
    let by_force = M::R::select(first, alone, after);
    by_force.min(by_shift / n.length().max(tiny))
}
