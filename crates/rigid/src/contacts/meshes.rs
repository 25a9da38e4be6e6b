//! The triangles of meshes as rows of tables.

use collide::mesh::MeshData;
use model::{Geometry, TriangleMesh};
use std::ops::Range;

/// Meshes, equal ones once, each with the range of its groups.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Meshes {
    known: Vec<(TriangleMesh, Range<usize>)>,
    pub data: MeshData,
}

impl Meshes {
    /// Of the meshes among some geometries.
    pub fn new<'a>(geometries: impl Iterator<Item = &'a Geometry>) -> Self {
        let mut meshes = Self::default();
        for geometry in geometries {
            if let Geometry::Mesh(mesh) = geometry
                && meshes.of(geometry).is_empty()
            {
                let [first, end] = meshes.data.add(mesh);
                meshes.known.push((mesh.clone(), first..end));
            }
        }
        meshes
    }
    /// The groups of a geometry; none of what is no mesh.
    pub fn of(&self, geometry: &Geometry) -> Range<usize> {
        let Geometry::Mesh(mesh) = geometry else {
            return 0..0;
        };
        let known = self.known.iter().find(|(known, _)| known == mesh);
        known.map_or(0..0, |(_, groups)| groups.clone())
    }
}
