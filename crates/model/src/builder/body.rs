//! A body in the making.

use super::ObjectId;
use crate::filter::STATIC_GROUP;
use crate::model::validate;
use crate::{Body, BodyKind, MassProperties, ModelError, Pose, Shape};
use glam::{DMat3, DVec3};

/// A body of an object; of every replica of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct BodyHandle {
    pub(super) object: ObjectId,
    pub(super) index: usize,
}

impl BodyHandle {
    /// The object it is of.
    pub fn object(&self) -> ObjectId {
        self.object
    }
}

/// A body in the making. Dynamic, at the object's origin, its mass from its shapes' densities,
/// unless said otherwise.
#[derive(Clone, Debug)]
pub struct BodyDraft {
    pub(super) body: Body,
    pub(super) shapes: Vec<Shape>,
    handle: BodyHandle,
    mass: MassSource,
    /// Membership and what it collides with, for all shapes.
    masks: Option<(u32, u32)>,
}

/// Where a body's mass, centre and inertia come from.
#[derive(Clone, Copy, Debug)]
enum MassSource {
    /// Shapes and their densities.
    Densities,
    /// This mass, spread as the shapes and their densities would.
    Total(f64),
    /// All three as given.
    Given,
}

impl BodyDraft {
    pub(super) fn new(name: String, handle: BodyHandle) -> Self {
        Self {
            body: Body::new(name),
            shapes: Vec::new(),
            handle,
            mass: MassSource::Densities,
            masks: None,
        }
    }
    /// Its name.
    pub fn name(&self) -> &str {
        &self.body.name
    }
    /// What joints and queries call the body by.
    pub fn handle(&self) -> BodyHandle {
        self.handle
    }
    /// Where it is in the object.
    pub fn pose(&self) -> Pose {
        self.body.pose
    }
    /// Whether it never moves.
    pub fn is_static(&self) -> bool {
        self.body.kind == BodyKind::Static
    }
    /// Membership and what it collides with, if given for all its shapes.
    pub fn masks(&self) -> Option<(u32, u32)> {
        self.masks
    }
    /// Places the body in the object's frame. A joint's coordinates may move it from there.
    pub fn at(&mut self, pose: Pose) -> &mut Self {
        self.body.pose = pose;
        self
    }
    /// Makes the body static and puts it in group −1.
    pub fn immovable(&mut self) -> &mut Self {
        self.body.kind = BodyKind::Static;
        self.body.group = STATIC_GROUP;
        self
    }
    /// Adds a shape, or a geometry with the default density and material.
    pub fn shape(&mut self, shape: impl Into<Shape>) -> &mut Self {
        self.shapes.push(shape.into());
        self
    }
    /// Sets the mass [kg]; centre and inertia follow from the shapes, whose densities then only
    /// matter in relation to each other.
    pub fn mass(&mut self, mass: f64) -> &mut Self {
        self.mass = MassSource::Total(mass);
        self
    }
    /// Sets the mass [kg], the centre of mass [m] in the body's frame, and the inertia [kg·m²]
    /// about that centre along the body's axes.
    pub fn inertia(&mut self, mass: f64, center: DVec3, inertia: DMat3) -> &mut Self {
        (self.body.mass, self.body.center, self.body.inertia) = (mass, center, inertia);
        self.mass = MassSource::Given;
        self
    }
    /// Sets the collision group; see [`CollisionFilter`](crate::CollisionFilter).
    pub fn group(&mut self, group: i32) -> &mut Self {
        self.body.group = group;
        self
    }
    /// Sets the kinds, a bit each, that all its shapes are of, and those that they collide with,
    /// whatever the shapes say, and whenever they are added.
    pub fn collision_masks(&mut self, membership: u32, collides_with: u32) -> &mut Self {
        self.masks = Some((membership, collides_with));
        self
    }
    /// Sets [`Body::world`](crate::Body::world), which parts what shall not touch; −1 touches all.
    pub fn world(&mut self, world: i32) -> &mut Self {
        self.body.world = world;
        self
    }

    /// Its shapes with its masks.
    pub(super) fn finished_shapes(&self) -> impl Iterator<Item = Shape> {
        self.shapes.iter().cloned().map(|shape| match self.masks {
            Some((membership, collides_with)) => shape.with_masks(membership, collides_with),
            None => shape,
        })
    }

    /// The body with its mass worked out.
    pub(super) fn finished(&self) -> Result<Body, ModelError> {
        let mut body = self.body.clone();
        if body.kind == BodyKind::Static {
            return Ok(body);
        }
        let solid = MassProperties::of_shapes(&self.shapes);
        // Sizes that make no sense hold no volume either, and are what is to be told.
        let unknown = |missing| {
            let wrong = self.shapes.iter().find_map(|s| validate::solid(s).err());
            wrong.unwrap_or_else(|| ModelError::MassUnknown {
                body: body.name.clone(),
                missing,
            })
        };
        let whole = match self.mass {
            MassSource::Given => return Ok(body),
            MassSource::Densities => solid.ok_or_else(|| unknown("has no mass"))?,
            MassSource::Total(mass) => solid
                .ok_or_else(|| unknown("nothing tells its inertia"))?
                .with_mass(mass),
        };
        (body.mass, body.center, body.inertia) = (whole.mass, whole.center, whole.inertia);
        Ok(body)
    }
}
