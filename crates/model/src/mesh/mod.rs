//! Triangle meshes: a surface, not a solid, that is touched from the side its normals point to.

mod distance_field;
mod height_field;
mod rectangle;
mod revolution;

pub use distance_field::DistanceFieldError;
pub use height_field::HeightFieldError;

use crate::{Hull, HullError};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::collections::HashMap;
use std::sync::Arc;

/// Triangles over shared vertices, counter-clockwise as seen from outside, in the frame of their shape.
/// Copies share them.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "Triangles", into = "Triangles")]
pub struct TriangleMesh(Arc<Surface>);

/// As it is written.
#[derive(Serialize, Deserialize)]
struct Triangles {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
}

impl From<TriangleMesh> for Triangles {
    fn from(mesh: TriangleMesh) -> Self {
        Self {
            vertices: mesh.vertices().to_vec(),
            triangles: mesh.triangles().to_vec(),
        }
    }
}

impl TryFrom<Triangles> for TriangleMesh {
    type Error = MeshError;
    fn try_from(written: Triangles) -> Result<Self, MeshError> {
        Self::new(&written.vertices, &written.triangles)
    }
}

impl PartialEq for TriangleMesh {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0) || self.0 == other.0
    }
}

#[derive(Debug, PartialEq)]
struct Surface {
    vertices: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    low: DVec3,
    high: DVec3,
}

/// Why points and triples of them are no mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
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
    /// A vertex is farther away than anything that moves.
    #[error(
        "vertex {vertex} of the mesh is at {position}: stay within 1e9 m along each axis; check its \
         units and scale"
    )]
    TooFar {
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
    /// Too few points or steps to sweep a surface.
    #[error(
        "a surface of revolution of {points} points in {around} steps holds nothing: give at least 3 of each"
    )]
    Revolution {
        /// Of the profile.
        points: usize,
        /// Steps around.
        around: usize,
    },
    /// A rectangle without a size.
    #[error("the rectangle's half sizes are {half_x} and {half_z} m: give positive numbers")]
    Rectangle {
        /// Along x.
        half_x: f64,
        /// Along z.
        half_z: f64,
    },
    /// Features could not be numbered exactly.
    #[error(
        "the mesh has {triangles} triangles, and at most {most} can be told apart: simplify it, or cut \
         it in several"
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
/// Largest coordinate [m].
const FARTHEST: f64 = 1e9;

