//! Where a line is inside a solid, for any numbers.
//!
//! A line p(t) = o + t d, |d| = 1, in the solid's frame, is inside a convex solid for one span of t.
//! Spans of half spaces and quadrics make those of all solids: what is in both of two is in the
//! later entry and the earlier exit. Numbers keep their digits where o is near the solid.
//!
//! Sums of products are written out, as a fused multiply-add is a call of a library where processors are not asked
//! for one.

use numbers::{Mask, Real, Vec3};

/// Beyond all distances [m], and finite: infinities have no place in a shader.
pub const ENDLESS: f64 = 1e30;

/// Squared sine of the angle to an axis of directions that are along it.
const ALONG: f64 = 1e-30;

/// A line in a solid's frame.
#[derive(Clone, Copy, Debug)]
pub struct Line<R> {
    /// A point of it [m]: that at t = 0.
    pub origin: Vec3<R>,
    /// Of unit length.
    pub direction: Vec3<R>,
}

/// The part of a line that is inside; there is none where it leaves before it enters.
#[derive(Clone, Copy, Debug)]
pub struct Span<R> {
    /// Where it enters [m], from the line's origin; −[`ENDLESS`] where it always was inside.
    pub enter: R,
    /// Where it leaves [m].
    pub leave: R,
    /// Outwards where the line enters, of any length; anything where it enters nowhere.
    pub normal: Vec3<R>,
}

/// How a line passes the axis of a tube.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chord<R: Real> {
    /// Where it goes along the axis.
    along: R::Mask,
    /// The square of its speed across it.
    speed: R,
    /// Where it is nearest [m].
    middle: R,
    /// Half of the chord across, squared [m²]; negative where it misses.
    pub rest: R,
}

#[inline(always)]
fn dot<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R {
    a.x * b.x + a.y * b.y + a.z * b.z
}

/// The part across the axis y.
#[inline(always)]
fn across<R: Real>(v: Vec3<R>) -> Vec3<R> {
    Vec3::new(v.x, R::zero(), v.z)
}
/// Its square.
#[inline(always)]
fn across_squared<R: Real>(v: Vec3<R>) -> R {
    v.x * v.x + v.z * v.z
}

/// Each component over that of another vector.
#[inline(always)]
fn over<R: Real>(v: Vec3<R>, a: Vec3<R>) -> Vec3<R> {
    Vec3::new(v.x / a.x, v.y / a.y, v.z / a.z)
}

/// What two vectors in the plane of x and y span.
#[inline(always)]
fn spanned<R: Real>(p: Vec3<R>, q: Vec3<R>) -> R {
    p.x * q.y - p.y * q.x
}

impl<R: Real> Span<R> {
    /// Where the mask holds, all of a line, else nothing of it.
    #[inline(always)]
    pub fn whole(mask: R::Mask, normal: Vec3<R>) -> Self {
        let end = R::lit(ENDLESS);
        Self {
            enter: R::select(mask, -end, end),
            leave: R::select(mask, end, -end),
            normal,
        }
    }
    /// Itself where the mask holds, else nothing.
    #[inline(always)]
    fn only(self, mask: R::Mask) -> Self {
        Self::select(mask, self, Self::whole(R::Mask::splat(false), self.normal))
    }
    /// What is in both.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        let later = self.enter.gt(other.enter);
        Self {
            enter: R::select(later, self.enter, other.enter),
            leave: self.leave.min(other.leave),
            normal: Vec3::select(later, self.normal, other.normal),
        }
    }
    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            enter: R::select(mask, yes.enter, no.enter),
            leave: R::select(mask, yes.leave, no.leave),
            normal: Vec3::select(mask, yes.normal, no.normal),
        }
    }
}

impl<R: Real> Line<R> {
    #[inline(always)]
    pub(super) fn at(&self, t: R) -> Vec3<R> {
        self.origin + self.direction * t
    }

