//! What the worlds look like, as plain numbers.

use crate::SimulationError;
use glam::{DQuat, DVec3};
use model::{BodyId, JointId, Pose, ShapeId};
use numbers::machine::space::Output;
use numbers::{Float, Memory, Table};
use rigid::{OutputTables, body, body_acceleration, contact, reaction, total};

/// The reported quantities of all worlds at one time.
///
/// Panics where a world, body, joint or row does not exist, as an array would.
#[derive(Clone, Copy, Debug)]
pub struct Outputs<'a, T> {
    pub(crate) memory: &'a Memory<T>,
    pub(crate) tables: &'a OutputTables,
    /// Of each row of contacts.
    pub(crate) shapes: &'a [[ShapeId; 2]],
}

/// A point at which two shapes touch, or were about to in the last step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// The shapes; the second one moves.
    pub shapes: [ShapeId; 2],
    /// Midway between the surfaces [m], world axes.
    pub position: DVec3,
    /// Unit vector from the first shape to the second, world axes.
    pub normal: DVec3,
    /// Gap between the surfaces less their margin [m]; negative where they overlap.
    pub distance: f64,
    /// Force [N] of the first shape on the second, world axes; zero where they do not press, as
    /// sensors never do.
    pub force: DVec3,
    /// Torque [N·m] of the first shape on the second against twisting and rolling, besides that of the force at the
    /// position; world axes.
    pub torque: DVec3,
    /// Whole number, the same from step to step while the same features touch.
    pub feature: u32,
}

