//! A joint of two bodies: what it locks, solved as one block, and what acts along its axes.
//!
//! A joint has six rows J: three about the gradients g of its angular coordinates, three along its linear
//! axes f, of B's anchor as it moves against A (Featherstone 2008, chapter 3, in maximal coordinates). With
//! u = J v, the response to impulses λ along the rows is
//!
//! ```text
//! u' = u + K λ,    K = J M⁻¹ Jᵀ        M the masses and inertias of A and B
//! ```
//!
//! Rows that are locked, L, are solved together, at the velocity that takes their error c out:
//!
//! ```text
//! K_LL Δλ = −m (u + β c) − s K_LL λ,    m = 1/(1 + κ), s = κ/(1 + κ)
//! κ = 1/((2πf)² (T/h + 1)),  β = 1/(T + h)
//! ```
//!
//! which is a spring and a damper in proportion to K⁻¹, implicit in time (Catto, *Soft Constraints*, 2011),
//! of f periods per small step, which closes a gap with the time constant T. When relaxing β and κ are 0. A
//! row i that is not locked is pushed with what the locks make of it, so that they stay as they are; no λ counts that:
//!
//! ```text
//! w_i = e_i − K_LL⁻¹ K_Li,    K_i w_i the response of its rate
//! ```
//!
//! and what acts along it is balanced exactly (`law`), and holds on to that when relaxing. That push moves the locks as well,
//! which others make give way, and so what acts sees the coordinate, and the rate, that the push does work on:
//!
//! ```text
//! θ̃_i = w_i · (θ, c) = θ_i − K_iL K_LL⁻¹ c        ũ_i = w_i · u
//! ```
//!
//! Of bodies with long arms an error of locks turns the whole, and a spring that sees θ_i takes work from that, or gives it,
//! which it does not store: what swung on several joints grew without end.
//!
//! A gap of a loop, which may be wide when a world begins, closes no faster than at a pace: β c within 1 m/s, as by
//! `featherstone`.
//!
//! Where several rows are acted along, a push drags with it what is passive along the others, where an impulse falls with
//! the rate by h z, z = h k + d + m/h:
//!
//! ```text
//! w_i = e_i − S (S K S + E)⁻¹ S K_i,    S = 1 on locked rows, √(h z) on the others but i, E = 1 on all but the locked
//! ```
//!
//! so that what one row has come to, none that follows undoes: armatures and dampers of all rows are solved as one. With
//! locks alone in w, a body of little moment about one direction, which three axes share, took so many passes to find the
//! impulses across it that these, given again, grew without end.
//!
//! The error of rotations and the angles are those by which the joint's own sequence of turns R(θ) misses the bodies':
//!
//! ```text
//! e = log(R_AB R(θ)ᵀ),    θ ← θ + gᵀ e on free axes,  c = gᵀ e on locked ones
//! ```
//!
//! where three vectors always make a basis, of free axes and of those that complete them, and the
//! gradients are its dual: so every kind of joint is the same kernel.
//!
//! Impulses are kept as those on B at its anchor, in world axes. What was given again with the bodies'
//! motion had the arms and axes of the small step before: [`solve`] gives the difference.

mod actuation;
mod drive;
mod law;
mod layout;
mod report;
mod tables;
mod tied;

pub use actuation::{Actuation, Sources, acting, actuate};
pub use drive::follow;
pub use layout::TIED_STATE;
pub(super) use layout::{Ties, inner_frames, is_bare};
pub use report::{TieReport, tell_tie};
pub use tables::{JointTables, LAWS, PLACED, ROWS, axis, axis_link, joint, law as bounded};
pub use tied::{Actuators, Tied};

use super::tables::{global, row};
use numbers::machine::{Held, Hold};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Cell, Machine, Mat3, Quat, Real, SymMat3, Vec3};
use tables::work;

/// f: frequency of a lock's spring, per small step; `layout` says why not more.
const FREQUENCY: f64 = 0.125;
/// T: small steps within which a gap closes.
const CALM: f64 = 8.0;
/// Pivots below this are none [1/kg, 1/(kg·m²)].
const TINY: f64 = 1e-18;
/// Least response of an axis [1/kg, 1/(kg·m²)].
const STIFF: f64 = 1e-30;
/// Least square of the volume of three axes: nearly in one plane, as in gimbal lock.
const FLAT: f64 = 1e-6;

/// κ.
fn softness() -> f64 {
    let stiffness = (core::f64::consts::TAU * FREQUENCY).powi(2);
    1.0 / (stiffness * (CALM + 1.0))
}

