//! Any two convex solids, apart or overlapping, by distances alone.
//!
//! For a unit vector n, the gap g(n) between two solids is what lies between two planes at a right
//! angle to n, one touching A from beyond and one touching B from before. Solids are apart by
//! max g; and where that is negative, −max g is the least way that one must be moved to free them.
//!
//! Nearest points say nothing about solids that overlap. So B is first moved away along the best n
//! known, by T = ε − g(n), to where the two are ε apart along n. With δ ≥ ε their true distance there,
//! along n′, the gap of the solids back in place is g(n′) = δ − T n·n′ ≥ ε − T = g(n): going on
//! from n′, the gap never falls, and it stays where n is normal to both surfaces. Close to a touch
//! the error shrinks by (ε − g)/(R + ε) a round, R being the radius of curvature. Distances are
//! never taken below ε, so that they keep their digits in single precision.
//!
//! While solids overlap little, this finds the largest gap. Where they overlap deeply there are
//! several maxima; then the search starts from several directions, and the best is kept. Where it is
//! known in which direction the two touched a step ago, it starts there, and only there: they were
//! followed from when they met.

use crate::gjk::{self, Cores};
use crate::overlap::{self, Witness};
use crate::support::radius;
use crate::{FAR, LEANING, Manifold, Point, Solid, Tables};
use numbers::machine::{Held, Hold};
use numbers::{Cell, Float, Known, LanesMask, Machine, Mask, Real, Vec3};

/// Rounds of moving apart and looking again.
const ROUNDS: usize = 12;
/// Rounds of a short search.
const SHORT: f64 = 3.0;
/// How far apart solids are held, against the sum of their sizes.
const APART: f64 = 0.02;
/// Depth, against the sum of the sizes, from which the search starts over from other directions.
pub(crate) const DEEP: f64 = 0.005;
/// How many directions those are.
const STARTS: usize = 16;
/// Cosine and sine of the golden angle, π (3 − √5).
const GOLDEN: (f64, f64) = (-0.737_368_878_078_319_7, 0.675_490_294_261_524);

/// Contact of two convex solids of any kinds.
#[inline(always)]
pub fn convex_convex<M: Machine>(
    k: &mut M,
    tables: Tables,
    a: &Solid<M>,
    b: &Solid<M>,
) -> Manifold<M::R> {
    let offset = b.placed.position - a.placed.position;
    let cores = Cores {
        tables,
        a,
        b,
        offset,
    };
    let Direction { n, gap, on_a } = search(k, &cores);
    let witness = Witness {
        normal: n,
        on_a,
        gap,
        radii: [radius(k, a), radius(k, b)],
        stands: <M::R as Real>::Mask::splat(true),
        leaning: LEANING,
    };
    overlap::manifold(k, &cores, &witness)
}

/// Contact of a sphere and a convex solid of any kind: one point.
#[inline(always)]
pub fn sphere_convex<M: Machine>(
    k: &M,
    tables: Tables,
    sphere: &Solid<M>,
    b: &Solid<M>,
) -> Manifold<M::R> {
    let center = sphere.placed.position;
    let cores = Cores {
        tables,
        a: sphere,
        b,
        offset: b.placed.position - center,
    };
    let Direction { n, gap, .. } = search(k, &cores);
    let radius = sphere.placed.size.x;
    let point = Point::from_a(n.fma(radius, center), n, gap - radius, M::R::zero());
    Manifold::single(n, point)
}

/// A direction from A to B.
#[derive(Clone, Copy)]
pub(crate) struct Direction<R> {
    /// Unit vector.
    pub n: Vec3<R>,
    /// The gap along it.
    pub gap: R,
    /// A's point nearest to B, from A's centre.
    pub on_a: Vec3<R>,
}

/// The direction of the largest gap.
///
/// The first search starts from the best axis. Lanes that it leaves deep, and whose direction was not
/// known, then make a short search from each of many directions, and a last one from the best of what
/// they found.
#[inline(always)]
fn search<M: Machine>(k: &M, cores: &Cores<'_, M>) -> Direction<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let axis = best_axis(k, cores);
    let is_new = match known(k, cores.tables) {
        Some(direction) => !is_some(direction),
        None => <M::R as Real>::Mask::splat(true),
    };
    let mut n = axis.n.hold(k);
    let mut gap = k.cell(axis.gap);
    let mut on_a = Vec3::zero().hold(k);
    let mut number = k.cell(o);
    let mut around = Around::new(k);
    let mut deep = k.cell(i);
    let never = <M::R as Real>::Mask::splat(false);
    for _ in k.count(STARTS + 2) {
        let (count, starts) = (number.read(), M::R::lit(STARTS as f64));
        let from_best = count.lt(M::R::lit(0.5)) | count.gt(starts);
        let d = around.next();
        let d = Vec3::select(d.dot(cores.offset).lt(o), -d, d);
        let d = Vec3::select(from_best, n.get(), d);
        let start = Direction {
            n: d,
            gap: cores.gap(k, d),
            on_a: on_a.get(),
        };
        let patience = M::R::select(from_best, M::R::lit(ROUNDS as f64), M::R::lit(SHORT));
        let idle = deep.read().lt(M::R::lit(0.5));
        let found = ascend(k, cores, start, patience, idle, never);
        let better = !idle & found.gap.ge(gap.read());
        n.set(Vec3::select(better, found.n, n.get()));
        gap.write(M::R::select(better, found.gap, gap.read()));
        on_a.set(Vec3::select(better, found.on_a, on_a.get()));
        number.write(count + i);
        let is_deep = is_new & !idle & gap.read().lt(M::R::lit(-DEEP) * size(cores));
        deep.write(M::R::select(is_deep, i, o));
        if k.finished(!is_deep) {
            break;
        }
    }
    Direction {
        n: n.get(),
        gap: gap.read(),
        on_a: on_a.get(),
    }
}

