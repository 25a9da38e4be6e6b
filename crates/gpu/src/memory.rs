//! Numbers in a card's memory.
//!
//! There, a world's number at `offset` lies at `offset · width + world`: neighbouring invocations read neighbouring
//! words. On the host, worlds lie in the blocks of a [`Memory`](numbers::Memory), which knows such
//! [rows](numbers::Memory::rows).

use crate::{Gpu, GpuError};
use bytemuck::NoUninit;
use piles::NUMBER;
use std::ops::Range;
use std::sync::mpsc;

const STORAGE: wgpu::BufferUsages = wgpu::BufferUsages::STORAGE
    .union(wgpu::BufferUsages::COPY_SRC)
    .union(wgpu::BufferUsages::COPY_DST);
const STAGING: wgpu::BufferUsages =
    wgpu::BufferUsages::MAP_READ.union(wgpu::BufferUsages::COPY_DST);

/// A buffer of so many numbers; of two where there are none, as cards have no empty buffers.
pub(crate) fn buffer(gpu: &Gpu, numbers: u64) -> Result<wgpu::Buffer, GpuError> {
    allocate(gpu, numbers.max(2), STORAGE)
}

/// A buffer of so many numbers that say how many workgroups there are.
pub(crate) fn indirect(gpu: &Gpu, numbers: u64) -> Result<wgpu::Buffer, GpuError> {
    allocate(gpu, numbers, STORAGE.union(wgpu::BufferUsages::INDIRECT))
}

fn allocate(gpu: &Gpu, numbers: u64, usage: wgpu::BufferUsages) -> Result<wgpu::Buffer, GpuError> {
    let size = numbers * NUMBER;
    let full = || GpuError::Memory {
        bytes: size,
        card: gpu.name().to_owned(),
    };
    // More than that is no shortage to wgpu, but a mistake, by which the card fails.
    if size > gpu.device().limits().max_buffer_size {
        return Err(full());
    }
    let (buffer, refused) = gpu.scoped(wgpu::ErrorFilter::OutOfMemory, || {
        gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage,
            mapped_at_creation: false,
        })
    });
    match refused {
        None => Ok(buffer),
        Some(_) => Err(full()),
    }
}

/// A buffer that holds this.
pub(crate) fn filled<T: NoUninit>(gpu: &Gpu, numbers: &[T]) -> Result<wgpu::Buffer, GpuError> {
    let buffer = buffer(gpu, numbers.len() as u64)?;
    let bytes = bytemuck::cast_slice(numbers);
    gpu.queue().write_buffer(&buffer, 0, bytes);
    Ok(buffer)
}

/// Where numbers wait on their way to the host. It grows, and is kept.
#[derive(Debug, Default)]
pub struct Staging(Option<wgpu::Buffer>);

impl Staging {
    /// Asks for these ranges of a buffer's numbers, one after the other.
    pub fn ask(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
    ) -> Result<(), GpuError> {
        let numbers: usize = ranges.clone().map(|range| range.len()).sum();
        let size = numbers as u64 * NUMBER;
        if self.0.as_ref().is_none_or(|own| own.size() < size) {
            self.0 = Some(allocate(gpu, numbers as u64, STAGING)?);
        }
        let Some(staging) = &self.0 else {
            return Ok(());
        };
        let mut end = 0;
        for range in ranges {
            let (from, size) = (range.start as u64 * NUMBER, range.len() as u64 * NUMBER);
            encoder.copy_buffer_to_buffer(buffer, from, staging, end, size);
            end += size;
        }
        Ok(())
    }
    /// Submits what was asked of the card before, waits for it, and reads ranges of a buffer's numbers.
    pub fn fetch(
        &mut self,
        gpu: &Gpu,
        mut encoder: wgpu::CommandEncoder,
        buffer: &wgpu::Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), GpuError> {
        let numbers = ranges.clone().map(|range| range.len()).sum();
        self.ask(gpu, &mut encoder, buffer, ranges)?;
        gpu.queue().submit([encoder.finish()]);
        let Some(mapping) = self.map() else {
            return Ok(());
        };
        gpu.wait()?;
        // What was asked for in an earlier, longer question lies behind it.
        mapping.read(gpu, |all| read(&all[..numbers]))
    }
    /// Begins to fetch what was asked for; to be called once the questions are submitted.
    pub(crate) fn map(&self) -> Option<Mapping<'_>> {
        let buffer = self.0.as_ref()?;
        let (sender, receiver) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, .., move |result| {
            // The receiver goes only where the reader gave up.
            let _ = sender.send(result);
        });
        Some(Mapping { buffer, receiver })
    }
}

/// Numbers on their way.
pub(crate) struct Mapping<'a> {
    buffer: &'a wgpu::Buffer,
    receiver: mpsc::Receiver<Result<(), wgpu::BufferAsyncError>>,
}

impl Mapping<'_> {
    /// Reads what was asked for, after the card was waited for.
    pub fn read(self, gpu: &Gpu, read: impl FnOnce(&[f32])) -> Result<(), GpuError> {
        let mapped = self.receiver.recv().map_err(|e| gpu.failed(e))?;
        mapped.map_err(|e| gpu.failed(e))?;
        let bytes = self.buffer.get_mapped_range(..);
        let bytes = bytes.map_err(|e| gpu.failed(e))?;
        read(bytemuck::cast_slice(&bytes));
        drop(bytes);
        self.buffer.unmap();
        Ok(())
    }
}
