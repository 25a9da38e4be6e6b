//! Joints, their axes, and what acts along each degree of freedom.
//!
//! A joint places the child's joint frame in the parent's:
//!
//! ```text
//! X_child · child_frame = X_parent · parent_frame · T(q)
//! ```
//!
//! T(q) is the identity (`fixed`), one motion along or about an axis
//! (`prismatic`, `revolute`), several in turn (`plane_xz`, `d6`), any rotation
//! (`ball`), or anything (`free`).

use crate::{BodyId, Pose};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

/// Row of a joint in [`Parts::joints`](crate::Parts::joints).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct JointId(pub usize);

/// The kinds of joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum JointKind {
    /// No relative motion.
    Fixed,
    /// Rotation about one axis.
    Revolute,
    /// Translation along one axis.
    Prismatic,
    /// Any rotation. Coordinates: a quaternion x, y, z, w; velocity: angular
    /// velocity of the child relative to the parent [rad/s], in the child's joint frame.
    Ball,
    /// Any motion. Coordinates: position [m] of the child's joint frame in the
    /// parent's, then a quaternion x, y, z, w. Velocity: linear velocity of that
    /// frame's origin [m/s] in the parent's joint axes, then angular velocity
    /// [rad/s] in the child's joint axes.
    Free,
    /// The two frame origins stay `length` apart. No coordinates.
    Distance,
    /// Up to three linear and three angular axes, in turn.
    D6,
    /// Translation along x and z of the joint frame and rotation about its y.
    PlaneXz,
}

impl JointKind {
    /// The field's name for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Prismatic => "prismatic",
            Self::Ball => "ball",
            Self::Free => "free",
            Self::Distance => "distance",
            Self::D6 => "d6",
            Self::PlaneXz => "plane_xz",
        }
    }
}

/// What an axis does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum AxisKind {
    /// Translates; coordinate in metres.
    Linear,
    /// Rotates; coordinate in radians.
    Angular,
}

/// One axis of a `revolute`, `prismatic`, `d6` or `plane_xz` joint.
///
/// Axes act in turn: each is fixed in the frame that the ones before it have moved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Along, or about.
    pub kind: AxisKind,
    /// Unit direction in the joint's frame.
    pub direction: DVec3,
    /// A point [m] on the axis, in the joint's frame. Zero, except in stacks of
    /// hinges whose axes do not meet; those only `featherstone` takes.
    pub anchor: DVec3,
    /// Coordinate at which the two joint frames coincide.
    pub reference: f64,
}

impl Axis {
    /// Rotation about a direction through the joint frame's origin.
    pub fn angular(direction: DVec3) -> Self {
        Self {
            kind: AxisKind::Angular,
            direction,
            anchor: DVec3::ZERO,
            reference: 0.0,
        }
    }
    /// Translation along a direction.
    pub fn linear(direction: DVec3) -> Self {
        Self {
            kind: AxisKind::Linear,
            ..Self::angular(direction)
        }
    }

    /// What the axis does at coordinate `q`: a shift, or a turn about the anchor a, which takes
    /// a point p to a + R (p − a).
    pub fn motion(&self, q: f64) -> Pose {
        let moved = q - self.reference;
        match self.kind {
            AxisKind::Linear => Pose::at(moved * self.direction),
            AxisKind::Angular => {
                let r = DQuat::from_axis_angle(self.direction.normalize(), moved);
                Pose::new(self.anchor - r * self.anchor, r)
            }
        }
    }
}

/// A soft stop at each end of a coordinate's range.
///
/// Beyond an end the force is −stiffness · excess − damping · velocity − inertia · acceleration, where
/// the first two push back; a limit never pulls.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limit {
    /// Lower end [m or rad].
    pub lower: f64,
    /// Upper end [m or rad].
    pub upper: f64,
    /// Stiffness [N/m or N·m/rad].
    pub stiffness: f64,
    /// Damping [N·s/m or N·m·s/rad].
    pub damping: f64,
    /// Mass or moment of inertia [kg or kg·m²] that is carried along beyond the ends; 0 by default. With
    /// it a stop can be soft to what runs into it, and yet give way little under load.
    pub inertia: f64,
}

/// A motor that pulls a coordinate to targets:
/// stiffness · (target − q) + damping · (target velocity − q̇), within ± effort limit; of a ball that is a limit of the
/// torque, whichever way it points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Stiffness [N/m or N·m/rad]; 0: no position target.
    pub stiffness: f64,
    /// Damping [N·s/m or N·m·s/rad]; 0: no velocity target.
    pub damping: f64,
    /// Initial position target [m or rad]. For a ball joint the three targets
    /// are a rotation vector; a free joint has no drive.
    pub target_position: f64,
    /// Initial velocity target [m/s or rad/s].
    pub target_velocity: f64,
    /// Largest force or torque of the drive [N or N·m]; infinite by default.
    pub effort_limit: f64,
    /// Time constant [s] with which the drive follows a jump of the position
    /// target (first-order lag); 0, the default, follows at once.
    pub control_time: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            stiffness: 0.0,
            damping: 0.0,
            target_position: 0.0,
            target_velocity: 0.0,
            effort_limit: f64::INFINITY,
            control_time: 0.0,
        }
    }
}

/// What acts along one degree of freedom. All zero by default.
#[derive(Clone, Debug, PartialEq, Default, Serialize, Deserialize)]
pub struct Dof {
    /// Unique in the model; the joint's name where it has one degree of freedom.
    pub name: String,
    /// Reflected inertia of the motor [kg or kg·m²].
    pub armature: f64,
    /// Viscous damping [N·s/m or N·m·s/rad].
    pub damping: f64,
    /// Stiffness of a spring [N/m or N·m/rad] that rests at `rest`.
    pub stiffness: f64,
    /// Coordinate at which the spring is slack [m or rad].
    pub rest: f64,
    /// Dry friction [N or N·m].
    pub friction_loss: f64,
    /// Range of the coordinate.
    pub limit: Option<Limit>,
    /// Motor.
    pub drive: Drive,
}

