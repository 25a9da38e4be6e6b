//! The small steps: impulses, colour by colour, between motions of the bodies.

use super::batches::Batch;
use super::colours::Colours;
use super::jobs::{Bodies, BodyRows, BodyStage, ContactStage, Contacts};
use super::team::{Barrier, together};
use super::world::Workspace;
use crate::jobs::Lane;
use numbers::Float;
use rigid::impulse::{Cached, Impulse, global};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

/// How to solve the contacts of a step.
pub(super) struct Solver<'a, T> {
    pub impulse: &'a Impulse,
    pub parameters: &'a [T],
    pub lane: Lane,
    /// Contacts in a batch.
    pub width: usize,
    pub team: usize,
    pub globals: &'a [T; global::WIDTH],
}

/// What all threads read.
struct Scene<'a, T: Float> {
    rows: &'a BodyRows<T>,
    masses: &'a [T],
    contacts: &'a [Cached<T>],
    bounces: AtomicBool,
}

/// What one thread works on.
struct Share<'a, T> {
    batches: Vec<Batch<'a, T>>,
    /// Of each colour, its batches among them.
    colours: Vec<Range<usize>>,
    /// Bodies.
    index: &'a [u32],
}

/// Contacts that are worth a thread.
const WORTH_SHARING: usize = 128;

impl<T: Float> Solver<'_, T> {
    /// Solves the contacts of a workspace, and moves its bodies.
    pub fn run(&self, w: &mut Workspace<T>) {
        let row = |s: u32| self.impulse.shapes()[s as usize].row;
        w.ends.clear();
        let ends = w.contacts.iter().map(|c| (c.shapes.map(row), c.count));
        w.ends.extend(ends);
        w.colours.paint(&w.ends, self.impulse.rows(), self.width);
        w.lanes.make_room(w.colours.batches.len(), self.width);
        let scene = Scene {
            rows: &w.rows,
            masses: self.impulse.masses(self.parameters),
            contacts: &w.contacts,
            bounces: AtomicBool::new(false),
        };
        let members = (0..w.colours.batches.len()).map(|batch| w.colours.batch(batch));
        let batches = w.lanes.batches(members, self.width);
        let shares = self.shares(batches, &w.colours, &w.awake);
        together(shares, |barrier, share| self.work(&scene, barrier, share));
        for batch in 0..w.colours.batches.len() {
            w.lanes.read(batch, w.colours.batch(batch), &mut w.contacts);
        }
    }

    /// Deals batches and bodies out, each thread a run of each colour.
    fn shares<'a>(
        &self,
        mut batches: impl Iterator<Item = Batch<'a, T>>,
        colours: &Colours,
        awake: &'a [u32],
    ) -> Vec<Share<'a, T>> {
        let worth = colours.batches.len() * self.width / WORTH_SHARING;
        let team = self.team.min(worth).max(1);
        let registers = awake.len() / self.width;
        let cut = |n: usize, member: usize| n * member / team;
        let mut shares: Vec<_> = (0..team)
            .map(|m| Share {
                batches: Vec::new(),
                colours: Vec::new(),
                index: &awake[cut(registers, m) * self.width..cut(registers, m + 1) * self.width],
            })
            .collect();
        for (i, colour) in colours.colours.iter().enumerate() {
            let in_turn = colours.uncoloured && i + 1 == colours.colours.len();
            for (member, share) in shares.iter_mut().enumerate() {
                let part = cut(colour.len(), member + 1) - cut(colour.len(), member);
                let all = if member == 0 { colour.len() } else { 0 };
                let count = if in_turn { all } else { part };
                let first = share.batches.len();
                share.batches.extend(batches.by_ref().take(count));
                share.colours.push(first..share.batches.len());
            }
        }
        shares
    }

    /// All small steps of one thread's share, in step with the others.
    fn work(&self, scene: &Scene<'_, T>, barrier: &Barrier, mut share: Share<'_, T>) {
        for batch in &mut share.batches {
            if batch.fill(self.impulse, self.parameters, scene.contacts) {
                scene.bounces.store(true, Ordering::Relaxed);
            }
        }
        self.contacts(scene, &mut share, ContactStage::Prepare);
        barrier.wait();
        let colours = |share: &mut Share<'_, T>, stage| {
            for colour in 0..share.colours.len() {
                self.colour(scene, share, colour, stage);
                barrier.wait();
            }
        };
        let bodies = |share: &Share<'_, T>, stage| {
            self.bodies(scene, share.index, stage);
            barrier.wait();
        };
        for step in 0..self.impulse.settings().contact_iterations {
            bodies(&share, BodyStage::Advance { again: step > 0 });
            if step == 0 {
                colours(&mut share, ContactStage::WarmStart);
            }
            colours(&mut share, ContactStage::Solve { pushing: true });
            bodies(&share, BodyStage::Drift);
            colours(&mut share, ContactStage::Solve { pushing: false });
        }
        if scene.bounces.load(Ordering::Relaxed) {
            colours(&mut share, ContactStage::Bounce);
        }
    }

    fn bodies(&self, scene: &Scene<'_, T>, index: &[u32], stage: BodyStage) {
        self.lane.run(Bodies {
            rows: scene.rows,
            index,
            masses: scene.masses,
            globals: self.globals,
            stage,
        });
    }

    /// A stage that changes no body, for all contacts at once.
    fn contacts(&self, scene: &Scene<'_, T>, share: &mut Share<'_, T>, stage: ContactStage) {
        self.lane.run(Contacts {
            rows: scene.rows,
            batches: &mut share.batches,
            globals: self.globals,
            stage,
        });
    }

    fn colour(
        &self,
        scene: &Scene<'_, T>,
        share: &mut Share<'_, T>,
        colour: usize,
        stage: ContactStage,
    ) {
        self.lane.run(Contacts {
            rows: scene.rows,
            batches: &mut share.batches[share.colours[colour].clone()],
            globals: self.globals,
            stage,
        });
    }
}
