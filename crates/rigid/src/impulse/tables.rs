//! What a lane holds: one body, or one contact and its two bodies.

use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch, State};

/// Fields of a body while a step runs.
pub mod row {
    /// Velocity of the centre of mass [m/s].
    pub const VELOCITY: usize = 0;
    /// Angular velocity [rad/s], world axes.
    pub const SPIN: usize = 3;
    /// Motion of the centre since the step began [m].
    pub const SHIFT: usize = 6;
    /// Turn since the step began, a rotation vector [rad].
    pub const TURN: usize = 9;
    /// How many of the first fields change in a small step.
    pub const MOVING: usize = 12;
    /// 1/m [1/kg]; 0 for what does not move.
    pub const INVERSE_MASS: usize = 12;
    /// I⁻¹ [1/(kg·m²)], world axes: xx, yy, zz, xy, xz, yz.
    pub const INVERSE_INERTIA: usize = 13;
    /// Centre of mass when the step began [m].
    pub const CENTER: usize = 19;
    /// How many of the first fields a contact needs to be prepared.
    pub const PREPARED: usize = 22;
    /// Orientation of the principal axes when the step began.
    pub const ORIENTATION: usize = 22;
    /// How many of the first fields the end of a step needs, in whole quads; two are not used.
    pub const PLACED: usize = 28;
    /// Velocity and spin that the small step would have had without contacts.
    pub const FREE: usize = 28;
    /// Acceleration and angular acceleration by all but the contacts.
    pub const ACCELERATION: usize = 34;
    /// Force [N] and torque about the centre [N·m] from outside, world axes.
    pub const WRENCH: usize = 40;
    /// Numbers in a row.
    pub const WIDTH: usize = 48;
}

/// Fields of a body's row of constants.
pub mod mass {
    /// Mass [kg].
    pub const MASS: usize = 0;
    /// 1/m [1/kg].
    pub const INVERSE: usize = 1;
    /// Principal moments [kg·m²].
    pub const MOMENTS: usize = 2;
    /// Their inverses.
    pub const INVERSE_MOMENTS: usize = 5;
    /// Numbers in a row.
    pub const WIDTH: usize = 8;
}

/// Fields of where a body is pushed: the frames of its free joint.
pub mod grip {
    /// Orientation of the parent's, in which forces are given.
    pub const FORCE_FRAME: usize = 0;
    /// The child's in the body's own: where forces act, and in which torques are given.
    pub const FRAME: usize = 4;
    /// Numbers in a row.
    pub const WIDTH: usize = 11;
}

/// Fields of the row of constants of a step.
pub mod global {
    /// Length h of a small step [s].
    pub const STEP: usize = 0;
    /// 1/h.
    pub const RATE: usize = 1;
    /// Small steps in a step.
    pub const STEPS: usize = 2;
    /// Gravity [m/s²], 3.
    pub const GRAVITY: usize = 3;
    /// Fastest separation of surfaces that overlap [m/s].
    pub const PUSH_OUT: usize = 6;
    /// Approach [m/s] below which nothing bounces.
    pub const RESTING: usize = 7;
    /// Numbers in the row.
    pub const WIDTH: usize = 8;
}

/// Fields of a contact.
pub mod manifold {
    /// Unit vector from A to B.
    pub const NORMAL: usize = 0;
    /// Coulomb friction coefficient; before [`prepare`](super::super::contact::prepare) of what slides.
    pub const FRICTION: usize = 3;
    /// Restitution.
    pub const RESTITUTION: usize = 4;
    /// Torsional friction coefficient [m].
    pub const TORSION: usize = 5;
    /// Rolling friction coefficient [m].
    pub const ROLLING: usize = 6;
    /// Stiffness [N/m] and damping [N·s/m] of a point that gives way.
    pub const SPRING: usize = 7;
    /// Time constant [s] with which an overlap closes, where nothing gives way; 0 for a spring.
    pub const SETTLING: usize = 9;
    /// Impulse of friction at its centre [N·s], 3.
    pub const DRAG: usize = 10;
    /// Angular impulse against twisting and rolling [N·m·s], 3.
    pub const TWIST: usize = 13;
    /// The sum of drags over the step [N·s], 3.
    pub const DRAG_SUM: usize = 16;
    /// The sum of twists over the step [N·m·s], 3, about the mean of the points.
    pub const TWIST_SUM: usize = 19;
    /// Inverse masses of A and B.
    pub const INVERSE_MASS: usize = 22;
    /// Inverse inertia of A, then of B.
    pub const INVERSE_INERTIA: usize = 24;
    /// From the centres of mass of A and of B to where friction acts [m].
    pub const ARMS: usize = 36;
    /// Inverse of the largest response in the tangent plane at the centre [kg].
    pub const TANGENT_MASS: usize = 42;
    /// Inverse of the resistance to twisting, and to rolling [kg·m²].
    pub const TWIST_MASS: usize = 43;
    /// How far B had moved against A [m] when surfaces were last pushed apart, 3; and the impulse [N·s]
    /// of all points then, 3.
    pub const LAST: usize = 45;
    /// Way [m] on which the shapes get through each other.
    pub const THICKNESS: usize = 51;
    /// From where the contact acts to where it is [m], 3: not zero where a centre of mass is stopped.
    pub const ASIDE: usize = 52;
    /// 1 where a blow may be, or has just been, struck; else 0.
    pub const STRUCK: usize = 55;
    /// Coulomb friction coefficient of what sticks.
    pub const STICKING: usize = 56;
    /// From the mean of the points to where friction acts [m], 3.
    pub const OFFSET: usize = 57;
    /// Numbers in a row.
    pub const WIDTH: usize = 60;
}

