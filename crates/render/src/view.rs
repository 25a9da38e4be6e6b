//! What is asked of a camera.

use crate::error::{RenderError, require};
use crate::{Camera, Light, Scene};
use model::Pose;
use std::collections::TryReserveError;
use std::sync::Arc;

/// Most pixels of all images together.
const MOST_PIXELS: usize = 1 << 31;
/// Most samples along each edge of a pixel, and most rays about each.
const MOST_SAMPLES: usize = 64;

/// A camera, and what is wanted of it. Several worlds have a camera each, all alike.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The camera.
    pub camera: Camera,
    /// Which images are made.
    pub channels: Channels,
    /// Samples along each edge of a pixel, of which the colour is the mean; 1 to 64. The other channels
    /// are taken in the middle of each pixel.
    pub samples: usize,
    /// Rays that tell how much of the sky each sample sees, 0 to 64; with 0, the default, all of it.
    pub occlusion: usize,
    /// What lights the scene; `None`, the default, is the scene's own.
    pub light: Option<Arc<Light>>,
    /// Edge of the squares of the checker pattern on planes [m], 0 for none; `None`, the default, is the scene's own.
    pub checker: Option<f64>,
}

/// Which images are made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Channels {
    /// Colours.
    pub rgb: bool,
    /// Depth along the optical axis.
    pub depth: bool,
    /// Rows of bodies.
    pub body: bool,
    /// Rows of shapes.
    pub shape: bool,
    /// Normals.
    pub normal: bool,
}

impl Channels {
    /// None of them.
    pub const NONE: Self = Self {
        rgb: false,
        depth: false,
        body: false,
        shape: false,
        normal: false,
    };
    /// Colours only.
    pub const RGB: Self = Self {
        rgb: true,
        ..Self::NONE
    };
    /// All of them.
    pub const ALL: Self = Self {
        rgb: true,
        depth: true,
        body: true,
        shape: true,
        normal: true,
    };

    /// Whether any is wanted that is no colour.
    pub(crate) fn geometric(self) -> bool {
        self.depth || self.body || self.shape || self.normal
    }
}

/// One image of each world and channel, row by row from the upper left corner, the images of N worlds
/// one after the other: shape (N, H, W) or (N, H, W, 3). What was not asked for is `None`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Images {
    /// Number of images N.
    pub worlds: usize,
    /// Pixels of a row W.
    pub width: usize,
    /// Rows H.
    pub height: usize,
    /// Red, green and blue in sRGB, (N, H, W, 3).
    pub rgb: Option<Vec<u8>>,
    /// Depth along the optical axis [m], not along the ray, (N, H, W); infinite where nothing is seen.
    pub depth: Option<Vec<f32>>,
    /// Row of the body, (N, H, W); −1 for the world's own shapes and where nothing is seen.
    pub body: Option<Vec<i32>>,
    /// Row of the shape, (N, H, W); −1 where nothing is seen.
    pub shape: Option<Vec<i32>>,
    /// Unit vector out of the surface, world axes, (N, H, W, 3); zero where nothing is seen.
    pub normal: Option<Vec<f32>>,
}

impl Images {
    /// Room for those that a view asks for.
    pub(crate) fn new(view: &View, worlds: usize) -> Result<Self, RenderError> {
        let (width, height) = (view.camera.width, view.camera.height);
        let pixels = worlds * width * height;
        let channels = view.channels;
        let made = || -> Result<Self, TryReserveError> {
            Ok(Self {
                worlds,
                width,
                height,
                rgb: room(channels.rgb, 3 * pixels)?,
                depth: room(channels.depth, pixels)?,
                body: room(channels.body, pixels)?,
                shape: room(channels.shape, pixels)?,
                normal: room(channels.normal, 3 * pixels)?,
            })
        };
        made().map_err(|_| RenderError::NoMemory {
            worlds,
            width,
            height,
        })
    }
}

