//! Triangle meshes ([`model::TriangleMesh`]): a surface, not a solid, that is touched from the side
//! its normals point to.

mod adjacency;
#[cfg(feature = "gltf")]
mod glb;
pub(crate) mod hierarchy;
mod kept;
mod kernel;
#[cfg(feature = "meshes")]
mod load;
mod matter;
mod oriented_box;
mod piece;
mod tables;

pub use kernel::{Surface, mesh_convex, mesh_mesh};
#[cfg(feature = "meshes")]
pub use load::{LoadError, is_known, load, parse, scaled};
pub use oriented_box::OrientedBox;
pub use tables::{
    BEYOND, BOUNDS, MeshData, MeshTables, NUMBER, SLOTS, TRIANGLE, Triangle, VERTICES, contact,
};
