//! All joints of a tree at once.
//!
//! One pass finds the displacements δ of the bodies that bring the locked rows of
//! all joints to zero while all laws along their coordinates act: the equations of
//! XPBD (Macklin et al. 2016, eq. 16) for the whole tree, solved in linear time. As
//! a tree can be eliminated from its leaves (Baraff 1996, §6; Deul et al. 2018,
//! *Direct Position-Based Solver for Stiff Rods*, §4), this is the articulated-body
//! algorithm (Featherstone 2008, §7.3) with displacements for accelerations, errors
//! e of the locked rows for bias accelerations, and λ = h² f for forces. With S
//! the motions that a joint leaves free, about its anchor on the child, inwards:
//!
//! ```text
//! Iᴬ = I + Σ Iᴬ_child       p = Σ p_child − Iᴬ e
//! U = Iᴬ S      D = Sᵀ U + g      u = λ₀ − Sᵀ p
//! Iᴬ ← Iᴬ − U Uᵀ / D        p ← p + U u / D
//! ```
//!
//! and outwards:
//!
//! ```text
//! δ = δ_parent      q = (u − Uᵀ δ) / D,  δ ← δ + S q      δ ← δ − e
//! ```
//!
//! Laws pull with λ₀ − g q along a coordinate that moves by q. A compliant row is a
//! motion, too: it gives way by q = −α/h² λ, so that 1/D is α/h² / (1 + α/h² Sᵀ U),
//! which is right for α = 0 as well.
//!
//! Parent and child are pushed at the same point P, the anchor on the child, so that
//! no push changes the linear momentum of a pair. Angular momentum Σ x × m v + I ω is
//! kept, too, if the arms of the pushes start where the centres were before the
//! substep, as x' = x + h v' has x' × m v' = x × m v' (SHAKE takes its gradients there:
//! Ryckaert, Ciccotti, Berendsen 1977; Barth, Kuczera, Leimkuhler, Skeel 1995). The pass
//! takes them from x + h v, with v as it is then. So each joint, which pushes the child
//! B with λ and the parent A with −λ, adds what is missing if P came with u,
//!
//! ```text
//! ΔL_B = (v_B − u) × λ      ΔL_A = (u − v_A) × λ      ω' = I(q')⁻¹ (I(q) (ω + δφ/h) + ΔL)
//! ```
//!
//! and the spin is that of the angular momentum after the turn δφ. That is exact to rounding
//! for turns of up to 0.01 rad; longer ones are off as their quaternions are from unit length, by
//! 3/8 (δφ/2)⁴.
//!
//! Any u will do for momentum. With the velocity of P energy does not drift, as with SHAKE,
//! whose v is half a step late, and periods of swings are right to second order; but chains that
//! whip round faster than substeps can follow gain energy. They lose it, as with arms from x + h v,
//! if what the arms add to the velocity of P, ω_B × r_B and ω_A × r_A, counts half less for both. So u goes
//! from the one to the other with (h (ω_B − ω_A))², up to a bend of [`LONG_TURN`] in a substep.

use super::articulated::{Passing, Subtree};
use super::body::Solid;
use super::guard::Survey;
use super::tables::{
    Tables, arrival, axis_field, global, hinge, inbound, joint_field, joint_link, mass, motion,
    row_link,
};
use crate::locks::turns;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::{Inertia, Spatial};
use numbers::{Cell, Machine, Mat3, Pose, Quat, Real, SymMat3, Vec3};

/// Three unit axes whose triple product is below this are in gimbal lock.
const FLAT: f64 = 1e-3;
/// Bend of a joint in a substep that is more than that can follow [rad].
const LONG_TURN: f64 = 0.25;

/// A joint on the way inwards: its rows in the tables, and the frames of both bodies.
struct Joint<M: Machine> {
    row: M::I,
    parent: M::I,
    joint: M::I,
    /// First motion, and number of motions along axes.
    first: M::I,
    linear: M::I,
    turns: M::I,
    qa: Quat<M::R>,
    qb: Quat<M::R>,
    a: Mat3<M::R>,
    b: Mat3<M::R>,
    /// From the centre of the child to the anchor.
    arm: Vec3<M::R>,
    /// From the parent's own anchor to this joint's on it.
    step: Vec3<M::R>,
}

