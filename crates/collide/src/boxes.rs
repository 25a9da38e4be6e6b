//! Two boxes, by the separating axes that they can have.
//!
//! Two convex polyhedra are apart, or least deep in each other, along the normal of a face or at a
//! right angle to an edge of each: for boxes 3 + 3 + 9 axes (Gottschalk, Lin & Manocha, OBBTree: a
//! hierarchical structure for rapid interference detection, SIGGRAPH 1996, §5). Along L, boxes of
//! half extents h and axes a, b whose centres are d apart have the gap
//! ```text
//! g = |d·L| − Σ hᵢ |aᵢ·L| − Σ hⱼ |bⱼ·L|
//! ```
//! where they overlap the largest of them is exact. Boxes that are apart by more than [`APART`] have
//! it improved by their true distance, which may be between two corners.

use crate::convex::{Direction, ascend, size};
use crate::gjk::Cores;
use crate::overlap::{self, Witness};
use crate::{LEANING, Manifold, Placed, Solid, Tables};
use numbers::machine::{Held, Hold};
use numbers::{Cell, Machine, Mask, Real, Vec3};

/// Gap, against the sum of the sizes, from which corners are looked at.
const APART: f64 = 0.005;
/// By how much edges must beat faces, against the sum of the sizes: where both say the same, it
/// is the faces that touch.
const BIAS: f64 = 1e-5;
/// Squared sine of the angle within which two edges count as parallel.
const PARALLEL: f64 = 1e-6;

/// Contact of two boxes.
#[inline(always)]
pub fn box_box<M: Machine>(
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
    let found = separating_axis(&a.placed, &b.placed, M::R::lit(BIAS) * size(&cores));
    let found = Direction {
        on_a: cores.facing(k, found.n)[0],
        ..found
    };
    let mut n = found.n.hold(k);
    let mut gap = k.cell(found.gap);
    let mut on_a = found.on_a.hold(k);
    let apart = found.gap.gt(M::R::lit(APART) * size(&cores));
    if let Some(_branch) = k.if_any(apart) {
        let never = <M::R as Real>::Mask::splat(false);
        let better = ascend(k, &cores, found, M::R::lit(2.0), !apart, never);
        n.set(better.n);
        gap.write(better.gap);
        on_a.set(better.on_a);
    }
    let witness = Witness {
        normal: n.get(),
        on_a: on_a.get(),
        gap: gap.read(),
        radii: [M::R::zero(); 2],
        stands: <M::R as Real>::Mask::splat(true),
        leaning: LEANING,
    };
    overlap::manifold(k, &cores, &witness)
}

/// The axis of the largest gap, from A to B.
#[inline(always)]
fn separating_axis<R: Real>(a: &Placed<R>, b: &Placed<R>, bias: R) -> Direction<R> {
    let d = b.position - a.position;
    let (p, q) = (a.axes, b.axes);
    let (ha, hb) = (a.size.to_array(), b.size.to_array());
    let (ps, qs) = ([p.x, p.y, p.z], [q.x, q.y, q.z]);
    // |aᵢ·bⱼ|
    let mut c = [[R::zero(); 3]; 3];
    for i in 0..3 {
        for j in 0..3 {
            c[i][j] = ps[i].dot(qs[j]).abs();
        }
    }
    let mut best = Axis {
        l: ps[0],
        gap: R::lit(-crate::FAR),
    };
    for i in 0..3 {
        let reach = hb[0].fma(c[i][0], hb[1].fma(c[i][1], hb[2] * c[i][2]));
        best = best.or(ps[i], ps[i].dot(d).abs() - ha[i] - reach);
        let reach = ha[0].fma(c[0][i], ha[1].fma(c[1][i], ha[2] * c[2][i]));
        best = best.or(qs[i], qs[i].dot(d).abs() - hb[i] - reach);
    }
    let faces = best;
    for i in 0..3 {
        let (i1, i2) = ((i + 1) % 3, (i + 2) % 3);
        for j in 0..3 {
            let (j1, j2) = ((j + 1) % 3, (j + 2) % 3);
            let l = ps[i].cross(qs[j]);
            let sine2 = l.length_squared();
            let parallel = sine2.lt(R::lit(PARALLEL));
            let scale = sine2.max(R::lit(PARALLEL)).sqrt().recip();
            // |aₖ·L| = |aᵢ × aₖ · bⱼ|, a cosine of the third axis; and so for b.
            let reach_a = ha[i1].fma(c[i2][j], ha[i2] * c[i1][j]);
            let reach_b = hb[j1].fma(c[i][j2], hb[j2] * c[i][j1]);
            let gap = (l.dot(d).abs() - reach_a - reach_b) * scale;
            best = best.or(l * scale, R::select(parallel, R::lit(-crate::FAR), gap));
        }
    }
    let edges_win = best.gap.gt(faces.gap + bias);
    let l = Vec3::select(edges_win, best.l, faces.l);
    Direction {
        n: Vec3::select(l.dot(d).lt(R::zero()), -l, l),
        gap: R::select(edges_win, best.gap, faces.gap),
        on_a: Vec3::zero(),
    }
}

#[derive(Clone, Copy)]
struct Axis<R> {
    l: Vec3<R>,
    gap: R,
}

impl<R: Real> Axis<R> {
    #[inline(always)]
    fn or(self, l: Vec3<R>, gap: R) -> Self {
        let more = gap.gt(self.gap);
        Self {
            l: Vec3::select(more, l, self.l),
            gap: R::select(more, gap, self.gap),
        }
    }
}
