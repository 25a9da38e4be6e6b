//! Errors of the engine as the exceptions of `kinetarium.errors`, with the same messages.

use kinetarium::DeviceChoiceError;
use kinetarium::formats::FormatError;
use kinetarium::model::ModelError;
use kinetarium::sim::SimulationError;
use pyo3::prelude::*;

/// An exception of `kinetarium.errors`.
pub fn raise(class: &str, message: String) -> PyErr {
    Python::attach(|py| {
        let found = py
            .import("kinetarium.errors")
            .and_then(|m| m.getattr(class));
        match found.and_then(|class| class.call1((message,))) {
            Ok(exception) => PyErr::from_value(exception),
            Err(error) => error,
        }
    })
}

/// A model that is refused, or a name that it does not have.
pub fn model(error: ModelError) -> PyErr {
    let class = match error {
        ModelError::UnknownName { .. } => "UnknownNameError",
        _ => "ModelError",
    };
    raise(class, error.to_string())
}

/// Options of the program that messages name, and what they are here.
const OPTIONS: [(&str, &str); 3] = [
    ("--lenient", "lenient=True"),
    ("--meshes exact", "meshes=\"exact\""),
    ("--meshes hull", "meshes=\"hull\""),
];

fn in_python(message: &str) -> String {
    let message = message.to_owned();
    OPTIONS
        .iter()
        .fold(message, |told, (theirs, own)| told.replace(theirs, own))
}

/// A file that cannot be read.
pub fn file(error: FormatError) -> PyErr {
    raise("FileError", in_python(&error.to_string()))
}

/// A simulation that refuses a call.
pub fn simulation(error: SimulationError) -> PyErr {
    raise(class(&error), in_python(&error.to_string()))
}

fn class(error: &SimulationError) -> &'static str {
    match error {
        SimulationError::InWorld { why, .. } => class(why),
        SimulationError::Model(_) => "ModelError",
        SimulationError::Index { .. } => "OutOfRangeError",
        SimulationError::Device(_)
        | SimulationError::NotOnDevice { .. }
        | SimulationError::NotShared { .. } => "DeviceError",
        _ => "SimulationError",
    }
}

/// A device that is not to be had.
pub fn device(error: DeviceChoiceError) -> PyErr {
    raise("DeviceError", error.to_string())
}

/// A value that makes no sense.
pub fn value(message: String) -> PyErr {
    raise("ModelError", message)
}

/// Refuses numbers below zero; `what` has them, as in `actuator "knee"`.
pub fn negative<const N: usize>(what: &str, numbers: [(&'static str, f64); N]) -> PyResult<()> {
    match numbers.into_iter().find(|(_, value)| *value < 0.0) {
        None => Ok(()),
        Some((quantity, value)) => Err(model(ModelError::Negative {
            what: what.to_owned(),
            quantity,
            value,
        })),
    }
}
