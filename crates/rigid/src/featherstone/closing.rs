//! Joints that close loops: what they lock, as rows on the tree's factor.
//!
//! A joint outside the tree locks rows φ(q) = 0: at most three turns and three shifts, along directions e that go
//! with its body A. With the Jacobian J of the rows, and the step q' = q + h q̇' of semi-implicit Euler,
//!
//! ```text
//! φ(q') = φ + h J q̇' + ½ h² J̇ q̇ + O(h³)
//! ```
//!
//! so that what is left of a row at the end of the step, and is to be zero, is
//!
//! ```text
//! r = φ/h + J q̇' + ½ h J̇ q̇
//! ```
//!
//! which [`locked`](super::locked) solves. That holds the positions at the end of the step, as
//! SHAKE does (Ryckaert, Ciccotti & Berendsen 1977), by one iteration with the curvature J̇ q̇ in place of many
//! without. With the shift u = v_B − v_A of the point x that the joint holds on B, both velocities there, and
//! the turn w = ω_B − ω_A,
//!
//! ```text
//! J q̇ = e · u        J̇ q̇ = e · (a_B − a_A − 2 ω_A × u)          shifts
//! J q̇ = e · w        J̇ q̇ = e · (α_B − α_A − ω_A × w)            turns
//! ```
//!
//! where the accelerations are those of the points of both bodies at x, all q̈ being zero. A distance |g| between
//! the anchors has e = g / |g| and (|u|² − (e · u)²) / |g| more; an angle between two axes a and b has
//! e = a × b / |a × b| and (|w|² (a · b) − (a · w) (b · w)) / |a × b| more.
//!
//! A loop that gapes by more than a step's drift, as one that is open when a world begins, is closed at a bounded
//! [pace](super::tied::Pace), along a straight line, and φ is what of it a step takes.

use super::contact::at;
use super::factor::{self, Path, seen_from_a};
use super::kinematics::Course;
use super::locked::Law;
use super::tables::{Tables, couple_link, frame, step};
use super::tied::{self, Pace, Tied};
use crate::locks::{Locks, ROWS, hold, turns};
use crate::output::reaction;
use crate::tables::Filler;
use model::{Joint, Pose};
use numbers::machine::space::{Parameter, Scratch};
use numbers::machine::{Held, Hold, Links};
use numbers::spatial::Spatial;
use numbers::{Machine, Mat3, Real, Table, Vec3};

/// Fields of [`ClosingTables::joint`].
mod joint_field {
    // Frames of A and B are those of their nodes.
    use crate::locks::lock;
    pub use lock::*;
    /// Origin of the child's joint frame, in B's node.
    pub const ORIGIN: usize = lock::WIDTH;
    /// 1, or 0 for a joint that does not act.
    pub const ENABLED: usize = ORIGIN + 3;
    /// How far a step closes turns, then shifts: two [`Pace`](super::super::tied::Pace)s.
    pub const TURN_PACE: usize = ENABLED + 1;
    pub const SHIFT_PACE: usize = TURN_PACE + 2;
    pub const WIDTH: usize = SHIFT_PACE + 2;
}

/// Fields of [`ClosingTables::links`].
mod joint_link {
    /// Row of [`Tables::couple_links`].
    pub const COUPLE: usize = 0;
    /// See [`turns`](crate::locks::turns).
    pub const TURNS: usize = 1;
    /// See [`hold`](crate::locks::hold).
    pub const HOLD: usize = 2;
    /// The joint, in the model.
    pub const JOINT: usize = 3;
    /// Rows of both bodies among those that are reported.
    pub const BODY_A: usize = 4;
    pub const BODY_B: usize = 5;
    pub const WIDTH: usize = 6;
}

/// Fields of [`ClosingTables::row`].
mod row {
    /// The point that is held, from O of B's tree.
    pub const POINT: usize = 0;
    /// Directions of the turns, then of the shifts, by columns; null where nothing is locked.
    pub const TURN: usize = 3;
    pub const SHIFT: usize = 12;
    pub const WIDTH: usize = 21;
}

/// Layout of what closes loops, a row for each joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ClosingTables {
    pub count: usize,
    /// See [`joint_field`].
    joint: Table<Parameter, { joint_field::WIDTH }>,
    /// See [`joint_link`].
    links: Links<{ joint_link::WIDTH }>,
    /// Rows of [`LockedTables`](super::locked::LockedTables): three turns, then three shifts.
    rows: Links<ROWS>,
    /// See [`row`].
    row: Table<Scratch, { row::WIDTH }>,
}

