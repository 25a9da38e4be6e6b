//! Numbers that change with time, to be plotted.

use crate::describe::axis;
use crate::protocol::Quantity;
use glam::DVec3;
use model::{BodyId, JointId, JointKind, Model};
use numbers::Float;
use sim::{Effort, Outputs, Simulation};

/// Bodies and joints beyond this many are not offered: of each there are some twenty quantities, which pages are told.
const MOST: usize = 1000;

/// What is measured, in one world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Measure {
    KineticEnergy,
    PotentialEnergy,
    Energy,
    /// Of all contacts, along their normals.
    ContactForce,
    Contacts,
    Height(BodyId),
    Position(usize),
    Velocity(usize),
    Drive(JointId, usize),
    Actuator(usize),
    /// A part of a vector.
    Part(Vector, Part),
}

/// A vector, in world axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Vector {
    Momentum,
    AngularMomentum,
    Position(BodyId),
    Velocity(BodyId),
    Spin(BodyId),
    /// Of all contacts on a body.
    ContactForce(BodyId),
    ReactionForce(JointId),
    ReactionTorque(JointId),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Part {
    Length,
    Along(usize),
}

impl Measure {
    /// Its value.
    pub fn of<T: Float>(
        self,
        simulation: &Simulation<T>,
        outputs: &Outputs<'_, T>,
        world: usize,
    ) -> f64 {
        let effort = Effort {
            simulation,
            outputs,
            world,
        };
        let model = simulation.model();
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
            Self::Height(body) => {
                let up = model.up_axis.direction();
                outputs.body_position(world, body).dot(up)
            }
            Self::Position(i) => outputs.coordinate(world, i),
            Self::Velocity(i) => outputs.dof_velocity(world, i),
            Self::Drive(joint, axis) => effort.of_drive(joint, axis),
            Self::Actuator(row) => {
                let gear = simulation.world_model(world).actuators[row].gear;
                gear * effort.of_actuator(row)
            }
            Self::Part(vector, part) => {
                let vector = vector.of(model, outputs, world);
                match part {
                    Part::Length => vector.length(),
                    Part::Along(axis) => vector[axis],
                }
            }
        }
    }
}

