//! Tables of all worlds at once, as plain arrays: what is reported, and what a controller sets.

use crate::error::{MOST_FORCE, MOST_MOTION, SimulationError, bounded, length};
use crate::simulation::Reported;
use crate::{Controls, Outputs};
use model::{BodyId, Model, Shape};
use numbers::{Float, Table};
use rigid::{OutputTables, body, contact, reaction, total};

/// A reported quantity of every world, as [`Simulation::read`](crate::Simulation::read) copies it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// Positions of the bodies' frames [m]: a row of 3 for each body.
    BodyPosition,
    /// Orientations of the bodies' frames, x, y, z, w: a row of 4 for each body.
    BodyOrientation,
    /// Velocities of the bodies' origins [m/s], world axes: a row of 3 for each body.
    BodyVelocity,
    /// Angular velocities of the bodies [rad/s], world axes: a row of 3 for each body.
    BodyAngularVelocity,
    /// Coordinates of the joints [m, rad, quaternions x, y, z, w], one a row.
    JointPosition,
    /// Velocities of the joints [m/s or rad/s], one a row.
    JointVelocity,
    /// Accelerations of the joints [m/s² or rad/s²], one a row.
    JointAcceleration,
    /// Forces of the joints on their children [N], world axes: a row of 3 for each joint.
    ReactionForce,
    /// Torques of the joints on their children about the joint's frame [N·m], world axes: a row of 3 for
    /// each joint.
    ReactionTorque,
    /// Force [N] and torque [N·m] about the world's origin of the contacts of the last step on each body, world
    /// axes: a row of 6 for each body, zero before the first step.
    ContactWrench,
    /// Kinetic energy [J], one row.
    KineticEnergy,
    /// Potential energy [J] of weight and passive springs, one row.
    PotentialEnergy,
    /// Linear momentum [kg·m/s], one row of 3.
    Momentum,
    /// Angular momentum [kg·m²/s] about the world's origin, one row of 3.
    AngularMomentum,
}

/// Numbers of a force and a torque.
const WRENCH: usize = 6;

/// Rows of numbers among others: where the first begins, how many there are, how far each is from the
/// next, and how many numbers of each are meant.
#[derive(Clone, Copy, Debug)]
struct Rows {
    start: usize,
    count: usize,
    stride: usize,
    width: usize,
}

impl Rows {
    fn of<S, const W: usize>(table: Table<S, W>, count: usize, field: usize, width: usize) -> Self {
        Self {
            start: table.start() + field,
            count,
            stride: W,
            width,
        }
    }
    fn offsets(self) -> Vec<usize> {
        let rows = (0..self.count).map(|row| self.start + row * self.stride);
        rows.flat_map(|row| row..row + self.width).collect()
    }
}

impl Quantity {
    /// Rows of it in each world, and numbers in each row.
    pub fn shape(self, model: &Model) -> [usize; 2] {
        match self.rows(&OutputTables::new(model), model) {
            Some(rows) => [rows.count, rows.width],
            None => [model.bodies.len(), WRENCH],
        }
    }
    /// How much of the output has to be of the present state.
    pub(crate) fn needs(self) -> Reported {
        match self {
            Self::BodyPosition
            | Self::BodyOrientation
            | Self::BodyVelocity
            | Self::BodyAngularVelocity
            | Self::JointPosition
            | Self::JointVelocity => Reported::Motion,
            Self::ContactWrench => Reported::Contacts,
            _ => Reported::Everything,
        }
    }
    /// Where it lies in the output; nowhere, if it is summed as it is read.
    fn rows(self, t: &OutputTables, model: &Model) -> Option<Rows> {
        let (bodies, joints) = (model.bodies.len(), model.joints.len());
        let (coordinates, dofs) = (model.coordinates(), model.degrees_of_freedom());
        Some(match self {
            Self::BodyPosition => Rows::of(t.body, bodies, body::POSITION, 3),
            Self::BodyOrientation => Rows::of(t.body, bodies, body::ORIENTATION, 4),
            Self::BodyVelocity => Rows::of(t.body, bodies, body::VELOCITY, 3),
            Self::BodyAngularVelocity => Rows::of(t.body, bodies, body::ANGULAR_VELOCITY, 3),
            Self::JointPosition => Rows::of(t.position, coordinates, 0, 1),
            Self::JointVelocity => Rows::of(t.velocity, dofs, 0, 1),
            Self::JointAcceleration => Rows::of(t.acceleration, dofs, 0, 1),
            Self::ReactionForce => Rows::of(t.reaction, joints, reaction::FORCE, 3),
            Self::ReactionTorque => Rows::of(t.reaction, joints, reaction::TORQUE, 3),
            Self::ContactWrench => return None,
            Self::KineticEnergy => Rows::of(t.total, 1, total::KINETIC, 1),
            Self::PotentialEnergy => Rows::of(t.total, 1, total::POTENTIAL, 1),
            Self::Momentum => Rows::of(t.total, 1, total::MOMENTUM, 3),
            Self::AngularMomentum => Rows::of(t.total, 1, total::ANGULAR_MOMENTUM, 3),
        })
    }
}

