//! Worlds of piles on a card.

use crate::Card;
use crate::actuators::Actuators;
use crate::batch::Batch;
use crate::kernels::Kernels;
use crate::report::{Reports, Told};
use crate::scene::{Scene, unsupported};
use crate::steps::Steps;
use model::{CollisionFilter, Model};
use numbers::Memory;
use rigid::Report;
use rigid::impulse::Impulse;
use sim::{DeviceError, DeviceWorlds, Processor, Stage};
use std::ops::Range;

/// Pairs of triangles of two meshes that programs get through: their loops end early, and say nothing.
const PAIRS_OF_PROGRAMS: usize = 256;

/// Worlds of piles on a card.
#[derive(Debug)]
pub struct Piles<C: Card> {
    card: C,
    scene: Scene,
    kernels: Kernels<C>,
    steps: Steps<C>,
    actuators: Option<Actuators<C>>,
    reports: Reports<C>,
    batches: Vec<Batch<C>>,
    /// Steps that the processor has taken.
    left: u64,
}

impl<C: Card> Piles<C> {
    /// # Errors
    /// The model has what cards do not know; the card refuses.
    pub fn new(
        card: &C,
        impulse: &Impulse,
        model: &Model,
        filter: Option<&CollisionFilter>,
        worlds: usize,
    ) -> Result<Self, DeviceError> {
        card.check()?;
        let scene = Scene::new(card, impulse, model, filter, worlds)?;
        let pairs = scene.groups.iter().map(|group| group.triangles);
        let most = pairs.map(|[a, b]| a * b).max().unwrap_or(0);
        if card.cuts_loops() && most > PAIRS_OF_PROGRAMS {
            return Err(unsupported(
                "meshes of many triangles that meet, where a program stands in for it,",
                "run on the processor, or on a card",
            )
            .into());
        }
        let kernels = Kernels::new(card, &scene)?;
        let joints = scene.joints.as_ref();
        let actuators = joints.map(|joints| Actuators::new(card, &scene, joints));
        let width = scene.plan.worlds as usize;
        let batches = (0..worlds).step_by(width).map(|first| {
            let end = worlds.min(first + width);
            Batch::new(card, &scene, first..end)
        });
        let batches = batches.collect::<Result<_, _>>()?;
        Ok(Self {
            reports: Reports::new(card, &scene, worlds, width.min(worlds))?,
            steps: Steps::new(card, &scene, &kernels)?,
            actuators: actuators.transpose()?,
            batches,
            left: 0,
            card: card.clone(),
            scene,
            kernels,
        })
    }

    /// Sets the states of worlds of one batch that follow each other.
    fn write(&mut self, worlds: Range<usize>, state: &Memory<f32>) -> Result<(), DeviceError> {
        let length = self.scene.impulse.lengths().state;
        let batch = worlds.start / self.scene.plan.worlds as usize;
        let first = worlds.start;
        let numbers = worlds.flat_map(|world| (0..length).map(move |i| state.get(world, i)));
        let mut numbers = Vec::from_iter(numbers);
        // Kernels do not ask which steps led to a state.
        let states = numbers.chunks_exact_mut(length);
        states.for_each(|state| self.scene.impulse.fit(state));
        self.batches[batch].write(&self.card, &self.scene, first, &numbers)
    }

    /// Has the processor take a step of some worlds of a batch, counted from its first.
    fn step_there(
        &mut self,
        batch: usize,
        worlds: &[usize],
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), DeviceError> {
        let (card, scene, batch) = (&self.card, &self.scene, &mut self.batches[batch]);
        let first = batch.worlds.start;
        let ranges = worlds.iter().map(|nth| batch.numbers(scene, *nth));
        let ranges = Vec::from_iter(ranges);
        let mut states = Vec::new();
        batch.read(card, ranges.into_iter(), |read| states = read.to_vec())?;
        let length = scene.impulse.lengths().state;
        for (nth, state) in worlds.iter().zip(states.chunks_exact_mut(length)) {
            processor(first + nth, 1, state);
            batch.left[*nth] -= 1;
            batch.write(card, scene, first + nth, state)?;
        }
        self.left += worlds.len() as u64;
        Ok(())
    }
}

