//! Contacts, found for any solver: which shapes may touch, and where they do.
//!
//! Each pair of shapes that the model's [`CollisionFilter`](model::CollisionFilter) lets through
//! has a fixed range of *slots*, one for each point that its kernel can find, the same in all
//! worlds. A slot whose point is farther than the two could come within the step holds the
//! distance [`FAR`](collide::FAR), and costs a comparison. The slots of sensors come last: solvers never
//! see them.

mod corners;
mod meshes;
mod narrow_phase;
mod plan;
mod sensors;
pub(crate) mod tables;

pub(crate) use corners::Corners;
use meshes::Meshes;
pub(crate) use narrow_phase::{
    Places, narrow_phase, narrow_phase_in_parts, place_shapes, store_placed,
};
pub(crate) use plan::{ContactPlan, Seat};
pub(crate) use sensors::sense;
pub use tables::ContactTables;
pub(crate) use tables::{pair_field, slot, slot_link};
