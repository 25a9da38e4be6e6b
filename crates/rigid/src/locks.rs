//! What a joint locks: where it holds its two bodies, and along which directions.

use crate::tables::{Filler, frame};
use glam::{DQuat, DVec3};
use model::{Joint, JointKind, Pose};
use numbers::Table;
use numbers::machine::space::Parameter;

/// How many rotations a joint leaves free.
pub(crate) mod turns {
    pub const LOCKED: usize = 0;
    pub const ONE: usize = 1;
    pub const TWO: usize = 2;
    /// Along three axes that have a coordinate each.
    pub const THREE: usize = 3;
    pub const FREE: usize = 4;
}

/// How a joint holds the two anchors.
pub(crate) mod hold {
    /// Together.
    pub const POINT: usize = 0;
    /// Together but along one or two directions.
    pub const SLIDE: usize = 1;
    /// At a distance.
    pub const DISTANCE: usize = 2;
    /// Not at all.
    pub const FREE: usize = 3;
}

/// Speeds at which a gap closes at most that no step has made: of a loop that is open when a world begins.
pub(crate) mod pace {
    /// [rad/s]
    pub const TURNS: f64 = 5.0;
    /// [m/s]
    pub const SHIFTS: f64 = 1.0;
}

/// Fields that a row of a solver's table of joints begins with: see [`Locks::fill`].
pub(crate) mod lock {
    /// Anchor in A's own frame.
    pub const ANCHOR_A: usize = 0;
    /// Orientation of the angular frame in A's.
    pub const FRAME_A: usize = 3;
    /// The same of B.
    pub const ANCHOR_B: usize = 7;
    pub const FRAME_B: usize = 10;
    /// Orientation of the linear frame in A's; the free directions come first.
    pub const LINEAR_FRAME: usize = 14;
    /// 1 for each locked direction of the linear frame.
    pub const LOCKED: usize = 18;
    /// Second angular axis, in the angular frame.
    pub const SECOND: usize = 21;
    /// Length of a distance joint.
    pub const LENGTH: usize = 24;
    pub const WIDTH: usize = 25;
}

/// Three turns and three shifts.
pub(crate) const ROWS: usize = 6;

/// A joint's locks in its own frame, where all coordinates are at their reference.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Locks {
    /// Where the anchors of both bodies meet.
    pub anchor: DVec3,
    /// The angular frame: the first angular axis is its x.
    pub turn: DQuat,
    /// The linear frame: the free directions come first.
    pub slide: DQuat,
    /// 1 for each locked direction of the linear frame.
    pub locked: [f64; 3],
    /// The second angular axis, in the angular frame.
    pub second: DVec3,
    /// See [`turns`].
    pub turns: usize,
    /// See [`hold`].
    pub hold: usize,
}

impl Locks {
    /// Those of a joint whose linear and angular [axes](crate::check::axes) are these.
    pub fn new(joint: &Joint, linear: &[usize], angular: &[usize]) -> Self {
        let directions = |axes: &[usize]| -> Vec<DVec3> {
            axes.iter().map(|&i| joint.axes[i].direction).collect()
        };
        let (turn, slide) = (frame(&directions(angular)), frame(&directions(linear)));
        let first = angular.first().map(|&i| joint.axes[i].anchor);
        let second = angular.get(1).map(|&i| joint.axes[i].direction);
        Self {
            anchor: first.unwrap_or(DVec3::ZERO),
            turn,
            slide,
            locked: std::array::from_fn(|i| f64::from(u8::from(i >= linear.len()))),
            second: turn.conjugate() * second.unwrap_or(DVec3::Y),
            turns: match joint.kind {
                JointKind::Ball | JointKind::Free | JointKind::Distance => turns::FREE,
                _ => [turns::LOCKED, turns::ONE, turns::TWO, turns::THREE][angular.len()],
            },
            hold: match joint.kind {
                JointKind::Free => hold::FREE,
                JointKind::Distance => hold::DISTANCE,
                _ => [hold::POINT, hold::SLIDE, hold::SLIDE, hold::FREE][linear.len()],
            },
        }
    }
    /// Which turns are locked, along the angular frame or, of two axes, across both; and which shifts, along the
    /// linear frame or the line between the anchors.
    pub fn rows(&self) -> [bool; ROWS] {
        let [a, b, c] = match self.turns {
            turns::LOCKED => [true; 3],
            turns::ONE => [false, true, true],
            turns::TWO => [true, false, false],
            _ => [false; 3],
        };
        let [x, y, z] = match self.hold {
            hold::DISTANCE => [true, false, false],
            hold::FREE => [false; 3],
            _ => self.locked.map(|locked| locked > 0.0),
        };
        [a, b, c, x, y, z]
    }
    /// Writes the fields of [`lock`], given the joint's frame on both bodies, as these see it.
    pub fn fill<const W: usize>(
        &self,
        t: Table<Parameter, W>,
        row: usize,
        [a, b]: [Pose; 2],
        length: f64,
        f: &mut Filler,
    ) {
        f.vec3(t, row, lock::ANCHOR_A, a.point(self.anchor));
        f.quat(t, row, lock::FRAME_A, a.orientation * self.turn);
        f.vec3(t, row, lock::ANCHOR_B, b.point(self.anchor));
        f.quat(t, row, lock::FRAME_B, b.orientation * self.turn);
        f.quat(t, row, lock::LINEAR_FRAME, a.orientation * self.slide);
        f.numbers(t, row, lock::LOCKED, &self.locked);
        f.vec3(t, row, lock::SECOND, self.second);
        f.number(t, row, lock::LENGTH, length);
    }
}