/// Fields of a point of a contact.
pub mod point {
    /// From the centre of mass of A [m]; before [`prepare`](super::super::contact::prepare) the point
    /// itself.
    pub const ARM_A: usize = 0;
    /// Gap when the step began [m].
    pub const GAP: usize = 3;
    /// Impulse along the normal in a small step [N·s].
    pub const IMPULSE: usize = 4;
    /// Distance from where friction acts [m].
    pub const SPREAD: usize = 5;
    /// The sum of impulses along the normal over the step [N·s].
    pub const SUM: usize = 6;
    /// What free motion adds to the velocity along the normal in a small step [m/s]; before
    /// [`foresee`](super::super::blow::foresee) that velocity when the step began.
    pub const GAIN: usize = 7;
    /// From the centre of mass of B [m].
    pub const ARM_B: usize = 8;
    /// Change of the relative velocity along the normal by a unit impulse [1/kg].
    pub const COMPLIANCE: usize = 11;
    /// Rate at which an overlap is pushed apart [1/s].
    pub const BIAS: usize = 12;
    /// What softness adds to the compliance [1/kg].
    pub const SOFTNESS: usize = 13;
    /// Impulse of a blow along the normal [N·s].
    pub const BLOW: usize = 14;
    /// Speed with which a blow lets the surfaces part [m/s]; negative where they do not meet.
    pub const LEAVE: usize = 15;
    /// Numbers in a row.
    pub const WIDTH: usize = 16;
}

/// Points of a contact, at most.
pub const POINTS: usize = 4;

/// Tables of the kernels of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyTables {
    /// One row: see [`row`].
    pub body: Table<State, { row::WIDTH }>,
    /// One row: see [`mass`].
    pub mass: Table<Parameter, { mass::WIDTH }>,
    /// One row: see [`global`].
    pub global: Table<Parameter, { global::WIDTH }>,
    /// One row: see [`grip`]. Only [`push`](super::body::push) reads it.
    pub grip: Table<Parameter, { grip::WIDTH }>,
}

impl BodyTables {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut state, mut parameters) = (0, 0);
        Self {
            body: Table::place(&mut state, 1),
            global: Table::place(&mut parameters, 1),
            mass: Table::place(&mut parameters, 1),
            grip: Table::place(&mut parameters, 1),
        }
    }
}

impl Default for BodyTables {
    fn default() -> Self {
        Self::new()
    }
}

/// Tables of the kernels of a contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactTables {
    /// One row: see [`manifold`].
    pub manifold: Table<State, { manifold::WIDTH }>,
    /// [`POINTS`] rows: see [`point`].
    pub point: Table<State, { point::WIDTH }>,
    /// How many of them there are.
    pub points: Links,
    /// Rows of A and B: the first fields of [`row`].
    pub body: Table<Scratch, { row::PREPARED }>,
    /// One row: see [`global`].
    pub global: Table<Parameter, { global::WIDTH }>,
    /// Numbers of a contact.
    pub length: usize,
}

impl ContactTables {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut state, mut scratch, mut parameters, mut links) = (0, 0, 0, 0);
        Self {
            manifold: Table::place(&mut state, 1),
            point: Table::place(&mut state, POINTS),
            points: Links::place(&mut links, 1),
            body: Table::place(&mut scratch, 2),
            global: Table::place(&mut parameters, 1),
            length: state,
        }
    }
}

impl Default for ContactTables {
    fn default() -> Self {
        Self::new()
    }
}
