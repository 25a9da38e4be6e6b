//! Makes models by hand: a tree of World → Object → Body and Joint, compiled to flat tables.

mod actuator;
mod body;
mod compile;
mod contact_pair;
mod joint;
mod object;
mod placement;

pub use actuator::ActuatorDraft;
pub use body::{BodyDraft, BodyHandle};
pub use contact_pair::{ContactPairDraft, ShapeHandle};
pub use joint::{JointDraft, JointHandle};
pub use object::{Object, ObjectId};
pub use placement::Placement;

use crate::{BodyId, JointId, Keyframe, Model, ModelError, Parts, Shape, ShapeId, UpAxis};
use compile::{Layout, find};
use glam::DVec3;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Builders made so far: their handles tell them apart.
static BUILDERS: AtomicUsize = AtomicUsize::new(0);

/// Makes a [`Model`] by hand.
///
/// A world consists of objects; an object of bodies, joints and actuators that belong together. An
/// object can be replicated within the world, and each replica be placed by itself. Handles stay
/// valid throughout, in clones made later, too; [`body_replica`](Self::body_replica),
/// [`joint_replica`](Self::joint_replica) and [`shape_replica`](Self::shape_replica) tell the rows
/// that they become.
///
/// ```
/// use glam::DVec3;
/// use kinetarium_model::{Builder, Geometry, Pose};
///
/// let mut world = Builder::new("pendula");
/// let arm = world.object("arm");
/// let rod = Geometry::Capsule { radius: 0.02, half_height: 0.5 };
/// let link = arm.body("link").at(Pose::at(DVec3::new(0.0, -0.5, 0.0))).shape(rod).mass(1.0).handle();
/// let hinge = arm.revolute("hinge", link, DVec3::Z).initial(&[0.3]).handle();
/// arm.motor("motor", hinge).control_range(-2.0, 2.0);
/// arm.replicate(3);
/// arm.replica(2)?.translate_by(DVec3::new(0.0, 0.0, 1.0));
///
/// let model = world.build()?;
/// assert_eq!(model.bodies[world.body_replica(link, 2)?.0].name, "link_2");
/// # Ok::<(), kinetarium_model::ModelError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Builder {
    /// As handles have it; that of the builder that it is a clone of.
    number: usize,
    /// Everything but bodies, shapes, joints, couplings and actuators, which the objects hold, and
    /// contact pairs.
    settings: Parts,
    objects: Vec<Object>,
    contact_pairs: Vec<ContactPairDraft>,
}

impl Builder {
    /// An empty world, as [`Parts::default`].
    pub fn new(name: impl Into<String>) -> Self {
        let settings = Parts {
            name: name.into(),
            ..Parts::default()
        };
        Self {
            number: BUILDERS.fetch_add(1, Ordering::Relaxed),
            settings,
            objects: Vec::new(),
            contact_pairs: Vec::new(),
        }
    }
    /// Sets the direction that is up, and turns gravity to point down.
    pub fn up_axis(&mut self, up: UpAxis) -> &mut Self {
        self.settings.up_axis = up;
        self.settings.gravity = -self.settings.gravity.length() * up.direction();
        self
    }
    /// Sets gravity [m/s²].
    pub fn gravity(&mut self, gravity: DVec3) -> &mut Self {
        self.settings.gravity = gravity;
        self
    }
    /// Sets the recommended time step [s].
    pub fn time_step(&mut self, seconds: f64) -> &mut Self {
        self.settings.time_step = seconds;
        self
    }
    /// Asks for this many worlds, each with all objects.
    pub fn replicate(&mut self, worlds: usize) -> &mut Self {
        self.settings.worlds = worlds;
        self
    }
    /// Adds a named state of the finished model.
    pub fn keyframe(&mut self, keyframe: Keyframe) -> &mut Self {
        self.settings.keyframes.push(keyframe);
        self
    }

