//! Forces along degrees of freedom, linearised in the step.
//!
//! Each is a spring and damper with target: τ = −k (q − q₀) − d (q̇ − w₀). With the speed q̇' = q̇ + h q̈ at the end of a
//! step of length h, and the place q + Θ h q̇' on the way there, it is
//!
//! ```text
//! τ' = −k (q + Θ h q̇ − q₀) − d (q̇ − w₀) − (Θ h² k + h d) q̈
//! ```
//!
//! The first two terms go into τ, the factor of q̈ into the joint's diagonal D
//! of the articulated-body algorithm, where it keeps any stiffness stable; how much of it that takes is
//! [`implicitness`](crate::implicitness). With h = 0 the law is explicit. (Baraff & Witkin 1998, eq. 6, along one
//! coordinate, for Θ = 1.) Source of the diagonal form: Featherstone 2008, §7.3, with D + h d + Θ h² k for D.
//!
//! Only what a model uses has a row, so that a passive chain pays for nothing.

use super::articulated_body::TINY;
use super::limit;
use super::tables::{Tables, dof};
use crate::tables::{Filler, actuator_numbers, ball_target, bounded};
use model::{JointKind, Model};
use numbers::functions::wrap;
use numbers::machine::space::{Parameter, State};
use numbers::machine::{Index, Links};
use numbers::{Cell, Machine, Quat, Real, Table};
use std::ops::Range;

/// How many rows each kind of force needs.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ForceRows {
    passive_begin: usize,
    passive_end: usize,
    drives: usize,
    balls: usize,
    /// Whether anything has dry friction.
    rubs: bool,
    motors: usize,
    servos: usize,
}

/// Layout of the force laws. Links name a degree of freedom and a coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ForceTables {
    dofs: usize,
    passive_begin: usize,
    passive_end: usize,
    drives: usize,
    balls: usize,
    motors: usize,
    servos: usize,
    /// Damping, stiffness, rest, Θ.
    /// One row for each of the degrees of freedom from `passive_begin` to `passive_end`.
    passive: Table<Parameter, 4>,
    passive_links: Links,
    /// Rows of `limit`: one for each degree of freedom, or none where nothing is passive.
    pub(crate) limits: usize,
    pub(crate) limit: Table<Parameter, 6>,
    pub(crate) limit_links: Links,
    /// Stiffness, damping, effort limit, control time, Θ.
    drive: Table<Parameter, 5>,
    drive_links: Links<3>,
    /// The target as smoothed so far.
    drive_target: Table<State>,
    /// As `drive`, of a ball joint.
    ball: Table<Parameter, 5>,
    ball_links: Links<2>,
    ball_target: Table<State, 4>,
    /// Rows of `friction`: one for each degree of freedom, or none where nothing rubs.
    pub(crate) frictions: usize,
    pub(crate) friction: Table<Parameter>,
    /// Force per control, control range 2. Links: degree of freedom, actuator.
    motor: Table<Parameter, 3>,
    motor_links: Links<2>,
    /// Gear, gain, bias 3, control range 2, force range 2, Θ. Links: coordinate, degree of freedom,
    /// actuator.
    servo: Table<Parameter, 10>,
    servo_links: Links<3>,
    armature: Table<Parameter>,
}

/// A model's degrees of freedom that have a coordinate each, with that coordinate, and whether it turns without end.
fn axes(model: &Model) -> impl Iterator<Item = (usize, usize, &model::Dof, bool)> {
    model
        .joints
        .iter()
        .enumerate()
        .filter(|(_, j)| !j.axes.is_empty())
        .flat_map(move |(i, joint)| {
            let id = model::JointId(i);
            let (q, v) = (model.coordinate_range(id), model.dof_range(id));
            let rows = q.zip(v).zip(&joint.dofs).enumerate();
            rows.map(move |(axis, ((q, v), dof))| (q, v, dof, model.turns_without_end(id, axis)))
        })
}

/// Coordinates that turn without end, and so stay within (−π, π].
pub(crate) fn wrapping(model: &Model) -> impl Iterator<Item = usize> {
    axes(model).filter(|a| a.3).map(|a| a.0)
}

