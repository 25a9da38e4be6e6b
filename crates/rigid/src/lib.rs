//! Solvers for articulated rigid bodies.
//!
//! A solver is [`Kernels`]: a model compiled to flat tables, and two functions
//! over a [`Machine`](numbers::Machine) that step a world and report it. The same
//! functions run in lanes, in one world, differentiated, or traced.

#![forbid(unsafe_code)]

mod check;
mod cone;
mod contacts;
pub mod featherstone;
mod gauges;
mod gyroscopic;
mod implicitness;
pub mod impulse;
mod input;
mod instrument;
mod lists;
mod locks;
mod output;
mod rangefinder;
mod restitution;
mod solver;
mod tables;
pub mod xpbd;

pub use contacts::ContactTables;
pub use featherstone::dynamics::{Dynamics, DynamicsError, DynamicsKernels, Totals};
pub use featherstone::{ArticulatedBodies, Featherstone, Integrator, TouchingFeatherstone};
pub use gauges::{FLAGS, Gauge, Gauges, Reported};
pub use input::InputTables;
pub use instrument::{Instrument, Sheet};
pub use output::{OutputTables, body, body_acceleration, contact, reaction, total};
pub use rangefinder::{FARTHEST, Rangefinder};
pub use solver::{Kernels, Lanes, Lengths, Report, Settings, Solver, SolverError};
pub use xpbd::Xpbd;
