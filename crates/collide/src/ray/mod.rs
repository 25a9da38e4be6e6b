//! Lines against solids and triangles, exactly, in double precision: what rays and cameras ask.
//!
//! These are no kernels: a ray meets one shape of one world at a time.

mod line;
mod triangle;

pub use line::{Face, Line, Span, faces};
pub use triangle::Sheared;
