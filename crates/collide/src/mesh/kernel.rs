//! A convex solid, or another mesh, against the triangles of a mesh.
//!
//! Each near triangle is a convex solid of three vertices, met from the side of its normal N. The
//! search for the normal starts at N; what it finds is then kept within the Voronoi regions of the
//! triangle's edges ([`adjacency`](super::adjacency)), and a triangle that the solid does not lie
//! over along that normal leaves the contact to its neighbours.
//!
//! Another mesh is met piece by piece: each of its triangles is a tetrahedron with a point of the
//! [`matter`](super::matter) behind it, which tells from which side it comes and how deep it may lie. A
//! normal that is not in the Voronoi region of that triangle, too, is left to its neighbours, so that
//! inner faces are never felt.
//!
//! Of all points those are kept that lie farthest in the eight corners of the first one's own frame,
//! which span what it rests on, and stay the same while it rests; and the deepest.

use super::tables::{BEHIND, BOUNDS, CORNERS, MeshTables, NUMBER, SLOTS, TRIANGLE, contact};
use crate::convex::{DEEP, Direction, ascend};
use crate::gjk::Cores;
use crate::overlap::{self, Witness};
use crate::solid::kind;
use crate::support::{radius, support};
use crate::{FAR, Manifold, Placed, Solid, Tables};
use numbers::machine::Index;
use numbers::{Cell, Machine, Mask, Mat3, Real, Vec3};

/// A mesh, placed in the world.
#[derive(Debug)]
pub struct Surface<M: Machine> {
    /// Where it is.
    pub placed: Placed<M::R>,
    /// The range of its groups, as [`MeshData::add`](super::MeshData::add) gave it.
    pub groups: [M::I; 2],
}

impl<M: Machine> Surface<M> {
    /// That of a shape of the kind [`MESH`](kind::MESH).
    #[inline(always)]
    pub fn of(mesh: &Solid<M>) -> Self {
        Self {
            placed: mesh.placed,
            groups: mesh.rows,
        }
    }
}

/// How deep a point counts against how far out it lies.
const DEPTH: f64 = 4.0;
/// What the number of a triangle counts for, against the size: so that rounding does not choose between two that
/// share a corner, and the same is taken in each step.
const PREFERRED: f64 = 1e-4;
/// A point is on an edge that is closer than this, against the sizes.
const ON_EDGE: f64 = 1e-3;
/// How far a normal may be turned by the edges before the triangle needs the solid right over it.
const TURNED: f64 = 1e-3;
/// Contacts closer than this, against the solid's size, with one normal, are one.
const MERGED: f64 = 1e-3;
/// How many triangles can be told apart, with 64 features each, in single precision.
const NUMBERS: f64 = 262_144.0;
/// The golden ratio less 1: its multiples lie as far apart as can be.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// Contacts of a convex solid (A) and a mesh (B) nearer than `margin` [m], written to
/// [`MeshTables::contacts`]; rows not used are [`FAR`] apart.
#[inline(always)]
pub fn mesh_convex<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    solid: &Solid<M>,
    mesh: &Surface<M>,
    margin: M::R,
) {
    begin(k, meshes);
    let placed = seen(&mesh.placed, &solid.placed);
    let piece = Piece {
        solid: Solid { placed, ..*solid },
        inside: placed.position,
        whole: &placed,
        face: None,
    };
    let bounds = around(k, tables, &piece.solid, margin);
    for group in k.range(mesh.groups[0], mesh.groups[1]) {
        let near = bounds.meet(k.read(meshes.groups, group, 0));
        if let Some(_branch) = k.if_any(near) {
            let [first, end] = k.link_row(meshes.group_rows, group);
            for cluster in k.range(first, end) {
                let near = bounds.meet(k.read(meshes.clusters, cluster, 0));
                if let Some(_branch) = k.if_any(near) {
                    triangles(k, tables, meshes, &piece, &bounds, cluster, margin);
                }
            }
        }
    }
    finish(k, meshes, &placed, &mesh.placed);
}

