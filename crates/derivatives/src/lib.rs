//! Derivatives of a time step: what linear controllers, trajectory optimisers and filters ask for.
//!
//! [`linearize`] runs the solver's own step once more, in dual numbers: no differences, no step to
//! choose, exact to rounding.
//!
//! ```
//! use kinetarium_derivatives::linearize;
//! use model::examples::n_pendula;
//! use sim::{Simulation, SimulationSettings};
//!
//! let mut simulation = Simulation::<f64>::new(n_pendula(2)?, SimulationSettings::new(1, 0.002))?;
//! let step = linearize(&mut simulation, 0)?;
//! let (n, a) = (step.dofs, &step.state);
//! // Semi-implicit Euler: q' = q + h q̇', hence ∂q'/∂q̇ = h ∂q̇'/∂q̇.
//! assert!((a[n] - 0.002 * a[n * 2 * n + n]).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! It is a package of its own so that who does not ask for derivatives does not compile them.

#![forbid(unsafe_code)]

mod error;
mod jobs;
mod linearization;
mod tangent;
mod touching;

pub use error::LinearizeError;
pub use linearization::{Linearization, linearize};
