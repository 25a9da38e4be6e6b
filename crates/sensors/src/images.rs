//! Cameras: images of those worlds that are due.

use crate::random::{Draw, Purpose, Source};
use crate::{ImageNoise, SensorError};
use model::{Model, Pose};
use numbers::dispatch::Isa;
use rayon::prelude::*;
use render::{Device, Images, RenderError, Renderer, Scene, View};

/// A camera in every world, with its last images.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    name: String,
    view: View,
    renderer: Renderer,
    pub images: Images,
}

/// What draws the images of a model: one for each device.
#[derive(Default)]
pub(crate) struct Renderers(Vec<(Device, Renderer)>);

impl Renderers {
    fn on(&mut self, device: &Device, model: &Model) -> Result<Renderer, RenderError> {
        let mut known = self.0.iter();
        if let Some((_, renderer)) = known.find(|(other, _)| other == device) {
            return Ok(renderer.clone());
        }
        let renderer = Renderer::new(Scene::new(model)?, device)?;
        self.0.push((device.clone(), renderer.clone()));
        Ok(renderer)
    }
}

impl Camera {
    /// Draws the model as it stands once: so a view that cannot be drawn is known at once.
    pub fn new(
        name: &str,
        (view, device): (View, &Device),
        (model, renderers): (&Model, &mut Renderers),
        worlds: usize,
    ) -> Result<Self, SensorError> {
        let refuse = |source| SensorError::Render {
            sensor: name.into(),
            source,
        };
        let renderer = renderers.on(device, model).map_err(refuse)?;
        let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
        let one = renderer.render(&view, &[&poses]).map_err(refuse)?;
        let images = Images {
            worlds,
            width: one.width,
            height: one.height,
            rgb: one.rgb.map(|x| vec![0; worlds * x.len()]),
            depth: one.depth.map(|x| vec![0.0; worlds * x.len()]),
            body: one.body.map(|x| vec![0; worlds * x.len()]),
            shape: one.shape.map(|x| vec![0; worlds * x.len()]),
            normal: one.normal.map(|x| vec![0.0; worlds * x.len()]),
        };
        Ok(Self {
            name: name.into(),
            view,
            renderer,
            images,
        })
    }

    /// Takes these samples, of worlds whose bodies are placed so.
    pub fn draw(
        &mut self,
        draws: &[Draw],
        poses: &[Vec<Pose>],
        errors: &ImageErrors,
    ) -> Result<(), SensorError> {
        let poses: Vec<&[Pose]> = poses.iter().map(Vec::as_slice).collect();
        let new = self.renderer.render(&self.view, &poses);
        let mut new = new.map_err(|source| SensorError::Render {
            sensor: self.name.clone(),
            source,
        })?;
        errors.add(draws, &mut new);
        let to = &mut self.images;
        scatter(draws, new.rgb, &mut to.rgb);
        scatter(draws, new.depth, &mut to.depth);
        scatter(draws, new.body, &mut to.body);
        scatter(draws, new.shape, &mut to.shape);
        scatter(draws, new.normal, &mut to.normal);
        Ok(())
    }
}

/// Noise of images, as a function of seed, camera, world, sample and pixel.
pub(crate) struct ImageErrors {
    pub noise: ImageNoise,
    pub source: Source,
    pub isa: Isa,
}

impl ImageErrors {
    /// Adds it to the new images, those of these samples; threads share the worlds.
    pub fn add(&self, draws: &[Draw], images: &mut Images) {
        let brightest = f64::from(u8::MAX);
        self.shift(
            Purpose::White,
            self.noise.rgb,
            draws,
            &mut images.rgb,
            |x, by| {
                let moved = f64::from(*x) + brightest * by;
                *x = moved.round().clamp(0.0, brightest) as u8;
            },
        );
        self.shift(
            Purpose::Depth,
            self.noise.depth,
            draws,
            &mut images.depth,
            |x, by| {
                if x.is_finite() {
                    *x = (f64::from(*x) + by).max(0.0) as f32;
                }
            },
        );
    }

    fn shift<P: Send>(
        &self,
        purpose: Purpose,
        deviation: f64,
        draws: &[Draw],
        images: &mut Option<Vec<P>>,
        move_by: impl Fn(&mut P, f64) + Sync,
    ) {
        let Some(images) = images
            .as_mut()
            .filter(|_| deviation > 0.0 && !draws.is_empty())
        else {
            return;
        };
        let n = images.len() / draws.len();
        let each = images.par_chunks_exact_mut(n).zip(draws);
        each.for_each(|(image, draw)| {
            let take = |_: &Draw, i: usize, z: f64| move_by(&mut image[i], deviation * z);
            self.source
                .each(self.isa, purpose, std::iter::once(*draw), n, take);
        });
    }
}

/// The image of the i-th sample is the i-th that is new.
fn scatter<P: Copy>(draws: &[Draw], new: Option<Vec<P>>, all: &mut Option<Vec<P>>) {
    let (Some(new), Some(all)) = (new, all) else {
        return;
    };
    let size = new.len() / draws.len().max(1);
    for (image, draw) in new.chunks_exact(size.max(1)).zip(draws) {
        all[draw.world * size..][..size].copy_from_slice(image);
    }
}
