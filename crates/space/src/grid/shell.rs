//! Cells about a cell.

use super::Cell;

/// The cells at a Chebyshev distance from a centre, within bounds.
pub(super) struct Shell {
    center: Cell,
    radius: i32,
    /// The bounds, no wider than the shell.
    low: Cell,
    high: Cell,
}

impl Shell {
    pub fn new(center: Cell, radius: i32, low: Cell, high: Cell) -> Self {
        let low = std::array::from_fn(|i| low[i].max(center[i] - radius));
        let high = std::array::from_fn(|i| high[i].min(center[i] + radius));
        Self {
            center,
            radius,
            low,
            high,
        }
    }

    /// Whether a coordinate is that of one of the two faces across an axis.
    fn is_face(&self, axis: usize, x: i32) -> bool {
        (x - self.center[axis]).abs() == self.radius
    }

    /// Rows and cells that a visit looks at.
    pub fn work(&self) -> i64 {
        let length = |axis: usize| i64::from(self.high[axis] - self.low[axis]) + 1;
        let faces = |axis: usize| {
            let ends = [
                self.center[axis] - self.radius,
                self.center[axis] + self.radius,
            ];
            ends.iter()
                .filter(|x| (self.low[axis]..=self.high[axis]).contains(x))
                .count() as i64
        };
        let rows = length(0) * length(1);
        1 + rows + faces(0) * length(1) * length(2) + faces(1) * length(0) * length(2)
    }

    pub fn visit(&self, mut visit: impl FnMut(Cell)) {
        let Self { low, high, .. } = self;
        for x in low[0]..=high[0] {
            for y in low[1]..=high[1] {
                let whole = self.is_face(0, x) || self.is_face(1, y);
                let row = low[2]..=high[2];
                if whole {
                    row.for_each(|z| visit([x, y, z]));
                } else {
                    // Radius 0 is a face, so that these are two.
                    let ends = [self.center[2] - self.radius, self.center[2] + self.radius];
                    ends.into_iter()
                        .filter(|z| row.contains(z))
                        .for_each(|z| visit([x, y, z]));
                }
            }
        }
    }
}