impl<T: Float> Outputs<'_, T> {
    /// Copies a quantity of all worlds of a model: `out[world][row][number]`.
    pub(crate) fn read(
        &self,
        model: &Model,
        quantity: Quantity,
        out: &mut [T],
    ) -> Result<(), SimulationError> {
        let [rows, width] = quantity.shape(model);
        length("the array", out.len(), self.worlds() * rows * width)?;
        match quantity.rows(self.tables, model) {
            Some(rows) => self.memory.gather(&rows.offsets(), out),
            None => self.sum_contacts(&model.shapes, rows, out),
        }
        Ok(())
    }
    /// What all contacts do to the bodies of both shapes.
    fn sum_contacts(&self, shapes: &[Shape], bodies: usize, out: &mut [T]) {
        out.fill(T::zero());
        let (table, width) = (self.tables.contact, self.memory.width());
        let far = T::from_f64(0.5 * collide::FAR);
        for first in (0..self.worlds()).step_by(width) {
            let block = self.memory.block(first / width);
            let lanes = width.min(self.worlds() - first);
            for row in 0..self.tables.contacts {
                let fields = &block[table.at(row, 0) * width..][..contact::WIDTH * width];
                let distances = &fields[contact::DISTANCE * width..][..lanes];
                // A sum of bits, not a search, so that it takes a register at a time.
                if distances.iter().map(|x| u32::from(*x < far)).sum::<u32>() == 0 {
                    continue;
                }
                for (lane, _) in distances.iter().enumerate().filter(|(_, x)| **x < far) {
                    let world = first + lane;
                    let ends = self.touching(world, row).map(|shape| shapes[shape.0].body);
                    let sums = &mut out[world * bodies * WRENCH..][..bodies * WRENCH];
                    add_contact(ends, |field| fields[field * width + lane], sums);
                }
            }
        }
    }
}

/// Adds the force f and the torque x × f of a contact to those of two bodies, of the first with the other sign.
fn add_contact<T: Float>(ends: [Option<BodyId>; 2], number: impl Fn(usize) -> T, sums: &mut [T]) {
    let [fx, fy, fz] = [0, 1, 2].map(|i| number(contact::FORCE + i));
    let [x, y, z] = [0, 1, 2].map(|i| number(contact::POSITION + i));
    let wrench = [
        fx,
        fy,
        fz,
        y * fz - z * fy,
        z * fx - x * fz,
        x * fy - y * fx,
    ];
    for (body, sign) in ends.into_iter().zip([-T::one(), T::one()]) {
        if let Some(body) = body {
            let row = &mut sums[body.0 * WRENCH..][..WRENCH];
            for (sum, x) in row.iter_mut().zip(wrench) {
                *sum += sign * x;
            }
        }
    }
}

/// What a controller sets in every world. Its array has the shape (worlds, degrees of freedom), that of
/// the actuators (worlds, actuators).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// Generalised forces [N or N·m].
    Force,
    /// Position targets of the drives [m or rad].
    TargetPosition,
    /// Velocity targets of the drives [m/s or rad/s].
    TargetVelocity,
    /// Controls of the actuators.
    Actuator,
}

impl Control {
    fn name(self) -> &'static str {
        match self {
            Self::Force => "force",
            Self::TargetPosition => "target position",
            Self::TargetVelocity => "target velocity",
            Self::Actuator => "control",
        }
    }
    fn most(self) -> f64 {
        match self {
            Self::Force | Self::Actuator => MOST_FORCE,
            Self::TargetPosition | Self::TargetVelocity => MOST_MOTION,
        }
    }
}

impl<T: Float> Controls<'_, T> {
    /// Numbers that each world has of these.
    pub fn count(&self, control: Control) -> usize {
        self.offsets(control).len()
    }
    /// Copies these of all worlds: `out[world][row]`.
    ///
    /// # Errors
    /// An array of the wrong length.
    pub fn read(&self, control: Control, out: &mut [T]) -> Result<(), SimulationError> {
        let offsets = self.offsets(control);
        length("the array", out.len(), self.worlds() * offsets.len())?;
        self.memory.gather(&offsets, out);
        Ok(())
    }
    /// Sets these in all worlds: `numbers[world][row]`.
    ///
    /// # Errors
    /// An array of the wrong length; a number that is not finite or too large, whose world is told. Nothing
    /// is set then.
    pub fn write(&mut self, control: Control, numbers: &[T]) -> Result<(), SimulationError> {
        let offsets = self.offsets(control);
        length(control.name(), numbers.len(), self.worlds() * offsets.len())?;
        let most = T::from_f64(control.most());
        // False for NaN, too. A sum of bits, not a search, so that it takes a register at a time.
        let wrong = |x: &T| u32::from(!(-most <= *x && *x <= most));
        if numbers.iter().map(wrong).sum::<u32>() > 0 {
            return Err(out_of_bounds(control, numbers, offsets.len()));
        }
        self.memory.scatter(&offsets, numbers);
        Ok(())
    }

    fn offsets(&self, control: Control) -> Vec<usize> {
        let t = self.tables;
        let range = match control {
            Control::Force => t.force.start()..t.target_position.start(),
            Control::TargetPosition => t.target_position.start()..t.target_velocity.start(),
            Control::TargetVelocity => t.target_velocity.start()..t.control.start(),
            Control::Actuator => t.control.start()..t.length,
        };
        range.collect()
    }
}

/// The first world whose row is refused, and why.
fn out_of_bounds<T: Float>(control: Control, numbers: &[T], columns: usize) -> SimulationError {
    let rows = numbers.chunks_exact(columns).enumerate();
    let mut refused = rows.filter_map(|(world, row)| {
        let row: Vec<f64> = row.iter().map(|x| x.to_f64()).collect();
        let why = bounded(control.name(), &row, control.most()).err()?;
        let why = Box::new(why);
        Some(SimulationError::InWorld { world, why })
    });
    refused.next().expect("a number is out of bounds")
}
