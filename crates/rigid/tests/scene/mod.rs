//! Models and memories to run kernels on.

mod models;

use kinetarium_rigid::{InputTables, Kernels};
use model::Model;
#[allow(unused_imports)] // for tests that bring models of their own
pub use models::*;
use numbers::{Cpu, Float, Known, Shared};

/// The memories of one world.
#[derive(Clone, Debug)]
pub struct World<R> {
    pub state: Vec<R>,
    pub input: Vec<R>,
    pub output: Vec<R>,
    pub scratch: Vec<R>,
}

/// Parameters in the precision of `T`.
pub fn parameters<T: Float>(kernels: &impl Kernels) -> Vec<T> {
    kernels
        .parameters()
        .iter()
        .map(|&x| T::from_f64(x))
        .collect()
}

impl<R: Known> World<R> {
    /// A world in motion, under controls of every sort.
    pub fn new(kernels: &impl Kernels, model: &Model) -> Self {
        let wave = |i: usize| (1.7 * i as f64 + 0.4).sin();
        let velocity: Vec<_> = (0..model.degrees_of_freedom()).map(wave).collect();
        let state = kernels.initial(model, &model.initial_position(), &velocity);
        let inputs = InputTables::new(model);
        let mut input = inputs.initial(model);
        for v in 0..model.degrees_of_freedom() {
            input[inputs.force.at(v, 0)] = 0.3 * wave(v + 1);
        }
        for a in 0..model.actuators.len() {
            input[inputs.control.at(a, 0)] = wave(a + 2);
        }
        let numbers = |x: Vec<f64>| x.into_iter().map(R::lit).collect();
        let lengths = kernels.lengths();
        Self {
            state: numbers(state),
            input: numbers(input),
            output: vec![R::zero(); lengths.output],
            scratch: vec![R::zero(); lengths.scratch],
        }
    }

    /// The machine that runs a kernel on this world.
    pub fn cpu<'a>(
        &'a mut self,
        parameters: &'a [R::Scalar],
        links: &'a [u32],
    ) -> Cpu<'a, R, Shared<'a, R>> {
        Cpu {
            state: &mut self.state,
            input: &self.input,
            output: &mut self.output,
            scratch: &mut self.scratch,
            parameters: Shared(parameters),
            links,
        }
    }
}
