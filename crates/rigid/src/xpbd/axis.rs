//! Joint coordinates, measured from the bodies.
//!
//! A joint's linear coordinates s and angular coordinates θ are those at which the
//! product of its motions gives the bodies' relative placement. From the values of
//! the last substep, one Gauss–Newton step finds them:
//!
//! ```text
//! e = log(R_rel R(θ)ᵀ)      θ ← θ + (JᵀJ)⁻¹ Jᵀ e      J = [a₁ a₂ a₃]
//! ```
//!
//! with the axes aₖ as the motions before them turn them. For one axis this is
//! exact; it counts turns, and needs no case for each sequence of axes. The rows
//! of (JᵀJ)⁻¹ Jᵀ are the gradients of the coordinates, along which a generalised
//! force pulls. In gimbal lock JᵀJ is damped.

use super::joint::Ends;
use super::tables::{Tables, axis_field, axis_link, group_link, joint_field};
use numbers::functions::wrap;
use numbers::machine::{Held, Hold, Index};
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Quat, Real, SymMat3, Vec3};

/// Least determinant of JᵀJ; unit axes at right angles have 1, gimbal lock 0.
const LEAST: f64 = 1e-6;

/// The gradients J (JᵀJ)⁻¹ of three axes; a null axis has a null gradient.
///
/// Away from gimbal lock nothing is damped, so that coordinates are right to rounding.
#[inline(always)]
fn gradients<R: Real>(a: [Vec3<R>; 3]) -> [Vec3<R>; 3] {
    let (o, i, least) = (R::zero(), R::one(), R::lit(LEAST));
    let (x, y, z) = (a[1].dot(a[2]), a[0].dot(a[2]), a[0].dot(a[1]));
    let squares = x.fma(x, y.fma(y, z.squared()));
    let determinant = (x * y * z).fma(R::lit(2.0), i - squares);
    let soft = (least - determinant).max(o);
    let gram = SymMat3::new(Vec3::splat(i + soft), Vec3::new(z, y, x));
    [
        along(a, gram.solve(Vec3::new(i, o, o), least)),
        along(a, gram.solve(Vec3::new(o, i, o), least)),
        along(a, gram.solve(Vec3::new(o, o, i), least)),
    ]
}

/// J c.
#[inline(always)]
fn along<R: Real>(a: [Vec3<R>; 3], c: Vec3<R>) -> Vec3<R> {
    a[0].fma(c.x, a[1].fma(c.y, a[2] * c.z))
}

/// Direction of the `i`-th of `count` axes whose rows start at `first`; null beyond the last.
#[inline(always)]
fn direction<M: Machine>(k: &M, t: &Tables, first: M::I, i: usize, count: M::I) -> Vec3<M::R> {
    let mut d = Vec3::zero().hold(k);
    if let Some(_branch) = k.when(k.less(k.index(i), count)) {
        d.set(k.vec3(t.direction, first.offset(i), 0));
    }
    d.get()
}

/// Rotation about the `i`-th axis by its last known angle; the identity beyond the last.
#[inline(always)]
fn turn<M: Machine>(
    k: &M,
    t: &Tables,
    first: M::I,
    i: usize,
    count: M::I,
    axis: Vec3<M::R>,
) -> Quat<M::R> {
    let mut q = Quat::identity().hold(k);
    if let Some(_branch) = k.when(k.less(k.index(i), count)) {
        q.set(Quat::from_axis_angle(
            axis,
            k.load(t.angle, first.offset(i), 0),
        ));
    }
    q.get()
}

/// Measures the axes of a group of one joint: their values, rates, and what they
/// pull along, all into `axis`.
#[inline(always)]
pub(crate) fn measure<M: Machine>(k: &mut M, t: &Tables, g: M::I) {
    let j = k.link(t.group_links, g, group_link::JOINT);
    let first = k.link(t.group_links, g, group_link::FIRST);
    let linear = k.link(t.group_links, g, group_link::LINEAR);
    let angular = k.link(t.group_links, g, group_link::ANGULAR);
    if let Some(_branch) = k.when(k.less(k.index(0), linear)) {
        measure_linear(k, t, j, first, linear);
    }
    if let Some(_branch) = k.when(k.less(k.index(0), angular)) {
        measure_angular(k, t, j, first.plus(linear), angular);
    }
}

#[inline(always)]
fn measure_linear<M: Machine>(k: &mut M, t: &Tables, j: M::I, first: M::I, count: M::I) {
    let ends = Ends::load(k, t, j);
    let (ra, rb, gap) = ends.arms(k, t, j);
    let ra = ra + gap;
    let frame = (ends.a.pose.q * k.quat(t.joint, j, joint_field::LINEAR_FRAME)).to_mat3();
    let d = frame.transpose_mul(gap);
    let axes = [
        direction(k, t, first, 0, count),
        direction(k, t, first, 1, count),
        direction(k, t, first, 2, count),
    ];
    let gradients = gradients(axes);
    for (i, &gradient) in gradients.iter().enumerate() {
        if let Some(_branch) = k.when(k.less(k.index(i), count)) {
            let row = first.offset(i);
            let n = frame * gradient;
            let pull = Pull {
                n,
                a: ra.cross(n),
                b: rb.cross(n),
            };
            finish(k, t, row, &ends, pull, gradient.dot(d));
        }
    }
}

