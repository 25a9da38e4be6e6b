//! Physics that is known beforehand, asked of all solvers.
//!
//! Every tolerance follows from the order of the method, and the comment beside it says how.
//! Where the method's own discrete solution is known in closed form, the test compares with that,
//! and only rounding is allowed for.

mod agreement;
mod armature;
mod chain;
mod closed_forms;
mod common;
mod conservation;
mod drives;
mod joints;
mod loops;
mod order;
mod reactions;
mod swings;
mod touching;
mod two_way;
mod xpbd;
