//! The point of a solid that lies farthest in a direction.
//!
//! Of spheres and capsules the *core* is taken, a point and a segment, around which they have a
//! [`radius`]: distances between cores are exact, and rounding them off costs nothing.

use crate::solid::{kind, sign};
use crate::{Solid, Tables};
use numbers::machine::{Held, Hold};
use numbers::{Cell, Machine, Real, Vec3};

/// What surrounds the core of a solid [m].
#[inline(always)]
pub(crate) fn radius<M: Machine>(k: &M, solid: &Solid<M>) -> M::R {
    let mut r = k.cell(M::R::zero());
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::SPHERE)) {
        r.write(solid.placed.size.x);
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CAPSULE)) {
        r.write(solid.placed.size.x);
    }
    r.read()
}

/// The farthest point of a solid's core along `d`, from the solid's centre, in world axes.
#[inline(always)]
pub(crate) fn support<M: Machine>(
    k: &M,
    tables: Tables,
    solid: &Solid<M>,
    d: Vec3<M::R>,
) -> Vec3<M::R> {
    let (placed, size) = (&solid.placed, solid.placed.size);
    let d = placed.local_direction(d);
    let mut x = Vec3::zero().hold(k);
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CAPSULE)) {
        x.set(capsule(placed.half_segment(), d));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CYLINDER)) {
        x.set(rim(size.x, sign(d.y) * size.y, d));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::CONE)) {
        x.set(cone(size.x, size.y, d));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::BOX)) {
        x.set(cuboid(size, d));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::ELLIPSOID)) {
        x.set(ellipsoid(size, d));
    }
    if let Some(_branch) = k.when(k.equals(solid.kind, kind::HULL)) {
        x.set(farthest_vertex(k, tables, solid, d).0);
    }
    placed.direction(x.get())
}

/// The farthest vertex of a hull along `d`, in its frame, and its number in the hull.
#[inline(always)]
pub(crate) fn farthest_vertex<M: Machine>(
    k: &M,
    tables: Tables,
    hull: &Solid<M>,
    d: Vec3<M::R>,
) -> (Vec3<M::R>, M::R) {
    let mut x = Vec3::zero().hold(k);
    let mut number = k.cell(M::R::zero());
    let mut most = k.cell(M::R::lit(-crate::FAR));
    let mut count = k.cell(M::R::zero());
    for row in k.range(hull.rows[0], hull.rows[1]) {
        let vertex = k.vec3(tables.vertices, row, 0);
        let reach = vertex.dot(d);
        let more = reach.gt(most.read());
        x.set(Vec3::select(more, vertex, x.get()));
        number.write(M::R::select(more, count.read(), number.read()));
        most.write(M::R::select(more, reach, most.read()));
        count.write(count.read() + M::R::one());
    }
    (x.get(), number.read())
}

/// An end of the segment |y| ≤ half.
#[inline(always)]
fn capsule<R: Real>(half: R, d: Vec3<R>) -> Vec3<R> {
    Vec3::new(R::zero(), sign(d.y) * half, R::zero())
}

/// The point of a circle about the y axis at the height `y`.
#[inline(always)]
pub(crate) fn rim<R: Real>(radius: R, y: R, d: Vec3<R>) -> Vec3<R> {
    let (o, i) = (R::zero(), R::one());
    let away = Vec3::new(d.x, o, d.z).normalized_or(Vec3::new(i, o, o));
    away.fma(radius, Vec3::new(o, y, o))
}

/// The apex or a point of the base's rim.
#[inline(always)]
pub(crate) fn cone<R: Real>(radius: R, half: R, d: Vec3<R>) -> Vec3<R> {
    let apex = Vec3::new(R::zero(), half, R::zero());
    let rim = rim(radius, -half, d);
    Vec3::select(apex.dot(d).gt(rim.dot(d)), apex, rim)
}

/// A corner.
#[inline(always)]
fn cuboid<R: Real>(half: Vec3<R>, d: Vec3<R>) -> Vec3<R> {
    half.times(Vec3::new(sign(d.x), sign(d.y), sign(d.z)))
}

/// Of an ellipsoid: x = S² d / |S d| with S = diag(a, b, c), where its gradient is along d.
#[inline(always)]
pub(crate) fn ellipsoid<R: Real>(half: Vec3<R>, d: Vec3<R>) -> Vec3<R> {
    let scaled = half.times(d);
    half.times(scaled.normalized_or(Vec3::zero()))
}