/// A joint that closes a loop, as the tables take it.
#[derive(Clone, Debug)]
pub(super) struct Closing {
    /// The joint, in the model.
    pub joint: usize,
    pub locks: Locks,
    /// Trees and rows of both bodies' nodes, and the bodies' frames in them.
    pub groups: [usize; 2],
    pub rows: [usize; 2],
    pub places: [Pose; 2],
    /// Rows of both bodies among those that are reported.
    pub bodies: [usize; 2],
    /// Pair of nodes.
    pub couple: usize,
    /// Rows among those that are locked: three turns, then three shifts.
    pub locked: [usize; ROWS],
    /// Mass [kg] of the lighter of both trees, and the sum of its bodies' moments of inertia [kg·m²].
    pub mass: [f64; 2],
    /// What hangs together by this and other joints.
    pub tied: Tied,
}

impl Closing {
    /// What a row's impulses follow, in steps of `h` [s].
    pub fn law(&self, row: usize, joint: &Joint, h: f64) -> Law {
        let [mass, moment] = self.mass;
        let (compliance, inertia, floor) = match row {
            0..3 => (joint.angular_compliance, moment, self.tied.turns(h)),
            _ => (joint.linear_compliance, mass, self.tied.shifts(h)),
        };
        Law {
            softness: compliance / (h * h),
            response: inertia.recip(),
            floor,
        }
    }
}

impl ClosingTables {
    pub fn place(
        count: usize,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> Self {
        Self {
            count,
            joint: Table::place(parameters, count),
            links: Links::place(links, count),
            rows: Links::place(links, count),
            row: Table::place(scratch, count),
        }
    }

    /// Writes a row, for steps of `h` [s].
    pub(super) fn fill(&self, i: usize, closing: &Closing, joint: &Joint, h: f64, f: &mut Filler) {
        let (locks, t) = (&closing.locks, self.joint);
        let a = closing.places[0] * joint.parent_frame;
        let b = closing.places[1] * joint.child_frame;
        locks.fill(t, i, [a, b], joint.length, f);
        f.vec3(t, i, joint_field::ORIGIN, b.position);
        let enabled = f64::from(u8::from(joint.enabled));
        f.number(t, i, joint_field::ENABLED, enabled);
        let tied = &closing.tied;
        let turns = Pace::turns(tied, h).unless(joint.angular_compliance > 0.0);
        let shifts = Pace::shifts(tied, h).unless(joint.linear_compliance > 0.0);
        f.numbers(t, i, joint_field::TURN_PACE, &turns.numbers());
        f.numbers(t, i, joint_field::SHIFT_PACE, &shifts.numbers());
        let links = [
            (joint_link::COUPLE, closing.couple),
            (joint_link::TURNS, locks.turns),
            (joint_link::HOLD, locks.hold),
            (joint_link::JOINT, closing.joint),
            (joint_link::BODY_A, closing.bodies[0]),
            (joint_link::BODY_B, closing.bodies[1]),
        ];
        for (field, x) in links {
            f.link(self.links, i, field, x);
        }
        for (field, row) in closing.locked.into_iter().enumerate() {
            f.link(self.rows, i, field, row);
        }
    }

    /// Rows of a joint's turns, and of its shifts.
    #[inline(always)]
    fn rows<M: Machine>(&self, k: &M, c: M::I) -> [[M::I; 3]; 2] {
        let [a, b, c, x, y, z] = k.link_row(self.rows, c);
        [[a, b, c], [x, y, z]]
    }
}

/// Finds what is locked, and how far it is off, and lets the forces of the last step act on it.
#[inline(always)]
pub(super) fn press<M: Machine>(k: &mut M, t: &Tables) {
    for c in k.count(t.closings.count) {
        let couple = k.link(t.closings.links, c, joint_link::COUPLE);
        let b = k.link(t.couple_links, couple, couple_link::NODE_B);
        let place = k.pose(t.frame, b, frame::PLACE);
        let x = place.point(k.vec3(t.closings.joint, c, joint_field::ANCHOR_B));
        k.store_vec3(t.closings.row, c, row::POINT, x);
        find(k, t, c, couple);
        let wrench = wrench(k, t, c);
        factor::press(k, t, couple, x, wrench);
    }
}

/// What is left of all rows without impulses, and their y. Needs the accelerations under the forces of [`press`].
#[inline(always)]
pub(super) fn rows<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for c in k.count(t.closings.count) {
        let couple = k.link(t.closings.links, c, joint_link::COUPLE);
        accelerate(k, t, c, couple, h);
        responses(k, t, c, couple);
    }
}

