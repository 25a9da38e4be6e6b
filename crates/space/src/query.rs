//! What is asked of objects, and what comes back.

use crate::{Boxes, Cast};
use glam::Vec3;

/// A cast's first touch of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Index of the object.
    pub object: u32,
    /// When, in units of the cast's direction.
    pub time: f32,
}

/// An object near a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Index of the object.
    pub object: u32,
    /// The object's point nearest to the one asked about [m].
    pub point: Vec3,
    /// Square of the distance [m²].
    pub distance_squared: f32,
}

impl Neighbor {
    /// The distance [m]; 0 where the point lies inside.
    pub fn distance(&self) -> f32 {
        self.distance_squared.sqrt()
    }
    /// Nearer first, then the lower index. Squares are not negative, so their bits are in order.
    pub(crate) fn rank(&self) -> (u32, u32) {
        (self.distance_squared.to_bits(), self.object)
    }
}

/// Decides exactly what a cast's candidates only may do. Closures are tests;
/// [`Boxes`] tests the boxes themselves.
pub trait CastTest: Sync {
    /// The first time in `0..=limit` at which `cast` touches `object`, if it does.
    /// Other times, NaN too, count as no hit.
    fn hit(&self, object: u32, cast: &Cast, limit: f32) -> Option<f32>;
}

impl<F: Fn(u32, &Cast, f32) -> Option<f32> + Sync> CastTest for F {
    #[inline]
    fn hit(&self, object: u32, cast: &Cast, limit: f32) -> Option<f32> {
        self(object, cast, limit)
    }
}

impl CastTest for Boxes {
    #[inline]
    fn hit(&self, object: u32, cast: &Cast, limit: f32) -> Option<f32> {
        cast.against(self.get(object), limit)
    }
}

/// Finds the point of an object nearest to another point. Closures are tests;
/// [`Boxes`] answers for the boxes themselves.
pub trait ClosestTest: Sync {
    /// The point of `object`, which lies within its box, nearest to `point`; `point`
    /// itself if that is inside.
    fn closest(&self, object: u32, point: Vec3) -> Vec3;
}

impl<F: Fn(u32, Vec3) -> Vec3 + Sync> ClosestTest for F {
    #[inline]
    fn closest(&self, object: u32, point: Vec3) -> Vec3 {
        self(object, point)
    }
}

impl ClosestTest for Boxes {
    #[inline]
    fn closest(&self, object: u32, point: Vec3) -> Vec3 {
        self.get(object).closest_point(point)
    }
}
