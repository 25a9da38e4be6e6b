//! A physics engine for articulated bodies: thousands of worlds side by side, in lanes and threads.
//!
//! ```
//! use kinetarium::prelude::*;
//!
//! // 64 pendula of three links each; world k starts k hundredths of a radian from horizontal.
//! let model = examples::n_pendula(3)?;
//! let mut simulation = Simulation::<f32>::new(model, SimulationSettings::new(64, 0.002))?;
//! for world in 0..simulation.worlds() {
//!     simulation.set_joint_state(world, &[1.57 + 0.01 * world as f64, 0.0, 0.0], &[0.0; 3])?;
//! }
//! simulation.step(500); // 500 steps of 2 ms
//! let tip = simulation.model().body("link2")?;
//! println!("{} m after {} s", simulation.outputs().body_position(7, tip), simulation.time(7));
//! # assert!((simulation.time(7) - 1.0).abs() < 1e-9);
//! # assert!(simulation.diverged().is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A robot file instead of the example: `formats::load("robot.xml".as_ref(), &Default::default())?.model`.
//!
//! | module | what |
//! |---|---|
//! | [`model`] | what exists: bodies, shapes, joints, drives, actuators; the builder |
//! | [`formats`] | readers of MJCF and URDF files |
//! | [`collide`] | shape against shape; meshes from OBJ and STL files, with the feature `gltf` from GLB files |
//! | [`space`] | where things are: trees, grids, sweep-and-prune; rays, nearest neighbours |
//! | `decomposition` | convex pieces of meshes, with the feature `decomposition` |
//! | [`sim`] | many worlds of one model: step, control, observe, snapshot |
//! | [`sensors`] | what robots measure: joints, inertial units, forces, rays, cameras, with noise |
//! | [`rigid`] | the solvers, as kernels over any machine |
//! | `gpu` | graphics cards of any maker, with the feature `gpu`; see [`DeviceChoice`] |
//! | `cuda` | NVIDIA's cards by CUDA, but for `impulse` bit for bit as the processor, with the feature `cuda` |
//! | [`numbers`] | the numbers and machines that kernels are written over |
//!
//! SI units; angles in radians; right-handed; quaternions x, y, z, w.

#![forbid(unsafe_code)]

pub use collide;
#[cfg(feature = "cuda")]
pub use cuda;
#[cfg(feature = "decomposition")]
pub use decomposition;
pub use formats;
#[cfg(feature = "gpu")]
pub use gpu;
pub use model;
pub use numbers;
pub use rigid;
pub use sensors;
pub use sim;
pub use space;

mod cards;
mod device;
#[cfg(doctest)]
mod documentation;

pub use cards::{Card, Cards};
pub use device::{DeviceChoice, DeviceChoiceError};

/// What most programs need.
pub mod prelude {
    pub use crate::DeviceChoice;
    pub use formats::{Loaded, Meshes, Options};
    pub use model::{
        BodyId, Builder, Geometry, Hull, JointId, Model, Pose, TriangleMesh, examples,
    };
    pub use rigid::{Integrator, Settings};
    pub use sensors::{Mount, Noise, Sensor, SensorKind, Sensors};
    pub use sim::{
        Contact, Controller, Controls, Diverged, Event, EventKind, Outputs, PlacedShape, QueryHit,
        Ray, RayHit, Recorder, Recording, Replay, Seen, ShapeCast, Simulation, SimulationError,
        SimulationSettings, Snapshot, SolverKind, Watch,
    };
}