impl<M: Machine> Joint<M> {
    #[inline(always)]
    fn load(k: &M, t: &Tables, row: M::I, qb: Quat<M::R>, b: Mat3<M::R>, arm: Vec3<M::R>) -> Self {
        let parent = k.link(t.row_links, row, row_link::PARENT);
        let joint = k.link(t.row_links, row, row_link::JOINT);
        let qa = k.quat(t.pose, parent, 3);
        let a = qa.to_mat3();
        Self {
            row,
            parent,
            joint,
            first: k.link(t.row_links, row, row_link::MOTION),
            linear: k.link(t.row_links, row, row_link::LINEAR),
            turns: k.link(t.joint_links, joint, joint_link::TURNS),
            qa,
            qb,
            a,
            b,
            arm,
            step: a * k.vec3(t.joint, joint, joint_field::STEP),
        }
    }
    /// From the anchor on the parent to the one on the child.
    #[inline(always)]
    fn gap(&self, k: &M, t: &Tables) -> Vec3<M::R> {
        let from = k.vec3(t.pose, self.parent, 0) + k.vec3(t.arm, self.parent, 0);
        (k.vec3(t.pose, self.row, 0) + self.arm) - (from + self.step)
    }
    /// The first axis, which the parent carries, and the last of one or two, which the child does.
    #[inline(always)]
    fn axes(&self, k: &M, t: &Tables) -> (Vec3<M::R>, Vec3<M::R>) {
        let a = self.a * k.vec3(t.joint, self.joint, joint_field::AXIS_A);
        let b = self.b * k.vec3(t.joint, self.joint, joint_field::AXIS_B);
        (a, b)
    }
}

/// One pass: the displacements of all bodies about their anchors into `way`.
#[inline(always)]
pub(crate) fn tree<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let nothing = Inertia::from_array([M::R::zero(); 21]);
    k.store_inertia(t.carried, k.index(0), 0, nothing);
    k.store_spatial(t.carried, k.index(0), 21, Spatial::zero());
    for i in k.range_down(k.index(t.rows - 1)) {
        inwards(k, t, i.offset(1), h);
    }
    k.store_spatial(t.way, k.index(0), 0, Spatial::zero());
    for row in k.range(k.index(1), k.index(t.rows)) {
        outwards(k, t, row, h);
    }
}

#[inline(always)]
fn inwards<M: Machine>(k: &mut M, t: &Tables, row: M::I, h: M::R) {
    let kind = k.link(t.row_links, row, row_link::INBOUND);
    if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ALONE))) {
        let q = k.quat(t.pose, row, 3);
        let b = q.to_mat3();
        let [m, x, y, z] = k.read(t.mass, row, mass::MASS);
        let i = SymMat3::rotated_diagonal(b, Vec3::new(x, y, z));
        let arm = k.vec3(t.arm, row, 0);
        let carried = Subtree::load(k, t, k.link(t.row_links, row, row_link::CARRIED));
        let subtree = Subtree::rigid(m, -arm, i) + carried;
        if let Some(_branch) = k.when(k.equals(kind, inbound::ROOT)) {
            k.store_spatial(t.way, row, 0, subtree.loose());
        }
        if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ROOT))) {
            let x = Joint::load(k, t, row, q, b, arm);
            // In the general way where any lane asks for it; then the others have had theirs, too.
            let plain = plain(k, t, row, kind);
            let mut left = k.cell(M::R::one());
            if let Some(_branch) = k.if_any(plain.lt(M::R::lit(0.5))) {
                in_general(k, t, &x, subtree, h);
                left.write(M::R::zero());
            }
            if let Some(_branch) = k.if_any(left.read().gt(M::R::zero())) {
                hinge(k, t, &x, subtree);
            }
        }
    }
}