    /// n · p ≤ h, |n| = 1: t = (h − n · o) / (n · d), an entry where n · d < 0.
    #[inline(always)]
    pub fn half_space(&self, n: Vec3<R>, h: R) -> Span<R> {
        let (gap, speed) = (h - dot(n, self.origin), dot(n, self.direction));
        let beside = Span::whole(gap.ge(R::zero()), n);
        let still = speed.abs().le(R::zero());
        let t = gap / R::select(still, R::one(), speed);
        let end = R::lit(ENDLESS);
        let crossing = Span {
            enter: R::select(speed.lt(R::zero()), t, -end),
            leave: R::select(speed.lt(R::zero()), end, t),
            normal: n,
        };
        Span::select(still, beside, crossing)
    }

    /// |p| ≤ h along one axis, given o and d along it: t = (∓h − o) / d.
    #[inline(always)]
    fn slab(o: R, d: R, h: R, axis: Vec3<R>) -> Span<R> {
        let still = d.abs().le(R::zero());
        let speed = R::select(still, R::one(), d);
        let reach = h.copysign(speed);
        let crossing = Span {
            enter: (-reach - o) / speed,
            leave: (reach - o) / speed,
            normal: axis * -R::one().copysign(d),
        };
        let beside = Span::whole(o.abs().le(h), axis);
        Span::select(still, beside, crossing)
    }
    /// |y| ≤ h.
    #[inline(always)]
    fn level(&self, h: R) -> Span<R> {
        let axis = Vec3::new(R::zero(), R::one(), R::zero());
        Self::slab(self.origin.y, self.direction.y, h, axis)
    }

    /// |pᵢ| ≤ hᵢ.
    #[inline(always)]
    pub fn cuboid(&self, half: Vec3<R>) -> Span<R> {
        let (o, d) = (self.origin, self.direction);
        let x = Vec3::new(R::one(), R::zero(), R::zero());
        let z = Vec3::new(R::zero(), R::zero(), R::one());
        Self::slab(o.x, d.x, half.x, x)
            .and(self.level(half.y))
            .and(Self::slab(o.z, d.z, half.z, z))
    }

    /// Σ (pᵢ/aᵢ)² ≤ 1: with u = o/a and w = d/a a unit ball, which the line is nearest to at t = −u·w / w², with
    /// half of the chord √((1 − foot²) / w²). Normal: the gradient pᵢ/aᵢ².
    #[inline(always)]
    pub fn ellipsoid(&self, a: Vec3<R>) -> Span<R> {
        let (u, w) = (over(self.origin, a), over(self.direction, a));
        let ww = dot(w, w);
        let middle = -(dot(u, w) / ww);
        let foot = u + w * middle;
        let rest = R::one() - dot(foot, foot);
        let half = (rest.max(R::zero()) / ww).sqrt();
        let enter = middle - half;
        let span = Span {
            enter,
            leave: middle + half,
            normal: over(over(self.at(enter), a), a),
        };
        span.only(rest.ge(R::zero()))
    }

    /// x² + z² ≤ r²: as a ball, in the plane across the axis.
    #[inline(always)]
    pub(super) fn tube(&self, r: R) -> Span<R> {
        let chord = self.chord(r);
        self.along(&chord).only(chord.rest.ge(R::zero()))
    }
    /// What a tube leaves of it.
    #[inline(always)]
    pub(super) fn chord(&self, r: R) -> Chord<R> {
        let (o, d) = (self.origin, self.direction);
        let dd = across_squared(d);
        let along = dd.lt(R::lit(ALONG));
        let speed = R::select(along, R::one(), dd);
        let middle = -((o.x * d.x + o.z * d.z) / speed);
        let rest = r * r - across_squared(o + d * middle);
        Chord {
            along,
            speed,
            middle,
            rest,
        }
    }
    /// The chord of a line that meets the tube.
    #[inline(always)]
    pub(super) fn along(&self, chord: &Chord<R>) -> Span<R> {
        let half = (chord.rest.max(R::zero()) / chord.speed).sqrt();
        let (end, enter) = (R::lit(ENDLESS), chord.middle - half);
        Span {
            enter: R::select(chord.along, -end, enter),
            leave: R::select(chord.along, end, chord.middle + half),
            normal: across(self.at(enter)),
        }
    }

