//! Worlds of many bodies that touch, by `impulse`: one world after the other, each by all of the card.
//!
//! A step is what it is on the processor (`sim/src/impulse`), by the same kernels: of bodies, shapes, pairs of shapes,
//! contacts and joints, one in each invocation. What lies between them is WGSL: which shapes, and which triangles of a
//! mesh, are near each other, which contact was there before, which colour it has. It finds the pairs in order, and the
//! colours that contacts get one after the other, so that a step is the processor's but for rounding.
//!
//! Nothing comes back within a step. What depends on what it finds, rounds of colouring and of blows and parts into which
//! it is cut, the host launches as often as in the steps before. Where that was not right, or there is too little room for
//! pairs, contacts or colours, nothing is written, or what parts before have written is undone, and the step is taken again.
//!
//! What is rare is left to the processor: a step in which something gets farther than it was looked for, or is stopped at
//! its centre of mass, in which a body has more contacts than there are colours, or more triangles near it than there is
//! room for, or is lost; and one for which the card has no more room.
//!
//! Nothing sleeps in the steps that a card takes.

mod joints;
mod kernels;
mod meshes;
mod pile;
mod plan;
mod room;
mod scene;
mod steps;

use crate::clock::Clock;
use crate::{Gpu, GpuError};
use kernels::Kernels;
use model::{CollisionFilter, Model};
use numbers::Memory;
use pile::Pile;
use rigid::Report;
use rigid::impulse::Impulse;
use scene::Scene;
use sim::{DeviceError, DeviceWorlds, Processor};
use std::ops::Range;
use steps::{Progress, Steps};

/// Pairs of triangles of two meshes that programs get through: their loops end early, and say nothing.
const PAIRS_OF_PROGRAMS: usize = 256;

/// Worlds of piles on a card.
#[derive(Debug)]
pub(crate) struct Piles {
    gpu: Gpu,
    scene: Scene,
    kernels: Kernels,
    steps: Steps,
    worlds: Vec<Pile>,
    /// Steps that the processor has taken.
    left: u64,
}

impl Piles {
    /// # Errors
    /// The model has what cards do not know; the card refuses.
    pub fn new(
        gpu: &Gpu,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Self, GpuError> {
        gpu.check()?;
        let scene = Scene::new(impulse, model, filter)?;
        let pairs = scene.groups.iter().map(|group| group.triangles);
        let most = pairs.map(|[a, b]| a * b).max().unwrap_or(0);
        if gpu.cuts_loops() && most > PAIRS_OF_PROGRAMS {
            return Err(GpuError::Unsupported {
                what: "meshes of many triangles that meet, where a program stands in for it,",
                remedy: "run on the processor, or on a card",
            });
        }
        let kernels = Kernels::new(gpu, &scene)?;
        let piles = (0..worlds).map(|_| Pile::new(gpu, &scene));
        Ok(Self {
            steps: Steps::new(gpu, &scene, &kernels)?,
            worlds: piles.collect::<Result<_, _>>()?,
            left: 0,
            gpu: gpu.clone(),
            scene,
            kernels,
        })
    }

    fn write_world(&self, world: usize, state: &Memory<f32>) {
        let numbers = 0..self.scene.impulse.lengths().state;
        let numbers: Vec<_> = numbers.map(|i| state.get(world, i)).collect();
        self.worlds[world].write(&self.gpu, &numbers);
    }

    /// Has the processor take steps of a world.
    fn step_there(
        &mut self,
        world: usize,
        steps: usize,
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), GpuError> {
        let pile = &mut self.worlds[world];
        let mut state = Vec::new();
        let all = 0..self.scene.impulse.lengths().state;
        pile.read(&self.gpu, all, |numbers| state = numbers.to_vec())?;
        processor(world, steps, &mut state);
        self.left += steps as u64;
        pile.write(&self.gpu, &state);
        Ok(())
    }
}

impl DeviceWorlds<f32> for Piles {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        (0..self.worlds.len()).for_each(|world| self.write_world(world, state));
        Ok(self.gpu.check()?)
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        worlds
            .iter()
            .for_each(|world| self.write_world(*world, state));
        Ok(self.gpu.check()?)
    }
    fn write_input(&mut self, _: Range<usize>, input: &Memory<f32>) -> Result<(), DeviceError> {
        let numbers = 0..self.scene.impulse.lengths().input;
        for (world, pile) in self.worlds.iter_mut().enumerate() {
            // What is made of them goes to the card before the next step: they may change once more.
            pile.input = Some(numbers.clone().map(|i| input.get(world, i)).collect());
        }
        Ok(())
    }
    fn write_parameters(&mut self, _: &Memory<f32>) -> Result<(), DeviceError> {
        self.takes_constants()
    }
    fn takes_constants(&self) -> Result<(), DeviceError> {
        Err(DeviceError::from(GpuError::Constants))
    }
    fn step(
        &mut self,
        substeps: usize,
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), DeviceError> {
        for world in 0..self.worlds.len() {
            if let Some(input) = self.worlds[world].input.take() {
                self.worlds[world].write_input(&self.gpu, &self.scene, &input);
            }
            let mut left = substeps;
            while left > 0 {
                let pile = &mut self.worlds[world];
                let steps = &mut self.steps;
                match steps.take(&self.gpu, &self.scene, &self.kernels, pile, left)? {
                    Progress::Taken(steps) => left -= steps,
                    Progress::Dead => left = 0,
                    Progress::Processor(steps) => {
                        self.step_there(world, 1, processor)?;
                        left -= steps + 1;
                    }
                }
            }
        }
        Ok(())
    }
    fn left(&self) -> u64 {
        self.left
    }
    fn start_clock(&mut self) {
        self.steps.clock = Clock::new(&self.gpu);
    }
    fn stop_clock(&mut self) -> Vec<(&'static str, f64)> {
        self.steps.clock.take().map_or(Vec::new(), Clock::times)
    }
    fn reports(&self) -> bool {
        false
    }
    fn report(&mut self, _: Report) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read_state(
        &mut self,
        numbers: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for (world, pile) in self.worlds.iter_mut().enumerate() {
            for range in numbers {
                pile.read(&self.gpu, range.clone(), |read| {
                    for (i, x) in range.clone().zip(read) {
                        state.set(world, i, *x);
                    }
                })?;
            }
        }
        Ok(())
    }
    fn read_output(&mut self, _: &[Range<usize>], _: &mut Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
}