/// A body, and where its tree sees the point that is held.
struct Side<R> {
    course: Course<R>,
    x: Vec3<R>,
}

impl<R: Real> Side<R> {
    /// Velocity of the body's point.
    #[inline(always)]
    fn velocity(&self) -> Vec3<R> {
        at(self.course.twist, self.x)
    }
    /// Its acceleration where all q̈ are zero, less gravity.
    #[inline(always)]
    fn bias(&self) -> Vec3<R> {
        let spin = self.course.twist.angular;
        spin.cross_plus(self.velocity(), at(self.course.bias, self.x))
    }
}

/// Three rows.
struct Rows<R> {
    /// Directions, by columns; null for a row that locks nothing.
    e: Mat3<R>,
    /// φ.
    error: Vec3<R>,
    /// What J̇ q̇ has beside the share of the directions.
    bend: Vec3<R>,
}

impl<R: Real> Rows<R> {
    #[inline(always)]
    fn times(self, s: R) -> Self {
        let Self { e, error, bend } = self;
        Self {
            e: Mat3::from_columns(e.x * s, e.y * s, e.z * s),
            error: error * s,
            bend: bend * s,
        }
    }
    /// φ/h + J q̇ + ½ h J̇ q̇ and b = φ/h + ½ h J̇ q̇, given J q̇, and J̇ q̇ but for what bends, as vectors.
    #[inline(always)]
    fn remains(&self, now: Vec3<R>, ahead: Vec3<R>, h: R) -> (Vec3<R>, Vec3<R>) {
        let half = h * R::lit(0.5);
        let more = self.bend.fma(half, self.error * h.recip());
        let left = self.e.transpose_mul(ahead.fma(half, now)) + more;
        (left, self.e.transpose_mul(ahead * half) + more)
    }
}

/// Directions of the rows, and r without q̈ and impulses: φ/h + J q̇ + ½ h J̇ q̇.
#[inline(always)]
fn find<M: Machine>(k: &mut M, t: &Tables, c: M::I, couple: M::I) {
    let h = k.load(t.step, k.index(0), step::TIME);
    let x = k.vec3(t.closings.row, c, row::POINT);
    let node = k.link(t.couple_links, couple, couple_link::NODE_A);
    let a = Side {
        course: Course::read(k, t, node),
        x: seen_from_a(k, t, couple, x),
    };
    let node = k.link(t.couple_links, couple, couple_link::NODE_B);
    let b = Side {
        course: Course::read(k, t, node),
        x,
    };
    let (spin, two) = (a.course.twist.angular, M::R::lit(2.0));
    let on = k.load(t.closings.joint, c, joint_field::ENABLED);

    let w = b.course.twist.angular - spin;
    let ahead = b.course.bias.angular - a.course.bias.angular - spin.cross(w);
    let mut turns = turned(k, t, c, [&a, &b], w).times(on);
    turns.error = pace(k, t, c, joint_field::TURN_PACE, turns.error);
    let (turn, bent) = turns.remains(w, ahead, h);
    let u = b.velocity() - a.velocity();
    let ahead = b.bias() - a.bias() - spin.cross(u) * two;
    let mut shifts = shifted(k, t, c, &a, u).times(on);
    shifts.error = pace(k, t, c, joint_field::SHIFT_PACE, shifts.error);
    let (shift, bowed) = shifts.remains(u, ahead, h);

    store_mat3(k, t, c, row::TURN, turns.e);
    store_mat3(k, t, c, row::SHIFT, shifts.e);
    let [turns, shifts] = t.closings.rows(k, c);
    let (turn, bent) = (turn.to_array(), bent.to_array());
    let (shift, bowed) = (shift.to_array(), bowed.to_array());
    for i in 0..3 {
        t.locked.remains(k, turns[i], turn[i], bent[i]);
        t.locked.remains(k, shifts[i], shift[i], bowed[i]);
    }
}

/// What of a gap a step closes.
#[inline(always)]
fn pace<M: Machine>(k: &M, t: &Tables, c: M::I, field: usize, gap: Vec3<M::R>) -> Vec3<M::R> {
    let pace = k.read(t.closings.joint, c, field);
    gap * tied::share(gap.length(), pace)
}

