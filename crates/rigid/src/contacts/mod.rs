//! Contacts, found for any solver: which shapes may touch, and where they do.
//!
//! Each pair of shapes that the model's [`CollisionFilter`](model::CollisionFilter) lets through
//! has a fixed range of *slots*, one for each point that its kernel can find, the same in all
//! worlds. The narrow phase lists the slots whose points the two could reach within the step; the others are
//! not looked at, and hold what they held. In a slot that is listed since another lane's point is near, the
//! distance is [`FAR`](collide::FAR). The slots of sensors have a list of their own: solvers never see them.

mod corners;
mod kept;
mod meshes;
mod narrow_phase;
mod plan;
mod sensors;
pub(crate) mod tables;

pub(crate) use corners::Corners;
pub(crate) use kept::{Kept, Touch, forget_torques, report_torques, touches};
use meshes::Meshes;
pub use narrow_phase::MARGIN;
pub(crate) use narrow_phase::{
    Places, narrow_phase, narrow_phase_in_parts, place_shapes, store_placed,
};
pub(crate) use plan::{ContactPlan, Seat};
pub(crate) use sensors::sense;
pub use tables::ContactTables;
pub(crate) use tables::{
    found, pair_field, pair_link, placed_field, round, shape_link, slot, slot_link,
};

/// Fastest separation [m/s] of surfaces that overlap, by that alone: what begins deep inside another is not shot out.
pub(crate) const PUSH_OUT: f64 = 3.0;
