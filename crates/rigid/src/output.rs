//! What every solver reports of a world, in one layout.

use numbers::Table;
use numbers::machine::space::Output;

/// Fields of a row of [`OutputTables::body`].
pub mod body {
    /// Position of the body's frame [m], 3.
    pub const POSITION: usize = 0;
    /// Orientation x, y, z, w, 4.
    pub const ORIENTATION: usize = 3;
    /// Velocity of the body frame's origin [m/s], 3.
    pub const VELOCITY: usize = 7;
    /// Angular velocity [rad/s], world axes, 3.
    pub const ANGULAR_VELOCITY: usize = 10;
    /// Numbers in a row.
    pub const WIDTH: usize = 13;
}

/// Fields of a row of [`OutputTables::body_acceleration`].
pub mod body_acceleration {
    /// Acceleration of the body frame's origin [m/s²], world axes, 3.
    pub const LINEAR: usize = 0;
    /// Angular acceleration [rad/s²], world axes, 3.
    pub const ANGULAR: usize = 3;
    /// Numbers in a row.
    pub const WIDTH: usize = 6;
}

/// Fields of a row of [`OutputTables::reaction`].
pub mod reaction {
    /// Force [N] of the joint on its child, world axes, 3.
    pub const FORCE: usize = 0;
    /// Torque [N·m] of the joint on its child about the child's joint frame, world axes, 3.
    pub const TORQUE: usize = 3;
    /// Numbers in a row.
    pub const WIDTH: usize = 6;
}

/// Fields of the row of [`OutputTables::total`].
pub mod total {
    /// Kinetic energy [J], with that of armatures.
    pub const KINETIC: usize = 0;
    /// Potential energy [J] of weight and passive springs; zero at the world's origin.
    pub const POTENTIAL: usize = 1;
    /// Linear momentum [kg·m/s], 3.
    pub const MOMENTUM: usize = 2;
    /// Angular momentum [kg·m²/s] about the world's origin, 3.
    pub const ANGULAR_MOMENTUM: usize = 5;
    /// How often a force or displacement cap has bitten since the world was reset, with `xpbd`; how
    /// many contacts there was no room to remember, with `impulse`.
    pub const CAPPED: usize = 8;
    /// Numbers in the row.
    pub const WIDTH: usize = 9;
}

/// Fields of a row of [`OutputTables::contact`].
pub mod contact {
    /// Midway between the surfaces [m], world axes, 3.
    pub const POSITION: usize = 0;
    /// Unit vector towards the shape that the force acts on, 3.
    pub const NORMAL: usize = 3;
    /// Gap less the margin of the surfaces [m], negative where the shapes overlap; 1e9 where there
    /// is no contact.
    pub const DISTANCE: usize = 6;
    /// Whole number, the same from step to step while the same features touch.
    pub const FEATURE: usize = 7;
    /// Force [N] on the shape that the normal points to, world axes, 3.
    pub const FORCE: usize = 8;
    /// Numbers in a row.
    pub const WIDTH: usize = 11;
}

/// Where the reported numbers lie.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OutputTables {
    /// One row per body of the model: see [`body`].
    pub body: Table<Output, { body::WIDTH }>,
    /// One row per body of the model: see [`body_acceleration`]; the mean over the last substep where the
    /// solver has no closed form.
    pub body_acceleration: Table<Output, { body_acceleration::WIDTH }>,
    /// One row per joint of the model: see [`reaction`]. A last row is of no joint. Of the last substep; with `impulse` the
    /// mean over it.
    pub reaction: Table<Output, { reaction::WIDTH }>,
    /// Joint coordinates, the model's order; axes that [turn without end](model::Model::turns_without_end) are wrapped to
    /// (−π, π].
    pub position: Table<Output>,
    /// Joint velocities, the model's order.
    pub velocity: Table<Output>,
    /// Joint accelerations, the model's order; of the last substep where the solver has no closed form.
    pub acceleration: Table<Output>,
    /// One row: see [`total`].
    pub total: Table<Output, { total::WIDTH }>,
    /// One row for each point of contact that may be: see [`contact`]. Contacts of the last substep; with `impulse` forces
    /// are means over it.
    pub contact: Table<Output, { contact::WIDTH }>,
    /// Torque [N·m] against twisting and rolling of each row of contacts, on the shape that the normal points to,
    /// world axes; only where a solver gives such torques.
    pub contact_torque: Option<Table<Output, 3>>,
    /// The shapes of each row of contacts, where they change from step to step; else no rows.
    pub touching: Table<Output, 2>,
    /// One row per body of the model, 1 while it sleeps, else 0; only of solvers that let bodies sleep.
    pub asleep: Option<Table<Output>>,
    /// How many rows of contacts there are.
    pub contacts: usize,
    /// Numbers per world.
    pub length: usize,
}

impl OutputTables {
    /// The layout for a model.
    pub fn new(model: &model::Model) -> Self {
        let mut end = 0;
        let body = Table::place(&mut end, model.bodies.len());
        let body_acceleration = Table::place(&mut end, model.bodies.len());
        let reaction = Table::place(&mut end, model.joints.len() + 1);
        let position = Table::place(&mut end, model.coordinates());
        let velocity = Table::place(&mut end, model.degrees_of_freedom());
        let acceleration = Table::place(&mut end, model.degrees_of_freedom());
        let total = Table::place(&mut end, 1);
        let contact = Table::place(&mut end, 0);
        Self {
            body,
            body_acceleration,
            reaction,
            position,
            velocity,
            acceleration,
            total,
            contact,
            contact_torque: None,
            touching: Table::place(&mut end, 0),
            asleep: None,
            contacts: 0,
            length: end,
        }
    }
    /// Where all that is told of contacts, which begins with [`contact`](Self::contact), ends.
    pub fn contacts_end(&self) -> usize {
        self.asleep.map_or(self.length, |asleep| asleep.start())
    }
    /// Whether each row of contacts names its shapes.
    pub fn names_contacts(&self) -> bool {
        let next = self.contact_torque.map(|torque| torque.start());
        let next = next.or(self.asleep.map(|asleep| asleep.start()));
        self.touching.start() < next.unwrap_or(self.length)
    }
    /// The same, with room for so many points of contact.
    pub fn with_contacts(self, contacts: usize) -> Self {
        let mut end = self.contact.start();
        let contact = Table::place(&mut end, contacts);
        Self {
            contact,
            touching: Table::place(&mut end, 0),
            contacts,
            length: end,
            ..self
        }
    }
    /// The same, with room for so many points of contact of whichever shapes.
    pub fn with_found_contacts(self, contacts: usize) -> Self {
        let with_contacts = self.with_contacts(contacts);
        let mut end = with_contacts.length;
        Self {
            touching: Table::place(&mut end, contacts),
            length: end,
            ..with_contacts
        }
    }
    /// The same, with room for the torques of all contacts; after these.
    pub fn with_contact_torques(self) -> Self {
        let mut end = self.length;
        Self {
            contact_torque: Some(Table::place(&mut end, self.contacts)),
            length: end,
            ..self
        }
    }
    /// The same, with room for which of so many bodies sleep; after all contacts.
    pub fn with_sleep(self, bodies: usize) -> Self {
        let mut end = self.length;
        Self {
            asleep: Some(Table::place(&mut end, bodies)),
            length: end,
            ..self
        }
    }
}
