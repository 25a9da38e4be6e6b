//! One world of many bodies in a card's memory.

use super::room::sized;
use super::scene::Scene;
use super::steps::Pace;
use crate::memory::{NUMBER, Staging};
use crate::{Gpu, GpuError};
use std::ops::Range;
use wgpu::Buffer;

/// A world.
#[derive(Debug)]
pub(super) struct Pile {
    /// Its state, and behind it what is given to its joints.
    pub state: Buffer,
    /// Of each contact that it remembers, the colour that it had: where colouring begins, which changes nothing.
    pub colours: Buffer,
    pub pace: Pace,
    staging: Staging,
}

impl Pile {
    pub fn new(gpu: &Gpu, scene: &Scene) -> Result<Self, GpuError> {
        let given = scene.joints.as_ref();
        let given = given.map_or(0, |joints| joints.given() * joints.count());
        Ok(Self {
            state: sized(gpu, u64::from(scene.plan.given) + given as u64)?,
            colours: sized(gpu, scene.impulse.capacity() as u64)?,
            pace: Pace::default(),
            staging: Staging::default(),
        })
    }
    /// Sets the state.
    pub fn write(&self, gpu: &Gpu, state: &[f32]) {
        let bytes = bytemuck::cast_slice(state);
        gpu.queue().write_buffer(&self.state, 0, bytes);
    }
    /// Gives numbers to the joints.
    pub fn write_given(&self, gpu: &Gpu, scene: &Scene, given: &[f32]) {
        let at = u64::from(scene.plan.given) * NUMBER;
        let bytes = bytemuck::cast_slice(given);
        gpu.queue().write_buffer(&self.state, at, bytes);
    }
    /// Reads these numbers of the state.
    pub fn read(
        &mut self,
        gpu: &Gpu,
        numbers: Range<usize>,
        read: impl FnOnce(&[f32]),
    ) -> Result<(), GpuError> {
        let encoder = gpu.device().create_command_encoder(&Default::default());
        self.staging.fetch(gpu, encoder, &self.state, numbers, read)
    }
}
