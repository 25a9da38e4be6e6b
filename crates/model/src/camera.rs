//! Cameras that a model's author has named.

use crate::{BodyId, Pose};
use serde::{Deserialize, Serialize};

/// A pinhole camera. It looks along the −z axis of its frame, with +y up in the image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Unique in the model.
    pub name: String,
    /// What it is on; `None` is the world.
    pub body: Option<BodyId>,
    /// How it goes along with its body.
    pub mode: CameraMode,
    /// Placement, as its mode says.
    pub pose: Pose,
    /// Angle from the upper to the lower edge of its image [rad], above 0 and below π.
    pub field_of_view: f64,
    /// Pixels of a row, and rows, where the author gives them.
    pub size: Option<[u32; 2]>,
}

/// How a camera goes along with its body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CameraMode {
    /// It moves and turns with its body: its pose is in the body's frame.
    #[default]
    Fixed,
    /// It moves with its body's origin and does not turn: its pose is along world axes, from that origin.
    Track,
}

impl CameraMode {
    /// Where a camera is in the world, on a body that is placed so.
    pub fn placed(self, body: &Pose, pose: &Pose) -> Pose {
        match self {
            Self::Fixed => *body * *pose,
            Self::Track => Pose::new(body.position + pose.position, pose.orientation),
        }
    }
    /// The same of one on a body, or on the world, where all bodies are placed so.
    ///
    /// # Panics
    /// If its body has no pose.
    pub fn placed_on(self, body: Option<BodyId>, bodies: &[Pose], pose: &Pose) -> Pose {
        let carrier = body.map_or(Pose::IDENTITY, |body| bodies[body.0]);
        self.placed(&carrier, pose)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};
    use std::f64::consts::FRAC_PI_2;

    /// A body at p, turned by R: fixed, p + R x and R q; tracking, p + x and q.
    #[test]
    fn a_camera_turns_with_its_body_or_not() {
        let quarter = DQuat::from_rotation_z(FRAC_PI_2);
        let body = Pose::new(DVec3::new(1.0, 2.0, 3.0), quarter);
        let pose = Pose::new(DVec3::X, DQuat::from_rotation_x(0.3));
        let fixed = CameraMode::Fixed.placed(&body, &pose);
        assert!(fixed.position.abs_diff_eq(DVec3::new(1.0, 3.0, 3.0), 1e-15));
        assert!(
            fixed
                .orientation
                .abs_diff_eq(quarter * pose.orientation, 1e-15)
        );
        let tracking = CameraMode::Track.placed(&body, &pose);
        assert_eq!(
            tracking,
            Pose::new(DVec3::new(2.0, 2.0, 3.0), pose.orientation)
        );
    }
}
