//! k-d tree for objects with extent; for scenes that rest.
//!
//! A set is halved at the median of the centres along the axis on which these
//! are spread the widest (Bentley 1975; Friedman, Bentley, Finkel 1977, "An
//! algorithm for finding best matches in logarithmic expected time").
//!
//! | | cost |
//! |---|---|
//! | build | O(n log n) |
//! | update, insert, remove, relocate | as build |
//! | query | O(log n + answers) for boxes that are of like size and overlap little |
//! | nearest | O(log n) expected: gaps along the axes add up on the way down (Arya, Mount 1993) |
//! | memory | about 40 bytes an object |

use crate::Aabb;
use crate::cast::Sweep;
use crate::halves::{Cut, Halves, Item, Motion};
use glam::Vec3;

/// A k-d tree; see [the module](self).
pub type KdTree = Halves<Axis>;

/// One of the three axes.
#[derive(Clone, Copy, Debug)]
pub struct Axis(u8);

impl Axis {
    /// The component along it.
    #[inline(always)]
    fn of(self, v: Vec3) -> f32 {
        v.to_array()[usize::from(self.0).min(2)]
    }
}

impl Cut for Axis {
    const NAME: &'static str = "kd_tree";
    /// Along each axis.
    type Gap = Vec3;

    fn across(items: &[Item]) -> Self {
        let centers = items.iter().map(|i| i.aabb.center());
        let about = centers.fold(Aabb::EMPTY, |b, c| b.union(&Aabb::new(c, c)));
        Self(about.extent().max_position() as u8)
    }
    #[inline(always)]
    fn height(self, point: Vec3) -> f32 {
        self.of(point)
    }
    #[inline(always)]
    fn shadow(self, aabb: &Aabb) -> (f32, f32) {
        (self.of(aabb.min), self.of(aabb.max))
    }
    #[inline(always)]
    fn motion(self, sweep: &Sweep) -> Motion {
        let inverse = self.of(sweep.inverse);
        Motion {
            low: self.of(sweep.lower),
            high: self.of(sweep.upper),
            inverse_left: inverse,
            inverse_right: inverse,
        }
    }
    #[inline(always)]
    fn widen(self, mut gap: Vec3, along: f32) -> Vec3 {
        let axis = usize::from(self.0).min(2);
        gap[axis] = gap[axis].max(along);
        gap
    }
    #[inline(always)]
    fn square(gap: Vec3) -> f32 {
        gap.length_squared()
    }
}
