//! The nearest points of two convex solids that do not meet.
//!
//! Gilbert, Johnson & Keerthi, A fast procedure for computing the distance between complex objects
//! in three-dimensional space, IEEE J. Robotics and Automation 4 (1988). The distance of A and B is
//! that of the origin from the set C = B − A. With v the point nearest to the origin of a triangle
//! in C, and w the point of C farthest along −v, C lies beyond the plane through w at a right angle
//! to v, so the distance is at least v·w/|v|, and that is the gap along v. Where it falls short of
//! |v|, the triangle is replaced by the best one of w and two of its corners.
//!
//! C must not hold the origin; [`convex`](crate::convex) sees to that.

use crate::support::support;
use crate::{Solid, Tables};
use numbers::machine::{Held, Hold};
use numbers::{Cell, Float, Machine, Real, Vec3};

/// More rounds than smooth solids take to get to rounding.
const ROUNDS: usize = 40;

/// Two solids as seen from the centre of the first.
pub(crate) struct Cores<'a, M: Machine> {
    pub tables: Tables,
    pub a: &'a Solid<M>,
    pub b: &'a Solid<M>,
    /// From A's centre to B's.
    pub offset: Vec3<M::R>,
}

impl<M: Machine> Cores<'_, M> {
    /// The points of A and B that lie farthest towards each other along `n`, from A's centre.
    #[inline(always)]
    pub fn facing(&self, k: &M, n: Vec3<M::R>) -> [Vec3<M::R>; 2] {
        let a = support(k, self.tables, self.a, n);
        let b = support(k, self.tables, self.b, -n);
        [a, b + self.offset]
    }
    /// The gap between the cores along `n`.
    #[inline(always)]
    pub fn gap(&self, k: &M, n: Vec3<M::R>) -> M::R {
        let [a, b] = self.facing(k, n);
        n.dot(b - a)
    }
}

/// A corner of the triangle: a point of C, and the point of A it comes from.
#[derive(Clone, Copy)]
struct Corner<V> {
    w: V,
    a: V,
}

/// What is found: the way from A to B.
#[derive(Clone, Copy)]
pub(crate) struct Nearest<R> {
    /// The unit vector along which the gap is largest.
    pub n: Vec3<R>,
    /// The point of A nearest to B, from A's centre.
    pub a: Vec3<R>,
    /// The way from it to the point of B.
    pub way: Vec3<R>,
}

/// The nearest points of A's core and of B's core moved by `shift`, from A to B about along `start`.
///
/// Lanes in `idle` are not waited for.
#[inline(always)]
pub(crate) fn nearest<M: Machine>(
    k: &M,
    cores: &Cores<'_, M>,
    shift: Vec3<M::R>,
    start: Vec3<M::R>,
    idle: <M::R as Real>::Mask,
) -> Nearest<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let (tolerance, rounding) = if <M::R as Real>::Scalar::DOUBLE {
        (1e-13, 1.0 + 1e-15)
    } else {
        (1e-6, 1.0 + 5e-7)
    };
    let [a, b] = cores.facing(k, start);
    let first = b + shift - a;
    let mut triangle = Triangle::at(k, Corner { w: first, a });
    let mut v = first.hold(k);
    let mut on_a = a.hold(k);
    // The best of the lower bounds, and its direction.
    let mut most = k.cell(o);
    let mut n = start.hold(k);
    let mut done = k.cell(M::R::select(idle, i, o));
    for _ in k.count(ROUNDS) {
        let old = v.get();
        let [a, b] = cores.facing(k, old);
        let w = b + shift - a;
        let new = Corner { w, a };
        let going = done.read().lt(M::R::lit(0.5));
        let (squared, onto_v) = (old.length_squared(), old.dot(w));
        let length = squared.sqrt();
        let bound = onto_v / length.max(M::R::lit(1e-20));
        let better = bound.gt(most.read()) & going;
        n.set(Vec3::select(better, old * length.recip(), n.get()));
        most.write(M::R::select(better, bound, most.read()));

        let best = triangle.best_with(new);
        // A little farther is as near as rounding can tell: the direction may still improve.
        let nearer = best.v.length_squared().le(squared * M::R::lit(rounding));
        let near_enough = (squared - onto_v).le(M::R::lit(tolerance) * squared);
        let go_on = going & nearer & !near_enough & !triangle.has(w);
        triangle.set_where(go_on, new, &best);
        v.set(Vec3::select(go_on, best.v, old));
        on_a.set(Vec3::select(go_on, best.a, on_a.get()));
        done.write(M::R::select(go_on, o, i));
        if k.finished(!go_on) {
            break;
        }
    }
    Nearest {
        n: n.get(),
        a: on_a.get(),
        way: v.get(),
    }
}

/// The three corners from round to round.
struct Triangle<H>([Corner<H>; 3]);

/// A choice of two old corners besides the new one, and the nearest point of the three.
#[derive(Clone, Copy)]
struct Choice<R> {
    v: Vec3<R>,
    a: Vec3<R>,
    kept: [Corner<Vec3<R>>; 2],
}

