//! A pair of shapes with a surface of its own, in the making.

use super::{BodyHandle, ObjectId};
use crate::{Material, Softness};

/// A shape of a body, or of an object's scenery; of every replica of it. Made by
/// [`BodyHandle::shape`] and [`ObjectId::scenery`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ShapeHandle {
    pub(super) object: ObjectId,
    /// Number of its body in the object; `None` for scenery.
    pub(super) body: Option<usize>,
    pub(super) index: usize,
}

impl ShapeHandle {
    /// The object it is of.
    pub fn object(&self) -> ObjectId {
        self.object
    }
}

impl BodyHandle {
    /// The shape of this number, counted from 0 in the order of adding.
    pub fn shape(&self, index: usize) -> ShapeHandle {
        ShapeHandle {
            object: self.object,
            body: Some(self.index),
            index,
        }
    }
}

impl ObjectId {
    /// The shape of this number among those fixed to the world, counted from 0 in the order of adding.
    pub fn scenery(&self, index: usize) -> ShapeHandle {
        ShapeHandle {
            object: *self,
            body: None,
            index,
        }
    }
}

/// Two shapes that touch in any case, in the making: with the surface that both shapes' materials
/// made of each other when it was begun, unless said otherwise. See [`ContactPair`](crate::ContactPair).
#[derive(Clone, Debug)]
pub struct ContactPairDraft {
    pub(super) shapes: [ShapeHandle; 2],
    material: Material,
}

impl ContactPairDraft {
    pub(super) fn new(shapes: [ShapeHandle; 2], material: Material) -> Self {
        Self { shapes, material }
    }
    /// The shapes.
    pub fn shapes(&self) -> [ShapeHandle; 2] {
        self.shapes
    }
    /// Its surface.
    pub fn surface(&self) -> Material {
        self.material
    }
    /// Sets the whole surface.
    pub fn material(&mut self, material: Material) -> &mut Self {
        self.material = material;
        self
    }
    /// Sets the Coulomb friction coefficient.
    pub fn friction(&mut self, coefficient: f64) -> &mut Self {
        self.material.friction = coefficient;
        self
    }
    /// Sets the torsional friction coefficient [m].
    pub fn torsional_friction(&mut self, coefficient: f64) -> &mut Self {
        self.material.torsional_friction = coefficient;
        self
    }
    /// Sets the rolling friction coefficient [m].
    pub fn rolling_friction(&mut self, coefficient: f64) -> &mut Self {
        self.material.rolling_friction = coefficient;
        self
    }
    /// Sets separation speed over approach speed, 0 to 1.
    pub fn restitution(&mut self, restitution: f64) -> &mut Self {
        self.material.restitution = restitution;
        self
    }
    /// Sets how far the surfaces give way.
    pub fn softness(&mut self, softness: Softness) -> &mut Self {
        self.material.softness = softness;
        self
    }
    /// Sets the gap [m] between the two at which contact begins.
    pub fn margin(&mut self, margin: f64) -> &mut Self {
        self.material.margin = margin;
        self
    }

    /// Whether it is of these two, in any order.
    pub(super) fn is_of(&self, a: ShapeHandle, b: ShapeHandle) -> bool {
        self.shapes == [a, b] || self.shapes == [b, a]
    }
}
