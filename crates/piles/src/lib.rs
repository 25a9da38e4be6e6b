//! Worlds of many bodies that touch, by `impulse`, each by all of the card: as many side by side as it has room for.
//!
//! A step is what it is on the processor (`sim/src/impulse`), by the same kernels: of bodies, shapes, pairs of shapes,
//! contacts and joints, one in each invocation. What lies between them is WGSL: which shapes, and which triangles of a
//! mesh, are near each other, which contact was there before, which colour it has. It finds the pairs in order, and the
//! colours that contacts get one after the other, so that a step is the processor's but for rounding.
//!
//! Nothing comes back within a step. What depends on what it finds, rounds of colouring and of blows and parts into which
//! it is cut, the host launches as often as in the steps before. Where that was not right, or there is too little room for
//! pairs, contacts or colours, nothing is written, or what parts before have written is undone, and the step is taken again.
//!
//! What is rare is left to the processor: a step in which something gets farther than it was looked for, or is stopped at
//! its centre of mass, in which a body has more contacts than there are colours, or more triangles near it than there is
//! room for, or is lost; and one for which the card has no more room.
//!
//! Nothing sleeps in the steps that a card takes.
//!
//! A [`Card`] is what all this needs of an interface to cards: [`Piles`] are worlds on any.

#![forbid(unsafe_code)]

mod actuators;
mod batch;
mod card;
mod constants;
mod error;
mod joints;
mod kernels;
mod launches;
mod meshes;
mod pace;
mod piles;
mod plan;
mod report;
mod room;
mod scene;
mod seen;
mod steps;
mod uniform;

pub use card::{BINDINGS, Card, Commands, Entry, KINDS, Kind, NUMBER, WORKGROUP, kinds};
pub use error::{Need, PilesError, TooLarge};
pub use kernels::texts;
pub use piles::Piles;
pub use seen::seen;
