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
//! rate that the small step began with. With v₀ the rate without any, and r the response of the axis, the
//! rate solves
//!
//! ```text
//! g(v) = v − v₀ − r h F(v) = 0
//! ```
//!
//! which rises and is piecewise linear. Between the last corner where g ≤ 0 and the first where g > 0 it
//! is a line, and the rate where that line crosses: no iteration, and no force beyond its bounds.

use super::super::tables::global;
use super::tables::{JointTables, axis, axis_link, law, line};
use numbers::{Cell, Machine, Real};

/// No rate is larger.
const FAR: f64 = 1e9;

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

/// By how much the impulse of an axis changes that has the rate `rate`, and has been given `had`.
#[inline(always)]
pub(super) fn balance<M: Machine>(
    k: &mut M,
    t: &JointTables,
    i: M::I,
    rate: M::R,
    had: M::R,
) -> M::R {
    let only = k.index(0);
    let [h, per] = k.read(t.global, only, global::STEP);
    let [stiffness, damping, force, armature] = k.read(t.axis, i, axis::PASSIVE);
    let [value, begin] = k.read(t.axis, i, axis::VALUE);
    let response = k.load(t.axis, i, axis::RESPONSE).max(M::R::lit(1e-30));
    let scale = response * h;
    let inert = armature * per;
    let falls = h.fma(stiffness, damping) + inert;
    let leads = inert.fma(begin, stiffness.fnma(value, force));
    let [first, end] = [
        k.link(t.links, i, axis_link::FIRST),
        k.link(t.links, i, axis_link::END),
    ];
    let g = Balance::<M> {
        slope: scale.fma(falls, M::R::one()),
        lead: scale.fma(leads, response.fnma(had, rate)),
        scale,
        first,
        end,
    };
    let mut after = k.cell(g.lead / g.slope);
    if let Some(_branch) = k.when(k.less(first, end)) {
        for law in k.range(first, end) {
            prepare(k, t, law, [value, begin], h, per);
        }
        after.write(g.solve(k, t));
    }
    (after.read() - rate) / response
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
