//! Convex pieces of meshes: a user's explicit choice.

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
