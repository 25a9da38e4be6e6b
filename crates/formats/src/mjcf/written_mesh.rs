//! Meshes whose points are written in the file (XML reference, "asset/mesh", attributes `vertex` and `face`).

use crate::error::FormatError;
use crate::meshes::broken;
use crate::xml::Element;
use collide::mesh;
use glam::DVec3;
use model::{Geometry, Hull};

/// The surface, scaled; without faces, the convex hull of the points.
pub(super) fn read(element: &Element, scale: DVec3) -> Result<Geometry, FormatError> {
    let vertices: Vec<_> = triples(element, "vertex")?
        .into_iter()
        .map(DVec3::from_array)
        .collect();
    if element.has("face") {
        let surface = mesh::scaled(&vertices, &faces(element)?, scale);
        let surface = surface.map_err(|problem| broken(element, problem.to_string()))?;
        return Ok(Geometry::Mesh(surface));
    }
    let points: Vec<_> = vertices.iter().map(|v| *v * scale).collect();
    let hull = Hull::new(&points).map_err(|problem| broken(element, problem.to_string()))?;
    Ok(Geometry::Hull(hull))
}

/// Numbers of vertices, from 0.
fn faces(element: &Element) -> Result<Vec<[u32; 3]>, FormatError> {
    let given = triples(element, "face")?;
    let is_number = |x: &f64| x.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(x);
    if let Some(x) = given.as_flattened().iter().find(|x| !is_number(x)) {
        let problem = format!("holds {x}, which numbers no vertex");
        return Err(element.invalid_attribute("face", &problem, "count the vertices from 0"));
    }
    let numbers = |face: [f64; 3]| face.map(|x| x as u32);
    Ok(given.into_iter().map(numbers).collect())
}

fn triples(element: &Element, name: &str) -> Result<Vec<[f64; 3]>, FormatError> {
    let numbers = element.list(name, 3, usize::MAX)?.unwrap_or_default();
    let (triples, rest) = numbers.as_chunks::<3>();
    if rest.is_empty() {
        return Ok(triples.to_vec());
    }
    let problem = format!("holds {} numbers", numbers.len());
    Err(element.invalid_attribute(name, &problem, "write three for each"))
}
