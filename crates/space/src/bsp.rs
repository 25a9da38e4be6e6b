//! Binary space partition by planes of any direction; for scenes that rest.
//!
//! Space is halved by planes again and again (Fuchs, Kedem, Naylor 1980, "On
//! visible surface generation by a priori tree structures"). A plane lies at the
//! median of the centres along their principal axis, the direction of their
//! largest variance, so that rows and walls aslant to the axes are cut across.
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n), about twice a k-d tree's |
//! | update, insert, remove, relocate | as build |
//! | query | O(log n + answers) for boxes that are of like size and overlap little |
//! | memory | about 49 bytes an object |

use crate::Aabb;
use crate::cast::Sweep;
use crate::halves::{Cut, Halves, Item, Motion};
use glam::Vec3;

/// Covers the rounding of products with a normal, as a share of the terms.
const ROUNDING: f32 = 1e-6;

/// A binary space partition; see [the module](self).
pub type Bsp = Halves<Normal>;

/// A unit vector.
#[derive(Clone, Copy, Debug)]
pub struct Normal(Vec3);

impl Cut for Normal {
    const NAME: &'static str = "bsp";
    /// The widest gap to any plane on the way.
    type Gap = f32;

    /// The direction of the largest variance of the centres, by power iteration.
    fn across(items: &[Item]) -> Self {
        let scale = 1.0 / items.len() as f32;
        let mean = items
            .iter()
            .fold(Vec3::ZERO, |sum, i| sum + scale * i.aabb.center());
        let mut covariance = [Vec3::ZERO; 3];
        for item in items {
            let off = item.aabb.center() - mean;
            for (row, x) in covariance.iter_mut().zip(off.to_array()) {
                *row += scale * x * off;
            }
        }
        let variance = Vec3::from_array(std::array::from_fn(|i| covariance[i][i]));
        let mut axis = covariance[variance.max_position()].normalize_or(Vec3::X);
        for _ in 0..8 {
            let next = Vec3::from_array(covariance.map(|row| row.dot(axis)));
            axis = next.normalize_or(axis);
        }
        Self(axis)
    }

    #[inline(always)]
    fn height(self, point: Vec3) -> f32 {
        point.dot(self.0)
    }

    #[inline(always)]
    fn shadow(self, aabb: &Aabb) -> (f32, f32) {
        let (center, half, along) = (aabb.center(), 0.5 * aabb.extent(), self.0.abs());
        let middle = center.dot(self.0);
        let reach = half.dot(along);
        let reach = reach + ROUNDING * (center.abs().dot(along) + reach);
        (middle - reach, middle + reach)
    }

    #[inline(always)]
    fn motion(self, sweep: &Sweep) -> Motion {
        let (low, high) = self.shadow(&Aabb::new(sweep.lower, sweep.upper));
        let direction = sweep.direction();
        let speed = direction.dot(self.0);
        let error = ROUNDING * direction.abs().dot(self.0.abs());
        let inverse = |speed: f32| {
            if speed == 0.0 {
                f32::MAX
            } else {
                speed.recip()
            }
        };
        Motion {
            low,
            high,
            inverse_left: inverse(speed - error),
            inverse_right: inverse(speed + error),
        }
    }

    #[inline(always)]
    fn widen(self, gap: f32, along: f32) -> f32 {
        // The normal is of unit length but for rounding.
        gap.max((1.0 - ROUNDING) * along)
    }

    #[inline(always)]
    fn square(gap: f32) -> f32 {
        gap * gap
    }
}
