//! Forces along joint coordinates: springs, drives, limits, friction, motors.
//!
//! All are one law, f = f₀ − k (θ − θ₀) − d (θ̇ − w₀) within [low, high], taken at
//! the end of the substep. Where a pass over the tree moves the coordinate by q, its
//! rate becomes θ̇ + q/h and its end θ + h θ̇ + q. With λ = h² f that is
//!
//! ```text
//! Δλ = λ₀ − g q      λ₀ = h² (f₀ − k (θ + h θ̇ − θ₀) − d (θ̇ − w₀)) − λ      g = h² k + h d
//! ```
//!
//! which is XPBD with compliance 1/k and damping d (Macklin et al. 2016, eqs. 18
//! and 26), multiplied through by k so that a missing spring divides by nothing.
//! Springs that substeps resolve are taken before their end, at θ + Θ (h θ̇ + q), with Θ by
//! [`implicitness`](crate::implicitness): they get a damper less, d − (1 − Θ) h k, which w₀ has no part in.
//!
//! A pass solves λ₀ and g together with the locks. A law that it takes beyond a
//! bound is held there, λ₀ = bound, g = 0, and the pass is done again, until the
//! same laws are held as before: a semi-smooth Newton method (Hintermüller, Ito,
//! Kunisch 2002).
//!
//! Armature m is the law d = m/h, w₀ = θ̇ + q/h as the last pass of the substep before had it: the speed w₀ − λ/(m h) that λ
//! gave it. What bodies gain by a turn of the axes, by loops or by a blow is not its own, and it resists that. Dry friction
//! is a damper without limit, held within its bounds.

use super::articulated::TINY;
use super::axis::Pull;
use super::joint::Ends;
use super::tables::{Tables, axis_field, axis_link, joint_field, joint_link, motion};
use crate::SolverError;
use crate::tables::{Filler, UNBOUNDED, actuator_numbers, ball_target, bounded};
use model::{Dof, JointKind, Model};
use numbers::functions::wrap;
use numbers::machine::space::{Parameter, Scratch, State};
use numbers::machine::{Index, Links};
use numbers::{Cell, Machine, Quat, Real, Table, Vec3};
use std::ops::Range;

/// True if anything acts along a degree of freedom.
pub(crate) fn acts(dof: &Dof) -> bool {
    driven(dof)
        || dof.armature > 0.0
        || dof.damping > 0.0
        || dof.stiffness > 0.0
        || dof.friction_loss > 0.0
        || dof.limit.is_some()
}

fn driven(dof: &Dof) -> bool {
    dof.drive.stiffness > 0.0 || dof.drive.damping > 0.0
}

/// Refuses what has no law on joints without axes.
pub(crate) fn check(model: &Model) -> Result<(), SolverError> {
    crate::check::rotations(model, "xpbd")?;
    for joint in model.joints.iter().filter(|j| j.axes.is_empty()) {
        let refuse = |what| {
            let (solver, name) = ("xpbd", joint.name.clone());
            let remedy = "use the solver `featherstone`, or a d6 joint with three angular axes";
            Err(SolverError::Unsupported {
                solver,
                what,
                name,
                remedy,
            })
        };
        for dof in &joint.dofs {
            if dof.armature > 0.0 {
                return refuse("armature on a joint without axes");
            }
            if dof.friction_loss > 0.0 {
                return refuse("friction loss on a joint without axes");
            }
            if dof.stiffness > 0.0 {
                return refuse("a spring on a joint without axes");
            }
            if dof.limit.is_some() {
                return refuse("limits on a joint without axes");
            }
            if joint.kind == JointKind::Free && dof.damping > 0.0 {
                return refuse("damping of a free joint");
            }
        }
        if joint.dofs.windows(2).any(|d| d[0].damping != d[1].damping) {
            return refuse("dampings that differ between the axes of a ball joint");
        }
    }
    for actuator in &model.actuators {
        let joint = &model.joints[actuator.joint.0];
        if joint.axes.is_empty() {
            return Err(SolverError::Unsupported {
                solver: "xpbd",
                what: "an actuator on a joint without axes",
                name: actuator.name.clone(),
                remedy: "act on it by the force of its degrees of freedom",
            });
        }
    }
    Ok(())
}

/// Most repetitions of a pass, until it is known what is held at a bound.
const ROUNDS: usize = 8;

/// Fields of [`LawTables::law`]: stiffness, damping, θ₀, w₀, f₀, low, high, and what follows.
mod law {
    pub const FIRST: usize = 0;
    pub const BOUNDS: usize = 5;
    /// λ of the passes before.
    pub const MULTIPLIER: usize = 7;
    /// λ₀.
    pub const LEAD: usize = 8;
    /// 1 if it is held at a bound; that bound's λ.
    pub const HELD: usize = 9;
    pub const WIDTH: usize = 11;
}