/// Contacts of two meshes, A and B, nearer than `margin` [m], as those of [`mesh_convex`]: A is met
/// triangle by triangle, each a tetrahedron with the matter behind it.
#[inline(always)]
pub fn mesh_mesh<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    a: &Surface<M>,
    b: &Surface<M>,
    margin: M::R,
) {
    begin(k, meshes);
    let a_seen = seen(&b.placed, &a.placed);
    for group in k.range(a.groups[0], a.groups[1]) {
        let bounds = Bounds::seen(&a_seen, k.read(meshes.groups, group, 0), margin);
        let clusters = k.link_row(meshes.group_rows, group);
        for other in k.range(b.groups[0], b.groups[1]) {
            let near = bounds.meet(k.read(meshes.groups, other, 0));
            if let Some(_branch) = k.if_any(near) {
                let others = k.link_row(meshes.group_rows, other);
                meet_clusters(k, tables, meshes, &a_seen, clusters, others, margin);
            }
        }
    }
    finish(k, meshes, &a_seen, &b.placed);
}

/// Contacts of clusters of A and clusters of B.
#[inline(always)]
fn meet_clusters<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    a: &Placed<M::R>,
    clusters: [M::I; 2],
    others: [M::I; 2],
    margin: M::R,
) {
    for cluster in k.range(clusters[0], clusters[1]) {
        let bounds = Bounds::seen(a, k.read(meshes.clusters, cluster, 0), margin);
        for other in k.range(others[0], others[1]) {
            let near = bounds.meet(k.read(meshes.clusters, other, 0));
            if let Some(_branch) = k.if_any(near) {
                let [first, end] = k.link_row(meshes.cluster_rows, cluster);
                for row in k.range(first, end) {
                    let face: [M::R; TRIANGLE] = k.read(meshes.triangles, row, 0);
                    let [x, y, z, l, m, n] = [face[0], face[1], face[2], face[3], face[4], face[5]];
                    let bounds = Bounds::seen(a, [x, y, z, l, m, n], margin);
                    let near = bounds.meet(k.read(meshes.clusters, other, 0));
                    if let Some(_branch) = k.if_any(near) {
                        let piece = Piece::of_mesh(k, tables, meshes, a, row, face);
                        triangles(k, tables, meshes, &piece, &bounds, other, margin);
                    }
                }
            }
        }
    }
}

/// Something of a frame, as seen from another frame.
#[inline(always)]
fn seen<R: Real>(from: &Placed<R>, placed: &Placed<R>) -> Placed<R> {
    Placed {
        size: placed.size,
        position: from.local_point(placed.position),
        axes: from.axes.transpose() * placed.axes,
    }
}

/// Nothing is found yet.
#[inline(always)]
fn begin<M: Machine>(k: &mut M, meshes: &MeshTables) {
    let first = k.index(0);
    k.store(meshes.pierced, first, 0, M::R::zero());
    for slot in k.count(SLOTS + 1) {
        let mut unused = [M::R::zero(); contact::WIDTH];
        unused[contact::DISTANCE] = M::R::lit(FAR);
        unused[contact::SCORE] = M::R::lit(-FAR);
        k.write(meshes.contacts, slot, 0, unused);
    }
}

/// What meets a mesh, or a convex piece of that, in the frame of the mesh.
struct Piece<'a, M: Machine> {
    solid: Solid<M>,
    /// A point of its matter: triangles that it touches are seen from there in front.
    inside: Vec3<M::R>,
    /// What it is a piece of.
    whole: &'a Placed<M::R>,
    /// The triangle that it is the matter behind of, in the frame of the piece.
    face: Option<[M::R; TRIANGLE]>,
}

