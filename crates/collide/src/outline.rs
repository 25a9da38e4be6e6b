//! The part of a solid's surface that faces a direction: a face, an edge or a corner.

use crate::solid::{corner_number, kind, sign};
use crate::support::{cone, ellipsoid, farthest_vertex, rim, support};
use crate::tables::CORNERS;
use crate::{FLAT, Placed, Solid, Tables};
use numbers::machine::space::Scratch;
use numbers::machine::{Held, Hold, Index};
use numbers::{Cell, Machine, Mat3, Real, Table, Vec3};

/// Cosine and sine of an eighth of a turn.
const EIGHTH: (f64, f64) = (
    core::f64::consts::FRAC_1_SQRT_2,
    core::f64::consts::FRAC_1_SQRT_2,
);
/// Cosine and sine of a sixteenth of a turn: from there, no direction is at a right angle to an axis.
pub(crate) const SIXTEENTH: (f64, f64) = (0.923_879_532_511_286_7, 0.382_683_432_365_089_8);

/// By how much the corners of a face that leans may be off its plane, against its length.
const PLANE: f64 = 1e-4;
/// Cosine of an angle that one of eight directions is always within, though they be seen at a slant.
const NEXT: f64 = 0.92;

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

/// How a solid is looked at.
pub(crate) struct View<R> {
    /// Out of the solid, towards the other one.
    pub out: Vec3<R>,
    /// The solid's centre, from A's [m].
    pub center: Vec3<R>,
    /// From the contact's frame, whose z axis is its normal.
    pub frame: Mat3<R>,
    /// By what angle a face or an edge may lean and still face the other solid whole [rad]; at least [`FLAT`].
    pub leaning: f64,
}

impl<R: Real> View<R> {
    /// A place within the solid, in the contact's frame.
    #[inline(always)]
    fn place(&self, placed: &Placed<R>, x: Vec3<R>) -> Vec3<R> {
        self.frame.transpose_mul(placed.direction(x) + self.center)
    }
}

/// Writes the outline of what faces the other solid into eight rows from `first` on, and the first of them
/// once more; answers the plane that it lies in.
///
/// Corner j is the farthest outwards where directions within the view's angle count as one, and among
/// those the farthest along the j-th of eight directions around. So corners run once around
/// the outline, however many of them coincide. All is seen from A's centre.
#[inline(always)]
pub(crate) fn outline<M: Machine>(
    k: &mut M,
    tables: Tables,
    solid: &Solid<M>,
    view: &View<M::R>,
    first: M::I,
) -> Height<M::R> {
    let n = solid.placed.local_direction(view.out);
    let [u, v] = tangents(n);
    let mut cosine = k.cell(M::R::lit(SIXTEENTH.0));
    let mut sine = k.cell(M::R::lit(SIXTEENTH.1));
    let mut number = k.cell(M::R::zero());
    for j in k.count(8) {
        let (c, s) = (cosine.read(), sine.read());
        let t = u.fma(c, v * s);
        let facing = Facing {
            n,
            t,
            leaning: view.leaning,
        };
        let (x, feature) = facing_corner(k, tables, solid, &facing, number.read());
        let x = view.place(&solid.placed, x);
        let away = view.frame.transpose_mul(solid.placed.direction(t));
        let row = [x.x, x.y, x.z, away.x, away.y, feature];
        k.write(tables.corners, first.plus(j), 0, row);
        let (c8, s8) = (M::R::lit(EIGHTH.0), M::R::lit(EIGHTH.1));
        cosine.write(c.fma(c8, -(s * s8)));
        sine.write(c.fma(s8, s * c8));
        number.write(number.read() + M::R::one());
    }
    let again: [M::R; CORNERS] = k.read(tables.corners, first, 0);
    k.write(tables.corners, first.offset(8), 0, again);
    let touching = support(k, tables, solid, view.out) + view.center;
    let fit = plane(k, tables.corners, first, view.frame.transpose_mul(touching));
    let mut slope_x = k.cell(fit.height.slope_x);
    let mut slope_y = k.cell(fit.height.slope_y);
    let mut zero = k.cell(fit.height.zero);
    if view.leaning > FLAT
        && let Some(_branch) = k.when(k.equals(solid.kind, kind::HULL))
    {
        let is_open = !fit.is_face;
        if let Some(_branch) = k.if_any(is_open) {
            let (height, leans) = leaning_face(k, tables, solid, view, first, is_open);
            slope_x.write(M::R::select(leans, height.slope_x, slope_x.read()));
            slope_y.write(M::R::select(leans, height.slope_y, slope_y.read()));
            zero.write(M::R::select(leans, height.zero, zero.read()));
        }
    }
    Height {
        slope_x: slope_x.read(),
        slope_y: slope_y.read(),
        zero: zero.read(),
    }
}