/// Fields of [`LawTables::ball_law`]: as of a law, with vectors.
mod ball_law {
    pub const MULTIPLIER: usize = 0;
    pub const LEAD: usize = 3;
    pub const HELD: usize = 6;
    pub const BOUND: usize = 7;
    /// λ and λ₀ of its damping, which no effort limit holds.
    pub const DAMPED: usize = 10;
    pub const DAMPING: usize = 13;
    pub const WIDTH: usize = 16;
}

/// Layout of the laws, by kind, and of what they are written to for a substep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LawTables {
    springs: usize,
    drives: usize,
    limits: usize,
    frictions: usize,
    armatures: usize,
    motors: usize,
    balls: usize,
    pub(crate) couplings: usize,
    laws: usize,
    /// Something with inertia may be geared to an axis.
    pub(crate) geared: bool,
    /// First law of each kind.
    starts: [usize; 6],
    /// Axis row and degree of freedom of each law (for a motor: actuator).
    law_links: Links<2>,
    /// Joint row, degree of freedom and first motion of each ball with a drive or damping.
    ball_links: Links<3>,
    /// Axis rows of each coupling.
    coupling_links: Links<2>,
    /// Damping, stiffness, rest, Θ.
    spring: Table<Parameter, 4>,
    /// Stiffness, damping, effort limit, control time, 1 if the coordinate turns without end, Θ.
    drive: Table<Parameter, 6>,
    drive_target: Table<State>,
    /// Lower, upper, stiffness, damping, inertia.
    limit: Table<Parameter, 5>,
    limit_speed: Table<State>,
    friction: Table<Parameter>,
    armature: Table<Parameter>,
    armature_speed: Table<State>,
    /// Gear, gain, bias 3, control range 2, force range 2, Θ.
    motor: Table<Parameter, 10>,
    /// Stiffness, damping, effort limit, control time, passive damping, Θ.
    ball: Table<Parameter, 6>,
    ball_target: Table<State, 4>,
    /// Ratio, offset.
    coupling: Table<Parameter, 2>,
    law: Table<Scratch, { law::WIDTH }>,
    ball_law: Table<Scratch, { ball_law::WIDTH }>,
}

/// Degrees of freedom that have an axis, with their laws' owner, and whether they turn without end.
fn axes(model: &Model) -> impl Iterator<Item = (usize, &Dof, bool)> {
    model
        .joints
        .iter()
        .enumerate()
        .filter(|(_, j)| !j.axes.is_empty() && !j.closes_loop)
        .flat_map(move |(i, joint)| {
            let id = model::JointId(i);
            let rows = model.dof_range(id).zip(&joint.dofs).enumerate();
            rows.map(move |(axis, (v, dof))| (v, dof, model.turns_without_end(id, axis)))
        })
}

/// Balls that something acts on: number among all balls, joint, first degree of freedom, its dofs.
fn balls(model: &Model) -> impl Iterator<Item = (usize, usize, usize, &[Dof])> {
    model
        .joints
        .iter()
        .enumerate()
        .filter(|(_, j)| j.kind == JointKind::Ball && !j.closes_loop)
        .enumerate()
        .filter(|(_, (_, j))| j.dofs.iter().any(acts))
        .map(|(n, (i, j))| {
            let v = model.dof_range(model::JointId(i)).start;
            (n, i, v, &j.dofs[..])
        })
}

impl LawTables {
    pub(crate) fn place(
        model: &Model,
        state: &mut usize,
        parameters: &mut usize,
        links: &mut usize,
        scratch: &mut usize,
    ) -> Self {
        let count = |has: fn(&Dof) -> bool| axes(model).filter(|a| has(a.1)).count();
        let springs = count(|d| d.damping > 0.0 || d.stiffness > 0.0);
        let drives = count(driven);
        let limits = count(|d| d.limit.is_some());
        let frictions = count(|d| d.friction_loss > 0.0);
        let armatures = count(|d| d.armature > 0.0);
        let (motors, couplings) = (model.actuators.len(), model.couplings.len());
        let balls = balls(model).count();
        let kinds = [springs, drives, limits, frictions, armatures, motors];
        let laws = kinds.iter().sum();
        let starts = std::array::from_fn(|kind| kinds[..kind].iter().sum());
        Self {
            springs,
            drives,
            limits,
            frictions,
            armatures,
            motors,
            balls,
            couplings,
            laws,
            geared: armatures + limits > 0,
            starts,
            law_links: Links::place(links, laws),
            ball_links: Links::place(links, balls),
            coupling_links: Links::place(links, couplings),
            spring: Table::place(parameters, springs),
            drive: Table::place(parameters, drives),
            drive_target: Table::place(state, drives),
            limit: Table::place(parameters, limits),
            limit_speed: Table::place(state, limits),
            friction: Table::place(parameters, frictions),
            armature: Table::place(parameters, armatures),
            armature_speed: Table::place(state, armatures),
            motor: Table::place(parameters, motors),
            ball: Table::place(parameters, balls),
            ball_target: Table::place(state, balls),
            coupling: Table::place(parameters, couplings),
            law: Table::place(scratch, laws),
            ball_law: Table::place(scratch, balls),
        }
    }

