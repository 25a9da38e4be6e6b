//! A joint in the making.

use super::{BodyHandle, ObjectId};
use crate::{Axis, BodyId, Dof, Drive, Joint, JointKind, Limit, Pose};

/// A joint of an object; of every replica of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct JointHandle {
    pub(super) object: ObjectId,
    pub(super) index: usize,
}

impl JointHandle {
    /// The object it is of.
    pub fn object(&self) -> ObjectId {
        self.object
    }
}

/// A joint in the making: from the world, at the object's origin, free to move along its axes,
/// unless said otherwise.
///
/// What is set for degrees of freedom holds for all that the joint has;
/// [`dofs_mut`](Self::dofs_mut) reaches them one by one.
#[derive(Clone, Debug)]
pub struct JointDraft {
    /// Its bodies are not yet known by row; the child's is a placeholder.
    pub(super) joint: Joint,
    pub(super) parent: Option<BodyHandle>,
    pub(super) child: BodyHandle,
    pub(super) frames: Frames,
    handle: JointHandle,
}

/// Where the joint's frames are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Frames {
    /// At this pose of the object's frame, when both bodies stand where they were placed.
    InObject(Pose),
    /// In the parent's and child's frames, as the joint says.
    InBodies,
}

impl JointDraft {
    pub(super) fn new(
        name: String,
        kind: JointKind,
        child: BodyHandle,
        axes: Vec<Axis>,
        handle: JointHandle,
    ) -> Self {
        let joint = Joint::new(name, kind, None, BodyId(0), axes);
        Self {
            joint,
            parent: None,
            child,
            frames: Frames::InObject(Pose::IDENTITY),
            handle,
        }
    }
    /// Its name.
    pub fn name(&self) -> &str {
        &self.joint.name
    }
    /// What actuators and queries call the joint by.
    pub fn handle(&self) -> JointHandle {
        self.handle
    }
    /// Where it is in the object; the origin where its frames are given in both bodies.
    pub fn pose(&self) -> Pose {
        match self.frames {
            Frames::InObject(pose) => pose,
            Frames::InBodies => Pose::IDENTITY,
        }
    }
    /// Its frames in the parent and in the child, as far as they are given.
    pub fn body_frames(&self) -> [Pose; 2] {
        [self.joint.parent_frame, self.joint.child_frame]
    }
    /// The degrees of freedom, one per axis; three for a ball, six for a free joint.
    pub fn dofs(&self) -> &[Dof] {
        &self.joint.dofs
    }
    /// How far the locked directions [m/N] and rotations [rad/(N·m)] give.
    pub fn compliances(&self) -> [f64; 2] {
        [self.joint.linear_compliance, self.joint.angular_compliance]
    }
    /// Sets the parent body, which may be of another object.
    pub fn parent(&mut self, body: BodyHandle) -> &mut Self {
        self.parent = Some(body);
        self
    }
    /// Puts the joint at a pose of the object's frame. There its two frames coincide as the
    /// bodies were placed.
    pub fn at(&mut self, pose: Pose) -> &mut Self {
        self.frames = Frames::InObject(pose);
        self
    }
    /// Gives the joint's frame in the parent's body frame (in the object's, where the parent is
    /// the world) and in the child's. Where the bodies were placed then does not matter.
    pub fn frames(&mut self, in_parent: Pose, in_child: Pose) -> &mut Self {
        (self.joint.parent_frame, self.joint.child_frame) = (in_parent, in_child);
        self.frames = Frames::InBodies;
        self
    }
    /// Sets the initial coordinates.
    pub fn initial(&mut self, coordinates: &[f64]) -> &mut Self {
        self.joint.initial = coordinates.to_vec();
        self
    }
    /// Limits the range.
    pub fn limit(&mut self, limit: Limit) -> &mut Self {
        self.each_dof(|dof| dof.limit = Some(limit))
    }
    /// Adds a drive.
    pub fn drive(&mut self, drive: Drive) -> &mut Self {
        self.each_dof(|dof| dof.drive = drive)
    }
    /// Sets the viscous damping [N·s/m or N·m·s/rad].
    pub fn damping(&mut self, damping: f64) -> &mut Self {
        self.each_dof(|dof| dof.damping = damping)
    }
    /// Adds a spring [N/m or N·m/rad] that is slack at `rest` [m or rad].
    pub fn spring(&mut self, stiffness: f64, rest: f64) -> &mut Self {
        self.each_dof(|dof| (dof.stiffness, dof.rest) = (stiffness, rest))
    }
    /// Sets the motor's reflected inertia [kg or kg·m²].
    pub fn armature(&mut self, armature: f64) -> &mut Self {
        self.each_dof(|dof| dof.armature = armature)
    }
    /// Sets the dry friction [N or N·m].
    pub fn friction_loss(&mut self, friction_loss: f64) -> &mut Self {
        self.each_dof(|dof| dof.friction_loss = friction_loss)
    }
    /// The degrees of freedom, to be changed.
    pub fn dofs_mut(&mut self) -> &mut [Dof] {
        &mut self.joint.dofs
    }
    /// Gives way in the locked directions [m/N] and rotations [rad/(N·m)].
    pub fn compliance(&mut self, linear: f64, angular: f64) -> &mut Self {
        (self.joint.linear_compliance, self.joint.angular_compliance) = (linear, angular);
        self
    }
    /// Sets whether the joint closes a loop.
    pub fn closes_loop(&mut self, closes_loop: bool) -> &mut Self {
        self.joint.closes_loop = closes_loop;
        self
    }
    /// Sets whether parent and child may touch.
    pub fn bodies_collide(&mut self, bodies_collide: bool) -> &mut Self {
        self.joint.bodies_collide = bodies_collide;
        self
    }
    /// Sets whether the joint is switched on at the start.
    pub fn enabled(&mut self, enabled: bool) -> &mut Self {
        self.joint.enabled = enabled;
        self
    }

    fn each_dof(&mut self, change: impl Fn(&mut Dof)) -> &mut Self {
        self.joint.dofs.iter_mut().for_each(change);
        self
    }
}
