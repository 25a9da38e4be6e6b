//! What a body looks like on a page.

use crate::error;
use pyo3::prelude::*;
use session::{SkinError, SkinFile};
use std::path::PathBuf;

/// What a body looks like on a page; made by `kinetarium.Skin`.
#[pyclass(frozen, module = "kinetarium._engine")]
pub struct Skin(pub session::Skin);

#[pymethods]
impl Skin {
    /// One colour and opacity, sRGB, each from 0 to 1.
    #[staticmethod]
    fn color(red: f32, green: f32, blue: f32, opacity: f32) -> PyResult<Self> {
        let skin = session::Skin::Color([red, green, blue, opacity]);
        skin.check().map_err(raise)?;
        Ok(Self(skin))
    }
    /// One that has a name.
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        session::Skin::named(name).map(Self).map_err(raise)
    }
    /// A picture or a model in a file, fitted to the body's shapes or as large as in the file.
    #[staticmethod]
    fn file(py: Python<'_>, path: PathBuf, fitted: bool) -> PyResult<Self> {
        let file = py.detach(|| SkinFile::read(path)).map_err(raise)?;
        Ok(Self(session::Skin::File { file, fitted }))
    }
}

/// A skin that cannot be, or a body that is not there.
pub fn raise(error: SkinError) -> PyErr {
    let class = match error {
        SkinError::Body(_) | SkinError::Name { .. } => "UnknownNameError",
        SkinError::Color { .. } => "SkinError",
        SkinError::Read { .. } | SkinError::Format { .. } | SkinError::Long { .. } => "FileError",
    };
    error::raise(class, error.to_string())
}
