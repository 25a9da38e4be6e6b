//! What acts along an axis: springs, dampers, armatures, drives, stops, friction and motors, at once.
//!
//! All are forces that fall with the rate v that the axis has at the end of the small step: passive ones
//! for good, others within bounds,
//!
//! ```text
//! F(v) = P − D v + Σ clamp(l − s v, low, high)      l, s: force at v = 0, and h k + d
//! ```
//!
//! of springs k and dampers d at the coordinate θ + h v, and of armatures m, which are dampers m/h of the
//! speed that they had: what is geared to an axis keeps the rate that it has got here, whatever becomes of the bodies, or
//! their axes, or its momentum would not be kept. Springs that small steps resolve are taken at θ + Θ h v, with Θ by
//! [`implicitness`](crate::implicitness): their d is less by (1 − Θ) h k. With v₀ the rate without any, and r the response of
//! the axis, the rate solves
//!
//! ```text
//! g(v) = v − v₀ − r h F(v) = 0
//! ```
//!
//! which rises and is piecewise linear. Between the last corner where g ≤ 0 and the first where g > 0 it
//! is a line, and the rate where that line crosses: no iteration, and no force beyond its bounds.
//!
//! What changes a rate after that, as locks do when relaxing, works against it, too: of a change the line leaves 1/g', so
//! that the impulse along the axis stays what it was in the end. If it did not, locks would be solved for an axis that is
//! free, and then find one that is not: where r is small beside the response without locks, they would not come to rest.
//!
//! Axes of one joint come one after the other, each with what is passive along the others dragged along (see [`super`]), so
//! that springs, dampers and armatures of all of them are solved as one; forces within bounds as they come.
//!
//! Of a ball the laws of three axes are one drive, whose effort limit its torque has: a limit of each that changes in every
//! small step with where the torque points.

use super::super::tables::global;
use super::STIFF;
use super::tables::{JointTables, axis, axis_link, law, line, work};
use numbers::{Cell, Machine, Real, Vec3};

/// No rate is larger.
const FAR: f64 = 1e9;
/// No torque that is shared is smaller [N·m].
const WEAK: f64 = 1e-30;

/// g, and the laws in it.
struct Balance<M: Machine> {
    /// 1 + r h D, v₀ + r h P, r h.
    slope: M::R,
    lead: M::R,
    scale: M::R,
    first: M::I,
    end: M::I,
}

impl<M: Machine> Balance<M> {
    /// g(v).
    #[inline(always)]
    fn at(&self, k: &M, t: &JointTables, v: M::R) -> M::R {
        let mut force = k.cell(M::R::zero());
        for i in k.range(self.first, self.end) {
            let [lead, slope, low, high] = k.read(t.line, i, line::LEAD);
            force.write(force.read() + slope.fnma(v, lead).clamp(low, high));
        }
        self.scale.fnma(force.read(), self.slope.fma(v, -self.lead))
    }
    /// Slope of g at v.
    #[inline(always)]
    fn slope_at(&self, k: &M, t: &JointTables, v: M::R) -> M::R {
        let mut sum = k.cell(M::R::zero());
        for i in k.range(self.first, self.end) {
            let [lead, slope, low, high] = k.read(t.line, i, line::LEAD);
            let f = slope.fnma(v, lead);
            let free = f.gt(low) & f.lt(high);
            sum.write(sum.read() + M::R::select(free, slope, M::R::zero()));
        }
        self.scale.fma(sum.read(), self.slope)
    }
    /// Where g is zero.
    #[inline(always)]
    fn solve(&self, k: &M, t: &JointTables) -> M::R {
        let far = M::R::lit(FAR);
        let (mut under, mut over) = (k.cell(-far), k.cell(far));
        for i in k.range(self.first, self.end) {
            let [lead, slope, low, high] = k.read(t.line, i, line::LEAD);
            let steep = slope.max(M::R::lit(1e-30));
            for bound in [high, low] {
                let corner = ((lead - bound) / steep).clamp(-far, far);
                let below = self.at(k, t, corner).le(M::R::zero());
                under.write(under.read().max(M::R::select(below, corner, -far)));
                over.write(over.read().min(M::R::select(below, far, corner)));
            }
        }
        let (low, high) = (under.read(), over.read());
        let one = M::R::one();
        let near = (self.lead / self.slope).clamp(low, high);
        // Well inside the line, which a corner belongs to two of.
        let inside = (low.max(near - one) + high.min(near + one)) * M::R::lit(0.5);
        let slope = self.slope_at(k, t, inside);
        let v = (inside - self.at(k, t, inside) / slope).clamp(low, high);
        (v - self.at(k, t, v) / slope).clamp(low, high)
    }
}

