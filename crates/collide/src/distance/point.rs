//! How far a point is outside of a solid, negative inside.

use super::{Convex, Corners, Outside, between, from_kernels, nearest_on_triangle, to_kernels};
use crate::pair::nearest::{self, Nearest};
use crate::{kind, ray};
use glam::DVec3;
use model::Hull;
use numbers::dispatch::Isa;

/// How far a point [m] is outside of a solid's surface, and which way is out there.
pub fn outside(isa: Isa, solid: &Convex<'_>, point: DVec3) -> Outside {
    match solid.corners {
        Corners::Triangle(arms) => beside(arms, point - solid.center()),
        Corners::Hull(hull) => match behind(hull, local(solid, point) + hull.center()) {
            Some(inside) => turned(solid, inside),
            None => {
                let way = between(isa, solid, &Convex::point(point));
                Outside {
                    distance: way.distance,
                    normal: way.normal,
                }
            }
        },
        Corners::None => turned(solid, of_kind(solid, local(solid, point))),
    }
}

/// A point of the world, in the solid's frame.
fn local(solid: &Convex<'_>, point: DVec3) -> DVec3 {
    from_kernels(solid.placed.local_point(to_kernels(point)))
}

/// From the solid's frame into the world.
fn turned(solid: &Convex<'_>, found: Outside) -> Outside {
    let normal = solid.placed.direction(to_kernels(found.normal));
    Outside {
        normal: from_kernels(normal),
        ..found
    }
}

/// Of solids without corners, in their own frame.
fn of_kind(solid: &Convex<'_>, x: DVec3) -> Outside {
    let (size, p) = (solid.placed.size, to_kernels(x));
    let Nearest { distance, out } = match solid.kind {
        kind::PLANE => return along(x.y, DVec3::Y),
        kind::SPHERE => return along(x.length() - size.x, x.try_normalize().unwrap_or(DVec3::Y)),
        kind::ELLIPSOID => return ellipsoid(from_kernels(size), x),
        kind::CAPSULE => nearest::capsule(p, size.x, solid.placed.half_segment()),
        kind::CYLINDER => nearest::cylinder(p, size.x, size.y),
        kind::CONE => nearest::cone(p, size.x, size.y),
        _ => nearest::cuboid(p, size),
    };
    along(distance, from_kernels(out))
}

fn along(distance: f64, normal: DVec3) -> Outside {
    Outside { distance, normal }
}

/// Closer to a triangle than this share of its size, the way from it is rounding.
const ON: f64 = 1e-12;

/// Of a triangle: the way from its nearest point; on it, its normal.
fn beside(corners: [DVec3; 3], x: DVec3) -> Outside {
    let (on, _) = nearest_on_triangle(corners, x);
    let [a, b, c] = corners;
    let distance = x.distance(on);
    let normal = if distance > ON * a.length().max(b.length()).max(c.length()) {
        (x - on) / distance
    } else {
        (b - a).cross(c - a).normalize()
    };
    along(distance, normal)
}

/// Where a point is behind all faces of a hull: the way to the nearest of them.
fn behind(hull: &Hull, x: DVec3) -> Option<Outside> {
    let faces = ray::faces(hull).filter(|(n, _)| *n != DVec3::ZERO);
    let heights = faces.map(|(n, h)| along(n.dot(x) - h, n));
    let higher = |a: Outside, b: Outside| if b.distance > a.distance { b } else { a };
    heights.reduce(higher).filter(|top| top.distance <= 0.0)
}

/// Rounds to the root; each but the first few doubles the digits.
const ROUNDS: usize = 100;
/// How near to the plane across the shortest axis a point is taken to be at least, against that axis: too
/// little to be seen, and enough to tell one of the two nearest points of the plane's own.
const OFF: f64 = 1e-20;

/// Of an ellipsoid Σ (yᵢ/aᵢ)² = 1.
///
/// Eberly, Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid (2013): x − y is along
/// the normal, x = y + t y/a², so yᵢ = aᵢ² xᵢ/(t + aᵢ²), where t > −m², m the shortest half axis, is the one root of
/// ```text
/// F(s) = Σ (aᵢ xᵢ/(s + aᵢ² − m²))² − 1,     s = t + m² > 0.
/// ```
/// F falls and is convex, so Newton's steps from where one term alone is 1, which is before the root, come to it from
/// that side. Counted from its end at −m², s keeps its digits.
fn ellipsoid(a: DVec3, x: DVec3) -> Outside {
    let (m, axis) = (a.min_element(), a.min_position());
    let mut p = x.abs();
    p[axis] = p[axis].max(OFF * m);
    let above = a * a - m * m;
    let mut s = (a * p - above).max_element();
    for _ in 0..ROUNDS {
        let (y, reach) = (a * p / (above + s), above + s);
        let (f, slope) = (
            y.length_squared() - 1.0,
            -2.0 * (y * y / reach).element_sum(),
        );
        let step = -f / slope;
        s += step;
        if step <= 1e-16 * s {
            break;
        }
    }
    let normal = (p / (above + s)).normalize();
    let on = a * a * p / (above + s);
    let sign = x.map(|c| 1f64.copysign(c));
    along((p - on).dot(normal), normal * sign)
}
