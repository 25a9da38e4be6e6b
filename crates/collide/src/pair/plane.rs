//! A half space against convex solids: the points of the solid that lie lowest.
//!
//! Which points these are changes with the solid's attitude as little as can be, and each has
//! its own true distance, so that a solid that rocks finds its next point already there.

use crate::outline::{SIXTEENTH, tangents};
use crate::solid::{corner_number, sign};
use crate::support::{ellipsoid as lowest_of_ellipsoid, farthest_vertex};
use crate::{FLAT, Manifold, Placed, Point, Solid, Tables};
use numbers::{Machine, Real, Vec3};

/// Plane and sphere: one point.
#[inline(always)]
pub fn plane_sphere<R: Real>(plane: &Placed<R>, sphere: &Placed<R>) -> Manifold<R> {
    let lowest = below(plane, sphere.position, sphere.size.x, 0);
    Manifold::single(plane.axes.y, lowest)
}

/// Plane and capsule: a point below each end; features 0 at +y and 1 at −y.
#[inline(always)]
pub fn plane_capsule<R: Real>(plane: &Placed<R>, capsule: &Placed<R>) -> Manifold<R> {
    let arm = capsule.axes.y * capsule.half_segment();
    let radius = capsule.size.x;
    Manifold::double(
        plane.axes.y,
        below(plane, capsule.position + arm, radius, 0),
        below(plane, capsule.position - arm, radius, 1),
    )
}

/// Plane and box: the corners of the face that looks down most; the feature is the corner's
/// number, with one binary digit for each axis along which it lies on the positive side.
#[inline(always)]
pub fn plane_box<R: Real>(plane: &Placed<R>, cuboid: &Placed<R>) -> Manifold<R> {
    let down = cuboid.local_direction(-plane.axes.y);
    let (x, y, z) = (down.x.abs(), down.y.abs(), down.z.abs());
    let along_x = x.ge(y) & x.ge(z);
    let along_y = !along_x & y.ge(z);
    let along_z = !along_x & !along_y;
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let (u, v) = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)][i];
        let (u, v) = (R::lit(u), R::lit(v));
        let side = Vec3::new(
            R::select(along_x, sign(down.x), u),
            R::select(along_y, sign(down.y), R::select(along_x, u, v)),
            R::select(along_z, sign(down.z), v),
        );
        let at = cuboid.point(cuboid.size.times(side));
        points[i] = above(plane, at, corner_number(side));
    }
    Manifold {
        normal: plane.axes.y,
        points,
    }
}

/// Plane and cylinder: on a cap four points of its rim, else the lowest point of each rim and
/// two points at a right angle on the lower one.
#[inline(always)]
pub fn plane_cylinder<R: Real>(plane: &Placed<R>, cylinder: &Placed<R>) -> Manifold<R> {
    let down = cylinder.local_direction(-plane.axes.y);
    plane_round(plane, cylinder, down, sign(down.y), cylinder.size.x)
}

/// Plane and cone: on its base four points of the rim, else the lowest point of the rim, two at a
/// right angle to it, and the apex.
#[inline(always)]
pub fn plane_cone<R: Real>(plane: &Placed<R>, cone: &Placed<R>) -> Manifold<R> {
    let down = cone.local_direction(-plane.axes.y);
    plane_round(plane, cone, down, -R::one(), R::zero())
}

