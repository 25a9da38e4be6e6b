//! Boxes and rays, one in each lane.

use numbers::{Real, Vec3};

/// Numbers of a box: lower corner, then upper corner.
pub(super) const BOX: usize = 6;

/// A box in each lane.
#[derive(Clone, Copy, Debug)]
pub struct LaneBox<R> {
    /// Lower corner.
    pub min: Vec3<R>,
    /// Upper corner.
    pub max: Vec3<R>,
}

impl<R: Real> LaneBox<R> {
    /// From lower corner and upper corner.
    #[inline(always)]
    pub fn read(x: [R; BOX]) -> Self {
        Self {
            min: Vec3::new(x[0], x[1], x[2]),
            max: Vec3::new(x[3], x[4], x[5]),
        }
    }

    /// In which lanes the boxes are not farther apart than `margin` along any axis.
    #[inline(always)]
    pub fn is_near(&self, other: &Self, margin: R) -> R::Mask {
        let beside = |a: R, b: R| a.le(b + margin);
        beside(self.min.x, other.max.x)
            & beside(other.min.x, self.max.x)
            & beside(self.min.y, other.max.y)
            & beside(other.min.y, self.max.y)
            & beside(self.min.z, other.max.z)
            & beside(other.min.z, self.max.z)
    }
}

/// A ray in each lane, made ready for many boxes.
#[derive(Clone, Copy, Debug)]
pub struct LaneRay<R> {
    lower: Vec3<R>,
    upper: Vec3<R>,
    inverse: Vec3<R>,
}

impl<R: Real> LaneRay<R> {
    /// From origin and direction; a component of the direction below 10⁻²⁰ counts as none.
    ///
    /// Along an axis of no motion, all times are within a box or none is: the origin is
    /// spread by a part in 10⁶, and 10⁻⁹ m, and the speed's inverse is 10³⁰.
    #[inline(always)]
    pub fn new(origin: Vec3<R>, direction: Vec3<R>) -> Self {
        let axis = |o: R, d: R| {
            let rests = d.abs().lt(R::lit(1e-20));
            let pad = R::select(rests, o.abs().fma(R::lit(1e-6), R::lit(1e-9)), R::zero());
            let inverse = R::select(rests, R::lit(1e30), R::select(rests, R::one(), d).recip());
            (o - pad, o + pad, inverse)
        };
        let x = axis(origin.x, direction.x);
        let y = axis(origin.y, direction.y);
        let z = axis(origin.z, direction.z);
        Self {
            lower: Vec3::new(x.0, y.0, z.0),
            upper: Vec3::new(x.1, y.1, z.1),
            inverse: Vec3::new(x.2, y.2, z.2),
        }
    }

    /// When the box is entered, at least 0, and in which lanes that is by `limit`.
    #[inline(always)]
    pub fn enter(&self, aabb: &LaneBox<R>, limit: R) -> (R, R::Mask) {
        let axis = |min: R, max: R, upper: R, lower: R, inverse: R| {
            let (a, b) = ((min - upper) * inverse, (max - lower) * inverse);
            (a.min(b), a.max(b))
        };
        let x = axis(
            aabb.min.x,
            aabb.max.x,
            self.upper.x,
            self.lower.x,
            self.inverse.x,
        );
        let y = axis(
            aabb.min.y,
            aabb.max.y,
            self.upper.y,
            self.lower.y,
            self.inverse.y,
        );
        let z = axis(
            aabb.min.z,
            aabb.max.z,
            self.upper.z,
            self.lower.z,
            self.inverse.z,
        );
        let enter = x.0.max(y.0).max(z.0.max(R::zero()));
        let leave = x.1.min(y.1).min(z.1.min(limit));
        // An inside-out box is met nowhere.
        (enter, enter.le(leave) & aabb.min.x.le(aabb.max.x))
    }
}
