//! Errors that are added to what is measured.
//!
//! Of a number x of a sensor, at sample k of a world, Δt after the one before:
//!
//! ```text
//! w ← w + σ_walk √Δt z_k          random walk, 0 at a world's first sample
//! y = x + σ_bias z + w + σ z'_k    bias, drawn once per world; white noise
//! reading = clamp(step · round(y / step), ± cutoff)
//! ```
//!
//! with z, z', … independent normal numbers (IEEE Std 952, annex C, names these terms of gyroscopes: bias,
//! rate random walk, angle random walk, quantisation). Readings of distances are kept from 0 to the largest range, too, at
//! which what met nothing stays.

use crate::SensorError;
use crate::random::{Draw, Purpose, Source};
use crate::sensor::{Sensor, SensorKind};
use numbers::Float;
use numbers::dispatch::Isa;

/// A number for all numbers of a sensor, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Level {
    /// The same for all.
    All(f64),
    /// For each number in the order of the reading.
    Each(Vec<f64>),
}

impl Default for Level {
    /// None.
    fn default() -> Self {
        Self::All(0.0)
    }
}

impl From<f64> for Level {
    fn from(level: f64) -> Self {
        Self::All(level)
    }
}

impl From<Vec<f64>> for Level {
    fn from(levels: Vec<f64>) -> Self {
        Self::Each(levels)
    }
}

/// What is added to the numbers of a sensor, in their units; nothing by default.
///
/// Among quaternions noise is added to x, y, z, w, which are then scaled to unit length: a standard
/// deviation s of these is one of 2 s [rad] about each axis. Distances that met nothing stay at the largest
/// range, and no reading is above it or below 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Noise {
    /// Standard deviation of each sample.
    pub deviation: Level,
    /// Standard deviation of a bias that each world draws once, for good.
    pub bias: Level,
    /// By how much a second bias wanders: its standard deviation after 1 s [unit/√s]. It starts from 0
    /// where a world begins anew.
    pub walk: Level,
    /// Readings are whole multiples of this; 0: of any size.
    pub step: Level,
}

impl Noise {
    /// White noise of this standard deviation.
    pub fn white(deviation: impl Into<Level>) -> Self {
        Self {
            deviation: deviation.into(),
            ..Self::default()
        }
    }
    /// Whether it adds nothing.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// What is added to the images of a camera: normal numbers, independent of pixel to pixel and image to image;
/// nothing by default. Bodies, shapes and normals are seen as they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ImageNoise {
    /// Standard deviation of red, green and blue, each in its sRGB value from 0 to 1.
    pub rgb: f64,
    /// Standard deviation of depth [m]. What is seen stays at 0 or beyond, and nothing infinitely far.
    pub depth: f64,
}

/// Some worlds, one after the other.
pub(crate) struct Part<'a, T> {
    /// The first of them.
    pub first: usize,
    /// World after world.
    pub numbers: &'a mut [T],
    /// As many, or none where nothing wanders.
    pub walk: &'a mut [f64],
}

/// The noise of a sensor, number by number. What adds nothing is empty.
#[derive(Clone, Debug)]
pub(crate) struct Errors {
    source: Source,
    deviation: Vec<f64>,
    bias: Vec<f64>,
    walk: Vec<f64>,
    step: Vec<f64>,
    /// First numbers of quaternions.
    quaternions: Vec<usize>,
    /// Numbers from 0 to this, which stands for nothing.
    range: Option<f64>,
    /// Largest size of a reading.
    cutoff: f64,
}

impl Errors {
    /// Of so many numbers in a world.
    pub fn new(
        sensor: &Sensor,
        source: Source,
        n: usize,
        quaternions: Vec<usize>,
    ) -> Result<Self, SensorError> {
        let range = match &sensor.kind {
            SensorKind::Rangefinder { max_range, .. } | SensorKind::Lidar { max_range, .. } => {
                Some(*max_range)
            }
            _ => None,
        };
        let errors = Self::of(&sensor.name, &sensor.noise, sensor.cutoff, source, n)?;
        Ok(Self {
            quaternions,
            range,
            ..errors
        })
    }
    /// Of any n numbers.
    fn of(
        name: &str,
        noise: &Noise,
        cutoff: Option<f64>,
        source: Source,
        n: usize,
    ) -> Result<Self, SensorError> {
        if let Some(value) = cutoff.filter(|cutoff| *cutoff <= 0.0 || cutoff.is_nan()) {
            return Err(SensorError::OutOfRange {
                sensor: name.into(),
                what: "its cutoff",
                value: value.to_string(),
                must: "above 0",
            });
        }
        let level = |what, level: &Level| expand(what, level, name, n);
        Ok(Self {
            source,
            deviation: level("the standard deviation of its noise", &noise.deviation)?,
            bias: level("the standard deviation of its bias", &noise.bias)?,
            walk: level("the random walk of its bias", &noise.walk)?,
            step: level("the step of its readings", &noise.step)?,
            quaternions: Vec::new(),
            range: None,
            cutoff: cutoff.unwrap_or(f64::INFINITY),
        })
    }
    /// Whether readings are what is measured.
    pub fn are_none(&self) -> bool {
        !self.adds() && self.step.is_empty() && self.cutoff.is_infinite()
    }
    /// Where its random numbers come from.
    pub fn source(&self) -> &Source {
        &self.source
    }
    /// Whether it keeps a random walk.
    pub fn walks(&self) -> bool {
        !self.walk.is_empty()
    }
    fn adds(&self) -> bool {
        !(self.deviation.is_empty() && self.bias.is_empty() && self.walk.is_empty())
    }

