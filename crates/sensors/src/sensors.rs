//! The sensors of all worlds of a simulation.

use crate::bank::{Bank, gauge};
use crate::check::{self, Check};
use crate::clock::Clock;
use crate::images::{Camera, ImageErrors, Renderers};
use crate::noise::{Errors, Part};
use crate::random::{Draw, Source};
use crate::sensor::{Sensor, SensorKind, directions};
use crate::{ImageNoise, SensorError};
use model::{BodyId, Model, Pose, hint};
use numbers::Float;
use rayon::prelude::*;
use render::Images;
use sim::{Diverged, Gauge, OutputPart, Rangefinder, Simulation};
use std::cmp::Reverse;
use std::ops::Range;
use std::sync::Arc;

/// What sensors measure in all worlds of a simulation.
///
/// Readings hold from sample to sample. A sample of rate r that is due at time k/r of a world is taken when
/// [`update`](Self::update) is called at or after it; [`step`](Self::step) calls it at the first step
/// at or after. Where several are due at once, one is taken. Each world has its own time: one that is set,
/// reset or restored is sampled anew, and one that diverged keeps what was measured last.
///
/// Noise is a function of the seed, the sensor's name, the world, how often that has begun anew, and the
/// sample: whatever the number of worlds and threads.
#[derive(Clone, Debug)]
pub struct Sensors<T: Float> {
    pub(crate) model: Arc<Model>,
    /// Its name, and whether shapes touch: on both depends where contacts stand.
    solver: (&'static str, bool),
    pub(crate) seed: u64,
    pub(crate) channels: Vec<Channel<T>>,
    /// Those of joints, bodies and contacts, by their rates.
    banks: Vec<Bank<T>>,
    pub(crate) worlds: Vec<World>,
}

/// What is remembered of a world.
#[derive(Clone, Copy, Debug)]
pub(crate) struct World {
    /// [`Simulation::begun`] when it was last looked at; `None`: it may be anything.
    pub begun: Option<u64>,
    /// How often it has begun anew since the sensors were made.
    pub episode: u32,
    /// It has not diverged.
    runs: bool,
}

impl World {
    /// That has begun anew so often, and may have been set meanwhile.
    pub fn new(episode: u32) -> Self {
        Self {
            begun: None,
            episode,
            runs: true,
        }
    }
}

/// A sensor in all worlds.
#[derive(Clone, Debug)]
pub(crate) struct Channel<T: Float> {
    pub sensor: Sensor,
    clock: Clock,
    errors: Errors,
    /// Worlds, then those of one world.
    pub shape: Vec<usize>,
    /// Which of the numbers that are measured are told.
    part: Range<usize>,
    /// Of each world.
    pub samples: Vec<Sampled>,
    /// Time of each world's last sample [s].
    pub time: Vec<f64>,
    /// World after world.
    pub numbers: Vec<T>,
    /// Biases that wander, world after world.
    pub walk: Vec<f64>,
    /// Of a sensor that casts rays.
    finder: Option<Rangefinder<T>>,
    /// Of a sensor of joints, bodies or contacts: in which bank it is read, and where its first number that is told stands
    /// there.
    place: Option<(usize, usize)>,
    pub camera: Option<Camera>,
}

/// The samples that a sensor has taken in a world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Sampled {
    /// The last one, counted from 0 at the world's time 0; `None` before the first.
    pub last: Option<u64>,
    /// The one to be taken now, if any.
    due: Option<u64>,
    /// Time since the one before [s].
    elapsed: f64,
}

impl Sampled {
    /// What the noise of the sample that is due depends on.
    fn draw(&self, world: usize, episode: u32) -> Option<Draw> {
        self.due.map(|sample| Draw {
            world,
            episode,
            sample,
            elapsed: self.elapsed,
        })
    }
}

/// Numbers of a sensor in all worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reading<'a, T> {
    /// World after world, each as its [`SensorKind`] says.
    pub numbers: &'a [T],
    /// Number of worlds, then the shape of a world's numbers.
    pub shape: &'a [usize],
    /// Time of each world's last sample [s].
    pub time: &'a [f64],
}

/// Images of a camera in all worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ImageReading<'a> {
    /// One image of each channel and world.
    pub images: &'a Images,
    /// Time of each world's last sample [s].
    pub time: &'a [f64],
}

