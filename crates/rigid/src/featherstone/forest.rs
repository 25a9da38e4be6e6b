//! The bodies of a model sorted into trees of nodes.
//!
//! Bodies that no axis separates are one *node*; fixed bodies are placed on
//! their node when reported. A node's frame is the child's joint frame, so that
//! its axes pass through its origin. Every joint is a sequence of
//! *motions*: revolute, prismatic or ball; a free joint is three prismatic
//! motions and a ball, a `d6` its axes in turn.

use super::closing::Closing;
use super::coupling::Coupled;
use super::force::only_forces_act;
use super::tables::{NAME, closes, motion};
use super::tied::{Bulk, Tied};
use super::wheel;
use crate::SolverError;
use crate::contacts::Seat as Carrier;
use crate::locks::Locks;
use glam::{DMat3, DQuat, DVec3};
use model::{
    Axis, AxisKind, Body, BodyId, BodyKind, Joint, JointId, JointKind, Model, Pose, ShapeId,
};

/// Tree of what is on no body.
const WORLD: usize = 0;

/// One of the bodies that a model's joints separate.
#[derive(Clone, Debug)]
pub(crate) struct Node {
    pub parent: Option<usize>,
    pub(super) tree: usize,
    /// In the parent's frame, or the world's, where all coordinates are at their reference.
    pub place: Pose,
    pub motions: Vec<Motion>,
    /// Whether its contacts go along: a root on a free joint, or a wheel.
    pub(super) rolls: bool,
    /// A root on a free joint along which nothing acts but forces.
    pub(super) floats: bool,
    pub dof: usize,
    pub mass: f64,
    pub center: DVec3,
    /// About the centre, node axes.
    pub inertia: DMat3,
}

/// One elementary motion.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    pub kind: usize,
    pub axis: DVec3,
    pub(super) reference: f64,
    pub(super) coordinate: usize,
    pub(super) dof: usize,
}

impl Node {
    pub fn dofs(&self) -> usize {
        self.motions
            .iter()
            .map(|m| if m.kind == motion::BALL { 3 } else { 1 })
            .sum()
    }
    /// Moments of inertia about three axes through the node's origin, less half of what its centre adds to them.
    fn moment(&self) -> f64 {
        let i = self.inertia;
        i.x_axis.x + i.y_axis.y + i.z_axis.z + self.mass * self.center.length_squared()
    }
    /// Adds a body placed at `place` in the node: masses add, inertias by Steiner's theorem.
    fn weld(&mut self, body: &Body, place: Pose) {
        let (m, c) = (body.mass, place.point(body.center));
        let i = turned(body.inertia, place.orientation);
        let total = self.mass + m;
        let center = (self.center * self.mass + c * m) / total;
        self.inertia =
            self.inertia + steiner(self.mass, self.center - center) + i + steiner(m, c - center);
        self.center = center;
        self.mass = total;
    }
}

/// m (d·d 1 − d dᵀ).
pub(crate) fn steiner(m: f64, d: DVec3) -> DMat3 {
    let outer = DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    (DMat3::from_diagonal(DVec3::splat(d.length_squared())) - outer) * m
}

/// An inertia in axes that are turned.
pub(crate) fn turned(inertia: DMat3, turn: DQuat) -> DMat3 {
    let turn = DMat3::from_quat(turn);
    turn * inertia * turn.transpose()
}

/// Where a body sits: on a node or in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seat {
    pub node: Option<usize>,
    pub place: Pose,
}

/// The bodies of a model sorted into nodes.
pub(crate) struct Forest {
    pub nodes: Vec<Node>,
    pub bases: Vec<Pose>,
    pub(super) seats: Vec<Seat>,
    /// Mass [kg] of each tree.
    masses: Vec<f64>,
    /// Row of each body in the model's order.
    rows: Vec<usize>,
}

/// The nodes, each limb to its end before the next begins, so that whoever carries any is followed by the first. Those that a
/// node carries come in their order, so that sums over them are what they are depth by depth.
pub(super) fn along_limbs(forest: &Forest, children: &[Vec<usize>]) -> Vec<usize> {
    let roots = (0..forest.nodes.len()).filter(|&n| forest.nodes[n].parent.is_none());
    let mut waiting: Vec<_> = roots.rev().collect();
    let mut limbs = Vec::new();
    while let Some(n) = waiting.pop() {
        limbs.push(n);
        waiting.extend(children[n].iter().rev());
    }
    limbs
}

