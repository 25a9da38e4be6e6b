//! What a lane takes of a joint when a step begins.

use super::super::layout::{Impulse, SLEEP_AFTER, State, WORLD};
use super::super::tables::mass;
use super::actuation::{Actuation, Sources, acting, actuate, source};
use super::drive::around;
use super::layout::{Freedom, Ties, dof};
use super::tables::{LAWS, ROWS, axis, joint, law};
use crate::InputTables;
use crate::tables::UNBOUNDED;
use glam::{DQuat, DVec3};
use model::Model;
use numbers::{Cpu, Float, PerWorld};
use std::iter::{repeat, repeat_n};

/// Targets nearer to their goals than this, but for rounding, have reached them [m or rad].
const REACHED: f64 = 1e-6;

/// By so many roundings [rad] a step may turn a target that is a quaternion, besides the way to its goal.
const TURNED: f64 = 16.0;

/// Share of the speed up to which bodies sleep at which nothing creeps.
const LEAST: f64 = 0.02;

/// Steepness of dry friction about rest [s/m or s/rad]: it is full at the inverse of this rate.
const STEEP: f64 = 1e6;

/// What a lane takes of a joint when a step begins, besides what it carries from the step before.
#[derive(Clone, Copy, Debug)]
pub struct Tied {
    /// The first fields of [`joint`].
    pub joint: [f64; joint::CONSTANTS],
    /// The first fields of [`axis`], a row each.
    pub axes: [[f64; axis::CONSTANTS]; ROWS],
    /// Laws with bounds, a row each.
    pub laws: [[[f64; law::WIDTH]; LAWS]; ROWS],
}

/// What determines the force of a law, or along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    Drive,
    Actuator(usize),
    /// It is zero.
    None,
}

impl Freedom {
    /// Of each law with bounds, in their order.
    fn laws(&self) -> impl Iterator<Item = Source> {
        let drive = self.driven.then_some(Source::Drive);
        let none = 2 * usize::from(self.limited) + usize::from(self.rubs);
        let none = repeat_n(Source::None, none);
        drive.into_iter().chain(none).chain(self.actuators(true))
    }
    /// Actuators with a force range, or those without.
    fn actuators(&self, bounded: bool) -> impl Iterator<Item = Source> {
        let motors = self.motors.iter().filter(move |motor| motor.1 == bounded);
        motors.map(|motor| Source::Actuator(motor.0))
    }
    /// How many laws with bounds act along it.
    pub(super) fn count_laws(&self) -> usize {
        self.laws().count()
    }
}

/// What determines the forces along these rows.
pub(super) fn sources(freedoms: &[Option<Freedom>; ROWS]) -> Sources {
    let freedoms = freedoms.each_ref();
    Sources {
        laws: freedoms.map(|f| f.as_ref().map_or(0, Freedom::count_laws)),
        free: freedoms.map(|f| f.as_ref().map_or(0, |f| f.actuators(false).count())),
    }
}

/// What acts along a row before a controller does: one passive law, and those with bounds.
struct Forces {
    /// Stiffness, damping, force at the reference, armature.
    passive: [f64; 4],
    laws: [[f64; law::WIDTH]; LAWS],
    count: usize,
}

impl Forces {
    /// Stiffness, damping, rest; bounds.
    fn bounded(&mut self, [k, d, rest]: [f64; 3], [low, high]: [f64; 2]) {
        self.laws[self.count] = [k, d, rest, 0.0, low, high, 0.0, 0.0];
        self.count += 1;
    }
    fn stop(&mut self, [k, d, end, inertia]: [f64; 4], [low, high]: [f64; 2]) {
        self.laws[self.count] = [k, d, end, 0.0, low, high, 1.0, inertia];
        self.count += 1;
    }
}

/// Constants of a world.
pub(super) struct Constants<'a, T> {
    pub ties: &'a Ties,
    pub parameters: &'a [T],
}