/// Degrees of freedom of ball and free rotations: (quaternion coordinate, first dof, dofs).
fn balls(model: &Model) -> impl Iterator<Item = (usize, usize, &[model::Dof])> {
    model
        .joints
        .iter()
        .enumerate()
        .filter(|(_, j)| j.kind == JointKind::Ball)
        .map(|(i, joint)| {
            let id = model::JointId(i);
            (
                model.coordinate_range(id).start,
                model.dof_range(id).start,
                &joint.dofs[..],
            )
        })
}

/// True where nothing along a joint's degrees of freedom opposes their accelerations: no armature,
/// spring, damper, friction, drive or limit, and no actuator that heeds the state.
pub(crate) fn only_forces_act(model: &Model, id: model::JointId) -> bool {
    let free = |d: &model::Dof| {
        let laws = d.armature + d.damping + d.stiffness + d.friction_loss;
        laws == 0.0 && !driven(d) && d.limit.is_none()
    };
    let plain = |a: &model::Actuator| a.joint != id || a.bias[1..] == [0.0, 0.0];
    model.joints[id.0].dofs.iter().all(free) && model.actuators.iter().all(plain)
}

/// True for a spring, a damper or a limit.
fn passive(dof: &model::Dof) -> bool {
    dof.damping > 0.0 || dof.stiffness > 0.0 || dof.limit.is_some()
}

/// True for an actuator whose force depends on its control alone, and has no bounds of its own.
fn is_motor(a: &model::Actuator) -> bool {
    a.bias == [0.0; 3] && a.force_range.is_none()
}

fn driven(dof: &model::Dof) -> bool {
    dof.drive.stiffness > 0.0 || dof.drive.damping > 0.0
}

impl ForceRows {
    pub(crate) fn count(model: &Model) -> Self {
        let all = || {
            model
                .joints
                .iter()
                .filter(|j| !j.closes_loop)
                .flat_map(|j| &j.dofs)
        };
        let tree = |(_, j): &(usize, &model::Joint)| !j.closes_loop;
        let passives = model
            .joints
            .iter()
            .enumerate()
            .filter(tree)
            .flat_map(|(i, joint)| {
                let rows = model.dof_range(model::JointId(i)).zip(&joint.dofs);
                rows.filter(|(_, d)| passive(d)).map(|(v, _)| v)
            });
        let (first, last) = (passives.clone().min(), passives.max());
        let motors = model.actuators.iter().filter(|a| is_motor(a)).count();
        Self {
            passive_begin: first.unwrap_or(0),
            passive_end: last.map_or(0, |v| v + 1),
            drives: axes(model).filter(|a| driven(a.2)).count(),
            balls: balls(model).filter(|b| b.2.iter().any(driven)).count(),
            rubs: all().any(|d| d.friction_loss > 0.0),
            motors,
            servos: model.actuators.len() - motors,
        }
    }
}

impl ForceTables {
    /// Lays the rows out at the ends of the four memories.
    pub(crate) fn place(
        rows: &ForceRows,
        dofs: usize,
        state: &mut usize,
        parameters: &mut usize,
        links: &mut usize,
    ) -> Self {
        let passives = rows.passive_end - rows.passive_begin;
        let limits = if passives > 0 { dofs } else { 0 };
        let frictions = if rows.rubs { dofs } else { 0 };
        Self {
            dofs,
            passive_begin: rows.passive_begin,
            passive_end: rows.passive_end,
            drives: rows.drives,
            balls: rows.balls,
            motors: rows.motors,
            servos: rows.servos,
            passive: Table::place(parameters, passives),
            passive_links: Links::place(links, passives),
            limits,
            limit: Table::place(parameters, limits),
            limit_links: Links::place(links, limits),
            drive: Table::place(parameters, rows.drives),
            drive_links: Links::place(links, rows.drives),
            drive_target: Table::place(state, rows.drives),
            ball: Table::place(parameters, rows.balls),
            ball_links: Links::place(links, rows.balls),
            ball_target: Table::place(state, rows.balls),
            frictions,
            friction: Table::place(parameters, frictions),
            motor: Table::place(parameters, rows.motors),
            motor_links: Links::place(links, rows.motors),
            servo: Table::place(parameters, rows.servos),
            servo_links: Links::place(links, rows.servos),
            armature: Table::place(parameters, dofs),
        }
    }

