//! Lines against a model's geometry, one at a time, in double precision.

use super::kernel;
use glam::DVec3;
use model::{Geometry, Hull};
use numbers::Vec3;

/// A line in a solid's frame.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// A point of it [m]: that at t = 0.
    pub origin: DVec3,
    /// Of unit length.
    pub direction: DVec3,
}

/// The part of a line that is inside.
#[derive(Clone, Copy, Debug)]
pub struct Span {
    /// Where it enters [m], from the line's origin; −[`ENDLESS`](kernel::ENDLESS) where it always was inside.
    pub enter: f64,
    /// Where it leaves [m]; not before it enters.
    pub leave: f64,
    /// Outwards where the line enters, of any length; anything where it enters nowhere.
    pub normal: DVec3,
}

impl Span {
    fn of(span: &kernel::Span<f64>) -> Option<Self> {
        let Vec3 { x, y, z } = span.normal;
        (span.enter <= span.leave).then_some(Self {
            enter: span.enter,
            leave: span.leave,
            normal: DVec3::new(x, y, z),
        })
    }
}

/// A half space n · p ≤ h: a unit vector out of it, and its height along that [m].
pub type Face = (DVec3, f64);

/// The half spaces that a hull is all of.
pub fn faces(hull: &Hull) -> impl Iterator<Item = Face> {
    hull.faces().map(|[a, b, c]| {
        let n = (b - a).cross(c - a).normalize_or_zero();
        (n, n.dot(a))
    })
}

pub(super) fn numbers(v: DVec3) -> Vec3<f64> {
    Vec3::new(v.x, v.y, v.z)
}

/// As [`kernel::Line::capsule`], which asks no more than it must.
#[inline]
fn capsule(line: &kernel::Line<f64>, r: f64, h: f64) -> Option<kernel::Span<f64>> {
    let chord = line.chord(r);
    if chord.rest < 0.0 {
        return None;
    }
    let tube = line.along(&chord);
    let ends = [tube.enter, tube.leave].map(|t| line.at(t).y.abs());
    Some(if ends[0].max(ends[1]) <= h {
        tube
    } else {
        line.closed(&tube, r, h)
    })
}

impl Line {
    /// The same as kernels have it.
    pub(super) fn numbers(&self) -> kernel::Line<f64> {
        kernel::Line {
            origin: numbers(self.origin),
            direction: numbers(self.direction),
        }
    }

    /// The span inside a solid; surfaces count. Meshes have no inside.
    #[inline]
    pub fn within(&self, geometry: &Geometry) -> Option<Span> {
        let line = self.numbers();
        let span = match *geometry {
            Geometry::Plane { .. } => line.half_space(numbers(DVec3::Y), 0.0),
            Geometry::Sphere { radius } => line.ball(0.0, radius),
            Geometry::Ellipsoid { half } => line.ellipsoid(numbers(half)),
            Geometry::Capsule {
                radius,
                half_height,
            } => capsule(&line, radius, half_height - radius)?,
            Geometry::Cylinder {
                radius,
                half_height,
            } => line.cylinder(radius, half_height),
            Geometry::Cone {
                radius,
                half_height,
            } => line.cone(radius, half_height),
            Geometry::Box { half } => line.cuboid(numbers(half)),
            Geometry::Hull(ref hull) => return self.behind(faces(hull)),
            Geometry::Mesh(_) | Geometry::MeshFile { .. } => return None,
        };
        Span::of(&span)
    }

    /// In front of no face: n · p ≤ h for all of them.
    pub fn behind(&self, mut faces: impl Iterator<Item = Face>) -> Option<Span> {
        let line = self.numbers();
        let whole = kernel::Span::whole(true, numbers(DVec3::ZERO));
        let span = faces.try_fold(whole, |span, (n, h)| {
            let span = span.and(line.half_space(numbers(n), h));
            (span.enter <= span.leave).then_some(span)
        });
        Span::of(&span?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A capsule is all within r of a segment: spans hold the points that are, and no others.
    #[test]
    fn a_line_is_in_a_capsule_where_it_is_near_the_segment() {
        let (r, h) = (0.3, 0.5);
        let capsule = Geometry::Capsule {
            radius: r,
            half_height: h + r,
        };
        let at = |line: &Line, t: f64| line.origin + t * line.direction;
        let apart = |p: DVec3| p.distance(DVec3::Y * p.y.clamp(-h, h)) - r;
        let mut random = fastrand::Rng::with_seed(5);
        let mut point = || DVec3::from_array([0; 3].map(|_| random.f64() - 0.5));
        let (mut met, mut missed) = (0, 0);
        for i in 0..4000 {
            let mut direction = point();
            match i % 10 {
                // Along the axis, and across it.
                0 => direction = DVec3::Y,
                1 => direction.y = 0.0,
                _ => {}
            }
            let line = Line {
                origin: 1.5 * point(),
                direction: direction.normalize(),
            };
            match line.within(&capsule) {
                Some(span) => {
                    met += 1;
                    assert!(apart(at(&line, span.enter)).abs() < 1e-12);
                    assert!(apart(at(&line, span.leave)).abs() < 1e-12);
                    let middle = at(&line, 0.5 * (span.enter + span.leave));
                    assert!(span.enter <= span.leave && apart(middle) < 1e-12);
                    // The gradient of the distance.
                    let p = at(&line, span.enter);
                    let outwards = (p - DVec3::Y * p.y.clamp(-h, h)) / r;
                    assert!(span.normal.normalize().abs_diff_eq(outwards, 1e-9));
                }
                None => {
                    missed += 1;
                    let points = (-200..=200).map(|i| at(&line, 0.01 * f64::from(i)));
                    assert!(points.map(apart).fold(1.0, f64::min) > 0.0);
                }
            }
        }
        assert!(met > 1000 && missed > 300, "{met} {missed}");
    }
}
