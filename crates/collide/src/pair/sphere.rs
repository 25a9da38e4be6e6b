//! A sphere against solids that know the way out of themselves: one point.

use super::nearest::{self, Nearest};
use crate::{Manifold, Placed, Point};
use numbers::{Real, Vec3};

/// Two spheres, along the line of their centres; along y where those coincide.
#[inline(always)]
pub fn sphere_sphere<R: Real>(a: &Placed<R>, b: &Placed<R>) -> Manifold<R> {
    let way = b.position - a.position;
    let normal = way.normalized_or(Vec3::new(R::zero(), R::one(), R::zero()));
    let distance = way.length() - a.size.x - b.size.x;
    let on_a = normal.fma(a.size.x, a.position);
    Manifold::single(normal, Point::from_a(on_a, normal, distance, R::zero()))
}

/// Sphere and capsule.
#[inline(always)]
pub fn sphere_capsule<R: Real>(sphere: &Placed<R>, capsule: &Placed<R>) -> Manifold<R> {
    let x = capsule.local_point(sphere.position);
    let nearest = nearest::capsule(x, capsule.size.x, capsule.half_segment());
    touch(sphere, capsule, nearest)
}

/// Sphere and cylinder.
#[inline(always)]
pub fn sphere_cylinder<R: Real>(sphere: &Placed<R>, cylinder: &Placed<R>) -> Manifold<R> {
    let x = cylinder.local_point(sphere.position);
    let nearest = nearest::cylinder(x, cylinder.size.x, cylinder.size.y);
    touch(sphere, cylinder, nearest)
}

/// Sphere and cone.
#[inline(always)]
pub fn sphere_cone<R: Real>(sphere: &Placed<R>, cone: &Placed<R>) -> Manifold<R> {
    let x = cone.local_point(sphere.position);
    touch(sphere, cone, nearest::cone(x, cone.size.x, cone.size.y))
}

/// Sphere and box.
#[inline(always)]
pub fn sphere_box<R: Real>(sphere: &Placed<R>, cuboid: &Placed<R>) -> Manifold<R> {
    let x = cuboid.local_point(sphere.position);
    touch(sphere, cuboid, nearest::cuboid(x, cuboid.size))
}

#[inline(always)]
fn touch<R: Real>(sphere: &Placed<R>, solid: &Placed<R>, nearest: Nearest<R>) -> Manifold<R> {
    let radius = sphere.size.x;
    let normal = -solid.direction(nearest.out);
    let on_sphere = normal.fma(radius, sphere.position);
    let distance = nearest.distance - radius;
    Manifold::single(
        normal,
        Point::from_a(on_sphere, normal, distance, R::zero()),
    )
}