/// For so many numbers, if they are wanted.
fn room<T>(wanted: bool, numbers: usize) -> Result<Option<Vec<T>>, TryReserveError> {
    let mut image = Vec::new();
    if wanted {
        image.try_reserve_exact(numbers)?;
    }
    Ok(wanted.then_some(image))
}

impl View {
    /// Colours as a camera sees them, a sample a pixel.
    pub fn new(camera: Camera) -> Self {
        Self {
            camera,
            channels: Channels::RGB,
            samples: 1,
            occlusion: 0,
            light: None,
            checker: None,
        }
    }
    /// The same, of other channels.
    pub fn with_channels(self, channels: Channels) -> Self {
        Self { channels, ..self }
    }
    /// The same, with so many samples along each edge of a pixel.
    pub fn with_samples(self, samples: usize) -> Self {
        Self { samples, ..self }
    }
    /// The same, with so many rays that tell how much of the sky each sample sees.
    pub fn with_occlusion(self, occlusion: usize) -> Self {
        Self { occlusion, ..self }
    }

    /// The same, lit so.
    pub fn with_light(self, light: Light) -> Self {
        let light = Some(Arc::new(light));
        Self { light, ..self }
    }
    /// The same, with squares of this edge [m] on planes.
    pub fn with_checker(self, checker: f64) -> Self {
        let checker = Some(checker);
        Self { checker, ..self }
    }

    /// What lights a scene.
    pub(crate) fn light<'a>(&'a self, scene: &'a Scene) -> &'a Light {
        self.light.as_deref().unwrap_or(&scene.light)
    }
    /// Edge of the squares on planes of a scene [m].
    pub(crate) fn checker(&self, scene: &Scene) -> f64 {
        self.checker.unwrap_or(scene.checker)
    }

    /// Checks all that is drawn together.
    pub(crate) fn check(&self, scene: &Scene, worlds: &[&[Pose]]) -> Result<(), RenderError> {
        let bodies = scene.bodies();
        self.camera.check(bodies)?;
        self.light(scene).check(bodies)?;
        let (what, checker) = ("the edge of the checker's squares", self.checker(scene));
        require(
            checker >= 0.0 && checker.is_finite(),
            what,
            checker,
            "finite and not below 0, in metres",
        )?;
        let (what, samples) = ("the number of samples", self.samples);
        require(
            (1..=MOST_SAMPLES).contains(&samples),
            what,
            samples,
            "from 1 to 64",
        )?;
        let (what, rays) = ("the number of occlusion rays", self.occlusion);
        require(rays <= MOST_SAMPLES, what, rays, "from 0 to 64")?;
        if worlds.is_empty() {
            return Err(RenderError::NoWorlds);
        }
        let (width, height) = (self.camera.width, self.camera.height);
        if worlds.len().saturating_mul(width * height) > MOST_PIXELS {
            let (worlds, most) = (worlds.len(), MOST_PIXELS);
            return Err(RenderError::TooLarge {
                worlds,
                width,
                height,
                most,
            });
        }
        let mut counted = worlds.iter().enumerate();
        counted.try_for_each(|(world, poses)| check_poses(world, poses, bodies))
    }
}

fn check_poses(world: usize, poses: &[Pose], bodies: usize) -> Result<(), RenderError> {
    if poses.len() != bodies {
        let poses = poses.len();
        return Err(RenderError::WrongPoses {
            world,
            poses,
            bodies,
        });
    }
    // Simulations in single precision round orientations.
    let bad = |pose: &Pose| {
        let length = pose.orientation.length();
        !(pose.position.is_finite() && (length - 1.0).abs() < 1e-3)
    };
    match poses.iter().position(bad) {
        Some(body) => Err(RenderError::BadPose { world, body }),
        None => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_there_is_no_memory_for_is_refused() {
        let view = View::new(Camera::new(1 << 14, 1 << 14, 1.0)).with_channels(Channels::ALL);
        let error = Images::new(&view, 1 << 32).unwrap_err().to_string();
        assert!(error.starts_with("there is too little memory for 4294967296 images"));
    }
}