impl Forest {
    /// No node, and all bodies in the world.
    pub fn empty(model: &Model) -> Self {
        let world = Seat {
            node: None,
            place: Pose::IDENTITY,
        };
        Self {
            nodes: Vec::new(),
            bases: vec![Pose::IDENTITY],
            seats: vec![world; model.bodies.len()],
            masses: Vec::new(),
            rows: vec![0; model.bodies.len()],
        }
    }

    pub fn new(model: &Model) -> Self {
        let mut forest = Self::empty(model);
        for (row, &id) in model.order().iter().enumerate() {
            forest.rows[id.0] = row;
            forest.seats[id.0] = forest.seat(model, id);
            let Seat { node, place } = forest.seats[id.0];
            if let Some(n) = node {
                forest.nodes[n].weld(&model.bodies[id.0], place);
            }
        }
        forest.sort_by_depth();
        forest.masses = vec![0.0; forest.bases.len()];
        for node in &forest.nodes {
            forest.masses[node.tree] += node.mass;
        }
        forest
    }

    /// Becomes that of the bodies of one joint of the tree by themselves, its parent free. Only their seats are known then, so
    /// that one forest serves all joints of a model, however many it has.
    pub fn take_joint(&mut self, model: &Model, id: JointId) {
        self.nodes.clear();
        self.bases.truncate(1);
        let Joint { parent, child, .. } = model.joints[id.0];
        if let Some(parent) = parent {
            let body = &model.bodies[parent.0];
            let place = Pose::IDENTITY;
            self.seats[parent.0] = match body.kind {
                BodyKind::Dynamic => {
                    let n = self.push(None, place, Vec::new());
                    self.nodes[n].weld(body, place);
                    Seat {
                        node: Some(n),
                        place,
                    }
                }
                BodyKind::Static => Seat {
                    node: None,
                    place: body.pose,
                },
            };
        }
        let Seat { node, place } = self.seat(model, child);
        if let Some(n) = node {
            self.nodes[n].weld(&model.bodies[child.0], place);
        }
    }

    /// Finds the nodes whose last motion [turns about itself](wheel::rolls) all of theirs that touches, which is this.
    pub(super) fn find_wheels(&mut self, model: &Model, touching: impl Iterator<Item = ShapeId>) {
        let mut wheels = vec![None; self.nodes.len()];
        for shape in touching
            .map(|shape| &model.shapes[shape.0])
            .filter(|shape| !shape.sensor)
        {
            let seat = shape.body.map(|body| self.seats[body.0]);
            let Some((n, seat)) = seat.and_then(|seat| Some((seat.node?, seat))) else {
                continue;
            };
            let last = self.nodes[n].motions.last();
            let rolls = last.is_some_and(|last| {
                let at = seat.place * shape.pose;
                wheel::rolls(last.kind, last.axis, &shape.geometry, at)
            });
            wheels[n] = Some(rolls && wheels[n] != Some(false));
        }
        for (node, wheel) in self.nodes.iter_mut().zip(wheels) {
            node.rolls |= wheel == Some(true);
        }
    }

