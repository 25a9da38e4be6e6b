//! A half space against convex solids: the points of the solid that lie lowest.
//!
//! Which points these are changes with the solid's attitude as little as can be, and each has
//! its own true distance, so that a solid that rocks finds its next point already there.

use crate::outline::{SIXTEENTH, tangents};
use crate::solid::{corner_number, sign};
use crate::support::{ellipsoid as lowest_of_ellipsoid, farthest_vertex};
use crate::{FLAT, LEANING, Manifold, Placed, Point, Solid, Tables};
use numbers::machine::{Held, Hold};
use numbers::{Cell, Machine, Mask, Real, Vec3};

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

/// Plane and cylinder: on a cap four points of its rim, leaning a little the lowest point of that, the highest, and two
/// in between, leaning more the lowest point of each rim, and two at a right angle on the lower one.
#[inline(always)]
pub fn plane_cylinder<R: Real>(plane: &Placed<R>, cylinder: &Placed<R>) -> Manifold<R> {
    let down = cylinder.local_direction(-plane.axes.y);
    plane_round(plane, cylinder, down, sign(down.y), cylinder.size.x)
}

/// Plane and cone: as a cylinder that stands on its base, with the apex as the other rim.
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
    let on_cap = radial.length_squared().lt(R::lit(LEANING * LEANING)) & (down.y * cap).gt(o);
    let opposite = Vec3::select(on_cap, u.fma(-radius, end), u.fma(other, -end));
    // Standing, the four are 0 to 3. Leaning, the end at +y is 4 and the one at −y is 5, each in its own place
    // whichever is lower, the sides are 6 and 7 of the end at −y, 8 and 9 of that at +y, and what is highest on the
    // cap is 10 and 11.
    let up = cap.gt(o);
    let leans_up = !stands & up;
    let (first, third) = (
        Vec3::select(leans_up, opposite, low),
        Vec3::select(leans_up, low, opposite),
    );
    let features = [
        R::select(stands, o, R::select(on_cap & up, R::lit(11.0), R::lit(5.0))),
        R::select(stands, i, R::select(up, R::lit(8.0), R::lit(6.0))),
        R::select(
            stands,
            R::lit(2.0),
            R::select(on_cap & !up, R::lit(10.0), R::lit(4.0)),
        ),
        R::select(stands, R::lit(3.0), R::select(up, R::lit(9.0), R::lit(7.0))),
    ];
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let x = solid.point([first, left, third, right][i]);
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
/// apart by how far they lie along four directions. Where that leaves room, those beyond that are lowest where the
/// plane leans more. The feature is the vertex's number.
#[inline(always)]
pub fn plane_hull<M: Machine>(
    k: &M,
    tables: Tables,
    plane: &Placed<M::R>,
    hull: &Solid<M>,
) -> Manifold<M::R> {
    let o = M::R::zero();
    let down = hull.placed.local_direction(-plane.axes.y);
    let around = tangents(down);
    let low = vertices_around(k, tables, hull, down, around, FLAT);
    let [a, b, c, d] = low;
    let shared = a.is(b) | b.is(c) | c.is(d) | a.is(c) | b.is(d) | a.is(d);
    let mut x = [a.x.hold(k), b.x.hold(k), c.x.hold(k), d.x.hold(k)];
    let mut number = [
        k.cell(a.number),
        k.cell(b.number),
        k.cell(c.number),
        k.cell(d.number),
    ];
    if let Some(_branch) = k.if_any(shared) {
        let far = vertices_around(k, tables, hull, down, around, 2.0 * LEANING);
        let middle = (far[0].x + far[1].x + far[2].x + far[3].x) * M::R::lit(0.25);
        // Where the vertices beyond are those of the same face, its corners stay in their places. Else a vertex takes
        // that of its directions in which it is farthest.
        let mut known = <M::R as Real>::Mask::splat(true);
        let [e, f, g, h] = far;
        for vertex in low {
            known = known & (vertex.is(e) | vertex.is(f) | vertex.is(g) | vertex.is(h));
        }
        let known = known & shared;
        let [u, v] = sixteenth_on(around, 1.0);
        let along = [u, v, -u, -v];
        let mut out = [o; 4];
        for i in 0..4 {
            out[i] = along[i].dot(low[i].x - middle);
        }
        let mut stays = [!known; 4];
        for i in 0..4 {
            for j in 0..i {
                let same = low[i].is(low[j]);
                let later = out[i].gt(out[j]);
                stays[i] = stays[i] & !(same & !later);
                stays[j] = stays[j] & !(same & later);
            }
        }
        for i in 0..4 {
            let mut is_new = !stays[i];
            for vertex in low {
                is_new = is_new & (known | !far[i].is(vertex));
            }
            for j in 0..i {
                is_new = is_new & (stays[j] | !far[i].is(far[j]));
            }
            let none = M::R::lit(-1.0);
            let own = M::R::select(is_new, far[i].number, none);
            x[i].set(Vec3::select(stays[i], low[i].x, far[i].x));
            number[i].write(M::R::select(stays[i], low[i].number, own));
        }
    }
    let mut points = [Point::unused(); 4];
    for i in 0..4 {
        let number = number[i].read();
        points[i] = above(plane, hull.placed.point(x[i].get()), number).only_if(number.ge(o));
    }
    Manifold {
        normal: plane.axes.y,
        points,
    }
}

/// A vertex of a hull, in its frame, and its number.
#[derive(Clone, Copy)]
struct Vertex<R> {
    x: Vec3<R>,
    number: R,
}

impl<R: Real> Vertex<R> {
    /// Whether two are the same.
    #[inline(always)]
    fn is(self, other: Self) -> R::Mask {
        self.number.same(other.number)
    }
}

/// The farthest vertices along four directions around `down` that are turned by `lean` from it.
#[inline(always)]
fn vertices_around<M: Machine>(
    k: &M,
    tables: Tables,
    hull: &Solid<M>,
    down: Vec3<M::R>,
    around: [Vec3<M::R>; 2],
    lean: f64,
) -> [Vertex<M::R>; 4] {
    let [u, v] = sixteenth_on(around, lean);
    let (x, number) = (Vec3::zero(), M::R::zero());
    let mut found = [Vertex { x, number }; 4];
    for i in 0..4 {
        let along = down + [u, v, -u, -v][i];
        let (x, number) = farthest_vertex(k, tables, hull, along);
        found[i] = Vertex { x, number };
    }
    found
}

/// Two directions at a right angle, a sixteenth of a turn on, `length` times as long.
#[inline(always)]
fn sixteenth_on<R: Real>([u, v]: [Vec3<R>; 2], length: f64) -> [Vec3<R>; 2] {
    let (c, s) = (R::lit(length * SIXTEENTH.0), R::lit(length * SIXTEENTH.1));
    [u * c + v * s, v * c - u * s]
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