    /// Writes a model's laws, with Θ of each degree of freedom.
    pub(crate) fn fill(
        &self,
        model: &Model,
        implicit: &[f64],
        axis_of: &[Option<usize>],
        ball_motion: impl Fn(usize) -> usize,
        f: &mut Filler,
    ) {
        let mut next = self.starts;
        let first = next;
        let mut row = |kind: usize, v: usize, f: &mut Filler| {
            let law = next[kind];
            next[kind] += 1;
            f.link(
                self.law_links,
                law,
                0,
                axis_of[v].expect("an axis has a row"),
            );
            f.link(self.law_links, law, 1, v);
            law - first[kind]
        };
        for (v, dof, turns) in axes(model) {
            if dof.damping > 0.0 || dof.stiffness > 0.0 {
                let i = row(0, v, f);
                let x = [dof.damping, dof.stiffness, dof.rest, implicit[v]];
                f.numbers(self.spring, i, 0, &x);
            }
            if driven(dof) {
                let (i, d) = (row(1, v, f), &dof.drive);
                let turns = f64::from(u8::from(turns));
                let x = [
                    d.stiffness,
                    d.damping,
                    bounded(d.effort_limit),
                    d.control_time,
                    turns,
                    implicit[v],
                ];
                f.numbers(self.drive, i, 0, &x);
            }
            if let Some(l) = dof.limit {
                let i = row(2, v, f);
                f.numbers(
                    self.limit,
                    i,
                    0,
                    &[l.lower, l.upper, l.stiffness, l.damping, l.inertia],
                );
            }
            if dof.friction_loss > 0.0 {
                let i = row(3, v, f);
                f.number(self.friction, i, 0, dof.friction_loss);
            }
            if dof.armature > 0.0 {
                let i = row(4, v, f);
                f.number(self.armature, i, 0, dof.armature);
            }
        }
        for (i, actuator) in model.actuators.iter().enumerate() {
            let v = model.dof_range(actuator.joint).start + actuator.dof;
            row(5, v, f);
            let x = actuator_numbers(actuator);
            f.numbers(self.motor, i, 0, &x);
            f.number(self.motor, i, x.len(), implicit[v]);
        }
        for (i, (ball, joint, v, dofs)) in balls(model).enumerate() {
            f.link(self.ball_links, i, 0, joint);
            f.link(self.ball_links, i, 1, v);
            f.link(self.ball_links, i, 2, ball_motion(ball));
            let (d, passive) = (&dofs[0].drive, dofs[0].damping);
            let x = [
                d.stiffness,
                d.damping,
                bounded(d.effort_limit),
                d.control_time,
                passive,
                implicit[v],
            ];
            f.numbers(self.ball, i, 0, &x);
        }
        for (i, c) in model.couplings.iter().enumerate() {
            for (field, joint) in [c.joint, c.other].into_iter().enumerate() {
                let v = model.dof_range(joint).start;
                f.link(
                    self.coupling_links,
                    i,
                    field,
                    axis_of[v].expect("an axis has a row"),
                );
            }
            f.numbers(self.coupling, i, 0, &[c.ratio, c.offset]);
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
        for (i, (_, dof, _)) in axes(model).filter(|a| driven(a.1)).enumerate() {
            state[self.drive_target.at(i, 0)] = dof.drive.target_position;
        }
        for (i, (_, _, _, dofs)) in balls(model).enumerate() {
            state[self.ball_target.at(i, 0)..][..4].copy_from_slice(&ball_target(dofs));
        }
    }
}

impl LawTables {
    /// Gives what is geared to the axes the speeds of their degrees of freedom.
    pub(crate) fn set_speeds(&self, velocity: &[f64], links: &[u32], state: &mut [f64]) {
        let [_, _, limits, _, armatures, _] = self.starts;
        let stops = (0..self.limits).map(|i| (limits + i, self.limit_speed.at(i, 0)));
        let geared = (0..self.armatures).map(|i| (armatures + i, self.armature_speed.at(i, 0)));
        for (law, at) in stops.chain(geared) {
            let v = links[self.law_links.at(law, 1)] as usize;
            state[at] = velocity[v];
        }
    }
    /// Where in the state those speeds are.
    pub(crate) fn speeds(&self) -> [Range<usize>; 2] {
        let (stops, geared) = (self.limit_speed, self.armature_speed);
        [
            stops.start()..stops.at(self.limits, 0),
            geared.start()..geared.at(self.armatures, 0),
        ]
    }
}

/// What is geared to the axes is as fast as a pass leads it to be, θ̇ + q/h. Needs the bodies as they were before the pass.
#[inline(always)]
pub(crate) fn keep_speeds<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let r = &t.laws;
    let [_, _, limits, _, armatures, _] = r.starts;
    for i in k.count(r.limits) {
        let speed = led(k, t, i.offset(limits), h);
        k.store(r.limit_speed, i, 0, speed);
    }
    for i in k.count(r.armatures) {
        let speed = led(k, t, i.offset(armatures), h);
        k.store(r.armature_speed, i, 0, speed);
    }
}