impl<T: Float> Constants<'_, T> {
    /// Those of a row.
    pub fn dof(&self, tie: usize, row: usize) -> [f64; dof::WIDTH] {
        let at = self.ties.dofs.at(ROWS * tie + row, 0);
        std::array::from_fn(|i| self.parameters[at + i].to_f64())
    }
    /// All that damps a row [N·s/m or N·m·s/rad].
    fn damping(&self, freedom: &Freedom, x: &[f64; dof::WIDTH]) -> f64 {
        let drive = if freedom.driven {
            x[dof::DRIVE + 1]
        } else {
            0.0
        };
        let motors = freedom.motors.iter().map(|&(i, _)| {
            let [gear, _, _, _, b2, ..] = self.motor(i);
            -b2 * gear * gear
        });
        x[dof::DAMPING] + drive + motors.sum::<f64>()
    }
    fn motor(&self, i: usize) -> [f64; 9] {
        let at = self.ties.motors.at(i, 0);
        std::array::from_fn(|field| self.parameters[at + field].to_f64())
    }
    /// The share of the stiffness along a row that acts.
    pub fn stiffness_that_acts(&self, freedom: &Freedom, x: &[f64; dof::WIDTH]) -> f64 {
        let drive = if freedom.driven { x[dof::DRIVE] } else { 0.0 };
        let motors = freedom.motors.iter().map(|&(i, _)| self.pulls(i));
        let all = x[dof::STIFFNESS] + drive + motors.sum::<f64>();
        if all > x[dof::STIFFEST] {
            x[dof::STIFFEST] / all
        } else {
            1.0
        }
    }
    /// Stiffness of an actuator.
    fn pulls(&self, i: usize) -> f64 {
        let [gear, _, _, b1, ..] = self.motor(i);
        -b1 * gear * gear
    }
    /// What acts along a row.
    fn forces(&self, freedom: &Freedom, x: &[f64; dof::WIDTH]) -> Forces {
        let acts = self.stiffness_that_acts(freedom, x);
        let reference = x[dof::REFERENCE];
        let stiffness = acts * x[dof::STIFFNESS];
        let force = stiffness * (x[dof::REST] - reference);
        let damping = x[dof::DAMPING] - x[dof::EARLY] * stiffness;
        let mut forces = Forces {
            passive: [stiffness, damping, force, x[dof::ARMATURE]],
            laws: [[0.0; law::WIDTH]; LAWS],
            count: 0,
        };
        if freedom.driven {
            let [k, d, effort] = [0, 1, 2].map(|i| x[dof::DRIVE + i]);
            let k = acts * k;
            // Its rest follows the target.
            forces.bounded([k, d - x[dof::EARLY] * k, 0.0], [-effort, effort]);
        }
        if freedom.limited {
            let [lower, upper, k, d, m] = [0, 1, 2, 3, 4].map(|i| x[dof::LIMIT + i]);
            forces.stop([k, d, lower - reference, m], [0.0, UNBOUNDED]);
            forces.stop([k, d, upper - reference, m], [-UNBOUNDED, 0.0]);
        }
        if freedom.rubs {
            let most = x[dof::FRICTION];
            forces.bounded([0.0, STEEP * most, 0.0], [-most, most]);
        }
        for &(i, limited) in &freedom.motors {
            let [gear, _, _, _, b2, _, _, least, most] = self.motor(i);
            let (k, d) = (acts * self.pulls(i), -b2 * gear * gear);
            let d = d - x[dof::EARLY] * k;
            if limited {
                let (a, b) = (gear * least, gear * most);
                forces.bounded([k, d, -reference], [a.min(b), a.max(b)]);
            } else {
                let [stiffness, damping, all, _] = &mut forces.passive;
                *stiffness += k;
                *damping += d;
                *all -= k * reference;
            }
        }
        forces
    }
    /// Constants of a law or an actuator, as [`actuate`] reads them.
    fn source(&self, tie: usize, row: usize, source: Source) -> [f64; source::WIDTH] {
        match source {
            Source::None => [0.0; source::WIDTH],
            Source::Drive => {
                let damping = self.dof(tie, row)[dof::DRIVE + 1];
                [0.0, 0.0, 0.0, 0.0, 0.0, damping]
            }
            Source::Actuator(i) => {
                let [gear, gain, bias, pulls, _, low, high, ..] = self.motor(i);
                let freedom = self.ties.list[tie].freedoms[row].as_ref();
                // What a servo that pulls less goes to is what it was.
                let acts = freedom.filter(|_| pulls != 0.0).map_or(1.0, |freedom| {
                    self.stiffness_that_acts(freedom, &self.dof(tie, row))
                });
                [gear, acts * gain, acts * bias, low, high, 0.0]
            }
        }
    }
}

