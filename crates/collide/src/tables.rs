//! Where the kernels find what shapes are made of, and put what they work with.

use numbers::Table;
use numbers::machine::space::{Parameter, Scratch};

/// A corner of an outline: position (x, y, z), the way out of the outline (x, y), feature.
pub(crate) const CORNERS: usize = 6;

/// Tables of the kernels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tables {
    /// Corners of convex hulls, each in its shape's frame [m].
    pub vertices: Table<Parameter, 3>,
    /// The outlines of A and B: eight corners each, and the first once more.
    pub(crate) corners: Table<Scratch, CORNERS>,
    /// The sides of both outlines: (a, b, c), with a x + b y + c ≥ 0 inside.
    pub(crate) sides: Table<Scratch, 3>,
    /// Points that contacts are chosen from: x, y, gap, feature.
    pub(crate) candidates: Table<Scratch, 4>,
    /// Of the one pair that there is, the direction from A to B in which the two touched last, or zero; none
    /// where nobody remembers.
    pub known: Option<Table<Parameter, 3>>,
}

impl Tables {
    /// Room for `vertices` corners of hulls at the end of the parameters, and for the kernels'
    /// work at the end of the scratch; both ends move on.
    pub fn place(parameters: &mut usize, vertices: usize, scratch: &mut usize) -> Self {
        Self {
            vertices: Table::place(parameters, vertices),
            corners: Table::place(scratch, 18),
            sides: Table::place(scratch, 16),
            candidates: Table::place(scratch, 24),
            known: None,
        }
    }
    /// The same for one pair whose direction is remembered, at the end of the parameters.
    pub fn remembering(self, parameters: &mut usize) -> Self {
        Self {
            known: Some(Table::place(parameters, 1)),
            ..self
        }
    }
}