#[inline(always)]
fn load_mat3<M: Machine>(k: &M, t: &JointTables, field: usize) -> Mat3<M::R> {
    let only = k.index(0);
    Mat3::from_columns(
        k.vec3(t.joint, only, field),
        k.vec3(t.joint, only, field + 3),
        k.vec3(t.joint, only, field + 6),
    )
}

#[inline(always)]
fn store_mat3<M: Machine>(k: &mut M, t: &JointTables, field: usize, m: Mat3<M::R>) {
    let only = k.index(0);
    k.store_vec3(t.joint, only, field, m.x);
    k.store_vec3(t.joint, only, field + 3, m.y);
    k.store_vec3(t.joint, only, field + 6, m.z);
}

#[inline(always)]
fn times<R: Real>(a: Spatial<R>, b: Spatial<R>) -> Spatial<R> {
    Spatial::new(a.angular.times(b.angular), a.linear.times(b.linear))
}

/// The rows of a joint: gradients, axes, and linear axes.
#[derive(Clone, Copy)]
struct Rows<R> {
    gradients: Mat3<R>,
    axes: Mat3<R>,
    shifts: Mat3<R>,
}

impl<R: Real> Rows<R> {
    #[inline(always)]
    fn load<M: Machine<R = R>>(k: &M, t: &JointTables) -> Self {
        Self {
            gradients: load_mat3(k, t, joint::GRADIENTS),
            axes: load_mat3(k, t, joint::AXES),
            shifts: load_mat3(k, t, joint::SHIFTS),
        }
    }
    /// Rates of the rows.
    #[inline(always)]
    fn rates(&self, u: Spatial<R>) -> Spatial<R> {
        Spatial::new(
            self.gradients.transpose_mul(u.angular),
            self.shifts.transpose_mul(u.linear),
        )
    }
    /// The impulse on B that impulses along the rows make.
    #[inline(always)]
    fn wrench(&self, x: Spatial<R>) -> Spatial<R> {
        Spatial::new(self.gradients * x.angular, self.shifts * x.linear)
    }
    /// Impulses along the rows that make an impulse on B.
    #[inline(always)]
    fn along(&self, w: Spatial<R>) -> Spatial<R> {
        Spatial::new(
            self.axes.transpose_mul(w.angular),
            self.shifts.transpose_mul(w.linear),
        )
    }
}

/// The bodies of a joint, changed by impulses.
struct Pair<M: Machine> {
    masses: [M::R; 2],
    inertia: [SymMat3<M::R>; 2],
    arms: [Vec3<M::R>; 2],
    a: <Spatial<M::R> as Hold<M>>::Held,
    b: <Spatial<M::R> as Hold<M>>::Held,
    /// All that the joint has given: see [`joint::IMPULSE`].
    given: <Spatial<M::R> as Hold<M>>::Held,
}

#[inline(always)]
fn motion<M: Machine>(k: &M, t: &JointTables, body: M::I) -> Spatial<M::R> {
    Spatial::new(
        k.vec3(t.body, body, row::SPIN),
        k.vec3(t.body, body, row::VELOCITY),
    )
}

#[inline(always)]
fn arms<M: Machine>(k: &M, t: &JointTables, field: usize) -> [Vec3<M::R>; 2] {
    let only = k.index(0);
    [
        k.vec3(t.joint, only, field),
        k.vec3(t.joint, only, field + 3),
    ]
}

impl<M: Machine> Pair<M> {
    #[inline(always)]
    fn load(k: &M, t: &JointTables) -> Self {
        let only = k.index(0);
        Self {
            masses: k.read(t.joint, only, joint::INVERSE_MASS),
            inertia: [
                k.sym(t.joint, only, joint::INVERSE_INERTIA),
                k.sym(t.joint, only, joint::INVERSE_INERTIA + 6),
            ],
            arms: arms(k, t, joint::ARMS),
            a: motion(k, t, only).hold(k),
            b: motion(k, t, k.index(1)).hold(k),
            given: k.spatial(t.joint, only, joint::IMPULSE).hold(k),
        }
    }
    #[inline(always)]
    fn store(self, k: &mut M, t: &JointTables) {
        let (only, second) = (k.index(0), k.index(1));
        let (a, b) = (self.a.get(), self.b.get());
        k.store_vec3(t.body, only, row::SPIN, a.angular);
        k.store_vec3(t.body, only, row::VELOCITY, a.linear);
        k.store_vec3(t.body, second, row::SPIN, b.angular);
        k.store_vec3(t.body, second, row::VELOCITY, b.linear);
        k.store_spatial(t.joint, only, joint::IMPULSE, self.given.get());
    }
    /// Motion of B's anchor against A.
    #[inline(always)]
    fn apart(&self) -> Spatial<M::R> {
        apart([self.a.get(), self.b.get()], self.arms)
    }
    /// Impulses on B through its anchor, and opposite ones on A; `turns` are further angular impulses
    /// about the centres of A and B.
    #[inline(always)]
    fn shove(&mut self, w: Spatial<M::R>, turns: [Vec3<M::R>; 2]) {
        let (mut a, mut b) = (self.a.get(), self.b.get());
        a.linear = w.linear.fma(-self.masses[0], a.linear);
        b.linear = w.linear.fma(self.masses[1], b.linear);
        a.angular -= self.inertia[0] * (w.angular + self.arms[0].cross(w.linear) + turns[0]);
        b.angular += self.inertia[1] * (w.angular + self.arms[1].cross(w.linear) + turns[1]);
        self.a.set(a);
        self.b.set(b);
        self.given.set(self.given.get() + w);
    }
    #[inline(always)]
    fn push(&mut self, w: Spatial<M::R>) {
        self.shove(w, [Vec3::zero(), Vec3::zero()]);
    }
}

