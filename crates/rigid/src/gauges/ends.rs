//! At which ends of their ranges joints are.

use super::rows::{Notes, Rows};
use super::{FLAGS, Told, flag};
use crate::OutputTables;
use crate::tables::Filler;
use model::{JointId, Model};
use numbers::machine::space::Input;
use numbers::{Machine, Real, Table};

/// What is beyond all ranges [m or rad], also as a number of single precision.
const NEVER: f64 = 1e30;

/// Degrees of freedom that have a coordinate of their own.
#[derive(Default)]
pub(super) struct EndNotes(Notes<2, 4>);

/// COORDINATE, of all that is reported; TO. The lower end and the upper, and what they count.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ends(Rows<2, 4>);

impl EndNotes {
    /// Notes the degrees of freedom of joints, which tell from a number on.
    pub fn add(
        &mut self,
        (model, outputs): (&Model, &OutputTables),
        joints: &[JointId],
        to: usize,
    ) {
        let mut row = 0;
        for &joint in joints {
            let dofs = model.dof_range(joint);
            let coordinates = model.coordinate_range(joint);
            if coordinates.len() == dofs.len() {
                let of = &model.joints[joint.0].dofs;
                for (i, (dof, coordinate)) in of.iter().zip(coordinates).enumerate() {
                    let (lower, upper) = dof.limit.map_or((-NEVER, NEVER), |l| (l.lower, l.upper));
                    let first = 2 * (row + i);
                    let links = [outputs.position.at(coordinate, 0), to + first / FLAGS];
                    let [low, high] = [first + 1, first].map(|i| flag(i) as f64);
                    self.0.add(links, [lower, upper, low, high]);
                }
            }
            row += dofs.len();
        }
    }
    pub fn len(&self) -> usize {
        self.0.len()
    }
    pub fn place(&self, parameters: &mut usize, links: &mut usize) -> Ends {
        Ends(self.0.place(parameters, links))
    }
}

impl Ends {
    pub fn fill(&self, notes: &EndNotes, f: &mut Filler) {
        self.0.fill(&notes.0, f);
    }

    /// Tells Σ flags, of the upper end where a range has but one place.
    #[inline(always)]
    pub fn tell<M: Machine>(&self, k: &mut M, all: Table<Input>, told: Told) {
        for row in self.0.all(k) {
            let [from, to] = self.0.links(k, row);
            let [lower, upper, low, high] = self.0.numbers(k, row);
            let x = k.load(all, from, 0);
            let low = M::R::select(x.le(lower), low, M::R::zero());
            k.add(told, to, 0, M::R::select(x.ge(upper), high, low));
        }
    }
}
