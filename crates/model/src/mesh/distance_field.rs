//! A signed distance field, by the surface where it is zero.

use super::{MeshError, TriangleMesh};
use glam::DVec3;
use std::collections::HashMap;

/// Why samples are no distance field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DistanceFieldError {
    /// The numbers of samples do not fit.
    #[error(
        "a distance field of {} × {} × {} samples needs at least 2 along each axis and {} in all, \
         and {found} were given", .counts[0], .counts[1], .counts[2], .counts.iter().product::<usize>()
    )]
    Counts {
        /// Samples along x, y, z.
        counts: [usize; 3],
        /// Samples given.
        found: usize,
    },
    /// The distance of the samples.
    #[error("the distance field's spacing is {0} m: give a positive number")]
    Spacing(f64),
    /// A sample is infinite or not a number.
    #[error("sample {index} of the distance field is {value}: give finite distances")]
    NotFinite {
        /// Which, x running fastest, then y.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// The surface.
    #[error("the distance field has no surface: {0}; samples must lie on both sides of it")]
    Mesh(#[from] MeshError),
}

/// The six tetrahedra of a cube around its diagonal from corner 0 to corner 7, of positive
/// orientation; bit 0 of a corner is x, bit 1 is y, bit 2 is z. Neighbouring cubes share their faces'
/// diagonals, so that the surface has no gaps.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 3, 7],
    [0, 3, 2, 7],
    [0, 2, 6, 7],
    [0, 6, 4, 7],
    [0, 4, 5, 7],
    [0, 5, 1, 7],
];

impl TriangleMesh {
    /// The zero surface of a grid of signed distances [m], negative inside, x running fastest, then
    /// y, `spacing` [m] apart around the origin.
    ///
    /// Marching tetrahedra (Doi & Koide, An efficient method of triangulating equi-valued surfaces by
    /// using tetrahedral cells, IEICE Transactions E74, 1991): in a tetrahedron the field is taken as
    /// linear, and its zero plane cuts off one corner (a triangle) or two (two triangles).
    ///
    /// # Errors
    /// Numbers of samples that do not fit, distances that are not finite, or no surface.
    pub fn distance_field(
        counts: [usize; 3],
        spacing: f64,
        distances: &[f64],
    ) -> Result<Self, DistanceFieldError> {
        let found = distances.len();
        let fits = counts.iter().product::<usize>() == found;
        if !fits || counts.iter().any(|&n| n < 2) {
            return Err(DistanceFieldError::Counts { counts, found });
        }
        if !(spacing > 0.0 && spacing.is_finite()) {
            return Err(DistanceFieldError::Spacing(spacing));
        }
        if let Some(index) = distances.iter().position(|d| !d.is_finite()) {
            let value = distances[index];
            return Err(DistanceFieldError::NotFinite { index, value });
        }
        let mut grid = Grid {
            counts,
            spacing,
            distances,
            vertices: Vec::new(),
            cuts: HashMap::new(),
            triangles: Vec::new(),
        };
        for z in 0..counts[2] - 1 {
            for y in 0..counts[1] - 1 {
                for x in 0..counts[0] - 1 {
                    grid.cube(x, y, z);
                }
            }
        }
        Ok(Self::new(&grid.vertices, &grid.triangles)?)
    }
}

struct Grid<'a> {
    counts: [usize; 3],
    spacing: f64,
    distances: &'a [f64],
    vertices: Vec<DVec3>,
    /// The vertex on an edge between two samples.
    cuts: HashMap<(usize, usize), u32>,
    triangles: Vec<[u32; 3]>,
}

impl Grid<'_> {
    fn cube(&mut self, x: usize, y: usize, z: usize) {
        let [nx, ny, _] = self.counts;
        let corner = |c: usize| x + (c & 1) + nx * (y + (c >> 1 & 1) + ny * (z + (c >> 2)));
        for tetrahedron in TETRAHEDRA {
            self.tetrahedron(tetrahedron.map(corner));
        }
    }

    fn tetrahedron(&mut self, corners: [usize; 4]) {
        let inside: Vec<_> = (0..4)
            .filter(|&i| self.distances[corners[i]] < 0.0)
            .collect();
        // The other corners of the face across from a corner, so that it sees them clockwise.
        let others = |i: usize| match i {
            0 => [1, 2, 3],
            1 => [0, 3, 2],
            2 => [0, 1, 3],
            _ => [0, 2, 1],
        };
        let cut = |grid: &mut Self, i: usize, j: usize| grid.cut(corners[i], corners[j]);
        match inside[..] {
            [i] => {
                let t = others(i).map(|j| cut(self, i, j));
                self.triangles.push(t);
            }
            [i, j] => {
                // An even order i, j, k, l.
                let [k, l] = match (i, j) {
                    (0, 1) => [2, 3],
                    (0, 2) => [3, 1],
                    (0, 3) => [1, 2],
                    (1, 2) => [0, 3],
                    (1, 3) => [2, 0],
                    _ => [0, 1],
                };
                let [ik, il] = [cut(self, i, k), cut(self, i, l)];
                let [jk, jl] = [cut(self, j, k), cut(self, j, l)];
                self.triangles.extend([[ik, il, jl], [ik, jl, jk]]);
            }
            [_, _, _] => {
                let i = (0..4)
                    .find(|i| !inside.contains(i))
                    .expect("one is outside");
                let [a, b, c] = others(i).map(|j| cut(self, j, i));
                self.triangles.push([a, c, b]);
            }
            _ => {}
        }
    }

    /// The vertex where the field is zero between two samples of different sign.
    fn cut(&mut self, p: usize, q: usize) -> u32 {
        let (p, q) = (p.min(q), p.max(q));
        if let Some(&vertex) = self.cuts.get(&(p, q)) {
            return vertex;
        }
        let (a, b) = (self.distances[p], self.distances[q]);
        let place = self.place(p).lerp(self.place(q), a / (a - b));
        let vertex = self.vertices.len() as u32;
        self.vertices.push(place);
        self.cuts.insert((p, q), vertex);
        vertex
    }

    fn place(&self, sample: usize) -> DVec3 {
        let [nx, ny, nz] = self.counts;
        let at = |i: usize, n: usize| (i as f64 - (n - 1) as f64 / 2.0) * self.spacing;
        DVec3::new(
            at(sample % nx, nx),
            at(sample / nx % ny, ny),
            at(sample / nx / ny, nz),
        )
    }
}
