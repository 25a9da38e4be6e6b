//! Rays that are cast from one place again and again, as a sensor of distance does.
//!
//! Where shapes are few, all rays of a block of worlds are cast in lanes, shape by shape ([`rigid::Rangefinder`]), or on
//! the device that holds the worlds. Where they are many, each ray goes its own way through a tree of boxes
//! ([`rays`](crate::rays)).

use crate::engine::Block;
use crate::error::{index, length};
use crate::jobs::ranges;
use crate::queries::{check_direction, check_most};
use crate::scratch::Scratch;
use crate::{Ray, Simulation, SimulationError};
use glam::DVec3;
use model::{Mount, Pose, Shape};
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::{FARTHEST, Report};
use std::collections::HashSet;

/// Rays that would take more tests than so many for each lane are left to a tree of boxes. Sixteen lanes share a test that
/// takes 4 ns; a tree takes 200 to 400 ns a ray.
const TESTS_PER_LANE: f64 = 64.0;
/// The same of worlds that are looked at one by one, by which a tree's ray is as good as some 16 tests.
const TESTS_ALONE: f64 = 16.0;
/// A device's thread casts all rays of a world: more tests may take so long that a card is taken for hung.
const TESTS_ON_A_DEVICE: f64 = (1 << 22) as f64;

/// Rays from one place of a model. See [`Simulation::rangefinder`].
#[derive(Clone)]
pub struct Rangefinder<T: Float> {
    mount: Mount,
    /// Of unit length, in the mount's frame.
    directions: Vec<DVec3>,
    /// How far they may go [m].
    range: f64,
    /// None where they may meet the name of a file.
    kernel: Option<Kernel<T>>,
}

/// The rays as kernels cast them.
#[derive(Clone)]
struct Kernel<T: Float> {
    finder: rigid::Rangefinder,
    /// Its constants.
    common: Vec<T>,
    scratch: Scratch<T>,
    /// How far they got when they were last cast.
    distances: Memory<T>,
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
    /// A body that does not exist; a direction that is not finite or has no length; a range that is negative or NaN.
    pub fn rangefinder(
        &self,
        mount: Mount,
        directions: &[DVec3],
        range: f64,
    ) -> Result<Rangefinder<T>, SimulationError> {
        if let Some(body) = mount.body {
            index("body", body.0, self.model().bodies.len())?;
        }
        check_most(("rangefinder", 0), range)?;
        let checked = |(i, d): (usize, &DVec3)| check_direction(("rangefinder", i), *d);
        let directions = directions.iter().enumerate().map(checked);
        let directions = directions.collect::<Result<Vec<_>, _>>()?;
        let (model, tables) = (self.model(), &self.output_tables);
        let finder = rigid::Rangefinder::new(model, tables, &mount, &directions, range);
        let kernel = finder.map(|finder| Kernel {
            common: finder
                .parameters()
                .iter()
                .map(|x| T::from_f64(*x))
                .collect(),
            scratch: Scratch::new(finder.lengths().scratch, self.output.width()),
            distances: Memory::new(self.worlds(), finder.rays().max(1), self.output.width()),
            finder,
        });
        Ok(Rangefinder {
            mount,
            directions,
            range,
            kernel,
        })
    }

    /// Casts a rangefinder's rays where bodies are now: how far [m] each gets before it meets a shape, 0 where it starts in
    /// a solid, its range where it meets none. Ray r of `worlds[i]` stands in `distances[i · rays + r]`.
    ///
    /// The rangefinder must be of a simulation with as many worlds of the same model.
    ///
    /// # Errors
    /// A world that does not exist; distances of another length; a mesh that is the name of its file only; a rangefinder of
    /// another number of worlds; worlds are on a device, and it fails.
    pub fn measure_ranges(
        &mut self,
        finder: &mut Rangefinder<T>,
        worlds: &[usize],
        distances: &mut [T],
    ) -> Result<(), SimulationError> {
        let (count, rays) = (self.worlds(), finder.rays());
        worlds.iter().try_for_each(|&w| index("world", w, count))?;
        length("distances", distances.len(), worlds.len() * rays)?;
        if distances.is_empty() {
            return Ok(());
        }
        let Some(kernel) = &mut finder.kernel else {
            return self.cast_one_by_one(finder, worlds, distances);
        };
        length(
            "worlds of the rangefinder",
            kernel.distances.worlds(),
            count,
        )?;
        if !self.measured_there(kernel)? && !self.measured_here(kernel, worlds)? {
            return self.cast_one_by_one(finder, worlds, distances);
        }
        let range = T::from_f64(finder.range);
        let farthest = T::from_f64(FARTHEST).to_f64();
        let told = |x: T| if x.to_f64() < farthest { x } else { range };
        self.threads.run(|| {
            let rows = distances.par_chunks_exact_mut(rays).zip(worlds);
            rows.for_each(|(row, &world)| {
                let read = |(ray, x): (usize, &mut T)| *x = told(kernel.distances.get(world, ray));
                row.iter_mut().enumerate().for_each(read);
            });
        });
        Ok(())
    }

    /// Casts the rays of all worlds on the device that holds them, if there is one and it casts these.
    fn measured_there(&mut self, kernel: &mut Kernel<T>) -> Result<bool, SimulationError> {
        let finder = &kernel.finder;
        let is_short = finder.tests(1) * finder.rays() as f64 <= TESTS_ON_A_DEVICE;
        if self.remote.is_none() || !is_short || !self.shapes_alike() {
            return Ok(false);
        }
        self.report(Report::Motion)?;
        let Some(remote) = &mut self.remote else {
            return Ok(false);
        };
        Ok(remote.measure(finder, &mut kernel.distances)?)
    }

    /// Casts all rays of the blocks that hold these worlds in lanes, if that takes less time than one by one.
    fn measured_here(
        &mut self,
        kernel: &mut Kernel<T>,
        worlds: &[usize],
    ) -> Result<bool, SimulationError> {
        let width = self.output.width();
        let most = match width {
            1 => TESTS_ALONE,
            _ => TESTS_PER_LANE * width as f64,
        };
        let laid_out_alike = kernel.distances.width() == width;
        if kernel.finder.tests(width) > most || !laid_out_alike || !self.shapes_alike() {
            return Ok(false);
        }
        self.fetch_motion()?;
        let lane = self.lane();
        let wanted: HashSet<usize> = worlds.iter().map(|world| world / width).collect();
        let size = kernel.distances.block_size();
        let Kernel {
            finder,
            common,
            scratch,
            distances,
        } = kernel;
        let measure = |number: usize, distances: &mut [T]| {
            // No numbers, where a register's would lie.
            let mut none = Memory::new(0, 0, width);
            scratch.lend(|scratch| {
                let mut block = Block {
                    number,
                    state: none.scalars_mut(),
                    input: self.output.block(number),
                    output: distances,
                    scratch: scratch.scalars_mut(),
                    parameters: &[],
                    common,
                    links: finder.links(),
                };
                ranges::run(lane, finder, &mut block);
            });
        };
        let blocks = distances.scalars_mut().par_chunks_exact_mut(size);
        let blocks = blocks.enumerate().filter(|(i, _)| wanted.contains(i));
        self.threads
            .run(|| blocks.for_each(|(number, distances)| measure(number, distances)));
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
