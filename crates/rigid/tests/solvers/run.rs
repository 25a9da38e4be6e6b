//! A world that is stepped and looked at.

use crate::scene::{World, parameters};
use glam::DVec3;
use kinetarium_rigid::{Kernels, OutputTables, body as of_body, contact as of_contact};
use model::Model;
use numbers::Machine;

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
    /// Steps, in parts that compile in seconds, and reports.
    pub fn step(&mut self, steps: usize) {
        for _ in 0..steps {
            let mut k = self.world.cpu(&self.parameters, self.kernels.links());
            self.kernels.step_in_parts(&mut k);
        }
        let mut k = self.world.cpu(&self.parameters, self.kernels.links());
        report(&self.kernels, &mut k);
        assert_eq!(self.world.state[self.kernels.alive()], 1.0, "diverged");
    }
    /// Where the first body is [m].
    pub fn position(&self) -> DVec3 {
        self.body(0, of_body::POSITION)
    }
    /// Its velocity [m/s].
    pub fn velocity(&self) -> DVec3 {
        self.body(0, of_body::VELOCITY)
    }
    /// Its angular velocity [rad/s].
    pub fn spin(&self) -> DVec3 {
        self.body(0, of_body::ANGULAR_VELOCITY)
    }
    /// Three numbers of a body.
    pub fn body(&self, body: usize, field: usize) -> DVec3 {
        self.vec3(self.tables.body.at(body, field))
    }
    /// Kinetic and potential energy [J].
    pub fn energy(&self) -> f64 {
        let total = self.tables.total.at(0, 0);
        self.world.output[total] + self.world.output[total + 1]
    }
    /// The force of each contact [N]; zero where there is none.
    pub fn forces(&self) -> impl Iterator<Item = DVec3> {
        let force = |slot| self.vec3(self.tables.contact.at(slot, of_contact::FORCE));
        (0..self.tables.contacts).map(force)
    }
    /// Three numbers of the output.
    pub fn vec3(&self, offset: usize) -> DVec3 {
        DVec3::from_slice(&self.world.output[offset..][..3])
    }
}

/// What a solver reports, as a function that is called: compiled once, whoever asks.
#[inline(never)]
pub fn report<M: Machine>(kernels: &impl Kernels, k: &mut M) {
    kernels.report(k);
}