/// 1 for a hinge that holds in full, else 0.
#[inline(always)]
fn plain<M: Machine>(k: &M, t: &Tables, row: M::I, kind: M::I) -> M::R {
    let mut plain = k.cell(M::R::zero());
    if let Some(_branch) = k.when(k.equals(kind, inbound::HINGE)) {
        let j = k.link(t.row_links, row, row_link::JOINT);
        plain.write(k.load(t.joint, j, joint_field::PLAIN));
    }
    plain.read()
}

/// Takes a subtree through a hinge, and hands it to the parent.
#[inline(always)]
fn hinge<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, subtree: Subtree<M::R>) {
    let gap = x.gap(k, t);
    let (a, b) = x.axes(k, t);
    let e = store_error(k, t, x, Spatial::new(a.cross(b), gap), gap);
    k.store_vec3(t.motion, x.first, motion::DIRECTION, a);
    let subtree = subtree.corrected(e);
    let column = subtree.turning(a);
    let subtree = subtree.released(k, t, x.first, column);
    pass_on(k, t, x, subtree, x.step + gap);
}

/// As [`hinge`], for any joint.
#[inline(always)]
fn in_general<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, subtree: Subtree<M::R>, h: M::R) {
    let j = x.joint;
    let parted = k.load(t.joint, j, joint_field::ENABLED).lt(M::R::lit(0.5));
    if let Some(_branch) = k.if_any(parted) {
        k.store_spatial(t.way, x.row, 0, subtree.loose());
    }
    let gap = x.gap(k, t);
    let e = Spatial::new(turn_error(k, t, x), shift_error(k, t, x, gap));
    let e = store_error(k, t, x, e, gap);
    let mut passing = Passing::hold(k, subtree.corrected(e));
    soften(k, t, x, &mut passing, h);
    release(k, t, x, &mut passing);
    if let Some(_branch) = k.if_any(parted) {
        let subtree = passing.get().unless(parted);
        passing.set(subtree);
    }
    pass_on(k, t, x, passing.get(), x.step + gap);
}

/// Keeps a joint's error, as far as a pass corrects it, and where the joint is.
#[inline(always)]
fn store_error<M: Machine>(
    k: &mut M,
    t: &Tables,
    x: &Joint<M>,
    e: Spatial<M::R>,
    gap: Vec3<M::R>,
) -> Spatial<M::R> {
    let mut share = k.load(t.global, k.index(0), global::RELAXATION);
    if t.capped_at_all {
        share *= k.load(t.share, x.row, 0);
    }
    let e = e * share;
    k.store_vec3(t.hinge, x.row, hinge::STEP, x.step + gap);
    k.store_spatial(t.hinge, x.row, hinge::ERROR, e);
    e
}

/// Adds to what the parent carries; the first child to arrive starts it, the world keeps nothing.
#[inline(always)]
fn pass_on<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, subtree: Subtree<M::R>, s: Vec3<M::R>) {
    let kind = k.link(t.row_links, x.row, row_link::ARRIVAL);
    let slot = k.link(t.row_links, x.parent, row_link::CARRIED);
    if let Some(_branch) = k.when(k.equals(kind, arrival::FIRST)) {
        subtree.about(s).store(k, t, slot);
    }
    if let Some(_branch) = k.when(k.equals(kind, arrival::LATER)) {
        let sum = Subtree::load(k, t, slot) + subtree.about(s);
        sum.store(k, t, slot);
    }
}