    /// Turns what was measured in a part of the worlds, from the first of it on, into what is read where a
    /// sample is due. `walk` are the biases that wander, if any does.
    pub fn apply<T: Float>(
        &self,
        isa: Isa,
        due: impl Iterator<Item = Draw> + Clone,
        n: usize,
        part: Part<'_, T>,
    ) {
        let Part {
            first,
            numbers,
            walk,
        } = part;
        let at = |draw: &Draw, i: usize| (draw.world - first) * n + i;
        if let Some(range) = self.range {
            for draw in due.clone() {
                set_nothing_apart(&mut numbers[at(&draw, 0)..][..n], range);
            }
        }
        if self.walks() {
            let each = |draw: &Draw, i: usize, z: f64| {
                walk[at(draw, i)] += self.walk[i] * draw.elapsed.sqrt() * z;
                add(&mut numbers[at(draw, i)], walk[at(draw, i)]);
            };
            self.source.each(isa, Purpose::Walk, due.clone(), n, each);
        }
        if !self.bias.is_empty() {
            let once = due.clone().map(|draw| Draw {
                sample: 0,
                episode: 0,
                ..draw
            });
            let each = |draw: &Draw, i: usize, z: f64| {
                add(&mut numbers[at(draw, i)], self.bias[i] * z);
            };
            self.source.each(isa, Purpose::Bias, once, n, each);
        }
        if !self.deviation.is_empty() {
            let each = |draw: &Draw, i: usize, z: f64| {
                add(&mut numbers[at(draw, i)], self.deviation[i] * z);
            };
            self.source.each(isa, Purpose::White, due.clone(), n, each);
        }
        for draw in due {
            self.finish(&mut numbers[at(&draw, 0)..][..n]);
        }
    }

    /// Quaternions of unit length; multiples of the step; within range and cutoff.
    fn finish<T: Float>(&self, x: &mut [T]) {
        if self.adds() {
            for &first in &self.quaternions {
                normalize(&mut x[first..first + 4]);
            }
        }
        for (x, &step) in x.iter_mut().zip(&self.step) {
            if step > 0.0 {
                *x = T::from_f64((x.to_f64() / step).round() * step);
            }
        }
        if let Some(range) = self.range {
            clamp(x, 0.0, range);
        }
        if self.cutoff.is_finite() {
            clamp(x, -self.cutoff, self.cutoff);
        }
    }
}

/// The noise of a sensor that its user measures: what [`Sensors`](crate::Sensors) add, by the same random numbers.
#[derive(Clone, Debug)]
pub struct Disturbance {
    errors: Errors,
    n: usize,
    isa: Isa,
}

impl Disturbance {
    /// Of a sensor of this name, of n numbers in a world; readings are kept within ± `cutoff`, if there is one.
    ///
    /// # Errors
    /// Levels that no noise can have, or another number of them than n; a cutoff that is not above 0.
    pub fn new(
        name: &str,
        seed: u64,
        noise: &Noise,
        cutoff: Option<f64>,
        n: usize,
    ) -> Result<Self, SensorError> {
        Ok(Self {
            errors: Errors::of(name, noise, cutoff, Source::new(seed, name), n)?,
            n,
            isa: Isa::detect(),
        })
    }
    /// Whether readings are what is measured.
    pub fn is_none(&self) -> bool {
        self.errors.are_none()
    }
    /// Turns what was measured, `numbers[world][i]`, into what is read where there is a sample. `walk`, of the same
    /// shape, are the biases that wander; they start from 0 where a world begins anew.
    ///
    /// # Panics
    /// If a sample is of a world that the arrays do not have.
    pub fn apply(&self, samples: &[Draw], numbers: &mut [f64], walk: &mut [f64]) {
        let part = Part {
            first: 0,
            numbers,
            walk,
        };
        self.errors
            .apply(self.isa, samples.iter().copied(), self.n, part);
    }
}

/// A level for each number, or none where all are 0.
fn expand(
    what: &'static str,
    level: &Level,
    sensor: &str,
    n: usize,
) -> Result<Vec<f64>, SensorError> {
    let levels = match level {
        Level::All(level) => vec![*level; n],
        Level::Each(levels) => levels.clone(),
    };
    if levels.len() != n {
        return Err(SensorError::Length {
            sensor: sensor.into(),
            what,
            found: levels.len(),
            expected: n,
        });
    }
    match levels.iter().find(|x| !(0.0..=1e9).contains(*x)) {
        Some(bad) => Err(SensorError::OutOfRange {
            sensor: sensor.into(),
            what,
            value: bad.to_string(),
            must: "from 0 to 1e9, in the reading's unit",
        }),
        None if levels.iter().all(|x| *x == 0.0) => Ok(Vec::new()),
        None => Ok(levels),
    }
}

/// Puts distances that met nothing infinitely far, where nothing that is added moves them.
fn set_nothing_apart<T: Float>(distances: &mut [T], range: f64) {
    for x in distances {
        if *x >= T::from_f64(range) {
            *x = T::from_f64(f64::INFINITY);
        }
    }
}

fn add<T: Float>(x: &mut T, by: f64) {
    *x = T::from_f64(x.to_f64() + by);
}

fn clamp<T: Float>(numbers: &mut [T], low: f64, high: f64) {
    for x in numbers {
        *x = T::from_f64(x.to_f64().clamp(low, high));
    }
}

/// Scales a quaternion to unit length.
fn normalize<T: Float>(q: &mut [T]) {
    let length = q
        .iter()
        .map(|x| x.to_f64().powi(2))
        .sum::<f64>()
        .sqrt()
        .max(1e-30);
    for x in q {
        *x = T::from_f64(x.to_f64() / length);
    }
}