/// What limits carry along has the rates of their axes where they do not act, whatever moved these.
#[inline(always)]
pub(crate) fn follow<M: Machine>(k: &mut M, t: &Tables) {
    let r = &t.laws;
    for i in k.count(r.limits) {
        let law = i.offset(r.starts[2]);
        let [stiffness, damping] = k.read(r.law, law, law::FIRST);
        let acts = (stiffness + damping).gt(M::R::zero());
        let free = rate(k, t, k.link(r.law_links, law, 0));
        let speed = M::R::select(acts, k.load(r.limit_speed, i, 0), free);
        k.store(r.limit_speed, i, 0, speed);
    }
}

/// Rate to which a pass leads the axis of a law.
#[inline(always)]
fn led<M: Machine>(k: &M, t: &Tables, law: M::I, h: M::R) -> M::R {
    let axis = k.link(t.laws.law_links, law, 0);
    h.recip()
        .fma(k.load(t.motion, axis, motion::WAY), rate(k, t, axis))
}

/// Gives what is geared to the axes the bodies' rates where the mask holds.
#[inline(always)]
pub(crate) fn reset_speeds<M: Machine>(k: &mut M, t: &Tables, mask: <M::R as Real>::Mask) {
    let r = &t.laws;
    let [_, _, limits, _, armatures, _] = r.starts;
    for (table, count, first) in [
        (r.limit_speed, r.limits, limits),
        (r.armature_speed, r.armatures, armatures),
    ] {
        for i in k.count(count) {
            let axis = k.link(r.law_links, i.offset(first), 0);
            let speed = M::R::select(mask, rate(k, t, axis), k.load(table, i, 0));
            k.store(table, i, 0, speed);
        }
    }
}

/// Writes the laws of a substep, at the coordinates it starts with.
#[inline(always)]
pub(crate) fn prepare<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let r = &t.laws;
    let [springs, drives, limits, frictions, armatures, motors] = r.starts;
    let zero = M::R::zero();
    for i in k.count(r.springs) {
        let [d, s, rest, theta] = k.read(r.spring, i, 0);
        let d = d - early(s, theta, h);
        write(k, t, i.offset(springs), [s, d, rest, zero, zero], UNBOUNDED);
    }
    for i in k.count(r.drives) {
        drive(k, t, i, i.offset(drives), h);
    }
    for i in k.count(r.limits) {
        limit(k, t, i, i.offset(limits), h);
    }
    for i in k.count(r.frictions) {
        // So stiff a damper that only the clamp shows.
        let most = k.load(r.friction, i, 0);
        let damper = most * M::R::lit(1e6);
        store_law(
            k,
            t,
            i.offset(frictions),
            [zero, damper, zero, zero, zero],
            -most,
            most,
        );
    }
    for i in k.count(r.armatures) {
        let law = i.offset(armatures);
        let d = k.load(r.armature, i, 0) / h;
        let speed = k.load(r.armature_speed, i, 0);
        write(k, t, law, [zero, d, zero, speed, zero], UNBOUNDED);
    }
    for i in k.count(r.motors) {
        motor(k, t, i, i.offset(motors), h);
    }
    for i in k.count(r.balls) {
        k.store_vec3(r.ball_law, i, ball_law::MULTIPLIER, Vec3::zero());
        k.store_vec3(r.ball_law, i, ball_law::DAMPED, Vec3::zero());
    }
}

/// (1 − Θ) h k: the damper that a spring would be besides if it were taken at the end of the substep.
#[inline(always)]
fn early<R: Real>(stiffness: R, theta: R, h: R) -> R {
    (R::one() - theta) * h * stiffness
}

#[inline(always)]
fn write<M: Machine>(k: &mut M, t: &Tables, law: M::I, x: [M::R; 5], bound: f64) {
    let bound = M::R::lit(bound);
    store_law(k, t, law, x, -bound, bound);
}