/// Error of the locked rotations, across the free ones. Also says what those are about.
#[inline(always)]
fn turn_error<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>) -> Vec3<M::R> {
    let (j, first) = (x.joint, x.first.plus(x.linear));
    let mut error = Vec3::zero().hold(k);
    if let Some(_branch) = k.when(k.equals(x.turns, turns::ONE)) {
        let (a, b) = x.axes(k, t);
        k.store_vec3(t.motion, first, motion::DIRECTION, a);
        error.set(a.cross(b));
    }
    if let Some(_branch) = k.when(k.equals(x.turns, turns::LOCKED)) {
        let qa = x.qa * k.quat(t.joint, j, joint_field::FRAME_A);
        let qb = x.qb * k.quat(t.joint, j, joint_field::FRAME_B);
        error.set(qa.rotate((qa.conjugate() * qb).log()));
    }
    // The angle between the two axes stays: it changes by n̂ · ω, n = a × b.
    if let Some(_branch) = k.when(k.equals(x.turns, turns::TWO)) {
        let (a, b) = x.axes(k, t);
        k.store_vec3(t.motion, first, motion::DIRECTION, a);
        k.store_vec3(t.motion, first.offset(1), motion::DIRECTION, b);
        let (n, c) = (
            a.cross(b),
            k.load(t.joint, j, joint_field::SECOND) - a.dot(b),
        );
        error.set(n * (c / n.length_squared().max(M::R::lit(1e-12))));
    }
    if let Some(_branch) = k.when(k.equals(x.turns, turns::THREE)) {
        three_axes(k, t, first);
    }
    if let Some(_branch) = k.when(k.equals(x.turns, turns::FREE)) {
        let (o, i) = (M::R::zero(), M::R::one());
        k.write(t.motion, first, motion::DIRECTION, [i, o, o]);
        k.write(t.motion, first.offset(1), motion::DIRECTION, [o, i, o]);
        k.write(t.motion, first.offset(2), motion::DIRECTION, [o, o, i]);
    }
    error.get()
}

/// Three axes as they were measured. In gimbal lock the third does not exist: in its place a
/// rotation across the first two, on which nothing acts.
#[inline(always)]
fn three_axes<M: Machine>(k: &mut M, t: &Tables, first: M::I) {
    let a = k.vec3(t.axis, first, axis_field::DIRECTION);
    let b = k.vec3(t.axis, first.offset(1), axis_field::DIRECTION);
    let c = k.vec3(t.axis, first.offset(2), axis_field::DIRECTION);
    let across = a.cross(b);
    let flat = across.dot(c).abs().lt(M::R::lit(FLAT));
    let third = Vec3::select(flat, across.normalized_or(c), c);
    for (i, axis) in [a, b, third].into_iter().enumerate() {
        k.store_vec3(t.motion, first.offset(i), motion::DIRECTION, axis);
    }
    let zero = M::R::zero();
    k.store_where(flat, t.motion, first.offset(2), motion::PUSH, zero);
    k.store_where(flat, t.motion, first.offset(2), motion::GIVE, zero);
}

/// Error of the locked shifts: what parts the anchors, but for the free directions.
#[inline(always)]
fn shift_error<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, gap: Vec3<M::R>) -> Vec3<M::R> {
    let mut error = gap.hold(k);
    if let Some(_branch) = k.when(k.less(k.index(0), x.linear)) {
        let frame = x.qa * k.quat(t.joint, x.joint, joint_field::LINEAR_FRAME);
        let frame = frame.to_mat3();
        let locked = k.vec3(t.joint, x.joint, joint_field::LOCKED);
        error.set(frame * frame.transpose_mul(gap).times(locked));
        for i in k.range(k.index(0), x.linear) {
            let row = x.first.plus(i);
            let direction = frame * k.vec3(t.direction, row, 0);
            k.store_vec3(t.motion, row, motion::DIRECTION, direction);
        }
    }
    error.get()
}

/// Lets compliant rows give way, where there are any.
#[inline(always)]
fn soften<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, passing: &mut Passing<M>, h: M::R) {
    let (shifts, turns) = compliance(k, t, x.joint, h);
    if let Some(_branch) = k.if_any(shifts.max(turns).gt(M::R::zero())) {
        let frame = x.qa * k.quat(t.joint, x.joint, joint_field::LINEAR_FRAME);
        let first = k.link(t.row_links, x.row, row_link::SOFT);
        let count = k.link(t.row_links, x.row, row_link::SOFT_SHIFTS);
        soft_rows(k, t, frame.to_mat3(), first, count);
        for row in k.range(first, first.plus(count)) {
            let subtree = passing.get();
            let column = subtree.sliding(k.vec3(t.motion, row, motion::DIRECTION));
            let pushed = pushed(k, t, row);
            passing.set(subtree.yielding(k, t, row, column, pushed, shifts));
        }
        let (first, count) = (
            first.plus(count),
            k.link(t.row_links, x.row, row_link::SOFT_TURNS),
        );
        let frame = soft_frame(k, t, x);
        soft_rows(k, t, frame, first, count);
        for row in k.range(first, first.plus(count)) {
            let subtree = passing.get();
            let column = subtree.turning(k.vec3(t.motion, row, motion::DIRECTION));
            let pushed = pushed(k, t, row);
            passing.set(subtree.yielding(k, t, row, column, pushed, turns));
        }
    }
}