    /// Nodes of one depth next to each other: no node waits for its neighbour in a pass,
    /// so that the processor works on several at once.
    fn sort_by_depth(&mut self) {
        let mut depth: Vec<usize> = Vec::new();
        for node in &self.nodes {
            depth.push(node.parent.map_or(0, |p: usize| depth[p] + 1));
        }
        let mut order: Vec<_> = (0..self.nodes.len()).collect();
        order.sort_by_key(|&n| depth[n]);
        let mut place = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            place[old] = new;
        }
        self.nodes = order.iter().map(|&old| self.nodes[old].clone()).collect();
        for node in &mut self.nodes {
            node.parent = node.parent.map(|p| place[p]);
        }
        for seat in &mut self.seats {
            seat.node = seat.node.map(|n| place[n]);
        }
    }

    /// The nodes that each carries.
    pub(super) fn children(&self) -> Vec<Vec<usize>> {
        let mut children = vec![Vec::new(); self.nodes.len()];
        for (n, node) in self.nodes.iter().enumerate() {
            if let Some(parent) = node.parent {
                children[parent].push(n);
            }
        }
        children
    }

    /// What carries a body: a node, in its tree, or the world, as it does what is on no body.
    pub(super) fn carrier(&self, body: Option<BodyId>) -> Carrier {
        let world = Seat {
            node: None,
            place: Pose::IDENTITY,
        };
        let Seat { node, place } = body.map_or(world, |id| self.seats[id.0]);
        let bases = self.bases.len();
        let (row, group, mass) = match node {
            Some(n) => {
                let tree = self.nodes[n].tree;
                (bases + n, tree, self.masses[tree])
            }
            None => (0, 0, f64::INFINITY),
        };
        Carrier {
            row,
            group,
            place,
            mass,
        }
    }

    /// Row of a body in the model's order; one past the last for the world.
    pub(super) fn row(&self, body: Option<BodyId>) -> usize {
        body.map_or(self.rows.len(), |id| self.rows[id.0])
    }

    /// Tells joints and couplings what hangs together by all of them.
    pub(super) fn tie(&self, model: &Model, closings: &mut [Closing], couplings: &mut [Coupled]) {
        let mut label: Vec<_> = (0..self.bases.len()).collect();
        let pairs = closings.iter().map(|c| c.groups);
        for [a, b] in pairs.chain(couplings.iter().map(|c| c.groups)) {
            if a != WORLD && b != WORLD {
                let (from, to) = (label[b], label[a]);
                label
                    .iter_mut()
                    .filter(|l| **l == from)
                    .for_each(|l| *l = to);
            }
        }
        let mut of = vec![Bulk::default(); self.bases.len()];
        for node in self.nodes.iter().filter(|n| n.mass > 0.0) {
            of[label[node.tree]].add(node.mass, node.moment());
        }
        for joint in model.joints.iter().filter(|j| !closes(j)) {
            if let Some(n) = self.seats[joint.child.0].node {
                of[label[self.nodes[n].tree]].reflect(joint);
            }
        }
        let tied = |[a, b]: [usize; 2]| of[label[if a == WORLD { b } else { a }]].tied();
        for closing in closings {
            let length = model.joints[closing.joint].length;
            closing.tied = tied(closing.groups).reaching(length);
        }
        for coupled in couplings {
            coupled.tied = tied(coupled.groups);
        }
    }

    fn of_tree(&self, tree: usize) -> impl Iterator<Item = &Node> {
        self.nodes.iter().filter(move |n| n.tree == tree)
    }

    /// The joints that close loops, and lock anything.
    pub(super) fn closings(&self, model: &Model) -> Result<Vec<Closing>, SolverError> {
        let joints = model.joints.iter().enumerate();
        joints
            .filter(|(_, j)| closes(j) && j.kind != JointKind::Free)
            .map(|(i, joint)| self.closing(i, joint))
            .filter(|c| c.as_ref().map_or(true, |c| c.locks.rows().contains(&true)))
            .collect()
    }

    /// Where the joints of each coupling are; each of them has one axis, and so a node of its own.
    pub(super) fn couplings(&self, model: &Model) -> Vec<Coupled> {
        let bases = self.bases.len();
        let node = |joint: JointId| {
            let dof = model.dof_range(joint).start;
            let node = self.nodes.iter().position(|n| n.dof == dof);
            node.expect("a coupled joint is in the tree")
        };
        let couplings = model.couplings.iter().map(|c| [c.joint, c.other].map(node));
        couplings
            .map(|nodes| Coupled {
                groups: nodes.map(|n| self.nodes[n].tree),
                rows: nodes.map(|n| bases + n),
                couple: 0,
                locked: 0,
                starts: [0; 2],
                tied: Tied::default(),
            })
            .collect()
    }

    fn closing(&self, i: usize, joint: &Joint) -> Result<Closing, SolverError> {
        let (linear, angular) = crate::check::axes(joint, NAME)?;
        let ends = [joint.parent, Some(joint.child)];
        let [a, b] = ends.map(|body| self.carrier(body));
        if a.row == b.row {
            return Err(SolverError::Unsupported {
                solver: NAME,
                what: "a loop of bodies that nothing separates",
                name: joint.name.clone(),
                remedy: "remove the joint",
            });
        }
        let lighter = if a.mass < b.mass { &a } else { &b };
        let moment: f64 = self.of_tree(lighter.group).map(Node::moment).sum();
        Ok(Closing {
            joint: i,
            locks: Locks::new(joint, &linear, &angular),
            groups: [a.group, b.group],
            rows: [a.row, b.row],
            places: [a.place, b.place],
            bodies: ends.map(|body| self.row(body)),
            couple: 0,
            locked: [0; 6],
            mass: [lighter.mass, moment],
            tied: Tied::default(),
        })
    }

    fn seat(&mut self, model: &Model, id: BodyId) -> Seat {
        let body = &model.bodies[id.0];
        let Some(joint_id) = model.carrier(id) else {
            return Seat {
                node: None,
                place: body.pose,
            };
        };
        let joint = &model.joints[joint_id.0];
        let parent = match joint.parent {
            Some(p) => self.seats[p.0],
            None => Seat {
                node: None,
                place: Pose::IDENTITY,
            },
        };
        let place = parent.place * joint.parent_frame;
        if joint.kind == JointKind::Fixed {
            return Seat {
                node: parent.node,
                place: place * joint.child_frame.inverse(),
            };
        }
        let (node, shift) = self.grow(model, joint_id, joint, parent.node, place);
        Seat {
            node: Some(node),
            place: Pose::at(-shift) * joint.child_frame.inverse(),
        }
    }

    /// Adds the nodes of a joint: one for each run of axes that meet in a point.
    /// Returns the last, and where its origin lies in the joint's frame.
    fn grow(
        &mut self,
        model: &Model,
        id: JointId,
        joint: &Joint,
        mut parent: Option<usize>,
        mut place: Pose,
    ) -> (usize, DVec3) {
        let mut shift = DVec3::ZERO;
        let mut motions: Vec<Motion> = Vec::new();
        for (motion, anchor) in joint_motions(model, id, joint) {
            let anchor = anchor.unwrap_or(shift);
            if anchor != shift && motions.is_empty() {
                place = place * Pose::at(anchor - shift);
                shift = anchor;
            } else if anchor != shift {
                parent = Some(self.push(parent, place, std::mem::take(&mut motions)));
                place = Pose::at(anchor - shift);
                shift = anchor;
            }
            motions.push(motion);
        }
        let node = self.push(parent, place, motions);
        let free = parent.is_none() && joint.kind == JointKind::Free;
        self.nodes[node].rolls = free;
        self.nodes[node].floats = free && only_forces_act(model, id);
        (node, shift)
    }

    fn push(&mut self, parent: Option<usize>, place: Pose, motions: Vec<Motion>) -> usize {
        let tree = match parent {
            Some(p) => self.nodes[p].tree,
            None => {
                self.bases.push(place);
                self.bases.len() - 1
            }
        };
        let dof = motions.first().map_or(0, |motion| motion.dof);
        self.nodes.push(Node {
            parent,
            tree,
            place,
            motions,
            rolls: false,
            floats: false,
            dof,
            mass: 0.0,
            center: DVec3::ZERO,
            inertia: DMat3::ZERO,
        });
        self.nodes.len() - 1
    }
}

