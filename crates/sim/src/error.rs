//! What can be wrong with a call.

use crate::{DeviceError, SnapshotError};
use numbers::dispatch::IsaError;
use rigid::SolverError;
use std::borrow::Cow;

/// Why a simulation cannot be made, or refuses a call. The simulation is as before.
#[derive(Debug, thiserror::Error)]
pub enum SimulationError {
    /// The solver cannot take the model.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// The model refuses a change.
    #[error(transparent)]
    Model(#[from] model::ModelError),
    /// The instruction set is not to be had.
    #[error(transparent)]
    Isa(#[from] IsaError),
    /// The snapshot does not fit.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
    /// A setting makes no sense.
    #[error("{what} is {value}: it must be {remedy}")]
    Setting {
        /// Which setting.
        what: Cow<'static, str>,
        /// Its value.
        value: String,
        /// What it must be.
        remedy: Cow<'static, str>,
    },
    /// An index is out of range.
    #[error("{what} {index} does not exist: there are {count}, counted from 0")]
    Index {
        /// What is counted.
        what: &'static str,
        /// The index given.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// An array has the wrong length.
    #[error("{what} has {found} numbers, but the model needs {expected}")]
    Length {
        /// Which array.
        what: &'static str,
        /// Its length.
        found: usize,
        /// The right length.
        expected: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what}[{index}] is {value}: it must be a finite number")]
    NotFinite {
        /// Which array.
        what: &'static str,
        /// Where in it.
        index: usize,
        /// The number.
        value: f64,
    },
    /// What one world is given is refused.
    #[error("world {world}: {why}")]
    InWorld {
        /// Which world.
        world: usize,
        /// Why.
        why: Box<SimulationError>,
    },
    /// A number is too large to compute with.
    #[error("{what}[{index}] is {value:e}: it must be from -{most:e} to {most:e}")]
    TooLarge {
        /// Which array.
        what: &'static str,
        /// Where in it.
        index: usize,
        /// The number.
        value: f64,
        /// The largest that is taken.
        most: f64,
    },
    /// A quaternion is no rotation.
    #[error(
        "joint position: the quaternion of joint `{joint}` is zero: give one of unit length, x, y, z, w"
    )]
    NoRotation {
        /// Name of the joint.
        joint: String,
    },
    /// The worlds do not fit.
    #[error(
        "{worlds} worlds of this model need {gibibytes:.1} GiB of memory, which are not to be had: ask for fewer"
    )]
    Memory {
        /// How many were asked for.
        worlds: usize,
        /// What they need.
        gibibytes: f64,
    },
    /// A world's own model has other bodies or joints.
    #[error(
        "the model of world {world} has another structure than the simulation's: only numbers may differ between worlds, \
         and what is zero since it is not there (drives, dry friction, springs, dampers) must stay zero"
    )]
    Structure {
        /// Which world.
        world: usize,
    },
    /// What was made for one simulation is used with another.
    #[error("the {0} of another model or solver: make new ones of this simulation")]
    OtherModel(&'static str),
    /// Numbers of a parameter for which the solver has no room, or the other way round.
    #[error(
        "with this {parameter} the model has another structure than the simulation's: drives, dry friction, springs and \
         dampers that are zero in all of it are not there; make the simulation of a model that has some (of drives: \
         `with_drives`), and give worlds others"
    )]
    Parameter {
        /// Its name.
        parameter: &'static str,
    },
    /// A query makes no sense.
    #[error("{what} of {query} {index} is {value}: it must be {remedy}")]
    Query {
        /// What is asked: "ray", "shape cast", "point" or "shape".
        query: &'static str,
        /// Its place among those given.
        index: usize,
        /// Which part of it.
        what: &'static str,
        /// How it is.
        value: String,
        /// What it must be.
        remedy: &'static str,
    },
    /// Queries find no mesh whose file cannot be read.
    #[error("{what} cannot meet the mesh of shape {shape} (`{name}`): {reason}")]
    NotRead {
        /// What is asked: "rays", "swept shapes", "points" or "shapes".
        what: &'static str,
        /// Row of the shape.
        shape: usize,
        /// Its name.
        name: String,
        /// What is wrong with its file.
        reason: String,
    },
    /// Shapes are nowhere, or too many.
    #[error(transparent)]
    Space(#[from] space::SpaceError),
    /// The device cannot take the worlds, or has failed.
    #[error(transparent)]
    Device(#[from] DeviceError),
    /// The solver needs what devices do not have.
    #[error(
        "the solver `{solver}` does not run on {device}: take `featherstone` or `xpbd`, or run on the processor"
    )]
    NotOnDevice {
        /// Its name.
        solver: &'static str,
        /// Name of the device.
        device: String,
    },
    /// Other libraries cannot get at it.
    #[error("{what} cannot be shared with other libraries: {remedy}")]
    NotShared {
        /// What was asked for.
        what: String,
        /// What to do instead.
        remedy: &'static str,
    },
    /// The threads cannot be started.
    #[error("cannot start {threads} threads: {reason}")]
    Threads {
        /// How many were asked for.
        threads: usize,
        /// What the system says.
        reason: String,
    },
}

/// Largest coordinate, speed or target that is taken [m, rad, m/s, rad/s]: its square is still a
/// number in single precision.
pub(crate) const MOST_MOTION: f64 = 1e9;
/// Largest force or control that is taken: beyond it single precision ends.
pub(crate) const MOST_FORCE: f64 = 1e30;

/// Refuses NaN, infinities and what is larger than `most`.
pub(crate) fn bounded(what: &'static str, x: &[f64], most: f64) -> Result<(), SimulationError> {
    match x
        .iter()
        .copied()
        .enumerate()
        .find(|(_, v)| !(-most..=most).contains(v))
    {
        Some((index, value)) if value.is_finite() => Err(SimulationError::TooLarge {
            what,
            index,
            value,
            most,
        }),
        Some((index, value)) => Err(SimulationError::NotFinite { what, index, value }),
        None => Ok(()),
    }
}

/// Refuses an array of another length.
pub(crate) fn length(
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SimulationError> {
    if found == expected {
        Ok(())
    } else {
        Err(SimulationError::Length {
            what,
            found,
            expected,
        })
    }
}

/// Refuses an index beyond the end.
pub(crate) fn index(what: &'static str, index: usize, count: usize) -> Result<(), SimulationError> {
    if index < count {
        Ok(())
    } else {
        Err(SimulationError::Index { what, index, count })
    }
}
