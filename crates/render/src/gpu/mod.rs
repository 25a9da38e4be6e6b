//! A renderer on a graphics card, or on what stands in for one, such as Mesa's lavapipe. It opens no
//! window.
//!
//! Solids are drawn as boxes, and each pixel of a box asks where its ray enters the solid: the same
//! formulas as the ray-caster's, in single precision. So a ball is round at any distance, depth is
//! as exact as single precision is, no solid is cut into triangles, and all of a world's are drawn
//! with one call. Hulls and meshes are drawn as their triangles. The images of many worlds are tiles of
//! one target, which is drawn in one pass (in several where it would be too large). Sun and lamps see the
//! worlds first, in tiles of a picture of depths: what is farther than that is in shadow. A lamp that shines all
//! around has six of them.
//!
//! Against the ray-caster: the colours are the same but for the edges of shadows, which are as fine as
//! that picture, and are softened by that. What is seen through is drawn after all else, the farthest
//! shape first, and throws no shadow.

mod device;
mod lamps;
mod pipelines;
mod shapes;
mod targets;
mod worlds;

pub use adapter::{Choice, NoCard};
pub use device::GpuError;

use crate::view::Channels;
use crate::{Images, Scene, View};
use device::Gpu;
use model::Pose;
use pipelines::Pipelines;
use shapes::Meshes;
use targets::{Grid, Target};
use worlds::{Drawn, Worlds};

/// A scene on a graphics card.
#[derive(Debug)]
pub struct Rasteriser {
    scene: Scene,
    gpu: Gpu,
    pipelines: Pipelines,
    meshes: Meshes,
}

impl Rasteriser {
    /// Opens a card, compiles the shaders, and brings the meshes of a scene to it.
    ///
    /// # Errors
    /// There is no such card, with a list of those that there are; or it lacks what is needed.
    pub fn new(scene: &Scene, choice: &Choice) -> Result<Self, GpuError> {
        let gpu = Gpu::new(choice)?;
        let (pipelines, meshes) = (Pipelines::new(&gpu), Meshes::new(&gpu, scene));
        gpu.check()?;
        let scene = scene.clone();
        Ok(Self {
            scene,
            gpu,
            pipelines,
            meshes,
        })
    }

    /// Name of the card, and of what drives it.
    pub fn device(&self) -> String {
        self.gpu.name()
    }

    /// Whether it draws what a view asks for.
    pub(crate) fn takes(&self, view: &View) -> bool {
        self.samples(view).is_ok()
    }
    /// Samples of a pixel.
    fn samples(&self, view: &View) -> Result<u32, GpuError> {
        let samples = match (view.samples, view.occlusion) {
            (1 | 2, 0) => (view.samples * view.samples) as u32,
            (samples, 0) => return Err(GpuError::Samples { samples }),
            (_, rays) => return Err(GpuError::Occlusion { rays }),
        };
        let (width, height) = (view.camera.width, view.camera.height);
        let most = self.gpu.most_texels();
        if width.max(height) > most {
            return Err(GpuError::TooLarge {
                width,
                height,
                most,
            });
        }
        Ok(samples)
    }

    /// As [`ray_caster::render`](crate::ray_caster::render), with 1 or 2 samples along each edge of a
    /// pixel.
    ///
    /// # Errors
    /// As there; more samples; occlusion rays; a device that was lost or has too little memory.
    pub fn render(&self, view: &View, worlds: &[&[Pose]]) -> Result<Images, GpuError> {
        view.check(&self.scene, worlds)?;
        let samples = self.samples(view)?;
        let mut images = Images::new(view, worlds.len())?;
        for some in worlds.chunks(Grid::most_at_once(view, &self.gpu)) {
            let grid = Grid::new(view, some.len(), &self.gpu);
            let worlds = Worlds::new(&self.gpu, &self.pipelines, &self.scene, view, some);
            if view.channels.geometric() {
                self.geometry(&grid, &worlds, view.channels, &mut images)?;
            }
            if view.channels.rgb {
                self.color(&grid, &worlds, samples, &mut images)?;
            }
        }
        Ok(images)
    }

