//! Parts of the outputs, of which only those that are asked for are worked out and fetched.

use crate::outputs::existing;
use model::{BodyId, JointId, Model};
use rigid::{OutputTables, Report};
use std::ops::Range;

/// What is looked at of the [`Outputs`](crate::Outputs); see
/// [`Simulation::observe_parts`](crate::Simulation::observe_parts).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutputPart {
    /// Where a body is, and how it moves.
    Motion(BodyId),
    /// The acceleration and the angular acceleration of a body.
    Acceleration(BodyId),
    /// The coordinates of a joint.
    Coordinates(JointId),
    /// The velocities of a joint.
    Velocities(JointId),
    /// The reaction of a joint.
    Reaction(JointId),
    /// A row of contacts.
    ContactRow(usize),
    /// All contacts.
    Contacts,
    /// Whether a body sleeps.
    Asleep(BodyId),
}

impl OutputPart {
    /// How much of the output has to be of the present state.
    pub(crate) fn needs(self) -> Report {
        match self {
            Self::Coordinates(_) | Self::Velocities(_) => Report::Joints,
            Self::Motion(_) | Self::Asleep(_) => Report::Motion,
            Self::ContactRow(_) | Self::Contacts => Report::Contacts,
            Self::Acceleration(_) | Self::Reaction(_) => Report::Everything,
        }
    }
    /// Its numbers.
    ///
    /// Panics where it does not exist.
    pub(crate) fn numbers(self, t: &OutputTables, model: &Model) -> [Range<usize>; 3] {
        self.exists(t, model);
        let none = || 0..0;
        let one = |numbers| [numbers, none(), none()];
        match self {
            Self::Motion(body) => one(t.body.at(body.0, 0)..t.body.at(body.0 + 1, 0)),
            Self::Acceleration(body) => {
                one(t.body_acceleration.at(body.0, 0)..t.body_acceleration.at(body.0 + 1, 0))
            }
            Self::Coordinates(joint) => {
                let rows = model.coordinate_range(joint);
                one(t.position.at(rows.start, 0)..t.position.at(rows.end, 0))
            }
            Self::Velocities(joint) => {
                let rows = model.dof_range(joint);
                one(t.velocity.at(rows.start, 0)..t.velocity.at(rows.end, 0))
            }
            Self::Reaction(joint) => one(t.reaction.at(joint.0, 0)..t.reaction.at(joint.0 + 1, 0)),
            Self::Asleep(body) => one(t.asleep.map_or_else(none, |asleep| {
                asleep.at(body.0, 0)..asleep.at(body.0 + 1, 0)
            })),
            Self::Contacts => one(t.contact.start()..t.contacts_end()),
            Self::ContactRow(row) => [
                t.contact.at(row, 0)..t.contact.at(row + 1, 0),
                t.contact_torque
                    .map_or_else(none, |torque| torque.at(row, 0)..torque.at(row + 1, 0)),
                // Where there is no such row, the shapes are known.
                if t.names_contacts() {
                    t.touching.at(row, 0)..t.touching.at(row + 1, 0)
                } else {
                    none()
                },
            ],
        }
    }

    fn exists(self, t: &OutputTables, model: &Model) {
        let (bodies, joints) = (model.bodies.len(), model.joints.len());
        match self {
            Self::Motion(body) | Self::Acceleration(body) | Self::Asleep(body) => {
                existing("body", body.0, bodies);
            }
            Self::Coordinates(joint) | Self::Velocities(joint) | Self::Reaction(joint) => {
                existing("joint", joint.0, joints);
            }
            Self::ContactRow(row) => {
                existing("row of contacts", row, t.contacts);
            }
            Self::Contacts => {}
        }
    }
}
