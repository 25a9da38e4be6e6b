//! What is told of a body: where its frame is, how that moves, and what the body adds to the sums of its world.
//!
//! With the centre of mass at c, the principal axes' orientation q, and the frame at r, R in these:
//!
//! ```text
//! x = c + q r     v_x = v + ω × q r     a_x = a + α × q r + ω × (ω × q r)
//! T = ½ (m v² + ω·Iω)     V = −m g·c     p = m v     L = Iω + c × m v
//! ```
//!
//! where a and α are the changes of v and ω over the last step, by its length.

use super::super::layout::{SLEEP_AFTER, state};
use super::super::tables::mass;
use super::ReportLengths;
use crate::output::{body, body_acceleration};
use numbers::machine::space::{Input, Output};
use numbers::{Machine, Pose, Real, Table, Vec3};

/// What is summed over the bodies of a world: kinetic and potential energy [J], momentum [kg·m/s], angular momentum about
/// the world's origin [kg·m²/s].
pub const SUMS: usize = 8;

/// Tables of [`tell_body`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyReport {
    /// See [`state`]: of what does not move, the first row.
    body: Table<Input, { state::WIDTH }>,
    /// Length of the step that led here [s].
    long: Table<Input>,
    /// The model's frame in the body's own, or in the world.
    frame: Table<Input, 7>,
    /// See [`mass`]; zeros for what does not move.
    mass: Table<Input, { mass::WIDTH }>,
    gravity: Table<Input, 3>,
    /// See [`body`].
    pub motion: Table<Output, { body::WIDTH }>,
    /// See [`body_acceleration`].
    pub acceleration: Table<Output, { body_acceleration::WIDTH }>,
    /// 1 while it sleeps, else 0.
    pub asleep: Table<Output>,
    /// See [`SUMS`].
    pub sums: Table<Output, SUMS>,
    /// How many there are.
    pub lengths: ReportLengths,
}

impl BodyReport {
    /// The layout; inlined, so that kernels know every offset when they are compiled.
    #[inline(always)]
    pub fn new() -> Self {
        let (mut given, mut told) = (0, 0);
        let (given_end, told_end) = (&mut given, &mut told);
        let mut tables = Self {
            body: Table::place(given_end, 1),
            long: Table::place(given_end, 1),
            frame: Table::place(given_end, 1),
            mass: Table::place(given_end, 1),
            gravity: Table::place(given_end, 1),
            motion: Table::place(told_end, 1),
            acceleration: Table::place(told_end, 1),
            asleep: Table::place(told_end, 1),
            sums: Table::place(told_end, 1),
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

impl Default for BodyReport {
    fn default() -> Self {
        Self::new()
    }
}

/// Tells of a body.
#[inline(always)]
pub fn tell_body<M: Machine>(k: &mut M, t: &BodyReport) {
    let only = k.index(0);
    let own = k.pose(t.body, only, state::CENTER);
    let frame = k.pose(t.frame, only, 0);
    let long = k.load(t.long, only, 0);
    let [v, w] = [0, 3].map(|i| k.vec3(t.body, only, state::VELOCITY + i));
    let [past_v, past_w] = [0, 3].map(|i| k.vec3(t.body, only, state::BEFORE + i));
    let arm = own.q.rotate(frame.p);
    let [a, turning] = [over(v - past_v, long), over(w - past_w, long)];
    let a = a + turning.cross(arm) + w.cross(w.cross(arm));
    let pose = Pose::new(own.p + arm, own.q * frame.q);
    k.store_pose(t.motion, only, body::POSITION, pose);
    k.store_vec3(t.motion, only, body::VELOCITY, v + w.cross(arm));
    k.store_vec3(t.motion, only, body::ANGULAR_VELOCITY, w);
    k.store_vec3(t.acceleration, only, body_acceleration::LINEAR, a);
    k.store_vec3(t.acceleration, only, body_acceleration::ANGULAR, turning);
    let rest = k.load(t.body, only, state::REST);
    let sleeps = M::R::select(rest.ge(M::R::lit(SLEEP_AFTER)), M::R::one(), M::R::zero());
    k.store(t.asleep, only, 0, sleeps);
    sum(k, t, own, [v, w]);
}

/// What a body adds to the sums of its world.
#[inline(always)]
fn sum<M: Machine>(k: &mut M, t: &BodyReport, own: Pose<M::R>, [v, w]: [Vec3<M::R>; 2]) {
    let only = k.index(0);
    let m = k.load(t.mass, only, mass::MASS);
    let spin = own.q.rotate_inverse(w);
    let turning = k.vec3(t.mass, only, mass::MOMENTS).times(spin);
    let (momentum, weight) = (v * m, k.vec3(t.gravity, only, 0) * m);
    let kinetic = M::R::lit(0.5) * (momentum.dot(v) + spin.dot(turning));
    let angular = own.q.rotate(turning) + own.p.cross(momentum);
    k.write(t.sums, only, 0, [kinetic, -weight.dot(own.p)]);
    k.store_vec3(t.sums, only, 2, momentum);
    k.store_vec3(t.sums, only, 5, angular);
}

/// v / x.
#[inline(always)]
pub(super) fn over<R: Real>(v: Vec3<R>, x: R) -> Vec3<R> {
    Vec3::new(v.x / x, v.y / x, v.z / x)
}
