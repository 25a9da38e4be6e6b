//! What is drawn into, and how it is read back.

use super::device::{Gpu, GpuError};
use crate::View;
use bytemuck::AnyBitPattern;
use std::sync::mpsc;

/// Most pixels that are drawn at once, so that targets take 100 MB or so.
const MOST_PIXELS: usize = 1 << 22;

/// Images of one size beside and below each other in one target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    images: usize,
    columns: usize,
    /// Of each image.
    width: usize,
    height: usize,
}

/// Place of an image in a target.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tile {
    left: usize,
    top: usize,
    width: usize,
    height: usize,
}

impl Grid {
    /// How many images of a view are drawn together.
    pub fn most_at_once(view: &View, gpu: &Gpu) -> usize {
        let (width, height) = (view.camera.width, view.camera.height);
        let fit = (gpu.most_texels() / width) * (gpu.most_texels() / height);
        fit.min(MOST_PIXELS / (width * height)).max(1)
    }

    /// Of this many of a view's images.
    pub fn new(view: &View, images: usize, gpu: &Gpu) -> Self {
        Self::of(images, (view.camera.width, view.camera.height), gpu)
    }

    /// About as wide as high.
    pub fn of(images: usize, (width, height): (usize, usize), gpu: &Gpu) -> Self {
        let even = ((images * height) as f64 / width as f64).sqrt().ceil() as usize;
        let fit = gpu.most_texels() / width;
        let least = images.div_ceil((gpu.most_texels() / height).max(1));
        let columns = even.clamp(least.max(1), fit.max(1));
        Self {
            images,
            columns,
            width,
            height,
        }
    }

    fn extent(&self) -> wgpu::Extent3d {
        wgpu::Extent3d {
            width: (self.columns.min(self.images) * self.width) as u32,
            height: (self.images.div_ceil(self.columns) * self.height) as u32,
            depth_or_array_layers: 1,
        }
    }

    pub fn tiles(&self) -> impl Iterator<Item = Tile> {
        let grid = *self;
        (0..self.images).map(move |i| Tile {
            left: i % grid.columns * grid.width,
            top: i / grid.columns * grid.height,
            width: grid.width,
            height: grid.height,
        })
    }

    /// Left and top, width and height of each tile, as shares of the target.
    pub fn shares(&self) -> impl Iterator<Item = [[f32; 2]; 2]> {
        let extent = self.extent();
        let (width, height) = (extent.width as f32, extent.height as f32);
        self.tiles().map(move |tile| {
            [
                [tile.left as f32 / width, tile.top as f32 / height],
                [tile.width as f32 / width, tile.height as f32 / height],
            ]
        })
    }

    /// Gives all texels of a target, image by image.
    pub fn read<T: AnyBitPattern>(
        &self,
        gpu: &Gpu,
        texture: &wgpu::Texture,
        mut each: impl FnMut(&T),
    ) -> Result<(), GpuError> {
        let size = self.extent();
        let row = (size.width as usize * size_of::<T>())
            .next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT as usize);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: (row * size.height as usize) as u64,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let mut encoder = gpu.encoder();
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(row as u32),
            rows_per_image: None,
        };
        let to = wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout,
        };
        encoder.copy_texture_to_buffer(texture.as_image_copy(), to, size);
        gpu.submit(encoder);
        let failed = |error: &dyn std::fmt::Display| GpuError::Failed(error.to_string());
        let (sender, mapped) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver waits below.
            let _ = sender.send(result);
        });
        gpu.check()?;
        let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map_err(|e| failed(&e))?;
        mapped
            .recv()
            .map_err(|e| failed(&e))?
            .map_err(|e| failed(&e))?;
        let bytes = buffer.get_mapped_range(..).map_err(|e| failed(&e))?;
        for tile in self.tiles() {
            for y in tile.top..tile.top + tile.height {
                let from = y * row + tile.left * size_of::<T>();
                let texels = &bytes[from..from + tile.width * size_of::<T>()];
                bytemuck::cast_slice(texels).iter().for_each(&mut each);
            }
        }
        Ok(())
    }
}

