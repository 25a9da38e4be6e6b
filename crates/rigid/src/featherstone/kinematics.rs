//! Placements, velocities and inertias of the nodes, from the coordinates.
//!
//! All spatial vectors are in world axes about O, a point of the world near the
//! tree's root, so that no transform is needed between bodies, and a robot far
//! from the world's origin keeps its precision. A motion about the axis a
//! through x has S = (a, x × a); along a it has S = (0, a). Motions act in turn:
//!
//! ```text
//! b ← b + v × S q̇ + S q̈⁻      acceleration where every q̈ is q̈⁻ (Featherstone 2008, eq. 3.41, with q̈⁻ = 0)
//! v ← v + S q̇
//! ```
//!
//! b starts at −g in the world, which stands for gravity.

use super::tables::{Tables, dof, frame, motion, node, node_link};
use numbers::machine::space::Parameter;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Machine, Pose, Quat, Real, SymMat3, Table, Vec3, functions};

/// How a node moves: what the first fields of its row tell, read and written at once.
pub(crate) struct Course<R> {
    /// Position from O, orientation.
    pub place: Pose<R>,
    /// Spatial velocity about O.
    pub twist: Spatial<R>,
    /// Spatial acceleration about O where every q̈ is q̈⁻, less gravity.
    pub bias: Spatial<R>,
}

impl<R: Real> Course<R> {
    #[inline(always)]
    pub(crate) fn read<M: Machine<R = R>>(k: &M, t: &Tables, n: M::I) -> Self {
        Self {
            place: k.pose(t.frame, n, frame::PLACE),
            twist: k.spatial(t.frame, n, frame::TWIST),
            bias: k.spatial(t.frame, n, frame::BIAS),
        }
    }
    #[inline(always)]
    fn write<M: Machine<R = R>>(self, k: &mut M, t: &Tables, n: M::I) {
        k.store_pose(t.frame, n, frame::PLACE, self.place);
        k.store_spatial(t.frame, n, frame::TWIST, self.twist);
        k.store_spatial(t.frame, n, frame::BIAS, self.bias);
    }
}

/// Origins O of the trees, and the world as each tree sees it.
#[inline(always)]
pub(crate) fn origins<M: Machine>(k: &mut M, t: &Tables) {
    let up = Spatial::new(Vec3::zero(), -k.vec3(t.world, k.index(0), 0));
    for tree in k.count(t.trees) {
        let mut point = k.vec3(t.tree, tree, 0).hold(k);
        for i in k.range(k.link(t.tree_links, tree, 0), k.link(t.tree_links, tree, 1)) {
            let q = k.load(t.position, k.link(t.origin_links, i, 0), 0);
            let moved = k.vec3(t.origin, i, 0).fma(q, point.get());
            point.set(moved);
        }
        let point = point.get();
        k.store_vec3(t.point, tree, 0, point);
        k.store_pose(
            t.frame,
            tree,
            frame::PLACE,
            Pose::new(-point, Quat::identity()),
        );
        k.store_spatial(t.frame, tree, frame::TWIST, Spatial::zero());
        k.store_spatial(t.frame, tree, frame::BIAS, up);
    }
}

/// Sine and cosine of half the angle of each revolute motion, up to a common sign.
///
/// A pass of its own: no motion waits for another here, as they do along the tree.
#[inline(always)]
fn half_angles<M: Machine>(k: &mut M, t: &Tables) {
    for i in k.count(t.hinges) {
        let [m, q] = k.link_row(t.hinge_links, i);
        let angle = k.load(t.position, q, 0) - k.load(t.motion, m, 3);
        let (sin, cos) = functions::half_sin_cos(angle);
        k.write(t.half_angle, m, 0, [sin, cos]);
    }
}

