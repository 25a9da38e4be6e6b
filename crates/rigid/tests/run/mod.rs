//! A world that is stepped and looked at.

use crate::scene::{World, parameters};
use glam::DVec3;
use kinetarium_rigid::{Kernels, OutputTables};
use model::Model;

/// One world in double precision, from the model's initial coordinates on.
pub struct Run<K> {
    pub kernels: K,
    pub world: World<f64>,
    pub tables: OutputTables,
    parameters: Vec<f64>,
}

impl<K: Kernels> Run<K> {
    /// At a velocity, without forces and controls.
    pub fn of(kernels: K, model: &Model, velocity: &[f64]) -> Self {
        let mut world = World::new(&kernels, model);
        world.state = kernels.initial(model, &model.initial_position(), velocity);
        world.input.fill(0.0);
        Self {
            parameters: parameters(&kernels),
            tables: kernels.outputs(),
            kernels,
            world,
        }
    }
    /// Steps, and reports.
    pub fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            let mut k = self.world.cpu(&self.parameters, self.kernels.links());
            self.kernels.step(&mut k);
        }
        let mut k = self.world.cpu(&self.parameters, self.kernels.links());
        self.kernels.report(&mut k);
        assert_eq!(self.world.state[self.kernels.alive()], 1.0, "diverged");
    }
    /// Three numbers of the output.
    pub fn vec3(&self, offset: usize) -> DVec3 {
        DVec3::from_slice(&self.world.output[offset..][..3])
    }
}
