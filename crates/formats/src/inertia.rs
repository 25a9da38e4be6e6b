//! Inertia matrices as files give them, and what no solid can have.

use crate::error::FormatError;
use crate::xml::Element;
use glam::{DMat3, DVec3};
use model::MassProperties;

/// Mass properties of what has no mass.
pub(crate) const NOTHING: MassProperties = MassProperties {
    mass: 0.0,
    center: DVec3::ZERO,
    inertia: DMat3::ZERO,
};

/// The largest principal moment may exceed the sum of the others by this share of itself.
const TRIANGLE_TOLERANCE: f64 = 1e-6;

/// A symmetric matrix from its six entries.
pub(crate) fn symmetric([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols(
        DVec3::new(xx, xy, xz),
        DVec3::new(xy, yy, yz),
        DVec3::new(xz, yz, zz),
    )
}

/// Whether a principal moment exceeds the sum of the other two, as no solid's does.
pub(crate) fn violates_triangle(moments: DVec3) -> bool {
    let excess = 2.0 * moments.max_element() - moments.element_sum();
    excess > TRIANGLE_TOLERANCE * moments.max_element()
}

/// An error where no solid has these principal moments.
pub(crate) fn check(element: &Element, moments: DVec3, remedy: &str) -> Result<(), FormatError> {
    if moments.min_element() < 0.0 {
        return Err(element.invalid(
            &format!(
                "its inertia has the negative principal moment {}",
                moments.min_element()
            ),
            "correct the inertia; its matrix must be positive definite",
        ));
    }
    if violates_triangle(moments) {
        let DVec3 { x, y, z } = moments;
        return Err(element.invalid(
            &format!(
                "its principal moments of inertia {x}, {y}, {z} belong to no solid: the largest \
                 exceeds the sum of the others"
            ),
            remedy,
        ));
    }
    Ok(())
}