/// What is left of the push of the passes before.
#[inline(always)]
fn pushed<M: Machine>(k: &M, t: &Tables, m: M::I) -> M::R {
    if t.iterations > 1 {
        let share = k.load(t.global, k.index(0), global::RELAXATION);
        share * k.load(t.motion, m, motion::PUSH)
    } else {
        M::R::zero()
    }
}

/// α/h² of a joint's shifts and turns.
#[inline(always)]
fn compliance<M: Machine>(k: &M, t: &Tables, j: M::I, h: M::R) -> (M::R, M::R) {
    let [shifts, turns] = k.read(t.joint, j, joint_field::COMPLIANCE);
    (shifts / h.squared(), turns / h.squared())
}

/// Angular frame, whose last directions are locked.
#[inline(always)]
fn soft_frame<M: Machine>(k: &M, t: &Tables, x: &Joint<M>) -> Mat3<M::R> {
    let frame = x.qa * k.quat(t.joint, x.joint, joint_field::FRAME_A);
    let mut frame = frame.to_mat3().hold(k);
    if let Some(_branch) = k.when(k.equals(x.turns, turns::TWO)) {
        let first = x.first.plus(x.linear);
        let a = k.vec3(t.motion, first, motion::DIRECTION);
        let b = k.vec3(t.motion, first.offset(1), motion::DIRECTION);
        let n = a.cross(b).normalized_or(frame.z.get());
        frame.z.set(n);
    }
    frame.get()
}

/// The last `count` columns of a frame, from the last on, as the directions of motions.
#[inline(always)]
fn soft_rows<M: Machine>(k: &mut M, t: &Tables, frame: Mat3<M::R>, first: M::I, count: M::I) {
    for (i, column) in [frame.z, frame.y, frame.x].into_iter().enumerate() {
        if let Some(_branch) = k.when(k.less(k.index(i), count)) {
            k.store_vec3(t.motion, first.offset(i), motion::DIRECTION, column);
        }
    }
}

/// Lets the free motions go, the last one first.
#[inline(always)]
fn release<M: Machine>(k: &mut M, t: &Tables, x: &Joint<M>, passing: &mut Passing<M>) {
    let first = x.first.plus(x.linear);
    for i in k.range_down(k.link(t.row_links, x.row, row_link::ANGULAR)) {
        let row = first.plus(i);
        let subtree = passing.get();
        let column = subtree.turning(k.vec3(t.motion, row, motion::DIRECTION));
        passing.set(subtree.released(k, t, row, column));
    }
    for i in k.range_down(x.linear) {
        let row = x.first.plus(i);
        let subtree = passing.get();
        let column = subtree.sliding(k.vec3(t.motion, row, motion::DIRECTION));
        passing.set(subtree.released(k, t, row, column));
    }
}