impl<T: Float> Sensors<T> {
    /// Sensors for a simulation, sampled for the first time.
    ///
    /// # Errors
    /// The first fault found: names that are empty or not unique; bodies and joints that do not exist;
    /// numbers that are not finite or out of range; noise of the wrong length; what the kind does not take.
    pub fn new(
        simulation: &mut Simulation<T>,
        sensors: Vec<Sensor>,
        seed: u64,
    ) -> Result<Self, SensorError> {
        check::names(&sensors)?;
        let model = Arc::clone(simulation.model());
        let worlds = simulation.worlds();
        let mut renderers = Renderers::default();
        // In the threads of the simulation, of which a process that was forked may have no others.
        let channels = simulation.observe_known(|_, _| {
            let channel = |sensor| Channel::new(sensor, (&*model, &mut renderers), worlds, seed);
            let channels = sensors.into_iter().map(channel);
            channels.collect::<Result<Vec<_>, _>>()
        });
        let mut channels = channels?;
        for channel in &mut channels {
            channel.finder = finder(&channel.sensor, simulation)?;
        }
        let banks = banks(simulation, &mut channels)?;
        let mut sensors = Self {
            model,
            solver: (simulation.solver(), simulation.settings().contacts),
            seed,
            channels,
            banks,
            worlds: vec![World::new(0); worlds],
        };
        sensors.update(simulation)?;
        Ok(sensors)
    }

