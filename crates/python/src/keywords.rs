//! Keywords of calls that make or change something.

use crate::error;
use crate::geometry::{self, pose};
use crate::names::unknown;
use crate::vector::{self, vector};
use kinetarium::model::Pose;
use pyo3::conversion::FromPyObjectOwned;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Keywords as they were given; `None` is as if there were none.
pub struct Keywords<'a, 'py> {
    /// What they are for, as in `joint "hinge"`.
    what: &'a str,
    options: Option<&'a Bound<'py, PyDict>>,
}

impl<'a, 'py> Keywords<'a, 'py> {
    /// All are known. `kind` is of what kind they are, as in "option of joints".
    pub fn new(
        what: &'a str,
        kind: &str,
        known: &[&str],
        options: Option<&'a Bound<'py, PyDict>>,
    ) -> PyResult<Self> {
        for name in options.into_iter().flat_map(|options| options.keys()) {
            let name: String = name.extract()?;
            if !known.contains(&name.as_str()) {
                return Err(unknown(kind, &name, known));
            }
        }
        Ok(Self { what, options })
    }
    pub fn read<T>(
        &self,
        name: &str,
        read: impl FnOnce(&Bound<'py, PyAny>) -> PyResult<T>,
    ) -> PyResult<Option<T>> {
        let value = match self.options {
            Some(options) => options.get_item(name)?,
            None => None,
        };
        let Some(value) = value.filter(|value| !value.is_none()) else {
            return Ok(None);
        };
        let read = read(&value).map_err(|e| {
            let why = e.value(value.py());
            PyTypeError::new_err(format!("{}: option {name}: {why}", self.what))
        });
        Ok(Some(read?))
    }
    pub fn get<T: FromPyObjectOwned<'py>>(&self, name: &str) -> PyResult<Option<T>> {
        self.read(name, |value| value.extract().map_err(Into::into))
    }
    /// Numbers of which it needs so many, as in "3 numbers".
    pub fn numbers<T: FromPyObjectOwned<'py>>(
        &self,
        name: &str,
        needs: &str,
    ) -> PyResult<Option<T>> {
        let given = self.get::<Bound<'py, PyAny>>(name)?;
        let what = format!("{}: option {name}", self.what);
        let numbers = given.map(|given| vector::read(&what, &given, needs));
        numbers.transpose()
    }
    /// Whether it was given, as `None`.
    pub fn is_taken_away(&self, name: &str) -> PyResult<bool> {
        let value = self.options.map(|options| options.get_item(name));
        let value = value.transpose()?.flatten();
        Ok(value.is_some_and(|value| value.is_none()))
    }
    /// Where it is in the object.
    pub fn place(&self) -> PyResult<Place> {
        let orientation = self.numbers("orientation", "4 numbers, x, y, z, w")?;
        let turned = |quaternion| geometry::orientation(self.what, quaternion);
        Ok(Place {
            position: self.numbers("position", "3 numbers")?,
            orientation: orientation.map(turned).transpose()?,
        })
    }
    /// Position and orientation in a frame of its own.
    pub fn frame(&self, name: &str) -> PyResult<Option<Pose>> {
        let needs = "a position and a quaternion";
        let Some([position, quaternion]) = self.numbers::<[Bound<'py, PyAny>; 2]>(name, needs)?
        else {
            return Ok(None);
        };
        let what = format!("{}: option {name}", self.what);
        let position = vector(&format!("{what}: position"), &position)?;
        let quaternion = vector(&format!("{what}: quaternion"), &quaternion)?;
        let orientation = geometry::orientation(self.what, quaternion)?;
        Ok(Some(pose(position, orientation)))
    }
    pub fn refused(&self, why: &str) -> PyErr {
        error::value(format!("{}: {why}", self.what))
    }
}

/// Position and orientation, each as far as given.
#[derive(Clone, Copy)]
pub struct Place {
    position: Option<[f64; 3]>,
    orientation: Option<[f64; 4]>,
}

impl Place {
    pub fn is_given(&self) -> bool {
        self.position.is_some() || self.orientation.is_some()
    }
    /// What is not given stays.
    pub fn moved(self, from: Pose) -> Pose {
        let position = self.position.unwrap_or(from.position.to_array());
        let orientation = self.orientation.unwrap_or(from.orientation.to_array());
        pose(position, orientation)
    }
}
