//! Which colliding shapes could touch within the step.
//!
//! What is kept from step to step, which boxes overlap and how far shapes are apart, tells sooner which
//! pairs need not be looked at. It changes nothing that is found.

use super::odometers::Odometers;
use collide::kind;
use glam::Vec3;
use model::CollisionFilter;
use numbers::Float;
use rayon::prelude::*;
use rigid::impulse::Impulse;
use rigid::impulse::NEARBY;
use rigid::impulse::pair::{Placed, placed};
use space::{Aabb, Pair, PairCache, SpaceError};

/// Two colliding shapes that could touch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Candidate {
    /// The lower one first.
    pub shapes: [u32; 2],
    /// The place in the list of pairs that is kept.
    kept: u32,
}

/// Boxes about all shapes, and the pairs whose boxes overlap.
#[derive(Debug, Default)]
pub(super) struct BroadPhase {
    boxes: Vec<Aabb>,
    /// Gaps [m] at which contacts with shapes begin at most.
    margins: Vec<f64>,
    /// With each pair, what both [`Odometers`] show when they could touch [m].
    pairs: PairCache<f64>,
    odometers: Odometers,
    /// What each odometer can show at the end of the step.
    ahead: Vec<f64>,
}

impl BroadPhase {
    /// The pairs that may touch, in order: shapes whose ways within the step meet. A thread takes
    /// so many shapes as a part at a time.
    ///
    /// # Errors
    /// A shape is nowhere.
    pub fn find<T: Float>(
        &mut self,
        impulse: &Impulse,
        filter: &CollisionFilter,
        shapes: &[Placed<T>],
        parameters: &[T],
        part: usize,
        found: &mut Vec<Candidate>,
    ) -> Result<(), SpaceError> {
        impulse.widest_margins(parameters, &mut self.margins);
        let margins = &self.margins;
        let around = |(i, shape): (usize, &Placed<T>)| {
            let grown = margins[i] + NEARBY;
            if impulse.shapes()[i].kind == kind::PLANE {
                Aabb::new(Vec3::NEG_INFINITY, Vec3::INFINITY)
            } else {
                around(shape, grown)
            }
        };
        let placed = shapes.par_iter().with_min_len(part);
        let boxes = placed.clone().enumerate().map(around);
        boxes.collect_into_vec(&mut self.boxes);
        let id = |i: u32| impulse.shapes()[i as usize].shape;
        self.pairs.update(&self.boxes, |pair| {
            filter.may_collide(id(pair.a), id(pair.b))
        })?;
        self.odometers.advance(impulse, shapes, parameters, part);
        let gone = self.odometers.ways().par_iter().zip(placed);
        let ahead = gone.map(|(gone, shape)| gone + shape.placed[placed::WAY].to_f64());
        ahead.collect_into_vec(&mut self.ahead);
        let threads = part < shapes.len();
        self.collect(threads, found);
        Ok(())
    }

    /// The pairs whose boxes overlap, without those that are known to stay apart.
    fn collect(&self, threads: bool, found: &mut Vec<Candidate>) {
        let pairs = self.pairs.pairs();
        found.clear();
        if !threads || pairs.len() < 2 * CHUNK {
            return self.collect_run(0, pairs, found);
        }
        let runs = pairs.par_chunks(CHUNK).enumerate().map(|(i, run)| {
            let mut found = Vec::new();
            self.collect_run(i * CHUNK, run, &mut found);
            found
        });
        let runs: Vec<_> = runs.collect();
        runs.iter().for_each(|run| found.extend_from_slice(run));
    }

    /// The same in a run of them, of which the first is at this place.
    fn collect_run(&self, first: usize, pairs: &[(Pair, f64)], found: &mut Vec<Candidate>) {
        found.resize(pairs.len(), Candidate::default());
        let mut count = 0;
        for (kept, (pair, until)) in (first as u32..).zip(pairs) {
            let shapes = [pair.a, pair.b];
            let [a, b] = [pair.a as usize, pair.b as usize];
            let soon = self.ahead[a] + self.ahead[b] + NEARBY >= *until;
            // Written in any case: branches that nobody can foretell would cost more.
            found[count] = Candidate { shapes, kept };
            count += usize::from(soon & self.boxes[a].overlaps(&self.boxes[b]));
        }
        found.truncate(count);
    }

    /// What the shapes' odometers show [m].
    pub fn ways(&self) -> &[f64] {
        self.odometers.ways()
    }

    /// Takes note that a pair is apart now by this length [m] or more.
    pub fn are_apart(&mut self, pair: Candidate, gap: f64) {
        let ways = pair.shapes.map(|s| self.odometers.ways()[s as usize]);
        let until = &mut self.pairs.pairs_mut()[pair.kept as usize].1;
        *until = ways[0] + ways[1] + gap;
    }
}

/// Pairs that one thread looks through at a time.
const CHUNK: usize = 1024;

/// The gap [m] that two shapes could close within the step.
pub(super) fn reach<T: Float>(shapes: &[Placed<T>], pair: [u32; 2]) -> f64 {
    let [a, b] = pair.map(|s| shapes[s as usize].placed[placed::WAY].to_f64());
    a + b + NEARBY
}

fn around<T: Float>(shape: &Placed<T>, grown: f64) -> Aabb {
    let at = |i: usize| shape.placed[i].to_f64() as f32;
    let vec3 = |i: usize| Vec3::new(at(i), at(i + 1), at(i + 2));
    let (center, half) = (vec3(placed::POSITION), vec3(placed::EXTENT));
    // What rounding to single precision may take away, far from the origin.
    let rounding = 1e-6 * (center.abs() + half).max_element();
    Aabb::around(center, half + (grown as f32 + rounding))
}
