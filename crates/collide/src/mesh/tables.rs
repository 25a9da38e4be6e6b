//! A mesh as tables, and the contacts found on it.

use super::adjacency::{Sides, sides, spreads};
use super::hierarchy::{Bounds, fan, order};
use super::matter::behind;
use glam::DVec3;
use model::TriangleMesh;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch};
use numbers::{Float, Table};
use std::ops::Range;

/// Contacts kept of a solid and a mesh, or of two meshes: those farthest in the corners of a frame, and
/// the deepest.
pub const SLOTS: usize = CORNERS + 1;
/// Corners of a frame.
pub(super) const CORNERS: usize = 8;
/// The row after them: a contact of what is behind a triangle, to be taken where there is no other.
pub(super) const BEHIND: usize = SLOTS;

/// Fields of a contact in [`MeshTables::contacts`]; as in [`Contact`](crate::Contact), in world axes.
pub mod contact {
    /// Position [m].
    pub const POSITION: usize = 0;
    /// Unit vector from the solid to the mesh.
    pub const NORMAL: usize = 3;
    /// Distance [m].
    pub const DISTANCE: usize = 6;
    /// Feature.
    pub const FEATURE: usize = 7;
    /// What the contact was chosen by.
    pub(crate) const SCORE: usize = 8;
    /// How many fields.
    pub const WIDTH: usize = 9;
}

/// Fields of [`MeshTables::search`]: what is known of a solid on its mesh while its triangles are looked through.
pub(super) mod search {
    /// 1 where the solid's core overlaps a triangle.
    pub const PIERCED: usize = 0;
    /// Of the triangles that the core overlaps, and that have a contact, the normal of the least deep.
    pub const NORMAL: usize = 1;
    /// The gap along it [m].
    pub const GAP: usize = 4;
    /// 1 where all triangles are looked through once more, since another contact is far deeper.
    pub const AGAIN: usize = 5;
    pub const WIDTH: usize = 6;
}

/// Bounds: low, high.
pub const BOUNDS: usize = 6;
/// A triangle: bounds, middle, normal, (out, lean) of three edges, number, cosine and sine of how far a
/// contact's normal may be off its own.
pub const TRIANGLE: usize = 6 + 3 + 3 + 12 + 1 + 2;
/// Where the number is.
pub const NUMBER: usize = 24;
/// How many triangles can be told apart, with 64 features each, in single precision.
pub(super) const NUMBERS: f64 = 262_144.0;
/// Vertices of a triangle: its corners, and a point behind it.
pub const VERTICES: usize = 4;
/// Beyond all coordinates [m].
pub const BEYOND: f64 = 1e30;

/// Where meshes, and the contacts with one of them, lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeshTables {
    pub(super) groups: Table<Parameter, BOUNDS>,
    pub(super) clusters: Table<Parameter, BOUNDS>,
    pub(super) triangles: Table<Parameter, TRIANGLE>,
    /// The range of a group's clusters.
    pub(super) group_rows: Links<2>,
    /// The range of a cluster's triangles.
    pub(super) cluster_rows: Links<2>,
    /// The range of a triangle's corners; the vertex after them is a point of the matter behind it.
    pub(super) triangle_rows: Links<2>,
    /// The contacts last found, [`SLOTS`] rows; see [`contact`].
    pub contacts: Table<Scratch, { contact::WIDTH }>,
    pub(super) search: Table<Scratch, { search::WIDTH }>,
}

/// A triangle of a mesh as the kernels read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    numbers: [f64; TRIANGLE],
    /// Its corners and a point of the matter behind it, from its middle [m].
    vertices: [f64; 3 * VERTICES],
}

impl Triangle {
    /// Those of a mesh, about the [middle](TriangleMesh::center) of its box.
    pub fn all(mesh: &TriangleMesh) -> Vec<Self> {
        Self::ordered(mesh, &order(mesh))
    }

    /// The same, where their order in space is known.
    fn ordered(mesh: &TriangleMesh, order: &[usize]) -> Vec<Self> {
        let behind = behind(mesh, order, fan(order.len()));
        let sides = sides(mesh);
        let parts = sides.iter().zip(spreads(mesh, &sides)).zip(behind);
        let triangle = |(t, ((sides, spread), behind))| Self::new(mesh, t, sides, spread, behind);
        parts.enumerate().map(triangle).collect()
    }

