//! What is told of a free joint to the world: where the child's frame is in the parent's, and how it moves: velocity along
//! the parent's axes, spin about the child's.

use super::super::layout::state;
use super::ReportLengths;
use super::body::over;
use crate::output::reaction;
use numbers::machine::space::{Input, Output};
use numbers::{Machine, Pose, Quat, Real, Table, Vec3};

/// Tables of [`tell_free`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeReport {
    /// See [`state`].
    body: Table<Input, { state::WIDTH }>,
    /// Length of the step that led here [s].
    long: Table<Input>,
    /// The parent's frame in the world.
    parent: Table<Input, 7>,
    /// The child's frame in the body's own.
    child: Table<Input, 7>,
    /// Position and orientation.
    pub position: Table<Output, 7>,
    /// Velocity, spin.
    pub velocity: Table<Output, 6>,
    /// The mean of their rates over the last step.
    pub acceleration: Table<Output, 6>,
    /// None.
    pub reaction: Table<Output, { reaction::WIDTH }>,
    /// How many there are.
    pub lengths: ReportLengths,
}

impl FreeReport {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut given, mut told) = (0, 0);
        let (given_end, told_end) = (&mut given, &mut told);
        let mut tables = Self {
            body: Table::place(given_end, 1),
            long: Table::place(given_end, 1),
            parent: Table::place(given_end, 1),
            child: Table::place(given_end, 1),
            position: Table::place(told_end, 1),
            velocity: Table::place(told_end, 1),
            acceleration: Table::place(told_end, 1),
            reaction: Table::place(told_end, 1),
            lengths: ReportLengths::default(),
        };
        tables.lengths = ReportLengths {
            given,
            state: 0,
            told,
        };
        tables
    }
}

impl Default for FreeReport {
    fn default() -> Self {
        Self::new()
    }
}

/// Tells of a free joint.
#[inline(always)]
pub fn tell_free<M: Machine>(k: &mut M, t: &FreeReport) {
    let only = k.index(0);
    let own = k.pose(t.body, only, state::CENTER);
    let (parent, child) = (k.pose(t.parent, only, 0), k.pose(t.child, only, 0));
    let arm = own.q.rotate(child.p);
    let frame = Pose::new(own.p + arm, own.q * child.q);
    let relative = Pose::new(
        parent.q.rotate_inverse(frame.p - parent.p),
        parent.q.conjugate() * frame.q,
    );
    let [now, before] = [motion(k, t, state::VELOCITY), motion(k, t, state::BEFORE)];
    // Of the change, not the change of what is rounded.
    let change = [now[0] - before[0], now[1] - before[1]];
    let [v, w] = seen(now, arm, [parent.q, frame.q]);
    let [a, turning] = seen(change, arm, [parent.q, frame.q]);
    let long = k.load(t.long, only, 0);
    k.store_pose(t.position, only, 0, relative);
    k.store_vec3(t.velocity, only, 0, v);
    k.store_vec3(t.velocity, only, 3, w);
    k.store_vec3(t.acceleration, only, 0, over(a, long));
    k.store_vec3(t.acceleration, only, 3, over(turning, long));
    k.store_vec3(t.reaction, only, reaction::FORCE, Vec3::zero());
    k.store_vec3(t.reaction, only, reaction::TORQUE, Vec3::zero());
}

/// Velocity and spin of the body, of which those begin with this field.
#[inline(always)]
fn motion<M: Machine>(k: &M, t: &FreeReport, field: usize) -> [Vec3<M::R>; 2] {
    let only = k.index(0);
    [k.vec3(t.body, only, field), k.vec3(t.body, only, field + 3)]
}

/// The velocity at the end of an arm along the parent's axes, and the spin about the child's.
#[inline(always)]
fn seen<R: Real>(
    [v, w]: [Vec3<R>; 2],
    arm: Vec3<R>,
    [parent, child]: [Quat<R>; 2],
) -> [Vec3<R>; 2] {
    let v = parent.rotate_inverse(v + w.cross(arm));
    [v, child.rotate_inverse(w)]
}
