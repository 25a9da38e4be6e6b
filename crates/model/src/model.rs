//! The flat tables of a model, checked.

mod check;
mod drives;
mod joints;
mod lookup;
mod tree;
pub(crate) mod validate;

use crate::contact_pair::key;
use crate::{
    Actuator, AxisKind, Body, BodyId, BodyKind, Camera, ContactPair, Coupling, Joint, JointId,
    JointKind, Keyframe, Lamp, Material, ModelError, Sensor, Shape, ShapeId,
};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

pub(crate) use check::Subject;
pub use lookup::{hint, similar_name};
pub(crate) use validate::MOST_ROWS;

/// Which axis points up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum UpAxis {
    /// As in USD and glTF.
    #[default]
    Y,
    /// As in MJCF and URDF.
    Z,
}

impl UpAxis {
    /// Unit vector upwards.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }
}

/// Everything a [`Model`] is made of, not yet checked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Parts {
    /// Name of the model.
    pub name: String,
    /// Which axis points up.
    pub up_axis: UpAxis,
    /// Acceleration of gravity [m/s²].
    pub gravity: DVec3,
    /// Time step [s] the author recommends.
    pub time_step: f64,
    /// Bodies.
    pub bodies: Vec<Body>,
    /// Shapes.
    pub shapes: Vec<Shape>,
    /// Joints. The first that names a body as its child carries it; later ones
    /// must be marked as closing a loop.
    pub joints: Vec<Joint>,
    /// Pairs of bodies whose shapes do not touch; `None` is the world.
    pub exclusions: Vec<(Option<BodyId>, BodyId)>,
    /// Pairs of shapes that touch in any case, with a surface of their own.
    pub contact_pairs: Vec<ContactPair>,
    /// Relations of coordinates.
    pub couplings: Vec<Coupling>,
    /// Control inputs.
    pub actuators: Vec<Actuator>,
    /// What the robot's file says of its sensors.
    pub sensors: Vec<Sensor>,
    /// Named states.
    pub keyframes: Vec<Keyframe>,
    /// Cameras with names.
    pub cameras: Vec<Camera>,
    /// Lights. Where there is none, it is day.
    pub lamps: Vec<Lamp>,
    /// Number of worlds the author asks for.
    pub worlds: usize,
}

impl Default for Parts {
    /// An empty model with gravity 9.81 m/s² downwards (Y up) and a step of 2 ms.
    fn default() -> Self {
        Self {
            name: "model".into(),
            up_axis: UpAxis::Y,
            gravity: DVec3::new(0.0, -9.81, 0.0),
            time_step: 0.002,
            bodies: Vec::new(),
            shapes: Vec::new(),
            joints: Vec::new(),
            exclusions: Vec::new(),
            contact_pairs: Vec::new(),
            couplings: Vec::new(),
            actuators: Vec::new(),
            sensors: Vec::new(),
            keyframes: Vec::new(),
            cameras: Vec::new(),
            lamps: Vec::new(),
            worlds: 1,
        }
    }
}

/// A checked, immutable model of one world, shared by all worlds of a simulation.
///
/// Reads as its [`Parts`]. In addition it knows where each joint's coordinates
/// and velocities lie, and which joint carries which body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Parts", into = "Parts")]
pub struct Model {
    parts: Parts,
    coordinate_start: Vec<usize>,
    dof_start: Vec<usize>,
    carrier: Vec<Option<JointId>>,
    order: Vec<BodyId>,
    /// Row of each contact pair, by the rows of its shapes, the lower first.
    pair_row: HashMap<(usize, usize), usize>,
}

impl From<Model> for Parts {
    fn from(model: Model) -> Self {
        model.parts
    }
}

impl TryFrom<Parts> for Model {
    type Error = ModelError;
    fn try_from(parts: Parts) -> Result<Self, ModelError> {
        Self::new(parts)
    }
}

impl std::ops::Deref for Model {
    type Target = Parts;
    fn deref(&self) -> &Parts {
        &self.parts
    }
}

impl Model {
    /// Checks the parts and completes them.
    ///
    /// Every dynamic body that no joint carries gets a `free` joint from the world, named
    /// `<body>_free`, after the joints given. Bodies that hang on joints are placed by the
    /// joints' initial coordinates.
    ///
    /// # Errors
    /// The first fault found, with its remedy; see [`ModelError`].
    pub fn new(mut parts: Parts) -> Result<Self, ModelError> {
        validate::parts(&parts)?;
        let mut carrier = tree::carriers(&parts)?;
        tree::free_the_rest(&mut parts, &mut carrier);
        let order = tree::order(&parts, &carrier)?;
        let coordinate_start = tree::starts(parts.joints.iter().map(Joint::coordinates));
        let dof_start = tree::starts(parts.joints.iter().map(Joint::degrees_of_freedom));
        let dofs = dof_start[parts.joints.len()];
        for keyframe in &parts.keyframes {
            validate::keyframe(keyframe, &parts, &coordinate_start, dofs)?;
        }
        tree::place(&mut parts, &carrier, &order);
        for pair in &mut parts.contact_pairs {
            pair.follow(&parts.shapes);
        }
        let pairs = parts.contact_pairs.iter().enumerate();
        let pair_row = pairs.map(|(row, pair)| (pair.key(), row)).collect();
        Ok(Self {
            parts,
            coordinate_start,
            dof_start,
            carrier,
            order,
            pair_row,
        })
    }

