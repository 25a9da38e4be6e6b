//! Tables of all worlds at once, as plain arrays: what is reported, and what a controller sets.

use crate::error::{MOST_FORCE, MOST_MOTION, SimulationError, bounded, index, length};
use crate::simulation::RUNS_PER_THREAD;
use crate::spatial::{Spatial, Trees};
use crate::{Controls, Outputs, Simulation};
use model::{BodyId, Model, Shape};
use numbers::{Float, Table};
use rayon::prelude::*;
use rigid::{OutputTables, Report, body, contact, reaction, total};
use std::ops::Range;

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
    /// Centre of mass [m] of all dynamic bodies, world axes, one row of 3; the origin where there are none.
    CenterOfMass,
    /// Inertia of each body about the centre of mass C of its tree, along the world's axes: a row of 10 for each
    /// body, Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg·m²], m (c − C) [kg·m], m [kg], with the body's own centre c. MuJoCo's
    /// `cinert`.
    ///
    /// A tree is all that joints carry from one body on that hangs on the world or on a static body. Static bodies
    /// have no mass, here.
    SpatialInertia,
    /// Angular velocity [rad/s] of each body and the velocity [m/s] that it has at the centre of mass of its tree,
    /// world axes: a row of 6 for each body. MuJoCo's `cvel`.
    SpatialVelocity,
    /// Torque [N·m] about the centre of mass of its tree and force [N] of the contacts of the last step on each
    /// body, world axes: a row of 6 for each body, zero before the first step. MuJoCo's `cfrc_ext`, as far as
    /// contacts go.
    SpatialContactForce,
    /// Kinetic energy [J], one row.
    KineticEnergy,
    /// Potential energy [J] of weight and passive springs, one row.
    PotentialEnergy,
    /// Linear momentum [kg·m/s], one row of 3.
    Momentum,
    /// Angular momentum [kg·m²/s] about the world's origin, one row of 3.
    AngularMomentum,
    /// How often a cap on a force or displacement has bitten since the world was reset, with `xpbd`; how many contacts there
    /// was no room to remember, with `impulse`; else zero: one row.
    Capped,
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
    /// The same, as few ranges as that can be.
    fn ranges(self) -> Vec<Range<usize>> {
        if self.width == self.stride {
            let all = self.start..self.start + self.count * self.stride;
            return vec![all];
        }
        let rows = (0..self.count).map(|row| self.start + row * self.stride);
        rows.map(|row| row..row + self.width).collect()
    }
}

/// Where a quantity comes from.
#[derive(Clone, Copy, Debug)]
enum Source {
    /// It lies in the output.
    Output(Rows),
    /// Contacts, summed for each body.
    Contacts,
    /// The same, about the centre of mass of the body's tree.
    SpatialContacts,
    /// The bodies' motion and masses.
    Spatial(Spatial),
}

