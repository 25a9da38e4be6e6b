//! The part of a solid's surface that faces a direction: a face, an edge or a corner.

use crate::FLAT;
use crate::solid::{corner_number, kind, sign};
use crate::support::{cone, ellipsoid, farthest_vertex, rim, support};
use crate::tables::CORNERS;
use crate::{Solid, Tables};
use numbers::machine::{Held, Hold, Index};
use numbers::{Cell, Machine, Mat3, Real, Vec3};

/// Cosine and sine of an eighth of a turn.
const EIGHTH: (f64, f64) = (
    core::f64::consts::FRAC_1_SQRT_2,
    core::f64::consts::FRAC_1_SQRT_2,
);
/// Cosine and sine of a sixteenth of a turn: from there, no direction is at a right angle to an axis.
pub(crate) const SIXTEENTH: (f64, f64) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);

/// The plane that a facing surface lies in: its height over the point (x, y) of the contact plane.
#[derive(Clone, Copy)]
pub(crate) struct Height<R> {
    slope_x: R,
    slope_y: R,
    zero: R,
}

impl<R: Real> Height<R> {
    /// The height at a point.
    #[inline(always)]
    pub fn at(&self, x: R, y: R) -> R {
        self.slope_x.fma(x, self.slope_y.fma(y, self.zero))
    }
}

/// Two unit vectors at right angles to a unit vector and to each other, right-handed with it.
///
/// Taken from the axis after the one that `n` is most along, so that they stay as they are while
/// `n` stays close to an axis.
#[inline(always)]
pub(crate) fn tangents<R: Real>(n: Vec3<R>) -> [Vec3<R>; 2] {
    let (x, y, z) = (n.x.abs(), n.y.abs(), n.z.abs());
    let (o, i) = (R::zero(), R::one());
    let along_x = x.ge(y) & x.ge(z);
    let along_y = !along_x & y.ge(z);
    let next = Vec3::new(
        R::select(!along_x & !along_y, i, o),
        R::select(along_x, i, o),
        R::select(along_y, i, o),
    );
    let v = n.cross(next).normalized_or(next);
    [v.cross(n), v]
}

/// Writes the outline of what faces `out` into eight rows from `first` on, and the first of them
/// once more; answers the plane that it lies in.
///
/// Corner j is the farthest along `out` where directions within [`FLAT`] count as one, and among
/// those the farthest along the j-th of eight directions around `out`. So corners run once around
/// the outline, however many of them coincide. All is seen from A's centre along `frame`, whose
/// z axis is the contact's normal.
#[inline(always)]
pub(crate) fn outline<M: Machine>(
    k: &mut M,
    tables: Tables,
    solid: &Solid<M>,
    center: Vec3<M::R>,
    out: Vec3<M::R>,
    frame: &Mat3<M::R>,
    first: M::I,
) -> Height<M::R> {
    let n = solid.placed.local_direction(out);
    let [u, v] = tangents(n);
    let mut cosine = k.cell(M::R::lit(SIXTEENTH.0));
    let mut sine = k.cell(M::R::lit(SIXTEENTH.1));
    let mut number = k.cell(M::R::zero());
    for j in k.count(8) {
        let (c, s) = (cosine.read(), sine.read());
        let t = u.fma(c, v * s);
        let (x, feature) = facing_corner(k, tables, solid, n, t, number.read());
        let x = frame.transpose_mul(solid.placed.direction(x) + center);
        let away = frame.transpose_mul(solid.placed.direction(t));
        let row = [x.x, x.y, x.z, away.x, away.y, feature];
        k.write(tables.corners, first.plus(j), 0, row);
        let (c8, s8) = (M::R::lit(EIGHTH.0), M::R::lit(EIGHTH.1));
        cosine.write(c.fma(c8, -(s * s8)));
        sine.write(c.fma(s8, s * c8));
        number.write(number.read() + M::R::one());
    }
    let again: [M::R; CORNERS] = k.read(tables.corners, first, 0);
    k.write(tables.corners, first.offset(8), 0, again);
    let touching = support(k, tables, solid, out) + center;
    plane(k, tables, first, frame.transpose_mul(touching))
}

