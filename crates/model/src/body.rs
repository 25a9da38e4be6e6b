//! Rigid bodies.

use crate::Pose;
use glam::{DMat3, DVec3};
use serde::{Deserialize, Serialize};

/// Row of a body in [`Parts::bodies`](crate::Parts::bodies).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct BodyId(pub usize);

/// Whether a body moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum BodyKind {
    /// Stays where it is, whatever acts on it; its mass is not read.
    Static,
    /// Moves by the laws of mechanics.
    #[default]
    Dynamic,
}

/// A rigid body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// Unique in the model.
    pub name: String,
    /// Static or dynamic.
    pub kind: BodyKind,
    /// Initial placement of the body's frame in the world.
    ///
    /// For a body that hangs on a joint, the joint's coordinates decide; this
    /// placement is what they give at the model's initial coordinates.
    pub pose: Pose,
    /// Mass [kg], above zero for a dynamic body.
    pub mass: f64,
    /// Centre of mass [m] in the body's frame.
    pub center: DVec3,
    /// Inertia [kg·m²] about the centre of mass, along the body's axes.
    pub inertia: DMat3,
    /// Collision group: positive groups collide among themselves and with
    /// negative ones; negative only with positive; 0 with nothing.
    pub group: i32,
    /// Bodies of different numbers, neither of them −1, do not touch, and no joint ties them. Not one of a simulation's
    /// worlds, each of which has all bodies.
    pub world: i32,
}

impl Body {
    /// A dynamic body of mass 1 kg and inertia 1 kg·m², at the origin, in group 1 of world 0.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            kind: BodyKind::Dynamic,
            pose: Pose::IDENTITY,
            mass: 1.0,
            center: DVec3::ZERO,
            inertia: DMat3::IDENTITY,
            group: 1,
            world: 0,
        }
    }
}