impl Vector {
    fn of<T: Float>(self, model: &Model, outputs: &Outputs<'_, T>, world: usize) -> DVec3 {
        match self {
            Self::Momentum => outputs.momentum(world),
            Self::AngularMomentum => outputs.angular_momentum(world),
            Self::Position(body) => outputs.body_position(world, body),
            Self::Velocity(body) => outputs.body_velocity(world, body),
            Self::Spin(body) => outputs.body_angular_velocity(world, body),
            Self::ContactForce(body) => {
                // The force is that of the first shape on the second.
                let sign = |c: &sim::Contact| {
                    let [first, second] = c.shapes.map(|s| model.shapes[s.0].body == Some(body));
                    f64::from(second) - f64::from(first)
                };
                outputs.contacts(world).map(|c| sign(&c) * c.force).sum()
            }
            Self::ReactionForce(joint) => outputs.reaction(world, joint).0,
            Self::ReactionTorque(joint) => outputs.reaction(world, joint).1,
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

/// The parts of a vector along the world's axes.
fn along(vector: Vector, label: &str, unit: &str, group: &str) -> Vec<Offer> {
    let part = |(axis, name)| {
        let measure = Measure::Part(vector, Part::Along(axis));
        offer(measure, format!("{label} {name}"), unit, group)
    };
    ["x", "y", "z"].into_iter().enumerate().map(part).collect()
}

/// How long a vector is, and its parts.
fn whole(vector: Vector, label: &str, unit: &str, group: &str) -> Vec<Offer> {
    let length = Measure::Part(vector, Part::Length);
    let mut all = vec![offer(length, label, unit, group)];
    all.extend(along(vector, label, unit, group));
    all
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
    let (momentum, angular) = (Vector::Momentum, Vector::AngularMomentum);
    list.extend(whole(momentum, "Momentum", "kg·m/s", "momentum"));
    list.extend(whole(angular, "Angular momentum", "kg·m²/s", "momentum"));
    let names = model.coordinate_names();
    for id in moving(model).take(MOST) {
        list.extend(of_joint(model, id, &names));
    }
    for (i, body) in model.bodies.iter().enumerate().take(MOST) {
        list.extend(of_body(BodyId(i), &body.name));
    }
    list
}

/// What is left out of [`quantities`], in a sentence, if anything is.
pub(crate) fn unlisted(model: &Model) -> Option<String> {
    let beyond = |all: usize, what: &str| {
        (all > MOST).then(|| format!("Of {all} {what} the first {MOST} are listed."))
    };
    let bodies = beyond(model.bodies.len(), "bodies");
    let joints = beyond(moving(model).count(), "joints");
    let all: Vec<_> = bodies.into_iter().chain(joints).collect();
    (!all.is_empty()).then(|| all.join(" "))
}

/// Joints with coordinates.
fn moving(model: &Model) -> impl Iterator<Item = JointId> {
    let joints = (0..model.joints.len()).map(JointId);
    joints.filter(|id| !model.joints[id.0].closes_loop && !model.coordinate_range(*id).is_empty())
}

/// Coordinates, their speeds, and the forces of a joint. Quaternions have no unit.
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
    let speeds = dofs.clone().map(|(i, (dof, row))| {
        let unit = if angular(i) { "rad/s" } else { "m/s" };
        let label = format!("{} (speed)", dof.name);
        offer(Measure::Velocity(row), label, unit, "joint")
    });
    let force = |i| if angular(i) { "N·m" } else { "N" };
    let driven = dofs.filter(|_| joint.kind != JointKind::Free);
    let drives = driven.map(|(i, (dof, _))| {
        let label = format!("{} (drive)", dof.name);
        offer(Measure::Drive(id, i), label, force(i), "joint")
    });
    let actuators = model.actuators.iter().enumerate();
    let actuators = actuators.filter(|(_, a)| a.joint == id).map(|(row, a)| {
        let label = format!("{} (actuator)", a.name);
        offer(Measure::Actuator(row), label, force(a.dof), "joint")
    });
    let name = &joint.name;
    let reactions = [
        (Vector::ReactionForce(id), "force", "N"),
        (Vector::ReactionTorque(id), "torque", "N·m"),
    ];
    let reactions = reactions
        .into_iter()
        .flat_map(|(vector, what, unit)| whole(vector, &format!("{name} ({what})"), unit, "joint"));
    let along = coordinates.chain(speeds).chain(drives).chain(actuators);
    along.chain(reactions).collect()
}

fn of_body(id: BodyId, name: &str) -> Vec<Offer> {
    let named = |what: &str| format!("{name} {what}");
    let mut list = vec![offer(Measure::Height(id), named("height"), "m", "body")];
    list.extend(along(Vector::Position(id), name, "m", "body"));
    let vectors = [
        (Vector::Velocity(id), "speed", "m/s"),
        (Vector::Spin(id), "spin", "rad/s"),
        (Vector::ContactForce(id), "contact force", "N"),
    ];
    for (vector, what, unit) in vectors {
        list.extend(whole(vector, &named(what), unit, "body"));
    }
    list
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::{ball_joint, billiards, prismatic, room, tower};
    use model::{Builder, Geometry};
    use sim::SimulationSettings;

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
        assert_eq!(unit(&room().unwrap(), "hinge (drive)"), "N·m");
    }

    #[test]
    fn forces_of_actuators_go_through_the_gears_of_their_world() {
        let with_gear = |gear| {
            let mut world = Builder::new("motor");
            let object = world.object("");
            let wheel = object.body("wheel").shape(Geometry::Sphere { radius: 0.1 });
            let wheel = wheel.handle();
            let hinge = object.revolute("hinge", wheel, DVec3::Z).handle();
            object.motor("motor", hinge).gear(gear);
            world.build().unwrap()
        };
        let settings = SimulationSettings::new(2, 0.01);
        let mut simulation = Simulation::<f64>::new(with_gear(2.0), settings).unwrap();
        simulation.set_world_model(1, &with_gear(3.0)).unwrap();
        for world in 0..2 {
            simulation.controls().set_control(world, &[5.0]).unwrap();
        }
        let force = |simulation: &Simulation<f64>, outputs: &Outputs<'_, f64>| {
            [0, 1].map(|world| Measure::Actuator(0).of(simulation, outputs, world))
        };
        assert_eq!(simulation.observe(force).unwrap(), [10.0, 15.0]);
    }

    #[test]
    fn labels_are_unique_and_what_is_left_out_is_told() {
        for scene in &model::examples::SCENES {
            let model = scene.model().unwrap();
            let mut labels: Vec<_> = quantities(&model)
                .into_iter()
                .map(|(_, q)| q.label)
                .collect();
            let all = labels.len();
            labels.sort();
            labels.dedup();
            assert_eq!(labels.len(), all, "{}", scene.name);
        }
        assert_eq!(unlisted(&tower(1000, 0.0).unwrap()), None);
        let told = unlisted(&tower(1001, 0.0).unwrap()).unwrap();
        assert!(told.contains("Of 1001 bodies the first 1000"), "{told}");
    }
}
