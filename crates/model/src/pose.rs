//! Placement of one frame in another.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::ops::Mul;

/// A rigid placement: rotate by `orientation`, then translate by `position`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position [m].
    pub position: DVec3,
    /// Orientation, a unit quaternion (x, y, z, w).
    pub orientation: DQuat,
}

impl Pose {
    /// At the origin, unturned.
    pub const IDENTITY: Self = Self {
        position: DVec3::ZERO,
        orientation: DQuat::IDENTITY,
    };

    /// From position [m] and orientation.
    pub fn new(position: DVec3, orientation: DQuat) -> Self {
        Self {
            position,
            orientation,
        }
    }
    /// Unturned, at a position [m].
    pub fn at(position: DVec3) -> Self {
        Self::new(position, DQuat::IDENTITY)
    }
    /// A point of this frame, in the outer frame.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.orientation * p + self.position
    }
    /// A direction of this frame, in the outer frame.
    #[inline]
    pub fn direction(&self, d: DVec3) -> DVec3 {
        self.orientation * d
    }
    /// The placement that undoes this one.
    #[inline]
    pub fn inverse(&self) -> Self {
        let q = self.orientation.conjugate();
        Self::new(-(q * self.position), q)
    }
    /// All numbers finite and the quaternion of unit length within 1e-6.
    pub fn is_valid(&self) -> bool {
        self.position.is_finite()
            && self.orientation.is_finite()
            && (self.orientation.length() - 1.0).abs() < 1e-6
    }
}

impl Default for Pose {
    fn default() -> Self {
        Self::IDENTITY
    }
}

impl Mul for Pose {
    type Output = Self;
    /// First `inner`, then `self`.
    fn mul(self, inner: Self) -> Self {
        Self::new(
            self.point(inner.position),
            (self.orientation * inner.orientation).normalize(),
        )
    }
}
