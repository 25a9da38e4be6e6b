//! Cameras: images of those worlds that are due.

use crate::SensorError;
use model::{Model, Pose};
use render::{Images, Scene, View, ray_caster};

/// A camera in every world, with its last images.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    name: String,
    view: View,
    scene: Scene,
    pub images: Images,
}

impl Camera {
    /// Draws the model as it stands once: so a view that cannot be drawn is known at once.
    pub fn new(name: &str, view: View, model: &Model, worlds: usize) -> Result<Self, SensorError> {
        let refuse = |source| SensorError::Render {
            sensor: name.into(),
            source,
        };
        let scene = Scene::new(model).map_err(refuse)?;
        let poses: Vec<Pose> = model.bodies.iter().map(|body| body.pose).collect();
        let one = ray_caster::render(&scene, &view, &[&poses]).map_err(refuse)?;
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
            scene,
            images,
        })
    }

    /// Draws these worlds, whose bodies are placed so.
    pub fn draw(&mut self, worlds: &[usize], poses: &[Vec<Pose>]) -> Result<(), SensorError> {
        let poses: Vec<&[Pose]> = poses.iter().map(Vec::as_slice).collect();
        let new = ray_caster::render(&self.scene, &self.view, &poses);
        let new = new.map_err(|source| SensorError::Render {
            sensor: self.name.clone(),
            source,
        })?;
        let to = &mut self.images;
        scatter(worlds, new.rgb, &mut to.rgb);
        scatter(worlds, new.depth, &mut to.depth);
        scatter(worlds, new.body, &mut to.body);
        scatter(worlds, new.shape, &mut to.shape);
        scatter(worlds, new.normal, &mut to.normal);
        Ok(())
    }
}

/// The image of `worlds[i]` is the i-th that is new.
fn scatter<P: Copy>(worlds: &[usize], new: Option<Vec<P>>, all: &mut Option<Vec<P>>) {
    let (Some(new), Some(all)) = (new, all) else {
        return;
    };
    let size = new.len() / worlds.len().max(1);
    for (image, &world) in new.chunks_exact(size.max(1)).zip(worlds) {
        all[world * size..][..size].copy_from_slice(image);
    }
}