/// Motion of B's anchor against A, given those of A and B.
#[inline(always)]
fn apart<R: Real>([a, b]: [Spatial<R>; 2], arms: [Vec3<R>; 2]) -> Spatial<R> {
    let va = a.linear + a.angular.cross(arms[0]);
    let vb = b.linear + b.angular.cross(arms[1]);
    Spatial::new(b.angular - a.angular, vb - va)
}

/// Orientation of a body now.
#[inline(always)]
fn orientation<M: Machine>(k: &M, t: &JointTables, body: M::I) -> Quat<M::R> {
    Quat::exp(k.vec3(t.body, body, row::TURN)) * k.quat(t.body, body, row::ORIENTATION)
}

/// Where the joint stands: its rows, what they are off, and how they respond.
#[inline(always)]
pub fn place<M: Machine>(k: &mut M, t: &JointTables) {
    let (only, a, b) = (k.index(0), k.index(0), k.index(1));
    let (qa, qb) = (orientation(k, t, a), orientation(k, t, b));
    let centres = k.vec3(t.body, b, row::CENTER) - k.vec3(t.body, a, row::CENTER);
    let shifts = k.vec3(t.body, b, row::SHIFT) - k.vec3(t.body, a, row::SHIFT);
    let rb = qb.rotate(k.vec3(t.joint, only, joint::ANCHOR_B));
    let ra = centres + shifts + rb;
    let gap = ra - qa.rotate(k.vec3(t.joint, only, joint::ANCHOR_A));
    k.store_vec3(t.joint, only, joint::ARMS, ra);
    k.store_vec3(t.joint, only, joint::ARMS + 3, rb);
    let (gradients, turned) = place_turns(k, t, qa, qb);
    let (shifts, shifted) = place_shifts(k, t, qa, gap);
    let locked = k.spatial(t.joint, only, joint::LOCKED);
    let off = times(Spatial::new(turned, shifted), locked);
    k.store_spatial(t.joint, only, joint::ERROR, off);
    respond(k, t, (gradients, shifts), [ra, rb], off);
}

/// The linear axes, and how far B's anchor is along them.
#[inline(always)]
fn place_shifts<M: Machine>(
    k: &mut M,
    t: &JointTables,
    qa: Quat<M::R>,
    gap: Vec3<M::R>,
) -> (Mat3<M::R>, Vec3<M::R>) {
    let only = k.index(0);
    let mut shifts = (qa * k.quat(t.joint, only, joint::LINEAR_FRAME)).to_mat3();
    let length = k.load(t.joint, only, joint::LENGTH);
    let rod = length.ge(M::R::zero());
    shifts.x = Vec3::select(rod, gap.normalized_or(shifts.x), shifts.x);
    let mut along = shifts.transpose_mul(gap);
    along.x -= length.max(M::R::zero());
    store_mat3(k, t, joint::SHIFTS, shifts);
    k.store(t.axis, k.index(3), axis::VALUE, along.x);
    k.store(t.axis, k.index(4), axis::VALUE, along.y);
    k.store(t.axis, k.index(5), axis::VALUE, along.z);
    (shifts, along)
}