/// The motions of a joint, each with the point its axis passes through, if it matters.
fn joint_motions(model: &Model, id: JointId, joint: &Joint) -> Vec<(Motion, Option<DVec3>)> {
    let (q, v) = (model.coordinate_range(id).start, model.dof_range(id).start);
    let axis = |i: usize, a: &Axis| {
        let kind = match a.kind {
            AxisKind::Angular => motion::REVOLUTE,
            AxisKind::Linear => motion::PRISMATIC,
        };
        let anchor = (a.kind == AxisKind::Angular).then_some(a.anchor);
        let motion = Motion {
            kind,
            axis: a.direction,
            reference: a.reference,
            coordinate: q + i,
            dof: v + i,
        };
        (motion, anchor)
    };
    let ball = |coordinate, dof| {
        let axis = DVec3::ZERO;
        (
            Motion {
                kind: motion::BALL,
                axis,
                reference: 0.0,
                coordinate,
                dof,
            },
            None,
        )
    };
    match joint.kind {
        JointKind::Ball => vec![ball(q, v)],
        JointKind::Free => {
            let translations = [DVec3::X, DVec3::Y, DVec3::Z].map(Axis::linear);
            let mut motions: Vec<_> = translations
                .iter()
                .enumerate()
                .map(|(i, a)| axis(i, a))
                .collect();
            motions.push(ball(q + 3, v + 3));
            motions
        }
        _ => joint
            .axes
            .iter()
            .enumerate()
            .map(|(i, a)| axis(i, a))
            .collect(),
    }
}
