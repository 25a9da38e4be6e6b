//! Two shapes whose contact is said by itself.

use crate::{Material, ShapeId};
use serde::{Deserialize, Serialize};

/// Two shapes that touch, and the surface that their contact has.
///
/// They touch whatever masks, groups, joints and exclusions say, and whether or not they collide
/// with others; but not where neither moves, nor where both are of one body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ContactPair {
    /// The shapes, in any order.
    pub shapes: (ShapeId, ShapeId),
    /// Surface, instead of the combination of both shapes' own; its
    /// [`combine`](Material::combine) does not matter.
    pub material: Material,
}

impl ContactPair {
    /// The rows of the shapes, the lower first.
    pub(crate) fn key(&self) -> (usize, usize) {
        key(self.shapes.0, self.shapes.1)
    }
}

/// The rows of two shapes, the lower first.
pub(crate) fn key(a: ShapeId, b: ShapeId) -> (usize, usize) {
    (a.0.min(b.0), a.0.max(b.0))
}
