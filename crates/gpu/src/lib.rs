//! The kernels of the solvers on graphics cards of any maker.
//!
//! There is no physics here. A [`Solver`](rigid::Kernels) is run once over the machine that
//! [records](numbers::trace), the record is printed as WGSL, and wgpu compiles it for the card: what runs
//! there is what runs on the CPU, operation by operation.
//!
//! [`Gpu`] is a card, found by [`Choice`], and a [`Device`](sim::Device): [`Simulation::on`](sim::Simulation::on)
//! places its worlds there. [`Worlds`] are W worlds of one solver in its memory: their numbers stay there from step
//! to step, and come back when they are asked for. One invocation steps one world, so that a card is busy from
//! some ten thousand worlds on.
//!
//! ```no_run
//! use kinetarium_gpu::Gpu;
//! use sim::{Quantity, Simulation, SimulationSettings};
//!
//! let card = Gpu::open(&"".parse()?)?; // any card that is there
//! let model = model::examples::n_pendula(3)?;
//! let mut simulation = Simulation::on(&card, model, SimulationSettings::new(65536, 0.002))?;
//! simulation.try_step(1000)?;
//! let mut positions = vec![0.0; 65536 * 3];
//! simulation.read(Quantity::JointPosition, &mut positions)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limitations
//! Numbers are `f32`. Results agree with the CPU's to rounding, not to the bit: shading languages leave the
//! last bits of division, square root and fused multiply-add to the card. Of `impulse`, rare steps are left to the
//! processor, and worlds have gravity of one strength where things bounce or stick.

#![forbid(unsafe_code)]

mod card;
mod clock;
mod error;
mod instrument;
mod memory;
mod piles;
mod pipeline;
mod placement;
mod worlds;

pub use adapter::{Choice, NoCard};
pub use card::Gpu;
pub use error::GpuError;
pub use worlds::Worlds;
