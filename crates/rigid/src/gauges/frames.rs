//! Frames on bodies and in the world: where they are, how they move, and what acts there.
//!
//! A frame at r from the origin o of a body that moves with v and turns with ω has
//!
//! ```text
//! position        o + r
//! velocity        v + ω × r
//! acceleration    a + α × r + ω × (ω × r)
//! ```
//!
//! o and r are kept apart, so that differences of frames far from the world's origin are as exact as those of the bodies.

use super::rows::{Notes, Rows};
use super::{Told, reported};
use crate::output::{OutputTables, body, body_acceleration, reaction};
use crate::tables::Filler;
use glam::DVec3;
use model::{Axes, BodyId, JointId, Model, Mount, Pose};
use numbers::machine::Index;
use numbers::machine::space::{Input, Parameter, Scratch};
use numbers::{Machine, Quat, Table, Vec3};

/// Fields of [`Frames::placed`].
mod placed_field {
    /// Origin of what carries the frame; of one in the world the frame's own.
    pub const ORIGIN: usize = 0;
    /// From there to the frame, world axes.
    pub const ARM: usize = 3;
    pub const ORIENTATION: usize = 6;
    pub const WIDTH: usize = 10;
}

/// Frames, and what is told of them.
#[derive(Default)]
pub(super) struct FrameNotes {
    /// Carrier; the frame on it. See [`Frames`] for these and the others.
    frames: Notes<1, 7>,
    poses: Notes<3, 0>,
    velocities: Notes<4, 0>,
    imus: Notes<3, 0>,
    still: Notes<2, 0>,
    wrenches: Notes<4, 3>,
    /// The frame of the world itself, if any is told in it.
    world: Option<usize>,
}

/// Where they lie. FRAME and AXES are rows of `frames`, TO is the first number told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frames {
    bodies: Table<Input, { body::WIDTH }>,
    accelerations: Table<Input, { body_acceleration::WIDTH }>,
    reactions: Table<Input, { reaction::WIDTH }>,
    /// How many bodies there are.
    count: usize,
    /// CARRIER, a body or how many there are; the frame on it.
    frames: Rows<1, 7>,
    /// Where they are now.
    placed: Table<Scratch, { placed_field::WIDTH }>,
    /// FRAME, RELATIVE, TO.
    poses: Rows<3, 0>,
    /// FRAME, AXES, BODY, TO.
    velocities: Rows<4, 0>,
    /// FRAME, BODY, TO.
    imus: Rows<3, 0>,
    /// Of those in the world: FRAME, TO.
    still: Rows<2, 0>,
    /// Where there is any of these.
    gravity: Option<Table<Parameter, 3>>,
    /// FRAME, JOINT, CHILD, TO; from the frame to the child's joint frame, in the child's axes.
    wrenches: Rows<4, 3>,
}

impl FrameNotes {
    /// A frame; returns its row.
    pub fn frame(&mut self, model: &Model, mount: &Mount) -> usize {
        let carrier = mount.body.map_or(model.bodies.len(), |body| body.0);
        let Pose {
            position: p,
            orientation: q,
        } = mount.pose;
        self.frames
            .add([carrier], [p.x, p.y, p.z, q.x, q.y, q.z, q.w])
    }
    /// The axes of a frame, or of the world.
    pub fn axes(
        &mut self,
        model: &Model,
        axes: Axes,
        own: impl FnOnce(&mut Self) -> usize,
    ) -> usize {
        match axes {
            Axes::Own => own(self),
            Axes::World => self.world.unwrap_or_else(|| {
                let world = self.frame(model, &Mount::default());
                self.world = Some(world);
                world
            }),
        }
    }
    pub fn pose(&mut self, model: &Model, [frame, relative]: [&Mount; 2], to: usize) {
        let [frame, relative] = [frame, relative].map(|mount| self.frame(model, mount));
        self.poses.add([frame, relative, to], []);
    }
    /// What stands in the world does not move.
    pub fn velocity(&mut self, model: &Model, (mount, axes): (&Mount, Axes), to: usize) {
        if let Some(BodyId(body)) = mount.body {
            let frame = self.frame(model, mount);
            let axes = self.axes(model, axes, |_| frame);
            self.velocities.add([frame, axes, body, to], []);
        }
    }
    pub fn imu(&mut self, model: &Model, mount: &Mount, to: usize) {
        let frame = self.frame(model, mount);
        match mount.body {
            Some(BodyId(body)) => self.imus.add([frame, body, to], []),
            None => self.still.add([frame, to], []),
        };
    }
    pub fn wrench(&mut self, model: &Model, (id, frame): (JointId, Option<Pose>), to: usize) {
        let joint = &model.joints[id.0];
        let inner = joint.child_frame;
        let at = frame.unwrap_or(inner);
        let frame = self.frame(model, &Mount::on(joint.child).at(at));
        let arm: DVec3 = inner.position - at.position;
        let links = [frame, id.0, joint.child.0, to];
        self.wrenches.add(links, arm.to_array());
    }