/// Adds h J q̈ to r.
#[inline(always)]
fn accelerate<M: Machine>(k: &mut M, t: &Tables, c: M::I, couple: M::I, h: M::R) {
    let x = k.vec3(t.closings.row, c, row::POINT);
    let x_a = seen_from_a(k, t, couple, x);
    let a = k.link(t.couple_links, couple, couple_link::NODE_A);
    let b = k.link(t.couple_links, couple, couple_link::NODE_B);
    let a = k.spatial(t.frame, a, frame::ACCELERATION);
    let b = k.spatial(t.frame, b, frame::ACCELERATION);
    let turn = mat3(k, t, c, row::TURN).transpose_mul(b.angular - a.angular);
    let shift = mat3(k, t, c, row::SHIFT).transpose_mul(at(b, x) - at(a, x_a));
    let (turn, shift) = ((turn * h).to_array(), (shift * h).to_array());
    let [turns, shifts] = t.closings.rows(k, c);
    for i in 0..3 {
        t.locked.gains(k, turns[i], turn[i]);
        t.locked.gains(k, shifts[i], shift[i]);
    }
}

/// The rows that lock turns; `w` is how fast B turns in A.
#[inline(always)]
fn turned<M: Machine>(
    k: &M,
    t: &Tables,
    c: M::I,
    [a, b]: [&Side<M::R>; 2],
    w: Vec3<M::R>,
) -> Rows<M::R> {
    let (zero, one) = (M::R::zero(), M::R::one());
    let none = Vec3::zero();
    let qa = a.course.place.q * k.quat(t.closings.joint, c, joint_field::FRAME_A);
    let qb = b.course.place.q * k.quat(t.closings.joint, c, joint_field::FRAME_B);
    let frame = qa.to_mat3();
    let x = Vec3::new(one, zero, zero);
    let mut e = Mat3::from_columns(none, none, none).hold(k);
    let mut error = none.hold(k);
    let mut bend = none.hold(k);
    let kind = k.link(t.closings.links, c, joint_link::TURNS);
    if let Some(_branch) = k.when(k.equals(kind, turns::LOCKED)) {
        e.set(frame);
        error.set((qa.conjugate() * qb).log());
    }
    if let Some(_branch) = k.when(k.equals(kind, turns::ONE)) {
        let tilt = frame.x.cross(qb.rotate(x));
        e.set(Mat3::from_columns(none, frame.y, frame.z));
        error.set(Vec3::new(zero, frame.y.dot(tilt), frame.z.dot(tilt)));
    }
    if let Some(_branch) = k.when(k.equals(kind, turns::TWO)) {
        let second = k.vec3(t.closings.joint, c, joint_field::SECOND);
        let (a, b) = (frame.x, qb.rotate(second));
        let n = a.cross(b);
        let over = n.length().max(M::R::lit(1e-6)).recip();
        let cosine = a.dot(b);
        e.set(Mat3::from_columns(n * over, none, none));
        error.set(x * ((second.x - cosine) * over));
        let turning = w.length_squared() * cosine - a.dot(w) * b.dot(w);
        bend.set(x * (turning * over));
    }
    Rows {
        e: e.get(),
        error: error.get(),
        bend: bend.get(),
    }
}

/// The rows that lock shifts; `u` is how fast the held point shifts in A.
#[inline(always)]
fn shifted<M: Machine>(k: &M, t: &Tables, c: M::I, a: &Side<M::R>, u: Vec3<M::R>) -> Rows<M::R> {
    let (zero, one) = (M::R::zero(), M::R::one());
    let none = Vec3::zero();
    let anchor = k.vec3(t.closings.joint, c, joint_field::ANCHOR_A);
    let gap = a.x - a.course.place.point(anchor);
    let turn = k.quat(t.closings.joint, c, joint_field::LINEAR_FRAME);
    let free = (a.course.place.q * turn).to_mat3();
    let lock = k.vec3(t.closings.joint, c, joint_field::LOCKED);
    let locked = Mat3::from_columns(free.x * lock.x, free.y * lock.y, free.z * lock.z);
    let mut e = locked.hold(k);
    let mut error = locked.transpose_mul(gap).hold(k);
    let mut bend = none.hold(k);
    let kind = k.link(t.closings.links, c, joint_link::HOLD);
    if let Some(_branch) = k.when(k.equals(kind, hold::DISTANCE)) {
        let x = Vec3::new(one, zero, zero);
        let length = k.load(t.closings.joint, c, joint_field::LENGTH);
        let n = gap.normalized_or(Vec3::new(zero, one, zero));
        let far = gap.length();
        let along = n.dot(u);
        e.set(Mat3::from_columns(n, none, none));
        error.set(x * (far - length));
        let across = u.length_squared() - along.squared();
        bend.set(x * (across / far.max(M::R::lit(1e-6))));
    }
    Rows {
        e: e.get(),
        error: error.get(),
        bend: bend.get(),
    }
}