/// By how much of the way between two points the gap along it may fall short, for them to be the nearest.
const SHORTFALL: f64 = 1e-10;
/// How often nearest points are looked for, each time from where the last search got to: rims come near to each other
/// slowly.
const ATTEMPTS: usize = 4;

/// A direction from A to B, and a point of B.
#[derive(Clone, Copy)]
pub(crate) struct Way<R> {
    /// Unit vector.
    pub n: Vec3<R>,
    /// The gap along it.
    pub gap: R,
    /// B's point nearest to A, or deepest in it, from A's centre.
    pub on_b: Vec3<R>,
}

/// The direction of the largest gap, of one pair: where the two are apart, that between their nearest points, which are
/// found where they are; else as [`search`] finds it, with the nearest points of the two moved apart along it.
///
/// The way between nearest points is known to rounding, its direction to rounding over its length. Along that, faces
/// that are parallel have a gap that is too small by as much, times their extent: so the way's length is what counts.
#[inline(always)]
pub(crate) fn nearest_or_deepest<M: Machine<R: Known>>(k: &M, cores: &Cores<'_, M>) -> Way<M::R> {
    let never = <M::R as Real>::Mask::splat(false);
    let mut start = best_axis(k, cores).n;
    let mut apart = Way {
        n: start,
        gap: M::R::lit(-FAR),
        on_b: Vec3::zero(),
    };
    for _ in 0..ATTEMPTS {
        let found = gjk::nearest(k, cores, Vec3::zero(), start, never);
        let (gap, length) = (cores.gap(k, found.n), found.way.length());
        if gap.gt(apart.gap).all() {
            apart = Way {
                n: found.n,
                gap,
                on_b: found.a + found.way,
            };
        }
        if gap.gt(length * M::R::lit(1.0 - SHORTFALL)).all() {
            let gap = length;
            return Way { gap, ..apart };
        }
        start = found.way.normalized_or(found.n);
    }
    let Direction { n, gap, .. } = search(k, cores);
    if gap.lt(apart.gap).all() {
        return apart;
    }
    let shift = n * (M::R::lit(APART) * size(cores) - gap);
    let moved = gjk::nearest(k, cores, shift, n, never);
    let on_b = moved.a + moved.way - shift;
    Way { n, gap, on_b }
}

/// Directions evenly spread over a sphere: steps of the golden angle around an axis, in slices of
/// equal height.
struct Around<C> {
    cosine: C,
    sine: C,
    height: C,
}

impl<C: Cell> Around<C> {
    #[inline(always)]
    fn new<M: Machine<Cell = C, R = C::R>>(k: &M) -> Self {
        Self {
            cosine: k.cell(C::R::one()),
            sine: k.cell(C::R::zero()),
            height: k.cell(C::R::lit(1.0 + 1.0 / STARTS as f64)),
        }
    }
    #[inline(always)]
    fn next(&mut self) -> Vec3<C::R> {
        let (c, s) = (self.cosine.read(), self.sine.read());
        let (turn_c, turn_s) = (C::R::lit(GOLDEN.0), C::R::lit(GOLDEN.1));
        let (c, s) = (c.fma(turn_c, -(s * turn_s)), c.fma(turn_s, s * turn_c));
        let z = self.height.read();
        self.cosine.write(c);
        self.sine.write(s);
        self.height.write(z - C::R::lit(2.0 / STARTS as f64));
        let radius = z.fnma(z, C::R::one()).max(C::R::zero()).sqrt();
        Vec3::new(radius * c, radius * s, z)
    }
}

