//! The small steps: impulses, colour by colour, between motions of the bodies.

use super::batches::Batch;
use super::colours::Colours;
use super::jobs::{Bodies, BodyRows, BodyStage, ContactStage, Contacts};
use super::team::{Member, Parts, parts, together};
use super::world::Workspace;
use crate::jobs::Lane;
use numbers::Float;
use rigid::impulse::{Cached, Impulse, global};
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

/// The work of a step in parts, for threads to share.
struct Shares<'a, T> {
    /// Of each colour, runs of its batches.
    colours: Vec<Parts<Vec<Batch<'a, T>>>>,
    /// Runs of bodies.
    bodies: Parts<&'a [u32]>,
}

/// Contacts that are worth a thread.
const WORTH_SHARING: usize = 128;
/// Parts for each thread, of each colour and of the bodies.
const PARTS: usize = 2;

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
        let worth = w.colours.batches.len() * self.width / WORTH_SHARING;
        let team = self.team.min(worth).max(1);
        let shares = self.shares(batches, &w.colours, &w.awake, team);
        together(team, |member| self.work(&scene, &shares, member));
        drop(shares);
        for batch in 0..w.colours.batches.len() {
            w.lanes.read(batch, w.colours.batch(batch), &mut w.contacts);
        }
    }

    /// Batches and bodies in parts; what has no colour is one part, since it is solved in turn.
    fn shares<'a>(
        &self,
        mut batches: impl Iterator<Item = Batch<'a, T>>,
        colours: &Colours,
        awake: &'a [u32],
        team: usize,
    ) -> Shares<'a, T> {
        let pieces = if team == 1 { 1 } else { PARTS * team };
        let last = colours.colours.len().wrapping_sub(1);
        let of_colour = |(i, colour): (usize, &std::ops::Range<usize>)| {
            let in_turn = colours.uncoloured && i == last;
            let pieces = if in_turn { 1 } else { pieces };
            let cut = |piece: usize| colour.len() * piece / pieces;
            let sizes = (0..pieces).map(|piece| cut(piece + 1) - cut(piece));
            let taken = sizes.filter(|size| *size > 0);
            parts(taken.map(|size| batches.by_ref().take(size).collect()))
        };
        let run = (awake.len() / self.width).div_ceil(pieces).max(1) * self.width;
        Shares {
            colours: colours.colours.iter().enumerate().map(of_colour).collect(),
            bodies: parts(awake.chunks(run)),
        }
    }

    /// All small steps, as one member of the team goes through them.
    fn work(&self, scene: &Scene<'_, T>, shares: &Shares<'_, T>, mut member: Member<'_>) {
        for colour in &shares.colours {
            member.stage(colour, |batches| {
                for batch in batches.iter_mut() {
                    if batch.fill(self.impulse, self.parameters, scene.contacts) {
                        scene.bounces.store(true, Ordering::Relaxed);
                    }
                }
                self.contacts(scene, batches, ContactStage::Prepare);
            });
        }
        let colours = |member: &mut Member<'_>, stage| {
            for colour in &shares.colours {
                member.stage(colour, |batches| self.contacts(scene, batches, stage));
            }
        };
        let bodies = |member: &mut Member<'_>, stage| {
            member.stage(&shares.bodies, |index| self.bodies(scene, index, stage));
        };
        for step in 0..self.impulse.settings().contact_iterations {
            bodies(&mut member, BodyStage::Advance { again: step > 0 });
            if step == 0 {
                colours(&mut member, ContactStage::WarmStart);
            }
            colours(&mut member, ContactStage::Solve { pushing: true });
            bodies(&mut member, BodyStage::Drift);
            colours(&mut member, ContactStage::Solve { pushing: false });
        }
        if scene.bounces.load(Ordering::Relaxed) {
            colours(&mut member, ContactStage::Bounce);
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

    fn contacts(&self, scene: &Scene<'_, T>, batches: &mut [Batch<'_, T>], stage: ContactStage) {
        self.lane.run(Contacts {
            rows: scene.rows,
            batches,
            globals: self.globals,
            stage,
        });
    }
}
