//! Who carries the shapes that touch.
//!
//! The carriers of the contacts are, in this order: the world as each tree sees it, which all is row
//! 0 of the bodies, and the moving bodies.

use super::tables::{NAME, Tables};
use super::topology::carrier;
use crate::SolverError;
use crate::contacts::{ContactPlan, Seat};
use crate::tables::Filler;
use model::{BodyId, BodyKind, JointKind, Model, Pose, Shape};

/// The bodies of a model as carriers of shapes.
pub(crate) struct Seats {
    /// Per body of the model: its row, 0 if it does not move; the model's frame in its own, or in
    /// the world; its tree.
    bodies: Vec<(usize, Pose, usize)>,
    /// Mass [kg] of each tree.
    masses: Vec<f64>,
}

impl Seats {
    /// `own` has, per body of the model, its row and the model's frame in its own.
    pub(crate) fn new(model: &Model, own: &[(usize, Pose)]) -> Self {
        let mut bodies: Vec<_> = own.iter().map(|&(row, place)| (row, place, 0)).collect();
        let mut masses = Vec::new();
        for &BodyId(id) in model.order() {
            if model.bodies[id].kind == BodyKind::Static {
                continue;
            }
            let parent = carrier(model, BodyId(id)).and_then(|j| model.joints[j].parent);
            let tree = match parent {
                Some(parent) if bodies[parent.0].0 > 0 => bodies[parent.0].2,
                _ => {
                    masses.push(0.0);
                    masses.len() - 1
                }
            };
            bodies[id].2 = tree;
            masses[tree] += model.bodies[id].mass;
        }
        Self { bodies, masses }
    }

    /// How many carriers there are.
    pub(crate) fn carriers(&self) -> usize {
        self.masses.len() + self.bodies.iter().filter(|b| b.0 > 0).count()
    }

    /// The pairs of a model.
    ///
    /// # Errors
    /// A shape that no kernel collides.
    pub(crate) fn plan(&self, model: &Model) -> Result<ContactPlan, SolverError> {
        ContactPlan::new(model, NAME, |shape| self.seat(shape))
    }

    fn seat(&self, shape: &Shape) -> Seat {
        let (row, place, group) = match shape.body {
            Some(BodyId(id)) => self.bodies[id],
            None => (0, Pose::IDENTITY, 0),
        };
        if row == 0 {
            let (group, mass) = (0, f64::INFINITY);
            return Seat {
                row,
                group,
                place,
                mass,
            };
        }
        Seat {
            row: self.masses.len() + row - 1,
            group,
            place,
            mass: self.masses[group],
        }
    }

    /// Writes the rows of the bodies of carriers and contacts.
    pub(crate) fn fill(&self, t: &Tables, plan: &ContactPlan, f: &mut Filler) {
        let trees = self.masses.len();
        let row = |carrier: usize| (carrier + 1).saturating_sub(trees);
        for carrier in 0..self.carriers() {
            f.link(t.carrier_links, carrier, 0, row(carrier));
            for slot in plan.slots_of(carrier) {
                f.link(t.touch_links, slot, 1, row(carrier));
            }
        }
        for (slot, a, b) in plan.between_slots() {
            f.link(t.touch_links, slot, 0, row(a.row));
            f.link(t.touch_links, slot, 1, row(b.row));
        }
    }
}

/// Whether joints hold any bodies.
pub(crate) fn jointed(model: &Model) -> bool {
    model.joints.iter().any(|j| j.kind != JointKind::Free)
}
