//! What robots measure, in many worlds at once: joints, inertial units, forces, contacts, frames, distances
//! and images, at rates of their own, with noise.
//!
//! ```
//! use glam::DVec3;
//! use kinetarium_sensors::{Mount, Noise, Sensor, SensorKind, Sensors};
//! use model::{Pose, examples};
//! use sim::{Simulation, SimulationSettings};
//!
//! let model = examples::n_pendula(2)?;
//! let mut simulation = Simulation::<f32>::new(model, SimulationSettings::new(64, 0.002))?;
//! let tip = Mount::on(simulation.model().body("link1")?).at(Pose::at(DVec3::new(0.0, -0.5, 0.0)));
//! let joints = SensorKind::all_joints(simulation.model());
//! let list = vec![
//!     Sensor::new("angles", SensorKind::JointPosition { joints }),
//!     Sensor::new("imu", SensorKind::Imu { mount: tip })
//!         .with_rate(100.0) // [Hz]
//!         .with_noise(Noise::white(0.02)),
//! ];
//! let mut sensors = Sensors::new(&mut simulation, list, 1)?;
//! sensors.step(&mut simulation, 50)?; // 0.1 s, in which the imu is sampled ten times
//! let imu = sensors.reading("imu")?;
//! assert_eq!(imu.shape, [64, 6]);
//! assert!((imu.time[63] - 0.1).abs() < 1e-9);
//! println!("world 63: {:?}", &imu.numbers[63 * 6..]); // [m/s²], then [rad/s]
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! SI units, right-handed, quaternions x, y, z, w; numbers in the precision of the simulation.
//! What each kind measures stands at [`SensorKind`], what noise is at [`Noise`].
//!
//! # Limits
//! - Contact forces are those of the last step. Accelerations are of the last substep but with
//!   `featherstone`.
//! - `JointEffort` takes no drives with a control time: how far their targets have got only the solver knows.
//! - Cameras show the model of the simulation, whatever sizes a world's own model has.

#![forbid(unsafe_code)]

mod bank;
mod check;
mod clock;
mod error;
mod from_model;
mod images;
mod noise;
mod random;
mod sensor;
mod sensors;
mod state;

pub use error::SensorError;
pub use model::{Axes, Mount};
pub use noise::{Disturbance, ImageNoise, Level, Noise};
pub use random::Draw;
pub use render::{Camera, Channels, Device, Images, Lens, View};
pub use sensor::{Sensor, SensorKind};
pub use sensors::{ImageReading, Reading, Sensors};
