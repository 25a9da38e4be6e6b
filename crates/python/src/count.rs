//! Whole numbers that must not be negative.

use crate::error;
use kinetarium::model::ModelError;
use pyo3::prelude::*;

/// A number of things, or of one of them. `what` is the culprit, as in `object "arm"`.
pub fn natural(what: &str, quantity: &'static str, value: i64) -> PyResult<usize> {
    usize::try_from(value).map_err(|_| {
        error::model(ModelError::Negative {
            what: what.into(),
            quantity,
            value: value as f64,
        })
    })
}

/// Kinds of shapes, a bit each.
pub fn mask(what: &str, quantity: &'static str, value: i64) -> PyResult<u32> {
    u32::try_from(value).map_err(|_| {
        error::model(ModelError::OutsideRange {
            what: what.into(),
            quantity,
            value: value as f64,
            lower: 0.0,
            upper: f64::from(u32::MAX),
        })
    })
}
