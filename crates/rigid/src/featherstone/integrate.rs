//! From accelerations to the next state.
//!
//! ```text
//! semi-implicit Euler   q̇' = q̇ + h q̈(q, q̇),  q' = q ⊕ h q̇'                     order 1
//! explicit Euler        q' = q ⊕ h q̇,  q̇' = q̇ + h q̈(q, q̇)                      order 1
//! Verlet                q̇½ = q̇ + h/2 q̈(q, q̇),  q' = q ⊕ h q̇½,
//!                       q̇' = q̇½ + h/2 q̈(q', q̇½)                               order 2 where q̈ = q̈(q)
//! Runge–Kutta 4         the classical tableau (Kutta 1901)                        order 4
//! ```
//!
//! ⊕ adds, and turns a quaternion by a rotation vector in the child's axes:
//! q ⊕ u = q exp(u). Along q₀ exp(u) a ball's body velocity ω gives
//! u̇ = ω + ½ u × ω + 1/12 u × (u × ω) + O(u⁴), which keeps Runge–Kutta at order 4
//! (Munthe-Kaas 1998, dexp⁻¹ truncated).

use super::Integrator;
use super::articulated_body::{along, articulated_body, by_themselves};
use super::contact;
use super::force::{forces, smooth_targets};
use super::friction;
use super::gauss_seidel;
use super::kinematics::kinematics;
use super::limit;
use super::locked;
use super::report::gather;
use super::tables::{Tables, dof, step};
use crate::contacts::forget_torques;
use crate::contacts::place_shapes;
use numbers::functions::{finite, wrap};
use numbers::machine::{Held, Hold, Index};
use numbers::{Cell, Float, Machine, Quat, Real, Vec3};

/// Coordinates beyond this are taken for diverged [m or rad].
const FAR: f64 = 1e9;
/// Further passes at most, for stops and points that pull.
const MORE: usize = 4;

/// The first half of a stage of a step: what comes before the contacts are found.
#[inline(always)]
pub(crate) fn begin<M: Machine, const CONTACTS: bool>(
    k: &mut M,
    t: &Tables,
    integrator: Integrator,
    stage: M::I,
) {
    let h = k.load(t.step, k.index(0), step::TIME);
    if let Some(_branch) = k.when(k.equals(stage, 0)) {
        // The first integrator saves as it goes, which is why it is the fastest.
        if integrator != Integrator::SemiImplicitEuler {
            save(k, t);
        }
        if integrator == Integrator::RungeKutta4 {
            clear_sums(k, t);
        }
        smooth_targets(k, t, h);
    }
    kinematics(k, t);
    if CONTACTS {
        place_shapes(k, &t.contacts, t, h);
    }
}

/// The second half of a stage; lanes that diverged stay where they were.
#[inline(always)]
pub(crate) fn finish<M: Machine, const CONTACTS: bool>(
    k: &mut M,
    t: &Tables,
    integrator: Integrator,
    stage: M::I,
) {
    let h = k.load(t.step, k.index(0), step::TIME);
    accelerate::<M, CONTACTS>(k, t, integrator, h);
    match integrator {
        Integrator::SemiImplicitEuler => kick_and_drift(k, t, h),
        Integrator::ExplicitEuler => {
            drift(k, t, h);
            kick(k, t, h);
        }
        Integrator::Verlet => {
            kick(k, t, h * M::R::lit(0.5));
            if let Some(_branch) = k.when(k.equals(stage, 0)) {
                drift(k, t, h);
            }
        }
        Integrator::RungeKutta4 => runge_kutta_stage(k, t, h, stage),
    }
    if let Some(_branch) = k.when(k.equals(stage, integrator.stages() - 1)) {
        if CONTACTS {
            contact::keep(k, t);
        }
        guard::<M, CONTACTS>(k, t);
    }
}

/// q̈ of the present state; contacts, and the forces along coordinates of the first integrator, are
/// taken as they will be after h.
#[inline(always)]
fn accelerate<M: Machine, const CONTACTS: bool>(
    k: &mut M,
    t: &Tables,
    integrator: Integrator,
    h: M::R,
) {
    let implicit = match integrator {
        Integrator::SemiImplicitEuler => h,
        _ => M::R::zero(),
    };
    forces(k, t, implicit);
    if CONTACTS {
        contact::meet(k, t, h);
        if t.exchanges() {
            gauss_seidel::begin(k, t);
        }
        settle(k, t, h, implicit);
        if t.exchanges() {
            gauss_seidel::gauss_seidel(k, t, h);
        }
    } else {
        limit::under_stops::<M, false>(k, t, h, implicit);
    }
}

