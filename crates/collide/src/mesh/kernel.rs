//! A convex solid against the triangles of a mesh.
//!
//! Each near triangle is a convex solid of three vertices, met from the side of its normal N. The
//! search for the normal starts at N; what it finds is then kept within the Voronoi regions of the
//! triangle's edges ([`adjacency`](super::adjacency)), and a triangle that the solid does not lie
//! over along that normal leaves the contact to its neighbours.
//!
//! Of all points those are kept that lie farthest in the eight corners of the solid's own frame: they
//! span what the solid rests on, and stay the same while it rests.

use super::tables::{BOUNDS, MeshTables, SLOTS, TRIANGLE, contact};
use crate::convex::{Direction, ascend};
use crate::gjk::Cores;
use crate::overlap::{self, Witness};
use crate::solid::kind;
use crate::support::{radius, support};
use crate::{FAR, Manifold, Placed, Solid, Tables};
use numbers::machine::Index;
use numbers::{Machine, Mat3, Real, Vec3};

/// A mesh, placed in the world.
#[derive(Debug)]
pub struct Surface<M: Machine> {
    /// Where it is.
    pub placed: Placed<M::R>,
    /// The range of its groups, as [`MeshData::add`](super::MeshData::add) gave it.
    pub groups: [M::I; 2],
}

/// How deep a point counts against how far out it lies.
const DEPTH: f64 = 4.0;
/// A point is on an edge that is closer than this, against the sizes.
const ON_EDGE: f64 = 1e-3;
/// How far a normal may be turned by the edges before the triangle needs the solid right over it.
const TURNED: f64 = 1e-3;
/// Contacts closer than this, against the solid's size, with one normal, are one.
const MERGED: f64 = 1e-3;

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
    for slot in k.count(SLOTS) {
        let mut unused = [M::R::zero(); contact::WIDTH];
        unused[contact::DISTANCE] = M::R::lit(FAR);
        unused[contact::SCORE] = M::R::lit(-FAR);
        k.write(meshes.contacts, slot, 0, unused);
    }
    // The solid in the mesh's frame.
    let seen = Solid {
        placed: Placed {
            size: solid.placed.size,
            position: mesh.placed.local_point(solid.placed.position),
            axes: mesh.placed.axes.transpose() * solid.placed.axes,
        },
        ..*solid
    };
    let bounds = bounds(k, tables, &seen, margin);
    for group in k.range(mesh.groups[0], mesh.groups[1]) {
        let near = bounds.meet(k.read(meshes.groups, group, 0));
        if let Some(_branch) = k.if_any(near) {
            let (first, last) = (
                k.link(meshes.group_rows, group, 0),
                k.link(meshes.group_rows, group, 1),
            );
            for cluster in k.range(first, last) {
                let near = bounds.meet(k.read(meshes.clusters, cluster, 0));
                if let Some(_branch) = k.if_any(near) {
                    let (first, last) = (
                        k.link(meshes.cluster_rows, cluster, 0),
                        k.link(meshes.cluster_rows, cluster, 1),
                    );
                    for row in k.range(first, last) {
                        let near = bounds.meet(k.read(meshes.triangles, row, 0));
                        if let Some(_branch) = k.if_any(near) {
                            triangle(k, tables, meshes, &seen, row, near, margin);
                        }
                    }
                }
            }
        }
    }
    finish(k, meshes, &seen, &mesh.placed);
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
}

