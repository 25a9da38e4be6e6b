//! Where a line is inside a solid.
//!
//! A line p(t) = o + t d, |d| = 1, in the solid's frame, is inside a convex solid for one span of t.
//! Spans of half spaces and quadrics make those of all solids: what is in both of two is in the
//! later entry and the earlier exit. Numbers keep their digits where o is near the solid.

use glam::{DVec2, DVec3};
use model::{Geometry, Hull};

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
    /// Where it enters [m], from the line's origin; may be infinite.
    pub enter: f64,
    /// Where it leaves [m]; not before it enters.
    pub leave: f64,
    /// Outwards where the line enters, of any length; anything where it enters nowhere.
    pub normal: DVec3,
}

impl Span {
    /// What is in both.
    fn and(self, other: Self) -> Option<Self> {
        let later = if self.enter > other.enter {
            self
        } else {
            other
        };
        let leave = self.leave.min(other.leave);
        (later.enter <= leave).then_some(Self { leave, ..later })
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

/// Directions so near to an axis are along it.
const ALONG: f64 = 1e-15;

impl Line {
    /// The span inside a solid; surfaces count. Meshes have no inside.
    #[inline]
    pub fn within(&self, geometry: &Geometry) -> Option<Span> {
        match *geometry {
            Geometry::Plane { .. } => self.half_space(DVec3::Y, 0.0),
            Geometry::Sphere { radius } => self.ball(0.0, radius),
            Geometry::Ellipsoid { half } => self.ellipsoid(half),
            Geometry::Capsule {
                radius,
                half_height,
            } => self.capsule(radius, half_height - radius),
            Geometry::Cylinder {
                radius,
                half_height,
            } => self.tube(radius)?.and(self.slab(1, half_height)?),
            Geometry::Cone {
                radius,
                half_height,
            } => self.cone(radius, half_height),
            Geometry::Box { half } => {
                let across = self.slab(0, half.x)?.and(self.slab(1, half.y)?)?;
                across.and(self.slab(2, half.z)?)
            }
            Geometry::Hull(ref hull) => self.behind(faces(hull)),
            Geometry::Mesh(_) | Geometry::MeshFile { .. } => None,
        }
    }

    fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// n · p ≤ h, |n| = 1: t = (h − n · o) / (n · d), an entry where n · d < 0.
    fn half_space(&self, n: DVec3, h: f64) -> Option<Span> {
        let (gap, speed) = (h - n.dot(self.origin), n.dot(self.direction));
        let (enter, leave) = if speed < 0.0 {
            (gap / speed, f64::INFINITY)
        } else if speed > 0.0 {
            (f64::NEG_INFINITY, gap / speed)
        } else if gap >= 0.0 {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            return None;
        };
        Some(Span {
            enter,
            leave,
            normal: n,
        })
    }

    /// |pᵢ| ≤ h: t = (∓h − oᵢ) / dᵢ.
    fn slab(&self, axis: usize, h: f64) -> Option<Span> {
        let (o, d) = (self.origin[axis], self.direction[axis]);
        let (enter, leave) = if d != 0.0 {
            let reach = h.copysign(d);
            ((-reach - o) / d, (reach - o) / d)
        } else if o.abs() <= h {
            (f64::NEG_INFINITY, f64::INFINITY)
        } else {
            return None;
        };
        let normal = -d.signum() * DVec3::AXES[axis];
        Some(Span {
            enter,
            leave,
            normal,
        })
    }

    /// In front of no face: n · p ≤ h for all of them.
    pub fn behind(&self, mut faces: impl Iterator<Item = Face>) -> Option<Span> {
        let whole = Span {
            enter: f64::NEG_INFINITY,
            leave: f64::INFINITY,
            normal: DVec3::ZERO,
        };
        faces.try_fold(whole, |span, (n, h)| span.and(self.half_space(n, h)?))
    }

    /// Σ (pᵢ/aᵢ)² ≤ 1: with u = o/a and w = d/a a unit ball. Normal: the gradient pᵢ/aᵢ².
    fn ellipsoid(&self, a: DVec3) -> Option<Span> {
        let (enter, leave) = unit_ball(self.origin / a, self.direction / a)?;
        let normal = self.at(enter) / (a * a);
        Some(Span {
            enter,
            leave,
            normal,
        })
    }

    /// x² + z² ≤ r²: as a ball, in the plane across the axis.
    fn tube(&self, r: f64) -> Option<Span> {
        let (o, d) = (across(self.origin), across(self.direction));
        let dd = d.length_squared();
        if dd < ALONG * ALONG {
            return (o.length_squared() <= r * r).then_some(Span {
                enter: f64::NEG_INFINITY,
                leave: f64::INFINITY,
                normal: DVec3::new(o.x, 0.0, o.y),
            });
        }
        let middle = -o.dot(d) / dd;
        let foot = o + middle * d;
        let rest = r * r - foot.length_squared();
        if rest < 0.0 {
            return None;
        }
        let half = (rest / dd).sqrt();
        let normal = foot - half * d;
        Some(Span {
            enter: middle - half,
            leave: middle + half,
            normal: DVec3::new(normal.x, 0.0, normal.y),
        })
    }

    /// |p − c| ≤ r with c = (0, y, 0): about the foot o − c − ((o − c)·d) d, half of the chord is √(r² − foot²).
    fn ball(&self, y: f64, r: f64) -> Option<Span> {
        let o = self.origin - y * DVec3::Y;
        let middle = -o.dot(self.direction);
        let foot = o + middle * self.direction;
        let rest = r * r - foot.length_squared();
        if rest < 0.0 {
            return None;
        }
        let half = rest.sqrt();
        Some(Span {
            enter: middle - half,
            leave: middle + half,
            normal: foot - half * self.direction,
        })
    }

    /// Within r of the segment |y| ≤ h: a tube, closed by balls. Where the line enters the tube between its
    /// ends, it enters the capsule; where beyond one, it enters there by that end's ball, or not at all, for
    /// where it comes to the end inside the tube, it is inside the ball. So it leaves. Normal: from the nearest
    /// point of the segment.
    fn capsule(&self, r: f64, h: f64) -> Option<Span> {
        let tube = self.tube(r)?;
        let height = |t: f64| self.origin.y + t * self.direction.y;
        let (first, last) = (height(tube.enter), height(tube.leave));
        let entry = if first.abs() <= h {
            tube
        } else {
            self.ball(h.copysign(first), r)?
        };
        let leave = if last.abs() <= h {
            tube.leave
        } else {
            self.ball(h.copysign(last), r)?.leave
        };
        Some(Span { leave, ..entry })
    }

    /// x² + z² ≤ k² s², where s = h − y is the depth below the apex and k = r / 2h. That is
    /// a t² + 2 b t + c ≤ 0, true between the roots where a ≥ 0; where a < 0, the line goes from one
    /// half of the double cone to the other, and is in ours beyond the later root if it descends,
    /// else before the earlier. With p and v the parts of o and d across the axis and e = −d.y,
    /// b² − a c = k² |s v − e p|² − (p × v)², which keeps its digits near the apex. Normal: the
    /// gradient of √(x² + z²) + k y.
    fn cone(&self, r: f64, h: f64) -> Option<Span> {
        let k = r / (2.0 * h);
        let (p, v) = (across(self.origin), across(self.direction));
        let (s, e) = (h - self.origin.y, -self.direction.y);
        let a = v.length_squared() - (k * e).powi(2);
        let b = p.dot(v) - k * k * s * e;
        let c = p.length_squared() - (k * s).powi(2);
        let square = k * k * (s * v - e * p).length_squared() - p.perp_dot(v).powi(2);
        let (first, last) = roots(a, b, c, square)?;
        let (enter, leave) = if a >= 0.0 {
            (first, last)
        } else if e > 0.0 {
            (last, f64::INFINITY)
        } else {
            (f64::NEG_INFINITY, first)
        };
        let p = self.at(enter);
        let normal = DVec3::new(p.x, k * p.x.hypot(p.z), p.z);
        let side = Span {
            enter,
            leave,
            normal: normal.try_normalize().unwrap_or(DVec3::Y),
        };
        side.and(self.slab(1, h)?)
    }
}

/// The part across the axis y.
fn across(v: DVec3) -> DVec2 {
    DVec2::new(v.x, v.z)
}

/// |u + t w| ≤ 1: about the foot u − (u·w / w²) w, which the line passes at t = −u·w / w², half of the
/// chord is √((1 − foot²) / w²).
fn unit_ball(u: DVec3, w: DVec3) -> Option<(f64, f64)> {
    let ww = w.length_squared();
    let middle = -u.dot(w) / ww;
    let rest = 1.0 - (u + middle * w).length_squared();
    let half = (rest / ww).sqrt();
    (rest >= 0.0).then_some((middle - half, middle + half))
}

/// Roots of a t² + 2 b t + c, the lower first, without cancellation: q/a and c/q, where
/// q = −(b ± √(b² − a c)) with the sign of b; `square` is b² − a c. One is infinite where a = 0.
fn roots(a: f64, b: f64, c: f64, square: f64) -> Option<(f64, f64)> {
    if square < 0.0 && a >= 0.0 {
        return None;
    }
    let q = -(b + square.max(0.0).sqrt().copysign(b));
    if q == 0.0 {
        return (c <= 0.0).then_some((0.0, 0.0));
    }
    let (x, y) = (q / a, c / q);
    Some((x.min(y), x.max(y)))
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
                    assert!(apart(line.at(span.enter)).abs() < 1e-12);
                    assert!(apart(line.at(span.leave)).abs() < 1e-12);
                    let middle = line.at(0.5 * (span.enter + span.leave));
                    assert!(span.enter <= span.leave && apart(middle) < 1e-12);
                    // The gradient of the distance.
                    let p = line.at(span.enter);
                    let outwards = (p - DVec3::Y * p.y.clamp(-h, h)) / r;
                    assert!(span.normal.normalize().abs_diff_eq(outwards, 1e-9));
                }
                None => {
                    missed += 1;
                    let points = (-200..=200).map(|i| line.at(0.01 * f64::from(i)));
                    assert!(points.map(apart).fold(1.0, f64::min) > 0.0);
                }
            }
        }
        assert!(met > 1000 && missed > 300, "{met} {missed}");
    }
}
