//! Bodies that touch or are jointed, by sequential impulses: piles, towers, ragdolls, thousands of bodies in
//! one world.
//!
//! Projected Gauss–Seidel on velocities (Catto, *Iterative Dynamics with Temporal Coherence*, 2005),
//! with small steps instead of iterations (Macklin et al., *Small Steps in Physics Simulation*,
//! 2019) and soft contacts that are relaxed afterwards (Catto, *Solver2D*, 2024: "soft step"). A
//! step of length H = n h:
//!
//! ```text
//! place shapes, find pairs, find contacts                                       pair
//! prepare: arms, effective masses, softness                                     contact, joint
//! n times:  v ← v + h M⁻¹ f + what these gave in the last small step            body::advance
//!           blows of what meets and bounces, handed on                          blow
//!           impulses that also push surfaces apart, and joints together         contact, joint
//!           x ← x + h v                                                         body::drift
//!           where joints stand now                                              joint::place
//!           impulses alone, so that what was pushed does not fly                contact, joint
//! turn the bodies; keep angular momentum                                        body::finish
//! ```
//!
//! A lane is a *contact* of two bodies, or a joint, not a world: a register takes sixteen contacts of
//! one colour, no two of which share a body. The kernels see one contact and its two bodies; who gathers
//! their numbers, and in which order colours follow, is the host's business.
//!
//! Departures from the sources:
//! - Impulses of the last small step are given again with the forces, as the change of velocity that
//!   they made: the same as warm starting, without a pass over the contacts.
//! - The two arms of a contact meet in one point throughout the step, so that angular momentum is kept
//!   to rounding; that point goes with the lighter body, as under a ball that rolls.
//! - Friction is a force and a torque of the contact as a whole, at its centre of pressure, not of its points.
//! - Gyroscopic torque acts within the step as an acceleration; at its end the spin is that of the
//!   angular momentum, which therefore is conserved to rounding.
//!
//! Two solids that touched in the step before are looked at from the normal that they had then, and let go of it
//! only for one along which they overlap less. So what is pressed deep into another comes out the way it went in.
//!
//! A mesh and a solid have a contact for each normal. A mesh has no inside: a solid whose centre was
//! pressed through it is not pushed out again, and falls.
//!
//! Limitations: first order in h; turns within a step are linear in what the contacts see of them. Joints
//! give way as springs do of an eighth of the frequency of small steps, and all else that acts along their
//! axes once in each; no couplings, and no compliance. Shapes of one articulation that overlap where its
//! joints cannot let them part push without bound: exclude them. Of surfaces that do not give
//! way only the time constant counts, not damping ratio and impedance. A blow that is handed on through more than
//! some thirty bodies within a small step is shared out by those that are left; bodies struck by several at once take
//! the blows in turn, which is not symmetric. A blow is one of the body that is struck: what joints then take from it is not
//! given back, so that what is jointed bounces less than it should. What is struck within a step moves for the rest of it
//! before its own contacts are looked for, unless it gets half of its thickness farther than was foreseen: then the step
//! is taken again (`sim/src/impulse/ahead.rs`).

pub mod blow;
pub mod body;
pub mod contact;
mod friction;
pub mod joint;
mod layout;
mod memory;
pub mod pair;
pub mod report;
pub mod sums;
mod surface;
mod tables;

pub use layout::{
    Collider, FARTHEST, FREE_TURN, HELD_TURN, Impulse, NEARBY, SAME_NORMAL, SAME_PLACE,
    SLEEP_AFTER, State, WORLD, state, suits,
};
pub use memory::{Cached, CachedPoint, REMEMBERED, Recalled, remembered};
pub use surface::Surface;
pub use tables::{BodyTables, ContactTables, POINTS, global, grip, manifold, mass, point, row};