    fn new(
        mesh: &TriangleMesh,
        t: usize,
        (normal, edges): &Sides,
        spread: f64,
        behind: DVec3,
    ) -> Self {
        let corners = mesh.corners(t).map(|c| c - mesh.center());
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let Bounds { low, high } = Bounds::of(corners);
        let mut numbers = [0.0; TRIANGLE];
        for (i, v) in [low, high, middle, *normal].into_iter().enumerate() {
            numbers[3 * i..3 * i + 3].copy_from_slice(&v.to_array());
        }
        for (i, edge) in edges.iter().enumerate() {
            numbers[12 + 4 * i..15 + 4 * i].copy_from_slice(&edge.out.to_array());
            numbers[15 + 4 * i] = edge.lean;
        }
        let sine = (1.0 - spread * spread).sqrt();
        numbers[NUMBER..].copy_from_slice(&[t as f64, spread, sine]);
        let mut vertices = [0.0; 3 * VERTICES];
        let [a, b, c] = corners;
        for (i, vertex) in [a, b, c, behind - mesh.center()].into_iter().enumerate() {
            vertices[3 * i..3 * i + 3].copy_from_slice(&(vertex - middle).to_array());
        }
        Self { numbers, vertices }
    }

    /// Its numbers as [`MeshTables::put`] writes them: [`TRIANGLE`] of them, and its vertices.
    pub fn numbers(&self) -> impl Iterator<Item = f64> {
        self.numbers.into_iter().chain(self.vertices)
    }

    /// The box that holds it: lowest and highest corner [m].
    pub fn bounds(&self) -> [DVec3; 2] {
        [0, 3].map(|i| DVec3::from_slice(&self.numbers[i..]))
    }

    /// Its corners [m].
    pub(super) fn corners(&self) -> [DVec3; 3] {
        let middle = DVec3::from_slice(&self.numbers[6..]);
        [0, 3, 6].map(|i| middle + DVec3::from_slice(&self.vertices[i..]))
    }

    /// The box that holds it and the matter behind it.
    fn with_matter(&self) -> Bounds {
        let vector = |at: usize| DVec3::from_slice(&self.numbers[at..]);
        let [low, high, middle] = [0, 3, 6].map(vector);
        let behind = middle + DVec3::from_slice(&self.vertices[9..]);
        Bounds { low, high }.and(Bounds::of([behind]))
    }

    pub(super) fn normal(&self) -> DVec3 {
        DVec3::from_slice(&self.numbers[9..])
    }

    /// Unit vectors out of it in its plane, across the edges from each corner to the next.
    pub(super) fn edges(&self) -> [DVec3; 3] {
        [12, 16, 20].map(|i| DVec3::from_slice(&self.numbers[i..]))
    }
}

/// Meshes put together for the kernels.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MeshData {
    groups: Vec<Bounds>,
    clusters: Vec<Bounds>,
    triangles: Vec<Triangle>,
    group_rows: Vec<[usize; 2]>,
    cluster_rows: Vec<[usize; 2]>,
}

impl MeshData {
    /// Adds a mesh, about the [middle](TriangleMesh::center) of its box; answers the range of its
    /// groups, by which kernels know it.
    pub fn add(&mut self, mesh: &TriangleMesh) -> [usize; 2] {
        let (order, fan) = (order(mesh), fan(mesh.triangles().len()));
        let triangles = Triangle::ordered(mesh, &order);
        let around = |list: &[usize]| Bounds::all(list.iter().map(|&t| triangles[t].with_matter()));
        let first_group = self.groups.len();
        for group in order.chunks(fan * fan) {
            let first_cluster = self.clusters.len();
            for cluster in group.chunks(fan) {
                let first = self.triangles.len();
                self.triangles.extend(cluster.iter().map(|&t| triangles[t]));
                self.cluster_rows.push([first, self.triangles.len()]);
                self.clusters.push(around(cluster));
            }
            self.group_rows.push([first_cluster, self.clusters.len()]);
            self.groups.push(around(group));
        }
        [first_group, self.groups.len()]
    }

    /// Room for meshes of so many triangles, which are all searched: they are [put](MeshTables::put)
    /// there later, for each lane its own. Each mesh that has room is one group.
    pub fn room(triangles: &[usize]) -> Self {
        let everywhere = Bounds {
            low: DVec3::splat(-BEYOND),
            high: DVec3::splat(BEYOND),
        };
        let mut nowhere = [0.0; TRIANGLE];
        nowhere[..BOUNDS].copy_from_slice(&NOWHERE);
        let nowhere = Triangle {
            numbers: nowhere,
            vertices: [0.0; 3 * VERTICES],
        };
        let mut data = Self::default();
        for (i, &room) in triangles.iter().filter(|room| **room > 0).enumerate() {
            let first = data.triangles.len();
            data.triangles.resize(first + room, nowhere);
            data.clusters.push(everywhere);
            data.cluster_rows.push([first, first + room]);
            data.groups.push(everywhere);
            data.group_rows.push([i, i + 1]);
        }
        data
    }

