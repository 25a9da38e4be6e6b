//! A convex solid, or another mesh, against the triangles of a mesh: which of them are near.
//!
//! A convex solid is one [`Piece`], another mesh one for each triangle. Three nested loops over boxes, each left
//! out where no lane's piece is near ([`hierarchy`](super::hierarchy)), lead to the triangles that
//! a piece may touch.

use super::kept::{begin, finish, forget, review};
use super::piece::{Piece, triangle};
use super::tables::{BEYOND, BOUNDS, MeshTables, VERTICES};
use crate::support::{radius, support};
use crate::{Placed, Solid, Tables};
use numbers::machine::Index;
use numbers::{Machine, Mat3, Real, Vec3};

/// Rounds through all triangles, the second where the first has found a contact to be doubted.
const ROUNDS: usize = 2;

/// A mesh, placed in the world.
#[derive(Debug)]
pub struct Surface<M: Machine> {
    /// Where it is.
    pub placed: Placed<M::R>,
    /// The range of its groups, as [`MeshData::add`](super::MeshData::add) gave it.
    pub groups: [M::I; 2],
}

impl<M: Machine> Surface<M> {
    /// That of a shape of the kind [`MESH`](crate::kind::MESH).
    #[inline(always)]
    pub fn of(mesh: &Solid<M>) -> Self {
        Self {
            placed: mesh.placed,
            groups: mesh.rows,
        }
    }
}

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
    let placed = seen(&mesh.placed, &solid.placed);
    let piece = Piece {
        solid: Solid { placed, ..*solid },
        inside: placed.position,
        whole: &placed,
        face: None,
    };
    let bounds = around(k, tables, &piece.solid, margin);
    forget(k, meshes);
    for _ in k.count(ROUNDS) {
        begin(k, meshes);
        meet_groups(k, tables, meshes, &piece, &bounds, mesh.groups, margin);
        let sure = review(k, meshes, &placed);
        if k.finished(sure) {
            break;
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
    let a_seen = seen(&b.placed, &a.placed);
    forget(k, meshes);
    for _ in k.count(ROUNDS) {
        begin(k, meshes);
        meet_all_groups(k, tables, meshes, &a_seen, a.groups, b.groups, margin);
        let sure = review(k, meshes, &a_seen);
        if k.finished(sure) {
            break;
        }
    }
    finish(k, meshes, &a_seen, &b.placed);
}

/// Contacts of a piece and groups of the mesh.
#[inline(always)]
fn meet_groups<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    piece: &Piece<'_, M>,
    bounds: &Bounds<M::R>,
    groups: [M::I; 2],
    margin: M::R,
) {
    for group in k.range(groups[0], groups[1]) {
        let near = bounds.meet(k.read(meshes.groups, group, 0));
        if let Some(_branch) = k.if_any(near) {
            let [first, end] = k.link_row(meshes.group_rows, group);
            for cluster in k.range(first, end) {
                let near = bounds.meet(k.read(meshes.clusters, cluster, 0));
                if let Some(_branch) = k.if_any(near) {
                    triangles(k, tables, meshes, piece, bounds, cluster, margin);
                }
            }
        }
    }
}

/// Contacts of groups of A and groups of B.
#[inline(always)]
fn meet_all_groups<M: Machine>(
    k: &mut M,
    tables: Tables,
    meshes: &MeshTables,
    a: &Placed<M::R>,
    groups: [M::I; 2],
    others: [M::I; 2],
    margin: M::R,
) {
    for group in k.range(groups[0], groups[1]) {
        let bounds = Bounds::seen(a, k.read(meshes.groups, group, 0), margin);
        let clusters = k.link_row(meshes.group_rows, group);
        for other in k.range(others[0], others[1]) {
            let near = bounds.meet(k.read(meshes.groups, other, 0));
            if let Some(_branch) = k.if_any(near) {
                let theirs = k.link_row(meshes.group_rows, other);
                meet_clusters(k, tables, meshes, a, clusters, theirs, margin);
            }
        }
    }
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
                    let bounds = around_piece(k, tables, meshes, a, row, margin);
                    let near = bounds.meet(k.read(meshes.clusters, other, 0));
                    if let Some(_branch) = k.if_any(near) {
                        let piece = Piece::of_mesh(k, tables, meshes, a, row);
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

/// The bounds of a triangle and of the matter behind it, widened by the margin; of a row that is free, nothing.
#[inline(always)]
fn around_piece<M: Machine>(
    k: &M,
    tables: Tables,
    meshes: &MeshTables,
    whole: &Placed<M::R>,
    row: M::I,
    margin: M::R,
) -> Bounds<M::R> {
    let (from, to) = (
        k.load(meshes.triangles, row, 0),
        k.load(meshes.triangles, row, 3),
    );
    let wide = M::R::select(from.le(to), margin, M::R::lit(-BEYOND));
    let middle = whole.point(k.vec3(meshes.triangles, row, 6)).to_array();
    let [first, _] = k.link_row(meshes.triangle_rows, row);
    let (mut low, mut high) = (middle, middle);
    for corner in 0..VERTICES {
        let way = whole.direction(k.vec3(tables.vertices, first.offset(corner), 0));
        let way = way.to_array();
        for axis in 0..3 {
            let x = middle[axis] + way[axis];
            low[axis] = low[axis].min(x);
            high[axis] = high[axis].max(x);
        }
    }
    let wide = Vec3::new(wide, wide, wide);
    Bounds {
        low: Vec3::from_array(low) - wide,
        high: Vec3::from_array(high) + wide,
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
