//! The small steps: impulses, colour by colour, between motions of the bodies.

use super::batches::Batch;
use super::jobs::{Bodies, BodyRows, BodyStage, ContactStage, Contacts};
use super::joints::{JointBatch, JointStage, Joints};
use super::shares::{Cuts, pieces};
use super::team::{Member, Parts, parts, together};
use super::world::Workspace;
use crate::jobs::Lane;
use numbers::Float;
use rigid::impulse::blow::ROUNDS;
use rigid::impulse::{Cached, Impulse, State, global};
use std::slice;
use std::sync::atomic::{AtomicBool, Ordering};

/// How to solve the contacts and joints of a step.
#[derive(Clone, Copy)]
pub(super) struct Solver<'a, T> {
    pub impulse: &'a Impulse,
    pub parameters: &'a [T],
    pub input: &'a [T],
    /// Whether it is the first part of a step, or all of it.
    pub first: bool,
    pub small_steps: usize,
    pub lane: Lane,
    /// Contacts in a batch.
    pub width: usize,
    pub team: usize,
    pub globals: &'a [T; global::WIDTH],
}

/// What all threads read.
#[derive(Clone, Copy)]
struct Scene<'a, T: Float> {
    rows: &'a BodyRows<T>,
    masses: &'a [T],
    contacts: &'a [Cached<T>],
    joints: &'a [u32],
    state: State<'a, T>,
    found: &'a Found,
}

/// What threads find out for all, in lines of the cache of its own.
#[repr(align(128))]
struct Found {
    /// Whether any contact can bounce.
    bounces: AtomicBool,
    /// Whether any of those could be struck in this step.
    meets: AtomicBool,
    /// Whether any was struck in each round of blows, of all small steps.
    struck: Vec<AtomicBool>,
}

/// The work of a step in parts, for threads to share.
struct Shares<'a, T> {
    /// Of each stage of contacts, runs of its batches.
    colours: Vec<Parts<Vec<Batch<'a, T>>>>,
    /// The same of joints.
    joints: Vec<Parts<Vec<JointBatch<'a, T>>>>,
    /// Runs of bodies.
    bodies: Parts<&'a [u32]>,
}

fn flags(count: usize) -> Vec<AtomicBool> {
    (0..count).map(|_| AtomicBool::new(false)).collect()
}

/// Contacts, or joints, that are worth a thread.
const WORTH_SHARING: usize = 128;
/// Registers of bodies that move in the time in which a batch is solved.
const BODIES: usize = 4;