impl<T: Float> Outputs<'_, T> {
    /// Number of worlds.
    pub fn worlds(&self) -> usize {
        self.memory.worlds()
    }
    /// Placement of a body's frame in the world.
    pub fn body_pose(&self, world: usize, body: BodyId) -> Pose {
        Pose::new(
            self.body_position(world, body),
            self.body_orientation(world, body),
        )
    }
    /// Position of a body's frame [m].
    pub fn body_position(&self, world: usize, id: BodyId) -> DVec3 {
        self.vec3(world, self.tables.body, self.body(id), body::POSITION)
    }
    /// Orientation of a body's frame, x, y, z, w.
    pub fn body_orientation(&self, world: usize, id: BodyId) -> DQuat {
        let (table, row) = (self.tables.body, self.body(id));
        DQuat::from_array(self.numbers(world, table, row, body::ORIENTATION))
    }
    /// Velocity of a body frame's origin [m/s].
    pub fn body_velocity(&self, world: usize, id: BodyId) -> DVec3 {
        self.vec3(world, self.tables.body, self.body(id), body::VELOCITY)
    }
    /// Angular velocity of a body [rad/s], world axes.
    pub fn body_angular_velocity(&self, world: usize, id: BodyId) -> DVec3 {
        let (table, row) = (self.tables.body, self.body(id));
        self.vec3(world, table, row, body::ANGULAR_VELOCITY)
    }
    /// Acceleration of a body frame's origin [m/s²], world axes. Of `featherstone` the one at this moment
    /// under the contact forces of the last step; of the other solvers the mean over the last substep, so
    /// zero in a world that has just been set.
    pub fn body_acceleration(&self, world: usize, id: BodyId) -> DVec3 {
        let (table, row) = (self.tables.body_acceleration, self.body(id));
        self.vec3(world, table, row, body_acceleration::LINEAR)
    }
    /// Angular acceleration of a body [rad/s²], world axes; as
    /// [`body_acceleration`](Outputs::body_acceleration).
    pub fn body_angular_acceleration(&self, world: usize, id: BodyId) -> DVec3 {
        let (table, row) = (self.tables.body_acceleration, self.body(id));
        self.vec3(world, table, row, body_acceleration::ANGULAR)
    }
    /// Whether a body sleeps: it stays where it is until something touches it. False for what never
    /// moves, and for solvers that let no body sleep: all but `impulse`.
    pub fn asleep(&self, world: usize, id: BodyId) -> bool {
        existing("world", world, self.memory.worlds());
        let (table, row) = (self.tables.asleep, self.body(id));
        table.is_some_and(|table| self.number(world, table, row, 0) != 0.0)
    }
    /// Joint coordinates in the model's order [m, rad, quaternions x, y, z, w];
    /// axes that [turn without end](model::Model::turns_without_end) are in [−π, π].
    pub fn joint_position(&self, world: usize) -> Vec<f64> {
        self.column(world, self.tables.position, self.tables.velocity)
    }
    /// One of the numbers of [`joint_position`](Outputs::joint_position).
    pub fn coordinate(&self, world: usize, row: usize) -> f64 {
        let (table, next) = (self.tables.position, self.tables.velocity);
        let row = existing("coordinate", row, rows(table, next));
        self.number(world, table, row, 0)
    }
    /// One of the numbers of [`joint_velocity`](Outputs::joint_velocity).
    pub fn dof_velocity(&self, world: usize, dof: usize) -> f64 {
        let (table, next) = (self.tables.velocity, self.tables.acceleration);
        let row = existing("degree of freedom", dof, rows(table, next));
        self.number(world, table, row, 0)
    }
    /// Joint velocities in the model's order [m/s or rad/s].
    pub fn joint_velocity(&self, world: usize) -> Vec<f64> {
        self.column(world, self.tables.velocity, self.tables.acceleration)
    }
    /// Joint accelerations in the model's order [m/s² or rad/s²].
    pub fn joint_acceleration(&self, world: usize) -> Vec<f64> {
        self.column(world, self.tables.acceleration, self.tables.total)
    }
    /// Force [N] and torque [N·m] of a joint on its child, world axes; the torque
    /// is about the child's joint frame. Where a step has several substeps, of the last one; with `impulse` the mean over
    /// it.
    pub fn reaction(&self, world: usize, joint: JointId) -> (DVec3, DVec3) {
        let table = self.tables.reaction;
        // The last row is of no joint.
        let row = existing("joint", joint.0, rows(table, self.tables.position) - 1);
        let at = |field| self.vec3(world, table, row, field);
        (at(reaction::FORCE), at(reaction::TORQUE))
    }
    /// The contacts of the last step, in an order that does not change from step to step. Where a step has several
    /// substeps, of the last one; with `impulse` forces and torques are means over it.
    pub fn contacts(&self, world: usize) -> impl Iterator<Item = Contact> {
        (0..self.tables.contacts).filter_map(move |row| self.contact(world, row))
    }
    /// The contact in a row of the table that [`contacts`](Outputs::contacts) goes through, if there is
    /// one now.
    pub fn contact(&self, world: usize, row: usize) -> Option<Contact> {
        let table = self.tables.contact;
        let row = existing("row of contacts", row, self.tables.contacts);
        let distance = self.number(world, table, row, contact::DISTANCE);
        (distance < 0.5 * collide::FAR).then(|| Contact {
            shapes: self.touching(world, row),
            position: self.vec3(world, table, row, contact::POSITION),
            normal: self.vec3(world, table, row, contact::NORMAL),
            distance,
            force: self.vec3(world, table, row, contact::FORCE),
            torque: self
                .tables
                .contact_torque
                .map_or(DVec3::ZERO, |table| self.vec3(world, table, row, 0)),
            feature: self.number(world, table, row, contact::FEATURE) as u32,
        })
    }
    /// Force [N] and torque about the world's origin [N·m] of all contacts of the last step of a shape on another,
    /// world axes; zero where they do not touch.
    pub fn pair_wrench(&self, world: usize, from: ShapeId, on: ShapeId) -> (DVec3, DVec3) {
        let mut sum = (DVec3::ZERO, DVec3::ZERO);
        for contact in self.contacts(world) {
            let sign = match contact.shapes {
                [a, b] if [a, b] == [from, on] => 1.0,
                [a, b] if [b, a] == [from, on] => -1.0,
                _ => continue,
            };
            let torque = contact.torque + contact.position.cross(contact.force);
            sum.0 += sign * contact.force;
            sum.1 += sign * torque;
        }
        sum
    }
    /// The rows in which a contact of these shapes may stand: fewer than all where the solver has rows of
    /// its own for each pair of shapes, as all but `impulse` have.
    pub fn contact_rows(&self, of: impl Fn(ShapeId) -> bool) -> Vec<usize> {
        let of_pair = |row: &usize| {
            self.shapes
                .get(*row)
                .is_none_or(|pair| pair.iter().any(|s| of(*s)))
        };
        (0..self.tables.contacts).filter(of_pair).collect()
    }
    /// The shapes of a row of contacts.
    pub(crate) fn touching(&self, world: usize, row: usize) -> [ShapeId; 2] {
        self.shapes.get(row).copied().unwrap_or_else(|| {
            let shape = |i| self.number(world, self.tables.touching, row, i) as usize;
            [ShapeId(shape(0)), ShapeId(shape(1))]
        })
    }
    /// Kinetic energy [J].
    pub fn kinetic_energy(&self, world: usize) -> f64 {
        self.number(world, self.tables.total, 0, total::KINETIC)
    }
    /// Potential energy [J] of weight and passive springs.
    pub fn potential_energy(&self, world: usize) -> f64 {
        self.number(world, self.tables.total, 0, total::POTENTIAL)
    }
    /// Kinetic and potential energy [J].
    pub fn energy(&self, world: usize) -> f64 {
        self.kinetic_energy(world) + self.potential_energy(world)
    }
    /// Linear momentum [kg·m/s].
    pub fn momentum(&self, world: usize) -> DVec3 {
        self.vec3(world, self.tables.total, 0, total::MOMENTUM)
    }
    /// Angular momentum [kg·m²/s] about the world's origin.
    pub fn angular_momentum(&self, world: usize) -> DVec3 {
        self.vec3(world, self.tables.total, 0, total::ANGULAR_MOMENTUM)
    }
    /// How often a force or displacement cap has bitten since the world was reset, with `xpbd`; how many contacts there
    /// was no room to remember, with `impulse`; else zero.
    pub fn capped(&self, world: usize) -> u64 {
        self.number(world, self.tables.total, 0, total::CAPPED) as u64
    }

    fn number<const W: usize>(
        &self,
        world: usize,
        table: Table<Output, W>,
        row: usize,
        field: usize,
    ) -> f64 {
        let world = existing("world", world, self.worlds());
        self.memory.get(world, table.at(row, field)).to_f64()
    }
    fn numbers<const N: usize, const W: usize>(
        &self,
        world: usize,
        table: Table<Output, W>,
        row: usize,
        field: usize,
    ) -> [f64; N] {
        std::array::from_fn(|i| self.number(world, table, row, field + i))
    }
    fn vec3<const W: usize>(
        &self,
        world: usize,
        table: Table<Output, W>,
        row: usize,
        field: usize,
    ) -> DVec3 {
        DVec3::from_array(self.numbers(world, table, row, field))
    }
    /// The row of a body.
    fn body(&self, id: BodyId) -> usize {
        let bodies = rows(self.tables.body, self.tables.body_acceleration);
        existing("body", id.0, bodies)
    }
    /// All rows of a table, which ends where the next begins.
    fn column<const W: usize>(
        &self,
        world: usize,
        table: Table<Output>,
        next: Table<Output, W>,
    ) -> Vec<f64> {
        (0..rows(table, next))
            .map(|row| self.number(world, table, row, 0))
            .collect()
    }
}

/// Number of rows of a table, which ends where the next begins.
fn rows<const V: usize, const W: usize>(table: Table<Output, V>, next: Table<Output, W>) -> usize {
    (next.start() - table.start()) / V
}

/// The index itself. Beyond the last lie numbers of other tables and worlds.
///
/// Panics where it does not exist.
#[inline]
pub(crate) fn existing(what: &'static str, index: usize, count: usize) -> usize {
    if index >= count {
        panic!("{}", SimulationError::Index { what, index, count });
    }
    index
}
