//! Numbers in a card's memory.

use crate::{Gpu, GpuError};
use bytemuck::NoUninit;
use std::ops::Range;
use std::sync::mpsc;

/// Bytes of a number.
pub(crate) const NUMBER: u64 = size_of::<f32>() as u64;

/// A buffer of so many numbers; of one where there is none, as cards have no empty buffers.
pub(crate) fn buffer(gpu: &Gpu, numbers: u64) -> Result<wgpu::Buffer, GpuError> {
    let size = numbers.max(2) * NUMBER;
    let (buffer, full) = gpu.scoped(wgpu::ErrorFilter::OutOfMemory, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::STORAGE
                | wgpu::BufferUsages::COPY_SRC
                | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    });
    match full {
        None => Ok(buffer),
        Some(_) => Err(GpuError::Memory {
            bytes: size,
            card: gpu.name().to_owned(),
        }),
    }
}

/// A buffer that holds this.
pub(crate) fn filled<T: NoUninit>(gpu: &Gpu, numbers: &[T]) -> Result<wgpu::Buffer, GpuError> {
    let buffer = buffer(gpu, numbers.len() as u64)?;
    gpu.queue()
        .write_buffer(&buffer, 0, bytemuck::cast_slice(numbers));
    Ok(buffer)
}

/// Copies a range of a buffer's numbers into `out`. Waits for all that was asked of the card before.
pub(crate) fn read(
    gpu: &Gpu,
    buffer: &wgpu::Buffer,
    range: Range<usize>,
    out: &mut [f32],
) -> Result<(), GpuError> {
    let size = range.len() as u64 * NUMBER;
    if size == 0 {
        return Ok(());
    }
    let (staging, full) = gpu.scoped(wgpu::ErrorFilter::OutOfMemory, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        })
    });
    if full.is_some() {
        return Err(GpuError::Memory {
            bytes: size,
            card: gpu.name().to_owned(),
        });
    }
    let mut encoder = gpu.device().create_command_encoder(&Default::default());
    encoder.copy_buffer_to_buffer(buffer, range.start as u64 * NUMBER, &staging, 0, size);
    gpu.queue().submit([encoder.finish()]);
    let (sender, mapped) = mpsc::channel();
    staging.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below.
        let _ = sender.send(result);
    });
    gpu.wait()?;
    let mapped = mapped.recv().map_err(|e| gpu.failed(e))?;
    mapped.map_err(|e| gpu.failed(e))?;
    let bytes = staging.get_mapped_range(..).map_err(|e| gpu.failed(e))?;
    out.copy_from_slice(bytemuck::cast_slice(&bytes));
    Ok(())
}
