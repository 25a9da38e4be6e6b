//! Mass properties of hollow solids (attribute `shellinertia`), and of surfaces.

use glam::{DMat3, DVec3};
use model::{Geometry, MassProperties};
use std::f64::consts::PI;

/// Of a thin shell of unit density per area, in the solid's frame; `None` where there is no volume.
///
/// A shell is the rate at which the solid grows: with I(ε) the inertia of the solid whose sizes are
/// all larger by ε, the shell has I'(0), and likewise the mass. Derivatives are by central
/// differences over four points, exact for polynomials up to degree 4; the error of degree 5 is below
/// 1e-11. An ellipsoid's shell is of uneven thickness then; as MuJoCo does, its inertia is scaled to
/// the mass of an even one.
pub(super) fn of(geometry: &Geometry) -> Option<MassProperties> {
    let step = 1e-3 * least_size(geometry)?;
    let solid = |k: f64| MassProperties::of(&grown(geometry, k * step), 1.0);
    let (a, b, c, d) = (solid(-2.0)?, solid(-1.0)?, solid(1.0)?, solid(2.0)?);
    let mass = (a.mass - 8.0 * b.mass + 8.0 * c.mass - d.mass) / (12.0 * step);
    let inertia: DMat3 =
        (a.inertia - b.inertia * 8.0 + c.inertia * 8.0 - d.inertia) * (1.0 / (12.0 * step));
    let shell = MassProperties {
        mass,
        center: a.center,
        inertia,
    };
    Some(match *geometry {
        Geometry::Ellipsoid { half } => shell.with_mass(ellipsoid_area(half)),
        _ => shell,
    })
}

/// Of triangles of unit density per area; `None` where they have none.
///
/// Of a triangle (a, b, c) of area A, about the common centre, with s = a + b + c and C = ∫ x xᵀ dA:
///
/// ```text
/// centre = Σ A/3 s / Σ A   C = Σ A/12 (a aᵀ + b bᵀ + c cᵀ + s sᵀ)   I = tr C 1 − C
/// ```
pub(super) fn of_faces(faces: impl Iterator<Item = [DVec3; 3]> + Clone) -> Option<MassProperties> {
    let area = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length() / 2.0;
    let (mut mass, mut first) = (0.0, DVec3::ZERO);
    for face in faces.clone() {
        let part = area(face);
        mass += part;
        first += face.iter().sum::<DVec3>() * (part / 3.0);
    }
    if mass <= 0.0 {
        return None;
    }
    let center = first / mass;
    let mut inertia = DMat3::ZERO;
    for face in faces {
        let [a, b, c] = face.map(|corner| corner - center);
        for x in [a, b, c, a + b + c] {
            let outer = DMat3::from_cols(x * x.x, x * x.y, x * x.z);
            let of_point = DMat3::from_diagonal(DVec3::splat(x.length_squared())) - outer;
            inertia += of_point * (area(face) / 12.0);
        }
    }
    Some(MassProperties {
        mass,
        center,
        inertia,
    })
}

/// Surface of an ellipsoid by Thomsen's formula (2004), within 1.1 %:
/// 4 π (((ab)ᵖ + (ac)ᵖ + (bc)ᵖ) / 3)^(1/p), p = 1.6075.
fn ellipsoid_area(half: DVec3) -> f64 {
    const P: f64 = 1.6075;
    let products = [half.x * half.y, half.x * half.z, half.y * half.z];
    let mean = products.iter().map(|product| product.powf(P)).sum::<f64>() / 3.0;
    4.0 * PI * mean.powf(1.0 / P)
}

fn least_size(geometry: &Geometry) -> Option<f64> {
    match *geometry {
        Geometry::Sphere { radius } => Some(radius),
        Geometry::Capsule {
            radius,
            half_height,
        }
        | Geometry::Cylinder {
            radius,
            half_height,
        } => Some(radius.min(half_height)),
        Geometry::Box { half } | Geometry::Ellipsoid { half } => Some(half.min_element()),
        Geometry::Plane { .. }
        | Geometry::Cone { .. }
        | Geometry::Hull(_)
        | Geometry::Mesh(_)
        | Geometry::MeshFile { .. } => None,
    }
}

fn grown(geometry: &Geometry, by: f64) -> Geometry {
    let mut grown = geometry.clone();
    match &mut grown {
        Geometry::Sphere { radius } => *radius += by,
        Geometry::Capsule {
            radius,
            half_height,
        }
        | Geometry::Cylinder {
            radius,
            half_height,
        } => {
            *radius += by;
            *half_height += by;
        }
        Geometry::Box { half } | Geometry::Ellipsoid { half } => *half += DVec3::splat(by),
        Geometry::Plane { .. }
        | Geometry::Cone { .. }
        | Geometry::Hull(_)
        | Geometry::Mesh(_)
        | Geometry::MeshFile { .. } => {}
    }
    grown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hollow_ball() {
        let r = 0.3;
        let shell = of(&Geometry::Sphere { radius: r }).unwrap();
        let mass = 4.0 * PI * r * r;
        assert!((shell.mass / mass - 1.0).abs() < 1e-10);
        let moment = 2.0 / 3.0 * mass * r * r;
        assert!((shell.inertia.x_axis.x / moment - 1.0).abs() < 1e-10);
    }

    /// Six square faces of edge a: two turn about their own centres, a²/6, four about an axis in
    /// their planes, a²/12, at distance a/2: I/m = (2/6 + 4/12 + 4/4)/6 a² = 5/18 a².
    #[test]
    fn hollow_cube() {
        let half = 0.2;
        let shell = of(&Geometry::Box {
            half: DVec3::splat(half),
        })
        .unwrap();
        let mass = 24.0 * half * half;
        assert!((shell.mass / mass - 1.0).abs() < 1e-10);
        let moment = 5.0 / 18.0 * mass * (2.0 * half).powi(2);
        assert!((shell.inertia.y_axis.y / moment - 1.0).abs() < 1e-10);
    }
}