/// The bounds of a solid, widened by the margin.
#[inline(always)]
fn bounds<M: Machine>(k: &M, tables: Tables, solid: &Solid<M>, margin: M::R) -> Bounds<M::R> {
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

/// Contacts with one triangle, in the mesh's frame.
#[inline(always)]
fn triangle<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    solid: &Solid<M>,
    row: M::I,
    near: <M::R as Real>::Mask,
    margin: M::R,
) {
    let t: [M::R; TRIANGLE] = k.read(meshes.triangles, row, 0);
    let vector = [
        Vec3::new(t[0], t[1], t[2]),
        Vec3::new(t[3], t[4], t[5]),
        Vec3::new(t[6], t[7], t[8]),
        Vec3::new(t[9], t[10], t[11]),
    ];
    let [low, high, middle, normal] = vector;
    let face = Solid {
        kind: k.index(kind::HULL),
        placed: Placed {
            size: (high - low) * M::R::lit(0.5),
            position: middle,
            axes: Mat3::identity(),
        },
        rows: [
            k.link(meshes.triangle_rows, row, 0),
            k.link(meshes.triangle_rows, row, 1),
        ],
    };
    let offset = middle - solid.placed.position;
    let cores = Cores {
        tables,
        a: solid,
        b: &face,
        offset,
    };
    let around = radius(k, solid);
    let over = cores.gap(k, -normal);
    let in_front = normal.dot(offset).lt(M::R::zero());
    let mask = near & in_front & (over - around).lt(margin);
    if let Some(_branch) = k.if_any(mask) {
        let start = Direction {
            n: -normal,
            gap: over,
            on_a: Vec3::zero(),
        };
        let found = ascend(k, &cores, start, M::R::lit(12.0), !mask);
        let on_face = found.n.fma(found.gap, found.on_a) - offset;
        let close = (solid.placed.size.length() + face.placed.size.length()) * M::R::lit(ON_EDGE);
        let n = -kept_over_edges(k, tables, &face, &t, -found.n, on_face, close);
        let turned = (n - found.n)
            .length_squared()
            .gt(M::R::lit(TURNED * TURNED));
        let witness = Witness {
            normal: n,
            on_a: found.on_a,
            gap: cores.gap(k, n),
            radii: [around, M::R::zero()],
            stands: !turned,
        };
        let manifold = overlap::manifold(k, &cores, &witness);
        keep(k, meshes, solid, &manifold, t[TRIANGLE - 1], mask, margin);
    }
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

/// Puts the points of a manifold where they lie farther out than what was kept.
#[inline(always)]
fn keep<M: Machine>(
    k: &mut M,
    meshes: &MeshTables,
    solid: &Solid<M>,
    manifold: &Manifold<M::R>,
    number: M::R,
    mask: <M::R as Real>::Mask,
    margin: M::R,
) {
    let n = manifold.normal;
    for i in 0..4 {
        let point = manifold.points[i];
        let x = solid.placed.local_point(point.position);
        let touches = mask & point.distance.lt(margin);
        // Sixty-four features a triangle.
        let turns = (point.feature * M::R::lit(1.0 / 64.0)).floor();
        let local = turns.fma(M::R::lit(-64.0), point.feature);
        let feature = number.fma(M::R::lit(64.0), local);
        let p = point.position;
        let new = [p.x, p.y, p.z, n.x, n.y, n.z, point.distance, feature];
        if let Some(_branch) = k.if_any(touches) {
            for slot in 0..SLOTS {
                let (a, b, c) = (slot & 1, slot >> 1 & 1, slot >> 2);
                let score = toward(x.x, a) + toward(x.y, b) + toward(x.z, c);
                let score = point.distance.fma(M::R::lit(-DEPTH), score);
                offer(k, meshes, slot, new, score, touches);
            }
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

/// Drops what is kept twice, and turns the rest into world axes.
#[inline(always)]
fn finish<M: Machine>(k: &mut M, meshes: &MeshTables, solid: &Solid<M>, placed: &Placed<M::R>) {
    let close = solid.placed.size.length() * M::R::lit(MERGED);
    for later in 1..SLOTS {
        for earlier in 0..later {
            let (p, q) = (k.index(earlier), k.index(later));
            let p: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, p, 0);
            let here: [M::R; contact::DISTANCE + 1] = k.read(meshes.contacts, q, 0);
            let way = Vec3::new(p[0] - here[0], p[1] - here[1], p[2] - here[2]);
            let turn = Vec3::new(p[3] - here[3], p[4] - here[4], p[5] - here[5]);
            let twice = p[contact::DISTANCE].lt(M::R::lit(0.5 * FAR))
                & way.length_squared().lt(close.squared())
                & turn.length_squared().lt(M::R::lit(TURNED * TURNED));
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
