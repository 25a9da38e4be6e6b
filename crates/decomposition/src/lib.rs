//! Convex pieces of meshes: a user's explicit choice.
//!
//! A crate by itself, since the library that finds them takes long to compile, and no solver needs it.

#![forbid(unsafe_code)]

use glam::DVec3;
use model::{Hull, HullError, TriangleMesh};
use parry3d_f64::math::Vector;
use parry3d_f64::transformation::vhacd;

/// Convex pieces that together are nearly a mesh: approximate convex decomposition (Mamou & Ghorbel,
/// A simple and efficient approach for 3D mesh approximate convex decomposition, ICIP 2009).
///
/// `concavity` in 0…1 is how much hollowness a piece may keep, and `resolution` the number of voxels
/// along the longest side; 0.01 and 64 are good first choices. Pieces without thickness are left out.
///
/// # Errors
/// No piece has a thickness.
pub fn convex_decomposition(
    mesh: &TriangleMesh,
    concavity: f64,
    resolution: u32,
) -> Result<Vec<Hull>, HullError> {
    let parameters = vhacd::VHACDParameters {
        concavity: concavity.clamp(0.0, 1.0),
        resolution: resolution.max(8),
        ..Default::default()
    };
    let vertices = mesh.vertices().iter();
    let vertices: Vec<_> = vertices.map(|p| Vector::new(p.x, p.y, p.z)).collect();
    let found = vhacd::VHACD::decompose(&parameters, &vertices, mesh.triangles(), true);
    let pieces = found.compute_exact_convex_hulls(&vertices, mesh.triangles());
    let hull = |(corners, _): &(Vec<Vector>, Vec<[u32; 3]>)| {
        let corners: Vec<_> = corners.iter().map(|v| DVec3::new(v.x, v.y, v.z)).collect();
        Hull::new(&corners)
    };
    let (hulls, errors): (Vec<_>, Vec<_>) = pieces.iter().map(hull).partition(Result::is_ok);
    let hulls: Vec<_> = hulls.into_iter().flatten().collect();
    match errors.into_iter().next() {
        Some(Err(error)) if hulls.is_empty() => Err(error),
        _ if hulls.is_empty() => Err(HullError::TooFew { points: 0 }),
        _ => Ok(hulls),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::{Geometry, MassProperties};

    /// An L is no convex solid, and two boxes are one.
    #[test]
    fn hollow_meshes_come_apart() {
        let outline = [
            [0.0, 0.0],
            [2.0, 0.0],
            [2.0, 1.0],
            [1.0, 1.0],
            [1.0, 2.0],
            [0.0, 2.0],
        ];
        let vertices: Vec<_> = [0.0, 1.0]
            .into_iter()
            .flat_map(|z| outline.map(|[x, y]| DVec3::new(x, y, z)))
            .collect();
        let mut triangles = vec![[0, 2, 1], [0, 3, 2], [0, 4, 3], [0, 5, 4]];
        triangles.extend([[6, 7, 8], [6, 8, 9], [6, 9, 10], [6, 10, 11]]);
        for i in 0..6 {
            let j = (i + 1) % 6;
            triangles.extend([[i, j, j + 6], [i, j + 6, i + 6]]);
        }
        let mesh = TriangleMesh::new(&vertices, &triangles).unwrap();
        let pieces = convex_decomposition(&mesh, 0.01, 32).unwrap();
        let volume = |hull: &Hull| {
            let solid = MassProperties::of(&Geometry::Hull(hull.clone()), 1.0);
            solid.unwrap().mass
        };
        let together: f64 = pieces.iter().map(volume).sum();
        assert!(
            pieces.len() >= 2 && (together - 3.0).abs() < 0.2,
            "{} of {together}",
            pieces.len()
        );
    }
}