    /// How often loops go round.
    pub fn rounds(&self) -> usize {
        let moving = self.poses.len() + self.velocities.len() + self.imus.len() + self.still.len();
        self.frames.len() + moving + self.wrenches.len()
    }
    pub fn place(
        &self,
        (model, outputs): (&Model, &OutputTables),
        [parameters, links, scratch]: [&mut usize; 3],
    ) -> Frames {
        let felt = self.imus.len() + self.still.len() > 0;
        Frames {
            bodies: reported(outputs.body),
            accelerations: reported(outputs.body_acceleration),
            reactions: reported(outputs.reaction),
            count: model.bodies.len(),
            frames: self.frames.place(parameters, links),
            placed: Table::place(scratch, self.frames.len()),
            poses: self.poses.place(parameters, links),
            velocities: self.velocities.place(parameters, links),
            imus: self.imus.place(parameters, links),
            still: self.still.place(parameters, links),
            gravity: felt.then(|| Table::place(parameters, 1)),
            wrenches: self.wrenches.place(parameters, links),
        }
    }
}

/// A frame now.
struct Placed<M: Machine> {
    origin: Vec3<M::R>,
    arm: Vec3<M::R>,
    orientation: Quat<M::R>,
}

impl Frames {
    pub fn fill(&self, notes: &FrameNotes, model: &Model, f: &mut Filler) {
        self.frames.fill(&notes.frames, f);
        self.poses.fill(&notes.poses, f);
        self.velocities.fill(&notes.velocities, f);
        self.imus.fill(&notes.imus, f);
        self.still.fill(&notes.still, f);
        self.wrenches.fill(&notes.wrenches, f);
        if let Some(gravity) = self.gravity {
            f.vec3(gravity, 0, 0, model.gravity);
        }
    }

    #[inline(always)]
    fn placed<M: Machine>(&self, k: &M, frame: M::I) -> Placed<M> {
        Placed {
            origin: k.vec3(self.placed, frame, placed_field::ORIGIN),
            arm: k.vec3(self.placed, frame, placed_field::ARM),
            orientation: k.quat(self.placed, frame, placed_field::ORIENTATION),
        }
    }
    /// How a frame is turned.
    #[inline(always)]
    pub fn orientation<M: Machine>(&self, k: &M, frame: M::I) -> Quat<M::R> {
        k.quat(self.placed, frame, placed_field::ORIENTATION)
    }
    /// A body's orientation, scaled to unit length.
    #[inline(always)]
    pub fn turn<M: Machine>(&self, k: &M, body: M::I) -> Quat<M::R> {
        k.quat(self.bodies, body, body::ORIENTATION).normalized()
    }
    /// Where a point of a body is, given in its frame.
    #[inline(always)]
    pub fn point<M: Machine>(&self, k: &M, body: M::I, at: Vec3<M::R>) -> Vec3<M::R> {
        k.vec3(self.bodies, body, body::POSITION) + self.turn(k, body).rotate(at)
    }

