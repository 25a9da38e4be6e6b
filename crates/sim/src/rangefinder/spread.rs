//! Rays of one world, side by side in lanes.
//!
//! The kernel sees as many worlds as there are lanes, which are one: its bodies stand in each lane, and the rays are
//! dealt out among them, so that neighbours go together.

use crate::engine::Block;
use crate::jobs::{Lane, ranges};
use glam::DVec3;
use model::{Model, Mount};
use numbers::dispatch::Isa;
use numbers::{Float, Memory};
use rayon::prelude::*;
use rigid::{OutputTables, Rangefinder};

/// Most rays of a lane: more are left to other threads.
const RAYS_PER_LANE: usize = 64;

/// What casts the rays of one world.
#[derive(Clone)]
pub(super) struct Spread<T: Float> {
    isa: Isa,
    /// Of as many rays as a lane has at a time.
    finder: Rangefinder,
    /// Its constants, in each lane; of which the directions are set as their turn comes.
    parameters: Memory<T>,
    directions: Vec<[T; 3]>,
    /// How many of what a world reports it sees.
    reported: usize,
}

/// What a thread works in.
struct Room<T: Float> {
    parameters: Memory<T>,
    reported: Memory<T>,
    scratch: Memory<T>,
    distances: Memory<T>,
}

impl<T: Float> Spread<T> {
    /// Of rays along these directions; none where lanes are not more than one, or rays are fewer.
    pub fn new(
        (model, outputs): (&Model, &OutputTables),
        mount: &Mount,
        (directions, range): (&[DVec3], f64),
        isa: Isa,
    ) -> Option<Self> {
        let width = isa.width::<T>();
        if width == 1 || directions.len() < width {
            return None;
        }
        let each = directions.len().div_ceil(width).min(RAYS_PER_LANE);
        let finder = Rangefinder::new(model, outputs, mount, &directions[..each], range)?;
        let mut parameters = Memory::new(width, finder.sheet().parameters.len(), width);
        for (at, x) in finder.sheet().parameters.iter().enumerate() {
            parameters.fill(at, T::from_f64(*x));
        }
        let of = |d: &DVec3| d.to_array().map(T::from_f64);
        Some(Self {
            isa,
            finder,
            parameters,
            directions: directions.iter().map(of).collect(),
            reported: outputs.body.at(model.bodies.len(), 0),
        })
    }

    /// Where a thread casts rays of a world of which this is reported, one number after the other.
    fn room(&self, reported: &[T]) -> Room<T> {
        let width = self.parameters.width();
        let memory = |numbers: usize| Memory::new(width, numbers, width);
        let lengths = self.finder.sheet().lengths;
        let mut room = Room {
            parameters: self.parameters.clone(),
            reported: memory(self.reported),
            scratch: memory(lengths.scratch.max(1)),
            distances: memory(lengths.output),
        };
        let lanes = room.reported.scalars_mut().chunks_exact_mut(width);
        lanes.zip(reported).for_each(|(lanes, x)| lanes.fill(*x));
        room
    }

    /// Whether so many worlds' rays are too few to be shared by threads.
    pub fn are_few(&self, worlds: usize) -> bool {
        worlds == 1 && self.directions.len() <= self.finder.rays() * self.parameters.width()
    }

    /// How far all rays get in a world of which this is reported.
    pub fn cast(&self, reported: &[T], distances: &mut [T]) {
        let together = self.finder.rays() * self.parameters.width();
        if distances.len() <= together {
            return self.cast_some(&mut self.room(reported), 0, distances);
        }
        let parts = distances.par_chunks_mut(together).enumerate();
        parts.for_each_init(
            || self.room(reported),
            |room, (nth, part)| self.cast_some(room, nth * together, part),
        );
    }

    /// Casts the rays from the first on.
    fn cast_some(&self, room: &mut Room<T>, first: usize, distances: &mut [T]) {
        let width = self.parameters.width();
        let last = self.directions.len() - 1;
        let parameters = room.parameters.scalars_mut();
        for ray in 0..self.finder.rays() {
            let at = self.finder.direction(ray);
            for lane in 0..width {
                let direction = self.directions[(first + ray * width + lane).min(last)];
                for (i, x) in direction.into_iter().enumerate() {
                    parameters[(at + i) * width + lane] = x;
                }
            }
        }
        let mut none = Memory::new(0, 0, width);
        let mut block = Block {
            number: 0,
            state: none.scalars_mut(),
            input: room.reported.scalars(),
            output: room.distances.scalars_mut(),
            scratch: room.scratch.scalars_mut(),
            parameters: room.parameters.scalars(),
            common: &[],
            links: &self.finder.sheet().links,
        };
        let lane = Lane {
            isa: self.isa,
            single: false,
        };
        ranges::run(lane, &self.finder, &mut block);
        distances.copy_from_slice(&room.distances.scalars()[..distances.len()]);
    }
}
