//! Two shapes whose contact is said by itself.

use crate::{Material, Shape, ShapeId};
use serde::{Deserialize, Serialize};

/// Two shapes that touch, and the surface that their contact has.
///
/// They touch whatever masks, groups, joints and exclusions say, and whether or not they collide
/// with others, unless the pair is [`filtered`](Self::filtered); but not where neither moves, nor where both are of one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPair {
    /// The shapes, in any order.
    pub shapes: (ShapeId, ShapeId),
    /// Surface, instead of the combination of both shapes' own; its
    /// [`combine`](Material::combine) does not matter.
    pub material: Material,
    /// Whose friction it has, sliding and static.
    #[serde(default)]
    pub friction: Whose,
    /// Whose restitution it has.
    #[serde(default)]
    pub restitution: Whose,
    /// Whether the shapes touch only where they would without the pair, which then says no more than their surface.
    #[serde(default)]
    pub filtered: bool,
}

/// Whose coefficient a contact pair has. Those of its shapes are written into its surface when the model is made, so that
/// they follow where the shapes get others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Whose {
    /// Its own, whatever its shapes have.
    #[default]
    Own,
    /// What those of both shapes make of each other.
    Both,
    /// That of the first shape.
    First,
    /// That of the second shape.
    Second,
}

impl ContactPair {
    /// A pair with a surface of its own.
    pub fn new(shapes: (ShapeId, ShapeId), material: Material) -> Self {
        Self {
            shapes,
            material,
            friction: Whose::Own,
            restitution: Whose::Own,
            filtered: false,
        }
    }
    /// The rows of the shapes, the lower first.
    pub(crate) fn key(&self) -> (usize, usize) {
        key(self.shapes.0, self.shapes.1)
    }
    /// Takes from the shapes' materials the coefficients that are theirs.
    pub(crate) fn follow(&mut self, shapes: &[Shape]) {
        let [a, b] = [self.shapes.0, self.shapes.1].map(|id| shapes[id.0].material);
        let of = |whose| match whose {
            Whose::Own => None,
            Whose::Both => Some(a.with(&b)),
            Whose::First => Some(a),
            Whose::Second => Some(b),
        };
        if let Some(other) = of(self.friction) {
            self.material.friction = other.friction;
            self.material.static_friction = other.static_friction;
        }
        if let Some(other) = of(self.restitution) {
            self.material.restitution = other.restitution;
        }
    }
}

/// The rows of two shapes, the lower first.
pub(crate) fn key(a: ShapeId, b: ShapeId) -> (usize, usize) {
    (a.0.min(b.0), a.0.max(b.0))
}