/// A joint between two bodies, or between the world and a body.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Joint {
    /// Unique in the model.
    pub name: String,
    /// Kind.
    pub kind: JointKind,
    /// Parent body; `None` is the world.
    pub parent: Option<BodyId>,
    /// Child body.
    pub child: BodyId,
    /// Joint frame in the parent's body frame (or in the world).
    pub parent_frame: Pose,
    /// Joint frame in the child's body frame.
    pub child_frame: Pose,
    /// Axes of a `revolute`, `prismatic`, `d6` or `plane_xz` joint; empty for the others.
    pub axes: Vec<Axis>,
    /// One for each degree of freedom: one per axis; three for a ball, six for a free joint.
    pub dofs: Vec<Dof>,
    /// Initial coordinates, as many as [`coordinates`](Joint::coordinates).
    pub initial: Vec<f64>,
    /// Length of a `distance` joint [m].
    pub length: f64,
    /// Give of the locked directions [m/N]; `xpbd`, and `featherstone` where the joint closes a loop. 0 is rigid.
    pub linear_compliance: f64,
    /// Give of the locked rotations [rad/(N·m)]; as for the directions. 0 is rigid.
    pub angular_compliance: f64,
    /// False: the joint does not act; `xpbd`, `impulse` as long as it stays so, and `featherstone` where, besides, it
    /// closes a loop.
    pub enabled: bool,
    /// True: the joint closes a loop. It has no coordinates in the state, and nothing acts along its axes.
    pub closes_loop: bool,
    /// True: parent and child may touch. False, the default: they do not, for most joints overlap
    /// what they tie. Two bodies that several joints tie touch if all of these let them.
    pub bodies_collide: bool,
}

impl Joint {
    /// A joint of a kind with its axes, at the origins of both bodies, with passive degrees of freedom.
    ///
    /// Initial coordinates are the axes' references, and no rotation.
    pub fn new(
        name: impl Into<String>,
        kind: JointKind,
        parent: Option<BodyId>,
        child: BodyId,
        axes: Vec<Axis>,
    ) -> Self {
        let name = name.into();
        let n = match kind {
            JointKind::Fixed | JointKind::Distance => 0,
            JointKind::Ball => 3,
            JointKind::Free => 6,
            JointKind::Revolute | JointKind::Prismatic | JointKind::D6 | JointKind::PlaneXz => {
                axes.len()
            }
        };
        let dof_name = |i: usize| {
            if n == 1 {
                name.clone()
            } else {
                format!("{name}_{i}")
            }
        };
        let dofs = (0..n)
            .map(|i| Dof {
                name: dof_name(i),
                ..Dof::default()
            })
            .collect();
        let initial = match kind {
            JointKind::Ball => vec![0.0, 0.0, 0.0, 1.0],
            JointKind::Free => vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            _ => axes.iter().map(|a| a.reference).collect(),
        };
        Self {
            name,
            kind,
            parent,
            child,
            parent_frame: Pose::IDENTITY,
            child_frame: Pose::IDENTITY,
            axes,
            dofs,
            initial,
            length: 0.0,
            linear_compliance: 0.0,
            angular_compliance: 0.0,
            enabled: true,
            closes_loop: false,
            bodies_collide: false,
        }
    }

    /// The axes of a `plane_xz` joint: along x, along z, about y.
    pub fn plane_xz_axes() -> Vec<Axis> {
        vec![
            Axis::linear(DVec3::X),
            Axis::linear(DVec3::Z),
            Axis::angular(DVec3::Y),
        ]
    }

    /// Number of coordinates: one per axis; 4 for a ball, 7 for a free joint; 0 for one that closes a loop.
    pub fn coordinates(&self) -> usize {
        match self.kind {
            _ if self.closes_loop => 0,
            JointKind::Ball => 4,
            JointKind::Free => 7,
            _ => self.axes.len(),
        }
    }
    /// T(q): placement of the child's joint frame in the parent's at coordinates `q`.
    ///
    /// Each axis acts in the frame that the ones before it have moved. Coordinates that are
    /// missing leave their axis at rest.
    pub(crate) fn motion(&self, q: &[f64]) -> Pose {
        match (self.kind, q) {
            (JointKind::Ball, &[x, y, z, w]) => {
                Pose::new(DVec3::ZERO, DQuat::from_xyzw(x, y, z, w).normalize())
            }
            (JointKind::Free, &[px, py, pz, x, y, z, w]) => Pose::new(
                DVec3::new(px, py, pz),
                DQuat::from_xyzw(x, y, z, w).normalize(),
            ),
            _ => self
                .axes
                .iter()
                .zip(q)
                .fold(Pose::IDENTITY, |t, (axis, &q)| t * axis.motion(q)),
        }
    }

    /// Number of degrees of freedom: as many as velocities; 0 for one that closes a loop.
    pub fn degrees_of_freedom(&self) -> usize {
        if self.closes_loop { 0 } else { self.dofs.len() }
    }
}

/// A linear relation of two coordinates, as of gears or of a URDF mimic:
/// q(joint) = offset + ratio · q(other). Taken by `featherstone` and `xpbd`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Coupling {
    /// Unique in the model.
    pub name: String,
    /// Joint that follows; it has one axis.
    pub joint: JointId,
    /// Joint that leads; it has one axis.
    pub other: JointId,
    /// Slope.
    pub ratio: f64,
    /// Value at q(other) = 0.
    pub offset: f64,
}
