//! Where samples lie, the same in every run.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Of the middle of part i, j of a pixel cut in n × n, from the pixel's upper left corner.
pub(super) fn within_pixel(part: usize, n: usize) -> DVec2 {
    let at = DVec2::new((part % n) as f64, (part / n) as f64);
    (at + 0.5) / n as f64
}

/// Point i of n that fill the unit disc evenly (Vogel, A better way to construct the sunflower head,
/// 1979), turned by an angle [rad].
pub(super) fn disc(i: usize, n: usize, turn: f64) -> DVec2 {
    let golden = PI * (3.0 - 5_f64.sqrt());
    let radius = ((i as f64 + 0.5) / n as f64).sqrt();
    radius * DVec2::from_angle(turn + golden * i as f64)
}

/// Direction i of n about a unit vector, as dense as a sheet across it is lit from them (Malley's
/// method: the points of a disc, raised to the ball above).
pub(super) fn hemisphere(normal: DVec3, i: usize, n: usize, turn: f64) -> DVec3 {
    let (a, b) = normal.any_orthonormal_pair();
    let p = disc(i, n, turn);
    p.x * a + p.y * b + (1.0 - p.length_squared()).max(0.0).sqrt() * normal
}

/// An angle [rad] for each pixel, all different, that of neighbours evenly spread (Jimenez, Next
/// generation post processing in Call of Duty, 2014: interleaved gradient noise).
pub(super) fn turn((column, row): (usize, usize)) -> f64 {
    let mixed = 0.06711056 * column as f64 + 0.00583715 * row as f64;
    TAU * (52.9829189 * mixed.fract()).fract()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Evenly lit from above, a sheet receives as much from each ray: their mean along the normal is ⅔.
    #[test]
    fn directions_are_as_dense_as_their_cosine() {
        let normal = DVec3::new(0.6, 0.0, 0.8);
        let n = 1000;
        let mean =
            (0..n).map(|i| hemisphere(normal, i, n, 0.3)).sum::<DVec3>() / f64::from(n as u32);
        assert!(mean.abs_diff_eq(normal * 2.0 / 3.0, 0.01), "{mean}");
        assert!((0..n).all(|i| hemisphere(normal, i, n, 0.3).is_normalized()));
    }

    #[test]
    fn samples_of_a_pixel_are_the_middles_of_its_parts() {
        assert_eq!(within_pixel(0, 1), DVec2::splat(0.5));
        assert_eq!(within_pixel(3, 2), DVec2::splat(0.75));
    }
}
