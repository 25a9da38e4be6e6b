//! Shape against shape: where two solids touch, which way, how deep.
//!
//! Every function but those of [`distance`], and those of [`ray`] that ask one by one, is a kernel: generic over its
//! numbers, without branches that differ from lane to lane, so that it runs in one world or in sixteen, differentiated or traced.
//!
//! SI units, right-handed. In a pair A and B, normals point from A to B, and a distance is the
//! gap between the surfaces along the normal, negative where they overlap. Contacts are reported
//! apart as well as overlapping: what is near enough to matter is the caller's choice.
//!
//! | pair | kernel | points |
//! |---|---|---|
//! | plane and any convex solid | [`pair`], closed forms | 1, 2 or 4 |
//! | sphere and sphere, capsule, cylinder, cone, box | [`pair`], closed forms | 1 |
//! | two capsules | [`pair`], closed form | 2 |
//! | two boxes | [`box_box`], separating axes | 4 |
//! | sphere and ellipsoid, hull | [`sphere_convex`], distances | 1 |
//! | any other two convex solids | [`convex_convex`], distances | 4 |
//! | any convex solid and a triangle mesh | [`mesh::mesh_convex`], its triangles | 9 |
//! | two triangle meshes | [`mesh::mesh_mesh`], the triangles of both | 9 |
//! | plane and triangle mesh | that of its convex hull | 4 |
//!
//! [`Route`] names the kernel for a pair of kinds, so that a solver can keep one list of pairs for
//! each and loop over it. A [height field](model::TriangleMesh::height_field) and the zero surface
//! of a [distance field](model::TriangleMesh::distance_field) are meshes. A finite plane is a
//! [box](Form::finite_plane).
//!
//! # Limits
//! - Solids within [`FLAT`] of parallel count as parallel: their points may be off by that angle. Faces and edges that
//!   lean by up to 0.2 rad touch with all that they overlap in, each point as deep as it is; those of hulls on planes by up
//!   to 0.15 rad, and those of meshes only on planes, as hulls: on other solids they touch in their deepest one or two
//!   points. More than these angles may do: boxes have 0.2 rad about each axis, hulls on solids up to 0.37.
//! - Where solids overlap by more than a tenth of the smaller one, the way out is not the
//!   shortest in up to one of a hundred poses; its depth is right for its normal in any case.
//! - A mesh is touched from its front, by solids whose origin is in front of the triangle, and by the
//!   triangles of meshes half of whose matter is.

#![forbid(unsafe_code)]

mod boxes;
mod contact;
mod convex;
pub mod distance;
mod form;
mod gjk;
pub mod mesh;
mod outline;
mod overlap;
pub mod pair;
pub mod ray;
mod route;
mod solid;
mod support;
mod tables;

pub use boxes::box_box;
pub use contact::{Contact, FAR, Manifold, Point};
pub use convex::{apart, convex_convex, sphere_convex};
pub use form::Form;
pub use route::{Kernel, Route, kernel};
pub use solid::{Placed, Solid, kind};
pub use tables::Tables;

/// Angle [rad] within which two surfaces count as parallel, and touch in more than one point.
pub const FLAT: f64 = 0.01;

/// Angle [rad] up to which faces and edges are looked at whole, with a distance of its own for each point: where solids
/// give way, more of a face touches than its lowest corner.
pub(crate) const LEANING: f64 = 0.2;
