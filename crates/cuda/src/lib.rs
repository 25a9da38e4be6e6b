//! The kernels of the solvers on NVIDIA's cards, through CUDA.
//!
//! There is no physics here. A [`Solver`](rigid::Solver) is [recorded](records::Programs), the record is printed as
//! CUDA C++ ([`to_cuda`](numbers::trace::Program::to_cuda)), and NVRTC compiles it for the card. Every operation is
//! rounded as on the processor, so that results have the same bits.
//!
//! [`Cuda`] is a card, and a [`Device`](sim::Device): [`Simulation::on`](sim::Simulation::on) places its worlds there.
//! [`Worlds`] are W worlds of one solver in its memory: their numbers stay there from step to step, and come back when
//! they are asked for. One thread steps one world.
//!
//! Worlds of `impulse`, which threads share, are [piles](::piles::Piles): their WGSL is read by naga and printed as CUDA C++.
//!
//! Nothing of CUDA is needed to build this: NVIDIA's driver and NVRTC are looked for when a card is opened.
//!
//! ```no_run
//! use kinetarium_cuda::Cuda;
//! use sim::{Quantity, Simulation, SimulationSettings};
//!
//! let card = Cuda::open(0)?;
//! let model = model::examples::n_pendula(3)?;
//! let mut simulation = Simulation::on(&card, model, SimulationSettings::new(65536, 0.002))?;
//! simulation.try_step(1000)?;
//! let mut positions = vec![0.0; 65536 * 3];
//! simulation.read(Quantity::JointPosition, &mut positions)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limitations
//! Numbers are `f32`. Of `impulse`, rare steps are left to the processor, and worlds have gravity of one strength where
//! things bounce or stick; there, the last bits are not the processor's.

#![deny(unsafe_code)]

mod card;
mod compiler;
mod error;
mod instrument;
mod kernel;
mod libraries;
mod piles;
mod wgsl;
mod worlds;

pub use card::Cuda;
pub use compiler::{ptx, ptx_of_wgsl};
pub use error::CudaError;
pub use worlds::Worlds;