/// Fills `place`, `twist`, `bias` and the axes of all nodes.
#[inline(always)]
pub(crate) fn kinematics<M: Machine>(k: &mut M, t: &Tables) {
    origins(k, t);
    half_angles(k, t);
    let mut place = Pose::identity().hold(k);
    let mut twist = Spatial::zero().hold(k);
    let mut bias = Spatial::zero().hold(k);
    for i in k.count(t.nodes) {
        let n = visited(k, t, i);
        let [parent, begin, end, turned] =
            k.link_row::<_, { node_link::OUTWARDS }>(t.node_links, n);
        if let Some(_branch) = begins(k, t, n) {
            let from = Course::read(k, t, parent);
            place.set(from.place);
            twist.set(from.twist);
            bias.set(from.bias);
        }
        let begun = start(k, t, n, place.get(), turned);
        place.set(begun);
        for m in k.range(begin, end) {
            let [kind, q, v] = k.link_row(t.motion_links, m);
            if let Some(_branch) = k.when(k.equals(kind, motion::REVOLUTE)) {
                let (moved, axis) = revolute(k, t, m, place.get());
                place.set(moved);
                let rate = turn(k, t, v, axis);
                advance(&mut twist, &mut bias, rate);
                go_on(k, t, v, &mut bias);
            }
            if let Some(_branch) = k.when(k.equals(kind, motion::PRISMATIC)) {
                let (moved, axis) = prismatic(k, t, m, q, place.get());
                place.set(moved);
                let rate = turn(k, t, v, axis);
                advance(&mut twist, &mut bias, rate);
                go_on(k, t, v, &mut bias);
            }
            if let Some(_branch) = k.when(k.equals(kind, motion::BALL)) {
                let at = place.get();
                let moved = Pose::new(at.p, (at.q * k.quat(t.position, q, 0)).nearly_normalized());
                place.set(moved);
                let rate = ball(k, t, v, moved);
                advance(&mut twist, &mut bias, rate);
                for axis in 0..3 {
                    go_on(k, t, v.offset(axis), &mut bias);
                }
            }
        }
        let course = Course {
            place: place.get(),
            twist: twist.get(),
            bias: bias.get(),
        };
        course.write(k, t, n);
    }
}

/// The node that passes visit in a round: in the order of their rows, in which neighbours do not wait for each other,
/// or, where [values are handed on](Machine::HANDS_ON), along the limbs. The order changes no number.
#[inline(always)]
pub(super) fn visited<M: Machine>(k: &M, t: &Tables, round: M::I) -> M::I {
    if M::HANDS_ON {
        k.link(t.limb_links, round, 0)
    } else {
        round.offset(t.trees)
    }
}

/// A branch where what the parent has is to be read: where it is not at hand, as it was not visited just before.
#[inline(always)]
pub(super) fn begins<M: Machine>(k: &M, t: &Tables, n: M::I) -> Option<Option<M::Branch>> {
    if M::HANDS_ON {
        let follows = k.link(t.node_links, n, node_link::FOLLOWS);
        k.when(k.equals(follows, 0)).map(Some)
    } else {
        Some(None)
    }
}

/// Where the node's frame is before its motions: at its reference in the parent's frame.
#[inline(always)]
fn start<M: Machine>(k: &M, t: &Tables, n: M::I, parent: Pose<M::R>, turned: M::I) -> Pose<M::R> {
    let p = parent.point(k.vec3(t.node, n, node::PLACE));
    let mut q = parent.q.hold(k);
    if let Some(_branch) = k.when(k.equals(turned, 1)) {
        q.set(parent.q * k.quat(t.node, n, node::PLACE + 3));
    }
    Pose::new(p, q.get())
}

/// Turns a placement about a motion's axis; returns the axis S.
#[inline(always)]
fn revolute<M: Machine>(k: &M, t: &Tables, m: M::I, at: Pose<M::R>) -> (Pose<M::R>, Spatial<M::R>) {
    let axis = k.vec3(t.motion, m, 0);
    let [sin, cos] = k.read(t.half_angle, m, 0);
    let turned = Pose::new(at.p, at.q * Quat::from_parts(axis * sin, cos));
    let a = at.q.rotate(axis);
    (turned, Spatial::new(a, at.p.cross(a)))
}

/// Shifts a placement along a motion's axis; returns the axis S.
#[inline(always)]
fn prismatic<M: Machine>(
    k: &M,
    t: &Tables,
    m: M::I,
    q: M::I,
    at: Pose<M::R>,
) -> (Pose<M::R>, Spatial<M::R>) {
    let way = k.load(t.position, q, 0) - k.load(t.motion, m, 3);
    let a = at.q.rotate(k.vec3(t.motion, m, 0));
    (
        Pose::new(a.fma(way, at.p), at.q),
        Spatial::new(Vec3::zero(), a),
    )
}