impl<R: Real> Choice<R> {
    #[inline(always)]
    fn nearer(self, other: Self) -> Self {
        let this = self.v.length_squared().le(other.v.length_squared());
        let [p, q] = self.kept;
        let [r, s] = other.kept;
        Self {
            v: Vec3::select(this, self.v, other.v),
            a: Vec3::select(this, self.a, other.a),
            kept: [Corner::select(this, p, r), Corner::select(this, q, s)],
        }
    }
}

impl<R: Real, H: Held<Value = Vec3<R>>> Triangle<H> {
    #[inline(always)]
    fn at<M: Machine<R = R>>(k: &M, corner: Corner<Vec3<R>>) -> Self
    where
        Vec3<R>: Hold<M, Held = H>,
    {
        let [x, y, z] = [corner; 3];
        Self([x.hold(k), y.hold(k), z.hold(k)])
    }

    /// The nearest point of all the triangles and edges that `new` makes with the corners.
    ///
    /// Weights are never negative, so that each candidate is a point of C however they are
    /// rounded, and the nearest of them is safe to take.
    #[inline(always)]
    fn best_with(&self, new: Corner<Vec3<R>>) -> Choice<R> {
        let [x, y, z] = [self.0[0].get(), self.0[1].get(), self.0[2].get()];
        let edges = edge(new, x).nearer(edge(new, y)).nearer(edge(new, z));
        let faces = face(new, x, y)
            .nearer(face(new, y, z))
            .nearer(face(new, z, x));
        edges.nearer(faces)
    }

    /// Whether a point is one of the corners.
    #[inline(always)]
    fn has(&self, w: Vec3<R>) -> R::Mask {
        same(self.0[0].w.get(), w) | same(self.0[1].w.get(), w) | same(self.0[2].w.get(), w)
    }

    #[inline(always)]
    fn set_where(&mut self, mask: R::Mask, new: Corner<Vec3<R>>, choice: &Choice<R>) {
        for (i, to) in [new, choice.kept[0], choice.kept[1]]
            .into_iter()
            .enumerate()
        {
            let old = self.0[i].get();
            self.0[i].w.set(Vec3::select(mask, to.w, old.w));
            self.0[i].a.set(Vec3::select(mask, to.a, old.a));
        }
    }
}

impl<R: Real> Corner<Vec3<R>> {
    #[inline(always)]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            w: Vec3::select(mask, yes.w, no.w),
            a: Vec3::select(mask, yes.a, no.a),
        }
    }
    #[inline(always)]
    fn hold<M: Machine<R = R>>(self, k: &M) -> Corner<<Vec3<R> as Hold<M>>::Held>
    where
        Vec3<R>: Hold<M>,
    {
        Corner {
            w: self.w.hold(k),
            a: self.a.hold(k),
        }
    }
}

impl<R: Real, H: Held<Value = Vec3<R>>> Corner<H> {
    #[inline(always)]
    fn get(&self) -> Corner<Vec3<R>> {
        Corner {
            w: self.w.get(),
            a: self.a.get(),
        }
    }
}

/// The nearest point of the segment p q.
#[inline(always)]
fn edge<R: Real>(p: Corner<Vec3<R>>, q: Corner<Vec3<R>>) -> Choice<R> {
    let along = q.w - p.w;
    let length2 = along.length_squared().max(R::lit(1e-30));
    let t = (-p.w.dot(along) / length2).clamp(R::zero(), R::one());
    Choice {
        v: along.fma(t, p.w),
        a: (q.a - p.a).fma(t, p.a),
        kept: [q, q],
    }
}

/// The nearest point of the triangle p q r, where it is inside of it; else p.
///
/// With e = q − p, f = r − p and n = e × f, the foot p + y e + z f of the normal through the origin
/// has y = (f × p)·n/n² and z = (p × e)·n/n². (Products with p, not of two corners: these would
/// lose the digits of a small triangle.)
#[inline(always)]
fn face<R: Real>(p: Corner<Vec3<R>>, q: Corner<Vec3<R>>, r: Corner<Vec3<R>>) -> Choice<R> {
    let o = R::zero();
    let (e, f) = (q.w - p.w, r.w - p.w);
    let n = e.cross(f);
    let n2 = n.length_squared();
    let (y, z) = (f.cross(p.w).dot(n), p.w.cross(e).dot(n));
    let inside = y.ge(o) & z.ge(o) & (y + z).le(n2) & n2.gt(R::lit(1e-30));
    let share = R::select(inside, n2, R::one()).recip();
    let y = R::select(inside, y * share, o);
    let z = R::select(inside, z * share, o);
    Choice {
        v: e.fma(y, f.fma(z, p.w)),
        a: (q.a - p.a).fma(y, (r.a - p.a).fma(z, p.a)),
        kept: [q, r],
    }
}

#[inline(always)]
fn same<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R::Mask {
    a.x.same(b.x) & a.y.same(b.y) & a.z.same(b.z)
}