    /// Has two shapes touch in any case, whatever masks, groups, joints and exclusions say, with a
    /// surface of their own; see [`ContactPair`](crate::ContactPair).
    ///
    /// Each replica of the one is paired with its own replica of the other; one of another object may
    /// also stand there only once.
    ///
    /// ```
    /// use glam::DVec3;
    /// use kinetarium_model::{Builder, Geometry, ShapeId};
    ///
    /// let mut world = Builder::new("curling");
    /// let rink = world.object("rink");
    /// rink.scenery(Geometry::Plane { half_x: 0.0, half_z: 0.0 });
    /// let ice = rink.id().scenery(0);
    /// let stone = Geometry::Cylinder { radius: 0.145, half_height: 0.06 };
    /// let stone = world.object("stones").body("stone").shape(stone).mass(19.0).handle();
    /// world.contact_pair(stone.shape(0), ice)?.friction(0.01);
    ///
    /// let model = world.build()?;
    /// assert_eq!(model.contact_material(ShapeId(0), ShapeId(1)).friction, 0.01);
    /// # Ok::<(), kinetarium_model::ModelError>(())
    /// ```
    ///
    /// # Errors
    /// If a handle is not of this builder, both are the same, or the two are a pair already.
    pub fn contact_pair(
        &mut self,
        a: ShapeHandle,
        b: ShapeHandle,
    ) -> Result<&mut ContactPairDraft, ModelError> {
        let number = self.contact_pairs.len();
        let what = format!("contact pair \"{number}\"");
        let material = self
            .shape(&what, a)?
            .material
            .with(&self.shape(&what, b)?.material);
        if a == b {
            let (kind, index) = ("shapes", a.index);
            return Err(ModelError::SameTwice { what, kind, index });
        }
        if let Some(first) = self.contact_pairs.iter().position(|pair| pair.is_of(a, b)) {
            let second = number;
            return Err(ModelError::PairTwice { first, second });
        }
        self.contact_pairs
            .push(ContactPairDraft::new([a, b], material));
        Ok(&mut self.contact_pairs[number])
    }
    /// The pairs of shapes with surfaces of their own, in the order of making.
    pub fn contact_pairs(&self) -> &[ContactPairDraft] {
        &self.contact_pairs
    }
    fn shape(&self, what: &str, handle: ShapeHandle) -> Result<&Shape, ModelError> {
        let shapes = find(&self.objects, handle.object).and_then(|object| match handle.body {
            Some(body) => Some(&object.bodies.get(body)?.shapes),
            None => Some(&object.scenery),
        });
        let shape = shapes.and_then(|shapes| shapes.get(handle.index));
        shape.ok_or_else(|| foreign(what, "shape"))
    }

    /// What was set so far; its tables of bodies, shapes, joints, couplings, actuators and contact
    /// pairs are empty.
    pub fn settings(&self) -> &Parts {
        &self.settings
    }
    /// The objects, in the order of making.
    pub fn objects(&self) -> &[Object] {
        &self.objects
    }

    /// Adds an empty object.
    pub fn object(&mut self, name: impl Into<String>) -> &mut Object {
        let id = ObjectId {
            builder: self.number,
            index: self.objects.len(),
        };
        self.objects.push(Object::new(name.into(), id));
        &mut self.objects[id.index]
    }
    /// An object made before.
    ///
    /// # Errors
    /// If the handle is not of this builder.
    pub fn object_mut(&mut self, id: ObjectId) -> Result<&mut Object, ModelError> {
        find(&self.objects, id).ok_or_else(|| foreign("world", "object"))?;
        Ok(&mut self.objects[id.index])
    }
    /// A body made before.
    ///
    /// # Errors
    /// If the handle is not of this builder.
    pub fn body_mut(&mut self, handle: BodyHandle) -> Result<&mut BodyDraft, ModelError> {
        let object = self.object_mut(handle.object)?;
        object
            .bodies
            .get_mut(handle.index)
            .ok_or_else(|| foreign("world", "body"))
    }
    /// A joint made before.
    ///
    /// # Errors
    /// If the handle is not of this builder.
    pub fn joint_mut(&mut self, handle: JointHandle) -> Result<&mut JointDraft, ModelError> {
        let object = self.object_mut(handle.object)?;
        object
            .joints
            .get_mut(handle.index)
            .ok_or_else(|| foreign("world", "joint"))
    }

    /// Row of a body's k-th replica in the model that [`build`](Self::build) makes.
    ///
    /// # Errors
    /// If the handle is not of this builder, or the object has no k-th replica.
    pub fn body_replica(&self, body: BodyHandle, k: usize) -> Result<BodyId, ModelError> {
        Layout::of(&self.objects).body("world", body, k)
    }
    /// Row of a joint's k-th replica in the model that [`build`](Self::build) makes.
    ///
    /// # Errors
    /// If the handle is not of this builder, or the object has no k-th replica.
    pub fn joint_replica(&self, joint: JointHandle, k: usize) -> Result<JointId, ModelError> {
        Layout::of(&self.objects).joint("world", joint, k)
    }

    /// Row of a shape's k-th replica in the model that [`build`](Self::build) makes.
    ///
    /// # Errors
    /// If the handle is not of this builder, or the object has no k-th replica.
    pub fn shape_replica(&self, shape: ShapeHandle, k: usize) -> Result<ShapeId, ModelError> {
        Layout::of(&self.objects).shape("world", shape, k)
    }

    /// Compiles the world to flat tables, and checks them. The builder can go on being used.
    ///
    /// Rows come object by object, replica by replica, in the order of making. Where an object
    /// has several replicas, the names in the k-th end in `_k`, from 0.
    ///
    /// # Errors
    /// The first fault found, with its remedy.
    pub fn build(&self) -> Result<Model, ModelError> {
        let mut parts = self.settings.clone();
        compile::compile(&self.objects, &self.contact_pairs, &mut parts)?;
        Model::new(parts)
    }
}

fn foreign(what: &str, role: &'static str) -> ModelError {
    ModelError::ForeignHandle {
        what: what.into(),
        role,
    }
}
