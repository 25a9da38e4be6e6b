//! Two capsules: their axes as segments, with a radius each.

use crate::{FLAT, Manifold, Placed, Point};
use numbers::{Real, Vec3};

/// Two capsules: one point, or where they lie side by side one at each end of the stretch they share.
///
/// The nearest points of two segments c₁ + s u₁, c₂ + t u₂ (Ericson, Real-Time Collision
/// Detection, 2005, §5.1.9): with d = c₂ − c₁ and b = u₁·u₂,
/// ```text
/// s = (u₁·d − b u₂·d)/(1 − b²), kept on its segment;   t = b s − u₂·d, kept on its;   s = u₁·d + b t
/// ```
#[inline(always)]
pub fn capsule_capsule<R: Real>(first: &Placed<R>, second: &Placed<R>) -> Manifold<R> {
    let (h1, h2) = (first.half_segment(), second.half_segment());
    let (u1, u2) = (first.axes.y, second.axes.y);
    let d = second.position - first.position;
    let (b, p, q) = (u1.dot(u2), u1.dot(d), u2.dot(d));
    let sine2 = u1.cross(u2).length_squared();
    let parallel = sine2.lt(R::lit(FLAT * FLAT));

    // The stretch of the first axis that runs along the second.
    let reach = b.abs() * h2;
    let (from, to) = ((p - reach).max(-h1), (p + reach).min(h1));
    let shared = parallel & from.lt(to);
    let middle = ((from + to) * R::lit(0.5)).clamp(-h1, h1);

    let nearly = sine2.lt(R::lit(1e-9));
    let s = b.fnma(q, p) / sine2.max(R::lit(1e-9));
    let s = R::select(nearly, middle, s).clamp(-h1, h1);
    let t = b.fma(s, -q).clamp(-h2, h2);
    let s = b.fma(t, p).clamp(-h1, h1);
    let t = b.fma(s, -q).clamp(-h2, h2);

    let pair = Axes { first, second, d };
    let way = pair.between(s, t);
    let across = crossing(u1, u2, way, d);
    // Of the two ways to the normal, the one that loses less to rounding where axes nearly meet.
    let inside = s.abs().lt(h1) & t.abs().lt(h2) & !nearly;
    let meet = way.length_squared().lt(sine2 * (h1 + h2).squared());
    let normal = Vec3::select(inside & meet, across, way.normalized_or(across));
    let at_from = b.fma(from, -q).clamp(-h2, h2);
    let at_to = b.fma(to, -q).clamp(-h2, h2);
    let s = R::select(shared, from, s);
    let t = R::select(shared, at_from, t);
    let feature = R::select(shared, R::one(), R::zero());
    Manifold::double(
        normal,
        pair.point(normal, s, t, feature),
        pair.point(normal, to, at_to, R::lit(2.0)).only_if(shared),
    )
}

/// The axes of two capsules, `d` apart.
struct Axes<'a, R> {
    first: &'a Placed<R>,
    second: &'a Placed<R>,
    d: Vec3<R>,
}

impl<R: Real> Axes<'_, R> {
    /// From the first axis at s to the second at t.
    #[inline(always)]
    fn between(&self, s: R, t: R) -> Vec3<R> {
        self.second.axes.y.fma(t, self.d) - self.first.axes.y * s
    }
    /// The contact there.
    #[inline(always)]
    fn point(&self, normal: Vec3<R>, s: R, t: R, feature: R) -> Point<R> {
        let (first, second) = (self.first, self.second);
        let gap = normal.dot(self.between(s, t)) - first.size.x - second.size.x;
        let on_axis = first.axes.y.fma(s, first.position);
        let on_first = normal.fma(first.size.x, on_axis);
        Point::from_a(on_first, normal, gap, feature)
    }
}

/// At right angles to both axes, pointing along `way`, or along `d` where that is null.
#[inline(always)]
fn crossing<R: Real>(u1: Vec3<R>, u2: Vec3<R>, way: Vec3<R>, d: Vec3<R>) -> Vec3<R> {
    let across = u1.cross(u2).normalized_or(u1.any_orthogonal());
    let along = across.dot(way);
    let side = R::select(along.same(R::zero()), across.dot(d), along);
    Vec3::select(side.lt(R::zero()), -across, across)
}
