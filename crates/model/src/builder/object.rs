//! Bodies, joints and actuators that belong together.

use super::joint::Frames;
use super::{ActuatorDraft, BodyDraft, BodyHandle, JointDraft, JointHandle, Placement};
use crate::model::MOST_ROWS;
use crate::{Actuator, Axis, Coupling, Joint, JointId, JointKind, ModelError, Pose, Shape};
use glam::DVec3;

/// An object of a [`Builder`](super::Builder).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ObjectId {
    /// Number of the builder.
    pub(super) builder: usize,
    pub(super) index: usize,
}

/// Bodies, joints and actuators that belong together, in a frame of their own; and how often, and
/// where, the world has them. Once and at the world's origin, unless said otherwise.
#[derive(Clone, Debug)]
pub struct Object {
    pub(super) name: String,
    id: ObjectId,
    pub(super) bodies: Vec<BodyDraft>,
    /// Shapes fixed to the world.
    pub(super) scenery: Vec<Shape>,
    pub(super) joints: Vec<JointDraft>,
    /// Bodies of its own that do not touch another, or the world.
    pub(super) exclusions: Vec<(BodyHandle, Option<BodyHandle>)>,
    pub(super) couplings: Vec<CouplingDraft>,
    pub(super) actuators: Vec<ActuatorDraft>,
    /// Where each replica stands.
    pub(super) placements: Vec<Pose>,
}

/// A coupling whose joints are not yet known by row; placeholders stand there.
#[derive(Clone, Debug)]
pub(super) struct CouplingDraft {
    pub coupling: Coupling,
    pub joint: JointHandle,
    pub other: JointHandle,
}