    /// The tables, to change them and make another model.
    pub fn into_parts(self) -> Parts {
        self.parts
    }

    /// Number of coordinates of a state.
    pub fn coordinates(&self) -> usize {
        self.coordinate_start[self.joints.len()]
    }
    /// Number of velocities of a state.
    pub fn degrees_of_freedom(&self) -> usize {
        self.dof_start[self.joints.len()]
    }
    /// Where a joint's coordinates lie in a state.
    pub fn coordinate_range(&self, joint: JointId) -> std::ops::Range<usize> {
        self.coordinate_start[joint.0]..self.coordinate_start[joint.0 + 1]
    }
    /// Where quaternions lie among the coordinates of a state, four numbers each, and the joints they are of.
    pub fn quaternions(&self) -> impl Iterator<Item = (JointId, std::ops::Range<usize>)> {
        let turning = |kind| matches!(kind, JointKind::Ball | JointKind::Free);
        let joints = self.joints.iter().enumerate();
        joints
            .filter(move |(_, j)| turning(j.kind) && !j.closes_loop)
            .map(|(i, _)| {
                let end = self.coordinate_start[i + 1];
                (JointId(i), end - 4..end)
            })
    }
    /// Where a joint's velocities lie in a state.
    pub fn dof_range(&self, joint: JointId) -> std::ops::Range<usize> {
        self.dof_start[joint.0]..self.dof_start[joint.0 + 1]
    }
    /// The joint that carries a body: the one in the tree. A dynamic body that no
    /// joint carries got a `free` joint when the model was made; a static body has none.
    /// Distance joints and joints that close a loop never carry.
    pub fn carrier(&self, body: BodyId) -> Option<JointId> {
        self.carrier[body.0]
    }
    /// The bodies, every parent before its children.
    pub fn order(&self) -> &[BodyId] {
        &self.order
    }

    /// The surface that a contact of two shapes has: their pair's own, or else what their materials
    /// make of each other.
    ///
    /// # Panics
    /// If a shape is not of this model.
    pub fn contact_material(&self, a: ShapeId, b: ShapeId) -> Material {
        match self.pair_row.get(&key(a, b)) {
            Some(row) => self.contact_pairs[*row].material,
            None => self.shapes[a.0].material.with(&self.shapes[b.0].material),
        }
    }

    /// Whether an axis of a joint turns without end, so that whole turns of it do not count: an angular one without a limit,
    /// a spring, a coupling, or an actuator that heeds its position. What drives it goes the shorter way round.
    ///
    /// # Panics
    /// If the joint is not of this model, or has no such degree of freedom.
    pub fn turns_without_end(&self, joint: JointId, axis: usize) -> bool {
        let Joint { axes, dofs, .. } = &self.joints[joint.0];
        let angular = axes.get(axis).is_some_and(|a| a.kind == AxisKind::Angular);
        let heeds = |a: &Actuator| a.joint == joint && a.dof == axis && a.bias[1] != 0.0;
        let free = dofs[axis].limit.is_none() && dofs[axis].stiffness == 0.0;
        let coupled = |c: &Coupling| c.joint == joint || c.other == joint;
        let counts = self.actuators.iter().any(heeds) || self.couplings.iter().any(coupled);
        angular && free && !counts
    }

    /// Initial coordinates of all joints, [`coordinates`](Self::coordinates) of them.
    pub fn initial_position(&self) -> Vec<f64> {
        let in_state = self.joints.iter().filter(|j| !j.closes_loop);
        in_state.flat_map(|j| j.initial.iter().copied()).collect()
    }
    /// Mass of all dynamic bodies [kg].
    pub fn total_mass(&self) -> f64 {
        let dynamic = self.bodies.iter().filter(|b| b.kind == BodyKind::Dynamic);
        // The sum of none is −0.
        0.0 + dynamic.map(|b| b.mass).sum::<f64>()
    }
    /// Whether the joints form a tree, so that their coordinates are independent.
    pub fn is_tree(&self) -> bool {
        self.loops().is_empty()
    }
    /// What ties coordinates together so that the model is no tree, as in `distance joint "rope"`:
    /// joints that close a loop, distance joints and couplings.
    pub fn loops(&self) -> Vec<String> {
        let joints = self.joints.iter().filter_map(|j| match j.kind {
            JointKind::Distance => Some(format!("distance joint \"{}\"", j.name)),
            _ if j.closes_loop => Some(format!("joint \"{}\" closing a loop", j.name)),
            _ => None,
        });
        let couplings = self
            .couplings
            .iter()
            .map(|c| format!("coupling \"{}\"", c.name));
        joints.chain(couplings).collect()
    }
}

/// Scales a quaternion among the coordinates of a state to unit length. False, and as it was, where it is zero.
pub fn unit_quaternion(coordinates: &mut [f64]) -> bool {
    let q = DQuat::from_slice(coordinates);
    let length = q.length();
    if length < 1e-12 {
        return false;
    }
    coordinates.copy_from_slice(&(q / length).to_array());
    true
}
