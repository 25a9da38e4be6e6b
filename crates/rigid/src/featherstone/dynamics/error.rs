//! What can be wrong with a question about dynamics.

/// Why a function of dynamics refuses its arguments.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum DynamicsError {
    /// A slice has the wrong length.
    #[error("{found} {what} given: the model has {expected}")]
    Length {
        /// What is counted.
        what: &'static str,
        /// How many were given.
        found: usize,
        /// How many there must be.
        expected: usize,
    },
    /// A number is infinite or NaN.
    #[error("number {index} of the {what} is {value}: give finite numbers")]
    NotFinite {
        /// What the numbers are.
        what: &'static str,
        /// Which of them, counted from 0.
        index: usize,
        /// The number.
        value: f64,
    },
    /// A quaternion is no rotation.
    #[error("coordinates {first} to {} are a quaternion, and zero: give one of unit length, x, y, z, w", .first + 3)]
    NoRotation {
        /// The first of its coordinates, counted from 0.
        first: usize,
    },
    /// There is no such body.
    #[error("body {body} does not exist: the model has {bodies}, counted from 0")]
    Body {
        /// Row of the body.
        body: usize,
        /// Number of bodies.
        bodies: usize,
    },
}

/// Checks the length of a slice, and that all its numbers are finite.
pub(super) fn finite(
    what: &'static str,
    numbers: &[f64],
    expected: usize,
) -> Result<(), DynamicsError> {
    let found = numbers.len();
    if found != expected {
        return Err(DynamicsError::Length {
            what,
            found,
            expected,
        });
    }
    match numbers.iter().position(|x| !x.is_finite()) {
        Some(index) => Err(DynamicsError::NotFinite {
            what,
            index,
            value: numbers[index],
        }),
        None => Ok(()),
    }
}
