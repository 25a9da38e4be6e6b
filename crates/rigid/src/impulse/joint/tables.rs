//! What a lane holds of a joint and its two bodies.

use super::super::tables::{global, row};
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch, State};

/// Rows of a joint: three about axes, then three along axes.
pub const ROWS: usize = 6;

/// Laws with bounds along one axis, at most.
pub const LAWS: usize = 6;

/// Fields of a joint.
pub mod joint {
    /// Where it holds A, in A's own frame [m].
    pub const ANCHOR_A: usize = 0;
    /// Orientation of the angular frame in A's; its x is the first angular axis.
    pub const FRAME_A: usize = 3;
    /// Where it holds B, in B's own frame [m].
    pub const ANCHOR_B: usize = 7;
    /// Orientation of the angular frame in B's.
    pub const FRAME_B: usize = 10;
    /// Orientation of the linear frame in A's; its first directions are the linear axes.
    pub const LINEAR_FRAME: usize = 14;
    /// 1 for each row that is locked, 6.
    pub const LOCKED: usize = 18;
    /// Second angular axis, in the angular frame, before any turn; then the third.
    pub const SECOND: usize = 24;
    /// Third angular axis.
    pub const THIRD: usize = 27;
    /// 1 where the second axis turns the third.
    pub const CARRIED: usize = 30;
    /// Length that the anchors keep [m]; negative where they coincide.
    pub const LENGTH: usize = 31;
    /// 1 where the angular axes are those of B, and coordinates the turn from the target below.
    pub const BALL: usize = 32;
    /// By how much more A and B respond to each of their joints than they would to one.
    pub const SHARES: usize = 33;
    /// Inverses of the paces at which turns and shifts of a gap close [s/rad, s/m]; 0 where there are none.
    pub const SLOW: usize = 35;
    /// How many of the first fields are constants.
    pub const CONSTANTS: usize = 37;
    /// Target of a ball, a quaternion; of other joints the targets of their drives, a row each: 6. With the
    /// next four it is what a joint carries from step to step.
    pub const TARGET: usize = 37;
    /// Angles about the axes, counting turns, less their references [rad], 3.
    pub const ANGLE: usize = 43;
    /// Angular impulse at B's anchor [N·m·s], and impulse [N·s], on B in a small step, world axes, 6.
    pub const IMPULSE: usize = 46;
    /// Speeds of what is geared to the axes, 6 [rad/s, m/s].
    pub const SPEED: usize = 52;
    /// The sum of the impulses over the step, 6.
    pub const SUM: usize = 58;
    /// How many of the first fields are there before a step.
    pub const WRITTEN: usize = 64;
    /// Inverse masses of A and B.
    pub const INVERSE_MASS: usize = 64;
    /// Inverse inertia of A, then of B.
    pub const INVERSE_INERTIA: usize = 66;
    /// From the centres of mass of A and of B to B's anchor [m].
    pub const ARMS: usize = 78;
    /// The same, and the impulse [N·s], when the joint was last pushed together.
    pub const LAST: usize = 84;
    /// Gradients of the angular coordinates, world axes, 9.
    pub const GRADIENTS: usize = 93;
    /// The angular axes, world axes, 9.
    pub const AXES: usize = 102;
    /// The linear axes, world axes, 9.
    pub const SHIFTS: usize = 111;
    /// How far each locked row is off [rad, m], 6.
    pub const ERROR: usize = 120;
    /// Response of the locked rows to impulses along them, 21.
    pub const BLOCK: usize = 126;
    /// 1 where several rows are acted along, one of them by what is passive.
    pub const MIXED: usize = 147;
    /// Numbers in a row.
    pub const WIDTH: usize = 148;
}

/// Fields of a row of a joint along which something acts.
pub mod axis {
    /// 1 where something does, in this lane.
    pub const ACTS: usize = 0;
    /// Stiffness [N/m or N·m/rad], damping [N·s/m or N·m·s/rad], force at coordinate 0 and rest
    /// [N or N·m], armature [kg or kg·m²].
    pub const PASSIVE: usize = 1;
    /// The third of these.
    pub const FORCE: usize = 3;
    /// What the target of its drive follows [m or rad]; of a ball a number of the turn, a rotation vector.
    pub const GOAL: usize = 5;
    /// Control time of the drive [s]; negative where there is none.
    pub const TIME: usize = 6;
    /// What coordinates are reckoned from [m or rad].
    pub const REFERENCE: usize = 7;
    /// 1 where whole turns do not count.
    pub const TURNS: usize = 8;
    /// How many of the first fields are there before a step.
    pub const CONSTANTS: usize = 9;
    /// The coordinate less its reference [m or rad].
    pub const VALUE: usize = 9;
    /// By how much its rate would change of what others change it by, because of what acts along it.
    pub const YIELDS: usize = 10;
    /// What a unit impulse along the axis makes of the locks, what is passive along other axes, and itself: angular impulse,
    /// impulse.
    pub const WRENCH: usize = 11;
    /// Change of the rate by that [1/kg or 1/(kg·m²)].
    pub const RESPONSE: usize = 17;
    /// What a unit impulse along the axis makes of the locks and itself alone.
    pub const HOLDS: usize = 18;
    /// What other rows have dragged out of it since its turn; while relaxing, and within a turn, what to count that from
    /// [N·s or N·m·s].
    pub const DRAGGED: usize = 24;
    /// Numbers in a row.
    pub const WIDTH: usize = 25;
}