impl<T: Float> Solver<'_, T> {
    /// Solves the contacts and joints of a workspace, which have their colours, and moves its bodies.
    pub fn run(&self, state: &[T], w: &mut Workspace<T>) {
        let all = w.colours.batches.len() + w.joint_colours.batches.len();
        let worth = all * self.width / WORTH_SHARING;
        let team = self.team.min(worth).max(1);
        let cuts = Cuts::new(&w.colours, team);
        let joint_cuts = Cuts::new(&w.joint_colours, team);
        w.lanes.make_room(cuts.places(), self.width);
        w.joint_lanes
            .make_room(w.joint_colours.batches.len(), self.width);
        let found = Found {
            bounces: AtomicBool::new(false),
            meets: AtomicBool::new(false),
            struck: flags(self.small_steps * ROUNDS),
        };
        let scene = Scene {
            rows: &w.rows,
            masses: self.impulse.masses(self.parameters),
            contacts: &w.contacts,
            joints: &w.joints,
            state: State {
                impulse: self.impulse,
                state,
                parameters: self.parameters,
            },
            found: &found,
        };
        let members = (0..w.colours.batches.len()).map(|batch| w.colours.batch(batch));
        let batches = w.lanes.batches(members, self.width);
        let joint_members = (0..w.joint_colours.batches.len()).map(|b| w.joint_colours.batch(b));
        let joint_batches = w.joint_lanes.batches(joint_members, self.width);
        let shares = Shares {
            colours: cuts.share(batches),
            joints: joint_cuts.share(joint_batches),
            bodies: self.share_bodies(&w.awake, team),
        };
        together(team, |member| {
            // Copies of its own: next to these, another thread writes what it works with.
            let globals = *self.globals;
            let own = Solver {
                globals: &globals,
                ..*self
            };
            own.work(&{ scene }, &shares, member);
        });
    }

    /// Bodies in parts.
    fn share_bodies<'a>(&self, awake: &'a [u32], team: usize) -> Parts<&'a [u32]> {
        let registers = awake.len() / self.width;
        let pieces = pieces(registers / BODIES, team);
        parts(awake.chunks(registers.div_ceil(pieces).max(1) * self.width))
    }

    /// All small steps, as one member of the team goes through them.
    fn work(&self, scene: &Scene<'_, T>, shares: &Shares<'_, T>, mut member: Member<'_>) {
        for colour in &shares.colours {
            member.stage(colour, |batches| {
                for batch in batches.iter_mut() {
                    batch.fill(self.impulse, self.parameters, scene.contacts);
                    if batch.bounces {
                        scene.found.bounces.store(true, Ordering::Relaxed);
                    }
                }
                self.contacts(scene, batches, ContactStage::Prepare);
            });
        }
        let drives = self.impulse.drives();
        for colour in &shares.joints {
            member.stage(colour, |batches| {
                for batch in batches.iter_mut() {
                    batch.fill(scene.joints, &scene.state, self.input, self.first);
                }
                if drives {
                    self.joints(scene, batches, JointStage::Follow);
                }
                self.joints(scene, batches, JointStage::Place);
            });
        }
        let contacts = |member: &mut Member<'_>, stage| {
            for colour in &shares.colours {
                member.stage(colour, |batches| self.contacts(scene, batches, stage));
            }
        };
        let joints = |member: &mut Member<'_>, stage| {
            for colour in &shares.joints {
                member.stage(colour, |batches| self.joints(scene, batches, stage));
            }
        };
        let bodies = |member: &mut Member<'_>, stage| {
            member.stage(&shares.bodies, |index| self.bodies(scene, index, stage));
        };
        for step in 0..self.small_steps {
            bodies(&mut member, BodyStage::Advance { again: step > 0 });
            if step == 0 {
                self.foresee(scene, shares, &mut member);
                contacts(&mut member, ContactStage::WarmStart);
                joints(&mut member, JointStage::WarmStart);
            }
            if scene.found.meets.load(Ordering::Relaxed) {
                bodies(&mut member, BodyStage::Part);
                self.blows(scene, shares, &mut member, step);
                bodies(&mut member, BodyStage::Part);
            }
            contacts(&mut member, ContactStage::Solve { pushing: true });
            joints(&mut member, JointStage::Solve { pushing: true });
            bodies(&mut member, BodyStage::Drift);
            joints(&mut member, JointStage::Place);
            contacts(&mut member, ContactStage::Solve { pushing: false });
            joints(&mut member, JointStage::Solve { pushing: false });
        }
    }

    /// Which contacts may be struck in this step, if any can bounce.
    fn foresee(&self, scene: &Scene<'_, T>, shares: &Shares<'_, T>, member: &mut Member<'_>) {
        if !scene.found.bounces.load(Ordering::Relaxed) {
            return;
        }
        for colour in &shares.colours {
            member.stage(colour, |batches| {
                for batch in batches.iter_mut().filter(|batch| batch.bounces) {
                    self.contacts(scene, slice::from_mut(batch), ContactStage::Foresee);
                    batch.meets = batch.is_struck();
                    if batch.meets {
                        scene.found.meets.store(true, Ordering::Relaxed);
                    }
                }
            });
        }
    }

    /// The blows of a small step: those of contacts that may be struck, and then of all, until none is.
    fn blows(
        &self,
        scene: &Scene<'_, T>,
        shares: &Shares<'_, T>,
        member: &mut Member<'_>,
        step: usize,
    ) {
        for round in 0..ROUNDS {
            let struck = &scene.found.struck[step * ROUNDS + round];
            for colour in &shares.colours {
                member.stage(colour, |batches| {
                    let takes =
                        |batch: &&mut Batch<'_, T>| batch.bounces && (round > 0 || batch.meets);
                    for batch in batches.iter_mut().filter(takes) {
                        self.contacts(scene, slice::from_mut(batch), ContactStage::Strike);
                        if batch.is_struck() {
                            struck.store(true, Ordering::Relaxed);
                        }
                    }
                });
            }
            if !struck.load(Ordering::Relaxed) {
                return;
            }
            for colour in &shares.joints {
                let stage = JointStage::Strike;
                member.stage(colour, |batches| self.joints(scene, batches, stage));
            }
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

    fn joints(&self, scene: &Scene<'_, T>, batches: &mut [JointBatch<'_, T>], stage: JointStage) {
        self.lane.run(Joints {
            rows: scene.rows,
            batches,
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
