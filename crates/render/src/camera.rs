//! Pinhole cameras.
//!
//! A camera looks along the −z axis of its frame, with +y up and +x to the right, as in glTF and
//! OpenGL. Pixels are counted from the upper left corner; the middle of the first is at
//! (u, v) = (½, ½). A point (x, y, z) of the camera's frame is seen at
//!
//! ```text
//! u = cx + fx x / d,   v = cy − fy y / d,   d = −z,
//! ```
//!
//! where d is its depth.

use crate::error::{RenderError, require};
use glam::{DMat3, DQuat, DVec2, DVec3};
use model::{BodyId, CameraMode, Pose};
use std::f64::consts::PI;

/// How points are spread over the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// Square pixels, the optical axis in the middle of the image.
    FieldOfView {
        /// Angle from the upper to the lower edge [rad], above 0 and below π.
        vertical: f64,
    },
    /// By the numbers of a calibration.
    Pixels {
        /// Focal lengths fx and fy [pixel], above 0.
        focal: DVec2,
        /// Where the optical axis meets the image, cx and cy [pixel].
        principal: DVec2,
    },
}

/// A pinhole camera, free or on a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Pixels of a row, 1 to 16384.
    pub width: usize,
    /// Rows, 1 to 16384.
    pub height: usize,
    /// How points are spread over the image.
    pub lens: Lens,
    /// Depth [m] from which on things are seen, above 0. 1 cm by default.
    pub near: f64,
    /// Depth [m] up to which things are seen; infinite by default.
    pub far: f64,
    /// What it is mounted on; `None`, the default, is the world.
    pub body: Option<BodyId>,
    /// How it goes along with its body; fixed to it by default.
    pub mode: CameraMode,
    /// Placement in the frame of its body as its mode says, or in the world; the origin by default.
    pub pose: Pose,
}

/// Most pixels of a row, and most rows.
const MOST_PIXELS: usize = 1 << 14;

impl Camera {
    /// At the world's origin, of a size [pixel] and an angle from its upper to its lower edge [rad].
    pub fn new(width: usize, height: usize, vertical: f64) -> Self {
        Self {
            width,
            height,
            lens: Lens::FieldOfView { vertical },
            near: 0.01,
            far: f64::INFINITY,
            body: None,
            mode: CameraMode::Fixed,
            pose: Pose::IDENTITY,
        }
    }
    /// One that a model names, where it is and as wide as it sees; of a size [pixel], whatever its own.
    pub fn of(camera: &model::Camera, width: usize, height: usize) -> Self {
        Self {
            body: camera.body,
            mode: camera.mode,
            pose: camera.pose,
            ..Self::new(width, height, camera.field_of_view)
        }
    }
    /// The same, at a place in its body's frame, or in the world.
    pub fn at(self, pose: Pose) -> Self {
        Self { pose, ..self }
    }
    /// The same, mounted on a body.
    pub fn on(self, body: BodyId) -> Self {
        let body = Some(body);
        Self { body, ..self }
    }
    /// The same, at `eye` [m], with `target` [m] in the middle of the image and `up` upwards in it, in
    /// its body's frame or in the world. Where these give no direction, another is taken: looking along
    /// `up`, any side is above.
    pub fn looking(self, eye: DVec3, target: DVec3, up: DVec3) -> Self {
        let back = (eye - target).try_normalize().unwrap_or(DVec3::Z);
        let right = up.cross(back).try_normalize();
        let right = right.unwrap_or_else(|| back.any_orthonormal_vector());
        let axes = DMat3::from_cols(right, back.cross(right), back);
        self.at(Pose::new(eye, DQuat::from_mat3(&axes)))
    }

    /// Focal lengths fx, fy [pixel].
    pub fn focal(&self) -> DVec2 {
        match self.lens {
            Lens::FieldOfView { vertical } => {
                DVec2::splat(0.5 * self.height as f64 / (0.5 * vertical).tan())
            }
            Lens::Pixels { focal, .. } => focal,
        }
    }
    /// Where the optical axis meets the image, cx, cy [pixel].
    pub fn principal(&self) -> DVec2 {
        match self.lens {
            Lens::FieldOfView { .. } => 0.5 * DVec2::new(self.width as f64, self.height as f64),
            Lens::Pixels { principal, .. } => principal,
        }
    }
    /// Where a point of the camera's frame [m] is seen, u and v [pixel]; `None` behind the camera.
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let depth = -point.z;
        let across = DVec2::new(point.x, -point.y) / depth;
        (depth > 0.0).then(|| self.principal() + self.focal() * across)
    }
    /// The point of the camera's frame [m] at depth 1 m that is seen at u, v [pixel].
    pub fn unproject(&self, pixel: DVec2) -> DVec3 {
        let across = (pixel - self.principal()) / self.focal();
        DVec3::new(across.x, -across.y, -1.0)
    }
    /// Where it is in a world whose bodies are placed so.
    ///
    /// # Panics
    /// If its body has no pose.
    pub fn placed(&self, bodies: &[Pose]) -> Pose {
        self.mode.placed_on(self.body, bodies, &self.pose)
    }

    pub(crate) fn check(&self, bodies: usize) -> Result<(), RenderError> {
        let size = "from 1 to 16384 pixels";
        let pixels = 1..=MOST_PIXELS;
        let (width, height) = (self.width, self.height);
        require(pixels.contains(&width), "the camera's width", width, size)?;
        require(
            pixels.contains(&height),
            "the camera's height",
            height,
            size,
        )?;
        self.check_lens()?;
        let (near, far) = (self.near, self.far);
        let finite = near > 0.0 && near.is_finite();
        require(
            finite,
            "the camera's near depth",
            near,
            "above 0 and finite, in metres",
        )?;
        let beyond = far > near;
        require(
            beyond,
            "the camera's far depth",
            far,
            "above the near depth; it may be infinite",
        )?;
        let Pose {
            position,
            orientation,
        } = self.pose;
        let pose = format!("at {position}, turned by {orientation}");
        let valid = self.pose.is_valid();
        require(
            valid,
            "the camera's pose",
            pose,
            "finite, its orientation of unit length",
        )?;
        match self.body {
            Some(BodyId(body)) if body >= bodies => Err(RenderError::NoSuchBody { body, bodies }),
            _ => Ok(()),
        }
    }

    fn check_lens(&self) -> Result<(), RenderError> {
        match self.lens {
            Lens::FieldOfView { vertical } => {
                let range = vertical > 0.0 && vertical < PI;
                let must = "above 0 and below π, in radians";
                require(range, "the camera's field of view", vertical, must)
            }
            Lens::Pixels { focal, principal } => {
                let positive = focal.is_finite() && focal.min_element() > 0.0;
                let must = "above 0 and finite, in pixels";
                require(positive, "the camera's focal length", focal, must)?;
                let finite = principal.is_finite();
                require(
                    finite,
                    "the camera's principal point",
                    principal,
                    "finite, in pixels",
                )
            }
        }
    }
}
