//! What is asked about shapes, and the answers as arrays.

use crate::count::mask;
use glam::{DQuat, DVec3};
use kinetarium::model::{BodyId, Model, Pose};
use kinetarium::sim::{Contact, QueryHit, RayHit, Seen};
use numpy::{PyArrayMethods, ToPyArray};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Which shapes are seen: colliding ones only, sensors too, of which kinds, of all bodies but these.
pub type Sight = (bool, bool, Option<i64>, Vec<usize>);

pub fn seen((colliding, sensors, membership, except): Sight) -> PyResult<Seen> {
    let membership = membership.map(|kinds| mask("query", "membership", kinds));
    Ok(Seen {
        membership: membership.transpose()?,
        colliding,
        sensors,
        except: except.into_iter().map(BodyId).collect(),
    })
}

/// Rows of three.
pub fn vectors(numbers: &[f64]) -> Vec<DVec3> {
    numbers.chunks_exact(3).map(DVec3::from_slice).collect()
}

/// Rows of three, and of x, y, z, w.
pub fn poses(positions: &[f64], orientations: &[f64]) -> Vec<Pose> {
    let turned = orientations.chunks_exact(4).map(DQuat::from_slice);
    let places = vectors(positions).into_iter().zip(turned);
    places.map(|(p, q)| Pose::new(p, q)).collect()
}

/// A row for each hit: distance [m] (infinite where nothing is hit), shape and body (−1 where none), position, normal.
pub fn rows<'py>(py: Python<'py>, hits: &[Option<QueryHit>]) -> PyResult<Bound<'py, PyDict>> {
    let n = hits.len();
    let number = |row: Option<usize>| row.map_or(-1, |row| row as i64);
    let distance = hits.iter().map(|h| h.map_or(f64::INFINITY, |h| h.distance));
    let shape = hits.iter().map(|h| number(h.map(|h| h.shape.0)));
    let body = hits.iter().map(|h| number(h.and_then(|h| Some(h.body?.0))));
    let vectors = |of: fn(&QueryHit) -> DVec3| {
        let vector = |hit: &Option<QueryHit>| hit.as_ref().map_or(DVec3::NAN, of).to_array();
        let flat: Vec<f64> = hits.iter().flat_map(vector).collect();
        flat.to_pyarray(py).reshape([n, 3])
    };
    let arrays = PyDict::new(py);
    arrays.set_item("distance", Vec::from_iter(distance).to_pyarray(py))?;
    arrays.set_item("shape", Vec::from_iter(shape).to_pyarray(py))?;
    arrays.set_item("body", Vec::from_iter(body).to_pyarray(py))?;
    arrays.set_item("position", vectors(|hit| hit.position)?)?;
    arrays.set_item("normal", vectors(|hit| hit.normal)?)?;
    Ok(arrays)
}

/// The same of any number of hits a query, with the row of its query for each.
pub fn listed<'py>(py: Python<'py>, found: &[Vec<QueryHit>]) -> PyResult<Bound<'py, PyDict>> {
    let hits: Vec<_> = found.iter().flatten().map(|hit| Some(*hit)).collect();
    let query = found.iter().enumerate();
    let query = query.flat_map(|(i, hits)| std::iter::repeat_n(i as i64, hits.len()));
    let arrays = rows(py, &hits)?;
    arrays.set_item("query", Vec::from_iter(query).to_pyarray(py))?;
    Ok(arrays)
}

/// Where a ray meets a shape of a model.
pub fn met(hit: RayHit, model: &Model) -> QueryHit {
    QueryHit {
        shape: hit.shape,
        body: model.shapes[hit.shape.0].body,
        distance: hit.distance,
        position: hit.position,
        normal: hit.normal,
    }
}

/// A row for each contact: its world, and all that it is.
pub fn contacts<'py>(
    py: Python<'py>,
    contacts: &[(usize, Contact)],
) -> PyResult<Bound<'py, PyDict>> {
    let n = contacts.len();
    let vectors = |of: fn(&Contact) -> DVec3| {
        let flat = contacts.iter().flat_map(|(_, c)| of(c).to_array());
        Vec::from_iter(flat).to_pyarray(py).reshape([n, 3])
    };
    let world = contacts.iter().map(|(world, _)| *world as i64);
    let shapes = contacts.iter().flat_map(|(_, c)| c.shapes);
    let shapes = Vec::from_iter(shapes.map(|shape| shape.0 as i64));
    let distance = contacts.iter().map(|(_, c)| c.distance);
    let feature = contacts.iter().map(|(_, c)| c.feature);
    let arrays = PyDict::new(py);
    arrays.set_item("world", Vec::from_iter(world).to_pyarray(py))?;
    arrays.set_item("shapes", shapes.to_pyarray(py).reshape([n, 2])?)?;
    arrays.set_item("position", vectors(|c| c.position)?)?;
    arrays.set_item("normal", vectors(|c| c.normal)?)?;
    arrays.set_item("distance", Vec::from_iter(distance).to_pyarray(py))?;
    arrays.set_item("force", vectors(|c| c.force)?)?;
    arrays.set_item("torque", vectors(|c| c.torque)?)?;
    arrays.set_item("feature", Vec::from_iter(feature).to_pyarray(py))?;
    Ok(arrays)
}
