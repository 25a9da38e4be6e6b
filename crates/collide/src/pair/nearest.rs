//! How far a point is from a solid's surface, and which way is out.
//!
//! In the solid's own frame. Signed: negative inside. The direction is the gradient of the
//! distance, a unit vector also where the distance has none (on an axis, in the middle).

use crate::solid::sign;
use numbers::{Real, Vec3};

/// Signed distance [m] and the unit vector out of the solid.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest<R> {
    pub distance: R,
    pub out: Vec3<R>,
}

/// The segment |y| ≤ half on the y axis, within `radius`.
#[inline(always)]
pub(crate) fn capsule<R: Real>(x: Vec3<R>, radius: R, half: R) -> Nearest<R> {
    let y = x.y.clamp(-half, half);
    let from = Vec3::new(x.x, x.y - y, x.z);
    Nearest {
        distance: from.length() - radius,
        out: from.normalized_or(axis_x()),
    }
}

/// A box. Outside the way to the nearest point of it; inside the way through the nearest face.
#[inline(always)]
pub(crate) fn cuboid<R: Real>(x: Vec3<R>, half: Vec3<R>) -> Nearest<R> {
    let (o, i) = (R::zero(), R::one());
    let q = Vec3::new(x.x.abs() - half.x, x.y.abs() - half.y, x.z.abs() - half.z);
    let side = Vec3::new(sign(x.x), sign(x.y), sign(x.z));
    let past = Vec3::new(q.x.max(o), q.y.max(o), q.z.max(o));
    let by_x = q.x.ge(q.y) & q.x.ge(q.z);
    let by_y = !by_x & q.y.ge(q.z);
    let face = Vec3::new(
        R::select(by_x, i, o),
        R::select(by_y, i, o),
        R::select(!by_x & !by_y, i, o),
    );
    let deepest = q.x.max(q.y).max(q.z);
    Nearest {
        distance: R::select(deepest.gt(o), past.length(), deepest),
        out: past.normalized_or(face).times(side),
    }
}

/// A cylinder along y: a rectangle in the half plane of (distance from the axis, y).
#[inline(always)]
pub(crate) fn cylinder<R: Real>(x: Vec3<R>, radius: R, half: R) -> Nearest<R> {
    let (rho, radial) = polar(x);
    // A box whose third faces are farther than all others.
    let rectangle = Vec3::new(radius, half, radius + half);
    let in_plane = cuboid(Vec3::new(rho, x.y, R::zero()), rectangle);
    turned(in_plane, radial)
}

/// A cone along y: a triangle in the half plane of (distance from the axis, y), with the
/// slant from the rim (r, −h) to the apex (0, h) and its normal (2h, r)/√(4h² + r²).
#[inline(always)]
pub(crate) fn cone<R: Real>(x: Vec3<R>, radius: R, half: R) -> Nearest<R> {
    let (o, i) = (R::zero(), R::one());
    let (rho, radial) = polar(x);
    let height = half + half;
    let slant = Vec3::new(-radius, height, o);
    let normal = Vec3::new(height, radius, o).normalized_or(axis_x());

    let p = Vec3::new(rho, x.y, o);
    let rim = Vec3::new(radius, -half, o);
    let from_rim = p - rim;
    let to_base = Vec3::new(rho - rho.min(radius), x.y + half, o);
    let tiny = R::lit(1e-30);
    let t = from_rim.dot(slant) / slant.length_squared().max(tiny);
    let to_slant = slant.fma(-t.clamp(o, i), from_rim);

    let (above_slant, below_base) = (normal.dot(from_rim), -half - x.y);
    let inside = above_slant.le(o) & below_base.le(o);
    let slant_first = above_slant.ge(below_base);
    let face = Vec3::select(slant_first, normal, Vec3::new(o, -i, o));
    let depth = above_slant.max(below_base);

    let base_nearer = to_base.length_squared().lt(to_slant.length_squared());
    let way = Vec3::select(base_nearer, to_base, to_slant);
    // Closer than this, the way is rounding and its direction could be any.
    let on_surface = way.length().lt((radius + half) * R::lit(1e-6));
    let in_plane = Nearest {
        distance: R::select(inside, depth, way.length()),
        out: Vec3::select(inside | on_surface, face, way.normalized_or(face)),
    };
    turned(in_plane, radial)
}

/// Distance from the y axis and the unit vector away from it.
#[inline(always)]
fn polar<R: Real>(x: Vec3<R>) -> (R, Vec3<R>) {
    let away = Vec3::new(x.x, R::zero(), x.z);
    (away.length(), away.normalized_or(axis_x()))
}

/// From the half plane of (distance from the axis, y) into space.
#[inline(always)]
fn turned<R: Real>(in_plane: Nearest<R>, radial: Vec3<R>) -> Nearest<R> {
    let Nearest { distance, out } = in_plane;
    Nearest {
        distance,
        out: radial.fma(out.x, Vec3::new(R::zero(), out.y, R::zero())),
    }
}

#[inline(always)]
fn axis_x<R: Real>() -> Vec3<R> {
    Vec3::new(R::one(), R::zero(), R::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signed distance [m] from a cylinder: of points inside from its side or an end, whichever is nearer.
    fn apart(p: Vec3<f64>, radius: f64, half: f64) -> f64 {
        let (side, end) = (p.x.hypot(p.z) - radius, p.y.abs() - half);
        side.max(0.0).hypot(end.max(0.0)) + side.max(end).min(0.0)
    }

    /// The unit vector out leads to the surface, by the distance.
    #[test]
    fn a_cylinder_is_as_far_as_its_nearest_side_or_end() {
        for (radius, half) in [(5.0, 5.0), (3.0, 0.2)] {
            for i in 0..21_i32.pow(3) {
                let [x, y, z] = [i % 21, i / 21 % 21, i / 441].map(|n| 0.15 * f64::from(n - 10));
                let p = Vec3::new(radius * x, half * y, radius * z);
                let Nearest { distance, out } = cylinder(p, radius, half);
                let near = |found: f64, expected: f64| {
                    let wrong = (found - expected).abs();
                    assert!(
                        wrong < 1e-12,
                        "{p:?} of {radius} m, {half} m: {found}, not {expected}"
                    );
                };
                near(distance, apart(p, radius, half));
                near(out.length(), 1.0);
                near(apart(p - out * distance, radius, half), 0.0);
            }
        }
    }
}
