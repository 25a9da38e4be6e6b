//! What exists in a simulated world, with no algorithm in it.
//!
//! A [`Model`] is a set of flat tables, checked once when it is made, and then
//! immutable and shared by all worlds. It is written by hand with a [`Builder`],
//! or read from a file by the `formats` crate.
//!
//! SI units; right-handed; quaternions x, y, z, w; sizes of shapes are half sizes.

#![forbid(unsafe_code)]

mod actuator;
mod body;
mod builder;
mod camera;
mod color;
mod contact_pair;
mod error;
pub mod examples;
mod filter;
mod hull;
mod joint;
mod keyframe;
mod lamp;
mod mass;
mod material;
mod mesh;
mod model;
mod pose;
mod sensor;
mod shape;

pub use actuator::Actuator;
pub use body::{Body, BodyId, BodyKind};
pub use builder::{
    ActuatorDraft, BodyDraft, BodyHandle, Builder, ContactPairDraft, JointDraft, JointHandle,
    Object, ObjectId, Placement, ShapeHandle,
};
pub use camera::{Camera, CameraMode};
pub use color::default_color;
pub use contact_pair::{ContactPair, Whose};
pub use error::ModelError;
pub use filter::{CollisionFilter, FilterSide};
pub use hull::{Hull, HullError};
pub use joint::{Axis, AxisKind, Coupling, Dof, Drive, Joint, JointId, JointKind, Limit};
pub use keyframe::Keyframe;
pub use lamp::{Lamp, LampKind};
pub use mass::MassProperties;
pub use material::{Combine, Material, Softness};
pub use mesh::{DistanceFieldError, HeightFieldError, MeshError, TriangleMesh};
pub use model::{Model, Parts, UpAxis, hint, similar_name, unit_quaternion};
pub use pose::Pose;
pub use sensor::{Axes, Measurand, Mount, Sensor};
pub use shape::{Geometry, Shape, ShapeId};
