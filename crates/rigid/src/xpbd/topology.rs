//! The trees that a model's joints make, as the pass over them reads them.

use super::tables::{Group, Tables, arrival, inbound, joint_field, mass, row_link};
use crate::tables::Filler;
use glam::DVec3;
use model::{BodyId, BodyKind, JointId, JointKind, Model, Pose};

/// The joint that carries a body in a tree. None does if it lets the body go, or if nothing moves.
pub(crate) fn carrier(model: &Model, BodyId(body): BodyId) -> Option<usize> {
    let JointId(joint) = model.carrier(BodyId(body))?;
    let holds = model.joints[joint].kind != JointKind::Free;
    let moves = model.bodies[body].kind == BodyKind::Dynamic;
    (holds && moves).then_some(joint)
}

/// Joints that hold, but are in no tree.
pub(crate) fn closings(model: &Model) -> impl Iterator<Item = usize> {
    let joints = model.joints.iter().enumerate();
    joints
        .filter(|(_, j)| j.kind != JointKind::Free)
        .filter(|&(i, j)| carrier(model, j.child) != Some(i))
        .map(|(i, _)| i)
}

/// Motions that a joint leaves free: the first one's row, how many along, how many about axes.
type Motions = (usize, usize, usize);

/// Hands out rows of [`Tables::carried`] from the first child of a body to its own turn, so that
/// few are in use at a time, and those stay in the cache.
struct Slots {
    free: Vec<usize>,
    /// Per row: its slot, 0 for none.
    held: Vec<usize>,
}

impl Slots {
    fn new(rows: usize) -> Self {
        Self {
            free: (1..rows).rev().collect(),
            held: vec![0; rows],
        }
    }
    /// Gives a row a slot. Returns how the child arrives there.
    fn take(&mut self, row: usize) -> usize {
        match (row, self.held[row]) {
            (0, _) => arrival::NONE,
            (_, 0) => {
                self.held[row] = self.free.pop().expect("a slot for each body");
                arrival::FIRST
            }
            _ => arrival::LATER,
        }
    }
    /// The slot of a row, which is free from now on.
    fn release(&mut self, row: usize) -> usize {
        let slot = self.held[row];
        if slot > 0 {
            self.free.push(slot);
        }
        slot
    }
}

impl Tables {
    /// What carries each body, which motions that leaves free, and which joints are in no tree.
    ///
    /// `own` has, per body of the model, its row and the model's frame in its own.
    pub(crate) fn fill_tree(
        &self,
        model: &Model,
        groups: &[Group],
        own: &[(usize, Pose)],
        f: &mut Filler,
    ) {
        for (i, j) in closings(model).enumerate() {
            f.link(self.closing_links, i, 0, j);
        }
        self.fill_anchors(model, own, f);
        let motions = self.motions(model, groups);
        let mut slots = Slots::new(self.rows);
        let mut soft = self.ball_motion(self.balls);
        for &BodyId(id) in model.order().iter().rev() {
            let row = own[id].0;
            if let Some(j) = carrier(model, BodyId(id)) {
                let parent = model.joints[j].parent.map_or(0, |p| own[p.0].0);
                let (first, linear, angular) = motions[j];
                let hinge = (linear, angular) == (0, 1);
                let links = [
                    (
                        row_link::INBOUND,
                        if hinge {
                            inbound::HINGE
                        } else {
                            inbound::JOINT
                        },
                    ),
                    (row_link::JOINT, j),
                    (row_link::PARENT, parent),
                    (row_link::CARRIED, slots.release(row)),
                    (row_link::ARRIVAL, slots.take(parent)),
                    (row_link::MOTION, first),
                    (row_link::LINEAR, linear),
                    (row_link::ANGULAR, angular),
                    (row_link::SOFT, soft),
                    (row_link::SOFT_SHIFTS, 3 - linear),
                    (row_link::SOFT_TURNS, 3 - angular),
                ];
                for (field, x) in links {
                    f.link(self.row_links, row, field, x);
                }
                soft += 6 - linear - angular;
            } else if row > 0 {
                let slot = slots.release(row);
                let kind = if slot > 0 {
                    inbound::ROOT
                } else {
                    inbound::ALONE
                };
                f.link(self.row_links, row, row_link::CARRIED, slot);
                f.link(self.row_links, row, row_link::INBOUND, kind);
            }
        }
    }

    /// Where the joint that carries a body holds it, and the way from there to where it carries
    /// others, both in its own frame.
    fn fill_anchors(&self, model: &Model, own: &[(usize, Pose)], f: &mut Filler) {
        let read = |f: &Filler, at: usize| DVec3::from_slice(&f.parameters[at..][..3]);
        for &BodyId(id) in model.order() {
            let Some(j) = carrier(model, BodyId(id)) else {
                continue;
            };
            let anchor = read(f, self.joint.at(j, joint_field::ANCHOR_B));
            f.vec3(self.mass, own[id].0, mass::ANCHOR, anchor);
            let parent = model.joints[j].parent.map_or(0, |p| own[p.0].0);
            let from = read(f, self.mass.at(parent, mass::ANCHOR));
            let to = read(f, self.joint.at(j, joint_field::ANCHOR_A));
            f.vec3(self.joint, j, joint_field::STEP, to - from);
        }
    }

    /// Per joint.
    fn motions(&self, model: &Model, groups: &[Group]) -> Vec<Motions> {
        let mut motions = vec![(0, 0, 0); model.joints.len()];
        let mut next = 0;
        for group in groups {
            let (linear, angular) = (group.linear.len(), group.angular.len());
            motions[group.joint] = (next, linear, angular);
            next += linear + angular;
        }
        let balls = model
            .joints
            .iter()
            .enumerate()
            .filter(|(_, j)| j.kind == JointKind::Ball && !j.closes_loop);
        for (ball, (j, _)) in balls.enumerate() {
            motions[j] = (self.ball_motion(ball), 0, 3);
        }
        motions
    }

    /// First of the three motions of a ball.
    pub(crate) fn ball_motion(&self, ball: usize) -> usize {
        self.coordinates + 3 * ball
    }
}
