//! Numbers that an argument needs, refused by its name where others are given.

use crate::error;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::prelude::*;

/// Longest text of what is told to have been given.
const LONGEST: usize = 80;

/// N numbers; `what` is the argument, as in `box: half`.
pub fn vector<'py, T, const N: usize>(what: &str, given: &Bound<'py, PyAny>) -> PyResult<[T; N]>
where
    [T; N]: FromPyObjectOwned<'py>,
{
    read(what, given, &format!("{N} numbers"))
}

/// The same where it may be left out.
pub fn vector_or<'py, T, const N: usize>(
    what: &str,
    given: Option<&Bound<'py, PyAny>>,
    else_: [T; N],
) -> PyResult<[T; N]>
where
    [T; N]: FromPyObjectOwned<'py>,
{
    given.map_or(Ok(else_), |given| vector(what, given))
}

/// What an argument needs, as in "rows of 3 numbers". `ShapeError` where it is given something else.
pub fn read<'py, T: FromPyObjectOwned<'py>>(
    what: &str,
    given: &Bound<'py, PyAny>,
    needs: &str,
) -> PyResult<T> {
    given.extract().map_err(|_| {
        let message = format!("{what} is {}: give {needs}", told(given));
        error::raise("ShapeError", message)
    })
}

/// What was given: of arrays the shape and the dtype, of all else as much as fits in a line.
fn told(given: &Bound<'_, PyAny>) -> String {
    if let (Ok(shape), Ok(dtype)) = (given.getattr("shape"), given.getattr("dtype")) {
        return format!("an array of the shape {shape} and dtype {dtype}");
    }
    let text = given.repr().map(|text| text.to_string());
    let text = text.unwrap_or_else(|_| "something without a text".into());
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", &text[..end]),
        None => text,
    }
}