/// q̈ under contacts and limits that agree with it, as far as the passes reach; beyond them, one more where stops do not,
/// and more until no point pulls too much.
#[inline(always)]
fn settle<M: Machine>(k: &mut M, t: &Tables, h: M::R, implicit: M::R) {
    let zero = M::R::zero();
    limit::begin(k, t, implicit);
    friction::begin(k, t);
    by_themselves(k, t, implicit);
    let mut pull = k.cell(zero);
    let mut stops = k.cell(zero);
    for i in k.count(t.passes + MORE) {
        let further = k.less(k.index(t.passes), i.offset(1));
        if let Some(_branch) = k.when(further) {
            let open = stops.read().gt(zero);
            let wrong = contact::pulls(k, t, pull.read());
            contact::go_back(k, t, open, wrong);
            limit::go_back(k, t, open);
            friction::hold(k, t);
        }
        articulated_body::<M, true>(k, t, h, implicit);
        let mut changes = k.cell(zero);
        stops.write(zero);
        contact::settle(k, t, h, &mut changes, &mut pull);
        limit::settle(k, t, &mut stops);
        friction::settle(k, t, implicit, &mut changes);
        if let Some(_branch) = k.when(further) {
            stops.write(zero);
        }

        let pulls = contact::pulls(k, t, pull.read());
        let mut left = k.cell(M::R::select(pulls, M::R::one(), stops.read()));
        if let Some(_branch) = k.when(k.less(i.offset(1), k.index(t.passes))) {
            left.write(changes.read() + stops.read());
        }
        if k.finished(left.read().same(zero)) {
            break;
        }
    }
}

/// q̇ ← q̇ + h q̈, then q ← q ⊕ h q̇; what was is saved.
#[inline(always)]
fn kick_and_drift<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for i in k.count(t.axes) {
        let [q, v] = k.link_row(t.axis_links, i);
        let (place, speed) = (k.load(t.position, q, 0), k.load(t.velocity, v, 0));
        let faster = k.load(t.dof, v, dof::ACCELERATION).fma(h, speed);
        k.store(t.saved_position, q, 0, place);
        k.store(t.saved_velocity, v, 0, speed);
        k.store(t.position, q, 0, faster.fma(h, place));
        k.store(t.velocity, v, 0, faster);
    }
    for v in k.count(t.recents) {
        let acceleration = k.load(t.dof, v, dof::ACCELERATION);
        k.store(t.recent, v, 0, acceleration);
    }
    for i in k.count(t.balls) {
        let [q, v] = k.link_row(t.ball_links, i);
        let (turn, spin) = (k.quat(t.position, q, 0), k.vec3(t.velocity, v, 0));
        let faster = along(k, t, v, dof::ACCELERATION).fma(h, spin);
        k.store_quat(t.saved_position, q, 0, turn);
        k.store_vec3(t.saved_velocity, v, 0, spin);
        k.store_quat(t.position, q, 0, turned(k, turn, faster * h));
        k.store_vec3(t.velocity, v, 0, faster);
    }
}

/// An orientation turned by a rotation vector in its own axes, of unit length.
///
/// The short series is exact to rounding of f32 for up to one radian, and of f64 for up to 0.01;
/// most steps turn less.
#[inline(always)]
fn turned<M: Machine>(k: &M, q: Quat<M::R>, way: Vec3<M::R>) -> Quat<M::R> {
    let mut turn = Quat::exp_short(way).hold(k);
    let limit = if <M::R as Real>::Scalar::DOUBLE {
        1e-4
    } else {
        1.0
    };
    let far = way.length_squared().gt(M::R::lit(limit));
    if let Some(_branch) = k.if_any(far) {
        turn.set(Quat::select(far, Quat::exp(way), turn.get()));
    }
    (q * turn.get()).normalized()
}

/// q̇ ← q̇ + h q̈.
#[inline(always)]
fn kick<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for v in k.count(t.dofs) {
        let moved = k
            .load(t.dof, v, dof::ACCELERATION)
            .fma(h, k.load(t.velocity, v, 0));
        k.store(t.velocity, v, 0, moved);
    }
}

/// q ← q ⊕ h q̇.
#[inline(always)]
fn drift<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for i in k.count(t.axes) {
        let (q, v) = (k.link(t.axis_links, i, 0), k.link(t.axis_links, i, 1));
        let moved = k.load(t.velocity, v, 0).fma(h, k.load(t.position, q, 0));
        k.store(t.position, q, 0, moved);
    }
    for i in k.count(t.balls) {
        let (q, v) = (k.link(t.ball_links, i, 0), k.link(t.ball_links, i, 1));
        let way = k.vec3(t.velocity, v, 0) * h;
        let moved = turned(k, k.quat(t.position, q, 0), way);
        k.store_quat(t.position, q, 0, moved);
    }
}

#[inline(always)]
fn clear_sums<M: Machine>(k: &mut M, t: &Tables) {
    for v in k.count(t.dofs) {
        k.store(t.sum_velocity, v, 0, M::R::zero());
        k.store(t.sum_acceleration, v, 0, M::R::zero());
        k.store(t.increment, v, 0, M::R::zero());
    }
}

