//! A convex piece against one triangle of a mesh.
//!
//! A triangle is a convex solid of three vertices, met from the side of its normal N. The
//! search for the normal starts at N; what it finds is then kept within the Voronoi regions of the
//! triangle's edges ([`adjacency`](super::adjacency)), and a triangle that the piece does not lie
//! over along that normal leaves the contact to its neighbours.
//!
//! A piece of another mesh is a tetrahedron: a triangle with a point of the [`matter`](super::matter)
//! behind it, which tells from which side it comes and how deep it may lie. A normal that is not in the
//! Voronoi region of that triangle, too, is left to its neighbours, so that inner faces are never felt. One that
//! is nearly there is kept for what lies right over the triangle: of two faces nearly flat on each other the
//! least depth is often along the normal of a seam, and each side would leave the corners to another.
//!
//! Tetrahedra do not fill what is between their triangles: near a seam those that hold the edges that meet may be
//! apart. Where no triangle has a contact, one that is pierced has the contact that it left.

use super::kept::{keep, note, remember};
use super::tables::{MeshTables, NUMBER, NUMBERS, TRIANGLE, search};
use crate::convex::{DEEP, Direction, ascend};
use crate::gjk::Cores;
use crate::overlap::{self, Witness};
use crate::solid::kind;
use crate::support::radius;
use crate::{FLAT, Placed, Point, Solid, Tables};
use numbers::machine::Index;
use numbers::{Cell, Machine, Mask, Mat3, Real, Vec3};

/// A point is on an edge that is closer than this, against the sizes.
const ON_EDGE: f64 = 1e-3;
/// How far a normal may be turned by the edges before the triangle needs the piece right over it.
const TURNED: f64 = 1e-3;
/// How far a normal may be turned by the edges of a piece before it is left to the neighbours of that.
const SLANTED: f64 = 0.05;
/// The golden ratio less 1: its multiples lie as far apart as can be.
const GOLDEN: f64 = 0.618_033_988_749_894_8;

/// What meets a mesh, or a convex piece of that, in the frame of the mesh.
pub(super) struct Piece<'a, M: Machine> {
    pub solid: Solid<M>,
    /// A point of its matter: triangles that it touches are seen from there in front.
    pub inside: Vec3<M::R>,
    /// What it is a piece of.
    pub whole: &'a Placed<M::R>,
    /// The triangle that it is the matter behind of, in the frame of the piece.
    pub face: Option<[M::R; TRIANGLE]>,
}

impl<'a, M: Machine> Piece<'a, M> {
    /// The tetrahedron of a triangle and a point behind it.
    #[inline(always)]
    pub fn of_mesh(
        k: &M,
        tables: Tables,
        meshes: &MeshTables,
        whole: &'a Placed<M::R>,
        row: M::I,
    ) -> Self {
        let face = k.read(meshes.triangles, row, 0);
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

    /// By how much its edges turn a direction out of it, to be a normal at a point of it: the square of the way.
    #[inline(always)]
    fn turns(&self, k: &M, tables: Tables, out: Vec3<M::R>, at: Vec3<M::R>, close: M::R) -> M::R {
        match &self.face {
            None => M::R::zero(),
            Some(face) => {
                let placed = &self.solid.placed;
                let (out, at) = (placed.local_direction(out), placed.local_direction(at));
                let kept = kept_over_edges(k, tables, &self.solid, face, out, at, close);
                (kept - out).length_squared()
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

/// Contacts of a piece with one triangle, in the mesh's frame.
#[inline(always)]
pub(super) fn triangle<M: Machine>(
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
        k.store_where(pierced, meshes.search, first, search::PIERCED, M::R::one());
        // Apart like that, it touches others, unless it came through them to this one's back.
        let apart = deep & !pierced & turned;
        let behind = apart & found.n.dot(normal).gt(M::R::zero());
        let n = Vec3::select(behind, -normal, n);
        let turns = piece.turns(k, tables, n, found.on_a, close);
        let slanted = turns.gt(M::R::lit(TURNED * TURNED));
        let nearly = turns.le(M::R::lit(SLANTED * SLANTED)) & !apart;
        let mask = mask & (nearly | !slanted);
        let mask = mask & !is_freed(k, meshes, &cores, found.gap, close);
        if let Some(_branch) = k.if_any(mask) {
            let witness = Witness {
                normal: n,
                on_a: found.on_a,
                gap: cores.gap(k, n),
                radii: [radius(k, solid), M::R::zero()],
                stands: !(turned | slanted),
                // What is not right over the triangle is the neighbours'.
                leaning: FLAT,
            };
            let manifold = overlap::manifold(k, &cores, &witness);
            let number = piece.with_number(t[NUMBER]);
            remember(k, meshes, n, witness.gap, mask & pierced & witness.stands);
            let masks = [mask & !apart, mask & behind];
            keep(k, meshes, piece.whole, &manifold, number, masks, margin);
            if piece.face.is_some() {
                let on_a = found.on_a + solid.placed.position;
                let point = Point::from_a(on_a, n, witness.gap, M::R::zero());
                note(k, meshes, n, &point, number, mask & pierced);
            }
        }
    }
}

/// Whether what frees the solid of another triangle frees it of this one, too, which is far deeper by itself.
#[inline(always)]
fn is_freed<M: Machine>(
    k: &M,
    meshes: &MeshTables,
    cores: &Cores<'_, M>,
    gap: M::R,
    close: M::R,
) -> <M::R as Real>::Mask {
    let first = k.index(0);
    let again = k.load(meshes.search, first, search::AGAIN);
    let mut freed = k.cell(M::R::zero());
    if let Some(_branch) = k.if_any(again.gt(M::R::zero())) {
        let least = k.load(meshes.search, first, search::GAP);
        let along = cores.gap(k, k.vec3(meshes.search, first, search::NORMAL));
        let frees = gap.lt(least - close) & along.ge(least - close);
        freed.write(M::R::select(frees, again, M::R::zero()));
    }
    freed.read().gt(M::R::zero())
}

/// Whether two unit vectors differ.
#[inline(always)]
pub(super) fn is_turned<R: Real>(a: Vec3<R>, b: Vec3<R>) -> R::Mask {
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
