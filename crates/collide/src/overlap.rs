//! The points of contact of two solids whose normal is known.
//!
//! What faces the other solid is on each side a face, an edge or a corner, outlined by eight points
//! ([`outline`](crate::outline)). Seen along the normal, the solids touch where the two outlines
//! overlap: a convex polygon, whose corners are the crossings of their sides and the corners of each
//! within the other. The gap between the two faces is linear over it. Four of its corners are
//! kept, so that they span what it spans.
//!
//! Outlines without area have nothing to clip against; so each is taken a little larger than it is,
//! by a distance that rounding cannot make up.

use crate::gjk::Cores;
use crate::outline::{Height, View, outline, tangents};
use crate::tables::CORNERS;
use crate::{FAR, FLAT, Manifold, Point, Tables};
use numbers::machine::Index;
use numbers::{Cell, Machine, Mat3, Real, Vec3};

/// By how much an outline is widened, against the size of the smaller and of the larger solid.
const WIDENED: (f64, f64) = (2e-4, 2e-6);
/// Points closer than this many widenings are one.
const MERGED: f64 = 4.0;
/// A gap that is larger by this many mergings than that of the witness, [`FLAT`] of the smaller solid, is not the least.
const MISSED: f64 = FLAT / (WIDENED.0 * MERGED);
/// What a length counts for against a gap in the choice of the first point: enough to keep the
/// choice where gaps are even, too little to miss the deepest where they are not.
const KEPT: f64 = 1e-3;

/// What is known of a contact before its points are.
pub(crate) struct Witness<R: Real> {
    /// Unit vector from A to B.
    pub normal: Vec3<R>,
    /// A point of A's core close to B's, from A's centre [m].
    pub on_a: Vec3<R>,
    /// The gap between the cores along the normal [m].
    pub gap: R,
    /// What surrounds the cores of A and B [m].
    pub radii: [R; 2],
    /// Whether the solids touch where the point is, even if nothing overlaps along the normal.
    pub stands: R::Mask,
    /// By what angle faces and edges may lean and still touch whole [rad].
    pub leaning: f64,
}

/// The manifold of two solids along the normal of the witness.
#[inline(always)]
pub(crate) fn manifold<M: Machine>(
    k: &mut M,
    cores: &Cores<'_, M>,
    witness: &Witness<M::R>,
) -> Manifold<M::R> {
    let (tables, a, b) = (cores.tables, cores.a, cores.b);
    let n = witness.normal;
    let [u, _] = tangents(a.placed.local_direction(n));
    let u = a.placed.direction(u);
    let frame = Mat3::from_columns(u, n.cross(u), n);
    let from_a = View {
        out: n,
        center: Vec3::zero(),
        frame,
        leaning: witness.leaning,
    };
    let from_b = View {
        out: -n,
        center: cores.offset,
        ..from_a
    };
    let (row_a, row_b) = (k.index(0), k.index(9));
    let faces = [
        outline(k, tables, a, &from_a, row_a),
        outline(k, tables, b, &from_b, row_b),
    ];
    let (size_a, size_b) = (a.placed.size.length(), b.placed.size.length());
    let (small, large) = (size_a.min(size_b), size_a.max(size_b));
    let wide = M::R::lit(WIDENED.0).fma(small, M::R::lit(WIDENED.1) * large);
    sides(k, tables, wide);
    clip(k, tables, &faces);
    let fallback = Candidate {
        x: frame.x.dot(witness.on_a),
        y: frame.y.dot(witness.on_a),
        gap: M::R::select(witness.stands, witness.gap, M::R::lit(FAR)),
        feature: M::R::zero(),
    };
    let (found, chosen) = choose(k, tables, wide * M::R::lit(MERGED), fallback);
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let Candidate { x, y, gap, feature } = chosen[i];
        let [radius_a, radius_b] = witness.radii;
        // The fallback may lie beyond the face.
        let z = match i {
            0 => M::R::select(found, faces[0].at(x, y), frame.z.dot(witness.on_a)),
            _ => faces[0].at(x, y),
        };
        let z = z + radius_a;
        // Planes fitted to outlines that are flat within `FLAT` may come nearer than the solids do.
        let distance = gap.max(witness.gap) - radius_a - radius_b;
        let on_a = frame * Vec3::new(x, y, z) + a.placed.position;
        let point = Point::from_a(on_a, n, distance, feature);
        points[i] = point.only_if(chosen[i].exists());
    }
    Manifold { normal: n, points }
}