/// What a controller gives a world.
struct Controls<'a, T> {
    tables: &'a InputTables,
    input: &'a [T],
}

impl<T: Float> Controls<'_, T> {
    fn force(&self, dof: usize) -> f64 {
        self.input[self.tables.force.at(dof, 0)].to_f64()
    }
    fn target(&self, dof: usize) -> f64 {
        self.input[self.tables.target_position.at(dof, 0)].to_f64()
    }
    fn target_velocity(&self, dof: usize) -> f64 {
        self.input[self.tables.target_velocity.at(dof, 0)].to_f64()
    }
    fn control(&self, actuator: usize) -> f64 {
        self.input[self.tables.control.at(actuator, 0)].to_f64()
    }
}

impl Impulse {
    fn constants<'a, T>(&'a self, parameters: &'a [T]) -> Constants<'a, T> {
        let ties = &self.ties;
        Constants { ties, parameters }
    }
    fn controls<'a, T>(&'a self, input: &'a [T]) -> Controls<'a, T> {
        let tables = &self.input;
        Controls { tables, input }
    }

    /// The share of the stiffness along each degree of freedom of a model that acts, by this solver's own constants: springs,
    /// drives and servos of a joint that shares a body are together no stiffer than small steps resolve.
    pub fn acting(&self, model: &Model) -> Vec<f64> {
        let given = self.constants(self.parameters());
        let mut shares = vec![1.0; model.degrees_of_freedom()];
        for (i, tie) in self.ties.list.iter().enumerate() {
            for (row, freedom) in tie.freedoms.iter().enumerate() {
                if let Some(freedom) = freedom {
                    let x = given.dof(i, row);
                    shares[freedom.dof] = given.stiffness_that_acts(freedom, &x);
                }
            }
        }
        shares
    }

    /// What determines the forces along a joint's axes.
    pub fn sources(&self, tie: usize) -> Sources {
        self.ties.list[tie].sources
    }
    /// What a lane takes of a joint, but for what controls make of it.
    pub fn tied_constants<T: Float>(&self, tie: usize, parameters: &[T]) -> Tied {
        let given = self.constants(parameters);
        let constants = &parameters[self.ties.constants.at(tie, 0)..];
        let mut tied = Tied {
            joint: std::array::from_fn(|i| constants[i].to_f64()),
            axes: [[0.0; axis::CONSTANTS]; ROWS],
            laws: [[[0.0; law::WIDTH]; LAWS]; ROWS],
        };
        for (row, freedom) in self.ties.list[tie].freedoms.iter().enumerate() {
            let Some(freedom) = freedom else { continue };
            let x = given.dof(tie, row);
            let forces = given.forces(freedom, &x);
            let acts = forces.count > 0 || forces.passive != [0.0; 4];
            let [k, d, force, armature] = forces.passive;
            let time = if freedom.driven {
                x[dof::DRIVE + 3]
            } else {
                -1.0
            };
            let [acts, turns] = [acts, freedom.turns].map(|x| f64::from(u8::from(x)));
            tied.axes[row] = [
                acts,
                k,
                d,
                force,
                armature,
                0.0,
                time,
                x[dof::REFERENCE],
                turns,
            ];
            tied.laws[row] = forces.laws;
        }
        tied
    }
    /// What a lane takes of a joint.
    pub fn tied<T: Float>(
        &self,
        tie: usize,
        parameters: &[T],
        input: &[T],
        actuators: &mut Actuators,
    ) -> Tied {
        let mut tied = self.tied_constants(tie, parameters);
        actuators.act(self, tie, (parameters, input), &mut tied);
        tied
    }