    /// Writes a model's force laws, for steps of length `h` [s], with Θ of each degree of freedom.
    pub(crate) fn fill(&self, model: &Model, h: f64, implicit: &[f64], f: &mut Filler) {
        self.fill_dofs(model, h, implicit, f);
        self.fill_axes(model, implicit, f);
        for (row, (q, v, dofs)) in balls(model).filter(|b| b.2.iter().any(driven)).enumerate() {
            f.link(self.ball_links, row, 0, q);
            f.link(self.ball_links, row, 1, v);
            let d = &dofs[0].drive;
            let x = [
                d.stiffness,
                d.damping,
                bounded(d.effort_limit),
                d.control_time,
                implicit[v],
            ];
            f.numbers(self.ball, row, 0, &x);
        }
        self.fill_actuators(model, implicit, f);
    }

    fn fill_actuators(&self, model: &Model, implicit: &[f64], f: &mut Filler) {
        let (mut motor, mut servo) = (0, 0);
        for (row, a) in model.actuators.iter().enumerate() {
            let (q, v) = (model.coordinate_range(a.joint), model.dof_range(a.joint));
            let numbers = actuator_numbers(a);
            if is_motor(a) {
                f.link(self.motor_links, motor, 0, v.start + a.dof);
                f.link(self.motor_links, motor, 1, row);
                let [gear, gain, _, _, _, low, high, _, _] = numbers;
                f.numbers(self.motor, motor, 0, &[gear * gain, low, high]);
                motor += 1;
            } else {
                // A free or ball joint's servo has no position term, so any coordinate will do.
                let coordinate = (q.start + a.dof).min(q.end - 1);
                f.link(self.servo_links, servo, 0, coordinate);
                f.link(self.servo_links, servo, 1, v.start + a.dof);
                f.link(self.servo_links, servo, 2, row);
                f.numbers(self.servo, servo, 0, &numbers);
                f.number(self.servo, servo, numbers.len(), implicit[v.start + a.dof]);
                servo += 1;
            }
        }
    }

    fn fill_dofs(&self, model: &Model, h: f64, implicit: &[f64], f: &mut Filler) {
        for (i, joint) in model.joints.iter().enumerate() {
            if joint.closes_loop {
                continue;
            }
            let id = model::JointId(i);
            let q = model.coordinate_range(id);
            for (k, (v, dof)) in model.dof_range(id).zip(&joint.dofs).enumerate() {
                f.number(self.armature, v, 0, dof.armature.max(TINY));
                // A ball's dampers have no position term, so any coordinate will do.
                let coordinate = (q.start + k).min(q.end - 1);
                if (self.passive_begin..self.passive_end).contains(&v) {
                    let row = v - self.passive_begin;
                    f.link(self.passive_links, row, 0, coordinate);
                    let numbers = [dof.damping, dof.stiffness, dof.rest, implicit[v]];
                    f.numbers(self.passive, row, 0, &numbers);
                }
                if self.limits > 0 {
                    f.link(self.limit_links, v, 0, coordinate);
                    f.numbers(self.limit, v, 0, &limit::numbers(dof.limit.as_ref(), h));
                }
                if self.frictions > 0 {
                    f.number(self.friction, v, 0, dof.friction_loss);
                }
            }
        }
    }

    fn fill_axes(&self, model: &Model, implicit: &[f64], f: &mut Filler) {
        let mut drive = 0;
        for (q, v, dof, wraps) in axes(model) {
            if driven(dof) {
                f.link(self.drive_links, drive, 0, q);
                f.link(self.drive_links, drive, 1, v);
                f.link(self.drive_links, drive, 2, usize::from(wraps));
                let d = &dof.drive;
                let x = [
                    d.stiffness,
                    d.damping,
                    bounded(d.effort_limit),
                    d.control_time,
                    implicit[v],
                ];
                f.numbers(self.drive, drive, 0, &x);
                drive += 1;
            }
        }
    }

    /// Where the targets lie as smoothed so far.
    pub(crate) fn targets(&self) -> Vec<Range<usize>> {
        let (axes, balls) = (&self.drive_target, &self.ball_target);
        vec![
            axes.start()..axes.at(self.drives, 0),
            balls.start()..balls.at(self.balls, 0),
        ]
    }
    /// The targets of the drives as a world starts: at the model's, already smoothed.
    pub(crate) fn initial(&self, model: &Model, state: &mut [f64]) {
        for (row, (_, _, dof, _)) in axes(model).filter(|a| driven(a.2)).enumerate() {
            state[self.drive_target.at(row, 0)] = dof.drive.target_position;
        }
        for (row, (_, _, dofs)) in balls(model).filter(|b| b.2.iter().any(driven)).enumerate() {
            state[self.ball_target.at(row, 0)..][..4].copy_from_slice(&ball_target(dofs));
        }
    }
}

