//! Worlds of many bodies that touch, by `impulse`, each by all of the card: as many side by side as it has room for.
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

mod batch;
mod constants;
mod joints;
mod kernels;
mod launches;
mod meshes;
mod pace;
mod plan;
mod room;
mod scene;
mod steps;

use crate::clock::Clock;
use crate::{Gpu, GpuError};
use batch::Batch;
use kernels::Kernels;
use model::{CollisionFilter, Model};
use numbers::Memory;
use rigid::Report;
use rigid::impulse::Impulse;
use scene::Scene;
use sim::{DeviceError, DeviceWorlds, Processor};
use std::ops::Range;
use steps::Steps;

/// Pairs of triangles of two meshes that programs get through: their loops end early, and say nothing.
const PAIRS_OF_PROGRAMS: usize = 256;

/// Worlds of piles on a card.
#[derive(Debug)]
pub(crate) struct Piles {
    gpu: Gpu,
    scene: Scene,
    kernels: Kernels,
    steps: Steps,
    batches: Vec<Batch>,
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
        let scene = Scene::new(gpu, impulse, model, filter, worlds)?;
        let pairs = scene.groups.iter().map(|group| group.triangles);
        let most = pairs.map(|[a, b]| a * b).max().unwrap_or(0);
        if gpu.cuts_loops() && most > PAIRS_OF_PROGRAMS {
            return Err(GpuError::Unsupported {
                what: "meshes of many triangles that meet, where a program stands in for it,",
                remedy: "run on the processor, or on a card",
            });
        }
        let kernels = Kernels::new(gpu, &scene)?;
        let width = scene.plan.worlds as usize;
        let batches = (0..worlds).step_by(width).map(|first| {
            let end = worlds.min(first + width);
            Batch::new(gpu, &scene, first..end)
        });
        let batches = batches.collect::<Result<_, _>>()?;
        Ok(Self {
            steps: Steps::new(gpu, &scene, &kernels)?,
            batches,
            left: 0,
            gpu: gpu.clone(),
            scene,
            kernels,
        })
    }

    fn write_world(&mut self, world: usize, state: &Memory<f32>) {
        let numbers = 0..self.scene.impulse.lengths().state;
        let numbers: Vec<_> = numbers.map(|i| state.get(world, i)).collect();
        let batch = world / self.scene.plan.worlds as usize;
        self.batches[batch].write(&self.gpu, &self.scene, world, &numbers);
    }

    /// Has the processor take a step of some worlds of a batch, counted from its first.
    fn step_there(
        &mut self,
        batch: usize,
        worlds: &[usize],
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), GpuError> {
        let (gpu, scene, batch) = (&self.gpu, &self.scene, &mut self.batches[batch]);
        let first = batch.worlds.start;
        let ranges = worlds.iter().map(|nth| batch.numbers(scene, *nth));
        let ranges = Vec::from_iter(ranges);
        let mut states = Vec::new();
        batch.read(gpu, ranges.into_iter(), |read| states = read.to_vec())?;
        let length = scene.impulse.lengths().state;
        for (nth, state) in worlds.iter().zip(states.chunks_exact_mut(length)) {
            processor(first + nth, 1, state);
            batch.left[*nth] -= 1;
            batch.write(gpu, scene, first + nth, state);
        }
        self.left += worlds.len() as u64;
        Ok(())
    }
}

impl DeviceWorlds<f32> for Piles {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        (0..state.worlds()).for_each(|world| self.write_world(world, state));
        Ok(self.gpu.check()?)
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        worlds
            .iter()
            .for_each(|world| self.write_world(*world, state));
        Ok(self.gpu.check()?)
    }
    fn write_input(
        &mut self,
        numbers: Range<usize>,
        input: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        let numbers = numbers.start..numbers.end.min(self.scene.impulse.lengths().input);
        let batches = self.batches.iter_mut();
        batches.for_each(|batch| batch.control(numbers.clone(), input));
        Ok(())
    }
    fn write_parameters(&mut self, parameters: &Memory<f32>) -> Result<(), DeviceError> {
        let numbers = 0..self.scene.impulse.parameters().len();
        let sets = (0..parameters.worlds()).map(|world| {
            let own = numbers.clone().map(|i| parameters.get(world, i));
            own.collect()
        });
        self.scene.differ(sets.collect())?;
        self.steps.renew(&self.gpu, &self.scene);
        self.batches.iter_mut().for_each(Batch::differs);
        Ok(())
    }
    fn takes(&self, parameters: &[&[f64]]) -> Result<(), DeviceError> {
        let sets = parameters.iter();
        let sets = sets.map(|set| set.iter().map(|x| *x as f32).collect());
        Ok(self.scene.takes(&self.gpu, &Vec::from_iter(sets))?)
    }
    fn step(
        &mut self,
        substeps: usize,
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), DeviceError> {
        for nth in 0..self.batches.len() {
            let batch = &mut self.batches[nth];
            batch.tell(&self.gpu, &self.scene);
            batch.ask(substeps);
            while self.batches[nth].is_behind() {
                let batch = &mut self.batches[nth];
                let steps = &mut self.steps;
                let left = steps.take(&self.gpu, &self.scene, &self.kernels, batch)?;
                if !left.is_empty() {
                    self.step_there(nth, &left, processor)?;
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
        for batch in &mut self.batches {
            batch.read_all(&self.gpu, &self.scene, numbers, state)?;
        }
        Ok(())
    }
    fn read_output(&mut self, _: &[Range<usize>], _: &mut Memory<f32>) -> Result<(), DeviceError> {
        Ok(())
    }
}