/// Stores an axis; returns its share S q̇ of the velocity.
#[inline(always)]
fn turn<M: Machine>(k: &mut M, t: &Tables, v: M::I, axis: Spatial<M::R>) -> Spatial<M::R> {
    k.store_spatial(t.dof, v, dof::AXIS, axis);
    axis * k.load(t.velocity, v, 0)
}

/// Stores the three axes of a ball, which turn with the child; returns their share of the velocity.
#[inline(always)]
fn ball<M: Machine>(k: &mut M, t: &Tables, v: M::I, at: Pose<M::R>) -> Spatial<M::R> {
    let r = at.q.to_mat3();
    k.store_spatial(t.dof, v, dof::AXIS, Spatial::new(r.x, at.p.cross(r.x)));
    k.store_spatial(
        t.dof,
        v.offset(1),
        dof::AXIS,
        Spatial::new(r.y, at.p.cross(r.y)),
    );
    k.store_spatial(
        t.dof,
        v.offset(2),
        dof::AXIS,
        Spatial::new(r.z, at.p.cross(r.z)),
    );
    let w = r * k.vec3(t.velocity, v, 0);
    Spatial::new(w, at.p.cross(w))
}

/// b ← b + v × s, v ← v + s.
#[inline(always)]
fn advance<R: Real, H: Held<Value = Spatial<R>>>(twist: &mut H, bias: &mut H, s: Spatial<R>) {
    let v = twist.get();
    let moved = v.cross_motion_plus(s, bias.get());
    bias.set(moved);
    twist.set(v + s);
}

/// b ← b + S q̈⁻, of an axis that is [stored](turn).
#[inline(always)]
fn go_on<M: Machine>(k: &M, t: &Tables, v: M::I, bias: &mut <Spatial<M::R> as Hold<M>>::Held) {
    if t.recents > 0 {
        let axis = k.spatial(t.dof, v, dof::AXIS);
        let moved = axis.fma(k.load(t.recent, v, 0), bias.get());
        bias.set(moved);
    }
}

/// Mass, centre from O and inertia about the centre in world axes, from the ten fields from MASS on.
#[inline(always)]
pub(crate) fn world_inertia<M: Machine, const W: usize>(
    k: &M,
    table: Table<Parameter, W>,
    row: M::I,
    at: Pose<M::R>,
) -> (M::R, Vec3<M::R>, SymMat3<M::R>) {
    let r = at.q.to_mat3();
    let [m, cx, cy, cz, xx, yy, zz, xy, xz, yz] = k.read(table, row, node::MASS);
    let c = r.mul_plus(Vec3::new(cx, cy, cz), at.p);
    (
        m,
        c,
        SymMat3::from_array([xx, yy, zz, xy, xz, yz]).rotated(r),
    )
}

/// Momentum I v of a rigid body: (I_c ω + c × f, f) with f = m (v + ω × c).
#[inline(always)]
pub(crate) fn momentum<R: Real>(m: R, c: Vec3<R>, i: SymMat3<R>, v: Spatial<R>) -> Spatial<R> {
    let f = v.angular.cross_plus(c, v.linear) * m;
    Spatial::new(i.mul_plus(v.angular, c.cross(f)), f)
}

/// Wrench that moves a rigid body with velocity v and acceleration a, I a + v ×* I v, by Newton's
/// and Euler's laws at its centre, where they have the fewest terms:
///
/// ```text
/// F = m (a_O + α × c + ω × (v_O + ω × c))      N = I_c α + ω × I_c ω      (N + c × F, F)
/// ```
#[inline(always)]
pub(crate) fn newton_euler<R: Real>(
    m: R,
    c: Vec3<R>,
    i: SymMat3<R>,
    v: Spatial<R>,
    a: Spatial<R>,
) -> Spatial<R> {
    let (w, alpha) = (v.angular, a.angular);
    let speed = w.cross_plus(c, v.linear);
    let f = w.cross_plus(speed, alpha.cross_plus(c, a.linear)) * m;
    let n = i.mul_plus(alpha, w.cross(i * w));
    Spatial::new(c.cross_plus(f, n), f)
}