impl ForceTables {
    /// Armature of a degree of freedom.
    #[inline(always)]
    pub(crate) fn armature<M: Machine>(&self, k: &M, v: M::I) -> M::R {
        k.load(self.armature, v, 0)
    }

    /// Adds ½ k (q − rest)² of all passive springs.
    #[inline(always)]
    pub(crate) fn spring_energy<M: Machine>(&self, k: &M, t: &Tables, sum: &mut M::Cell) {
        for i in k.count(self.passive_end - self.passive_begin) {
            let q = k.load(t.position, k.link(self.passive_links, i, 0), 0);
            let [stiffness, rest] = k.read(self.passive, i, 1);
            let energy = M::R::lit(0.5) * stiffness * (q - rest).squared();
            sum.write(sum.read() + energy);
        }
    }
}

/// Sums all forces along the degrees of freedom but limits' and dry friction's into `dof::TAU` and the field after it,
/// linearised over `h` [s].
#[inline(always)]
pub(crate) fn forces<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for v in k.count(f.passive_begin) {
        bare(k, t, v);
    }
    passives(k, t, h);
    for v in k.range(k.index(f.passive_end), k.index(f.dofs)) {
        bare(k, t, v);
    }
    drives(k, t, h);
    ball_drives(k, t, h);
    motors(k, t);
    servos(k, t, h);
}

/// Starts the sums of a degree of freedom without spring, damper and limit.
#[inline(always)]
pub(crate) fn bare<M: Machine>(k: &mut M, t: &Tables, v: M::I) {
    let (tau, armature) = (k.load(t.input.force, v, 0), t.forces.armature(k, v));
    k.write(t.dof, v, dof::TAU, [tau, armature]);
}

/// Adds a force and the factor by which it opposes q̈.
#[inline(always)]
fn add<M: Machine>(k: &mut M, t: &Tables, v: M::I, tau: M::R, implicit: M::R) {
    let [sum, opposing] = k.read(t.dof, v, dof::TAU);
    k.write(t.dof, v, dof::TAU, [sum + tau, opposing + implicit]);
}

/// Starts the sums with springs and dampers; limits and friction are kept apart.
#[inline(always)]
fn passives<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for i in k.count(f.passive_end - f.passive_begin) {
        let v = i.offset(f.passive_begin);
        let q = k.load(t.position, k.link(f.passive_links, i, 0), 0);
        let speed = k.load(t.velocity, v, 0);
        let [d, s, rest, theta] = k.read(f.passive, i, 0);
        let ahead = theta * h;
        let stretch = ahead.fma(speed, q - rest);
        let tau = k.load(t.input.force, v, 0) - s.fma(stretch, d * speed);
        let implicit = h.fma(ahead.fma(s, d), f.armature(k, v));
        k.write(t.dof, v, dof::TAU, [tau, implicit]);
    }
}

/// The drive's force clamped to its effort limit; where it bites, nothing is implicit.
#[inline(always)]
fn limited<R: Real>(tau: R, implicit: R, effort: R) -> (R, R) {
    let free = tau.abs().le(effort);
    (
        tau.clamp(-effort, effort),
        R::select(free, implicit, R::zero()),
    )
}

#[inline(always)]
fn drives<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for i in k.count(f.drives) {
        let (q, v) = (k.link(f.drive_links, i, 0), k.link(f.drive_links, i, 1));
        let turns = k.equals(k.link(f.drive_links, i, 2), 1);
        let (s, d) = (k.load(f.drive, i, 0), k.load(f.drive, i, 1));
        let (q, speed) = (k.load(t.position, q, 0), k.load(t.velocity, v, 0));
        let mut error = k.cell(k.load(f.drive_target, i, 0) - q);
        if let Some(_branch) = k.when(turns) {
            error.write(wrap(error.read()));
        }
        let ahead = k.load(f.drive, i, 4) * h;
        let error = ahead.fnma(speed, error.read());
        let tau = s * error + d * (k.load(t.input.target_velocity, v, 0) - speed);
        let (tau, implicit) = limited(tau, h * ahead.fma(s, d), k.load(f.drive, i, 2));
        add(k, t, v, tau, implicit);
    }
}

