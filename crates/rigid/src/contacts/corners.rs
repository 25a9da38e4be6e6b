//! The corners of hulls as rows of a table.

use crate::tables::Filler;
use glam::DVec3;
use model::{Geometry, Hull, TriangleMesh};
use numbers::Table;
use numbers::machine::space::Parameter;
use std::ops::Range;

/// Hulls and the hulls of meshes, equal ones once.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Corners {
    known: Vec<Outline>,
}

/// The corners of one.
#[derive(Clone, Debug, PartialEq)]
struct Outline {
    geometry: Geometry,
    /// From the geometry's centre [m].
    arms: Vec<DVec3>,
    /// The rows they take.
    rows: Range<usize>,
}

impl Corners {
    /// Of some hulls and meshes, with `room` for a number of corners.
    pub fn new<'a>(
        geometries: impl Iterator<Item = &'a Geometry>,
        room: impl Fn(usize) -> usize,
    ) -> Self {
        let mut corners = Self::default();
        for geometry in geometries {
            if corners.of(geometry).is_empty() {
                let (first, arms) = (corners.rows(), arms(geometry));
                let rows = first..first + room(arms.len());
                let geometry = geometry.clone();
                corners.known.push(Outline {
                    geometry,
                    arms,
                    rows,
                });
            }
        }
        corners
    }
    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.known.last().map_or(0, |outline| outline.rows.end)
    }
    /// The rows of a geometry; none of what was not given.
    pub fn of(&self, geometry: &Geometry) -> Range<usize> {
        let known = self.known.iter().find(|known| known.geometry == *geometry);
        known.map_or(0..0, |outline| outline.rows.clone())
    }
    /// Writes the corners; rows to spare repeat them, and are never farther than the first of their kind.
    pub fn fill(&self, table: Table<Parameter, 3>, f: &mut Filler) {
        for outline in &self.known {
            for (row, arm) in outline.rows.clone().zip(outline.arms.iter().cycle()) {
                f.vec3(table, row, 0, *arm);
            }
        }
    }
}

/// The corners of a geometry from its centre [m]; none of what is neither hull nor mesh.
fn arms(geometry: &Geometry) -> Vec<DVec3> {
    match geometry {
        Geometry::Hull(hull) => hull.arms().collect(),
        Geometry::Mesh(mesh) => {
            let corners = outermost(mesh).into_iter();
            corners.map(|corner| corner - mesh.center()).collect()
        }
        _ => Vec::new(),
    }
}

/// The vertices of a mesh that can be the farthest in some direction; all of those that have no convex
/// hull, such as those of one plane.
fn outermost(mesh: &TriangleMesh) -> Vec<DVec3> {
    let mut used = Vec::from_iter(mesh.triangles().iter().flatten());
    used.sort_unstable();
    used.dedup();
    let used = Vec::from_iter(used.into_iter().map(|v| mesh.vertices()[*v as usize]));
    match Hull::new(&used) {
        Ok(hull) => hull.vertices().to_vec(),
        Err(_) => used,
    }
}