impl<'a, M: Machine> Piece<'a, M> {
    /// The tetrahedron of a triangle and a point behind it.
    #[inline(always)]
    fn of_mesh(
        k: &M,
        tables: Tables,
        meshes: &MeshTables,
        whole: &'a Placed<M::R>,
        row: M::I,
        face: [M::R; TRIANGLE],
    ) -> Self {
        let mut solid = corners_of(k, meshes, row, &face);
        let behind = solid.rows[1];
        solid.rows[1] = behind.offset(1);
        solid.placed.position = whole.point(solid.placed.position);
        solid.placed.axes = whole.axes;
        let inside = solid.placed.point(k.vec3(tables.vertices, behind, 0));
        Self {
            solid,
            inside,
            whole,
            face: Some(face),
        }
    }

    /// Whether its normals and those of a triangle may be opposite. Of its own, and of the triangle, they are
    /// within an angle of that of the face: α and β. So it cannot be where the two faces are off by more than
    /// α + β.
    #[inline(always)]
    fn may_meet(&self, t: &[M::R; TRIANGLE]) -> <M::R as Real>::Mask {
        match &self.face {
            None => <M::R as Real>::Mask::splat(true),
            Some(face) => {
                let own = self.whole.direction(Vec3::new(face[9], face[10], face[11]));
                let [cos_a, sin_a] = [face[NUMBER + 1], face[NUMBER + 2]];
                let [cos_b, sin_b] = [t[NUMBER + 1], t[NUMBER + 2]];
                let least = cos_a.fma(cos_b, -(sin_a * sin_b)) - M::R::lit(TURNED);
                (-own.dot(Vec3::new(t[9], t[10], t[11]))).ge(least)
            }
        }
    }

    /// Whether a direction out of it may be a normal at a point of it.
    #[inline(always)]
    fn allows(
        &self,
        k: &M,
        tables: Tables,
        out: Vec3<M::R>,
        at: Vec3<M::R>,
        close: M::R,
    ) -> <M::R as Real>::Mask {
        match &self.face {
            None => <M::R as Real>::Mask::splat(true),
            Some(face) => {
                let placed = &self.solid.placed;
                let (out, at) = (placed.local_direction(out), placed.local_direction(at));
                !is_turned(
                    out,
                    kept_over_edges(k, tables, &self.solid, face, out, at, close),
                )
            }
        }
    }

    /// The number of a triangle that it meets: with another piece, another one.
    #[inline(always)]
    fn with_number(&self, number: M::R) -> M::R {
        match &self.face {
            None => number,
            Some(face) => {
                let turns = face[NUMBER] * M::R::lit(GOLDEN);
                let spread = (turns - turns.floor()) * M::R::lit(NUMBERS);
                let sum = number + spread.floor();
                M::R::select(sum.lt(M::R::lit(NUMBERS)), sum, sum - M::R::lit(NUMBERS))
            }
        }
    }
}

/// A triangle as a hull of its corners, in the frame of its mesh.
#[inline(always)]
fn corners_of<M: Machine>(k: &M, meshes: &MeshTables, row: M::I, t: &[M::R; TRIANGLE]) -> Solid<M> {
    let (low, high) = (Vec3::new(t[0], t[1], t[2]), Vec3::new(t[3], t[4], t[5]));
    Solid {
        kind: k.index(kind::HULL),
        placed: Placed {
            size: (high - low) * M::R::lit(0.5),
            position: Vec3::new(t[6], t[7], t[8]),
            axes: Mat3::identity(),
        },
        rows: k.link_row(meshes.triangle_rows, row),
    }
}

/// A box along the axes.
struct Bounds<R> {
    low: Vec3<R>,
    high: Vec3<R>,
}