/// Follows a jump of the targets: first-order lag with the drive's control time T,
/// discretised implicitly: s' = s + (target − s) h / (T + h).
#[inline(always)]
pub(crate) fn smooth_targets<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for i in k.count(f.drives) {
        let v = k.link(f.drive_links, i, 1);
        let share = h / (k.load(f.drive, i, 3) + h);
        let (now, target) = (
            k.load(f.drive_target, i, 0),
            k.load(t.input.target_position, v, 0),
        );
        let mut way = k.cell(target - now);
        if let Some(_branch) = k.when(k.equals(k.link(f.drive_links, i, 2), 1)) {
            way.write(wrap(way.read()));
        }
        let next = share.fma(way.read(), now);
        k.store(f.drive_target, i, 0, next);
    }
    for i in k.count(f.balls) {
        let v = k.link(f.ball_links, i, 1);
        let share = h / (k.load(f.ball, i, 3) + h);
        let now = k.quat(f.ball_target, i, 0);
        let target = Quat::exp(k.vec3(t.input.target_position, v, 0));
        let next = now * Quat::exp((now.conjugate() * target).log() * share);
        k.store_quat(f.ball_target, i, 0, next.normalized());
    }
}

/// τ = k log(q⁻¹ target) + d (w − ω) in the child's axes, the shorter way round,
/// shortened as a whole to the effort limit.
#[inline(always)]
fn ball_drives<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for i in k.count(f.balls) {
        let (q, v) = (k.link(f.ball_links, i, 0), k.link(f.ball_links, i, 1));
        let (s, d) = (k.load(f.ball, i, 0), k.load(f.ball, i, 1));
        let now = k.quat(t.position, q, 0);
        let speed = k.vec3(t.velocity, v, 0);
        let error = (now.conjugate() * k.quat(f.ball_target, i, 0)).log();
        let ahead = k.load(f.ball, i, 4) * h;
        let error = error - speed * ahead;
        let tau = error * s + (k.vec3(t.input.target_velocity, v, 0) - speed) * d;
        let effort = k.load(f.ball, i, 2);
        let size = tau.length();
        let free = size.le(effort);
        let tau = tau * M::R::select(free, M::R::one(), effort / size.max(M::R::lit(1e-12)));
        let implicit = M::R::select(free, h * ahead.fma(s, d), M::R::zero());
        add(k, t, v, tau.x, implicit);
        add(k, t, v.offset(1), tau.y, implicit);
        add(k, t, v.offset(2), tau.z, implicit);
    }
}

#[inline(always)]
fn motors<M: Machine>(k: &mut M, t: &Tables) {
    let f = &t.forces;
    for i in k.count(f.motors) {
        let (v, actuator) = (k.link(f.motor_links, i, 0), k.link(f.motor_links, i, 1));
        let [gain, low, high] = k.read(f.motor, i, 0);
        let control = k.load(t.input.control, actuator, 0).clamp(low, high);
        let tau = gain.fma(control, k.load(t.dof, v, dof::TAU));
        k.store(t.dof, v, dof::TAU, tau);
    }
}

#[inline(always)]
fn servos<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let f = &t.forces;
    for i in k.count(f.servos) {
        let (q, v) = (k.link(f.servo_links, i, 0), k.link(f.servo_links, i, 1));
        let (q, speed) = (k.load(t.position, q, 0), k.load(t.velocity, v, 0));
        let control = k.load(t.input.control, k.link(f.servo_links, i, 2), 0);
        let [
            gear,
            gain,
            b0,
            b1,
            b2,
            control_low,
            control_high,
            low,
            high,
            theta,
        ] = k.read(f.servo, i, 0);
        let ahead = theta * h;
        let control = control.clamp(control_low, control_high);
        let (s, d) = (-b1, -b2);
        let force = gain.fma(control, b0) - gear * (s * ahead.fma(speed, q) + d * speed);
        let free = force.ge(low) & force.le(high);
        let implicit = M::R::select(free, gear * gear * (h * ahead.fma(s, d)), M::R::zero());
        add(k, t, v, gear * force.clamp(low, high), implicit);
    }
}