#[inline(always)]
fn outwards<M: Machine>(k: &mut M, t: &Tables, row: M::I, h: M::R) {
    let kind = k.link(t.row_links, row, row_link::INBOUND);
    if let Some(_branch) = k.when(k.equals(kind, inbound::ALONE)) {
        k.store_spatial(t.way, row, 0, Spatial::zero());
    }
    if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ROOT))) {
        let parent = k.link(t.row_links, row, row_link::PARENT);
        let of_parent = k.spatial(t.way, parent, 0);
        let step = k.vec3(t.hinge, row, hinge::STEP);
        let shift = of_parent.linear + of_parent.angular.cross(step);
        let mut way = Spatial::new(of_parent.angular, shift).hold(k);
        let first = k.link(t.row_links, row, row_link::MOTION);
        let count = k.link(t.row_links, row, row_link::LINEAR);
        for m in k.range(first, first.plus(count)) {
            slide(k, t, m, &mut way);
        }
        let first = first.plus(count);
        let count = k.link(t.row_links, row, row_link::ANGULAR);
        for m in k.range(first, first.plus(count)) {
            turn(k, t, m, &mut way);
        }
        let j = k.link(t.row_links, row, row_link::JOINT);
        let plain = k.load(t.joint, j, joint_field::PLAIN);
        if let Some(_branch) = k.if_any(plain.lt(M::R::lit(0.5))) {
            yielding(k, t, row, j, &mut way, h);
        }
        way.set(way.get() - k.spatial(t.hinge, row, hinge::ERROR));
        if let Some(_branch) = k.if_any(plain.lt(M::R::lit(0.5))) {
            let parted = k.load(t.joint, j, joint_field::ENABLED).lt(M::R::lit(0.5));
            let (held, loose) = (way.get(), k.spatial(t.way, row, 0));
            let angular = Vec3::select(parted, loose.angular, held.angular);
            let linear = Vec3::select(parted, loose.linear, held.linear);
            way.set(Spatial::new(angular, linear));
        }
        k.store_spatial(t.way, row, 0, way.get());
    }
}

/// Gives way in compliant rows.
#[inline(always)]
fn yielding<M: Machine>(
    k: &mut M,
    t: &Tables,
    row: M::I,
    j: M::I,
    way: &mut Spatial<M::Cell>,
    h: M::R,
) {
    let (shifts, turns) = compliance(k, t, j, h);
    if let Some(_branch) = k.if_any(shifts.max(turns).gt(M::R::zero())) {
        let first = k.link(t.row_links, row, row_link::SOFT);
        let count = k.link(t.row_links, row, row_link::SOFT_SHIFTS);
        for i in k.range_down(k.link(t.row_links, row, row_link::SOFT_TURNS)) {
            let m = first.plus(count).plus(i);
            turn(k, t, m, way);
            keep(k, t, m, turns);
        }
        for i in k.range_down(count) {
            let m = first.plus(i);
            slide(k, t, m, way);
            keep(k, t, m, shifts);
        }
    }
}

/// What a compliant row has pushed so far, for the next pass: Δλ = −q h²/α − λ.
#[inline(always)]
fn keep<M: Machine>(k: &mut M, t: &Tables, m: M::I, soft: M::R) {
    if t.iterations > 1 {
        let share = k.load(t.global, k.index(0), global::RELAXATION);
        let pushed = k.load(t.motion, m, motion::PUSH);
        let q = k.load(t.motion, m, motion::WAY);
        let push = -(q / soft.max(M::R::lit(1e-30))) - share * pushed;
        k.store(t.motion, m, motion::PUSH, pushed + push);
    }
}

/// Moves along a motion, as far as its laws and the subtree let it.
#[inline(always)]
fn slide<M: Machine>(k: &mut M, t: &Tables, m: M::I, way: &mut Spatial<M::Cell>) {
    let (s, q) = along(k, t, m, way.get());
    way.linear.set(s.fma(q, way.linear.get()));
}

/// As [`slide`], about an axis.
#[inline(always)]
fn turn<M: Machine>(k: &mut M, t: &Tables, m: M::I, way: &mut Spatial<M::Cell>) {
    let (s, q) = along(k, t, m, way.get());
    way.angular.set(s.fma(q, way.angular.get()));
}

/// Direction of a motion, and the way along it.
#[inline(always)]
fn along<M: Machine>(k: &mut M, t: &Tables, m: M::I, way: Spatial<M::R>) -> (Vec3<M::R>, M::R) {
    let u = k.spatial(t.motion, m, motion::U);
    let [inverse, free] = k.read(t.motion, m, motion::INVERSE);
    let q = u.dot(way).fnma(inverse, free);
    k.store(t.motion, m, motion::WAY, q);
    (k.vec3(t.motion, m, motion::DIRECTION), q)
}