    /// Boxes of groups, and the range of each one's clusters.
    pub fn groups(&self) -> impl ExactSizeIterator<Item = ([f64; BOUNDS], [usize; 2])> {
        let boxes = self.groups.iter().map(Bounds::numbers);
        boxes.zip(self.group_rows.iter().copied())
    }
    /// Boxes of clusters, and the range of each one's triangles.
    pub fn clusters(&self) -> impl ExactSizeIterator<Item = ([f64; BOUNDS], [usize; 2])> {
        let boxes = self.clusters.iter().map(Bounds::numbers);
        boxes.zip(self.cluster_rows.iter().copied())
    }
    /// The triangles of all meshes, cluster by cluster.
    pub fn triangles(&self) -> &[Triangle] {
        &self.triangles
    }

    /// How many rows of [`Tables::vertices`](crate::Tables::vertices) the triangles take.
    pub fn vertex_rows(&self) -> usize {
        VERTICES * self.triangles.len()
    }

    /// Room at the ends of the memories, which move on.
    pub fn place(
        &self,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> MeshTables {
        // Contacts are kept where there is a mesh.
        let kept = usize::from(!self.groups.is_empty());
        MeshTables {
            groups: Table::place(parameters, self.groups.len()),
            clusters: Table::place(parameters, self.clusters.len()),
            triangles: Table::place(parameters, self.triangles.len()),
            group_rows: Links::place(links, self.groups.len()),
            cluster_rows: Links::place(links, self.clusters.len()),
            triangle_rows: Links::place(links, self.triangles.len()),
            contacts: Table::place(scratch, kept * (SLOTS + 1)),
            search: Table::place(scratch, kept),
        }
    }

    /// Writes the meshes where `tables` has room for them, and their vertices from `vertex_row` on.
    ///
    /// Panics where the memories are shorter than what was placed.
    pub fn write(
        &self,
        tables: &MeshTables,
        vertices: Table<Parameter, 3>,
        vertex_row: usize,
        parameters: &mut [f64],
        links: &mut [u32],
    ) {
        for (row, b) in self.groups.iter().enumerate() {
            parameters[tables.groups.at(row, 0)..][..BOUNDS].copy_from_slice(&b.numbers());
        }
        for (row, b) in self.clusters.iter().enumerate() {
            parameters[tables.clusters.at(row, 0)..][..BOUNDS].copy_from_slice(&b.numbers());
        }
        for (row, t) in self.triangles.iter().enumerate() {
            let first = vertex_row + VERTICES * row;
            parameters[tables.triangles.at(row, 0)..][..TRIANGLE].copy_from_slice(&t.numbers);
            parameters[vertices.at(first, 0)..][..t.vertices.len()].copy_from_slice(&t.vertices);
            write_range(links, tables.triangle_rows, row, [first, first + 3]);
        }
        for (row, range) in self.group_rows.iter().enumerate() {
            write_range(links, tables.group_rows, row, *range);
        }
        for (row, range) in self.cluster_rows.iter().enumerate() {
            write_range(links, tables.cluster_rows, row, *range);
        }
    }
}

/// The bounds of what meets nothing.
const NOWHERE: [f64; BOUNDS] = [BEYOND, BEYOND, BEYOND, -BEYOND, -BEYOND, -BEYOND];

impl MeshTables {
    /// Where the boxes of groups, those of clusters, and triangles begin.
    pub fn places(&self) -> [usize; 3] {
        [
            self.groups.start(),
            self.clusters.start(),
            self.triangles.start(),
        ]
    }

    /// Writes the triangles of one lane into rows where [`MeshData::room`] left room for them, and their
    /// vertices, of which those of row 0 begin at `vertex_row`; what they leave free meets nothing.
    ///
    /// Panics where there are more than there is room for.
    pub fn put<'a, T: Float>(
        &self,
        triangles: impl Iterator<Item = &'a Triangle>,
        rows: Range<usize>,
        (vertices, vertex_row): (Table<Parameter, 3>, usize),
        (lane, width): (usize, usize),
        parameters: &mut [T],
    ) {
        let mut write = |at: usize, numbers: &[f64]| {
            for (i, x) in numbers.iter().enumerate() {
                parameters[(at + i) * width + lane] = T::from_f64(*x);
            }
        };
        let mut free = rows.clone();
        for t in triangles {
            let row = free.next();
            let row = row.unwrap_or_else(|| panic!("{} triangles fit", rows.len()));
            write(self.triangles.at(row, 0), &t.numbers);
            write(vertices.at(vertex_row + VERTICES * row, 0), &t.vertices);
        }
        for row in free {
            write(self.triangles.at(row, 0), &NOWHERE);
        }
    }
}

fn write_range(links: &mut [u32], rows: Links<2>, row: usize, range: [usize; 2]) {
    for (i, x) in range.into_iter().enumerate() {
        links[rows.at(row, i)] = x as u32;
    }
}
