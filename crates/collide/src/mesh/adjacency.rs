//! Which triangles meet along an edge, and which normals a contact there may have.

use glam::DVec3;
use model::TriangleMesh;
use std::collections::HashMap;

/// An edge of a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Edge {
    /// In the triangle's plane, out of the triangle, at a right angle to the edge.
    pub out: DVec3,
    /// How far a contact's normal may lean over the edge: the sine of the angle to the neighbour's
    /// normal. 0 where the surface goes on flat or upwards, 1 where it ends.
    pub lean: f64,
}

/// A triangle's normal and its edges, in the order ab, bc, ca.
pub(super) type Sides = (DVec3, [Edge; 3]);

/// For each triangle the cosine of the largest angle from its normal to that of one that shares a corner
/// with it: no contact's normal is farther off. 0 beyond a right angle, and where the surface ends.
pub(super) fn spreads(mesh: &TriangleMesh, sides: &[Sides]) -> Vec<f64> {
    let around = normals_around(mesh, sides);
    let spread = |(corners, (normal, edges)): (&[u32; 3], &Sides)| {
        if edges.iter().any(|edge| edge.lean >= 1.0) {
            return 0.0;
        }
        let neighbours = corners.iter().flat_map(|v| &around[*v as usize]);
        let cosines = neighbours.map(|other| normal.dot(*other));
        cosines.fold(1.0, f64::min).max(0.0)
    };
    mesh.triangles().iter().zip(sides).map(spread).collect()
}

/// For each vertex the normals of the triangles that meet there, those that are equal once where they come one after
/// the other: of a flat fan there is one.
fn normals_around(mesh: &TriangleMesh, sides: &[Sides]) -> Vec<Vec<DVec3>> {
    let mut around: Vec<Vec<DVec3>> = vec![Vec::new(); mesh.vertices().len()];
    for (corners, (normal, _)) in mesh.triangles().iter().zip(sides) {
        for &v in corners {
            let normals = &mut around[v as usize];
            if normals.last() != Some(normal) {
                normals.push(*normal);
            }
        }
    }
    around
}

/// For each triangle its normal and its edges.
///
/// The normals of all contacts with an edge fill the angle between the normals of the two faces
/// (the edge's Voronoi region). A contact that a triangle alone would give, as if there were no
/// neighbours, may lie outside of it: the bump felt where a ball rolls over the seam of a flat floor.
pub(super) fn sides(mesh: &TriangleMesh) -> Vec<Sides> {
    let normals: Vec<_> = (0..mesh.triangles().len())
        .map(|t| mesh.normal(t))
        .collect();
    let mut owners: HashMap<(u32, u32), Vec<usize>> = HashMap::new();
    for (i, t) in mesh.triangles().iter().enumerate() {
        for (a, b) in [(t[0], t[1]), (t[1], t[2]), (t[2], t[0])] {
            owners.entry((a.min(b), a.max(b))).or_default().push(i);
        }
    }
    let edge = |i: usize, a: u32, b: u32| {
        let along = mesh.vertices()[b as usize] - mesh.vertices()[a as usize];
        let out = along.cross(normals[i]).normalize();
        let others = owners[&(a.min(b), a.max(b))].iter().filter(|&&j| j != i);
        let lean = others.map(|&j| lean(normals[i], out, normals[j]));
        Edge {
            out,
            lean: lean.reduce(f64::max).unwrap_or(1.0),
        }
    };
    mesh.triangles()
        .iter()
        .enumerate()
        .map(|(i, &[a, b, c])| (normals[i], [edge(i, a, b), edge(i, b, c), edge(i, c, a)]))
        .collect()
}

/// Sine of the angle from a normal to the neighbour's, 0 if that leans inwards, 1 beyond a right angle.
fn lean(normal: DVec3, out: DVec3, other: DVec3) -> f64 {
    let sine = out.dot(other);
    if sine > 0.0 && normal.dot(other) < 0.0 {
        1.0
    } else {
        sine.clamp(0.0, 1.0)
    }
}
