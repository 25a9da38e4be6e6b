//! Moving objects.

use crate::Pose;
use glam::{DQuat, DVec3};

/// Moves one replica of an object, or all of them.
///
/// `…_by` is relative to where it stands, `…_to` absolute. Angles in radians, lengths in metres, in
/// the world's frame. Axes need no unit length, but must not be zero.
#[derive(Debug)]
pub struct Placement<'a> {
    pub(super) poses: &'a mut [Pose],
}

impl Placement<'_> {
    /// Shifts.
    pub fn translate_by(&mut self, shift: DVec3) -> &mut Self {
        self.each(|pose| pose.position += shift)
    }
    /// Puts the object's origin at a point.
    pub fn translate_to(&mut self, point: DVec3) -> &mut Self {
        self.each(|pose| pose.position = point)
    }
    /// Shifts along an axis.
    pub fn move_on_axis_by(&mut self, axis: DVec3, distance: f64) -> &mut Self {
        self.translate_by(distance * axis.normalize())
    }
    /// Shifts along an axis until the origin stands at this distance along it from the world's.
    pub fn move_on_axis_to(&mut self, axis: DVec3, distance: f64) -> &mut Self {
        let axis = axis.normalize();
        self.each(|pose| pose.position += (distance - axis.dot(pose.position)) * axis)
    }
    /// Turns about an axis through a point.
    pub fn rotate_around_by(&mut self, point: DVec3, axis: DVec3, angle: f64) -> &mut Self {
        let axis = axis.normalize();
        self.each(|pose| *pose = turn(point, axis, angle) * *pose)
    }
    /// Turns about an axis through a point until the orientation is turned by this angle about it.
    ///
    /// Which angle an orientation q = (v, w) has about an axis a is told by its twist
    /// φ = 2 atan2(v·a, w), to which a turn by δ about a adds δ.
    pub fn rotate_around_to(&mut self, point: DVec3, axis: DVec3, angle: f64) -> &mut Self {
        let axis = axis.normalize();
        self.each(|pose| {
            let q = pose.orientation;
            let twist = 2.0 * q.xyz().dot(axis).atan2(q.w);
            *pose = turn(point, axis, angle - twist) * *pose;
        })
    }

    fn each(&mut self, change: impl Fn(&mut Pose)) -> &mut Self {
        self.poses.iter_mut().for_each(change);
        self
    }
}

fn turn(point: DVec3, axis: DVec3, angle: f64) -> Pose {
    let r = DQuat::from_axis_angle(axis, angle);
    Pose::new(point - r * point, r)
}
