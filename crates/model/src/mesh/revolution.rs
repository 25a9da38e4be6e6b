//! Surfaces of revolution: rings, bowls, vases.

use super::{MOST, MeshError, TriangleMesh};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

impl TriangleMesh {
    /// What a closed profile, of distances from the y axis and heights [m], sweeps as it turns about that
    /// axis, in so many steps around. Its points go counter-clockwise about what is solid; the last is
    /// joined to the first.
    ///
    /// # Errors
    /// A profile of fewer than three points or a turn of fewer than three steps, numbers that are not
    /// finite, nothing left to touch, more triangles than a mesh may have.
    pub fn revolution(profile: &[DVec2], around: usize) -> Result<Self, MeshError> {
        let points = profile.len();
        if points < 3 || around < 3 {
            return Err(MeshError::Revolution { points, around });
        }
        let triangles = points.saturating_mul(around).saturating_mul(2);
        if triangles > MOST {
            let most = MOST;
            return Err(MeshError::TooMany { triangles, most });
        }
        let mut vertices = Vec::with_capacity(points * around);
        for step in 0..around {
            let (s, c) = (step as f64 / around as f64 * TAU).sin_cos();
            vertices.extend(profile.iter().map(|p| DVec3::new(p.x * c, p.y, p.x * s)));
        }
        let number = |step: usize, point: usize| (step % around * points + point % points) as u32;
        let mut faces = Vec::with_capacity(triangles);
        for step in 0..around {
            for point in 0..points {
                let [a, b] = [point, point + 1].map(|point| number(step, point));
                let [d, c] = [point, point + 1].map(|point| number(step + 1, point));
                faces.extend([[a, b, c], [a, c, d]]);
            }
        }
        Self::new(&vertices, &faces)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Geometry, MassProperties};

    /// Pappus: the volume is the area of the profile by the way of its centre; of n steps, that of a
    /// polygon, n/2 sin(2π/n) in place of π.
    #[test]
    fn rings_hold_what_pappus_says() {
        let square = [(0.9, -0.1), (1.1, -0.1), (1.1, 0.1), (0.9, 0.1)].map(DVec2::from);
        let n = 40;
        let ring = TriangleMesh::revolution(&square, n).unwrap();
        assert!(ring.is_closed());
        let mass = MassProperties::of(&Geometry::Mesh(ring), 1.0).unwrap();
        let pi = n as f64 / 2.0 * (TAU / n as f64).sin();
        assert!((mass.mass - 2.0 * pi * 0.04).abs() < 1e-12);
        assert!(mass.center.length() < 1e-12);
    }

    /// On the axis triangles without area are dropped, and the surface stays closed.
    #[test]
    fn a_profile_may_touch_the_axis() {
        let triangle = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(DVec2::from);
        let cone = TriangleMesh::revolution(&triangle, 8).unwrap();
        assert!(cone.is_closed());
        assert_eq!((cone.vertices().len(), cone.triangles().len()), (10, 16));
    }

    #[test]
    fn what_sweeps_nothing_is_refused() {
        let line = [DVec2::ZERO, DVec2::X];
        let flat = [DVec2::X, 2.0 * DVec2::X, 3.0 * DVec2::X];
        let endless = [DVec2::NAN; 3];
        for (profile, around) in [
            (&line[..], 8),
            (&flat, 2),
            (&endless, 8),
            (&flat, usize::MAX),
        ] {
            assert!(TriangleMesh::revolution(profile, around).is_err());
        }
    }
}
