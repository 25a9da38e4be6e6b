//! The corners of hulls as rows of a table.

use crate::tables::Filler;
use model::{Geometry, Hull, Shape};
use numbers::Table;
use numbers::machine::space::Parameter;
use std::ops::Range;

/// Hulls, equal ones once, each with the rows that its corners take.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Corners {
    hulls: Vec<(Hull, Range<usize>)>,
}

impl Corners {
    /// Of the hulls among some shapes, with `room` for a number of corners.
    pub fn new<'a>(shapes: impl Iterator<Item = &'a Shape>, room: impl Fn(usize) -> usize) -> Self {
        let mut corners = Self::default();
        for shape in shapes {
            if let Geometry::Hull(hull) = &shape.geometry
                && corners.of(&shape.geometry).is_empty()
            {
                let (first, count) = (corners.rows(), room(hull.vertices().len()));
                corners.hulls.push((hull.clone(), first..first + count));
            }
        }
        corners
    }
    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.hulls.last().map_or(0, |(_, rows)| rows.end)
    }
    /// The rows of a geometry; none of what is no hull.
    pub fn of(&self, geometry: &Geometry) -> Range<usize> {
        let Geometry::Hull(hull) = geometry else {
            return 0..0;
        };
        let known = self.hulls.iter().find(|(known, _)| known == hull);
        known.map_or(0..0, |(_, rows)| rows.clone())
    }
    /// Writes the corners about the centres of their hulls; rows to spare repeat them, and are never
    /// farther than the first of their kind.
    pub fn fill(&self, table: Table<Parameter, 3>, f: &mut Filler) {
        for (hull, rows) in &self.hulls {
            let arms: Vec<_> = hull.arms().collect();
            for (row, arm) in rows.clone().zip(arms.iter().cycle()) {
                f.vec3(table, row, 0, *arm);
            }
        }
    }
}
