//! Why a command is refused.

use formats::FormatError;
use model::ModelError;
use sim::{SimulationError, SnapshotError};
use thiserror::Error;

/// Why a command is refused. All is as before it.
#[derive(Debug, Error)]
pub enum SessionError {
    /// It is no command.
    #[error(
        "this is no command: {reason}; commands are JSON objects with a `type`, see the protocol"
    )]
    Command {
        /// What the reader says.
        reason: String,
    },
    /// There is no such example.
    #[error("there is no example `{name}`; known are {known}")]
    Example {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// There is no such field.
    #[error("there is no field `{name}`; known are {known}")]
    Field {
        /// What was asked for.
        name: String,
        /// What there is.
        known: String,
    },
    /// A value is not one that the field takes.
    #[error("{name} cannot be {value}: it must be {range}")]
    Value {
        /// Of the field or argument.
        name: String,
        /// What was given.
        value: f64,
        /// What it takes.
        range: String,
    },
    /// There is no such row.
    #[error("there is no {what} {row}: there are {count}, counted from 0")]
    Row {
        /// Of what.
        what: &'static str,
        /// What was asked for.
        row: usize,
        /// How many there are.
        count: usize,
    },
    /// A list is too long or empty.
    #[error("{what} must be from {least} to {most}, not {count}")]
    Count {
        /// Of what.
        what: &'static str,
        /// Least.
        least: usize,
        /// Most.
        most: usize,
        /// What was given.
        count: usize,
    },
    /// It has no effect on that body.
    #[error("body `{body}` does not move: take one that does")]
    Immovable {
        /// Its name.
        body: String,
    },
    /// A drive is asked of what has none.
    #[error(
        "degree of freedom `{dof}` cannot have a drive: joints that are free have none; use one that is not"
    )]
    Undriven {
        /// Its name.
        dof: String,
    },
    /// A page asks for what is the program's to change.
    #[error("{what} cannot be changed here: the simulation is a program's; change it there")]
    Program {
        /// What was to be changed.
        what: &'static str,
    },
    /// The model cannot be made.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A file cannot be read.
    #[error(transparent)]
    Format(#[from] Box<FormatError>),
    /// The simulation refuses.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// A recorded state does not fit.
    #[error(transparent)]
    Snapshot(#[from] SnapshotError),
}

impl SessionError {
    /// Whether a graphics card says so.
    pub(crate) fn is_of_card(&self) -> bool {
        matches!(self, Self::Simulation(SimulationError::Device(_)))
    }
}

/// Refuses rows that are not there.
pub(crate) fn row(what: &'static str, row: usize, count: usize) -> Result<usize, SessionError> {
    if row < count {
        Ok(row)
    } else {
        Err(SessionError::Row { what, row, count })
    }
}

/// Refuses numbers out of a range, and what is no number.
pub(crate) fn within(name: &str, value: f64, least: f64, most: f64) -> Result<f64, SessionError> {
    if (least..=most).contains(&value) {
        return Ok(value);
    }
    Err(SessionError::Value {
        name: name.into(),
        value,
        range: format!("from {least} to {most}"),
    })
}

/// Refuses lists that are too short or too long.
pub(crate) fn count(
    what: &'static str,
    count: usize,
    [least, most]: [usize; 2],
) -> Result<(), SessionError> {
    if (least..=most).contains(&count) {
        return Ok(());
    }
    Err(SessionError::Count {
        what,
        least,
        most,
        count,
    })
}