    /// The sensors, in the order they were given.
    pub fn sensors(&self) -> impl ExactSizeIterator<Item = &Sensor> {
        self.channels.iter().map(|channel| &channel.sensor)
    }
    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.worlds.len()
    }
    /// Row of the sensor of this name.
    ///
    /// # Errors
    /// There is none; says which there are.
    pub fn row(&self, name: &str) -> Result<usize, SensorError> {
        let found = self.sensors().position(|sensor| sensor.name == name);
        found.ok_or_else(|| SensorError::UnknownName {
            name: name.into(),
            hint: hint(
                name,
                &self.sensors().map(|s| s.name.as_str()).collect::<Vec<_>>(),
            ),
        })
    }
    fn channel(&self, row: usize) -> Result<&Channel<T>, SensorError> {
        let count = self.channels.len();
        let channel = self.channels.get(row);
        channel.ok_or(SensorError::NoSuchRow { row, count })
    }

    /// What the sensor of this name measured last.
    ///
    /// # Errors
    /// There is none, or it is a camera.
    pub fn reading(&self, name: &str) -> Result<Reading<'_, T>, SensorError> {
        self.reading_at(self.row(name)?)
    }
    /// What the sensor in this row measured last.
    ///
    /// # Errors
    /// There is none, or it is a camera.
    pub fn reading_at(&self, row: usize) -> Result<Reading<'_, T>, SensorError> {
        let channel = self.channel(row)?;
        if channel.camera.is_some() {
            return Err(SensorError::OtherReading {
                sensor: channel.sensor.name.clone(),
                is: "a camera",
                call: "images",
            });
        }
        Ok(Reading {
            numbers: &channel.numbers,
            shape: &channel.shape,
            time: &channel.time,
        })
    }
    /// What the camera of this name saw last.
    ///
    /// # Errors
    /// There is none, or it is no camera.
    pub fn images(&self, name: &str) -> Result<ImageReading<'_>, SensorError> {
        self.images_at(self.row(name)?)
    }
    /// What the camera in this row saw last.
    ///
    /// # Errors
    /// There is none, or it is no camera.
    pub fn images_at(&self, row: usize) -> Result<ImageReading<'_>, SensorError> {
        let channel = self.channel(row)?;
        let Some(camera) = &channel.camera else {
            return Err(SensorError::OtherReading {
                sensor: channel.sensor.name.clone(),
                is: "no camera",
                call: "reading",
            });
        };
        Ok(ImageReading {
            images: &camera.images,
            time: &channel.time,
        })
    }

    /// Advances the simulation by `steps` time steps and misses no sample; returns the worlds that diverged
    /// meanwhile, which keep what was measured last.
    ///
    /// # Errors
    /// As [`update`](Self::update); the simulation then stands at the sample that failed.
    pub fn step(
        &mut self,
        simulation: &mut Simulation<T>,
        steps: usize,
    ) -> Result<Vec<Diverged>, SensorError> {
        let mut diverged = Vec::new();
        let mut left = steps;
        self.update(simulation)?;
        while left > 0 {
            let slice = self.steps_until_next(simulation).min(left);
            diverged.extend_from_slice(simulation.try_step(slice)?);
            left -= slice;
            self.update(simulation)?;
        }
        Ok(diverged)
    }

    /// Takes all samples that are due at the time of each world.
    ///
    /// # Errors
    /// The simulation is of another model, solver or number of worlds; a mesh that rays do not meet; an image that
    /// cannot be drawn. The sensors before the one at fault have been sampled; it and all others are as before. Where a
    /// device fails, none may have been.
    pub fn update(&mut self, simulation: &mut Simulation<T>) -> Result<(), SensorError> {
        self.take(simulation, false)
    }
    /// The same, and takes samples of the present time of a world anew, with the noise that they had: after
    /// [`Simulation::move_joints`], or where other controls act.
    ///
    /// # Errors
    /// As [`update`](Self::update).
    pub fn resample(&mut self, simulation: &mut Simulation<T>) -> Result<(), SensorError> {
        simulation.controls_may_differ();
        self.take(simulation, true)
    }
    fn take(&mut self, simulation: &mut Simulation<T>, anew: bool) -> Result<(), SensorError> {
        self.recognise(simulation)?;
        self.look_at_worlds(simulation);
        let h = simulation.settings().step.time_step;
        let (worlds, channels) = (&self.worlds, self.channels.iter_mut());
        let due = channels.filter_map(|channel| {
            let is_due = channel.find_due(simulation, h, worlds, anew);
            is_due.then_some(channel)
        });
        let due = Vec::from_iter(due);
        if due.is_empty() {
            return Ok(());
        }
        for (nth, bank) in self.banks.iter_mut().enumerate() {
            let due = due_in(&due, nth);
            if !due.is_empty() {
                bank.read(simulation, &due)?;
            }
        }
        if due.iter().any(|channel| channel.camera.is_some()) {
            let bodies = (0..self.model.bodies.len()).map(BodyId);
            simulation.fetch_parts(bodies.map(OutputPart::Motion))?;
        }
        for channel in due {
            channel.sample(simulation, (worlds, &self.banks))?;
            channel.note(simulation);
        }
        Ok(())
    }

    fn recognise(&mut self, simulation: &Simulation<T>) -> Result<(), SensorError> {
        let solver = (simulation.solver(), simulation.settings().contacts);
        let alike = simulation.worlds() == self.worlds() && solver == self.solver;
        if !alike || !simulation.recognises(&mut self.model) {
            return Err(SensorError::OtherSimulation);
        }
        Ok(())
    }

    /// Finds which worlds run, and forgets the samples of those that were set meanwhile.
    fn look_at_worlds(&mut self, simulation: &Simulation<T>) {
        self.worlds.iter_mut().for_each(|world| world.runs = true);
        for diverged in simulation.diverged() {
            self.worlds[diverged.world].runs = false;
        }
        for (index, world) in self.worlds.iter_mut().enumerate() {
            let now = simulation.begun(index);
            if world.begun.replace(now).is_some_and(|begun| begun != now) {
                world.episode = world.episode.wrapping_add(1);
                for channel in &mut self.channels {
                    channel.forget(index);
                }
            }
        }
    }

    /// How many steps until any sensor is due in any world that runs, as of the last update.
    fn steps_until_next(&self, simulation: &Simulation<T>) -> usize {
        let h = simulation.settings().step.time_step;
        let running = || (0..self.worlds()).filter(|&world| self.worlds[world].runs);
        let next = self.channels.iter().flat_map(|channel| {
            running().map(|world| {
                let last = channel.samples[world].last.unwrap_or(0);
                let time = simulation.time(world);
                channel.clock.steps_until_next(time, h, last)
            })
        });
        next.min().unwrap_or(usize::MAX)
    }
}

/// Threads take so many worlds at a time.
const WORLDS_AT_A_TIME: usize = 64;

impl<T: Float> Channel<T> {
    fn new(
        sensor: Sensor,
        (model, renderers): (&Model, &mut Renderers),
        worlds: usize,
        seed: u64,
    ) -> Result<Self, SensorError> {
        let check = Check {
            sensor: &sensor,
            model,
        };
        let layout = check.layout()?;
        let n = layout.part.len();
        let source = Source::new(seed, &sensor.name);
        let errors = Errors::new(&sensor, source, n, layout.quaternions)?;
        let camera = match &sensor.kind {
            SensorKind::Camera { view, device, .. } => {
                let view = (view.clone(), device);
                Some(Camera::new(&sensor.name, view, (model, renderers), worlds)?)
            }
            _ => None,
        };
        Ok(Self {
            clock: Clock { rate: sensor.rate },
            shape: [vec![worlds], layout.shape].concat(),
            part: layout.part,
            samples: vec![Sampled::default(); worlds],
            time: vec![0.0; worlds],
            numbers: vec![T::zero(); worlds * n],
            walk: vec![0.0; if errors.walks() { worlds * n } else { 0 }],
            finder: None,
            place: None,
            errors,
            camera,
            sensor,
        })
    }

