//! What can be wrong with sensors.

use render::RenderError;
use sim::SimulationError;

/// Why sensors cannot be made, sampled or read. They are as before.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SensorError {
    /// A sensor without a name.
    #[error("sensor {row} has no name: give each a name of its own")]
    NoName {
        /// Its place in the list.
        row: usize,
    },
    /// Two sensors of one name.
    #[error("two sensors are named `{name}`: give each a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// There is no such sensor.
    #[error("there is no sensor \"{name}\"; {hint}")]
    UnknownName {
        /// The name asked for.
        name: String,
        /// The name that is alike, or those that there are.
        hint: String,
    },
    /// There is no sensor in this row.
    #[error("sensor {row} does not exist: there are {count}, counted from 0")]
    NoSuchRow {
        /// The row asked for.
        row: usize,
        /// How many there are.
        count: usize,
    },
    /// A body or joint that the model does not have.
    #[error(
        "sensor `{sensor}`: {what} {row} does not exist: the model has {count}, counted from 0"
    )]
    NotInModel {
        /// Name of the sensor.
        sensor: String,
        /// `body` or `joint`.
        what: &'static str,
        /// The row asked for.
        row: usize,
        /// How many there are.
        count: usize,
    },
    /// A number makes no sense.
    #[error("sensor `{sensor}`: {what} is {value}: it must be {must}")]
    OutOfRange {
        /// Name of the sensor.
        sensor: String,
        /// Which number.
        what: &'static str,
        /// Its value.
        value: String,
        /// What it must be.
        must: &'static str,
    },
    /// Noise for each number, of which there are more or fewer.
    #[error(
        "sensor `{sensor}`: {what} has {found} numbers, but the sensor has {expected}: give one for each, or \
         one for all"
    )]
    Length {
        /// Name of the sensor.
        sensor: String,
        /// Which part of the noise.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many numbers the sensor has in a world.
        expected: usize,
    },
    /// What the sensor is to measure is not there.
    #[error("sensor `{sensor}`: a {kind} sensor takes no {what}: {remedy}")]
    Unsupported {
        /// Name of the sensor.
        sensor: String,
        /// What it measures.
        kind: &'static str,
        /// What it does not take.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// A camera is read by `images`, all others by `reading`.
    #[error("sensor `{sensor}` is {is}: call `{call}`")]
    OtherReading {
        /// Name of the sensor.
        sensor: String,
        /// What it is.
        is: &'static str,
        /// What reads it.
        call: &'static str,
    },
    /// The simulation is not the one that the sensors were made for.
    #[error(
        "the simulation has another model, solver or number of worlds than the one that the sensors were made \
         for: make sensors for it"
    )]
    OtherSimulation,
    /// A saved state does not fit.
    #[error("the state of the sensors cannot be restored: {0}")]
    State(&'static str),
    /// The device that the worlds are on fails.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A camera makes no sense, or cannot be drawn.
    #[error("sensor `{sensor}`: {source}")]
    Render {
        /// Name of the sensor.
        sensor: String,
        /// Why.
        source: RenderError,
    },
    /// Rays cannot be cast.
    #[error("sensor `{sensor}`: {source}")]
    Rays {
        /// Name of the sensor.
        sensor: String,
        /// Why.
        source: SimulationError,
    },
}