/// The sides of both outlines, widened; inside is to the left on A's, to the right on B's.
#[inline(always)]
fn sides<M: Machine>(k: &mut M, tables: Tables, wide: M::R) {
    for (from, to, left) in [(0, 0, 1.0), (9, 8, -1.0)] {
        for j in k.count(8) {
            let p = widened(k, tables, j.offset(from), wide);
            let q = widened(k, tables, j.offset(from + 1), wide);
            let left = M::R::lit(left);
            let (a, b) = ((p[1] - q[1]) * left, (q[0] - p[0]) * left);
            let c = -(a * p[0] + b * p[1]);
            k.write(tables.sides, j.offset(to), 0, [a, b, c]);
        }
    }
}

#[inline(always)]
fn widened<M: Machine>(k: &M, tables: Tables, row: M::I, wide: M::R) -> [M::R; 2] {
    let [x, y, _, out_x, out_y] = k.read(tables.corners, row, 0);
    [out_x.fma(wide, x), out_y.fma(wide, y)]
}

/// How far a point is inside of a side, in units of the side's length.
#[inline(always)]
fn inside<M: Machine>(k: &M, tables: Tables, side: M::I, [x, y]: [M::R; 2]) -> M::R {
    let [a, b, c] = k.read(tables.sides, side, 0);
    a.fma(x, b.fma(y, c))
}

/// Writes the candidates: both ends of each of A's sides within B, and B's corners within A.
#[inline(always)]
fn clip<M: Machine>(k: &mut M, tables: Tables, faces: &[Height<M::R>; 2]) {
    let (o, i) = (M::R::zero(), M::R::one());
    for row in k.count(8) {
        let p: [M::R; CORNERS] = k.read(tables.corners, row, 0);
        let q: [M::R; 2] = k.read(tables.corners, row.offset(1), 0);
        let (p_feature, p) = (p[5], [p[0], p[1]]);
        // Cyrus & Beck (1978): the side p + t (q − p) is within B from `enters` to `leaves`.
        let (mut enters, mut leaves) = (k.cell(o), k.cell(i));
        let (mut in_by, mut out_by) = (k.cell(p_feature), k.cell(-i));
        for side in k.count(8) {
            let (at_p, at_q) = (
                inside(k, tables, side.offset(8), p),
                inside(k, tables, side.offset(8), q),
            );
            let crossed =
                M::R::lit(256.0).fma(p_feature, k.load(tables.corners, side.offset(9), 5));
            let crossed = crossed + M::R::lit(512.0);
            let (p_out, q_out) = (at_p.lt(o), at_q.lt(o));
            let t = at_p / M::R::select(p_out | q_out, at_p - at_q, i);
            // Out at both ends: never within.
            let t = M::R::select(p_out & q_out, M::R::lit(2.0), t);
            let later = p_out & t.gt(enters.read());
            let sooner = q_out & !p_out & t.lt(leaves.read());
            enters.write(M::R::select(later, t, enters.read()));
            in_by.write(M::R::select(later, crossed, in_by.read()));
            leaves.write(M::R::select(sooner, t, leaves.read()));
            out_by.write(M::R::select(sooner, crossed, out_by.read()));
        }
        let (t0, t1) = (enters.read(), leaves.read());
        let within = t0.le(t1);
        let (dx, dy) = (q[0] - p[0], q[1] - p[1]);
        let start = [dx.fma(t0, p[0]), dy.fma(t0, p[1])];
        let end = [dx.fma(t1, p[0]), dy.fma(t1, p[1])];
        offer(k, tables, row, faces, start, in_by.read(), within);
        let left = within & t1.lt(i);
        offer(k, tables, row.offset(8), faces, end, out_by.read(), left);
    }
    for row in k.count(8) {
        let x = k.read(tables.corners, row.offset(9), 0);
        let feature = k.load(tables.corners, row.offset(9), 5) + M::R::lit(256.0);
        let mut least = k.cell(o);
        for side in k.count(8) {
            least.write(least.read().min(inside(k, tables, side, x)));
        }
        let within = least.read().ge(o);
        offer(k, tables, row.offset(16), faces, x, feature, within);
    }
}

/// Writes one candidate, infinitely far where it is none.
#[inline(always)]
fn offer<M: Machine>(
    k: &mut M,
    tables: Tables,
    row: M::I,
    faces: &[Height<M::R>; 2],
    [x, y]: [M::R; 2],
    feature: M::R,
    valid: <M::R as Real>::Mask,
) {
    let gap = faces[1].at(x, y) - faces[0].at(x, y);
    let gap = M::R::select(valid, gap, M::R::lit(FAR));
    k.write(tables.candidates, row, 0, [x, y, gap, feature]);
}