/// The direction of the largest gap near `start`, after at most `patience` rounds. Lanes in `idle`
/// are not waited for. Those in `unsure` may be apart though `start` goes deep: they first look for the
/// nearest points where the two are.
#[inline(always)]
pub(crate) fn ascend<M: Machine>(
    k: &M,
    cores: &Cores<'_, M>,
    start: Direction<M::R>,
    patience: M::R,
    idle: <M::R as Real>::Mask,
    unsure: <M::R as Real>::Mask,
) -> Direction<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let tolerance = if <M::R as Real>::Scalar::DOUBLE {
        1e-12
    } else {
        2e-7
    };
    let tolerance = M::R::lit(tolerance) * size(cores);
    let apart = M::R::lit(APART) * size(cores);
    let mut n = start.n.hold(k);
    let mut gap = k.cell(start.gap);
    let mut on_a = start.on_a.hold(k);
    let mut done = k.cell(M::R::select(idle, i, o));
    let mut left = k.cell(patience - M::R::lit(0.5));
    let mut unmoved = k.cell(M::R::select(unsure, i, o));
    for _ in k.count(ROUNDS) {
        left.write(left.read() - i);
        let idle = done.read().gt(M::R::lit(0.5));
        let looks = unmoved.read().gt(M::R::lit(0.5));
        let move_by = M::R::select(looks, o, (apart - gap.read()).max(o));
        let found = gjk::nearest(k, cores, n.get() * move_by, n.get(), idle);
        let next_gap = cores.gap(k, found.n);
        let overlap = looks & next_gap.le(o);
        let better = next_gap.gt(gap.read()) & !idle & !overlap;
        let is_best = move_by.le(o) | (next_gap - gap.read()).le(tolerance);
        let settled = idle | left.read().lt(o) | (is_best & !overlap);
        unmoved.write(o);
        on_a.set(Vec3::select(idle, on_a.get(), found.a));
        n.set(Vec3::select(better, found.n, n.get()));
        gap.write(M::R::select(better, next_gap, gap.read()));
        done.write(M::R::select(settled, i, o));
        if k.finished(settled) {
            break;
        }
    }
    Direction {
        n: n.get(),
        gap: gap.read(),
        on_a: on_a.get(),
    }
}

/// A length [m] that two solids are apart at least, or minus one that frees them where they overlap: the
/// largest gap along the direction known, or the line of centres, and the solids' axes.
#[inline(always)]
pub fn apart<M: Machine>(k: &M, tables: Tables, a: &Solid<M>, b: &Solid<M>) -> M::R {
    let cores = Cores {
        tables,
        a,
        b,
        offset: b.placed.position - a.placed.position,
    };
    best_axis(k, &cores).gap - radius(k, a) - radius(k, b)
}

/// The direction in which the two touched last; zero where that is not known.
#[inline(always)]
fn known<M: Machine>(k: &M, tables: Tables) -> Option<Vec3<M::R>> {
    Some(k.vec3(tables.known?, k.index(0), 0))
}

/// Where there is a direction.
#[inline(always)]
fn is_some<R: Real>(direction: Vec3<R>) -> R::Mask {
    direction.length_squared().gt(R::lit(0.5))
}

/// Of the direction known, or the line of centres, and the solids' axes, the one with the largest gap.
#[inline(always)]
fn best_axis<M: Machine>(k: &M, cores: &Cores<'_, M>) -> Direction<M::R> {
    let towards = cores.offset;
    let (p, q) = (cores.a.placed.axes, cores.b.placed.axes);
    let center = towards.normalized_or(p.y);
    let first = match known(k, cores.tables) {
        Some(direction) => Vec3::select(is_some(direction), direction, center),
        None => center,
    };
    let mut n = first.hold(k);
    let mut gap = k.cell(M::R::lit(-FAR));
    // Those still to be tried, the next one first: a loop is compiled once, and seven gaps are not.
    let mut next = [
        first.hold(k),
        forward(p.x, towards).hold(k),
        forward(p.y, towards).hold(k),
        forward(p.z, towards).hold(k),
        forward(q.x, towards).hold(k),
        forward(q.y, towards).hold(k),
        forward(q.z, towards).hold(k),
    ];
    for _ in k.count(next.len()) {
        let axis = next[0].get();
        for i in 1..next.len() {
            let later = next[i].get();
            next[i - 1].set(later);
        }
        let here = cores.gap(k, axis);
        let more = here.gt(gap.read());
        n.set(Vec3::select(more, axis, n.get()));
        gap.write(M::R::select(more, here, gap.read()));
    }
    Direction {
        n: n.get(),
        gap: gap.read(),
        on_a: Vec3::zero(),
    }
}

/// An axis from A to B.
#[inline(always)]
fn forward<R: Real>(axis: Vec3<R>, towards: Vec3<R>) -> Vec3<R> {
    Vec3::select(axis.dot(towards).lt(R::zero()), -axis, axis)
}

/// The sum of the sizes [m].
#[inline(always)]
pub(crate) fn size<M: Machine>(cores: &Cores<'_, M>) -> M::R {
    cores.a.placed.size.length() + cores.b.placed.size.length()
}