/// The gradients of the angular coordinates, and e along them.
#[inline(always)]
fn place_turns<M: Machine>(
    k: &mut M,
    t: &JointTables,
    qa: Quat<M::R>,
    qb: Quat<M::R>,
) -> (Mat3<M::R>, Vec3<M::R>) {
    let only = k.index(0);
    let frame = qa * k.quat(t.joint, only, joint::FRAME_A);
    let relative = frame.conjugate() * (qb * k.quat(t.joint, only, joint::FRAME_B));
    let angle = k.vec3(t.joint, only, joint::ANGLE);
    let x = Vec3::new(M::R::one(), M::R::zero(), M::R::zero());
    let second = k.vec3(t.joint, only, joint::SECOND);
    let third = k.vec3(t.joint, only, joint::THIRD);
    let once = Quat::from_axis_angle(x, angle.x);
    let twice = once * Quat::from_axis_angle(second, angle.y);
    let thrice = twice * Quat::from_axis_angle(third, angle.z);
    let carried = k.load(t.joint, only, joint::CARRIED).gt(M::R::zero());
    let ball = k.load(t.joint, only, joint::BALL).gt(M::R::zero());
    let target = k.quat(t.joint, only, joint::TARGET);
    let e = (relative * Quat::select(ball, target, thrice).conjugate()).log();
    let own = relative.to_mat3();
    let axes = Mat3::from_columns(
        Vec3::select(ball, own.x, x),
        Vec3::select(ball, own.y, once.rotate(second)),
        Vec3::select(
            ball,
            own.z,
            Quat::select(carried, twice, once).rotate(third),
        ),
    );
    let gradients = dual(axes);
    let off = gradients.transpose_mul(e);
    let value = angle + off;
    let locked = k.vec3(t.joint, only, joint::LOCKED);
    let (value, locked) = (value.to_array(), locked.to_array());
    for i in 0..3 {
        let stays = ball | locked[i].gt(M::R::zero());
        let angle = M::R::select(stays, M::R::zero(), value[i]);
        k.store(t.joint, only, joint::ANGLE + i, angle);
        k.store(t.axis, k.index(i), axis::VALUE, value[i]);
    }
    let turn = frame.to_mat3();
    let (axes, gradients) = (turn * axes, turn * gradients);
    store_mat3(k, t, joint::AXES, axes);
    store_mat3(k, t, joint::GRADIENTS, gradients);
    (gradients, off)
}

/// The dual basis, within bounds where the vectors nearly lie in a plane.
#[inline(always)]
fn dual<R: Real>(m: Mat3<R>) -> Mat3<R> {
    let (x, y, z) = (m.y.cross(m.z), m.z.cross(m.x), m.x.cross(m.y));
    let volume = m.x.dot(x);
    let inverse = volume / volume.squared().max(R::lit(FLAT));
    Mat3::from_columns(x * inverse, y * inverse, z * inverse)
}

/// How the rows respond to impulses along them, and what the locks, which are `off` so far, make of those along the others;
/// and where these stand for what acts along them.
#[inline(always)]
fn respond<M: Machine>(
    k: &mut M,
    t: &JointTables,
    (gradients, shifts): (Mat3<M::R>, Mat3<M::R>),
    [ra, rb]: [Vec3<M::R>; 2],
    off: Spatial<M::R>,
) {
    let (only, a, b) = (k.index(0), k.index(0), k.index(1));
    let masses = [
        k.load(t.body, a, row::INVERSE_MASS),
        k.load(t.body, b, row::INVERSE_MASS),
    ];
    let (ia, ib) = (
        k.sym(t.body, a, row::INVERSE_INERTIA),
        k.sym(t.body, b, row::INVERSE_INERTIA),
    );
    k.write(t.joint, only, joint::INVERSE_MASS, masses);
    k.store_sym(t.joint, only, joint::INVERSE_INERTIA, ia);
    k.store_sym(t.joint, only, joint::INVERSE_INERTIA + 6, ib);
    // As if each joint of a body had a share of it.
    let [na, nb] = k.read(t.joint, only, joint::SHARES);
    let (ia, ib) = (ia.scaled(na), ib.scaled(nb));
    let linear = arm_response(ia, ra) + arm_response(ib, rb);
    let linear = linear + SymMat3::diagonal(masses[0] * na + masses[1] * nb);
    let all = Inertia {
        i: (ia + ib).rotated(gradients.transpose()),
        h: gradients.transpose()
            * Mat3::from_columns(
                ia * ra.cross(shifts.x) + ib * rb.cross(shifts.x),
                ia * ra.cross(shifts.y) + ib * rb.cross(shifts.y),
                ia * ra.cross(shifts.z) + ib * rb.cross(shifts.z),
            ),
        m: linear.rotated(shifts.transpose()),
    };
    store_columns(k, t, &all, gradients, shifts);
    let locked = k.spatial(t.joint, only, joint::LOCKED);
    let block = among(&all, locked, locked);
    k.store_inertia(t.joint, only, joint::BLOCK, block);
    let mixed = impede(k, t);
    for i in k.count(ROWS) {
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let column = k.spatial(t.work, i, work::COLUMN);
            let own = k.load(t.axis, i, axis::RESPONSE);
            let wrench = k.spatial(t.axis, i, axis::WRENCH);
            let held = block.solve(times(column, locked), M::R::lit(TINY));
            let value = k.load(t.axis, i, axis::VALUE) - held.dot(off);
            k.store(t.axis, i, axis::VALUE, value);
            let back = Spatial::new(gradients * held.angular, shifts * held.linear);
            k.store(t.axis, i, axis::RESPONSE, own - column.dot(held));
            k.store_spatial(t.axis, i, axis::WRENCH, wrench - back);
            k.store_spatial(t.axis, i, axis::HOLDS, wrench - back);
            if let Some(_branch) = k.if_any(mixed) {
                let s = locked + others(k, t, i);
                let dragged = among(&all, s, locked).solve(times(column, s), M::R::lit(TINY));
                let dragged = times(dragged, s);
                let back = Spatial::new(gradients * dragged.angular, shifts * dragged.linear);
                let response = own - column.dot(dragged);
                k.store_where(mixed, t.axis, i, axis::RESPONSE, response);
                for (field, x) in (wrench - back).to_array().into_iter().enumerate() {
                    k.store_where(mixed, t.axis, i, axis::WRENCH + field, x);
                }
            }
        }
    }
}