    /// Constants of [`actuate`] for a joint with these [constants](Self::tied_constants), with room for these.
    pub fn actuation_constants<T: Float>(
        &self,
        (tie, tied): (usize, &Tied),
        room: &Sources,
        parameters: &[T],
        mut give: impl FnMut(f64),
    ) {
        let constants = self.constants(parameters);
        for axis in &tied.axes {
            give(axis[axis::FORCE]);
            give(axis[axis::ACTS]);
        }
        self.all_sources(tie, room, |row, source| {
            let numbers = constants.source(tie, row, source);
            numbers.into_iter().for_each(&mut give);
        });
    }
    /// What a controller gives a joint, as [`actuate`] reads it.
    pub fn actuation_controls<T: Float>(
        &self,
        tie: usize,
        room: &Sources,
        input: &[T],
        mut give: impl FnMut(f64),
    ) {
        let controls = self.controls(input);
        for freedom in &self.ties.list[tie].freedoms {
            let of = |freedom: &Freedom| {
                let dof = freedom.dof;
                let [force, target] = [controls.force(dof), controls.target(dof)];
                [force, target, controls.target_velocity(dof)]
            };
            let numbers = freedom.as_ref().map_or([0.0; 3], of);
            numbers.into_iter().for_each(&mut give);
        }
        self.all_sources(tie, room, |_, source| match source {
            Source::Actuator(i) => give(controls.control(i)),
            _ => give(0.0),
        });
    }
    /// All laws and actuators of a joint, each with its row, and as many more as there is room for.
    fn all_sources(&self, tie: usize, room: &Sources, mut give: impl FnMut(usize, Source)) {
        let freedoms = self.ties.list[tie].freedoms.iter().enumerate();
        let none = || repeat(Source::None);
        for (row, freedom) in freedoms.clone() {
            let laws = freedom.iter().flat_map(Freedom::laws);
            let laws = laws.chain(none()).take(room.laws[row]);
            laws.for_each(|source| give(row, source));
        }
        for (row, freedom) in freedoms {
            let free = freedom.iter().flat_map(|f| f.actuators(false));
            let free = free.chain(none()).take(room.free[row]);
            free.for_each(|source| give(row, source));
        }
    }

    /// Whether a controller moves a joint, or what it has set has not been reached; in steps, or parts of steps, of this
    /// length [s].
    pub fn stirs<T: Float>(
        &self,
        tie: usize,
        state: &State<'_, T>,
        input: &[T],
        long: f64,
    ) -> bool {
        let given = self.controls(input);
        let all = &self.ties.list[tie];
        let mut freedoms = all.freedoms.iter().enumerate();
        all.solved
            && freedoms.any(|(row, freedom)| {
                let Some(f) = freedom else { return false };
                let pushed = given.force(f.dof) != 0.0;
                let controlled = f.motors.iter().any(|m| given.control(m.0) != 0.0);
                let runs = f.driven && given.target_velocity(f.dof) != 0.0;
                let away = f.driven && self.is_away([tie, row], f, state, &given, long);
                pushed || controlled || runs || away
            })
    }
    /// Whether the drive of a row has not yet come to its goal, as near as it gets: a step adds a share of what is left,
    /// which in the end is less than a rounding.
    fn is_away<T: Float>(
        &self,
        [tie, row]: [usize; 2],
        freedom: &Freedom,
        state: &State<'_, T>,
        given: &Controls<'_, T>,
        long: f64,
    ) -> bool {
        let targets = self.carried(tie, state.state);
        let number = |i: usize| targets[i].to_f64();
        let (left, now, goal) = if self.ties.list[tie].ball {
            let first = freedom.dof - row;
            let goal = DVec3::from_array([0, 1, 2].map(|i| given.target(first + i)));
            let now = DQuat::from_array([0, 1, 2, 3].map(number));
            let left = now.conjugate() * DQuat::from_scaled_axis(goal);
            // The angle, whatever the quaternion's length.
            let left = 2.0 * left.xyz().length().atan2(left.w.abs());
            (left, TURNED, goal.length())
        } else {
            let (now, goal) = (number(row), given.target(freedom.dof));
            let left = around(goal - now, freedom.turns).abs();
            (left, now.abs(), goal.abs())
        };
        let rounding = if T::DOUBLE {
            f64::EPSILON
        } else {
            f32::EPSILON.into()
        };
        let time = self.constants(state.parameters).dof(tie, row)[dof::DRIVE + 3];
        let share = long / (time + long);
        left > REACHED + rounding * (now / share + goal)
    }
}

