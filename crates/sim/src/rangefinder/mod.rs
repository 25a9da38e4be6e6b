//! Rays that are cast from one place again and again, as a sensor of distance does.
//!
//! Where shapes are few, rays are cast in lanes, shape by shape ([`rigid::Rangefinder`]): those of a block of worlds at
//! once, or those of one world ([`spread`]); or on the device that holds the worlds. Where shapes are many, each ray goes
//! its own way through a tree of boxes ([`rays`](crate::rays)).

mod spread;

use crate::error::{index, length};
use crate::instrument::Reader;
use crate::queries::{check_direction, check_most, check_pose};
use crate::{Ray, Simulation, SimulationError};
use glam::DVec3;
use model::{Model, Mount, Pose, Shape};
use numbers::Float;
use rayon::prelude::*;
use rigid::{FARTHEST, Instrument, Report};
use spread::Spread;
use std::sync::Arc;

/// Rays that would take more tests than so many for each lane are left to a tree of boxes. Sixteen lanes share a test that
/// takes 4 ns; a tree takes 200 to 400 ns a ray.
const TESTS_PER_LANE: f64 = 64.0;
/// The same of a device, where a thread casts all rays of a world, and of all its worlds: more may take so long that a card
/// is taken for hung.
const TESTS_OF_A_WORLD: f64 = (1 << 18) as f64;
const TESTS_IN_ALL: f64 = (1_u64 << 31) as f64;

/// Rays from one place of a model. See [`Simulation::rangefinder`].
#[derive(Clone)]
pub struct Rangefinder<T: Float> {
    model: Arc<Model>,
    worlds: usize,
    mount: Mount,
    /// Of unit length, in the mount's frame.
    directions: Vec<DVec3>,
    /// How far they may go [m].
    range: f64,
    way: Way<T>,
}

/// How its rays are cast where all worlds have the same shapes.
#[derive(Clone)]
enum Way<T: Float> {
    /// Through trees of boxes.
    OneByOne,
    /// Those of one world in lanes.
    Spread(Spread<T>),
    /// Those of a block of worlds in lanes, or of all on a device.
    Together(Reader<T>),
}

impl<T: Float> std::fmt::Debug for Rangefinder<T> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rangefinder")
            .field("mount", &self.mount)
            .field("directions", &self.directions)
            .field("range", &self.range)
            .finish_non_exhaustive()
    }
}

impl<T: Float> Rangefinder<T> {
    /// How many rays it has.
    pub fn rays(&self) -> usize {
        self.directions.len()
    }
}

/// Whether rays see no difference between two worlds' shapes.
pub(crate) fn look_alike(ours: &[Shape], theirs: &[Shape]) -> bool {
    let alike = |(a, b): (&Shape, &Shape)| {
        a.geometry == b.geometry && a.pose == b.pose && a.body == b.body && a.sensor == b.sensor
    };
    ours.len() == theirs.len() && ours.iter().zip(theirs).all(alike)
}

impl<T: Float> Simulation<T> {
    /// Rays from a mount along `directions` of its frame, of any length but zero, that go no farther than `range` [m],
    /// which may be infinite: to be cast in many worlds at once, again and again, by
    /// [`measure_ranges`](Self::measure_ranges).
    ///
    /// They see what [`cast_ray`](Self::cast_ray) does, but the body that carries them.
    ///
    /// # Errors
    /// A body that does not exist; a mount that is nowhere, or turned by no rotation; a direction that is not finite or has
    /// no length; a range that is negative or NaN.
    pub fn rangefinder(
        &self,
        mount: Mount,
        directions: &[DVec3],
        range: f64,
    ) -> Result<Rangefinder<T>, SimulationError> {
        if let Some(body) = mount.body {
            index("body", body.0, self.model().bodies.len())?;
        }
        let mount = mount.at(check_pose(("rangefinder", 0), mount.pose)?);
        check_most(("rangefinder", 0), range)?;
        let unit = |(i, d): (usize, &DVec3)| check_direction(("rangefinder", i), *d);
        let directions = directions.iter().enumerate().map(unit);
        let directions = directions.collect::<Result<Vec<_>, _>>()?;
        Ok(Rangefinder {
            way: self.way(&mount, &directions, range),
            model: Arc::clone(self.model()),
            worlds: self.worlds(),
            mount,
            directions,
            range,
        })
    }

    /// The soonest way to cast rays.
    fn way(&self, mount: &Mount, directions: &[DVec3], range: f64) -> Way<T> {
        let (model, tables) = (self.model(), &self.output_tables);
        let tests = |lanes| rigid::Rangefinder::tests(model, mount, lanes);
        let (width, lanes) = (self.output.width(), self.isa.width::<T>());
        let there = self.measures_there();
        let short = match (there, width) {
            (true, _) => {
                let of_world = tests(1) * directions.len() as f64;
                of_world <= TESTS_OF_A_WORLD && of_world * self.worlds() as f64 <= TESTS_IN_ALL
            }
            // Neighbours pass the same triangles.
            (false, 1) => tests(1) <= TESTS_PER_LANE * lanes as f64,
            (false, _) => tests(width) <= TESTS_PER_LANE * width as f64,
        };
        if !short || directions.is_empty() {
            return Way::OneByOne;
        }
        if !there && width == 1 {
            let rays = (directions, range);
            let spread = Spread::new((model, tables), mount, rays, self.isa);
            return spread.map_or(Way::OneByOne, Way::Spread);
        }
        let finder = rigid::Rangefinder::new(model, tables, mount, directions, range);
        let finder = finder.map(Instrument::Rangefinder);
        finder.map_or(Way::OneByOne, |finder| {
            Way::Together(Reader::new(finder, self.worlds(), width))
        })
    }