    /// |p − c| ≤ r with c = (0, y, 0): about the foot o − c − ((o − c)·d) d, half of the chord is √(r² − foot²).
    #[inline(always)]
    pub fn ball(&self, y: R, r: R) -> Span<R> {
        let o = Vec3::new(self.origin.x, self.origin.y - y, self.origin.z);
        let middle = -dot(o, self.direction);
        let foot = o + self.direction * middle;
        let rest = r * r - dot(foot, foot);
        let half = rest.max(R::zero()).sqrt();
        let span = Span {
            enter: middle - half,
            leave: middle + half,
            normal: foot - self.direction * half,
        };
        span.only(rest.ge(R::zero()))
    }

    /// Within r of the segment |y| ≤ h: a tube, closed by balls. Where the line enters the tube between its
    /// ends, it enters the capsule; where beyond one, it enters there by that end's ball, or not at all, for
    /// where it comes to the end inside the tube, it is inside the ball. So it leaves. Normal: from the nearest
    /// point of the segment.
    #[inline(always)]
    pub fn capsule(&self, r: R, h: R) -> Span<R> {
        let tube = self.tube(r);
        self.closed(&tube, r, h).only(tube.enter.le(tube.leave))
    }
    /// The same, of a line that is in the tube.
    #[inline(always)]
    pub(super) fn closed(&self, tube: &Span<R>, r: R, h: R) -> Span<R> {
        let (first, last) = (self.at(tube.enter).y, self.at(tube.leave).y);
        let entry = Span::select(first.abs().le(h), *tube, self.ball(h.copysign(first), r));
        let exit = Span::select(last.abs().le(h), *tube, self.ball(h.copysign(last), r));
        Span {
            leave: exit.leave,
            ..entry
        }
    }

    /// A tube between two planes.
    #[inline(always)]
    pub fn cylinder(&self, r: R, h: R) -> Span<R> {
        self.tube(r).and(self.level(h))
    }

    /// x² + z² ≤ k² s², where s = h − y is the depth below the apex and k = r / 2h. That is
    /// a t² + 2 b t + c ≤ 0, true between the roots where a ≥ 0; where a < 0, the line goes from one
    /// half of the double cone to the other, and is in ours beyond the later root if it descends,
    /// else before the earlier. With p and v the parts of o and d across the axis and e = −d.y,
    /// b² − a c = k² |s v − e p|² − (p × v)², which keeps its digits near the apex. Normal: the
    /// gradient of √(x² + z²) + k y.
    #[inline(always)]
    pub fn cone(&self, r: R, h: R) -> Span<R> {
        let (o, d) = (self.origin, self.direction);
        let k = r / (h + h);
        let (s, e) = (h - o.y, -d.y);
        let a = across_squared(d) - (k * e) * (k * e);
        let b = o.x * d.x + o.z * d.z - k * k * s * e;
        let c = across_squared(o) - (k * s) * (k * s);
        let lever = o.x * d.z - o.z * d.x;
        let square = k * k * across_squared(d * s - o * e) - lever * lever;
        let roots = roots(a, b, c, square);
        let end = R::lit(ENDLESS);
        let (closed, descends) = (a.ge(R::zero()), e.gt(R::zero()));
        let below = R::select(descends, roots.leave, -end);
        let until = R::select(descends, end, roots.enter);
        let enter = R::select(closed, roots.enter, below);
        let p = self.at(enter);
        let normal = Vec3::new(p.x, k * across_squared(p).sqrt(), p.z);
        let apex = dot(normal, normal).le(R::zero());
        let up = Vec3::new(R::zero(), R::one(), R::zero());
        let side = Span {
            enter,
            leave: R::select(closed, roots.leave, until),
            normal: Vec3::select(apex, up, normal),
        };
        side.only(roots.enter.le(roots.leave)).and(self.level(h))
    }
}