/// The rate that what acts along an axis leads to, and 1/g' there; it has the rate `rate`, and been given `had`, and what is
/// geared to it has the speed `begin`.
#[inline(always)]
pub(super) fn balance<M: Machine>(
    k: &mut M,
    t: &JointTables,
    i: M::I,
    [rate, begin]: [M::R; 2],
    had: M::R,
) -> (M::R, M::R) {
    let only = k.index(0);
    let [h, per] = k.read(t.global, only, global::STEP);
    let [stiffness, damping, force, armature] = k.read(t.axis, i, axis::PASSIVE);
    let value = k.load(t.axis, i, axis::VALUE);
    let response = k.load(t.axis, i, axis::RESPONSE).max(M::R::lit(STIFF));
    let scale = response * h;
    let inert = armature * per;
    let falls = h.fma(stiffness, damping) + inert;
    let leads = inert.fma(begin, stiffness.fnma(value, force));
    let [first, end] = laws(k, t, i);
    let g = Balance::<M> {
        slope: scale.fma(falls, M::R::one()),
        lead: scale.fma(leads, response.fnma(had, rate)),
        scale,
        first,
        end,
    };
    let mut after = k.cell(g.lead / g.slope);
    let mut slope = k.cell(g.slope);
    if let Some(_branch) = k.when(k.less(first, end)) {
        for law in k.range(first, end) {
            prepare(k, t, law, [value, begin], h, per);
        }
        let share = k.load(t.work, i, work::SHARE);
        let [low, high] = k.read(t.line, first, line::LOW);
        k.write(t.line, first, line::LOW, [low * share, high * share]);
        let v = g.solve(k, t);
        after.write(v);
        slope.write(g.slope_at(k, t, v));
    }
    (after.read(), slope.read().recip())
}

/// A law as a line with bounds. A stop damps what goes beyond it: the rate that just reaches it, w, is
/// free. Its inertia is carried along from the rate before, or from w where that is farther: it takes nothing away from
/// what runs into it, and holds back nothing that does not get there.
#[inline(always)]
fn prepare<M: Machine>(
    k: &mut M,
    t: &JointTables,
    i: M::I,
    [value, begin]: [M::R; 2],
    h: M::R,
    per: M::R,
) {
    let [stiffness, damping, rest, force, low, high, stop, inertia] =
        k.read(t.law, i, law::STIFFNESS);
    let way = rest - value;
    let reaching = (way * per).clamp(-high, -low) * stop;
    let farther = reaching + (begin - reaching).clamp(-high, -low);
    let kept = M::R::select(reaching.same(M::R::zero()), begin, farther);
    let inert = inertia * per;
    let lead = stiffness.fma(way, damping.fma(reaching, inert.fma(kept, force)));
    let slope = h.fma(stiffness, damping) + inert;
    k.write(t.line, i, line::LEAD, [lead, slope, low, high]);
}

/// The effort limit of a ball's drive is one of its torque: where that is more at these rates, each axis gets its part of the
/// limit. A drive's law is the first of its row.
#[inline(always)]
pub(super) fn share_effort<M: Machine>(
    k: &mut M,
    t: &JointTables,
    rates: Vec3<M::R>,
    ball: <M::R as Real>::Mask,
) {
    let zero = M::R::zero();
    let [h, _] = k.read(t.global, k.index(0), global::STEP);
    let mut squared = k.cell(zero);
    for (row, rate) in rates.to_array().into_iter().enumerate() {
        let i = k.index(row);
        let [first, end] = laws(k, t, i);
        if let Some(_branch) = k.when(k.less(first, end)) {
            let [stiffness, damping, rest, force] = k.read(t.law, first, law::STIFFNESS);
            let way = rest - k.load(t.axis, i, axis::VALUE);
            let slope = h.fma(stiffness, damping);
            let torque = stiffness.fma(way, slope.fnma(rate, force));
            let torque = M::R::select(drives(k, t, i), torque, zero);
            k.store(t.work, i, work::TORQUE, torque);
            squared.write(torque.fma(torque, squared.read()));
        }
    }
    let torque = squared.read().sqrt();
    for row in 0..3 {
        let i = k.index(row);
        let [first, end] = laws(k, t, i);
        if let Some(_branch) = k.when(k.less(first, end)) {
            let own = k.load(t.work, i, work::TORQUE).abs();
            let over = torque.gt(k.load(t.law, first, law::HIGH));
            let over = ball & drives(k, t, i) & over;
            let share = own / torque.max(M::R::lit(WEAK));
            k.store_where(over, t.work, i, work::SHARE, share);
        }
    }
}

/// The first law of a row, and the first after its laws.
#[inline(always)]
fn laws<M: Machine>(k: &M, t: &JointTables, row: M::I) -> [M::I; 2] {
    [
        k.link(t.links, row, axis_link::FIRST),
        k.link(t.links, row, axis_link::END),
    ]
}

/// Whether a row has a drive.
#[inline(always)]
fn drives<M: Machine>(k: &M, t: &JointTables, row: M::I) -> <M::R as Real>::Mask {
    k.load(t.axis, row, axis::TIME).ge(M::R::zero())
}