    /// Casts a rangefinder's rays where bodies are now: how far [m] each gets before it meets a shape, 0 where it starts in
    /// a solid, its range where it meets none. Ray r of `worlds[i]` stands in `distances[i · rays + r]`.
    ///
    /// # Errors
    /// A rangefinder of another model or another number of worlds; a world that does not exist; distances of another
    /// length; a mesh whose file cannot be read; worlds are on a device, and it fails.
    pub fn measure_ranges(
        &mut self,
        finder: &mut Rangefinder<T>,
        worlds: &[usize],
        distances: &mut [T],
    ) -> Result<(), SimulationError> {
        let (count, rays) = (self.worlds(), finder.rays());
        self.recognise(finder)?;
        worlds.iter().try_for_each(|&w| index("world", w, count))?;
        length("distances", distances.len(), worlds.len() * rays)?;
        if distances.is_empty() {
            return Ok(());
        }
        let cast = match &mut finder.way {
            _ if !self.shapes_alike() => false,
            Way::OneByOne => false,
            Way::Spread(spread) => self.spread(spread, worlds, distances)?,
            Way::Together(reader) => self.together(reader, worlds, distances)?,
        };
        if !cast {
            return self.cast_one_by_one(finder, worlds, distances);
        }
        let range = T::from_f64(finder.range);
        let farthest = T::from_f64(FARTHEST).to_f64();
        let unmet = distances.iter_mut().filter(|x| x.to_f64() >= farthest);
        unmet.for_each(|x| *x = range);
        Ok(())
    }

    fn recognise(&self, finder: &mut Rangefinder<T>) -> Result<(), SimulationError> {
        length("worlds of the rangefinder", finder.worlds, self.worlds())?;
        if !self.recognises(&mut finder.model) {
            return Err(SimulationError::OtherModel("rangefinder is"));
        }
        Ok(())
    }

    /// Casts rays of worlds that are looked at one by one.
    fn spread(
        &mut self,
        spread: &Spread<T>,
        worlds: &[usize],
        distances: &mut [T],
    ) -> Result<bool, SimulationError> {
        if self.output.width() != 1 {
            return Ok(false);
        }
        self.fetch_motion()?;
        let rays = distances.len() / worlds.len();
        if spread.are_few(worlds.len()) {
            spread.cast(self.output.block(worlds[0]), distances);
            return Ok(true);
        }
        let rows = distances.par_chunks_exact_mut(rays).zip(worlds);
        self.threads
            .run(|| rows.for_each(|(row, &world)| spread.cast(self.output.block(world), row)));
        Ok(true)
    }

    /// Casts rays of worlds together, where the worlds are.
    fn together(
        &mut self,
        reader: &mut Reader<T>,
        worlds: &[usize],
        distances: &mut [T],
    ) -> Result<bool, SimulationError> {
        if self.measures_there() {
            if !self.measure_there(reader, Report::Motion, worlds)? {
                return Ok(false);
            }
        } else {
            if reader.width() != self.output.width() {
                return Ok(false);
            }
            self.fetch_motion()?;
            self.measure_here(reader, worlds);
        }
        let rows = distances.par_chunks_exact_mut(reader.length()).zip(worlds);
        let read = |(row, &world): (&mut [T], &usize)| reader.copy(world, 0, row);
        self.threads.run(|| rows.for_each(read));
        Ok(true)
    }

    fn cast_one_by_one(
        &mut self,
        finder: &Rangefinder<T>,
        worlds: &[usize],
        distances: &mut [T],
    ) -> Result<(), SimulationError> {
        self.fetch_motion()?;
        let (mount, range) = (finder.mount, finder.range);
        let outputs = self.last_reported();
        let rays = worlds.iter().flat_map(|&world| {
            let carrier = mount.body.map_or(Pose::IDENTITY, |body| {
                Pose::new(
                    outputs.body_position(world, body),
                    outputs.body_orientation(world, body).normalize(),
                )
            });
            let at = carrier * mount.pose;
            finder.directions.iter().map(move |&direction| Ray {
                origin: at.position,
                direction: at.direction(direction),
                max_distance: range,
            })
        });
        let rays = Vec::from_iter(rays);
        let hits = self.cast_rays_in_worlds(worlds, &rays, mount.body)?;
        for (distance, hit) in distances.iter_mut().zip(hits) {
            *distance = T::from_f64(hit.map_or(range, |hit| hit.distance));
        }
        Ok(())
    }
}
