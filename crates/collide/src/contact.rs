//! Where two solids touch, or are about to.

use numbers::{Real, Vec3};

/// Distance [m] of a point that does not exist: lanes with fewer points are simply far apart.
pub const FAR: f64 = 1e9;

/// One point of contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<R> {
    /// Midway between the two surfaces [m], in world axes.
    pub position: Vec3<R>,
    /// Unit vector from A to B.
    pub normal: Vec3<R>,
    /// Gap between the surfaces along the normal [m]; negative where they overlap.
    pub distance: R,
    /// What touches what: a whole number, the same from step to step while the same features touch.
    pub feature: R,
}

/// One point of a [`Manifold`], whose normal it shares; fields as in [`Contact`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)]
pub struct Point<R> {
    pub position: Vec3<R>,
    pub distance: R,
    pub feature: R,
}

impl<R: Real> Point<R> {
    /// The point midway between `on_a`, on A's surface, and B's surface beyond `distance` along `normal`.
    #[inline(always)]
    pub fn from_a(on_a: Vec3<R>, normal: Vec3<R>, distance: R, feature: R) -> Self {
        Self {
            position: normal.fma(distance * R::lit(0.5), on_a),
            distance,
            feature,
        }
    }
    /// The point midway between `on_b`, on B's surface, and A's surface, `distance` against `normal`.
    #[inline(always)]
    pub fn from_b(on_b: Vec3<R>, normal: Vec3<R>, distance: R, feature: R) -> Self {
        Self::from_a(on_b, -normal, distance, feature)
    }
    /// A point that does not exist: finite numbers, [`FAR`] apart.
    #[inline(always)]
    pub fn unused() -> Self {
        Self {
            position: Vec3::zero(),
            distance: R::lit(FAR),
            feature: R::zero(),
        }
    }
    /// `self` where the mask holds, else a point that does not exist.
    #[inline(always)]
    pub fn only_if(self, mask: R::Mask) -> Self {
        Self::select(mask, self, Self::unused())
    }
    /// `yes` where the mask holds, else `no`.
    #[inline(always)]
    pub fn select(mask: R::Mask, yes: Self, no: Self) -> Self {
        Self {
            position: Vec3::select(mask, yes.position, no.position),
            distance: R::select(mask, yes.distance, no.distance),
            feature: R::select(mask, yes.feature, no.feature),
        }
    }
}

/// Up to four points of contact with one normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manifold<R> {
    /// Unit vector from A to B.
    pub normal: Vec3<R>,
    /// The points, in no particular order; those not used are [`FAR`] apart.
    pub points: [Point<R>; 4],
}

impl<R: Real> Manifold<R> {
    /// One point.
    #[inline(always)]
    pub fn single(normal: Vec3<R>, point: Point<R>) -> Self {
        let unused = Point::unused();
        Self {
            normal,
            points: [point, unused, unused, unused],
        }
    }
    /// Two points.
    #[inline(always)]
    pub fn double(normal: Vec3<R>, first: Point<R>, second: Point<R>) -> Self {
        let unused = Point::unused();
        Self {
            normal,
            points: [first, second, unused, unused],
        }
    }
    /// The same contact, seen with A and B exchanged.
    #[inline(always)]
    pub fn swapped(self) -> Self {
        Self {
            normal: -self.normal,
            points: self.points,
        }
    }
    /// One of the four, with the normal.
    #[inline(always)]
    pub fn contact(self, i: usize) -> Contact<R> {
        let Point {
            position,
            distance,
            feature,
        } = self.points[i];
        Contact {
            position,
            normal: self.normal,
            distance,
            feature,
        }
    }
    /// The smallest of the distances [m].
    #[inline(always)]
    pub fn distance(self) -> R {
        let [a, b, c, d] = self.points;
        a.distance.min(b.distance).min(c.distance.min(d.distance))
    }
}