    /// Numbers in a world.
    fn each(&self) -> usize {
        self.shape[1..].iter().product()
    }
    fn forget(&mut self, world: usize) {
        self.samples[world].last = None;
        if !self.walk.is_empty() {
            let n = self.each();
            self.walk[world * n..][..n].fill(0.0);
        }
    }

    /// Finds which samples are due now, or were taken now if those are to be taken `anew`; whether there are any.
    fn find_due(
        &mut self,
        simulation: &Simulation<T>,
        h: f64,
        worlds: &[World],
        anew: bool,
    ) -> bool {
        let mut any = false;
        for (world, sampled) in self.samples.iter_mut().enumerate() {
            let time = simulation.time(world);
            let now = self.clock.sample(time, h);
            let again = anew && self.time[world] == time;
            let due = worlds[world].runs && (again || sampled.last != Some(now));
            sampled.due = due.then_some(now);
            let passed = sampled.last.map_or(0, |last| now.saturating_sub(last));
            sampled.elapsed = passed as f64 * self.clock.period(h);
            any |= sampled.due.is_some();
        }
        any
    }
    fn due(&self) -> Vec<usize> {
        let due = |world: &usize| self.samples[*world].due.is_some();
        (0..self.samples.len()).filter(due).collect()
    }
    /// Those that were due have been taken.
    fn note(&mut self, simulation: &Simulation<T>) {
        for (world, sampled) in self.samples.iter_mut().enumerate() {
            if let Some(now) = sampled.due.take() {
                sampled.last = Some(now);
                self.time[world] = simulation.time(world);
            }
        }
    }

    /// Takes the samples that are due.
    fn sample(
        &mut self,
        simulation: &mut Simulation<T>,
        (worlds, banks): (&[World], &[Bank<T>]),
    ) -> Result<(), SensorError> {
        match &self.sensor.kind {
            SensorKind::Camera { noise, .. } => {
                let noise = *noise;
                return self.draw(simulation, worlds, noise);
            }
            SensorKind::Rangefinder { .. } | SensorKind::Lidar { .. } => self.cast(simulation)?,
            _ => self.read(simulation, banks),
        }
        self.add_errors(simulation, worlds);
        Ok(())
    }

    /// Takes its numbers where a bank has read them.
    fn read(&mut self, simulation: &Simulation<T>, banks: &[Bank<T>]) {
        let Some((bank, from)) = self.place else {
            return;
        };
        let (n, bank, samples) = (self.each(), &banks[bank], &self.samples);
        let numbers = &mut self.numbers;
        simulation.observe_known(|_, _| {
            in_parts(n, (numbers, &mut []), |part| {
                for (i, numbers) in part.numbers.chunks_exact_mut(n).enumerate() {
                    let world = part.first + i;
                    if samples[world].due.is_some() {
                        bank.copy(world, from, numbers);
                    }
                }
            });
        });
    }

    fn add_errors(&mut self, simulation: &Simulation<T>, worlds: &[World]) {
        if self.errors.are_none() {
            return;
        }
        let n = self.each();
        let (samples, errors) = (&self.samples, &self.errors);
        let draw = |world: usize| samples[world].draw(world, worlds[world].episode);
        let memories = (&mut self.numbers[..], &mut self.walk[..]);
        simulation.observe_known(|simulation, _| {
            in_parts(n, memories, |part| {
                let worlds = part.first..part.first + part.numbers.len() / n;
                errors.apply(simulation.isa(), worlds.filter_map(draw), n, part);
            });
        });
    }

    fn cast(&mut self, simulation: &mut Simulation<T>) -> Result<(), SensorError> {
        let due = self.due();
        let Some(finder) = &mut self.finder else {
            return Ok(());
        };
        let n = finder.rays();
        let mut distances = vec![T::zero(); due.len() * n];
        simulation
            .measure_ranges(finder, &due, &mut distances)
            .map_err(|source| SensorError::Rays {
                sensor: self.sensor.name.clone(),
                source,
            })?;
        for (row, world) in distances.chunks_exact(n).zip(due) {
            self.numbers[world * n..][..n].copy_from_slice(row);
        }
        Ok(())
    }