/// √(h z) of all rows; and where several are acted along, one of them by what is passive.
#[inline(always)]
fn impede<M: Machine>(k: &mut M, t: &JointTables) -> <M::R as Real>::Mask {
    let (only, zero) = (k.index(0), M::R::zero());
    let (mut count, mut sum) = (k.cell(zero), k.cell(zero));
    for i in k.count(ROWS) {
        k.store(t.work, i, work::ROOT, zero);
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let acts = k.load(t.axis, i, axis::ACTS);
            let root = falls(k, t, i).sqrt() * acts;
            k.store(t.work, i, work::ROOT, root);
            count.write(count.read() + acts);
            sum.write(sum.read() + root);
        }
    }
    let mixed = count.read().gt(M::R::one()) & sum.read().gt(zero);
    let flag = M::R::select(mixed, M::R::one(), zero);
    k.store(t.joint, only, joint::MIXED, flag);
    mixed
}

/// h z of what is passive along a row: by how much its impulse falls with the rate.
#[inline(always)]
fn falls<M: Machine>(k: &M, t: &JointTables, i: M::I) -> M::R {
    let [h, per] = k.read(t.global, k.index(0), global::STEP);
    let [stiffness, damping, _, armature] = k.read(t.axis, i, axis::PASSIVE);
    h * armature
        .fma(per, h.fma(stiffness, damping))
        .max(M::R::zero())
}

/// √(h z) of all rows but one, which has 0.
#[inline(always)]
fn others<M: Machine>(k: &mut M, t: &JointTables, i: M::I) -> Spatial<M::R> {
    let own = k.load(t.work, i, work::ROOT);
    k.store(t.work, i, work::ROOT, M::R::zero());
    let angular = Vec3::new(root(k, t, 0), root(k, t, 1), root(k, t, 2));
    let linear = Vec3::new(root(k, t, 3), root(k, t, 4), root(k, t, 5));
    k.store(t.work, i, work::ROOT, own);
    Spatial::new(angular, linear)
}

#[inline(always)]
fn root<M: Machine>(k: &M, t: &JointTables, row: usize) -> M::R {
    k.load(t.work, k.index(row), work::ROOT)
}

/// −r× I⁻¹ r×: response of a point at the arm r through rotation.
#[inline(always)]
fn arm_response<R: Real>(i: SymMat3<R>, r: Vec3<R>) -> SymMat3<R> {
    i.rotated(Mat3::skew(r))
}

/// The rows of K, and impulses along them as the bodies see them.
#[inline(always)]
fn store_columns<M: Machine>(
    k: &mut M,
    t: &JointTables,
    all: &Inertia<M::R>,
    gradients: Mat3<M::R>,
    shifts: Mat3<M::R>,
) {
    let (i, m) = (all.i.to_mat3(), all.m.to_mat3());
    let (h, ht, zero) = (all.h, all.h.transpose(), Vec3::zero());
    store_column(
        k,
        t,
        0,
        Spatial::new(i.x, ht.x),
        Spatial::new(gradients.x, zero),
        all.i.xx,
    );
    store_column(
        k,
        t,
        1,
        Spatial::new(i.y, ht.y),
        Spatial::new(gradients.y, zero),
        all.i.yy,
    );
    store_column(
        k,
        t,
        2,
        Spatial::new(i.z, ht.z),
        Spatial::new(gradients.z, zero),
        all.i.zz,
    );
    store_column(
        k,
        t,
        3,
        Spatial::new(h.x, m.x),
        Spatial::new(zero, shifts.x),
        all.m.xx,
    );
    store_column(
        k,
        t,
        4,
        Spatial::new(h.y, m.y),
        Spatial::new(zero, shifts.y),
        all.m.yy,
    );
    store_column(
        k,
        t,
        5,
        Spatial::new(h.z, m.z),
        Spatial::new(zero, shifts.z),
        all.m.zz,
    );
}

