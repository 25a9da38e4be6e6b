//! Numbers a physics kernel is written over.
//!
//! A kernel is an ordinary generic function over [`Real`] (the numbers) and
//! [`Machine`] (tables, loops and links). The same function is read as scalar
//! code, as sixteen worlds in a register, as a derivative, or as a recorded
//! program that prints as WGSL. This crate knows nothing of physics.
//!
//! | type | reading |
//! |---|---|
//! | `f32`, `f64` | one world |
//! | [`lanes`] | 16 worlds of `f32`, 8 of `f64`, per instruction set |
//! | [`Dual`] | value and forward derivative |
//! | [`trace`] | a handle into a recorded program |

#![deny(unsafe_code)]

pub mod dispatch;
mod dual;
pub mod functions;
pub mod lanes;
pub mod machine;
mod mat3;
mod memory;
mod pose;
mod quat;
mod real;
pub mod rotation;
mod rows;
mod scalar;
pub mod spatial;
pub mod trace;
mod vec3;

pub use dual::Dual;
pub use machine::{Cell, Cpu, Machine, Parameters, PerWorld, Shared, Table};
pub use mat3::{Cholesky3, Mat3, SymMat3};
pub use memory::Memory;
pub use pose::Pose;
pub use quat::Quat;
pub use real::{Float, Known, Lanes, LanesMask, Mask, Real};
pub use rows::{Atom, LANES, Picked, Quad, Rows};
pub use vec3::Vec3;
