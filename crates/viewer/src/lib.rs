//! Serves the page, and connects it to a session.
//!
//! [`serve`] answers `/` with the page and `/session` with a WebSocket that speaks
//! [`session::protocol`]. One session has any number of pages: all see the same worlds, and each may steer.
//! The session runs on a thread of its own (`engine.rs`), so that nothing a page does, or fails to
//! do, holds it up. [`show`] does the same for a simulation that a program goes on stepping.

#![forbid(unsafe_code)]

mod access;
mod client;
mod engine;
mod error;
mod server;
mod viewer;

pub use access::Access;
pub use engine::clock;
pub use error::ViewerError;
pub use server::{Server, serve};
pub use viewer::{Viewer, show};