#[inline(always)]
fn measure_angular<M: Machine>(k: &mut M, t: &Tables, j: M::I, first: M::I, count: M::I) {
    let ends = Ends::load(k, t, j);
    let (qa, qb) = ends.frames(k, t, j);
    let u = [
        direction(k, t, first, 0, count),
        direction(k, t, first, 1, count),
        direction(k, t, first, 2, count),
    ];
    let q1 = turn(k, t, first, 0, count, u[0]);
    let q2 = q1 * turn(k, t, first, 1, count, u[1]);
    let q3 = q2 * turn(k, t, first, 2, count, u[2]);
    let e = (qa.conjugate() * qb * q3.conjugate()).log();
    let axes = [u[0], q1.rotate(u[1]), q2.rotate(u[2])];
    let gradients = gradients(axes);
    for (i, &gradient) in gradients.iter().enumerate() {
        if let Some(_branch) = k.when(k.less(k.index(i), count)) {
            let row = first.offset(i);
            let angle = k.load(t.angle, row, 0) + gradient.dot(e);
            let a = qa.rotate(gradient);
            k.store_vec3(t.axis, row, axis_field::DIRECTION, qa.rotate(axes[i]));
            finish(
                k,
                t,
                row,
                &ends,
                Pull {
                    n: Vec3::zero(),
                    a,
                    b: a,
                },
                angle,
            );
        }
    }
}

/// Stores what an axis pulls along, its value and its rate.
#[inline(always)]
fn finish<M: Machine>(
    k: &mut M,
    t: &Tables,
    row: M::I,
    ends: &Ends<M::R, M::I>,
    pull: Pull<M::R>,
    value: M::R,
) {
    k.store_vec3(t.axis, row, axis_field::LINEAR, pull.n);
    k.store_vec3(t.axis, row, axis_field::ANGULAR_A, pull.a);
    k.store_vec3(t.axis, row, axis_field::ANGULAR_B, pull.b);
    k.store(
        t.axis,
        row,
        axis_field::VALUE,
        value + k.load(t.direction, row, 3),
    );
    k.store(t.axis, row, axis_field::RATE, pull.rate(ends));
}

/// Measures the axes on which something acts, and remembers their values, so that turns count where they do.
#[inline(always)]
pub(crate) fn track<M: Machine>(k: &mut M, t: &Tables) {
    for g in k.count(t.tracked) {
        measure(k, t, g);
        let first = k.link(t.group_links, g, group_link::FIRST);
        let count = k.link(t.group_links, g, group_link::LINEAR);
        let count = count.plus(k.link(t.group_links, g, group_link::ANGULAR));
        for row in k.range(first, first.plus(count)) {
            let value = k.load(t.axis, row, axis_field::VALUE) - k.load(t.direction, row, 3);
            let mut kept = k.cell(value);
            if let Some(_branch) = k.when(k.equals(k.link(t.axis_links, row, axis_link::TURNS), 1))
            {
                kept.write(wrap(value));
            }
            k.store(t.angle, row, 0, kept.read());
        }
    }
}

/// What an axis pulls along: n on the centres, a and b on the rotations.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull<R> {
    n: Vec3<R>,
    a: Vec3<R>,
    b: Vec3<R>,
}

impl<R: Real> Pull<R> {
    #[inline(always)]
    pub fn load<M: Machine<R = R>>(k: &M, t: &Tables, row: M::I) -> Self {
        Self {
            n: k.vec3(t.axis, row, axis_field::LINEAR),
            a: k.vec3(t.axis, row, axis_field::ANGULAR_A),
            b: k.vec3(t.axis, row, axis_field::ANGULAR_B),
        }
    }
    /// Rate of the coordinate.
    #[inline(always)]
    pub fn rate<I: Index>(&self, ends: &Ends<R, I>) -> R {
        let (a, b) = (ends.a.twist, ends.b.twist);
        self.n.dot(b.linear - a.linear) + self.b.dot(b.angular) - self.a.dot(a.angular)
    }
    /// Inverse mass of the coordinate.
    #[inline(always)]
    pub fn weight<I: Index>(&self, ends: &Ends<R, I>) -> R {
        let straight = (ends.a.m + ends.b.m) * self.n.length_squared();
        straight + self.a.dot(ends.a.i * self.a) + self.b.dot(ends.b.i * self.b)
    }
    /// Applies a position impulse along the coordinate, at the arms of the start. Returns how A and B moved.
    #[inline(always)]
    pub fn push<I: Index>(&self, ends: &mut Ends<R, I>, lambda: R, over_h: R) -> [Spatial<R>; 2] {
        let (n, a, b) = (self.n * lambda, self.a * lambda, self.b * lambda);
        let none = Vec3::zero();
        [
            ends.a.push(-n, -a, none, over_h),
            ends.b.push(n, b, none, over_h),
        ]
    }
}