    fn draw(
        &mut self,
        simulation: &mut Simulation<T>,
        worlds: &[World],
        noise: ImageNoise,
    ) -> Result<(), SensorError> {
        let draw = |world: usize| self.samples[world].draw(world, worlds[world].episode);
        let due: Vec<Draw> = (0..worlds.len()).filter_map(draw).collect();
        let Some(camera) = &mut self.camera else {
            return Ok(());
        };
        let source = *self.errors.source();
        simulation.observe_known(|simulation, outputs| {
            let bodies = simulation.model().bodies.len();
            let of = |draw: &Draw| -> Vec<Pose> {
                let pose = |body| outputs.body_pose(draw.world, BodyId(body));
                (0..bodies).map(pose).collect()
            };
            let poses: Vec<_> = due.iter().map(of).collect();
            let isa = simulation.isa();
            let errors = ImageErrors { noise, source, isa };
            camera.draw(&due, &poses, &errors)
        })
    }
}

/// What casts the rays of a sensor, if it has any.
fn finder<T: Float>(
    sensor: &Sensor,
    simulation: &Simulation<T>,
) -> Result<Option<Rangefinder<T>>, SensorError> {
    let (SensorKind::Rangefinder { mount, max_range }
    | SensorKind::Lidar {
        mount, max_range, ..
    }) = &sensor.kind
    else {
        return Ok(None);
    };
    let made = simulation.rangefinder(*mount, &directions(&sensor.kind), *max_range);
    let made = made.map_err(|source| SensorError::Rays {
        sensor: sensor.name.clone(),
        source,
    });
    made.map(Some)
}

/// Banks of all sensors of joints, bodies and contacts, which learn where they are read.
fn banks<T: Float>(
    simulation: &Simulation<T>,
    channels: &mut [Channel<T>],
) -> Result<Vec<Bank<T>>, SensorError> {
    let mut groups: Vec<(Clock, Vec<(usize, Gauge)>)> = Vec::new();
    for (row, channel) in channels.iter().enumerate() {
        let Some(gauge) = gauge(&channel.sensor.kind, &channel.part) else {
            continue;
        };
        match groups.iter_mut().find(|(clock, _)| *clock == channel.clock) {
            Some((_, group)) => group.push((row, gauge)),
            None => groups.push((channel.clock, vec![(row, gauge)])),
        }
    }
    let made = groups
        .into_iter()
        .map(|(_, group)| Bank::new(simulation, group));
    let mut banks = made.collect::<Result<Vec<_>, _>>()?;
    // What those need that need most is reported once, and the others find it there.
    banks.sort_by_key(|bank| Reverse(bank.needs()));
    for (nth, bank) in banks.iter().enumerate() {
        for (&row, numbers) in bank.sensors().iter().zip(bank.numbers()) {
            let channel = &mut channels[row];
            channel.place = Some((nth, numbers.start + channel.part.start));
        }
    }
    Ok(banks)
}

/// The worlds in which any sensor of a bank is due, of those that are due anywhere.
fn due_in<T: Float>(due: &[&mut Channel<T>], bank: usize) -> Vec<usize> {
    let of = |channel: &&&mut Channel<T>| channel.place.is_some_and(|(own, _)| own == bank);
    let own = Vec::from_iter(due.iter().filter(of));
    let worlds = own.first().map_or(0, |channel| channel.samples.len());
    let is_due = |world: &usize| own.iter().any(|c| c.samples[*world].due.is_some());
    (0..worlds).filter(is_due).collect()
}

/// Works on parts of the worlds, of n numbers each, which threads share.
fn in_parts<T: Float>(
    n: usize,
    (numbers, walk): (&mut [T], &mut [f64]),
    work: impl Fn(Part<'_, T>) + Sync,
) {
    let size = n * WORLDS_AT_A_TIME;
    let one = |i: usize, numbers, walk| {
        work(Part {
            first: i * WORLDS_AT_A_TIME,
            numbers,
            walk,
        });
    };
    let numbers = numbers.par_chunks_mut(size);
    if walk.is_empty() {
        let parts = numbers.enumerate();
        parts.for_each(|(i, numbers)| one(i, numbers, &mut []));
    } else {
        let parts = numbers.zip(walk.par_chunks_mut(size)).enumerate();
        parts.for_each(|(i, (numbers, walk))| one(i, numbers, walk));
    }
}