impl Object {
    pub(super) fn new(name: String, id: ObjectId) -> Self {
        Self {
            name,
            id,
            bodies: Vec::new(),
            scenery: Vec::new(),
            joints: Vec::new(),
            exclusions: Vec::new(),
            couplings: Vec::new(),
            actuators: Vec::new(),
            placements: vec![Pose::IDENTITY],
        }
    }
    /// What the builder calls the object by.
    pub fn id(&self) -> ObjectId {
        self.id
    }
    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }
    /// The bodies, in the order of making.
    pub fn bodies(&self) -> &[BodyDraft] {
        &self.bodies
    }
    /// The joints, in the order of making.
    pub fn joints(&self) -> &[JointDraft] {
        &self.joints
    }
    /// How many shapes a replica has.
    pub(super) fn shapes(&self) -> usize {
        let shapes = self.bodies.iter().map(|body| body.shapes.len());
        self.scenery.len() + shapes.sum::<usize>()
    }
    /// The shapes that are fixed to the world, in the order of adding.
    pub fn scenery_shapes(&self) -> &[Shape] {
        &self.scenery
    }
    /// How often the world has it.
    pub fn replica_count(&self) -> usize {
        self.placements.len()
    }

    /// Adds a dynamic body.
    pub fn body(&mut self, name: impl Into<String>) -> &mut BodyDraft {
        let handle = BodyHandle {
            object: self.id,
            index: self.bodies.len(),
        };
        self.bodies.push(BodyDraft::new(name.into(), handle));
        &mut self.bodies[handle.index]
    }
    /// Adds a shape that is fixed to the world, where the object stands.
    pub fn scenery(&mut self, shape: impl Into<Shape>) -> &mut Self {
        self.scenery.push(shape.into());
        self
    }

    /// Adds a joint that allows no motion.
    pub fn fixed(&mut self, name: impl Into<String>, child: BodyHandle) -> &mut JointDraft {
        self.joint(name, JointKind::Fixed, child, vec![])
    }
    /// Adds a hinge about a unit vector of the joint's frame.
    pub fn revolute(
        &mut self,
        name: impl Into<String>,
        child: BodyHandle,
        axis: DVec3,
    ) -> &mut JointDraft {
        self.joint(name, JointKind::Revolute, child, vec![Axis::angular(axis)])
    }
    /// Adds a slider along a unit vector of the joint's frame.
    pub fn prismatic(
        &mut self,
        name: impl Into<String>,
        child: BodyHandle,
        axis: DVec3,
    ) -> &mut JointDraft {
        self.joint(name, JointKind::Prismatic, child, vec![Axis::linear(axis)])
    }
    /// Adds a joint that allows any rotation.
    pub fn ball(&mut self, name: impl Into<String>, child: BodyHandle) -> &mut JointDraft {
        self.joint(name, JointKind::Ball, child, vec![])
    }
    /// Adds a joint that allows any motion. Bodies that no joint carries get one by themselves.
    pub fn free(&mut self, name: impl Into<String>, child: BodyHandle) -> &mut JointDraft {
        self.joint(name, JointKind::Free, child, vec![])
    }
    /// Adds a joint that keeps the origins of two bodies at this distance [m]; its
    /// [`frames`](JointDraft::frames) set other points.
    pub fn distance(
        &mut self,
        name: impl Into<String>,
        child: BodyHandle,
        length: f64,
    ) -> &mut JointDraft {
        let draft = self.joint(name, JointKind::Distance, child, vec![]);
        draft.joint.length = length;
        draft.frames = Frames::InBodies;
        draft
    }
    /// Adds a joint with up to three linear and three angular axes.
    pub fn d6(
        &mut self,
        name: impl Into<String>,
        child: BodyHandle,
        axes: &[Axis],
    ) -> &mut JointDraft {
        self.joint(name, JointKind::D6, child, axes.to_vec())
    }
    /// Adds a joint that allows motion in the x–z plane of the joint's frame.
    pub fn plane_xz(&mut self, name: impl Into<String>, child: BodyHandle) -> &mut JointDraft {
        self.joint(name, JointKind::PlaneXz, child, Joint::plane_xz_axes())
    }

    /// Keeps the shapes of a body of this object from touching those of another body, or with
    /// `None` those of the world.
    ///
    /// Each replica keeps from its own replica of the other body; one of another object may also
    /// stand there only once.
    pub fn exclude(&mut self, body: BodyHandle, other: impl Into<Option<BodyHandle>>) -> &mut Self {
        self.exclusions.push((body, other.into()));
        self
    }

    /// Makes q(joint) = offset + ratio · q(other).
    pub fn couple(
        &mut self,
        name: impl Into<String>,
        joint: JointHandle,
        other: JointHandle,
        ratio: f64,
        offset: f64,
    ) -> &mut Self {
        let (name, unknown) = (name.into(), JointId(0));
        let coupling = Coupling {
            name,
            joint: unknown,
            other: unknown,
            ratio,
            offset,
        };
        self.couplings.push(CouplingDraft {
            coupling,
            joint,
            other,
        });
        self
    }

    /// Adds a motor: the control is the force or torque.
    pub fn motor(&mut self, name: impl Into<String>, joint: JointHandle) -> &mut ActuatorDraft {
        self.actuator(Actuator::motor(name, JointId(0)), joint)
    }
    /// Adds a position servo: the control is the position that a spring [N/m or N·m/rad] with a
    /// damper [N·s/m or N·m·s/rad] pulls to.
    pub fn position_servo(
        &mut self,
        name: impl Into<String>,
        joint: JointHandle,
        stiffness: f64,
        damping: f64,
    ) -> &mut ActuatorDraft {
        self.actuator(
            Actuator::position(name, JointId(0), stiffness, damping),
            joint,
        )
    }
    /// Adds a velocity servo: the control is the velocity that a damper [N·s/m or N·m·s/rad]
    /// pulls to.
    pub fn velocity_servo(
        &mut self,
        name: impl Into<String>,
        joint: JointHandle,
        damping: f64,
    ) -> &mut ActuatorDraft {
        self.actuator(Actuator::velocity(name, JointId(0), damping), joint)
    }

    /// Has the world contain `count` replicas; 0 leaves the object out. Those added stand where
    /// the first does, those already there stay. [`build`](super::Builder::build) refuses more
    /// than a million.
    pub fn replicate(&mut self, count: usize) -> &mut Self {
        let first = self.placements.first().copied().unwrap_or_default();
        self.placements.resize(count.min(MOST_ROWS + 1), first);
        self
    }
    /// Moves the k-th replica, counted from 0.
    ///
    /// # Errors
    /// If there are not so many.
    pub fn replica(&mut self, k: usize) -> Result<Placement<'_>, ModelError> {
        let count = self.placements.len();
        match self.placements.get_mut(k) {
            Some(pose) => Ok(Placement {
                poses: std::slice::from_mut(pose),
            }),
            None => {
                let object = self.name.clone();
                Err(ModelError::NoSuchReplica {
                    object,
                    replica: k,
                    count,
                })
            }
        }
    }
    /// Moves all replicas together.
    pub fn replicas(&mut self) -> Placement<'_> {
        Placement {
            poses: &mut self.placements,
        }
    }

    fn joint(
        &mut self,
        name: impl Into<String>,
        kind: JointKind,
        child: BodyHandle,
        axes: Vec<Axis>,
    ) -> &mut JointDraft {
        let handle = JointHandle {
            object: self.id,
            index: self.joints.len(),
        };
        self.joints
            .push(JointDraft::new(name.into(), kind, child, axes, handle));
        &mut self.joints[handle.index]
    }

    fn actuator(&mut self, actuator: Actuator, joint: JointHandle) -> &mut ActuatorDraft {
        self.actuators.push(ActuatorDraft { actuator, joint });
        let last = self.actuators.len() - 1;
        &mut self.actuators[last]
    }
}