#[inline(always)]
fn store_column<M: Machine>(
    k: &mut M,
    t: &JointTables,
    row: usize,
    column: Spatial<M::R>,
    wrench: Spatial<M::R>,
    response: M::R,
) {
    let row = k.index(row);
    k.store_spatial(t.work, row, work::COLUMN, column);
    k.store_spatial(t.axis, row, axis::WRENCH, wrench);
    k.store(t.axis, row, axis::RESPONSE, response);
}

/// S K S + E: K among the locked rows where S is 1 on these alone; the others are those of the unit matrix.
#[inline(always)]
fn among<R: Real>(all: &Inertia<R>, s: Spatial<R>, locked: Spatial<R>) -> Inertia<R> {
    let (a, l) = (s.angular, s.linear);
    Inertia {
        i: scaled(all.i, a, locked.angular),
        h: Mat3::from_columns(
            all.h.x.times(a) * l.x,
            all.h.y.times(a) * l.y,
            all.h.z.times(a) * l.z,
        ),
        m: scaled(all.m, l, locked.linear),
    }
}

#[inline(always)]
fn scaled<R: Real>(m: SymMat3<R>, s: Vec3<R>, locked: Vec3<R>) -> SymMat3<R> {
    let one = R::one();
    SymMat3 {
        xx: (m.xx * s.x).fma(s.x, one - locked.x),
        yy: (m.yy * s.y).fma(s.y, one - locked.y),
        zz: (m.zz * s.z).fma(s.z, one - locked.z),
        xy: m.xy * s.x * s.y,
        xz: m.xz * s.x * s.z,
        yz: m.yz * s.y * s.z,
    }
}

/// Gives the impulses that the joint had in the step before.
#[inline(always)]
pub fn warm_start<M: Machine>(k: &mut M, t: &JointTables) {
    let mut pair = Pair::load(k, t);
    let had = pair.given.get();
    pair.given.set(Spatial::zero());
    pair.push(had);
    keep(k, t, pair.arms, had.linear);
    pair.store(k, t);
}

/// Arms and impulse to give again.
#[inline(always)]
fn keep<M: Machine>(k: &mut M, t: &JointTables, arms: [Vec3<M::R>; 2], impulse: Vec3<M::R>) {
    let only = k.index(0);
    k.store_vec3(t.joint, only, joint::LAST, arms[0]);
    k.store_vec3(t.joint, only, joint::LAST + 3, arms[1]);
    k.store_vec3(t.joint, only, joint::LAST + 6, impulse);
}

/// One relaxation of the joint; `pushing` is 1 where it is to be pushed together, and what acts along its
/// axes does, else 0.
#[inline(always)]
pub fn solve<M: Machine>(k: &mut M, t: &JointTables, pushing: M::R) {
    let pushes = pushing.gt(M::R::zero());
    let rows = Rows::load(k, t);
    let mut pair = Pair::load(k, t);
    let had = pair.given.get();
    // All lanes push, or none does.
    if let Some(_branch) = k.if_any(pushes) {
        mend(k, t, &rows, &mut pair);
    }
    hold(k, t, &rows, &mut pair, pushing);
    if let Some(_branch) = k.if_any(pushes) {
        act(k, t, &rows, &mut pair);
        keep(k, t, pair.arms, pair.given.get().linear);
    }
    if let Some(_branch) = k.if_any(!pushes) {
        hold_on(k, t, &rows, &mut pair);
    }
    count(k, t, pair.given.get(), had * (M::R::one() - pushing));
    pair.store(k, t);
}

/// Hands a blow on: a relaxation whose impulse is counted, but not given again. What acts along the axes, and what is geared
/// to them, takes part in the small step that follows.
#[inline(always)]
pub fn strike<M: Machine>(k: &mut M, t: &JointTables) {
    let rows = Rows::load(k, t);
    let mut pair = Pair::load(k, t);
    let had = pair.given.get();
    hold(k, t, &rows, &mut pair, M::R::zero());
    count(k, t, pair.given.get(), had);
    pair.given.set(had);
    pair.store(k, t);
}

/// Adds to what the step has given what this relaxation made of what was there: nothing where it is the first of a
/// small step.
#[inline(always)]
fn count<M: Machine>(k: &mut M, t: &JointTables, given: Spatial<M::R>, there: Spatial<M::R>) {
    let only = k.index(0);
    let sum = k.spatial(t.joint, only, joint::SUM);
    k.store_spatial(t.joint, only, joint::SUM, sum + (given - there));
}

