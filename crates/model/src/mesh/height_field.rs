//! Heights over a grid, as the mesh that they make.

use super::{MOST, MeshError, TriangleMesh};
use glam::{DVec2, DVec3};

/// Why heights are no height field.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum HeightFieldError {
    /// Nothing lies between the samples.
    #[error("a height field of {rows} × {columns} samples has no area: give at least 2 × 2")]
    TooSmall {
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// The rows differ.
    #[error("row {row} of the height field has {found} heights, the first one has {columns}")]
    Ragged {
        /// Which row.
        row: usize,
        /// Its length.
        found: usize,
        /// The first one's.
        columns: usize,
    },
    /// The distance of the samples.
    #[error("the height field's spacing is {0} m: give positive numbers")]
    Spacing(DVec2),
    /// The heights.
    #[error(transparent)]
    Mesh(#[from] MeshError),
}

impl TriangleMesh {
    /// How many samples a height field of so many rows and columns has: to be asked before they are read, as a file of a few
    /// bytes can say that it is huge.
    ///
    /// # Errors
    /// Fewer than two rows or columns, or more triangles than a mesh may have.
    pub fn height_field_samples(rows: usize, columns: usize) -> Result<usize, HeightFieldError> {
        if rows < 2 || columns < 2 {
            return Err(HeightFieldError::TooSmall { rows, columns });
        }
        let triangles = (rows - 1).saturating_mul(columns - 1).saturating_mul(2);
        if triangles > MOST {
            let most = MOST;
            return Err(MeshError::TooMany { triangles, most }.into());
        }
        Ok(rows * columns)
    }
    /// A height field: `heights[row][column]` [m] along y at x = column · spacing.x,
    /// z = row · spacing.y, from the middle of the field; touched from above. Each cell is two
    /// triangles, cut from its corner of most x and least z to that of least x and most z.
    ///
    /// # Errors
    /// Fewer than two rows or columns, rows of different lengths, heights that are not finite, a
    /// spacing that is not positive, or more triangles than a mesh may have.
    pub fn height_field(heights: &[Vec<f64>], spacing: DVec2) -> Result<Self, HeightFieldError> {
        let (rows, columns) = (heights.len(), heights.first().map_or(0, Vec::len));
        let samples = Self::height_field_samples(rows, columns)?;
        if let Some(row) = heights.iter().position(|r| r.len() != columns) {
            let found = heights[row].len();
            return Err(HeightFieldError::Ragged {
                row,
                found,
                columns,
            });
        }
        if !(spacing.min_element() > 0.0 && spacing.is_finite()) {
            return Err(HeightFieldError::Spacing(spacing));
        }
        let middle = |n: usize| (n - 1) as f64 / 2.0;
        let mut vertices = Vec::with_capacity(samples);
        for (row, heights) in heights.iter().enumerate() {
            for (column, &height) in heights.iter().enumerate() {
                let x = (column as f64 - middle(columns)) * spacing.x;
                let z = (row as f64 - middle(rows)) * spacing.y;
                vertices.push(DVec3::new(x, height, z));
            }
        }
        let mut faces = Vec::with_capacity(2 * (rows - 1) * (columns - 1));
        for row in 0..rows - 1 {
            for column in 0..columns - 1 {
                let a = (row * columns + column) as u32;
                let (b, c) = (a + 1, a + columns as u32);
                faces.extend([[a, c, b], [b, c, c + 1]]);
            }
        }
        Ok(Self::new(&vertices, &faces)?)
    }
}
