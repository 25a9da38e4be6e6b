//! Shape against shape: where two solids touch, which way, how deep.
//!
//! Every function is a kernel: generic over its numbers, without branches that differ from lane
//! to lane, so that it runs in one world or in sixteen, differentiated or traced.
//!
//! SI units, right-handed. In a pair A and B, normals point from A to B, and a distance is the
//! gap between the surfaces along the normal, negative where they overlap.

#![forbid(unsafe_code)]

mod boxes;
mod contact;
mod convex;
mod form;
mod gjk;
mod hull;
pub mod mesh;
mod outline;
mod overlap;
pub mod pair;
mod route;
mod solid;
mod support;
mod tables;

pub use boxes::box_box;
pub use contact::{Contact, FAR, Manifold, Point};
pub use convex::convex_convex;
pub use form::Form;
pub use hull::{ConvexHull, HullError};
pub use route::Route;
pub use solid::{Placed, Solid, kind};
pub use tables::Tables;

/// Angle [rad] within which two surfaces count as parallel, and touch in more than one point.
pub const FLAT: f64 = 0.01;