/// Adds a stage to the sums, and moves from the saved state to the next stage, or to the end.
#[inline(always)]
fn runge_kutta_stage<M: Machine>(k: &mut M, t: &Tables, h: M::R, stage: M::I) {
    let weight = k.load(t.tableau, stage, 0);
    let (next, last) = (k.load(t.tableau, stage, 1), k.load(t.tableau, stage, 2));
    for i in k.count(t.axes) {
        let (q, v) = (k.link(t.axis_links, i, 0), k.link(t.axis_links, i, 1));
        let rate = k.load(t.velocity, v, 0);
        let sum = weight.fma(rate, k.load(t.sum_velocity, v, 0));
        k.store(t.sum_velocity, v, 0, sum);
        let moved = h.fma(next.fma(rate, last * sum), k.load(t.saved_position, q, 0));
        k.store(t.position, q, 0, moved);
    }
    for i in k.count(t.balls) {
        let (q, v) = (k.link(t.ball_links, i, 0), k.link(t.ball_links, i, 1));
        let (u, w) = (k.vec3(t.increment, v, 0), k.vec3(t.velocity, v, 0));
        let (uw, half, twelfth) = (u.cross(w), M::R::lit(0.5), M::R::lit(1.0 / 12.0));
        let rate = u.cross(uw).fma(twelfth, uw.fma(half, w));
        let sum = rate.fma(weight, k.vec3(t.sum_velocity, v, 0));
        k.store_vec3(t.sum_velocity, v, 0, sum);
        let way = (rate * next + sum * last) * h;
        k.store_vec3(t.increment, v, 0, way);
        let moved = k.quat(t.saved_position, q, 0) * Quat::exp(way);
        k.store_quat(t.position, q, 0, moved.normalized());
    }
    for v in k.count(t.dofs) {
        let rate = k.load(t.dof, v, dof::ACCELERATION);
        let sum = weight.fma(rate, k.load(t.sum_acceleration, v, 0));
        k.store(t.sum_acceleration, v, 0, sum);
        let moved = h.fma(next.fma(rate, last * sum), k.load(t.saved_velocity, v, 0));
        k.store(t.velocity, v, 0, moved);
    }
}

#[inline(always)]
fn save<M: Machine>(k: &mut M, t: &Tables) {
    for q in k.count(t.coordinates) {
        let x = k.load(t.position, q, 0);
        k.store(t.saved_position, q, 0, x);
    }
    for v in k.count(t.dofs) {
        let x = k.load(t.velocity, v, 0);
        k.store(t.saved_velocity, v, 0, x);
    }
}

/// Wraps free turns that nothing counts; a lane that has diverged, now or before, keeps its last finite state.
#[inline(always)]
fn guard<M: Machine, const CONTACTS: bool>(k: &mut M, t: &Tables) {
    for i in k.count(t.wraps) {
        let q = k.link(t.wrap_links, i, 0);
        let wrapped = wrap(k.load(t.position, q, 0));
        k.store(t.position, q, 0, wrapped);
    }
    let (world, zero) = (k.index(0), M::R::zero());
    let mut fastest = k.cell(zero);
    let mut farthest = k.cell(zero);
    let mut sum = k.cell(zero);
    for v in k.count(t.dofs) {
        let speed = k.load(t.velocity, v, 0).abs();
        fastest.write(fastest.read().max(speed));
        gather(&mut sum, speed);
    }
    for q in k.count(t.coordinates) {
        let far = k.load(t.position, q, 0).abs();
        farthest.write(farthest.read().max(far));
        gather(&mut sum, far);
    }
    let slow = fastest.read().le(k.load(t.step, world, step::SPEED_LIMIT));
    let near = farthest.read().le(M::R::lit(FAR));
    let fine = slow & near & finite(sum.read());
    let fine = M::R::select(fine, k.load(t.alive, world, 0), zero);
    k.store(t.alive, world, 0, fine);
    let lost = fine.same(M::R::zero());
    if let Some(_branch) = k.if_any(lost) {
        if CONTACTS {
            t.kept.forget(k, lost);
            if t.grips {
                forget_torques(k, (t.gripped, t.contacts.sensed), lost);
            }
            locked::forget(k, t, lost);
        }
        for q in k.count(t.coordinates) {
            let x = k.load(t.saved_position, q, 0);
            k.store_where(lost, t.position, q, 0, x);
        }
        for v in k.count(t.dofs) {
            let x = k.load(t.saved_velocity, v, 0);
            k.store_where(lost, t.velocity, v, 0, x);
        }
        for v in k.count(t.recents) {
            k.store_where(lost, t.recent, v, 0, zero);
        }
    }
}
