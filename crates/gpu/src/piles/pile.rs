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
    /// Its state, and behind it what acts on its bodies, and what is given to its joints.
    pub state: Buffer,
    /// Controls that the card has not been told of.
    pub input: Option<Vec<f32>>,
    /// Whether anything acts on its bodies from outside.
    pub pushed: bool,
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
            input: None,
            pushed: false,
            pace: Pace::default(),
            staging: Staging::default(),
        })
    }
    /// Sets the state.
    pub fn write(&self, gpu: &Gpu, state: &[f32]) {
        let bytes = bytemuck::cast_slice(state);
        gpu.queue().write_buffer(&self.state, 0, bytes);
    }
    /// Tells the card what controls make of forces on bodies, and of joints.
    pub fn write_input(&mut self, gpu: &Gpu, scene: &Scene, input: &[f32]) {
        let write = |at: u32, numbers: &[f32]| {
            let bytes = bytemuck::cast_slice(numbers);
            let at = u64::from(at) * NUMBER;
            gpu.queue().write_buffer(&self.state, at, bytes);
        };
        let impulse = &scene.impulse;
        if let Some(joints) = &scene.joints {
            let given = joints.given_by(impulse, &scene.parameters, input);
            write(scene.plan.given, &given);
        }
        let pushed = impulse.is_pushed(input);
        if pushed || self.pushed {
            let bodies = impulse.rows();
            let mut forces = vec![0.0; 6 * bodies];
            for (row, given) in impulse.pushes(input) {
                (0..6).for_each(|i| forces[i * bodies + row] = given[i]);
            }
            write(scene.plan.forces, &forces);
        }
        self.pushed = pushed;
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
