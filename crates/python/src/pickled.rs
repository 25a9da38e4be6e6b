//! Values as bytes, for `pickle` and `copy`.

use crate::error;
use pyo3::PyClass;
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// What makes a value anew, and what it takes.
pub type Reduced<'py> = (Bound<'py, PyAny>, (Bound<'py, PyBytes>,));

/// For `__reduce__` of a class with a static method `_from_bytes`.
pub fn reduce<'py, C: PyClass>(
    object: &Bound<'py, C>,
    value: &impl Serialize,
) -> PyResult<Reduced<'py>> {
    let bytes = postcard::to_stdvec(value);
    let bytes = bytes.map_err(|e| error::value(format!("this cannot be written: {e}")))?;
    let make = object.as_any().get_type().getattr("_from_bytes")?;
    Ok((make, (PyBytes::new(object.py(), &bytes),)))
}

/// For `_from_bytes`.
pub fn restored<V: DeserializeOwned>(bytes: &[u8]) -> PyResult<V> {
    let read = postcard::from_bytes(bytes);
    read.map_err(|e| error::value(format!("these bytes hold nothing of this release: {e}")))
}