/// Moves all bodies by what the pass has found, and their velocities by as much over h, from the
/// leaves to the roots.
#[inline(always)]
pub(crate) fn commit<M: Machine>(k: &mut M, t: &Tables, h: M::R, survey: &mut Survey<M>) {
    for i in k.range_down(k.index(t.rows - 1)) {
        let row = i.offset(1);
        let kind = k.link(t.row_links, row, row_link::INBOUND);
        if let Some(_branch) = k.when(k.less(kind, k.index(inbound::ALONE))) {
            carry(k, t, row, h, survey);
        }
        if let Some(_branch) = k.when(k.equals(kind, inbound::ALONE)) {
            survey.note(k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        }
    }
}

/// Moves a body of a tree. What it carries must have had its turn.
#[inline(always)]
fn carry<M: Machine>(k: &mut M, t: &Tables, row: M::I, h: M::R, survey: &mut Survey<M>) {
    let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
    let moved = about_centre(k, t, row);
    let solid = Solid::load(k, t, row);
    let couple = couple(k, t, row, h, twist, moved.linear * solid.mass);
    let spin = moved.angular.fma(h.recip(), twist.angular);
    let (q, spin) = solid.turned(pose.q, spin, moved.angular, couple);
    let linear = moved.linear.fma(h.recip(), twist.linear);
    let (pose, twist) = (
        Pose::new(pose.p + moved.linear, q),
        Spatial::new(spin, linear),
    );
    k.store_pose(t.pose, row, 0, pose);
    k.store_spatial(t.twist, row, 0, twist);
    survey.note(pose, twist);
    let before = if t.sums_moves() {
        k.spatial(t.moved, row, 0)
    } else {
        Spatial::zero()
    };
    k.store_spatial(t.moved, row, 0, before + moved);
}

/// What the joints of a body add to its angular momentum so that all is kept: see the module.
/// Passes the force through the joint that carries it, and its couple, on to the parent.
#[inline(always)]
fn couple<M: Machine>(
    k: &mut M,
    t: &Tables,
    row: M::I,
    h: M::R,
    twist: Spatial<M::R>,
    own: Vec3<M::R>,
) -> Vec3<M::R> {
    let parent = k.link(t.row_links, row, row_link::PARENT);
    let of_parent = k.spatial(t.twist, parent, 0);
    let carried = k.spatial(t.carried, k.link(t.row_links, row, row_link::CARRIED), 0);
    let force = carried.linear + own;
    let arm = k.vec3(t.arm, row, 0);
    let arm_of_parent = k.vec3(t.pose, row, 0) + arm - k.vec3(t.pose, parent, 0);
    let about = twist.angular.cross(arm);
    let about_parent = of_parent.angular.cross(arm_of_parent);
    let apart = twist.linear - of_parent.linear;
    let bend = (twist.angular - of_parent.angular) * (h * M::R::lit(1.0 / LONG_TURN));
    let share = bend.length_squared().min(M::R::one()) * M::R::lit(-0.5);
    // u − v_B.
    let ahead = (about + about_parent).fma(share, about);
    let passed = Spatial::new((apart + ahead).cross(force), force);
    let kind = k.link(t.row_links, row, row_link::ARRIVAL);
    let slot = k.link(t.row_links, parent, row_link::CARRIED);
    if let Some(_branch) = k.when(k.equals(kind, arrival::FIRST)) {
        k.store_spatial(t.carried, slot, 0, passed);
    }
    if let Some(_branch) = k.when(k.equals(kind, arrival::LATER)) {
        let sum = k.spatial(t.carried, slot, 0) + passed;
        k.store_spatial(t.carried, slot, 0, sum);
    }
    carried.angular - ahead.cross(force)
}

/// How far a body moves in the present pass, about its centre.
#[inline(always)]
pub(crate) fn about_centre<M: Machine>(k: &M, t: &Tables, row: M::I) -> Spatial<M::R> {
    let (way, arm) = (k.spatial(t.way, row, 0), k.vec3(t.arm, row, 0));
    Spatial::new(way.angular, way.linear + arm.cross(way.angular))
}