impl TriangleMesh {
    /// From vertices [m] and triples of their numbers. Triangles without area are dropped, and
    /// vertices at the same place become one.
    ///
    /// # Errors
    /// Numbers that are not finite or beyond 1e9 m, vertices that do not exist, nothing left to touch,
    /// or more than 262144 triangles.
    pub fn new(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<Self, MeshError> {
        check(vertices, triangles)?;
        let (welded, numbers) = weld(vertices);
        let [low, high] = bounds(welded.iter().copied());
        let size = (high - low).max_element();
        let has_area = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|v| welded[v as usize]);
            (b - a).cross(c - a).length() > 1e-12 * size * size
        };
        let numbered = triangles.iter().map(|t| t.map(|v| numbers[v as usize]));
        let kept: Vec<_> = numbered.filter(has_area).collect();
        match (triangles.len(), kept.len()) {
            (0, _) => Err(MeshError::Empty),
            (triangles, 0) => Err(MeshError::NoArea { triangles }),
            _ => Ok(Self(Arc::new(Surface::new(welded, kept)))),
        }
    }

    /// The convex hull of all vertices: what was hollow is filled.
    ///
    /// # Errors
    /// A mesh that lies in one plane, a hull of too many corners.
    pub fn convex_hull(&self) -> Result<Hull, HullError> {
        Hull::new(self.vertices())
    }

    /// The vertices [m].
    pub fn vertices(&self) -> &[DVec3] {
        &self.0.vertices
    }
    /// The triangles, as numbers of vertices.
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.0.triangles
    }
    /// The corners of a triangle [m].
    ///
    /// Panics where there is no such triangle.
    pub fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles()[triangle].map(|v| self.vertices()[v as usize])
    }
    /// The corners of each of the triangles [m].
    pub fn faces(&self) -> impl Iterator<Item = [DVec3; 3]> + Clone {
        (0..self.triangles().len()).map(|t| self.corners(t))
    }
    /// Whether the surface ends nowhere: along each edge of each triangle lies another one, turned the
    /// same way.
    pub fn is_closed(&self) -> bool {
        self.open_edges().is_empty()
    }
    /// Both ends [m] of each edge along which the surface is not [closed](Self::is_closed), in the order of the vertices.
    pub fn open_edges(&self) -> Vec<[DVec3; 2]> {
        let mut open = HashMap::new();
        for &[a, b, c] in self.triangles() {
            for [from, to] in [[a, b], [b, c], [c, a]] {
                let sign = if from < to { 1 } else { -1 };
                *open.entry([from.min(to), from.max(to)]).or_insert(0) += sign;
            }
        }
        let open = open.into_iter().filter(|(_, left)| *left != 0);
        let mut edges: Vec<[u32; 2]> = open.map(|(edge, _)| edge).collect();
        edges.sort_unstable();
        let ends = |edge: [u32; 2]| edge.map(|v| self.vertices()[v as usize]);
        edges.into_iter().map(ends).collect()
    }
    /// What the surface holds [m³], where it is [closed](Self::is_closed): the sum of a · (b × c)/6 over its faces, negative
    /// where they look inwards; zero where that is but rounding.
    pub fn volume(&self) -> f64 {
        let faces = self
            .faces()
            .map(|face| face.map(|corner| corner - self.center()));
        let volume: f64 = faces.map(|[a, b, c]| a.dot(b.cross(c)) / 6.0).sum();
        let least = 1e-12 * self.half_extents().max_element().powi(3);
        if volume.abs() > least { volume } else { 0.0 }
    }
    /// Unit vector out of the surface at a triangle.
    ///
    /// Panics where there is no such triangle.
    pub fn normal(&self, triangle: usize) -> DVec3 {
        let [a, b, c] = self.corners(triangle);
        (b - a).cross(c - a).normalize()
    }
    /// Middle of the box about its triangles, along the axes of its frame [m].
    pub fn center(&self) -> DVec3 {
        0.5 * (self.0.low + self.0.high)
    }
    /// Half of that box [m].
    pub fn half_extents(&self) -> DVec3 {
        0.5 * (self.0.high - self.0.low)
    }
}

fn check(vertices: &[DVec3], triangles: &[[u32; 3]]) -> Result<(), MeshError> {
    for (vertex, &position) in vertices.iter().enumerate() {
        if !position.is_finite() {
            return Err(MeshError::NotFinite { vertex, position });
        }
        if position.abs().max_element() > FARTHEST {
            return Err(MeshError::TooFar { vertex, position });
        }
    }
    if triangles.len() > MOST {
        let triangles = triangles.len();
        return Err(MeshError::TooMany {
            triangles,
            most: MOST,
        });
    }
    let vertices = vertices.len();
    for (triangle, corners) in triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
            return Err(MeshError::NoSuchVertex {
                triangle,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}

/// Vertices at the same place made one; the new number of each old vertex.
fn weld(vertices: &[DVec3]) -> (Vec<DVec3>, Vec<u32>) {
    let mut welded = Vec::new();
    let mut known = HashMap::new();
    let numbers = vertices
        .iter()
        .map(|v| {
            // −0 is 0.
            let place = (*v + DVec3::ZERO).to_array().map(f64::to_bits);
            *known.entry(place).or_insert_with(|| {
                welded.push(*v);
                welded.len() as u32 - 1
            })
        })
        .collect();
    (welded, numbers)
}

impl Surface {
    fn new(vertices: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let used = triangles.iter().flatten().map(|v| vertices[*v as usize]);
        let [low, high] = bounds(used);
        Self {
            vertices,
            triangles,
            low,
            high,
        }
    }
}

/// Lowest and highest corner of the box about points.
fn bounds(points: impl Iterator<Item = DVec3>) -> [DVec3; 2] {
    points.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[low, high], p| {
        [low.min(p), high.max(p)]
    })
}