    /// Places all frames.
    #[inline(always)]
    pub fn place<M: Machine>(&self, k: &mut M) {
        for frame in self.frames.all(k) {
            let [carrier] = self.frames.links(k, frame);
            let own = k.pose(self.frames.numbers, frame, 0);
            if let Some(_branch) = k.when(k.equals(carrier, self.count)) {
                let none = Vec3::zero();
                k.store_vec3(self.placed, frame, placed_field::ORIGIN, own.p);
                k.store_vec3(self.placed, frame, placed_field::ARM, none);
                k.store_quat(self.placed, frame, placed_field::ORIENTATION, own.q);
            }
            if let Some(_branch) = k.when(k.less(carrier, k.index(self.count))) {
                let origin = k.vec3(self.bodies, carrier, body::POSITION);
                let turn = self.turn(k, carrier);
                let (arm, q) = (turn.rotate(own.p), turn * own.q);
                k.store_vec3(self.placed, frame, placed_field::ORIGIN, origin);
                k.store_vec3(self.placed, frame, placed_field::ARM, arm);
                k.store_quat(self.placed, frame, placed_field::ORIENTATION, q);
            }
        }
    }

    /// Tells all that is told of them.
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, told: Told) {
        self.tell_poses(k, told);
        self.tell_velocities(k, told);
        self.tell_imus(k, told);
        self.tell_wrenches(k, told);
    }
    #[inline(always)]
    fn tell_poses<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.poses.all(k) {
            let [frame, relative, to] = self.poses.links(k, row);
            let (frame, from) = (self.placed(k, frame), self.placed(k, relative));
            let way = (frame.origin - from.origin) + (frame.arm - from.arm);
            k.store_vec3(told, to, 0, from.orientation.rotate_inverse(way));
            let turn = from.orientation.conjugate() * frame.orientation;
            k.store_quat(told, to.offset(3), 0, turn);
        }
    }
    #[inline(always)]
    fn tell_velocities<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.velocities.all(k) {
            let [frame, axes, body, to] = self.velocities.links(k, row);
            let (arm, axes) = (self.placed(k, frame).arm, self.orientation(k, axes));
            let linear = k.vec3(self.bodies, body, body::VELOCITY);
            let angular = k.vec3(self.bodies, body, body::ANGULAR_VELOCITY);
            k.store_vec3(
                told,
                to,
                0,
                axes.rotate_inverse(linear + angular.cross(arm)),
            );
            k.store_vec3(told, to.offset(3), 0, axes.rotate_inverse(angular));
        }
    }
    /// An accelerometer reads a − g.
    #[inline(always)]
    fn tell_imus<M: Machine>(&self, k: &mut M, told: Told) {
        let Some(gravity) = self.gravity else {
            return;
        };
        let gravity = k.vec3(gravity, k.index(0), 0);
        for row in self.imus.all(k) {
            let [frame, body, to] = self.imus.links(k, row);
            let Placed {
                arm, orientation, ..
            } = self.placed(k, frame);
            let angular = k.vec3(self.bodies, body, body::ANGULAR_VELOCITY);
            let linear = k.vec3(self.accelerations, body, body_acceleration::LINEAR);
            let turning = k.vec3(self.accelerations, body, body_acceleration::ANGULAR);
            let inwards = angular.cross(angular.cross(arm));
            let proper = linear + turning.cross(arm) + inwards - gravity;
            k.store_vec3(told, to, 0, orientation.rotate_inverse(proper));
            k.store_vec3(told, to.offset(3), 0, orientation.rotate_inverse(angular));
        }
        for row in self.still.all(k) {
            let [frame, to] = self.still.links(k, row);
            let proper = self.orientation(k, frame).rotate_inverse(-gravity);
            k.store_vec3(told, to, 0, proper);
        }
    }
    /// A force f that acts at x has the torque τ + (x − y) × f about y, if τ is that about x.
    #[inline(always)]
    fn tell_wrenches<M: Machine>(&self, k: &mut M, told: Told) {
        for row in self.wrenches.all(k) {
            let [frame, joint, child, to] = self.wrenches.links(k, row);
            let orientation = self.orientation(k, frame);
            let arm = self
                .turn(k, child)
                .rotate(k.vec3(self.wrenches.numbers, row, 0));
            let force = k.vec3(self.reactions, joint, reaction::FORCE);
            let torque = k.vec3(self.reactions, joint, reaction::TORQUE) + arm.cross(force);
            k.store_vec3(told, to, 0, orientation.rotate_inverse(force));
            k.store_vec3(told, to.offset(3), 0, orientation.rotate_inverse(torque));
        }
    }
}
