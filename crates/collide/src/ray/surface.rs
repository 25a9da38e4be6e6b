//! What rays meet of hulls and meshes, as rows of tables.
//!
//! A hull is the half spaces behind its faces. A mesh is its triangles, in the groups of clusters that
//! [`mesh`](crate::mesh) has them in, each of which is left out where no lane's ray passes its box.

use super::kernel::{ENDLESS, Line, Sheared, Span};
use super::line::{Face, faces};
use crate::mesh::hierarchy::{Bounds, bounds, fan, order};
use glam::DVec3;
use model::{Hull, TriangleMesh};
use numbers::machine::space::Parameter;
use numbers::machine::{Cell, Links};
use numbers::{Machine, Real, Table, Vec3};
use std::ops::Range;

/// A box: low, high.
const BOUNDS: usize = 6;
/// The corners of a triangle.
const CORNERS: usize = 9;
/// In single precision coordinates are off by so large a share of the largest; boxes are larger by it.
const ROUNDING: f64 = 1e-6;
/// Directions that are nearer to 0 along an axis are taken to be so far from it.
const LEAST: f64 = 1e-20;

/// Hulls and meshes put together, each about the middle of its box.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SurfaceData {
    faces: Vec<Face>,
    groups: Vec<(Bounds, Range<usize>)>,
    clusters: Vec<(Bounds, Range<usize>)>,
    triangles: Vec<[DVec3; 3]>,
}

/// Where they lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceTables {
    /// Unit vector out of a half space, and its height along that [m].
    faces: Table<Parameter, 4>,
    groups: Table<Parameter, BOUNDS>,
    /// The range of a group's clusters.
    group_rows: Links<2>,
    clusters: Table<Parameter, BOUNDS>,
    /// The range of a cluster's triangles.
    cluster_rows: Links<2>,
    triangles: Table<Parameter, CORNERS>,
}

impl SurfaceData {
    /// Adds a hull; answers the range of its faces.
    pub fn add_hull(&mut self, hull: &Hull, middle: DVec3) -> Range<usize> {
        let first = self.faces.len();
        let about = |(n, h): Face| (n, h - n.dot(middle));
        self.faces.extend(faces(hull).map(about));
        first..self.faces.len()
    }
    /// Adds a mesh; answers the range of its groups.
    pub fn add_mesh(&mut self, mesh: &TriangleMesh) -> Range<usize> {
        let (order, fan) = (order(mesh), fan(mesh.triangles().len()));
        let slack = DVec3::splat(ROUNDING * mesh.half_extents().length());
        let around = |list: &[usize]| {
            let Bounds { low, high } = Bounds::all(list.iter().map(|&t| bounds(mesh, t)));
            Bounds {
                low: low - mesh.center() - slack,
                high: high - mesh.center() + slack,
            }
        };
        let first_group = self.groups.len();
        for group in order.chunks(fan * fan) {
            let first_cluster = self.clusters.len();
            for cluster in group.chunks(fan) {
                let first = self.triangles.len();
                let corners = |&t: &usize| mesh.corners(t).map(|corner| corner - mesh.center());
                self.triangles.extend(cluster.iter().map(corners));
                let rows = first..self.triangles.len();
                self.clusters.push((around(cluster), rows));
            }
            let rows = first_cluster..self.clusters.len();
            self.groups.push((around(group), rows));
        }
        first_group..self.groups.len()
    }

    /// Room at the ends of the memories, which move on.
    pub fn place(&self, parameters: &mut usize, links: &mut usize) -> SurfaceTables {
        SurfaceTables {
            faces: Table::place(parameters, self.faces.len()),
            groups: Table::place(parameters, self.groups.len()),
            group_rows: Links::place(links, self.groups.len()),
            clusters: Table::place(parameters, self.clusters.len()),
            cluster_rows: Links::place(links, self.clusters.len()),
            triangles: Table::place(parameters, self.triangles.len()),
        }
    }
    /// Writes them where `tables` has room for them.
    ///
    /// Panics where the memories are shorter than what was placed.
    pub fn write(&self, tables: &SurfaceTables, parameters: &mut [f64], links: &mut [u32]) {
        let mut write = |at: usize, numbers: &[f64]| {
            parameters[at..][..numbers.len()].copy_from_slice(numbers);
        };
        for (row, (n, h)) in self.faces.iter().enumerate() {
            write(tables.faces.at(row, 0), &[n.x, n.y, n.z, *h]);
        }
        for (row, corners) in self.triangles.iter().enumerate() {
            let numbers = corners.map(|corner| corner.to_array());
            write(tables.triangles.at(row, 0), numbers.as_flattened());
        }
        for (boxes, table, rows) in [
            (&self.groups, tables.groups, tables.group_rows),
            (&self.clusters, tables.clusters, tables.cluster_rows),
        ] {
            for (row, (around, range)) in boxes.iter().enumerate() {
                write(table.at(row, 0), &around.numbers());
                links[rows.at(row, 0)] = range.start as u32;
                links[rows.at(row, 1)] = range.end as u32;
            }
        }
    }
}