/// Stiffness, damping, rest, speed, force; bounds of the force.
#[inline(always)]
fn store_law<M: Machine>(k: &mut M, t: &Tables, law: M::I, x: [M::R; 5], low: M::R, high: M::R) {
    let [s, d, rest, speed, force] = x;
    let zero = M::R::zero();
    k.write(
        t.laws.law,
        law,
        law::FIRST,
        [s, d, rest, speed, force, low, high, zero],
    );
}

#[inline(always)]
fn drive<M: Machine>(k: &mut M, t: &Tables, i: M::I, law: M::I, h: M::R) {
    let r = &t.laws;
    let axis = k.link(r.law_links, law, 0);
    let v = k.link(r.law_links, law, 1);
    let [s, d, effort, time, turns, theta] = k.read(r.drive, i, 0);
    let now = k.load(r.drive_target, i, 0);
    // Whole turns between value and target do not count where the axis turns without end.
    let turns = turns.gt(M::R::lit(0.5));
    let way = k.load(t.input.target_position, v, 0) - now;
    let way = M::R::select(turns, wrap(way), way);
    let target = (h / (time + h)).fma(way, now);
    k.store(r.drive_target, i, 0, target);
    let value = k.load(t.axis, axis, axis_field::VALUE);
    let error = target - value;
    let rest = value + M::R::select(turns, wrap(error), error);
    let speed = k.load(t.input.target_velocity, v, 0);
    let early = early(s, theta, h);
    store_law(
        k,
        t,
        law,
        [s, d - early, rest, speed, early * speed],
        -effort,
        effort,
    );
}

/// A limit acts where the substep would end beyond it, and never pulls.
#[inline(always)]
fn limit<M: Machine>(k: &mut M, t: &Tables, i: M::I, law: M::I, h: M::R) {
    let axis = k.link(t.laws.law_links, law, 0);
    let [lower, upper, s, d, m] = k.read(t.laws.limit, i, 0);
    let value = k.load(t.axis, axis, axis_field::VALUE);
    let next = h.fma(rate(k, t, axis), value);
    let (zero, above) = (M::R::zero(), next.gt(upper));
    let beyond = above | next.lt(lower);
    let rest = M::R::select(above, upper, lower);
    // The inertia is a damper too, against the speed that it has.
    let drag = m / h;
    let d = d + drag;
    let start = k.load(t.laws.limit_speed, i, 0);
    let kept = drag * start / d.max(M::R::lit(TINY));
    let s = M::R::select(beyond, s, zero);
    let d = M::R::select(beyond, d, zero);
    let most = M::R::lit(UNBOUNDED);
    let (low, high) = (
        M::R::select(above, -most, zero),
        M::R::select(above, zero, most),
    );
    store_law(k, t, law, [s, d, rest, kept, zero], low, high);
}

#[inline(always)]
fn motor<M: Machine>(k: &mut M, t: &Tables, i: M::I, law: M::I, h: M::R) {
    let [gear, gain, b0, b1, b2, low, high, least, most, theta] = k.read(t.laws.motor, i, 0);
    let control = k.load(t.input.control, i, 0).clamp(low, high);
    let force = gear * gain.fma(control, b0);
    let gear2 = gear.squared();
    // A bias −k l − d l̇ with l = gear q is a spring and a damper of the coordinate.
    let (s, d) = (-(b1 * gear2), -(b2 * gear2));
    let d = d - early(s, theta, h);
    let (a, b) = (gear * least, gear * most);
    store_law(
        k,
        t,
        law,
        [s, d, M::R::zero(), M::R::zero(), force],
        a.min(b),
        a.max(b),
    );
}

/// Rate of an axis's coordinate as the bodies move now.
#[inline(always)]
fn rate<M: Machine>(k: &M, t: &Tables, axis: M::I) -> M::R {
    let ends = Ends::load(k, t, k.link(t.axis_links, axis, axis_link::JOINT));
    Pull::load(k, t, axis).rate(&ends)
}

/// How often a pass may have to be done: once if nothing has a bound.
pub(crate) fn rounds(t: &Tables) -> usize {
    let r = &t.laws;
    let bounded = r.drives + r.limits + r.frictions + r.motors + r.balls;
    if bounded == 0 && !t.capped_at_all {
        1
    } else {
        ROUNDS
    }
}

/// λ₀ of all laws, as the bodies now move. None is held at a bound yet.
#[inline(always)]
pub(crate) fn lead<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let zero = M::R::zero();
    for law in k.count(t.laws.laws) {
        let axis = k.link(t.laws.law_links, law, 0);
        let [s, d, rest, speed, force] = k.read(t.laws.law, law, law::FIRST);
        let rate = rate(k, t, axis);
        let end = h.fma(rate, k.load(t.axis, axis, axis_field::VALUE));
        let wanted = force - s * (end - rest) - d * (rate - speed);
        let lead = h.squared() * wanted - k.load(t.laws.law, law, law::MULTIPLIER);
        k.write(t.laws.law, law, law::LEAD, [lead, zero, zero]);
    }
    for i in k.count(t.laws.balls) {
        lead_ball(k, t, i, h);
    }
}