impl<R: Real> Bounds<R> {
    #[inline(always)]
    fn meet(&self, [a, b, c, x, y, z]: [R; BOUNDS]) -> R::Mask {
        let (low, high) = (self.low, self.high);
        let x = low.x.le(x) & high.x.ge(a);
        let y = low.y.le(y) & high.y.ge(b);
        let z = low.z.le(z) & high.z.ge(c);
        x & y & z
    }
    /// About a box of another frame, widened by the margin.
    #[inline(always)]
    fn seen(placed: &Placed<R>, [a, b, c, x, y, z]: [R; BOUNDS], margin: R) -> Self {
        let (low, high) = (Vec3::new(a, b, c), Vec3::new(x, y, z));
        let center = placed.point((low + high) * R::lit(0.5));
        let half = (high - low) * R::lit(0.5);
        let Mat3 { x, y, z } = placed.axes;
        let across = x.abs().fma(half.x, y.abs() * half.y) + z.abs() * half.z;
        let across = across + Vec3::new(margin, margin, margin);
        Self {
            low: center - across,
            high: center + across,
        }
    }
}

/// The bounds of a solid, widened by the margin.
#[inline(always)]
fn around<M: Machine>(k: &M, tables: Tables, solid: &Solid<M>, margin: M::R) -> Bounds<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let wide = radius(k, solid) + margin;
    let mut low = [o; 3];
    let mut high = [o; 3];
    for axis in 0..3 {
        let mut d = [o; 3];
        d[axis] = i;
        let d = Vec3::from_array(d);
        let center = solid.placed.position.dot(d);
        high[axis] = center + support(k, tables, solid, d).dot(d) + wide;
        low[axis] = center + support(k, tables, solid, -d).dot(d) - wide;
    }
    Bounds {
        low: Vec3::from_array(low),
        high: Vec3::from_array(high),
    }
}

/// Contacts of a piece with the triangles of a cluster.
#[inline(always)]
fn triangles<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    piece: &Piece<'_, M>,
    bounds: &Bounds<M::R>,
    cluster: M::I,
    margin: M::R,
) {
    let [first, end] = k.link_row(meshes.cluster_rows, cluster);
    for row in k.range(first, end) {
        let near = bounds.meet(k.read(meshes.triangles, row, 0));
        if let Some(_branch) = k.if_any(near) {
            triangle(k, tables, meshes, piece, row, near, margin);
        }
    }
}

/// Contacts of a piece with one triangle, in the mesh's frame.
#[inline(always)]
fn triangle<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    piece: &Piece<'_, M>,
    row: M::I,
    near: <M::R as Real>::Mask,
    margin: M::R,
) {
    let t: [M::R; TRIANGLE] = k.read(meshes.triangles, row, 0);
    let face = corners_of(k, meshes, row, &t);
    let (solid, normal) = (&piece.solid, Vec3::new(t[9], t[10], t[11]));
    let offset = face.placed.position - solid.placed.position;
    let cores = Cores {
        tables,
        a: solid,
        b: &face,
        offset,
    };
    let size = solid.placed.size.length() + face.placed.size.length();
    let close = size * M::R::lit(ON_EDGE);
    let over = cores.gap(k, -normal);
    let in_front = normal
        .dot(face.placed.position - piece.inside)
        .lt(M::R::zero());
    let near = near & piece.may_meet(&t);
    let mask = near & in_front & (over - radius(k, solid)).lt(margin);
    if let Some(_branch) = k.if_any(mask) {
        let start = Direction {
            n: -normal,
            gap: over,
            on_a: Vec3::zero(),
        };
        // Deep along the normal, and still apart: a peg in a hole, to the triangles around it.
        let deep = over.lt(M::R::lit(-DEEP) * size);
        let found = ascend(k, &cores, start, M::R::lit(12.0), !mask, deep);
        let on_face = found.n.fma(found.gap, found.on_a) - offset;
        let n = -kept_over_edges(k, tables, &face, &t, -found.n, on_face, close);
        let turned = is_turned(n, found.n);
        let pierced = mask & found.gap.le(M::R::zero());
        let first = k.index(0);
        k.store_where(pierced, meshes.pierced, first, 0, M::R::one());
        // Apart like that, it touches others, unless it came through them to this one's back.
        let apart = deep & !pierced & turned;
        let behind = apart & found.n.dot(normal).gt(M::R::zero());
        let n = Vec3::select(behind, -normal, n);
        let mask = mask & piece.allows(k, tables, n, found.on_a, close);
        if let Some(_branch) = k.if_any(mask) {
            let witness = Witness {
                normal: n,
                on_a: found.on_a,
                gap: cores.gap(k, n),
                radii: [radius(k, solid), M::R::zero()],
                stands: !turned,
            };
            let manifold = overlap::manifold(k, &cores, &witness);
            let number = piece.with_number(t[NUMBER]);
            let masks = [mask & !apart, mask & behind];
            keep(k, meshes, piece.whole, &manifold, number, masks, margin);
        }
    }
}