/// Fields of a law with bounds: f = force + stiffness (rest − θ) − damping (θ̇ − w), low ≤ f ≤ high.
pub mod law {
    /// Stiffness [N/m or N·m/rad].
    pub const STIFFNESS: usize = 0;
    /// Damping [N·s/m or N·m·s/rad].
    pub const DAMPING: usize = 1;
    /// Rest less the coordinate's reference [m or rad].
    pub const REST: usize = 2;
    /// Force at rest [N or N·m].
    pub const FORCE: usize = 3;
    /// Bounds [N or N·m].
    pub const LOW: usize = 4;
    /// The upper one.
    pub const HIGH: usize = 5;
    /// 1 for a stop, which damps only what goes beyond it; else w is 0.
    pub const STOP: usize = 6;
    /// What a stop carries along [kg or kg·m²].
    pub const INERTIA: usize = 7;
    /// Numbers in a row.
    pub const WIDTH: usize = 8;
}

/// Whole numbers of a row, the same in all lanes.
pub mod axis_link {
    /// 1 where something acts in any lane.
    pub const ACTS: usize = 0;
    /// First law: that of the drive, where there is one.
    pub const FIRST: usize = 1;
    /// The first one after its laws.
    pub const END: usize = 2;
    /// Numbers in a row.
    pub const WIDTH: usize = 3;
}

/// Fields of a row while a kernel runs.
pub(super) mod work {
    /// Response of all rows to a unit impulse along this one.
    pub const COLUMN: usize = 0;
    /// The impulse that it has been given.
    pub const HAD: usize = 6;
    /// Torque of its drive, of a ball.
    pub const TORQUE: usize = 7;
    /// The speed of what is geared to it, as the small step began.
    pub const BEGIN: usize = 8;
    /// Which part of its bounds the drive of a row has.
    pub const SHARE: usize = 9;
    /// √(h z): see [`super`].
    pub const ROOT: usize = 10;
    pub const WIDTH: usize = 11;
}

/// Fields of a law while a kernel runs: f = lead − slope θ̇ within bounds.
pub(super) mod line {
    pub const LEAD: usize = 0;
    /// Bounds.
    pub const LOW: usize = 2;
    pub const WIDTH: usize = 4;
}

/// Fields of a body that a joint is placed by: the first ones of [`row`].
pub const PLACED: usize = row::FREE;

/// Tables of the kernels of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTables {
    /// One row: see [`joint`].
    pub joint: Table<State, { joint::WIDTH }>,
    /// [`joint::SPEED`], by row.
    pub(super) speed: Table<State>,
    /// [`ROWS`] rows: see [`axis`].
    pub axis: Table<State, { axis::WIDTH }>,
    /// The laws of all rows: see [`law`].
    pub law: Table<State, { law::WIDTH }>,
    /// See [`axis_link`].
    pub links: Links<{ axis_link::WIDTH }>,
    /// A and B: see [`PLACED`].
    pub body: Table<Scratch, { PLACED }>,
    pub(super) work: Table<Scratch, { work::WIDTH }>,
    pub(super) line: Table<Scratch, { line::WIDTH }>,
    /// One row: see [`global`].
    pub global: Table<Parameter, { global::WIDTH }>,
    /// Numbers of a joint.
    pub length: usize,
}

impl JointTables {
    /// Numbers that a kernel works with, those of the bodies first.
    pub const SCRATCH: usize = Self::scratch(ROWS * LAWS);

    /// The same of a joint along whose axes there are so many laws.
    pub const fn scratch(laws: usize) -> usize {
        2 * PLACED + ROWS * work::WIDTH + laws * line::WIDTH
    }

    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut state, mut scratch, mut parameters, mut links) = (0, 0, 0, 0);
        let joint: Table<State, { joint::WIDTH }> = Table::place(&mut state, 1);
        let mut speed = joint.start() + joint::SPEED;
        Self {
            joint,
            speed: Table::place(&mut speed, ROWS),
            axis: Table::place(&mut state, ROWS),
            law: Table::place(&mut state, ROWS * LAWS),
            links: Links::place(&mut links, ROWS),
            body: Table::place(&mut scratch, 2),
            work: Table::place(&mut scratch, ROWS),
            line: Table::place(&mut scratch, ROWS * LAWS),
            global: Table::place(&mut parameters, 1),
            length: state,
        }
    }
}

impl Default for JointTables {
    fn default() -> Self {
        Self::new()
    }
}