impl Quantity {
    /// All of them: those first that tell where joints are, then bodies, then what touches, which take less to be told than
    /// all else.
    pub const ALL: [Self; 19] = [
        Self::JointPosition,
        Self::JointVelocity,
        Self::BodyPosition,
        Self::BodyOrientation,
        Self::BodyVelocity,
        Self::BodyAngularVelocity,
        Self::CenterOfMass,
        Self::SpatialInertia,
        Self::SpatialVelocity,
        Self::ContactWrench,
        Self::SpatialContactForce,
        Self::JointAcceleration,
        Self::ReactionForce,
        Self::ReactionTorque,
        Self::KineticEnergy,
        Self::PotentialEnergy,
        Self::Momentum,
        Self::AngularMomentum,
        Self::Capped,
    ];
    /// Rows of it in each world, and numbers in each row.
    pub fn shape(self, model: &Model) -> [usize; 2] {
        let bodies = model.bodies.len();
        match self.source(&OutputTables::new(model), model) {
            Source::Output(rows) => [rows.count, rows.width],
            Source::Contacts | Source::SpatialContacts => [bodies, WRENCH],
            Source::Spatial(Spatial::Center) => [1, Spatial::Center.width()],
            Source::Spatial(of_body) => [bodies, of_body.width()],
        }
    }
    /// How much of the output has to be of the present state.
    pub(crate) fn needs(self) -> Report {
        match self {
            Self::JointPosition | Self::JointVelocity => Report::Joints,
            Self::BodyPosition
            | Self::BodyOrientation
            | Self::BodyVelocity
            | Self::BodyAngularVelocity
            | Self::CenterOfMass
            | Self::SpatialInertia
            | Self::SpatialVelocity => Report::Motion,
            Self::ContactWrench | Self::SpatialContactForce => Report::Contacts,
            _ => Report::Everything,
        }
    }
    /// The numbers of the output that it is made of.
    pub(crate) fn made_of(self, t: &OutputTables, model: &Model) -> Vec<Range<usize>> {
        let bodies = t.body.start()..t.body_acceleration.start();
        let contacts = t.contact.start()..t.contacts_end();
        match self.source(t, model) {
            Source::Output(rows) => rows.ranges(),
            Source::Contacts => vec![contacts],
            Source::SpatialContacts => vec![bodies, contacts],
            Source::Spatial(_) => vec![bodies],
        }
    }
    /// The numbers of the output from its first row on, how far rows are apart, and how wide they are, if it lies there.
    pub(crate) fn rows(
        self,
        t: &OutputTables,
        model: &Model,
    ) -> Option<(Range<usize>, usize, usize)> {
        match self.source(t, model) {
            Source::Output(rows) => {
                let end = rows.start + rows.count * rows.stride;
                Some((rows.start..end, rows.stride, rows.width))
            }
            _ => None,
        }
    }
    fn source(self, t: &OutputTables, model: &Model) -> Source {
        let (bodies, joints) = (model.bodies.len(), model.joints.len());
        let (coordinates, dofs) = (model.coordinates(), model.degrees_of_freedom());
        Source::Output(match self {
            Self::BodyPosition => Rows::of(t.body, bodies, body::POSITION, 3),
            Self::BodyOrientation => Rows::of(t.body, bodies, body::ORIENTATION, 4),
            Self::BodyVelocity => Rows::of(t.body, bodies, body::VELOCITY, 3),
            Self::BodyAngularVelocity => Rows::of(t.body, bodies, body::ANGULAR_VELOCITY, 3),
            Self::JointPosition => Rows::of(t.position, coordinates, 0, 1),
            Self::JointVelocity => Rows::of(t.velocity, dofs, 0, 1),
            Self::JointAcceleration => Rows::of(t.acceleration, dofs, 0, 1),
            Self::ReactionForce => Rows::of(t.reaction, joints, reaction::FORCE, 3),
            Self::ReactionTorque => Rows::of(t.reaction, joints, reaction::TORQUE, 3),
            Self::KineticEnergy => Rows::of(t.total, 1, total::KINETIC, 1),
            Self::PotentialEnergy => Rows::of(t.total, 1, total::POTENTIAL, 1),
            Self::Momentum => Rows::of(t.total, 1, total::MOMENTUM, 3),
            Self::AngularMomentum => Rows::of(t.total, 1, total::ANGULAR_MOMENTUM, 3),
            Self::Capped => Rows::of(t.total, 1, total::CAPPED, 1),
            Self::ContactWrench => return Source::Contacts,
            Self::SpatialContactForce => return Source::SpatialContacts,
            Self::CenterOfMass => return Source::Spatial(Spatial::Center),
            Self::SpatialInertia => return Source::Spatial(Spatial::Inertia),
            Self::SpatialVelocity => return Source::Spatial(Spatial::Velocity),
        })
    }
}

/// Numbers from which on threads share the copying: fewer are copied sooner than threads wake.
const SHARED: usize = 1 << 15;

/// Worlds that are copied at once on their way into columns, a few blocks: they stay in the nearest caches.
const AT_ONCE: usize = 128;

impl<T: Float> Simulation<T> {
    /// Copies a quantity of what was last reported: `out[world][row][number]`.
    pub(crate) fn copy(&self, quantity: Quantity, out: &mut [T]) -> Result<(), SimulationError> {
        let [rows, width] = quantity.shape(self.model());
        let (blocks, lanes) = (self.output.blocks(), self.output.width());
        length("the array", out.len(), self.worlds() * rows * width)?;
        if out.is_empty() {
            return Ok(());
        }
        let source = quantity.source(&self.output_tables, self.model());
        if out.len() < SHARED || blocks == 1 {
            self.copy_from(source, 0, out);
            return Ok(());
        }
        let run = lanes * blocks.div_ceil(self.threads() * RUNS_PER_THREAD);
        let parts = out.par_chunks_mut(run * rows * width).enumerate();
        self.threads
            .run(|| parts.for_each(|(part, out)| self.copy_from(source, part * run, out)));
        Ok(())
    }
    /// The same, into columns of a table.
    pub(crate) fn copy_columns<U: Float>(
        &self,
        quantity: Quantity,
        table: &mut [U],
        column: usize,
    ) -> Result<(), SimulationError> {
        let worlds = self.worlds();
        let numbers: usize = quantity.shape(self.model()).iter().product();
        let columns = table.len() / worlds;
        length("the table", table.len(), worlds * columns)?;
        index("last column", column + numbers, columns + 1)?;
        if numbers == 0 {
            return Ok(());
        }
        let (blocks, lanes) = (self.output.blocks(), self.output.width());
        let source = quantity.source(&self.output_tables, self.model());
        let run = lanes * blocks.div_ceil(self.threads() * RUNS_PER_THREAD);
        let place = |first: usize, table: &mut [U]| {
            let mut some = vec![T::zero(); (table.len() / columns).min(AT_ONCE) * numbers];
            for (i, table) in table.chunks_mut(AT_ONCE * columns).enumerate() {
                let some = &mut some[..table.len() / columns * numbers];
                self.copy_from(source, first + i * AT_ONCE, some);
                for (row, from) in table.chunks_mut(columns).zip(some.chunks(numbers)) {
                    for (to, x) in row[column..].iter_mut().zip(from) {
                        *to = U::from_f64(x.to_f64());
                    }
                }
            }
        };
        if table.len() < SHARED || blocks == 1 {
            place(0, table);
            return Ok(());
        }
        let parts = table.par_chunks_mut(run * columns).enumerate();
        self.threads
            .run(|| parts.for_each(|(part, table)| place(part * run, table)));
        Ok(())
    }
    /// The same of the worlds from the first of a block on, of as many as there is room for.
    fn copy_from(&self, source: Source, first: usize, out: &mut [T]) {
        let bodies = self.model().bodies.len();
        match source {
            Source::Output(rows) => self.output.gather(first, &rows.offsets(), out),
            Source::Contacts => {
                self.last_reported()
                    .sum_contacts(&self.model().shapes, bodies, first, out);
            }
            Source::SpatialContacts => {
                self.copy_from(Source::Contacts, first, out);
                let mut centers = vec![T::zero(); out.len() / WRENCH * 3];
                let trees = Trees::of_each_body(self.model());
                self.work_out(Spatial::Center, &trees, first, &mut centers);
                for (row, center) in out.chunks_exact_mut(WRENCH).zip(centers.chunks_exact(3)) {
                    about(center, row);
                }
            }
            Source::Spatial(Spatial::Center) => {
                self.work_out(Spatial::Center, &Trees::one(self.model()), first, out);
            }
            Source::Spatial(of_body) => {
                self.work_out(of_body, &Trees::of_each_body(self.model()), first, out);
            }
        }
    }
}

