//! Numbers that change with time, to be plotted.

use crate::describe::axis;
use crate::protocol::Quantity;
use model::{BodyId, JointId, JointKind, Model};
use numbers::Float;
use sim::Outputs;

/// Bodies and coordinates beyond this many are not offered, so that the list stays readable.
const MOST: usize = 200;

/// What is measured, in one world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measure {
    KineticEnergy,
    PotentialEnergy,
    Energy,
    ContactForce,
    Contacts,
    Position(usize),
    Velocity(usize),
    Height(BodyId),
    Speed(BodyId),
    Reaction(JointId),
}

impl Measure {
    /// Its value.
    pub fn of<T: Float>(self, model: &Model, outputs: &Outputs<'_, T>, world: usize) -> f64 {
        match self {
            Self::KineticEnergy => outputs.kinetic_energy(world),
            Self::PotentialEnergy => outputs.potential_energy(world),
            Self::Energy => outputs.energy(world),
            Self::ContactForce => {
                let forces = outputs.contacts(world).map(|c| c.force.dot(c.normal));
                forces.sum()
            }
            Self::Contacts => {
                let presses = |c: &sim::Contact| c.force.length_squared() > 0.0;
                outputs.contacts(world).filter(presses).count() as f64
            }
            Self::Position(i) => outputs.joint_position(world)[i],
            Self::Velocity(i) => outputs.joint_velocity(world)[i],
            Self::Height(body) => {
                let up = model.up_axis.direction();
                outputs.body_position(world, body).dot(up)
            }
            Self::Speed(body) => outputs.body_velocity(world, body).length(),
            Self::Reaction(joint) => outputs.reaction(world, joint).0.length(),
        }
    }
}

/// What is measured, and what a page is told of it.
type Offer = (Measure, Quantity);

fn offer(measure: Measure, label: impl Into<String>, unit: &str, group: &str) -> Offer {
    let quantity = Quantity {
        label: label.into(),
        unit: unit.into(),
        group: group.into(),
    };
    (measure, quantity)
}

/// All that can be plotted of a model.
pub(crate) fn quantities(model: &Model) -> Vec<Offer> {
    let mut list = vec![
        offer(Measure::KineticEnergy, "Kinetic energy", "J", "energy"),
        offer(Measure::PotentialEnergy, "Potential energy", "J", "energy"),
        offer(Measure::Energy, "Energy", "J", "energy"),
        offer(Measure::ContactForce, "Contact force", "N", "contact"),
        offer(Measure::Contacts, "Contacts", "", "contact"),
    ];
    let names = model.coordinate_names();
    let joints = (0..model.joints.len()).map(JointId);
    let moving = joints
        .filter(|id| !model.joints[id.0].closes_loop && !model.coordinate_range(*id).is_empty());
    for id in moving.take(MOST) {
        list.extend(of_joint(model, id, &names));
    }
    for (i, body) in model.bodies.iter().enumerate().take(MOST) {
        let (id, name) = (BodyId(i), &body.name);
        list.push(offer(
            Measure::Height(id),
            format!("{name} height"),
            "m",
            "body",
        ));
        list.push(offer(
            Measure::Speed(id),
            format!("{name} speed"),
            "m/s",
            "body",
        ));
    }
    list
}

/// Coordinates, their speeds, and the force of a joint. Quaternions have no unit.
fn of_joint(model: &Model, id: JointId, names: &[String]) -> Vec<Offer> {
    let joint = &model.joints[id.0];
    let angular = |dof| axis(joint, dof).0;
    let shift = match joint.kind {
        JointKind::Ball => 0,
        JointKind::Free => 3,
        _ => joint.coordinates(),
    };
    let coordinates = model.coordinate_range(id).enumerate().map(|(i, row)| {
        let unit = match i {
            _ if i >= shift => "",
            _ if angular(i) => "rad",
            _ => "m",
        };
        offer(Measure::Position(row), names[row].clone(), unit, "joint")
    });
    let dofs = joint.dofs.iter().zip(model.dof_range(id)).enumerate();
    let speeds = dofs.map(|(i, (dof, row))| {
        let unit = if angular(i) { "rad/s" } else { "m/s" };
        let label = format!("{} (speed)", dof.name);
        offer(Measure::Velocity(row), label, unit, "joint")
    });
    let force = offer(
        Measure::Reaction(id),
        format!("{} (force)", joint.name),
        "N",
        "joint",
    );
    coordinates.chain(speeds).chain([force]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::{ball_joint, billiards, prismatic, room};

    #[test]
    fn units_are_those_of_the_coordinates() {
        let unit = |model: &Model, label: &str| {
            let found = quantities(model)
                .into_iter()
                .find(|(_, q)| q.label == label);
            found.unwrap_or_else(|| panic!("no {label}")).1.unit
        };
        let slider = prismatic().unwrap();
        assert_eq!(unit(&slider, "slider"), "m");
        assert_eq!(unit(&slider, "slider (speed)"), "m/s");
        let ball = ball_joint().unwrap();
        assert_eq!(unit(&ball, &ball.coordinate_names()[3]), "");
        assert_eq!(unit(&ball, "shoulder_0 (speed)"), "rad/s");
        let free = billiards().unwrap();
        assert_eq!(unit(&free, &free.coordinate_names()[2]), "m");
        assert_eq!(unit(&free, &free.coordinate_names()[3]), "");
        assert_eq!(unit(&room().unwrap(), "hinge"), "rad");
    }
}