impl SurfaceTables {
    /// Where a line is behind all faces of a hull; without the normal.
    #[inline(always)]
    pub fn within_hull<M: Machine>(&self, k: &M, line: &Line<M::R>, rows: [M::I; 2]) -> Span<M::R> {
        let end = M::R::lit(ENDLESS);
        let (mut enter, mut leave) = (k.cell(-end), k.cell(end));
        for row in k.range(rows[0], rows[1]) {
            let [x, y, z, h] = k.read(self.faces, row, 0);
            let span = line.half_space(Vec3::new(x, y, z), h);
            enter.write(enter.read().max(span.enter));
            leave.write(leave.read().min(span.leave));
        }
        Span {
            enter: enter.read(),
            leave: leave.read(),
            normal: Vec3::zero(),
        }
    }

    /// Where a line first crosses a triangle of a mesh, given the range of its groups, from its origin on and before `to`
    /// [m]; `to` where it crosses none.
    #[inline(always)]
    pub fn first_of_mesh<M: Machine>(
        &self,
        k: &M,
        line: &Line<M::R>,
        groups: [M::I; 2],
        to: M::R,
    ) -> M::R {
        let passing = Passing::new(line);
        let sheared = Sheared::new(line);
        let mut first = k.cell(to);
        for group in k.range(groups[0], groups[1]) {
            let near = passing.meets(k.read(self.groups, group, 0), first.read());
            if let Some(_branch) = k.if_any(near) {
                let [begin, end] = k.link_row(self.group_rows, group);
                for cluster in k.range(begin, end) {
                    let near =
                        near & passing.meets(k.read(self.clusters, cluster, 0), first.read());
                    if let Some(_branch) = k.if_any(near) {
                        self.first_of_cluster(k, &sheared, near, cluster, &mut first);
                    }
                }
            }
        }
        first.read()
    }

    #[inline(always)]
    fn first_of_cluster<M: Machine>(
        &self,
        k: &M,
        line: &Sheared<M::R>,
        near: <M::R as Real>::Mask,
        cluster: M::I,
        first: &mut M::Cell,
    ) {
        let [begin, end] = k.link_row(self.cluster_rows, cluster);
        for row in k.range(begin, end) {
            let [ax, ay, az, bx, by, bz, cx, cy, cz] = k.read(self.triangles, row, 0);
            let corners = [
                Vec3::new(ax, ay, az),
                Vec3::new(bx, by, bz),
                Vec3::new(cx, cy, cz),
            ];
            let (distance, crosses) = line.crosses(corners);
            let ahead = distance.ge(M::R::zero()) & distance.lt(first.read());
            let met = near & crosses & ahead;
            first.write(M::R::select(met, distance, first.read()));
        }
    }
}

/// A line as boxes see it.
struct Passing<R> {
    origin: Vec3<R>,
    /// 1 / dᵢ.
    slowness: Vec3<R>,
}

impl<R: Real> Passing<R> {
    #[inline(always)]
    fn new(line: &Line<R>) -> Self {
        let d = line.direction;
        Self {
            origin: line.origin,
            slowness: Vec3::new(slowness(d.x), slowness(d.y), slowness(d.z)),
        }
    }
    /// Whether it passes a box between its origin and `to`.
    #[inline(always)]
    fn meets(&self, bounds: [R; BOUNDS], to: R) -> R::Mask {
        let [x, y, z, xx, yy, zz] = bounds;
        let low = (Vec3::new(x, y, z) - self.origin).times(self.slowness);
        let high = (Vec3::new(xx, yy, zz) - self.origin).times(self.slowness);
        let enter = low.x.min(high.x).max(low.y.min(high.y));
        let leave = low.x.max(high.x).min(low.y.max(high.y));
        let enter = enter.max(low.z.min(high.z)).max(R::zero());
        let leave = leave.min(low.z.max(high.z)).min(to);
        // The times are rounded, too.
        let slack = (enter.abs() + leave.abs()) * R::lit(ROUNDING);
        enter.le(leave + slack)
    }
}

#[inline(always)]
fn slowness<R: Real>(speed: R) -> R {
    let least = R::lit(LEAST);
    let far = speed.abs().ge(least);
    R::one() / R::select(far, speed, least.copysign(speed))
}
