//! Triangle meshes: a surface, not a solid, that is touched from the side its normals point to.

mod adjacency;
#[cfg(feature = "decomposition")]
mod decomposition;
mod distance_field;
#[cfg(feature = "gltf")]
mod glb;
mod hierarchy;
mod kernel;
#[cfg(feature = "meshes")]
mod load;
mod tables;

pub use distance_field::DistanceFieldError;
pub use kernel::{Surface, mesh_convex};
#[cfg(feature = "meshes")]
pub use load::LoadError;
pub use tables::{MeshData, MeshTables, SLOTS, contact};

use glam::DVec3;
use model::{Hull, HullError};

/// Triangles over shared vertices, counter-clockwise as seen from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleMesh {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

/// Why points and triples of them are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// There is nothing to touch.
    #[error("the mesh has no triangles: give at least one")]
    Empty,
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} of the mesh is at {position}: give finite coordinates")]
    NotFinite {
        /// Which vertex.
        vertex: usize,
        /// Its coordinates.
        position: DVec3,
    },
    /// A triangle has a vertex that does not exist.
    #[error(
        "triangle {triangle} of the mesh has the vertex {vertex}, but there are {vertices}, \
         counted from 0"
    )]
    NoSuchVertex {
        /// Which triangle.
        triangle: usize,
        /// Its vertex.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// All triangles are without area.
    #[error("all {triangles} triangles of the mesh are without area: check its units and scale")]
    NoArea {
        /// How many.
        triangles: usize,
    },
    /// Features could not be numbered exactly.
    #[error(
        "the mesh has {triangles} triangles, and at most {most} can be told apart: simplify it"
    )]
    TooMany {
        /// How many.
        triangles: usize,
        /// How many there may be.
        most: usize,
    },
}

/// Triangles that whole numbers of single precision can tell apart, with 64 features each.
const MOST: usize = 1 << 18;

impl TriangleMesh {
    /// From vertices [m] and triples of their numbers. Triangles without area are dropped, and
    /// vertices at the same place become one.
    ///
    /// # Errors
    /// Numbers that are not finite, vertices that do not exist, nothing left to touch, or more
    /// triangles than can be told apart.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        if let Some(vertex) = vertices.iter().position(|v| !v.is_finite()) {
            let position = vertices[vertex];
            return Err(MeshError::NotFinite { vertex, position });
        }
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                let vertices = vertices.len();
                return Err(MeshError::NoSuchVertex {
                    triangle,
                    vertex,
                    vertices,
                });
            }
        }
        let (welded, numbers) = adjacency::weld(vertices);
        let size = extent(&welded);
        let kept: Vec<_> = triangles
            .iter()
            .map(|t| t.map(|v| numbers[v as usize]))
            .filter(|t| area_vector(&welded, t).length() > 1e-12 * size * size)
            .collect();
        match (triangles.len(), kept.len()) {
            (0, _) => Err(MeshError::Empty),
            (triangles, 0) => Err(MeshError::NoArea { triangles }),
            (_, triangles) if triangles > MOST => Err(MeshError::TooMany {
                triangles,
                most: MOST,
            }),
            _ => Ok(Self {
                vertices: welded,
                triangles: kept,
            }),
        }
    }

    /// A height field: `heights[row][column]` [m] along y at x = column · spacing, z = row · spacing,
    /// from the middle of the field; touched from above.
    ///
    /// # Errors
    /// Fewer than two rows or columns, rows of different lengths, or heights that are not finite.
    pub fn height_field(heights: &[Vec<f64>], spacing: f64) -> Result<Self, HeightFieldError> {
        let (rows, columns) = (heights.len(), heights.first().map_or(0, Vec::len));
        if rows < 2 || columns < 2 {
            return Err(HeightFieldError::TooSmall { rows, columns });
        }
        if let Some(row) = heights.iter().position(|r| r.len() != columns) {
            let found = heights[row].len();
            return Err(HeightFieldError::Ragged {
                row,
                found,
                columns,
            });
        }
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(HeightFieldError::Spacing(spacing));
        }
        let middle = |n: usize| (n - 1) as f64 / 2.0;
        let mut vertices = Vec::new();
        for (row, heights) in heights.iter().enumerate() {
            for (column, &height) in heights.iter().enumerate() {
                let x = (column as f64 - middle(columns)) * spacing;
                let z = (row as f64 - middle(rows)) * spacing;
                vertices.push(DVec3::new(x, height, z));
            }
        }
        let mut triangles = Vec::new();
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let a = (row * columns + column) as u32;
                let (b, c) = (a + 1, a + columns as u32);
                triangles.extend([[a, c, b], [b, c, c + 1]]);
            }
        }
        Ok(Self::new(&vertices, &triangles)?)
    }

    /// The convex hull of all vertices: what was hollow is filled.
    ///
    /// # Errors
    /// A mesh that lies in one plane, a hull of too many corners.
    pub fn convex_hull(&self) -> Result<Hull, HullError> {
        Hull::new(&self.vertices)
    }

    /// The vertices [m].
    pub fn vertices(&self) -> &[DVec3] {
        &self.vertices
    }
    /// The triangles, as numbers of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }
}

/// Why heights are no height field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum HeightFieldError {
    /// Nothing lies between the samples.
    #[error("a height field of {rows} × {columns} samples has no area: give at least 2 × 2")]
    TooSmall {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// The rows differ.
    #[error("row {row} of the height field has {found} heights, the first one has {columns}")]
    Ragged {
        /// Which row.
        row: usize,
        /// Its length.
        found: usize,
        /// The first one's.
        columns: usize,
    },
    /// The distance of the samples.
    #[error("the height field's spacing is {0} m: give a positive number")]
    Spacing(f64),
    /// The heights.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

/// Largest side of the bounding box.
fn extent(vertices: &[DVec3]) -> f64 {
    let low = vertices.iter().copied().fold(DVec3::INFINITY, DVec3::min);
    let high = vertices
        .iter()
        .copied()
        .fold(DVec3::NEG_INFINITY, DVec3::max);
    (high - low).max_element()
}

/// Twice the area, along the normal.
fn area_vector(vertices: &[DVec3], triangle: &[u32; 3]) -> DVec3 {
    let [a, b, c] = triangle.map(|v| vertices[v as usize]);
    (b - a).cross(c - a)
}
