//! What can be wrong with a model.

use crate::{HeightFieldError, HullError, JointKind, MeshError};
use thiserror::Error;

/// Why a model was refused, with the remedy.
///
/// `what` names the culprit, as in `joint "hinge"`.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ModelError {
    /// Points have no convex hull.
    #[error(transparent)]
    Hull(#[from] HullError),
    /// Triangles are no mesh.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// Heights are no height field.
    #[error(transparent)]
    HeightField(#[from] HeightFieldError),
    /// A name is empty.
    #[error("{kind} number {index} has no name; give it one")]
    EmptyName {
        /// Such as "body".
        kind: &'static str,
        /// Its row.
        index: usize,
    },
    /// A name occurs twice.
    #[error("two of kind {kind} are named \"{name}\"; rename one")]
    DuplicateName {
        /// Such as "body".
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// Nothing has this name.
    #[error("there is no {kind} named \"{name}\"; {hint}")]
    UnknownName {
        /// Such as "body".
        kind: &'static str,
        /// The name asked for.
        name: String,
        /// Names that exist.
        hint: String,
    },
    /// A table is too long.
    #[error(
        "the model has {count} {what}, more than the {most} it may have; check the number, or split the model"
    )]
    TooMany {
        /// Such as "bodies".
        what: &'static str,
        /// Number of rows.
        count: usize,
        /// Largest number of rows.
        most: usize,
    },
    /// A number is infinite or not a number.
    #[error("{what}: {quantity} is {value}; give a finite number")]
    NotFinite {
        /// The culprit.
        what: String,
        /// Which of its numbers.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// A number must be zero or above.
    #[error("{what}: {quantity} is {value}; it must not be negative")]
    Negative {
        /// The culprit.
        what: String,
        /// Which of its numbers.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// A number must be above zero.
    #[error("{what}: {quantity} is {value}; it must be above zero")]
    NotPositive {
        /// The culprit.
        what: String,
        /// Which of its numbers.
        quantity: &'static str,
        /// The number.
        value: f64,
    },
    /// A surface that sticks less than it slides.
    #[error(
        "{what}: static friction is {sticking}, less than the friction {sliding} of what slides; \
         give at least that, or none"
    )]
    SticksLess {
        /// The culprit.
        what: String,
        /// Its static friction.
        sticking: f64,
        /// Its friction.
        sliding: f64,
    },
    /// A number lies outside its range.
    #[error("{what}: {quantity} is {value}; it must lie from {lower} to {upper}")]
    OutsideRange {
        /// The culprit.
        what: String,
        /// Which of its numbers.
        quantity: &'static str,
        /// The number.
        value: f64,
        /// Least it may be.
        lower: f64,
        /// Most it may be.
        upper: f64,
    },
    /// A range is upside down.
    #[error(
        "{what}: the lower end of its {quantity}, {lower}, is above the upper end, {upper}; swap them"
    )]
    RangeReversed {
        /// The culprit.
        what: String,
        /// Which range.
        quantity: &'static str,
        /// Lower end.
        lower: f64,
        /// Upper end.
        upper: f64,
    },
    /// A vector or quaternion is not of unit length.
    #[error("{what}: {quantity} has length {length}; normalise it (1 within 1e-6)")]
    NotUnit {
        /// The culprit.
        what: String,
        /// Which vector or quaternion.
        quantity: String,
        /// Its length.
        length: f64,
    },
    /// A vector or quaternion has no direction.
    #[error("{what}: {quantity} has length zero and so no direction; {remedy}")]
    ZeroLength {
        /// The culprit.
        what: String,
        /// Which vector or quaternion.
        quantity: String,
        /// What to do.
        remedy: &'static str,
    },
    /// A list has the wrong number of entries.
    #[error("{what}: its {quantity} has {count} entries; it needs {needed}{why}")]
    WrongLength {
        /// The culprit.
        what: String,
        /// Which list.
        quantity: &'static str,
        /// Entries found.
        count: usize,
        /// Entries needed.
        needed: usize,
        /// The reason, or nothing.
        why: &'static str,
    },
    /// A row number points past the end of a table.
    #[error(
        "{what}: its {role} is number {index}, but the model has {count}, numbered from 0; use a number below {count}"
    )]
    NoSuchRow {
        /// The culprit.
        what: String,
        /// Such as "parent body".
        role: &'static str,
        /// The row asked for.
        index: usize,
        /// Rows there are.
        count: usize,
    },
    /// A sensor is of a joint of another kind than it can measure.
    #[error(
        "sensor \"{sensor}\": joint \"{joint}\" has not what it measures; orientations and angular velocities are of ball joints, forces and torques of all but free ones"
    )]
    SensorJoint {
        /// The sensor.
        sensor: String,
        /// The joint.
        joint: String,
    },
    /// An inertia matrix is not symmetric.
    #[error(
        "body \"{body}\": its inertia matrix is not symmetric (entries differ by {difference}); write equal products of inertia on both sides"
    )]
    InertiaNotSymmetric {
        /// The body.
        body: String,
        /// Largest difference of opposite entries [kg·m²].
        difference: f64,
    },
    /// An inertia matrix is not positive definite.
    #[error(
        "body \"{body}\": its smallest principal moment of inertia is {smallest} kg·m², but all three must be above zero; check the signs and units"
    )]
    InertiaNotPositive {
        /// The body.
        body: String,
        /// Smallest principal moment [kg·m²].
        smallest: f64,
    },
    /// No mass distribution has these principal moments.
    #[error(
        "body \"{body}\": its principal moments of inertia {moments:?} kg·m² belong to no solid: the largest exceeds the sum of the others by more than 1e-6 of itself; correct them (files written with few digits sometimes violate this slightly; setting all three to their mean also helps)"
    )]
    InertiaTriangle {
        /// The body.
        body: String,
        /// Principal moments [kg·m²].
        moments: [f64; 3],
    },
    /// A body of the builder has a mass but nothing to derive its inertia from, or no mass at all.
    #[error(
        "body \"{body}\" is dynamic but {missing}; add a solid shape (a plane, and a mesh that is open or inside out, hold no volume), give mass, centre and inertia, or make it static"
    )]
    MassUnknown {
        /// The body.
        body: String,
        /// What cannot be derived.
        missing: &'static str,
    },
    /// A capsule is too short for its radius.
    #[error(
        "{what}: the capsule's half height {half_height}, caps included, must be at least 1.01 times its radius {radius}; lengthen it or use a sphere"
    )]
    CapsuleTooShort {
        /// The shape.
        what: String,
        /// Half height [m].
        half_height: f64,
        /// Radius [m].
        radius: f64,
    },
    /// A mesh names no file.
    #[error("{what}: the mesh names no file; give its path")]
    MeshWithoutFile {
        /// The shape.
        what: String,
    },
    /// A joint ties a body to itself.
    #[error(
        "joint \"{joint}\": body \"{body}\" is both parent and child; name two different bodies"
    )]
    ParentIsChild {
        /// The joint.
        joint: String,
        /// The body.
        body: String,
    },
    /// A joint would move a static body.
    #[error(
        "joint \"{joint}\": its child \"{body}\" is static; make the body dynamic, or swap parent and child"
    )]
    StaticChild {
        /// The joint.
        joint: String,
        /// The child.
        body: String,
    },
    /// A joint ties bodies of two worlds.
    #[error(
        "joint \"{joint}\": its parent stands in world {parent_world}, its child in world {child_world}; put both in one world, or the parent in world -1, which all share"
    )]
    AcrossWorlds {
        /// The joint.
        joint: String,
        /// The parent's world.
        parent_world: i32,
        /// The child's world.
        child_world: i32,
    },
    /// The axes do not suit the kind of joint.
    #[error("joint \"{joint}\": a {} joint {needs}, but it has {linear} linear and {angular} angular", kind.name())]
    WrongAxes {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: JointKind,
        /// What the kind needs.
        needs: &'static str,
        /// Linear axes found.
        linear: usize,
        /// Angular axes found.
        angular: usize,
    },
    /// The axes of a plane_xz joint are not those of its plane.
    #[error(
        "joint \"{joint}\": the axes of a plane_xz joint are linear x, linear z and angular y, in this order; use Joint::plane_xz_axes and turn the joint frames instead"
    )]
    WrongPlane {
        /// The joint.
        joint: String,
    },
    /// A free joint has a limit or a drive.
    #[error("joint \"{joint}\": a free joint takes no {what}; remove it, or use a d6 joint")]
    FreeJointTakesNo {
        /// The joint.
        joint: String,
        /// "limit" or "drive".
        what: &'static str,
    },
    /// Something acts along a joint that closes a loop, and so has no coordinates.
    #[error(
        "joint \"{joint}\": one that closes a loop has no coordinates, and takes no {what}; remove it, or let another joint of the loop close it"
    )]
    ClosingJointTakesNo {
        /// The joint.
        joint: String,
        /// "drive", "spring", ….
        what: &'static str,
    },
    /// Two joints would carry one body.
    #[error(
        "joint \"{joint}\": its child \"{body}\" already hangs on joint \"{first}\"; mark the joint closes_loop, merge the two into one d6 joint, or swap its parent and child"
    )]
    SecondCarrier {
        /// The joint.
        joint: String,
        /// The joint before it.
        first: String,
        /// The body.
        body: String,
    },
    /// Bodies hang on one another in a circle.
    #[error(
        "the bodies {} hang on one another in a circle; mark one of their joints closes_loop",
        quoted(bodies)
    )]
    Cycle {
        /// The bodies of the circle.
        bodies: Vec<String>,
    },
    /// An exclusion is of one body.
    #[error("{what}: both of its bodies are \"{body}\"; name two different bodies")]
    ExcludedFromItself {
        /// The exclusion.
        what: String,
        /// The body.
        body: String,
    },
    /// A pair consists of one thing.
    #[error("{what}: both of its {kind} are number {index}; name two different {kind}")]
    SameTwice {
        /// The pair.
        what: String,
        /// Such as "bodies".
        kind: &'static str,
        /// Row of the body or shape.
        index: usize,
    },
    /// Two contact pairs are of the same shapes.
    #[error("contact pairs {first} and {second} are of the same two shapes; remove one")]
    PairTwice {
        /// Row of the one.
        first: usize,
        /// Row of the other.
        second: usize,
    },
    /// Two axes of a joint are one.
    #[error(
        "joint \"{joint}\": its axes {first} and {second} are the same line, so that nothing tells how far each of them \
         moves: leave one out, or give one an armature"
    )]
    SameAxis {
        /// The joint.
        joint: String,
        /// One of the axes.
        first: usize,
        /// The other.
        second: usize,
    },
    /// A coupling needs joints with one axis.
    #[error(
        "coupling \"{coupling}\": joint \"{joint}\" has {axes} axes; couple joints with exactly one"
    )]
    CouplingAxes {
        /// The coupling.
        coupling: String,
        /// The joint.
        joint: String,
        /// Its axes.
        axes: usize,
    },
    /// A coupling ties a joint to itself.
    #[error(
        "coupling \"{coupling}\": joint \"{joint}\" both leads and follows; name two different joints"
    )]
    CouplingToItself {
        /// The coupling.
        coupling: String,
        /// The joint.
        joint: String,
    },
    /// An actuator names a degree of freedom that its joint does not have.
    #[error("actuator \"{actuator}\": joint \"{joint}\" has {count} degrees of freedom in the state, numbered from 0, so not number {dof}; choose another{}", if *closes_loop { " joint, for this one closes a loop" } else { "" })]
    ActuatorDof {
        /// The actuator.
        actuator: String,
        /// The joint.
        joint: String,
        /// The degree of freedom asked for.
        dof: usize,
        /// Degrees of freedom there are.
        count: usize,
        /// Whether the joint closes a loop.
        closes_loop: bool,
    },
    /// A handle is not of the builder that it is used with.
    #[error(
        "{what}: no {role} of this builder has this handle; use handles that this builder gave"
    )]
    ForeignHandle {
        /// Where the handle was used.
        what: String,
        /// Such as "parent body".
        role: &'static str,
    },
    /// A joint or actuator reaches into another object.
    #[error(
        "{what}: its {role} belongs to object \"{other}\", not to \"{object}\"; make it in object \"{other}\""
    )]
    OtherObject {
        /// The joint, coupling or actuator.
        what: String,
        /// Such as "child body".
        role: &'static str,
        /// The object it was made in.
        object: String,
        /// The object it belongs to.
        other: String,
    },
    /// An object has fewer replicas.
    #[error(
        "object \"{object}\" has {count} replicas, numbered from 0, so not number {replica}; call replicate first, or use a number below {count}"
    )]
    NoSuchReplica {
        /// The object.
        object: String,
        /// Replica asked for.
        replica: usize,
        /// Replicas there are.
        count: usize,
    },
    /// A joint or exclusion ties objects whose replicas do not match.
    #[error(
        "{what}: its object has {count} replicas, but that of its {role}, \"{other}\", has {other_count}; replicate both alike, or the other not at all"
    )]
    ReplicasDiffer {
        /// The joint or exclusion.
        what: String,
        /// Such as "parent body".
        role: &'static str,
        /// Replicas of its object.
        count: usize,
        /// The other object.
        other: String,
        /// Replicas of the other object.
        other_count: usize,
    },
    /// A model is for no world.
    #[error("the model asks for 0 worlds; ask for at least 1")]
    NoWorlds,
}

fn quoted(names: &[String]) -> String {
    names
        .iter()
        .map(|n| format!("\"{n}\""))
        .collect::<Vec<_>>()
        .join(", ")
}