impl<C: Card> DeviceWorlds<f32> for Piles<C> {
    fn write_state(&mut self, state: &Memory<f32>) -> Result<(), DeviceError> {
        for batch in 0..self.batches.len() {
            self.write(self.batches[batch].worlds.clone(), state)?;
        }
        self.card.check()
    }
    fn write_worlds(&mut self, worlds: &[usize], state: &Memory<f32>) -> Result<(), DeviceError> {
        let mut worlds = worlds.iter();
        worlds.try_for_each(|&world| self.write(world..world + 1, state))?;
        self.card.check()
    }
    fn write_input(
        &mut self,
        numbers: Range<usize>,
        input: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        let batches = self.batches.iter_mut();
        batches.for_each(|batch| batch.control(numbers.clone(), input));
        Ok(())
    }
    fn write_parameters(
        &mut self,
        worlds: &[usize],
        parameters: &Memory<f32>,
    ) -> Result<(), DeviceError> {
        let all = Vec::from_iter(0..parameters.worlds());
        let numbers = 0..self.scene.impulse.parameters().len();
        let set = |&world: &usize| {
            let own = numbers.clone().map(|i| parameters.get(world, i));
            (world, own.collect())
        };
        let differ = self.scene.parameters.differ();
        let sets = if differ { worlds } else { &all }.iter().map(set);
        let anew = self.scene.differ(sets.collect())?;
        if anew {
            self.steps.renew(&self.card, &self.scene)?;
        }
        let changed = if anew { &all } else { worlds };
        self.actuators.iter_mut().for_each(Actuators::differs);
        for batch in &mut self.batches {
            let own = changed.iter().filter(|world| batch.worlds.contains(world));
            let own = Vec::from_iter(own.copied());
            self.reports.differ(&self.card, &self.scene, batch, &own)?;
            batch.differ(own);
        }
        Ok(())
    }
    fn takes(&self, parameters: &[&[f64]]) -> Result<(), DeviceError> {
        let sets = parameters.iter();
        let sets = sets.map(|set| set.iter().map(|x| *x as f32).collect());
        Ok(self.scene.takes(&self.card, &Vec::from_iter(sets))?)
    }
    fn step(
        &mut self,
        substeps: usize,
        processor: &mut Processor<'_, f32>,
    ) -> Result<(), DeviceError> {
        for nth in 0..self.batches.len() {
            let batch = &mut self.batches[nth];
            batch.tell(&self.card, &self.scene, self.actuators.as_mut())?;
            batch.ask(substeps);
            while self.batches[nth].is_behind() {
                let batch = &mut self.batches[nth];
                let steps = &mut self.steps;
                let left = steps.take(&self.card, &self.scene, &self.kernels, batch)?;
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
        self.steps.clock = self.card.clock();
        self.reports.clock = self.card.clock();
    }
    fn stop_clock(&mut self) -> Vec<Stage> {
        let clocks = [self.steps.clock.take(), self.reports.clock.take()];
        clocks.into_iter().flatten().flat_map(C::times).collect()
    }
    /// It is told of what is read, when it is.
    fn report(&mut self, _: Report) -> Result<(), DeviceError> {
        Ok(())
    }
    fn read_state(
        &mut self,
        numbers: &[Range<usize>],
        state: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for batch in &mut self.batches {
            batch.read_all(&self.card, &self.scene, numbers, state)?;
        }
        Ok(())
    }
    fn read_output(
        &mut self,
        numbers: &[Range<usize>],
        output: &mut Memory<f32>,
    ) -> Result<(), DeviceError> {
        for batch in &self.batches {
            let (card, scene) = (&self.card, &self.scene);
            self.reports
                .read(&Told { card, scene, batch }, numbers, output)?;
        }
        Ok(())
    }
}
