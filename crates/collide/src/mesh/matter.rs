//! How much matter lies behind the triangles of a mesh.

use super::hierarchy::{Bounds, bounds};
use crate::ray::{Line, Sheared};
use glam::DVec3;
use model::TriangleMesh;

/// Least distance of the point behind a triangle, against the triangle's size, so that what lies
/// between has a volume.
const LEAST: f64 = 1e-3;

/// Some triangles, or what is made of them, and the box about them.
type Boxed<T> = (Bounds, T);

/// For each triangle a point [m] of the matter behind it: half way from its middle to where the line
/// back into the mesh leaves it; behind a surface that ends somewhere, as far as the triangle is large.
///
/// `order` has neighbours in space next to each other, and is looked through in groups of clusters of
/// `fan` triangles.
pub(super) fn behind(mesh: &TriangleMesh, order: &[usize], fan: usize) -> Vec<DVec3> {
    let groups = if mesh.is_closed() {
        Vec::from_iter(order.chunks(fan * fan).map(|group| boxed(mesh, group, fan)))
    } else {
        Vec::new()
    };
    let behind = |t: usize| {
        let corners = mesh.corners(t);
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let line = Line {
            origin: middle,
            direction: -mesh.normal(t),
        };
        let size = corners.map(|corner| corner.distance(middle));
        let size = size.into_iter().fold(0.0, f64::max);
        let way = first_crossing(mesh, &groups, &line, t).map_or(size, |far| 0.5 * far);
        middle + line.direction * way.max(LEAST * size)
    };
    (0..mesh.triangles().len()).map(behind).collect()
}

/// A group of triangles, cut into clusters.
fn boxed<'a>(
    mesh: &TriangleMesh,
    triangles: &'a [usize],
    fan: usize,
) -> Boxed<Vec<Boxed<&'a [usize]>>> {
    let cluster = |triangles: &'a [usize]| (around(mesh, triangles), triangles);
    let clusters = triangles.chunks(fan).map(cluster);
    (around(mesh, triangles), clusters.collect())
}

fn around(mesh: &TriangleMesh, triangles: &[usize]) -> Bounds {
    Bounds::all(triangles.iter().map(|&t| bounds(mesh, t)))
}

/// How far [m] along a line it first crosses a triangle other than the one it starts on.
fn first_crossing(
    mesh: &TriangleMesh,
    groups: &[Boxed<Vec<Boxed<&[usize]>>>],
    line: &Line,
    start: usize,
) -> Option<f64> {
    let sheared = Sheared::new(line);
    let clusters = groups
        .iter()
        .filter(|(group, _)| group.meets(line))
        .flat_map(|(_, clusters)| clusters);
    let triangles = clusters
        .filter(|(cluster, _)| cluster.meets(line))
        .flat_map(|(_, triangles)| triangles.iter());
    triangles
        .filter(|t| **t != start)
        .filter_map(|&t| sheared.crosses(mesh.corners(t)))
        .filter(|far| *far > 0.0)
        .reduce(f64::min)
}
