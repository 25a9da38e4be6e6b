//! What a user does to a body by hand: pulls it by a spring, pushes it.

use glam::{DQuat, DVec3};
use model::{AxisKind, BodyId, JointId, JointKind, Model, Pose};
use numbers::Float;
use sim::Outputs;

/// A point of a body that is drawn to a point of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grab {
    pub world: usize,
    pub body: BodyId,
    /// In the body's frame [m].
    pub point: DVec3,
    /// In the world [m].
    pub to: DVec3,
}

/// A blow on a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Push {
    pub world: usize,
    pub body: BodyId,
    /// In the body's frame [m].
    pub point: DVec3,
    /// World axes [N·s].
    pub impulse: DVec3,
}

/// Frequency [rad/s] at which the spring of a hand would swing what it holds as a whole.
const FREQUENCY: f64 = 12.0;

impl Grab {
    /// The force [N] of the hand for a time step h [s].
    ///
    /// A spring k and a damper c on the body's mass m, implicit in the step, so that no k shakes it:
    /// F = (k (x* − x) − (c + h k) v) / (1 + (h c + h² k) / m), with k of the whole mass M that hangs
    /// together, ω² M, and c = 2 ω √(m M).
    pub fn force<T: Float>(&self, model: &Model, outputs: &Outputs<'_, T>, h: f64) -> DVec3 {
        let m = model.bodies[self.body.0].mass;
        let whole = mass_of_tree(model, self.body);
        let k = FREQUENCY * FREQUENCY * whole;
        let c = 2.0 * FREQUENCY * (m * whole).sqrt();
        let arm = outputs.body_orientation(self.world, self.body) * self.point;
        let x = outputs.body_position(self.world, self.body) + arm;
        let spin = outputs.body_angular_velocity(self.world, self.body);
        let v = outputs.body_velocity(self.world, self.body) + spin.cross(arm);
        (k * (self.to - x) - (c + h * k) * v) / (1.0 + (h * c + h * h * k) / m)
    }
}

/// Mass [kg] of all bodies that joints tie to a body.
fn mass_of_tree(model: &Model, body: BodyId) -> f64 {
    let root = |mut body: BodyId| {
        while let Some(parent) = parent(model, body) {
            body = parent;
        }
        body
    };
    let mine = root(body);
    let bodies = (0..model.bodies.len()).map(BodyId);
    bodies
        .filter(|&other| root(other) == mine)
        .map(|other| model.bodies[other.0].mass)
        .sum()
}

fn parent(model: &Model, body: BodyId) -> Option<BodyId> {
    let joint = model.carrier(body)?;
    model.joints[joint.0].parent
}

/// Adds Jᵀ F, the generalised forces [N or N·m] of a force [N, world axes] on a point of a body [m, its
/// frame], to those of all degrees of freedom.
pub(crate) fn add_force<T: Float>(
    model: &Model,
    outputs: &Outputs<'_, T>,
    grab: (usize, BodyId, DVec3),
    force: DVec3,
    generalised: &mut [f64],
) {
    let (world, mut body, point) = grab;
    let at = outputs.body_pose(world, body).point(point);
    let position = outputs.joint_position(world);
    while let Some(joint) = model.carrier(body) {
        let coordinates = &position[model.coordinate_range(joint)];
        let forces = &mut generalised[model.dof_range(joint)];
        add_at_joint(
            model,
            outputs,
            (world, joint),
            (at, force),
            coordinates,
            forces,
        );
        match model.joints[joint.0].parent {
            Some(parent) => body = parent,
            None => return,
        }
    }
}

/// What the force F at x does along the degrees of freedom of one joint: n·F along an axis n,
/// n·((x − p) × F) about one through p.
fn add_at_joint<T: Float>(
    model: &Model,
    outputs: &Outputs<'_, T>,
    (world, id): (usize, JointId),
    (x, f): (DVec3, DVec3),
    coordinates: &[f64],
    forces: &mut [f64],
) {
    let joint = &model.joints[id.0];
    let pose = |body| outputs.body_pose(world, body);
    let parent = joint.parent.map_or(Pose::IDENTITY, pose) * joint.parent_frame;
    let child = pose(joint.child) * joint.child_frame;
    let turn = |p: DVec3, axes: DQuat| axes.inverse() * (x - p).cross(f);
    let add = |forces: &mut [f64], more: DVec3| {
        forces
            .iter_mut()
            .zip(more.to_array())
            .for_each(|(f, m)| *f += m);
    };
    match joint.kind {
        JointKind::Fixed | JointKind::Distance => {}
        JointKind::Ball => add(forces, turn(child.position, child.orientation)),
        JointKind::Free => {
            add(&mut forces[..3], parent.orientation.inverse() * f);
            add(&mut forces[3..], turn(child.position, child.orientation));
        }
        JointKind::Revolute | JointKind::Prismatic | JointKind::D6 | JointKind::PlaneXz => {
            let mut frame = parent;
            for ((axis, &q), force) in joint.axes.iter().zip(coordinates).zip(forces) {
                let n = frame.direction(axis.direction);
                *force += match axis.kind {
                    AxisKind::Linear => n.dot(f),
                    AxisKind::Angular => n.dot((x - frame.point(axis.anchor)).cross(f)),
                };
                frame = frame * axis.motion(q);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use model::examples::{Start, ball_joint, chain, ragdolls, rover};
    use rigid::Dynamics;
    use sim::{Simulation, SimulationSettings};

    /// Jᵀ F beside the Jacobian of the dynamics library, (ω, ẋ) = J q̇, in states that are not symmetric.
    #[test]
    fn generalised_forces_are_the_transposed_jacobian_times_the_force() {
        let models = [
            chain(4, Start::Horizontal),
            ball_joint(),
            ragdolls(1),
            rover(),
        ];
        for model in models.map(Result::unwrap) {
            let mut simulation =
                Simulation::<f32>::new(model.clone(), SimulationSettings::new(1, 0.002)).unwrap();
            simulation.step(60);
            let outputs = simulation.outputs();
            let n = model.degrees_of_freedom();
            let (point, force) = (DVec3::new(0.1, -0.2, 0.3), DVec3::new(3.0, -5.0, 7.0));
            for body in (0..model.bodies.len()).map(BodyId) {
                let mut found = vec![0.0; n];
                add_force(&model, &outputs, (0, body, point), force, &mut found);
                let dynamics = Dynamics::new(&model).unwrap();
                let position = outputs.joint_position(0);
                let j = dynamics.jacobian(&position, body, point).unwrap();
                for (i, found) in found.iter().enumerate() {
                    let column = DVec3::new(j[3 * n + i], j[4 * n + i], j[5 * n + i]);
                    let expected = column.dot(force);
                    assert!(
                        (found - expected).abs() < 1e-4 * (1.0 + expected.abs()),
                        "{} body {} dof {i}: {found} for {expected}",
                        model.name,
                        body.0
                    );
                }
            }
        }
    }
}