/// Replaces the outline of a hull by that of the face or edge about the point that touches, though it leans, in those
/// lanes of `is_open` where what is around that point is flat; answers the plane that it lies in, and these lanes.
///
/// Its corners are written in place of the candidates first, which come later.
#[inline(always)]
fn leaning_face<M: Machine>(
    k: &mut M,
    tables: Tables,
    hull: &Solid<M>,
    view: &View<M::R>,
    first: M::I,
    is_open: <M::R as Real>::Mask,
) -> (Height<M::R>, <M::R as Real>::Mask) {
    let (placed, row, o) = (&hull.placed, k.index(0), M::R::zero());
    let n = placed.local_direction(view.out);
    for j in k.count(8) {
        let [x, y] = k.read(tables.corners, first.plus(j), 3);
        let t = placed.local_direction(view.frame.x * x + view.frame.y * y);
        let along = t.fma(M::R::lit(2.0 * view.leaning), n);
        let (x, number) = farthest_vertex(k, tables, hull, along);
        let x = view.place(placed, x);
        k.write(tables.candidates, j, 0, [x.x, x.y, x.z, number]);
    }
    let again: [M::R; 4] = k.read(tables.candidates, row, 0);
    k.write(tables.candidates, row.offset(8), 0, again);
    let (x, number) = farthest_vertex(k, tables, hull, n);
    let touching = view.place(placed, x);
    let Fit { height, length, .. } = plane(k, tables.candidates, row, touching);
    let mut off = k.cell(o);
    for j in k.count(8) {
        let x = k.vec3(tables.candidates, j, 0);
        off.write(off.read().max((x.z - height.at(x.x, x.y)).abs()));
    }
    let leans = is_open & off.read().le(length * M::R::lit(PLANE));
    // The point that touches is the corner in its direction: where the plane comes closest to the other solid.
    let towards = sign(view.out.dot(view.frame.z));
    let (up_x, up_y) = (height.slope_x * towards, height.slope_y * towards);
    let least = up_x.fma(up_x, up_y * up_y) * M::R::lit(NEXT * NEXT);
    for j in k.count(8) {
        let [x, y, z, own]: [M::R; 4] = k.read(tables.candidates, j, 0);
        let [away_x, away_y] = k.read(tables.corners, first.plus(j), 3);
        let along = up_x.fma(away_x, up_y * away_y);
        let next = along.gt(o) & (along * along).ge(least);
        let x = Vec3::select(next, touching, Vec3::new(x, y, z));
        let own = M::R::select(next, number, own);
        for (field, x) in [(0, x.x), (1, x.y), (2, x.z), (5, own)] {
            k.store_where(leans, tables.corners, first.plus(j), field, x);
        }
    }
    let again: [M::R; CORNERS] = k.read(tables.corners, first, 0);
    k.write(tables.corners, first.offset(8), 0, again);
    (height, leans)
}

/// How a plane fits an outline.
struct Fit<R: Real> {
    height: Height<R>,
    /// Whether the outline has an area.
    is_face: R::Mask,
    /// From the first corner to the farthest [m].
    length: R,
}

