//! Where a line crosses a triangle, in double precision.

use super::kernel;
use super::line::{Line, numbers};
use glam::DVec3;

/// A line as triangles see it; see [`kernel::Sheared`].
#[derive(Clone, Copy, Debug)]
pub struct Sheared(kernel::Sheared<f64>);

impl Sheared {
    /// Of a line whose direction has unit length.
    pub fn new(line: &Line) -> Self {
        Self(kernel::Sheared::new(&line.numbers()))
    }

    /// The distance [m] along the line at which it crosses a triangle, from either side; edges count.
    pub fn crosses(&self, corners: [DVec3; 3]) -> Option<f64> {
        let (distance, crosses) = self.0.crosses(corners.map(numbers));
        crosses.then_some(distance)
    }
}