impl Impulse {
    /// Whether a joint creeps, held by what damps it: a force that goes on moves it. Its bodies, which reach so far [m],
    /// have been slower than `slow` [m/s] for [`SLEEP_AFTER`]; what damps a row would have left of that, in one implicit
    /// step,
    ///
    /// ```text
    /// slow / (1 + d T / (J + armature))      J = m R² of the lighter body, or m along an axis
    /// ```
    ///
    /// What is slower than a fiftieth of `slow` may be rounding, far from the origin.
    pub fn creeps<T: Float>(
        &self,
        tie: usize,
        state: &State<'_, T>,
        reaches: [f64; 2],
        slow: f64,
    ) -> bool {
        let all = &self.ties.list[tie];
        let constants = self.constants(state.parameters);
        let rates = &state.state[self.tied_rates(tie)];
        let bodies = all.rows.into_iter().zip(reaches);
        let bodies = bodies.filter(|(row, _)| *row != WORLD).map(|(row, reach)| {
            let mass = self.mass_of(row as usize, state.parameters)[mass::MASS];
            (mass.to_f64(), reach)
        });
        let mut freedoms = all.freedoms.iter().enumerate();
        freedoms.any(|(row, freedom)| {
            let Some(freedom) = freedom else { return false };
            let x = constants.dof(tie, row);
            let damping = constants.damping(freedom, &x);
            let rate = rates[row].to_f64().abs();
            bodies.clone().any(|(mass, reach)| {
                let arm = if row < 3 { reach } else { 1.0 };
                let inertia = mass * arm * arm + x[dof::ARMATURE];
                let left = slow / (1.0 + damping.max(0.0) * SLEEP_AFTER / inertia);
                damping > 0.0 && rate * arm > left.max(LEAST * slow)
            })
        })
    }
}

/// Runs [`actuate`] on the processor, in double precision.
#[derive(Debug, Default)]
pub struct Actuators {
    given: Vec<f64>,
    constants: Vec<f64>,
    made: Vec<f64>,
}

impl Actuators {
    /// Adds to what a lane takes of a joint what controls make of it.
    fn act<T: Float>(
        &mut self,
        impulse: &Impulse,
        tie: usize,
        (parameters, input): (&[T], &[T]),
        tied: &mut Tied,
    ) {
        let sources = impulse.sources(tie);
        let t = Actuation::new(&sources);
        self.given.clear();
        self.constants.clear();
        self.made.resize(t.lengths[2], 0.0);
        let (given, constants) = (&mut self.given, &mut self.constants);
        impulse.actuation_controls(tie, &sources, input, |x| given.push(x));
        impulse.actuation_constants((tie, &*tied), &sources, parameters, |x| constants.push(x));
        let mut k = Cpu {
            state: &mut [],
            input: given,
            output: &mut self.made,
            scratch: &mut [],
            parameters: PerWorld(constants),
            links: &sources.links(),
        };
        actuate(&mut k, &t);
        let mut laws = self.made[t.law.start()..].iter();
        for row in 0..ROWS {
            let made = |field| self.made[t.axis.at(row, field)];
            let axis = &mut tied.axes[row];
            axis[axis::ACTS] = made(acting::ACTS);
            axis[axis::FORCE] = made(acting::FORCE);
            axis[axis::GOAL] = made(acting::GOAL);
            let own = tied.laws[row][..sources.laws[row]].iter_mut();
            own.zip(&mut laws)
                .for_each(|(law, force)| law[law::FORCE] = *force);
        }
    }
}