/// Drive and damping of a ball, e the rotation vector from target to child.
#[inline(always)]
fn lead_ball<M: Machine>(k: &mut M, t: &Tables, i: M::I, h: M::R) {
    let r = &t.laws;
    let (j, v) = (k.link(r.ball_links, i, 0), k.link(r.ball_links, i, 1));
    let [s, d, _, _, passive, theta] = k.read(r.ball, i, 0);
    let ends = Ends::load(k, t, j);
    let (qa, qb) = ends.frames(k, t, j);
    let e = qb.rotate((k.quat(r.ball_target, i, 0).conjugate() * (qa.conjugate() * qb)).log());
    let rate = ends.b.twist.angular - ends.a.twist.angular;
    let speed = qb.rotate(k.vec3(t.input.target_velocity, v, 0));
    let wanted = rate * early(s, theta, h) - e * s - (rate - speed) * d;
    let lead = wanted * h.squared() - k.vec3(r.ball_law, i, ball_law::MULTIPLIER);
    k.store_vec3(r.ball_law, i, ball_law::LEAD, lead);
    let lead = -(rate * (passive * h.squared())) - k.vec3(r.ball_law, i, ball_law::DAMPED);
    k.store_vec3(r.ball_law, i, ball_law::DAMPING, lead);
    k.store(r.ball_law, i, ball_law::HELD, M::R::zero());
}

/// h² k + h d of a law.
#[inline(always)]
fn give<M: Machine>(k: &M, t: &Tables, law: M::I, h: M::R) -> M::R {
    let [s, d] = k.read(t.laws.law, law, law::FIRST);
    h.squared().fma(s, h * d)
}

/// Θ h² k + h d of a ball's drive, and h d of its damping.
#[inline(always)]
fn ball_give<M: Machine>(k: &M, t: &Tables, i: M::I, h: M::R) -> [M::R; 2] {
    let [s, d, _, _, passive, theta] = k.read(t.laws.ball, i, 0);
    [h * (theta * h).fma(s, d), h * passive]
}

/// Sums up what pulls along each motion. `fresh` is 1 in the first pass, in which forces act
/// that a controller has set, and 0 later.
#[inline(always)]
pub(crate) fn gather<M: Machine>(k: &mut M, t: &Tables, h: M::R, fresh: M::R) {
    let (r, zero, acts) = (&t.laws, M::R::zero(), fresh * h.squared());
    for row in k.count(t.coordinates) {
        let v = k.link(t.axis_links, row, axis_link::DOF);
        let force = k.load(t.input.force, v, 0);
        k.write(t.motion, row, motion::PUSH, [acts * force, zero]);
    }
    for i in k.count(t.balls) {
        let j = k.link(t.ball_links, i, 0);
        let b = k.link(t.joint_links, j, joint_link::B);
        let frame = k.quat(t.pose, b, 3) * k.quat(t.joint, j, joint_field::FRAME_B);
        let torque = k.vec3(t.input.force, k.link(t.ball_links, i, 2), 0);
        let push = frame.rotate(torque * acts);
        store_ball(k, t, k.link(t.ball_links, i, 3), push, zero);
    }
    for law in k.count(r.laws) {
        let axis = k.link(r.law_links, law, 0);
        let [pushed, lead, held, bound] = k.read(r.law, law, law::MULTIPLIER);
        let held = held.gt(zero);
        let push = M::R::select(held, bound - pushed, lead);
        let give = M::R::select(held, zero, give(k, t, law, h));
        k.add(t.motion, axis, motion::PUSH, push);
        k.add(t.motion, axis, motion::GIVE, give);
    }
    for i in k.count(r.balls) {
        let m = k.link(r.ball_links, i, 2);
        let held = k.load(r.ball_law, i, ball_law::HELD).gt(zero);
        let bound = k.vec3(r.ball_law, i, ball_law::BOUND);
        let rest = bound - k.vec3(r.ball_law, i, ball_law::MULTIPLIER);
        let lead = k.vec3(r.ball_law, i, ball_law::LEAD);
        let damped = k.vec3(r.ball_law, i, ball_law::DAMPING);
        let push = ball_push(k, t, m) + Vec3::select(held, rest, lead) + damped;
        let [drive, damping] = ball_give(k, t, i, h);
        let give = M::R::select(held, zero, drive) + damping;
        store_ball(k, t, m, push, give);
    }
}

/// What pulls along the three motions of a ball.
#[inline(always)]
fn ball_push<M: Machine>(k: &M, t: &Tables, m: M::I) -> Vec3<M::R> {
    along_ball(k, t, m, motion::PUSH)
}