/// A solid of revolution with a cap of its radius at the end `cap` (±1) and of radius `other` at
/// the other; `down` is in its frame.
#[inline(always)]
fn plane_round<R: Real>(
    plane: &Placed<R>,
    solid: &Placed<R>,
    down: Vec3<R>,
    cap: R,
    other: R,
) -> Manifold<R> {
    let (o, i) = (R::zero(), R::one());
    let radial = Vec3::new(down.x, o, down.z);
    let stands = radial.length_squared().lt(R::lit(FLAT * FLAT)) & (down.y * cap).gt(o);
    let u = radial.normalized_or(Vec3::new(i, o, o));
    let u = Vec3::select(stands, Vec3::new(i, o, o), u);
    let v = Vec3::new(-u.z, o, u.x);

    let (radius, end) = (solid.size.x, Vec3::new(o, cap * solid.size.y, o));
    let (low, left, right) = (u.fma(radius, end), v.fma(radius, end), v.fma(-radius, end));
    let opposite = Vec3::select(stands, u.fma(-radius, end), u.fma(other, -end));
    // On its cap, the four are 0 to 3. Leaning, the end at +y is 4 and the one at −y is 5,
    // whichever is lower, and the sides are 6 and 7.
    let cap_is_up = cap.gt(o);
    let low_end = R::select(cap_is_up, R::lit(4.0), R::lit(5.0));
    let features = [
        R::select(stands, o, low_end),
        R::select(stands, i, R::lit(6.0)),
        R::select(stands, R::lit(2.0), R::lit(9.0) - low_end),
        R::select(stands, R::lit(3.0), R::lit(7.0)),
    ];
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let x = solid.point([low, left, opposite, right][i]);
        points[i] = above(plane, x, features[i]);
    }
    Manifold {
        normal: plane.axes.y,
        points,
    }
}

/// Plane and ellipsoid: the lowest point, where the gradient of x²/a² + y²/b² + z²/c² points down:
/// x = S² d / |S d| with S = diag(a, b, c).
#[inline(always)]
pub fn plane_ellipsoid<R: Real>(plane: &Placed<R>, ellipsoid: &Placed<R>) -> Manifold<R> {
    let down = ellipsoid.local_direction(-plane.axes.y);
    let lowest = lowest_of_ellipsoid(ellipsoid.size, down);
    let point = above(plane, ellipsoid.point(lowest), R::zero());
    Manifold::single(plane.axes.y, point)
}

/// Plane and convex hull: the lowest vertices, where those within [`FLAT`] of one height are told
/// apart by how far they lie along four directions. The feature is the vertex's number.
#[inline(always)]
pub fn plane_hull<M: Machine>(
    k: &M,
    tables: Tables,
    plane: &Placed<M::R>,
    hull: &Solid<M>,
) -> Manifold<M::R> {
    let down = hull.placed.local_direction(-plane.axes.y);
    let [u, v] = tangents(down);
    let (c, s) = (M::R::lit(FLAT * SIXTEENTH.0), M::R::lit(FLAT * SIXTEENTH.1));
    let (u, v) = (u * c + v * s, v * c - u * s);
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let along = down + [u, v, -u, -v][i];
        let (vertex, number) = farthest_vertex(k, tables, hull, along);
        points[i] = above(plane, hull.placed.point(vertex), number);
    }
    let [a, b, c, d] = points;
    let (ab, bc, cd) = (
        a.feature.same(b.feature),
        b.feature.same(c.feature),
        c.feature.same(d.feature),
    );
    let (ac, bd, ad) = (
        a.feature.same(c.feature),
        b.feature.same(d.feature),
        a.feature.same(d.feature),
    );
    Manifold {
        normal: plane.axes.y,
        points: [
            a,
            b.only_if(!ab),
            c.only_if(!ac & !bc),
            d.only_if(!ad & !bd & !cd),
        ],
    }
}

/// Contact of the plane with the lowest point of a ball.
#[inline(always)]
fn below<R: Real>(plane: &Placed<R>, center: Vec3<R>, radius: R, feature: usize) -> Point<R> {
    let lowest = plane.axes.y.fma(-radius, center);
    above(plane, lowest, R::lit(feature as f64))
}

/// Contact of the plane with a point of the other solid's surface.
#[inline(always)]
pub(crate) fn above<R: Real>(plane: &Placed<R>, x: Vec3<R>, feature: R) -> Point<R> {
    let distance = plane.axes.y.dot(x - plane.position);
    Point::from_b(x, plane.axes.y, distance, feature)
}
