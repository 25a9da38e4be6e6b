//! What piles ask of a card, by wgpu.

use crate::clock::Clock;
use crate::memory::{Staging, buffer, indirect};
use crate::pipeline::{bind_group_layout, dispatch};
use crate::{Gpu, GpuError};
use numbers::trace::{Members, Program};
use piles::{BINDINGS, Card, NUMBER, WORKGROUP};
use sim::DeviceError;
use std::iter::{once, repeat_n};
use std::ops::Range;
use wgpu::{BindGroup, BindGroupLayout, Buffer, CommandEncoder, ComputePass, ComputePipeline};

/// What is asked of a card together: copies, and passes between them.
#[derive(Debug)]
pub struct Commands<'a> {
    /// Dropped before what it is a part of.
    pass: Option<ComputePass<'static>>,
    encoder: CommandEncoder,
    clock: Option<&'a mut Clock>,
}

impl<'a> Commands<'a> {
    fn pass(&mut self) -> &mut ComputePass<'static> {
        let (encoder, clock) = (&mut self.encoder, &mut self.clock);
        self.pass.get_or_insert_with(|| {
            let mut pass = encoder
                .begin_compute_pass(&Default::default())
                .forget_lifetime();
            if let Some(clock) = clock {
                clock.mark(&mut pass, None);
            }
            pass
        })
    }
    fn end(mut self) -> (CommandEncoder, Option<&'a mut Clock>) {
        self.pass = None;
        (self.encoder, self.clock)
    }
}

impl piles::Commands<Gpu> for Commands<'_> {
    fn run(&mut self, kernel: &ComputePipeline, bindings: &BindGroup, workgroups: u32) {
        dispatch(self.pass(), kernel, bindings, workgroups);
    }
    fn run_told(
        &mut self,
        kernel: &ComputePipeline,
        bindings: &BindGroup,
        (launches, nth): (&Buffer, u32),
        _: u32,
    ) {
        let pass = self.pass();
        pass.set_pipeline(kernel);
        pass.set_bind_group(0, bindings, &[]);
        pass.dispatch_workgroups_indirect(launches, u64::from(3 * nth) * NUMBER);
    }
    fn copy(&mut self, from: &Buffer, words: Range<usize>, to: &Buffer, at: usize) {
        self.pass = None;
        let [start, size, at] = [words.start, words.len(), at].map(|n| n as u64 * NUMBER);
        self.encoder
            .copy_buffer_to_buffer(from, start, to, at, size);
    }
    fn mark(&mut self, stage: &'static str) {
        if self.clock.is_some() {
            self.pass();
        }
        if let (Some(clock), Some(pass)) = (&mut self.clock, &mut self.pass) {
            clock.mark(pass, Some(stage));
        }
    }
}

impl Card for Gpu {
    type Buffer = Buffer;
    type Layout = BindGroupLayout;
    type Bindings = BindGroup;
    type Kernel = ComputePipeline;
    type Staging = Staging;
    type Clock = Clock;
    type Commands<'a> = Commands<'a>;

    fn name(&self) -> &str {
        Gpu::name(self)
    }
    fn most_bytes(&self) -> u64 {
        Gpu::most_bytes(self)
    }
    fn most_invocations(&self) -> u32 {
        let groups = self.device().limits().max_compute_workgroups_per_dimension;
        groups.saturating_mul(WORKGROUP)
    }
    fn cuts_loops(&self) -> bool {
        Gpu::cuts_loops(self)
    }
    fn check(&self) -> Result<(), DeviceError> {
        Ok(Gpu::check(self)?)
    }
    fn failed(&self, reason: &str) -> DeviceError {
        Gpu::failed(self, reason).into()
    }

    fn buffer(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(buffer(self, words)?)
    }
    fn launches(&self, words: u64) -> Result<Buffer, DeviceError> {
        Ok(indirect(self, words)?)
    }
    fn uniform(&self, words: &[u32]) -> Result<Buffer, DeviceError> {
        Ok(Gpu::uniform(self, words))
    }
    fn room(buffer: &Buffer) -> u64 {
        buffer.size() / NUMBER
    }
    fn write(&self, buffer: &Buffer, from: u64, bytes: &[u8]) -> Result<(), DeviceError> {
        self.queue().write_buffer(buffer, from * NUMBER, bytes);
        Ok(())
    }

    fn layout(&self, written: usize, read: usize) -> Result<BindGroupLayout, DeviceError> {
        let (needed, limits) = (written + read, self.device().limits());
        let most = limits.max_storage_buffers_per_shader_stage;
        if most < needed as u32 {
            return Err(GpuError::Buffers {
                needed,
                most,
                card: Gpu::name(self).to_owned(),
            }
            .into());
        }
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let kinds = repeat_n(storage(false), written).chain(repeat_n(storage(true), read));
        let uniform = once(wgpu::BufferBindingType::Uniform);
        Ok(bind_group_layout(self.device(), kinds.chain(uniform)))
    }
    fn entries<const N: usize>(
        &self,
        text: &str,
        names: [&'static str; N],
        layout: &BindGroupLayout,
    ) -> Result<[ComputePipeline; N], DeviceError> {
        Ok(Gpu::entries(self, text, names, Some(layout))?)
    }
    fn bind(&self, layout: &BindGroupLayout, buffers: &[&Buffer]) -> BindGroup {
        self.bindings(layout, buffers)
    }
    fn kernel(
        &self,
        program: &Program,
        parameters_per_world: bool,
        members: Members,
    ) -> Result<ComputePipeline, DeviceError> {
        Ok(Gpu::kernel(self, program, parameters_per_world, members)?)
    }
    fn bind_kernel(&self, buffers: [&Buffer; BINDINGS]) -> BindGroup {
        self.bindings(Gpu::layout(self), &buffers)
    }

    fn clock(&self) -> Option<Clock> {
        Clock::new(self)
    }
    fn times(clock: Clock) -> Vec<(&'static str, f64)> {
        clock.times()
    }
    fn commands<'a>(&self, clock: Option<&'a mut Clock>) -> Commands<'a> {
        Commands {
            pass: None,
            encoder: self.device().create_command_encoder(&Default::default()),
            clock,
        }
    }
    fn submit(&self, commands: Commands<'_>) -> Result<(), DeviceError> {
        let (encoder, _) = commands.end();
        self.queue().submit([encoder.finish()]);
        Ok(())
    }
    fn fetch(
        &self,
        commands: Commands<'_>,
        staging: &mut Staging,
        buffer: &Buffer,
        ranges: impl Iterator<Item = Range<usize>> + Clone,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), DeviceError> {
        let (encoder, clock) = commands.end();
        staging.fetch(self, encoder, buffer, ranges, read)?;
        match clock {
            Some(clock) => Ok(clock.read(self)?),
            None => Ok(()),
        }
    }
}
