//! Images from a graphics card, or from the processor.

#[cfg(feature = "gpu")]
use crate::gpu::{Choice, GpuError, Rasteriser};
use crate::{Images, RenderError, Scene, View, ray_caster};
use model::Pose;
use std::fmt;
use std::str::FromStr;
use std::sync::Arc;

/// Where images are drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Device {
    /// `cpu`: the ray-caster.
    #[default]
    Processor,
    /// `auto`: a graphics card where there is one and it draws what a view asks for, else the ray-caster. Never a
    /// program that stands in for a card.
    Auto,
    /// `gpu`, or `gpu:NAME` with a part of its name; by name a program that stands in for a card is taken, too.
    Card(String),
}

impl FromStr for Device {
    type Err = RenderError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(':') {
            None if text == "cpu" => Ok(Self::Processor),
            None if text == "auto" => Ok(Self::Auto),
            None if text == "gpu" => Ok(Self::Card(String::new())),
            Some(("gpu", name)) => Ok(Self::Card(name.to_owned())),
            _ => Err(RenderError::UnknownDevice(text.to_owned())),
        }
    }
}

impl fmt::Display for Device {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Processor => f.write_str("cpu"),
            Self::Auto => f.write_str("auto"),
            Self::Card(name) if name.is_empty() => f.write_str("gpu"),
            Self::Card(name) => write!(f, "gpu:{name}"),
        }
    }
}

/// A scene, and what draws it. Clones share the card.
///
/// ```
/// use kinetarium_render::{Camera, Device, Renderer, Scene, View};
///
/// let model = model::examples::tower(3, 0.0)?;
/// let poses: Vec<_> = model.bodies.iter().map(|body| body.pose).collect();
/// let renderer = Renderer::new(Scene::new(&model)?, &Device::Auto)?;
/// let camera = Camera::framing(renderer.scene(), &poses, 64, 48);
/// let images = renderer.render(&View::new(camera), &[&poses])?;
/// assert_eq!(images.rgb.unwrap().len(), 48 * 64 * 3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Renderer {
    scene: Arc<Scene>,
    card: Option<Arc<Rasteriser>>,
    /// Whether the ray-caster draws what the card does not.
    falls_back: bool,
}

impl Renderer {
    /// Opens the device, and brings the scene to it.
    ///
    /// # Errors
    /// A card that is not there, with those that are; one that cannot be used; a build without cards.
    pub fn new(scene: Scene, device: &Device) -> Result<Self, RenderError> {
        let card = match device {
            Device::Processor => None,
            Device::Card(name) => Some(Rasteriser::open(&scene, name)?),
            Device::Auto => match Rasteriser::open(&scene, "") {
                Ok(card) => Some(card),
                Err(RenderError::NoCard(_) | RenderError::NotBuilt) => None,
                Err(error) => return Err(error),
            },
        };
        Ok(Self {
            scene: Arc::new(scene),
            card: card.map(Arc::new),
            falls_back: *device == Device::Auto,
        })
    }

    /// What is drawn.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }
    /// `cpu`, or the name of the card, and of what drives it.
    pub fn device(&self) -> String {
        self.card
            .as_ref()
            .map_or("cpu".into(), |card| card.device())
    }

    /// As [`ray_caster::render`]; a card takes 1 or 2 samples along each edge of a pixel, and no occlusion rays.
    ///
    /// # Errors
    /// As there; what the card does not draw, unless the device is `auto`; a card that fails.
    pub fn render(&self, view: &View, worlds: &[&[Pose]]) -> Result<Images, RenderError> {
        match &self.card {
            Some(card) if card.takes(view) || !self.falls_back => Ok(card.render(view, worlds)?),
            _ => ray_caster::render(&self.scene, view, worlds),
        }
    }
}

#[cfg(feature = "gpu")]
impl Rasteriser {
    /// The first card with this in its name; any that is no program where that is empty.
    fn open(scene: &Scene, name: &str) -> Result<Self, RenderError> {
        let Ok(choice) = name.parse::<Choice>();
        Ok(Self::new(scene, &choice)?)
    }
}

#[cfg(feature = "gpu")]
impl From<GpuError> for RenderError {
    fn from(error: GpuError) -> Self {
        match error {
            GpuError::Render(error) => error,
            GpuError::NoCard(error) => Self::NoCard(error.to_string()),
            error => Self::Card(error.to_string()),
        }
    }
}

/// No card, in a build that has no part for them.
#[cfg(not(feature = "gpu"))]
#[derive(Debug)]
enum Rasteriser {}

#[cfg(not(feature = "gpu"))]
impl Rasteriser {
    fn open(_: &Scene, _: &str) -> Result<Self, RenderError> {
        Err(RenderError::NotBuilt)
    }
    fn device(&self) -> String {
        match *self {}
    }
    fn takes(&self, _: &View) -> bool {
        match *self {}
    }
    fn render(&self, _: &View, _: &[&[Pose]]) -> Result<Images, RenderError> {
        match *self {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for text in ["cpu", "auto", "gpu", "gpu:llvmpipe"] {
            assert_eq!(text.parse::<Device>().unwrap().to_string(), text);
        }
        for text in ["", "GPU", "cuda", "cpu:0"] {
            let told = text.parse::<Device>().unwrap_err().to_string();
            assert!(told.contains(&format!("`{text}`")), "{told}");
        }
    }

    #[test]
    fn a_card_that_is_not_there_is_told() {
        let scene = Scene::new(&model::examples::tower(1, 0.0).unwrap()).unwrap();
        let device = Device::Card("no such card".into());
        let told = Renderer::new(scene, &device).unwrap_err().to_string();
        let words = if cfg!(feature = "gpu") {
            "has `no such card` in its name; found: "
        } else {
            "build it with the feature gpu"
        };
        assert!(told.contains(words), "{told}");
    }
}