/// A field of the three motions of a ball.
#[inline(always)]
fn along_ball<M: Machine>(k: &M, t: &Tables, m: M::I, field: usize) -> Vec3<M::R> {
    Vec3::new(
        k.load(t.motion, m, field),
        k.load(t.motion, m.offset(1), field),
        k.load(t.motion, m.offset(2), field),
    )
}

#[inline(always)]
fn store_ball<M: Machine>(k: &mut M, t: &Tables, m: M::I, push: Vec3<M::R>, give: M::R) {
    for (i, push) in push.to_array().into_iter().enumerate() {
        k.write(t.motion, m.offset(i), motion::PUSH, [push, give]);
    }
}

/// Holds the laws at their bounds that the pass took beyond. Returns where none changed.
#[inline(always)]
pub(crate) fn hold<M: Machine>(k: &mut M, t: &Tables, h: M::R) -> <M::R as Real>::Mask {
    let (zero, h2) = (M::R::zero(), h.squared());
    let mut changes = k.cell(zero);
    for law in k.count(t.laws.laws) {
        let next = next(k, t, law, h);
        let [low, high] = k.read(t.laws.law, law, law::BOUNDS);
        let [was, before] = k.read(t.laws.law, law, law::HELD);
        let bound = next.clamp(h2 * low, h2 * high);
        let held = M::R::select(bound.same(next), zero, M::R::one());
        let bound = M::R::select(held.gt(zero), bound, zero);
        k.write(t.laws.law, law, law::HELD, [held, bound]);
        let change = (held - was).abs().max((bound - before).abs());
        changes.write(changes.read().max(change));
    }
    for i in k.count(t.laws.balls) {
        let next = next_ball(k, t, i, h);
        let (size, most) = (next.length(), k.load(t.laws.ball, i, 2) * h2);
        let held = M::R::select(size.gt(most), M::R::one(), zero);
        let was = k.load(t.laws.ball_law, i, ball_law::HELD);
        // It points as the drive does before the pass: what passes find hangs on what else is held, and where a pass is done
        // again it must not change.
        let lead = k.vec3(t.laws.ball_law, i, ball_law::LEAD);
        let wanted = lead + k.vec3(t.laws.ball_law, i, ball_law::MULTIPLIER);
        let bound = wanted * (most / wanted.length().max(M::R::lit(1e-30)));
        k.store(t.laws.ball_law, i, ball_law::HELD, held);
        k.store_vec3(t.laws.ball_law, i, ball_law::BOUND, bound);
        changes.write(changes.read().max((held - was).abs()));
    }
    changes.read().same(zero)
}

/// λ of a law after a pass, if it were not held.
#[inline(always)]
fn next<M: Machine>(k: &M, t: &Tables, law: M::I, h: M::R) -> M::R {
    let axis = k.link(t.laws.law_links, law, 0);
    let [pushed, lead] = k.read(t.laws.law, law, law::MULTIPLIER);
    let q = k.load(t.motion, axis, motion::WAY);
    give(k, t, law, h).fnma(q, lead) + pushed
}

/// λ of a ball after a pass, if it were not held.
#[inline(always)]
fn next_ball<M: Machine>(k: &M, t: &Tables, i: M::I, h: M::R) -> Vec3<M::R> {
    let r = &t.laws;
    let m = k.link(r.ball_links, i, 2);
    let way = along_ball(k, t, m, motion::WAY);
    let lead = k.vec3(r.ball_law, i, ball_law::LEAD);
    let pushed = k.vec3(r.ball_law, i, ball_law::MULTIPLIER);
    let [give, _] = ball_give(k, t, i, h);
    way.fma(-give, lead) + pushed
}

/// Keeps the λ of a pass for the next one.
#[inline(always)]
pub(crate) fn keep<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let zero = M::R::zero();
    for law in k.count(t.laws.laws) {
        let [held, bound] = k.read(t.laws.law, law, law::HELD);
        let next = M::R::select(held.gt(zero), bound, next(k, t, law, h));
        k.store(t.laws.law, law, law::MULTIPLIER, next);
    }
    for i in k.count(t.laws.balls) {
        let held = k.load(t.laws.ball_law, i, ball_law::HELD).gt(zero);
        let bound = k.vec3(t.laws.ball_law, i, ball_law::BOUND);
        let next = Vec3::select(held, bound, next_ball(k, t, i, h));
        k.store_vec3(t.laws.ball_law, i, ball_law::MULTIPLIER, next);
        let way = along_ball(k, t, k.link(t.laws.ball_links, i, 2), motion::WAY);
        let lead = k.vec3(t.laws.ball_law, i, ball_law::DAMPING);
        let [_, give] = ball_give(k, t, i, h);
        let next = way.fma(-give, lead) + k.vec3(t.laws.ball_law, i, ball_law::DAMPED);
        k.store_vec3(t.laws.ball_law, i, ball_law::DAMPED, next);
    }
}

