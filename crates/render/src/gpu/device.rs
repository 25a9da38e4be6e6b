//! The card.

use crate::RenderError;
use adapter::Choice;
use std::sync::{Arc, Mutex, PoisonError};
use thiserror::Error;

/// Why a graphics card drew nothing.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum GpuError {
    /// What was asked for is wrong.
    #[error(transparent)]
    Render(#[from] RenderError),
    /// No card suits the choice.
    #[error(transparent)]
    NoCard(#[from] adapter::NoCard),
    /// The card refuses.
    #[error("the graphics card cannot be used: {0}; use the ray-caster")]
    NoDevice(#[from] wgpu::RequestDeviceError),
    /// The card failed.
    #[error("the graphics card failed: {0}; draw fewer or smaller images at once")]
    Failed(String),
    /// More samples than cards take.
    #[error(
        "{samples} samples along each edge of a pixel: ask for 1 or 2 on a graphics card, or use the ray-caster"
    )]
    Samples {
        /// How many were asked for.
        samples: usize,
    },
    /// An image is larger than what the card draws into.
    #[error(
        "images of {width} × {height} pixels: this graphics card draws at most {most} along each edge; ask for \
         smaller ones, or use the ray-caster"
    )]
    TooLarge {
        /// Pixels of a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Most of either.
        most: usize,
    },
    /// Only the ray-caster has them.
    #[error("{rays} occlusion rays: ask for 0 on a graphics card, or use the ray-caster")]
    Occlusion {
        /// How many were asked for.
        rays: usize,
    },
}

/// A card, ready to draw.
#[derive(Debug)]
pub(super) struct Gpu {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
    info: wgpu::AdapterInfo,
    /// What went wrong first, which cards tell late.
    failure: Arc<Mutex<Option<String>>>,
}

impl Gpu {
    pub fn new(choice: &Choice) -> Result<Self, GpuError> {
        let adapter = choice.adapter()?;
        let wanted = wgpu::DeviceDescriptor {
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&wanted))?;
        let failure = Arc::new(Mutex::new(None));
        let first = Arc::clone(&failure);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            let mut first = first.lock().unwrap_or_else(PoisonError::into_inner);
            first.get_or_insert(error.to_string());
        }));
        Ok(Self {
            device,
            queue,
            info: adapter.get_info(),
            failure,
        })
    }

    /// An error if anything went wrong since this was last asked.
    pub fn check(&self) -> Result<(), GpuError> {
        let mut failure = self.failure.lock().unwrap_or_else(PoisonError::into_inner);
        failure.take().map_or(Ok(()), |e| Err(GpuError::Failed(e)))
    }

    pub fn name(&self) -> String {
        format!("{} ({})", self.info.name, self.info.backend)
    }
    /// Most texels of an edge of a target.
    pub fn most_texels(&self) -> usize {
        self.device.limits().max_texture_dimension_2d as usize
    }

    /// A buffer that holds this, which is made to hold something.
    pub fn buffer(&self, bytes: &[u8], usage: wgpu::BufferUsages) -> wgpu::Buffer {
        let buffer = self.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: bytes.len().next_multiple_of(16).max(256) as u64,
            usage: usage | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        self.queue.write_buffer(&buffer, 0, bytes);
        buffer
    }
    pub fn encoder(&self) -> wgpu::CommandEncoder {
        self.device.create_command_encoder(&Default::default())
    }
    pub fn submit(&self, encoder: wgpu::CommandEncoder) {
        self.queue.submit([encoder.finish()]);
    }
}