/// The plane through a point that fits an outline: across its area, or along its length if it is
/// an edge, or at a right angle to the normal if it is a corner.
///
/// The area vector is half of Σ pⱼ × pⱼ₊₁ (Newell), with p from the first corner.
#[inline(always)]
fn plane<M: Machine, const W: usize>(
    k: &M,
    corners: Table<Scratch, W>,
    first: M::I,
    through: Vec3<M::R>,
) -> Fit<M::R> {
    let (o, i) = (M::R::zero(), M::R::one());
    let origin = k.vec3(corners, first, 0);
    let mut area = Vec3::zero().hold(k);
    let mut length = Vec3::zero().hold(k);
    for j in k.count(8) {
        let here = k.vec3(corners, first.plus(j), 0) - origin;
        let next = k.vec3(corners, first.plus(j).offset(1), 0) - origin;
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
    Fit {
        height: Height {
            slope_x,
            slope_y,
            zero: through.z - slope_x * through.x - slope_y * through.y,
        },
        is_face,
        length: length2.sqrt(),
    }
}

/// Where a corner of the outline is looked for, in the solid's frame.
struct Facing<R> {
    /// Towards the other solid.
    n: Vec3<R>,
    /// Around that.
    t: Vec3<R>,
    /// By what angle a face or an edge may lean [rad].
    leaning: f64,
}

impl<R: Real> Facing<R> {
    /// The sign of a component of `n`, or where that is close to zero, of `t`.
    #[inline(always)]
    fn side(&self, n: R, t: R) -> R {
        sign(R::select(n.abs().lt(R::lit(self.leaning)), t, n))
    }
}

/// One corner of the outline, in the solid's frame, and its number.
#[inline(always)]
fn facing_corner<M: Machine>(
    k: &M,
    tables: Tables,
    solid: &Solid<M>,
    facing: &Facing<M::R>,
    number: M::R,
) -> (Vec3<M::R>, M::R) {
    let (size, n, t) = (solid.placed.size, facing.n, facing.t);
    let mut x = Vec3::zero().hold(k);
    let mut feature = k.cell(M::R::zero());
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CAPSULE)) {
        let end = facing.side(n.y, t.y);
        x.set(Vec3::new(
            M::R::zero(),
            end * solid.placed.half_segment(),
            M::R::zero(),
        ));
        feature.write(end + M::R::one());
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CYLINDER)) {
        let (corner, feature_of) = cylinder_corner(size, facing, number);
        x.set(corner);
        feature.write(feature_of);
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CONE)) {
        let (corner, feature_of) = cone_corner(size, facing, number);
        x.set(corner);
        feature.write(feature_of);
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::BOX)) {
        let side = Vec3::new(
            facing.side(n.x, t.x),
            facing.side(n.y, t.y),
            facing.side(n.z, t.z),
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

/// The way from the axis to a point of a rim: along `t`, or where `out` leans and is next to that, along `out`, so that
/// the lowest point is one of those around.
#[inline(always)]
fn around<R: Real>(out: Vec3<R>, t: Vec3<R>) -> Vec3<R> {
    let o = R::zero();
    let (out, t) = (Vec3::new(out.x, o, out.z), Vec3::new(t.x, o, t.z));
    let along = out.dot(t);
    let (out2, t2) = (out.length_squared(), t.length_squared());
    let next = along.gt(o) & (along * along).ge(R::lit(NEXT * NEXT) * out2 * t2);
    let leans = out2.ge(R::lit(FLAT * FLAT));
    Vec3::select(leans & next, out, t)
}

/// A rim on a cap, two ends along a side, or a point of a rim.
#[inline(always)]
fn cylinder_corner<R: Real>(size: Vec3<R>, facing: &Facing<R>, number: R) -> (Vec3<R>, R) {
    let (n, t, leaning) = (facing.n, facing.t, R::lit(facing.leaning));
    let o = R::zero();
    let on_cap = Vec3::new(n.x, o, n.z)
        .length_squared()
        .lt(leaning * leaning);
    let on_side = n.y.abs().lt(leaning);
    let end = sign(R::select(on_side, t.y, n.y));
    let x = rim(size.x, end * size.y, Vec3::select(on_cap, around(n, t), n));
    let feature = R::select(on_cap, number, R::select(on_side, R::lit(8.0), R::lit(9.0)));
    // The two ends are sixteen apart.
    (x, end.fma(R::lit(8.0), feature + R::lit(8.0)))
}

/// The rim of the base, base and apex along the slant, a point of the rim, or the apex.
#[inline(always)]
fn cone_corner<R: Real>(size: Vec3<R>, facing: &Facing<R>, number: R) -> (Vec3<R>, R) {
    let (n, t, leaning) = (facing.n, facing.t, R::lit(facing.leaning));
    let (o, i) = (R::zero(), R::one());
    let (radius, half) = (size.x, size.y);
    let radial = Vec3::new(n.x, o, n.z);
    let rho = radial.length();
    let on_base = rho.lt(leaning) & n.y.lt(o);
    let out = radial.normalized_or(Vec3::new(i, o, o));
    let slant = Vec3::new(-(out.x * radius), half + half, -(out.z * radius));
    let lean = n.dot(slant) / slant.length();
    let on_slant = lean.abs().lt(leaning) & n.y.gt(-i + R::lit(FLAT)) & rho.gt(o);
    let apex = Vec3::new(o, half, o);
    let by_slant = Vec3::select(t.dot(slant).gt(o), apex, rim(radius, -half, n));
    let x = Vec3::select(on_slant, by_slant, cone(radius, half, n));
    let x = Vec3::select(on_base, rim(radius, -half, around(n, t)), x);
    let at_apex = x.y.gt(o);
    let feature = R::select(at_apex, R::lit(8.0), R::lit(9.0));
    (x, R::select(on_base, number, feature))
}
