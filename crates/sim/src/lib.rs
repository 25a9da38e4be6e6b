//! Many worlds of one model, stepped in lanes and threads.
//!
//! A [`Simulation`] holds W worlds in blocks that fill a register, and advances
//! all of them with one solver. A world's trajectory is the same bits whatever
//! W is, whichever lane it sits in, and however many threads run.

#![forbid(unsafe_code)]

mod compile;
mod controller;
mod controls;
mod device;
mod effort;
mod engine;
mod error;
mod events;
mod facts;
mod gauges;
mod impulse;
mod instrument;
mod jobs;
mod meshes;
mod output_part;
mod outputs;
mod parameter;
mod quantity;
mod queries;
mod rangefinder;
mod ranges;
mod rays;
mod scratch;
mod setting;
mod settings;
mod shared;
mod simulation;
mod snapshot;
mod spatial;
mod threads;

pub use controller::{Controller, Recorder, Recording, Replay};
pub use controls::{Controls, Inputs};
pub use device::{Address, Constants, Device, DeviceError, DeviceWorlds, Processor, Stage};
pub use effort::Effort;
pub use error::SimulationError;
pub use events::{Event, EventKind, Watch};
pub use gauges::Gauges;
pub use impulse::joint_runs;
pub use output_part::OutputPart;
pub use outputs::{Contact, Outputs};
pub use parameter::Parameter;
pub use quantity::{Control, Quantity};
pub use queries::{PlacedShape, QueryHit, Seen, ShapeCast};
pub use rangefinder::Rangefinder;
pub use rays::{Ray, RayHit};
pub use rigid::{FLAGS, Gauge, Report};
pub use setting::{SETTINGS, Setting, SettingKind};
pub use settings::{SimulationSettings, SolverKind};
pub use shared::DeviceArray;
pub use simulation::{Diverged, Simulation, WorldNumbers};
pub use snapshot::{Snapshot, SnapshotError};
