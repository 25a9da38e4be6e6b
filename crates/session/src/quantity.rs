//! Numbers that change with time, to be plotted.

use crate::protocol::Quantity;
use model::{BodyId, JointId, Model};
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
    pub fn of(self, model: &Model, outputs: &Outputs<'_, f32>, world: usize) -> f64 {
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

/// All that can be plotted of a model: what it is, and what a page is told of it.
pub(crate) fn quantities(model: &Model) -> Vec<(Measure, Quantity)> {
    let mut list = Vec::new();
    let mut add = |measure, label: String, unit: &str, group: &str| {
        let (unit, group) = (unit.to_owned(), group.to_owned());
        list.push((measure, Quantity { label, unit, group }));
    };
    add(
        Measure::KineticEnergy,
        "Kinetic energy".into(),
        "J",
        "energy",
    );
    add(
        Measure::PotentialEnergy,
        "Potential energy".into(),
        "J",
        "energy",
    );
    add(Measure::Energy, "Energy".into(), "J", "energy");
    add(
        Measure::ContactForce,
        "Contact force".into(),
        "N",
        "contact",
    );
    add(Measure::Contacts, "Contacts".into(), "", "contact");
    let jointed =
        |id: JointId| !model.joints[id.0].closes_loop && !model.coordinate_range(id).is_empty();
    let joints = (0..model.joints.len())
        .map(JointId)
        .filter(|&id| jointed(id));
    let names = model.coordinate_names();
    for id in joints.take(MOST) {
        let joint = &model.joints[id.0];
        let free = joint.coordinates() != joint.degrees_of_freedom();
        for (i, row) in model.coordinate_range(id).enumerate() {
            let angular = !free && joint.axes[i].kind == model::AxisKind::Angular;
            let unit = match (free, angular) {
                (true, _) => "",
                (_, true) => "rad",
                (_, false) => "m",
            };
            add(Measure::Position(row), names[row].clone(), unit, "joint");
        }
        for (dof, row) in joint.dofs.iter().zip(model.dof_range(id)) {
            add(
                Measure::Velocity(row),
                format!("{} (speed)", dof.name),
                "",
                "joint",
            );
        }
        add(
            Measure::Reaction(id),
            format!("{} (force)", joint.name),
            "N",
            "joint",
        );
    }
    for (i, body) in model.bodies.iter().enumerate().take(MOST) {
        add(
            Measure::Height(BodyId(i)),
            format!("{} height", body.name),
            "m",
            "body",
        );
        add(
            Measure::Speed(BodyId(i)),
            format!("{} speed", body.name),
            "m/s",
            "body",
        );
    }
    list
}