    fn geometry(
        &self,
        grid: &Grid,
        worlds: &Worlds,
        channels: Channels,
        images: &mut Images,
    ) -> Result<(), GpuError> {
        let target = Target::geometry(&self.gpu, grid);
        let mut encoder = self.gpu.encoder();
        let mut pass = target.pass(&mut encoder);
        for (world, tile) in worlds.all.iter().zip(grid.tiles()) {
            tile.set(&mut pass);
            for drawn in world.solid.iter().chain(&world.clear) {
                self.draw(
                    &mut pass,
                    drawn,
                    &self.pipelines.geometry,
                    worlds,
                    world.offset,
                );
            }
        }
        drop(pass);
        self.gpu.submit(encoder);
        let [depth, rows, normal] = &target.colors[..] else {
            unreachable!("three targets")
        };
        if let Some(images) = images.depth.as_mut().filter(|_| channels.depth) {
            grid.read(&self.gpu, depth, |texel: &f32| images.push(*texel))?;
        }
        if channels.shape || channels.body {
            grid.read(&self.gpu, rows, |[shape, body]: &[i32; 2]| {
                images.shape.iter_mut().for_each(|image| image.push(*shape));
                images.body.iter_mut().for_each(|image| image.push(*body));
            })?;
        }
        if let Some(image) = &mut images.normal {
            grid.read(&self.gpu, normal, |n: &[f32; 4]| image.extend(&n[..3]))?;
        }
        Ok(())
    }

    fn color(
        &self,
        grid: &Grid,
        worlds: &Worlds,
        samples: u32,
        images: &mut Images,
    ) -> Result<(), GpuError> {
        let target = Target::color(&self.gpu, grid, samples);
        let pipelines = self.pipelines.color(samples);
        let mut encoder = self.gpu.encoder();
        self.shadows(&mut encoder, worlds);
        let mut pass = target.pass(&mut encoder);
        pass.set_bind_group(1, &worlds.lamps.bindings, &[]);
        for (world, tile) in worlds.all.iter().zip(grid.tiles()) {
            tile.set(&mut pass);
            pass.set_pipeline(&pipelines.background);
            pass.set_bind_group(0, &worlds.bindings, &[world.offset]);
            pass.draw(0..3, 0..1);
            for drawn in &world.solid {
                self.draw(&mut pass, drawn, &pipelines.solid, worlds, world.offset);
            }
            for drawn in &world.clear {
                self.draw(&mut pass, drawn, &pipelines.clear, worlds, world.offset);
            }
        }
        drop(pass);
        self.gpu.submit(encoder);
        let image = images.rgb.as_mut();
        match (image, target.colors.last()) {
            (Some(image), Some(color)) => grid.read(&self.gpu, color, |texel: &[u8; 4]| {
                image.extend(&texel[..3])
            }),
            _ => Ok(()),
        }
    }

    /// Draws what lamps see of each world.
    fn shadows(&self, encoder: &mut wgpu::CommandEncoder, worlds: &Worlds) {
        let lamps = &worlds.lamps;
        let mut pass = lamps.target.pass(encoder);
        let mut tiles = lamps.grid.tiles();
        for (i, world) in worlds.all.iter().enumerate() {
            for (offset, tile) in lamps.offsets(i).zip(&mut tiles) {
                tile.set(&mut pass);
                pass.set_bind_group(1, &lamps.onto, &[offset]);
                for drawn in &world.casting {
                    self.draw(
                        &mut pass,
                        drawn,
                        &self.pipelines.shadow,
                        worlds,
                        world.offset,
                    );
                }
            }
        }
    }

    fn draw(
        &self,
        pass: &mut wgpu::RenderPass,
        drawn: &Drawn,
        pipelines: &pipelines::Pair,
        worlds: &Worlds,
        offset: u32,
    ) {
        match drawn.mesh {
            None => {
                pass.set_pipeline(&pipelines.boxes);
                pass.set_bind_group(0, &worlds.bindings, &[offset]);
                pass.draw(0..36, drawn.shapes.clone());
            }
            Some(mesh) => {
                pass.set_pipeline(&pipelines.triangles);
                pass.set_bind_group(0, &worlds.bindings, &[offset]);
                pass.set_vertex_buffer(0, self.meshes.vertices.slice(..));
                pass.draw(self.meshes.ranges[mesh].clone(), drawn.shapes.clone());
            }
        }
    }
}