/// The plane through a point that fits an outline: across its area, or along its length if it is
/// an edge, or at a right angle to the normal if it is a corner.
///
/// The area vector is half of Σ pⱼ × pⱼ₊₁ (Newell), with p from the first corner.
#[inline(always)]
fn plane<M: Machine>(k: &M, tables: Tables, first: M::I, through: Vec3<M::R>) -> Height<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let origin = k.vec3(tables.corners, first, 0);
    let mut area = Vec3::zero().hold(k);
    let mut length = Vec3::zero().hold(k);
    for j in k.count(8) {
        let here = k.vec3(tables.corners, first.plus(j), 0) - origin;
        let next = k.vec3(tables.corners, first.plus(j).offset(1), 0) - origin;
        area.set(area.get() + here.cross(next));
        let longer = here.length_squared().gt(length.get().length_squared());
        length.set(Vec3::select(longer, here, length.get()));
    }
    let (area, length) = (area.get(), length.get());
    let length2 = length.length_squared();
    let is_face = area.z.abs().gt(M::R::lit(1e-3) * length2) & length2.gt(o);
    let up = Vec3::new(o, o, i);
    let is_edge = length2.gt(M::R::lit(1e-20));
    let lean = M::R::select(is_edge, length.z / length2.max(M::R::lit(1e-20)), o);
    let normal = Vec3::select(is_face, area, length.fma(-lean, up));
    let (slope_x, slope_y) = (-(normal.x / normal.z), -(normal.y / normal.z));
    Height {
        slope_x,
        slope_y,
        zero: through.z - slope_x * through.x - slope_y * through.y,
    }
}

/// One corner of the outline, in the solid's frame, and its number.
#[inline(always)]
fn facing_corner<M: Machine>(
    k: &M,
    tables: Tables,
    solid: &Solid<M>,
    n: Vec3<M::R>,
    t: Vec3<M::R>,
    number: M::R,
) -> (Vec3<M::R>, M::R) {
    let size = solid.placed.size;
    let mut x = Vec3::zero().hold(k);
    let mut feature = k.cell(M::R::zero());
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CAPSULE)) {
        let end = sign(broken(n.y, t.y));
        x.set(Vec3::new(
            M::R::zero(),
            end * solid.placed.half_segment(),
            M::R::zero(),
        ));
        feature.write(end + M::R::one());
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CYLINDER)) {
        let (corner, feature_of) = cylinder_corner(size, n, t, number);
        x.set(corner);
        feature.write(feature_of);
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CONE)) {
        let (corner, feature_of) = cone_corner(size, n, t, number);
        x.set(corner);
        feature.write(feature_of);
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::BOX)) {
        let side = Vec3::new(
            sign(broken(n.x, t.x)),
            sign(broken(n.y, t.y)),
            sign(broken(n.z, t.z)),
        );
        x.set(size.times(side));
        feature.write(corner_number(side));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::ELLIPSOID)) {
        x.set(ellipsoid(size, n));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::HULL)) {
        let (vertex, row) = farthest_vertex(k, tables, solid, t.fma(M::R::lit(FLAT), n));
        x.set(vertex);
        feature.write(row);
    }
    (x.get(), feature.read())
}

/// `a`, or where that is close to zero, `b`.
#[inline(always)]
fn broken<R: Real>(a: R, b: R) -> R {
    R::select(a.abs().lt(R::lit(FLAT)), b, a)
}

/// A rim on a cap, two ends along a side, or a point of a rim.
#[inline(always)]
fn cylinder_corner<R: Real>(size: Vec3<R>, n: Vec3<R>, t: Vec3<R>, number: R) -> (Vec3<R>, R) {
    let o = R::zero();
    let on_cap = Vec3::new(n.x, o, n.z)
        .length_squared()
        .lt(R::lit(FLAT * FLAT));
    let on_side = n.y.abs().lt(R::lit(FLAT));
    let end = sign(R::select(on_side, t.y, n.y));
    let x = rim(size.x, end * size.y, Vec3::select(on_cap, t, n));
    let feature = R::select(on_cap, number, R::select(on_side, R::lit(8.0), R::lit(9.0)));
    // The two ends are sixteen apart.
    (x, end.fma(R::lit(8.0), feature + R::lit(8.0)))
}

/// The rim of the base, base and apex along the slant, a point of the rim, or the apex.
#[inline(always)]
fn cone_corner<R: Real>(size: Vec3<R>, n: Vec3<R>, t: Vec3<R>, number: R) -> (Vec3<R>, R) {
    let (o, i) = (R::zero(), R::one());
    let (radius, half) = (size.x, size.y);
    let radial = Vec3::new(n.x, o, n.z);
    let rho = radial.length();
    let on_base = rho.lt(R::lit(FLAT)) & n.y.lt(o);
    let out = radial.normalized_or(Vec3::new(i, o, o));
    let slant = Vec3::new(-(out.x * radius), half + half, -(out.z * radius));
    let lean = n.dot(slant) / slant.length();
    let on_slant = lean.abs().lt(R::lit(FLAT)) & n.y.gt(-i + R::lit(FLAT)) & rho.gt(o);
    let apex = Vec3::new(o, half, o);
    let by_slant = Vec3::select(t.dot(slant).gt(o), apex, rim(radius, -half, n));
    let x = Vec3::select(on_slant, by_slant, cone(radius, half, n));
    let x = Vec3::select(on_base, rim(radius, -half, t), x);
    let at_apex = x.y.gt(o);
    let feature = R::select(at_apex, R::lit(8.0), R::lit(9.0));
    (x, R::select(on_base, number, feature))
}
