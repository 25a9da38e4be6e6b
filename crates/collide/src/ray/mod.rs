//! Lines against solids and triangles, exactly: what rays, sensors of distance and cameras ask.
//!
//! [`kernel`] has the formulas, for any numbers, and [`surface`] what hulls and meshes are in tables. The others ask about
//! one shape of one world at a time, in double precision.

pub mod kernel;
mod line;
pub mod surface;
mod triangle;

pub use line::{Face, Line, Span, faces};
pub use triangle::Sheared;