/// Whether two unit vectors differ.
#[inline(always)]
fn is_turned<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R::Mask {
    (a - b).length_squared().gt(R::lit(TURNED * TURNED))
}

/// A unit vector out of the surface at `at` (from the triangle's middle), leaned back as the edges ask
/// that the contact is on: those that the vector is at a right angle to, and those close to the point.
#[inline(always)]
fn kept_over_edges<M: Machine>(
    k: &M,
    tables: Tables,
    face: &Solid<M>,
    t: &[M::R; TRIANGLE],
    out: Vec3<M::R>,
    at: Vec3<M::R>,
    close: M::R,
) -> Vec3<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let normal = Vec3::new(t[9], t[10], t[11]);
    let a = k.vec3(tables.vertices, face.rows[0], 0);
    let b = k.vec3(tables.vertices, face.rows[0].offset(1), 0);
    let c = k.vec3(tables.vertices, face.rows[0].offset(2), 0);
    let corners = [a, b, c];
    let top = a.dot(out).max(b.dot(out)).max(c.dot(out)) - close;
    let mut share = i;
    for edge in 0..3 {
        let field = 12 + 4 * edge;
        let (beyond, lean) = (
            Vec3::new(t[field], t[field + 1], t[field + 2]),
            t[field + 3],
        );
        let (from, to) = (corners[edge], corners[(edge + 1) % 3]);
        let leans = out.dot(beyond);
        let faces_out = from.dot(out).gt(top) & to.dot(out).gt(top);
        let on_edge = faces_out | beyond.dot(at - from).gt(-close);
        let too_far = on_edge & leans.gt(lean);
        let limit = lean / M::R::select(too_far, leans, i);
        share = M::R::select(too_far, share.min(limit), share);
    }
    let level = normal.fma(-normal.dot(out), out) * share;
    let up = (i - level.length_squared()).max(o).sqrt();
    normal.fma(up, level).normalized_or(normal)
}

/// Puts the points of a manifold where they lie farther out than what was kept; in the lanes of the second
/// mask they are those of a solid behind the triangle.
#[inline(always)]
fn keep<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    whole: &Placed<M::R>,
    manifold: &Manifold<M::R>,
    number: M::R,
    [mask, behind]: [<M::R as Real>::Mask; 2],
    margin: M::R,
) {
    let n = manifold.normal;
    let preferred = whole.size.length() * number * M::R::lit(PREFERRED / NUMBERS);
    for i in 0..4 {
        let point = manifold.points[i];
        let x = whole.local_point(point.position);
        let near = point.distance.lt(margin);
        let (touches, behind) = (mask & near, behind & near);
        // Sixty-four features a triangle.
        let turns = (point.feature * M::R::lit(1.0 / 64.0)).floor();
        let local = turns.fma(M::R::lit(-64.0), point.feature);
        let feature = number.fma(M::R::lit(64.0), local);
        let p = point.position;
        let new = [p.x, p.y, p.z, n.x, n.y, n.z, point.distance, feature];
        if let Some(_branch) = k.if_any(touches) {
            for slot in 0..CORNERS {
                let (a, b, c) = (slot & 1, slot >> 1 & 1, slot >> 2);
                let score = toward(x.x, a) + toward(x.y, b) + toward(x.z, c);
                let score = point.distance.fma(M::R::lit(-DEPTH), score + preferred);
                offer(k, meshes, slot, new, score, touches);
            }
            let score = preferred - point.distance;
            offer(k, meshes, CORNERS, new, score, touches);
        }
        if let Some(_branch) = k.if_any(behind) {
            offer(k, meshes, BEHIND, new, point.distance, behind);
        }
    }
}