#[inline(always)]
fn store_mat3<M: Machine>(k: &mut M, t: &Tables, c: M::I, field: usize, m: Mat3<M::R>) {
    k.store_vec3(t.closings.row, c, field, m.x);
    k.store_vec3(t.closings.row, c, field + 3, m.y);
    k.store_vec3(t.closings.row, c, field + 6, m.z);
}

#[inline(always)]
fn mat3<M: Machine>(k: &M, t: &Tables, c: M::I, field: usize) -> Mat3<M::R> {
    Mat3::from_columns(
        k.vec3(t.closings.row, c, field),
        k.vec3(t.closings.row, c, field + 3),
        k.vec3(t.closings.row, c, field + 6),
    )
}

/// y of a joint's rows.
#[inline(always)]
fn responses<M: Machine>(k: &mut M, t: &Tables, c: M::I, couple: M::I) {
    let path = Path::of(k, t, couple);
    let [turns, shifts] = t.closings.rows(k, c);
    let e = mat3(k, t, c, row::TURN);
    let against = Mat3::from_columns(-e.x, -e.y, -e.z);
    let sides = [factor::moments(against), factor::moments(e)];
    factor::rows(k, t, path, &(t.locked, turns), sides);
    let x = k.vec3(t.closings.row, c, row::POINT);
    let x_a = seen_from_a(k, t, couple, x);
    let e = mat3(k, t, c, row::SHIFT);
    let against = Mat3::from_columns(-e.x, -e.y, -e.z);
    let sides = [factor::forces(x_a, against), factor::forces(x, e)];
    factor::rows(k, t, path, &(t.locked, shifts), sides);
}

/// Moment [N·m] about the held point and force [N] on B of the last step, world axes.
#[inline(always)]
fn wrench<M: Machine>(k: &M, t: &Tables, c: M::I) -> Spatial<M::R> {
    let [turns, shifts] = t.closings.rows(k, c);
    let moment = mat3(k, t, c, row::TURN) * t.locked.forces(k, turns);
    let force = mat3(k, t, c, row::SHIFT) * t.locked.forces(k, shifts);
    Spatial::new(moment, force)
}

/// Tells the reactions, and takes the wrenches off what moves the bodies. Needs [`press`].
#[inline(always)]
pub(super) fn report<M: Machine>(k: &mut M, t: &Tables) {
    for c in k.count(t.closings.count) {
        let couple = k.link(t.closings.links, c, joint_link::COUPLE);
        let [_, group] = k.link_row::<_, 2>(t.couple_links, couple);
        let b = k.link(t.couple_links, couple, couple_link::NODE_B);
        let x = k.vec3(t.closings.row, c, row::POINT);
        let wrench = wrench(k, t, c);
        let (moment, force) = (wrench.angular, wrench.linear);
        let origin = k.pose(t.frame, b, frame::PLACE);
        let origin = origin.point(k.vec3(t.closings.joint, c, joint_field::ORIGIN));
        let joint = k.link(t.closings.links, c, joint_link::JOINT);
        let torque = (x - origin).cross_plus(force, moment);
        k.store_vec3(t.output.reaction, joint, reaction::FORCE, force);
        k.store_vec3(t.output.reaction, joint, reaction::TORQUE, torque);

        let x = x + k.vec3(t.point, group, 0);
        let carried = Spatial::new(x.cross_plus(force, moment), force);
        let one = k.link(t.closings.links, c, joint_link::BODY_A);
        let other = k.link(t.closings.links, c, joint_link::BODY_B);
        let sum = k.spatial(t.wrench, one, 0) + carried;
        k.store_spatial(t.wrench, one, 0, sum);
        let sum = k.spatial(t.wrench, other, 0) - carried;
        k.store_spatial(t.wrench, other, 0, sum);
    }
}