impl Tile {
    /// Lets a pass draw here only.
    pub fn set(&self, pass: &mut wgpu::RenderPass) {
        let [left, top, width, height] = [self.left, self.top, self.width, self.height];
        pass.set_viewport(
            left as f32,
            top as f32,
            width as f32,
            height as f32,
            0.0,
            1.0,
        );
        pass.set_scissor_rect(left as u32, top as u32, width as u32, height as u32);
    }
}

pub(super) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;
/// Depth; rows of shape and body; normal.
pub(super) const GEOMETRY: [wgpu::TextureFormat; 3] = [
    wgpu::TextureFormat::R32Float,
    wgpu::TextureFormat::Rg32Sint,
    wgpu::TextureFormat::Rgba32Float,
];
pub(super) const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;

/// Textures that a pass draws into.
#[derive(Debug)]
pub(super) struct Target {
    /// To be read; what samples become, last.
    pub colors: Vec<wgpu::Texture>,
    views: Vec<wgpu::TextureView>,
    pub depth: wgpu::TextureView,
    /// Of each colour at first.
    clear: Vec<wgpu::Color>,
    far: f32,
    /// Whether the last colour is the mean of the samples of the first.
    resolves: bool,
}

impl Target {
    pub fn geometry(gpu: &Gpu, grid: &Grid) -> Self {
        let all = |x: f64| wgpu::Color {
            r: x,
            g: x,
            b: x,
            a: x,
        };
        let clear = vec![all(f64::INFINITY), all(-1.0), all(0.0)];
        let colors = GEOMETRY
            .map(|format| texture(gpu, grid, format, 1))
            .to_vec();
        Self::new(gpu, grid, colors, clear, 1)
    }

    pub fn color(gpu: &Gpu, grid: &Grid, samples: u32) -> Self {
        let mut colors = vec![texture(gpu, grid, COLOR, samples)];
        if samples > 1 {
            colors.push(texture(gpu, grid, COLOR, 1));
        }
        Self::new(gpu, grid, colors, vec![wgpu::Color::BLACK], samples)
    }

    /// What lamps see: depths, from 0 at the lamp to 1.
    pub fn depths(gpu: &Gpu, grid: &Grid) -> Self {
        Self {
            far: 1.0,
            ..Self::new(gpu, grid, Vec::new(), Vec::new(), 1)
        }
    }

    fn new(
        gpu: &Gpu,
        grid: &Grid,
        colors: Vec<wgpu::Texture>,
        clear: Vec<wgpu::Color>,
        samples: u32,
    ) -> Self {
        let view = |texture: &wgpu::Texture| texture.create_view(&Default::default());
        Self {
            views: colors.iter().map(view).collect(),
            depth: view(&texture(gpu, grid, DEPTH, samples)),
            resolves: colors.len() > clear.len(),
            colors,
            clear,
            far: 0.0,
        }
    }

    /// A pass that draws into it, from its first state on.
    pub fn pass<'a>(&self, encoder: &'a mut wgpu::CommandEncoder) -> wgpu::RenderPass<'a> {
        let resolve_target = self.views.last().filter(|_| self.resolves);
        let mut attachments = Vec::new();
        for (view, clear) in self.views.iter().zip(&self.clear) {
            attachments.push(Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(*clear),
                    store: wgpu::StoreOp::Store,
                },
            }));
        }
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: &self.depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(self.far),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        encoder
            .begin_render_pass(&wgpu::RenderPassDescriptor {
                color_attachments: &attachments,
                depth_stencil_attachment: Some(depth),
                ..Default::default()
            })
            .forget_lifetime()
    }
}

fn texture(gpu: &Gpu, grid: &Grid, format: wgpu::TextureFormat, samples: u32) -> wgpu::Texture {
    let read = if samples > 1 {
        wgpu::TextureUsages::empty()
    } else if format == DEPTH {
        wgpu::TextureUsages::TEXTURE_BINDING
    } else {
        wgpu::TextureUsages::COPY_SRC
    };
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: None,
        size: grid.extent(),
        mip_level_count: 1,
        sample_count: samples,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::RENDER_ATTACHMENT | read,
        view_formats: &[],
    })
}