#[derive(Clone, Copy)]
struct Candidate<R> {
    x: R,
    y: R,
    gap: R,
    feature: R,
}

impl<R: Real> Candidate<R> {
    #[inline(always)]
    fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            x: R::select(mask, yes.x, no.x),
            y: R::select(mask, yes.y, no.y),
            gap: R::select(mask, yes.gap, no.gap),
            feature: R::select(mask, yes.feature, no.feature),
        }
    }
    #[inline(always)]
    fn exists(&self) -> R::Mask {
        self.gap.lt(R::lit(0.5 * FAR))
    }
}

/// A candidate and its score, from round to round.
struct Best<C> {
    x: C,
    y: C,
    gap: C,
    feature: C,
    score: C,
}

impl<C: Cell> Best<C> {
    /// Nothing better than `score` yet.
    #[inline(always)]
    fn above<M: Machine<Cell = C, R = C::R>>(k: &M, score: C::R) -> Self {
        let zero = C::R::zero();
        Self {
            x: k.cell(zero),
            y: k.cell(zero),
            gap: k.cell(C::R::lit(FAR)),
            feature: k.cell(zero),
            score: k.cell(score),
        }
    }
    #[inline(always)]
    fn consider(&mut self, candidate: Candidate<C::R>, score: C::R) {
        let better = score.gt(self.score.read());
        let best = Candidate::select(better, candidate, self.get());
        self.x.write(best.x);
        self.y.write(best.y);
        self.gap.write(best.gap);
        self.feature.write(best.feature);
        self.score
            .write(C::R::select(better, score, self.score.read()));
    }
    #[inline(always)]
    fn get(&self) -> Candidate<C::R> {
        Candidate {
            x: self.x.read(),
            y: self.y.read(),
            gap: self.gap.read(),
            feature: self.feature.read(),
        }
    }
}

#[inline(always)]
fn candidate<M: Machine>(k: &M, tables: Tables, row: M::I) -> Candidate<M::R> {
    let [x, y, gap, feature] = k.read(tables.candidates, row, 0);
    Candidate { x, y, gap, feature }
}

/// Up to four of the candidates: the deepest, the one farthest from it, and on both sides of the
/// line through these the ones farthest from the line. In place of the first the fallback where there is none, or where it
/// is not the deepest: the mask tells where it is of the overlap.
#[inline(always)]
fn choose<M: Machine>(
    k: &M,
    tables: Tables,
    merged: M::R,
    fallback: Candidate<M::R>,
) -> (<M::R as Real>::Mask, [Candidate<M::R>; 4]) {
    let none = M::R::lit(-0.5 * FAR);
    let mut first = Best::above(k, none);
    for row in k.count(24) {
        let c = candidate(k, tables, row);
        let along = c.x.fma(M::R::lit(0.8), c.y * M::R::lit(0.6));
        let score = along.fma(M::R::lit(KEPT), -c.gap);
        first.consider(c, score);
    }
    let first = first.get();
    // Apart, the two are nearest to each other where outlines may miss each other.
    let missed = first.gap.gt(fallback.gap + merged * M::R::lit(MISSED)) & fallback.exists();
    let found = first.exists() & !missed;
    let first = Candidate::select(found, first, fallback);

    let mut second = Best::above(k, merged.squared());
    for row in k.count(24) {
        let c = candidate(k, tables, row);
        let (dx, dy) = (c.x - first.x, c.y - first.y);
        let away2 = dx.fma(dx, dy * dy);
        let exists = c.exists();
        second.consider(c, M::R::select(exists, away2, none));
    }
    let second = second.get();

    let (ux, uy) = (second.x - first.x, second.y - first.y);
    let least = merged * ux.fma(ux, uy * uy).sqrt();
    let mut left = Best::above(k, least);
    let mut right = Best::above(k, least);
    let is_line = second.exists();
    for row in k.count(24) {
        let c = candidate(k, tables, row);
        let (dx, dy) = (c.x - first.x, c.y - first.y);
        let area = ux.fma(dy, -(uy * dx));
        let exists = is_line & c.exists();
        left.consider(c, M::R::select(exists, area, none));
        right.consider(c, M::R::select(exists, -area, none));
    }
    (found, [first, second, left.get(), right.get()])
}