/// Roots of a t² + 2 b t + c, the lower first, without cancellation: q/a and c/q, where
/// q = −(b ± √(b² − a c)) with the sign of b; `square` is b² − a c. One is far where a = 0.
#[inline(always)]
fn roots<R: Real>(a: R, b: R, c: R, square: R) -> Span<R> {
    let zero = R::zero();
    let q = -(b + square.max(zero).sqrt().copysign(b));
    let (flat, touching) = (a.abs().le(zero), q.abs().le(zero));
    let far = R::lit(ENDLESS).copysign(q);
    let x = R::select(flat, far, q / R::select(flat, R::one(), a));
    let y = c / R::select(touching, R::one(), q);
    let two = Span {
        enter: x.min(y),
        leave: x.max(y),
        normal: Vec3::zero(),
    };
    let one = Span {
        enter: zero,
        leave: zero,
        normal: Vec3::zero(),
    };
    let misses = R::select(a.ge(zero), square, R::one()).lt(zero);
    let real = Span::select(misses, Span::whole(R::Mask::splat(false), two.normal), two);
    Span::select(touching, one.only(c.le(zero)), real)
}

/// A line as triangles see it.
///
/// Woop, Benthin & Wald, Watertight Ray/Triangle Intersection (2013): axes x, y, z are named so that z
/// is the longest of the line's direction, and sheared so that the line is the z axis. The signed
/// areas of the corners' projections tell on which side of each edge it passes; two triangles compute
/// the same number for the edge they share, of opposite sign, so that no line passes between them (where a card does not
/// fuse the products):
///
/// ```text
/// S = (d.x / d.z, d.y / d.z, 1 / d.z)       p' = (p.x − S.x p.z, p.y − S.y p.z)
/// u = c' × b',  v = a' × c',  w = b' × a'   t = S.z (u a.z + v b.z + w c.z) / (u + v + w)
/// ```
///
/// for corners a, b, c relative to the line's origin. Lines in the triangle's plane do not cross it.
#[derive(Clone, Copy, Debug)]
pub struct Sheared<R: Real> {
    origin: Vec3<R>,
    /// Where x, or y, is the longest axis.
    longest: [R::Mask; 2],
    shear: Vec3<R>,
}

impl<R: Real> Sheared<R> {
    /// Of a line whose direction has unit length.
    #[inline(always)]
    pub fn new(line: &Line<R>) -> Self {
        let d = line.direction;
        let most = d.abs();
        let is_x = most.x.ge(most.y.max(most.z));
        let longest = [is_x, most.y.ge(most.x.max(most.z)) & !is_x];
        let d = named(longest, d);
        Self {
            origin: line.origin,
            longest,
            shear: Vec3::new(d.x / d.z, d.y / d.z, R::one() / d.z),
        }
    }

    /// A corner relative to the origin, with its axes named, and seen along the line.
    #[inline(always)]
    fn seen(&self, corner: Vec3<R>) -> Vec3<R> {
        let p = named(self.longest, corner - self.origin);
        Vec3::new(p.x - self.shear.x * p.z, p.y - self.shear.y * p.z, p.z)
    }

    /// The distance [m] along the line at which it crosses a triangle, from either side, and whether it does; edges
    /// count.
    #[inline(always)]
    pub fn crosses(&self, corners: [Vec3<R>; 3]) -> (R, R::Mask) {
        let [a, b, c] = corners;
        let (a, b, c) = (self.seen(a), self.seen(b), self.seen(c));
        let (u, v, w) = (spanned(c, b), spanned(a, c), spanned(b, a));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let area = u + v + w;
        let flat = area.abs().le(R::zero());
        let aside = least.lt(R::zero()) & most.gt(R::zero());
        let weighted = u * a.z + v * b.z + w * c.z;
        let distance = self.shear.z * weighted / R::select(flat, R::one(), area);
        (distance, !(aside | flat))
    }
}

/// The same vector with its axes called so that the longest is z.
#[inline(always)]
fn named<R: Real>([is_x, is_y]: [R::Mask; 2], v: Vec3<R>) -> Vec3<R> {
    let turned = Vec3::select(is_y, Vec3::new(v.z, v.x, v.y), v);
    Vec3::select(is_x, Vec3::new(v.y, v.z, v.x), turned)
}
