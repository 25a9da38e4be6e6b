//! A mesh as tables, and the contacts found on it.

use super::TriangleMesh;
use super::adjacency::sides;
use super::hierarchy::{Bounds, bounds, fan, order};
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch};

/// Contacts kept of a solid and a mesh.
pub const SLOTS: usize = 8;

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

/// Bounds: low, high.
pub(super) const BOUNDS: usize = 6;
/// A triangle: bounds, middle, normal, (out, lean) of three edges, number.
pub(super) const TRIANGLE: usize = 6 + 3 + 3 + 12 + 1;

/// Where meshes, and the contacts with one of them, lie.
#[derive(Clone, Copy, Debug)]
pub struct MeshTables {
    pub(super) groups: Table<Parameter, BOUNDS>,
    pub(super) clusters: Table<Parameter, BOUNDS>,
    pub(super) triangles: Table<Parameter, TRIANGLE>,
    /// The range of a group's clusters.
    pub(super) group_rows: Links<2>,
    /// The range of a cluster's triangles.
    pub(super) cluster_rows: Links<2>,
    /// The range of a triangle's vertices.
    pub(super) triangle_rows: Links<2>,
    /// The contacts last found, [`SLOTS`] rows; see [`contact`].
    pub contacts: Table<Scratch, { contact::WIDTH }>,
}

/// Meshes put together for the kernels.
#[derive(Clone, Debug, Default)]
pub struct MeshData {
    groups: Vec<Bounds>,
    clusters: Vec<Bounds>,
    triangles: Vec<[f64; TRIANGLE]>,
    vertices: Vec<f64>,
    group_rows: Vec<[usize; 2]>,
    cluster_rows: Vec<[usize; 2]>,
}

impl MeshData {
    /// Adds a mesh; answers the range of its groups, by which kernels know it.
    pub fn add(&mut self, mesh: &TriangleMesh) -> [usize; 2] {
        let (order, fan) = (order(mesh), fan(mesh.triangles().len()));
        let sides = sides(mesh);
        let first_group = self.groups.len();
        for group in order.chunks(fan * fan) {
            let first_cluster = self.clusters.len();
            for cluster in group.chunks(fan) {
                let first = self.triangles.len();
                for &t in cluster {
                    self.add_triangle(mesh, t, &sides[t]);
                }
                self.cluster_rows.push([first, self.triangles.len()]);
                self.clusters
                    .push(Bounds::all(cluster.iter().map(|&t| bounds(mesh, t))));
            }
            self.group_rows.push([first_cluster, self.clusters.len()]);
            self.groups
                .push(Bounds::all(group.iter().map(|&t| bounds(mesh, t))));
        }
        [first_group, self.groups.len()]
    }

    fn add_triangle(
        &mut self,
        mesh: &TriangleMesh,
        t: usize,
        (normal, edges): &super::adjacency::Sides,
    ) {
        let corners = mesh.triangles()[t].map(|v| mesh.vertices()[v as usize]);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let Bounds { low, high } = bounds(mesh, t);
        let mut row = [0.0; TRIANGLE];
        for (i, v) in [low, high, middle, *normal].into_iter().enumerate() {
            row[3 * i..3 * i + 3].copy_from_slice(&v.to_array());
        }
        for (i, edge) in edges.iter().enumerate() {
            row[12 + 4 * i..15 + 4 * i].copy_from_slice(&edge.out.to_array());
            row[15 + 4 * i] = edge.lean;
        }
        row[TRIANGLE - 1] = t as f64;
        self.triangles.push(row);
        self.vertices
            .extend(corners.iter().flat_map(|c| (*c - middle).to_array()));
    }

    /// How many rows of [`Tables::vertices`](crate::Tables::vertices) the triangles take.
    pub fn vertex_rows(&self) -> usize {
        self.vertices.len() / 3
    }

    /// Room at the ends of the memories, which move on.
    pub fn place(
        &self,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> MeshTables {
        MeshTables {
            groups: Table::place(parameters, self.groups.len()),
            clusters: Table::place(parameters, self.clusters.len()),
            triangles: Table::place(parameters, self.triangles.len()),
            group_rows: Links::place(links, self.groups.len()),
            cluster_rows: Links::place(links, self.clusters.len()),
            triangle_rows: Links::place(links, self.triangles.len()),
            contacts: Table::place(scratch, SLOTS),
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
        let numbers = |b: &Bounds| [b.low.to_array(), b.high.to_array()].concat();
        for (row, b) in self.groups.iter().enumerate() {
            parameters[tables.groups.at(row, 0)..][..BOUNDS].copy_from_slice(&numbers(b));
        }
        for (row, b) in self.clusters.iter().enumerate() {
            parameters[tables.clusters.at(row, 0)..][..BOUNDS].copy_from_slice(&numbers(b));
        }
        for (row, t) in self.triangles.iter().enumerate() {
            parameters[tables.triangles.at(row, 0)..][..TRIANGLE].copy_from_slice(t);
            let first = vertex_row + 3 * row;
            write_range(links, tables.triangle_rows, row, [first, first + 3]);
        }
        for (row, range) in self.group_rows.iter().enumerate() {
            write_range(links, tables.group_rows, row, *range);
        }
        for (row, range) in self.cluster_rows.iter().enumerate() {
            write_range(links, tables.cluster_rows, row, *range);
        }
        parameters[vertices.at(vertex_row, 0)..][..self.vertices.len()]
            .copy_from_slice(&self.vertices);
    }
}

fn write_range(links: &mut [u32], rows: Links<2>, row: usize, range: [usize; 2]) {
    for (i, x) in range.into_iter().enumerate() {
        links[rows.at(row, i)] = x as u32;
    }
}