/// `x` or `−x`.
#[inline(always)]
fn toward<R: Real>(x: R, side: usize) -> R {
    if side == 0 { -x } else { x }
}

/// Replaces the contact in a slot by one of a higher score.
#[inline(always)]
fn offer<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    slot: usize,
    new: [M::R; contact::SCORE],
    score: M::R,
    mask: <M::R as Real>::Mask,
) {
    let row = k.index(slot);
    let old: [M::R; contact::WIDTH] = k.read(meshes.contacts, row, 0);
    let better = mask & score.gt(old[contact::SCORE]);
    let mut chosen = old;
    for f in 0..contact::SCORE {
        chosen[f] = M::R::select(better, new[f], old[f]);
    }
    chosen[contact::SCORE] = M::R::select(better, score, old[contact::SCORE]);
    k.write(meshes.contacts, row, 0, chosen);
}

/// Drops the deepest contact where one in a corner is as deep, within `close`: which of them it is would change
/// from step to step. Takes that of what is behind a triangle where the solid pierces others that have none.
#[inline(always)]
fn complete<M: Machine>(k: &mut M, meshes: &MeshTables, close: M::R) {
    let (first, deepest, behind) = (k.index(0), k.index(CORNERS), k.index(BEHIND));
    let mut least = k.cell(M::R::lit(FAR));
    for slot in k.count(CORNERS) {
        let distance = k.load(meshes.contacts, slot, contact::DISTANCE);
        least.write(least.read().min(distance));
    }
    let (least, distance) = (least.read(), contact::DISTANCE);
    let as_deep = (least - close).lt(k.load(meshes.contacts, deepest, distance));
    k.store_where(as_deep, meshes.contacts, deepest, distance, M::R::lit(FAR));
    let pierced = k.load(meshes.pierced, first, 0).gt(M::R::zero());
    let none = least.gt(M::R::lit(0.5 * FAR)) & pierced;
    if let Some(_branch) = k.if_any(none) {
        let contact: [M::R; contact::SCORE] = k.read(meshes.contacts, behind, 0);
        offer(k, meshes, 0, contact, M::R::zero(), none);
    }
}

/// Drops what is kept twice, and turns the rest into world axes.
#[inline(always)]
fn finish<M: Machine>(k: &mut M, meshes: &MeshTables, whole: &Placed<M::R>, placed: &Placed<M::R>) {
    let close = whole.size.length() * M::R::lit(MERGED);
    complete(k, meshes, close);
    for later in 1..SLOTS {
        for earlier in 0..later {
            let (p, q) = (k.index(earlier), k.index(later));
            let p: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, p, 0);
            let here: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, q, 0);
            let way = Vec3::new(p[0] - here[0], p[1] - here[1], p[2] - here[2]);
            let normals = [
                Vec3::new(p[3], p[4], p[5]),
                Vec3::new(here[3], here[4], here[5]),
            ];
            let twice = p[contact::DISTANCE].lt(M::R::lit(0.5 * FAR))
                & way.length_squared().lt(close.squared())
                & !is_turned(normals[0], normals[1]);
            k.store_where(twice, meshes.contacts, q, contact::DISTANCE, M::R::lit(FAR));
        }
    }
    for slot in k.count(SLOTS) {
        let position = placed.point(k.vec3(meshes.contacts, slot, contact::POSITION));
        let normal = placed.direction(k.vec3(meshes.contacts, slot, contact::NORMAL));
        k.store_vec3(meshes.contacts, slot, contact::POSITION, position);
        k.store_vec3(meshes.contacts, slot, contact::NORMAL, normal);
    }
}