/// One pass over all couplings.
#[inline(always)]
pub(crate) fn couplings<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    for i in k.count(t.laws.couplings) {
        solve_coupling(k, t, i, h);
    }
}

/// Follows a jump of a ball's target with its control time.
#[inline(always)]
pub(crate) fn smooth_balls<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let r = &t.laws;
    for i in k.count(r.balls) {
        let v = k.link(r.ball_links, i, 1);
        let share = h / (k.load(r.ball, i, 3) + h);
        let now = k.quat(r.ball_target, i, 0);
        let target = Quat::exp(k.vec3(t.input.target_position, v, 0));
        let next = now * Quat::exp((now.conjugate() * target).log() * share);
        k.store_quat(r.ball_target, i, 0, next.normalized());
    }
}

/// One rigid row over two joints: θ − offset − ratio θ_other = 0, while both act.
///
/// The bodies of both joints are weighed as if none were shared; where one is,
/// the row converges over iterations and substeps instead of at once.
#[inline(always)]
fn solve_coupling<M: Machine>(k: &mut M, t: &Tables, i: M::I, h: M::R) {
    let r = &t.laws;
    let (one, other) = (
        k.link(r.coupling_links, i, 0),
        k.link(r.coupling_links, i, 1),
    );
    let [ratio, offset] = k.read(r.coupling, i, 0);
    let (end, weight) = reach(k, t, one, h);
    let (other_end, other_weight) = reach(k, t, other, h);
    let c = end - offset - ratio * other_end;
    let acts = enabled(k, t, one) * enabled(k, t, other);
    let weight = ratio.squared().fma(other_weight, weight);
    let lambda = -(acts * c / weight.max(M::R::lit(1e-30)));
    pull_axis(k, t, one, lambda, h);
    pull_axis(k, t, other, -(ratio * lambda), h);
}

/// 1 for an axis of a joint that acts, else 0.
#[inline(always)]
fn enabled<M: Machine>(k: &M, t: &Tables, axis: M::I) -> M::R {
    let joint = k.link(t.axis_links, axis, axis_link::JOINT);
    k.load(t.joint, joint, joint_field::ENABLED)
}

/// Where an axis's coordinate will be at the end of the substep, and its inverse mass.
#[inline(always)]
fn reach<M: Machine>(k: &M, t: &Tables, axis: M::I, h: M::R) -> (M::R, M::R) {
    let ends = Ends::load(k, t, k.link(t.axis_links, axis, axis_link::JOINT));
    let pull = Pull::load(k, t, axis);
    let end = h.fma(pull.rate(&ends), k.load(t.axis, axis, axis_field::VALUE));
    (end, pull.weight(&ends))
}

#[inline(always)]
fn pull_axis<M: Machine>(k: &mut M, t: &Tables, axis: M::I, lambda: M::R, h: M::R) {
    let j = k.link(t.axis_links, axis, axis_link::JOINT);
    let mut ends = Ends::load(k, t, j);
    let pull = Pull::load(k, t, axis);
    let [moved_a, moved_b] = pull.push(&mut ends, lambda, h.recip());
    ends.store(k, t);
    let sum = k.spatial(t.moved, ends.row_a, 0) + moved_a;
    k.store_spatial(t.moved, ends.row_a, 0, sum);
    let sum = k.spatial(t.moved, ends.row_b, 0) + moved_b;
    k.store_spatial(t.moved, ends.row_b, 0, sum);
}

impl LawTables {
    /// Adds ½ m θ̇² of the armatures and ½ k (θ − rest)² of the springs. Needs all axes measured.
    #[inline(always)]
    pub(crate) fn energies<M: Machine>(
        &self,
        k: &M,
        t: &Tables,
        kinetic: &mut M::Cell,
        potential: &mut M::Cell,
    ) {
        let half = M::R::lit(0.5);
        let [springs, .., armatures, _] = self.starts;
        for i in k.count(self.springs) {
            let axis = k.link(self.law_links, i.offset(springs), 0);
            let stretch = k.load(t.axis, axis, axis_field::VALUE) - k.load(self.spring, i, 2);
            let energy = half * k.load(self.spring, i, 1) * stretch.squared();
            potential.write(potential.read() + energy);
        }
        for i in k.count(self.armatures) {
            let axis = k.link(self.law_links, i.offset(armatures), 0);
            let rate = k.load(t.axis, axis, axis_field::RATE);
            let energy = half * k.load(self.armature, i, 0) * rate.squared();
            kinetic.write(kinetic.read() + energy);
        }
    }
}