/// What was given again had other arms, and rows that have turned since.
#[inline(always)]
fn mend<M: Machine>(k: &mut M, t: &JointTables, rows: &Rows<M::R>, pair: &mut Pair<M>) {
    let only = k.index(0);
    let mut kept = k.spatial(t.joint, only, joint::LOCKED).to_array();
    for (i, kept) in kept.iter_mut().enumerate() {
        *kept += k.load(t.axis, k.index(i), axis::ACTS);
    }
    let given = pair.given.get();
    let along = times(rows.along(given), Spatial::from_array(kept));
    let last = arms(k, t, joint::LAST);
    let force = k.vec3(t.joint, only, joint::LAST + 6);
    let turns = [
        (pair.arms[0] - last[0]).cross(force),
        (pair.arms[1] - last[1]).cross(force),
    ];
    pair.shove(rows.wrench(along) - given, turns);
}

/// The locked rows.
#[inline(always)]
fn hold<M: Machine>(
    k: &mut M,
    t: &JointTables,
    rows: &Rows<M::R>,
    pair: &mut Pair<M>,
    pushing: M::R,
) {
    let only = k.index(0);
    let softness = softness();
    let yields = pushing * M::R::lit(softness / (1.0 + softness));
    let had = held(k, t, rows, pair, pushing);
    let closes = pushing * k.load(t.global, only, global::RATE) * M::R::lit(1.0 / (CALM + 1.0));
    let locked = k.spatial(t.joint, only, joint::LOCKED);
    let block = k.inertia(t.joint, only, joint::BLOCK);
    let off = k.spatial(t.joint, only, joint::ERROR);
    let wrong = times(rows.rates(pair.apart()), locked) + closing(k, t, off * closes);
    let x = block.solve(wrong, M::R::lit(TINY));
    let change = x * (yields - M::R::one()) - times(had, locked) * yields;
    pair.push(rows.wrench(change));
}

/// β c, within the pace of a joint that closes a loop: what such a gap is when a world begins, no step before has bounded.
#[inline(always)]
fn closing<M: Machine>(k: &M, t: &JointTables, speed: Spatial<M::R>) -> Spatial<M::R> {
    let one = M::R::one();
    let [turns, shifts] = k.read(t.joint, k.index(0), joint::SLOW);
    let turns = one / (speed.angular.length() * turns).max(one);
    let shifts = one / (speed.linear.length() * shifts).max(one);
    Spatial::new(speed.angular * turns, speed.linear * shifts)
}

/// λ, without what the locks make of what acts along the axes, while they are pushed.
#[allow(clippy::needless_range_loop)] // iterators of arrays are not sure to be inlined
#[inline(always)]
fn held<M: Machine>(
    k: &mut M,
    t: &JointTables,
    rows: &Rows<M::R>,
    pair: &Pair<M>,
    pushing: M::R,
) -> Spatial<M::R> {
    let mut given = pair.given.get().hold(k);
    if let Some(_branch) = k.if_any(pushing.gt(M::R::zero())) {
        let had = rows.along(pair.given.get()).to_array();
        for row in 0..ROWS {
            k.store(t.work, k.index(row), work::HAD, had[row]);
        }
        for i in k.count(ROWS) {
            let acts = k.link(t.links, i, axis_link::ACTS);
            if let Some(_branch) = k.when(k.equals(acts, 1)) {
                let had = k.load(t.work, i, work::HAD) * k.load(t.axis, i, axis::ACTS);
                given.set(given.get() - k.spatial(t.axis, i, axis::HOLDS) * had);
            }
        }
    }
    rows.along(given.get())
}

/// What acts along the axes, one after the other.
#[allow(clippy::needless_range_loop)] // iterators of arrays are not sure to be inlined
#[inline(always)]
fn act<M: Machine>(k: &mut M, t: &JointTables, rows: &Rows<M::R>, pair: &mut Pair<M>) {
    let only = k.index(0);
    let before = k.spatial(t.joint, only, joint::SPEED).to_array();
    for row in 0..ROWS {
        let numbers = [before[row], M::R::one()];
        k.write(t.work, k.index(row), work::BEGIN, numbers);
    }
    let rates = rows.rates(pair.apart());
    k.store_spatial(t.joint, only, joint::SPEED, rates);
    let ball = k.load(t.joint, only, joint::BALL).gt(M::R::zero());
    if let Some(_branch) = k.if_any(ball) {
        law::share_effort(k, t, rates.angular, ball);
    }
    for i in k.count(ROWS) {
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let [rate, had] = along(k, t, rows, pair, i);
            let begin = k.load(t.work, i, work::BEGIN);
            let (after, yields) = law::balance(k, t, i, [rate, begin], had);
            k.store(t.axis, i, axis::YIELDS, yields);
            let change = bring(k, t, pair, i, [rate, after]);
            k.store(t.axis, i, axis::DRAGGED, had + change);
        }
    }
    let mixed = k.load(t.joint, only, joint::MIXED).gt(M::R::zero());
    if let Some(_branch) = k.if_any(mixed) {
        since(k, t, rows, pair);
    }
}