/// From a force f and a torque t about the world's origin to the torque t − C × f about C, and f.
fn about<T: Float>(center: &[T], row: &mut [T]) {
    let (force, torque) = row.split_at_mut(3);
    let [x, y, z] = [center[0], center[1], center[2]];
    let [fx, fy, fz] = [force[0], force[1], force[2]];
    torque[0] -= y * fz - z * fy;
    torque[1] -= z * fx - x * fz;
    torque[2] -= x * fy - y * fx;
    force.swap_with_slice(torque);
}

impl<T: Float> Outputs<'_, T> {
    /// What all contacts do to the bodies of both shapes, in the worlds from the first of a block on.
    fn sum_contacts(&self, shapes: &[Shape], bodies: usize, first: usize, out: &mut [T]) {
        out.fill(T::zero());
        let (table, width) = (self.tables.contact, self.memory.width());
        let far = T::from_f64(0.5 * collide::FAR);
        for (i, out) in out.chunks_mut(width * bodies * WRENCH).enumerate() {
            let start = first + i * width;
            let block = self.memory.block(start / width);
            let lanes = out.len() / (bodies * WRENCH);
            for row in 0..self.tables.contacts {
                let fields = &block[table.at(row, 0) * width..][..contact::WIDTH * width];
                let distances = &fields[contact::DISTANCE * width..][..lanes];
                // A sum of bits, not a search, so that it takes a register at a time.
                if distances.iter().map(|x| u32::from(*x < far)).sum::<u32>() == 0 {
                    continue;
                }
                for (lane, _) in distances.iter().enumerate().filter(|(_, x)| **x < far) {
                    let ends = self.touching(start + lane, row);
                    let ends = ends.map(|shape| shapes[shape.0].body);
                    let sums = &mut out[lane * bodies * WRENCH..][..bodies * WRENCH];
                    let number = |at: usize| block[at * width + lane];
                    let torque = self.tables.contact_torque.map_or([T::zero(); 3], |torque| {
                        [0, 1, 2].map(|i| number(torque.at(row, i)))
                    });
                    add_contact(ends, |field| fields[field * width + lane], torque, sums);
                }
            }
        }
    }
}

/// Adds the force f and the torque t + x × f of a contact to those of two bodies, of the first with the other sign.
fn add_contact<T: Float>(
    ends: [Option<BodyId>; 2],
    number: impl Fn(usize) -> T,
    [tx, ty, tz]: [T; 3],
    sums: &mut [T],
) {
    let [fx, fy, fz] = [0, 1, 2].map(|i| number(contact::FORCE + i));
    let [x, y, z] = [0, 1, 2].map(|i| number(contact::POSITION + i));
    let wrench = [
        fx,
        fy,
        fz,
        tx + y * fz - z * fy,
        ty + z * fx - x * fz,
        tz + x * fy - y * fx,
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
        self.memory.gather(0, &offsets, out);
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
        self.changes.include(self.range(control));
        Ok(())
    }

    fn offsets(&self, control: Control) -> Vec<usize> {
        self.range(control).collect()
    }
    pub(crate) fn range(&self, control: Control) -> Range<usize> {
        let t = self.tables;
        match control {
            Control::Force => t.force.start()..t.target_position.start(),
            Control::TargetPosition => t.target_position.start()..t.target_velocity.start(),
            Control::TargetVelocity => t.target_velocity.start()..t.control.start(),
            Control::Actuator => t.control.start()..t.length,
        }
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
