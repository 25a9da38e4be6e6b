//! Names of things of which there are few: tables, read in both directions.

use crate::error;
use kinetarium::model::hint;
use pyo3::prelude::*;

/// Names, and what they stand for.
pub type Table<T, const N: usize> = [(&'static str, T); N];

/// What a name stands for; `kind` is of what kind it is, as in "integrator".
///
/// `UnknownNameError` where it stands for nothing, with the one that was meant.
pub fn find<T: Copy, const N: usize>(table: &Table<T, N>, kind: &str, name: &str) -> PyResult<T> {
    match table.iter().find(|(known, _)| *known == name) {
        Some((_, found)) => Ok(*found),
        None => Err(unknown(
            kind,
            name,
            &table.each_ref().map(|(name, _)| *name),
        )),
    }
}

/// The name of what is in the table.
pub fn name_of<T: PartialEq, const N: usize>(table: &Table<T, N>, value: &T) -> &'static str {
    let found = table.iter().find(|(_, known)| known == value);
    found.map_or("", |(name, _)| *name)
}

/// A name that is not among those that there are.
pub fn unknown(kind: &str, name: &str, known: &[&str]) -> PyErr {
    let message = format!("there is no {kind} \"{name}\"; {}", hint(name, known));
    error::raise("UnknownNameError", message)
}