/// What rows have been given, less what they keep of that: first what others dragged since their turn, then what to count
/// from that others drag.
#[inline(always)]
fn since<M: Machine>(k: &mut M, t: &JointTables, rows: &Rows<M::R>, pair: &Pair<M>) {
    for i in k.count(ROWS) {
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let [_, had] = along(k, t, rows, pair, i);
            let before = k.load(t.axis, i, axis::DRAGGED);
            k.store(t.axis, i, axis::DRAGGED, had - before);
        }
    }
}

/// What acts along the axes holds on to the rates that it has led to, as far as it does: see `law`. What rows that were
/// pushed later have dragged along does so already.
#[inline(always)]
fn hold_on<M: Machine>(k: &mut M, t: &JointTables, rows: &Rows<M::R>, pair: &mut Pair<M>) {
    let (only, zero) = (k.index(0), M::R::zero());
    let mixed = k.load(t.joint, only, joint::MIXED).gt(zero);
    if let Some(_branch) = k.if_any(mixed) {
        since(k, t, rows, pair);
    }
    for i in k.count(ROWS) {
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let [rate, had] = along(k, t, rows, pair, i);
            let dragged = had - k.load(t.axis, i, axis::DRAGGED);
            let dragged = M::R::select(mixed, dragged, zero);
            let response = k.load(t.axis, i, axis::RESPONSE);
            let alone = response.fnma(dragged, rate);
            let led_to = k.load(t.speed, i, 0);
            let after = k.load(t.axis, i, axis::YIELDS).fma(alone - led_to, led_to);
            let change = bring(k, t, pair, i, [rate, after]);
            k.store(t.axis, i, axis::DRAGGED, had + change);
        }
    }
    if let Some(_branch) = k.if_any(mixed) {
        go_along(k, t, rows, pair, mixed);
    }
}

/// What is geared to axes has the rates that all of them have in the end: what others have dragged out of it since its turn
/// has changed it by that over h z. The bodies' rate would not be it, where they have only shares of their masses here.
#[inline(always)]
fn go_along<M: Machine>(
    k: &mut M,
    t: &JointTables,
    rows: &Rows<M::R>,
    pair: &Pair<M>,
    mixed: <M::R as Real>::Mask,
) {
    for i in k.count(ROWS) {
        let acts = k.link(t.links, i, axis_link::ACTS);
        if let Some(_branch) = k.when(k.equals(acts, 1)) {
            let [_, had] = along(k, t, rows, pair, i);
            let dragged = had - k.load(t.axis, i, axis::DRAGGED);
            let (falls, zero) = (falls(k, t, i), M::R::zero());
            let acts = k.load(t.axis, i, axis::ACTS).gt(zero);
            let tied = mixed & acts & falls.gt(zero);
            let slower = dragged / M::R::select(tied, falls, M::R::one());
            let speed = k.load(t.speed, i, 0) - slower;
            k.store_where(tied, t.speed, i, 0, speed);
            k.store(t.axis, i, axis::DRAGGED, zero);
        }
    }
}

/// The rate of what the push along a row moves, and the impulse that it has been given.
#[inline(always)]
fn along<M: Machine>(
    k: &mut M,
    t: &JointTables,
    rows: &Rows<M::R>,
    pair: &Pair<M>,
    i: M::I,
) -> [M::R; 2] {
    let had = rows.along(pair.given.get()).to_array();
    for (row, had) in had.into_iter().enumerate() {
        k.store(t.work, k.index(row), work::HAD, had);
    }
    let rate = k.spatial(t.axis, i, axis::HOLDS).dot(pair.apart());
    [rate, k.load(t.work, i, work::HAD)]
}

/// Brings a row from one rate to another, with what is geared to it, by an impulse.
#[inline(always)]
fn bring<M: Machine>(
    k: &mut M,
    t: &JointTables,
    pair: &mut Pair<M>,
    i: M::I,
    [rate, after]: [M::R; 2],
) -> M::R {
    let acts = k.load(t.axis, i, axis::ACTS);
    let change = (after - rate) * acts;
    let response = k.load(t.axis, i, axis::RESPONSE).max(M::R::lit(STIFF));
    k.store_where(acts.gt(M::R::zero()), t.speed, i, 0, after);
    let impulse = change / response;
    pair.push(k.spatial(t.axis, i, axis::WRENCH) * impulse);
    impulse
}
