//! Worlds that are set one by one, as resets set them, and their constants.

use crate::memory::filled;
use crate::pipeline::dispatch;
use crate::{Gpu, GpuError};
use piles::WORKGROUP;

/// The columns of some worlds of a part: `columns[number][i]` of `worlds[i]`.
pub(crate) struct Placement<'a> {
    pub worlds: &'a [u32],
    pub columns: &'a [f32],
    pub width: usize,
}

impl Placement<'_> {
    /// Writes them.
    pub fn write(&self, gpu: &Gpu, memory: &wgpu::Buffer) -> Result<(), GpuError> {
        let count = self.worlds.len();
        let numbers = self.columns.len() / count;
        let pipeline = gpu.pipeline(include_str!("placement.wgsl"), None)?;
        let launch = gpu.uniform(&[count as u32, numbers as u32, self.width as u32]);
        let (columns, worlds) = (filled(gpu, self.columns)?, filled(gpu, self.worlds)?);
        let buffers = [memory, &columns, &worlds, &launch];
        let bindings = gpu.bindings(&pipeline.get_bind_group_layout(0), &buffers);
        let mut encoder = gpu.device().create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        let workgroups = (count as u32).div_ceil(WORKGROUP);
        let most = gpu.device().limits().max_compute_workgroups_per_dimension;
        dispatch(&mut pass, &pipeline, &bindings, workgroups.min(most));
        drop(pass);
        gpu.queue().submit([encoder.finish()]);
        gpu.check()
    }
}
