//! Bodies in maximal coordinates: extended position-based dynamics.
//!
//! Macklin, Müller, Chentanez, *XPBD* (2016); Müller et al., *Detailed Rigid Body
//! Simulation with Extended Position Based Dynamics* (2020); Macklin et al., *Small
//! Steps in Physics Simulation* (2019), whose advice is substeps before iterations.
//! A substep of length h, in order:
//!
//! ```text
//! find contacts
//! measure coordinates                         axis
//! v ← v + h g;  x ← x + h v                   body::fly
//! forces on free bodies                       force
//! repeat: contacts                            contact
//!         laws along coordinates, and what
//!         the joints of trees lock, at once   laws, tree
//!         couplings                           laws
//!         loops and distances, as blocks      joint
//! bounces, which change velocities only       contact
//! keep the last state if it diverged          guard
//! ```
//!
//! Where anything with inertia is geared to axes, couplings and loops come before the tree: that ties it to the bodies, and
//! what moved them afterwards would leave it behind.
//!
//! Departures from the sources:
//! - Delta form. Velocities are state, and a position correction Δx also adds Δx/h
//!   to the velocity, instead of v = (x − x_prev)/h at the end, which loses all
//!   precision of f32 as h shrinks.
//! - The rows of a whole tree are solved at once, in linear time. Rows solved one
//!   after the other undo each other in part: a tower of four links on dampers, or
//!   of thirty on springs, then leans over however stiff those are.
//! - The locked rows of any other joint are solved as one block, not along the
//!   residual, which is chaotic.
//! - Free flight conserves angular momentum and turns by the midpoint rate; what joints, couplings
//!   and loops push conserves linear and angular momentum to rounding: see `tree`.
//! - Forces along coordinates act on rates, at the coordinate the substep ends
//!   with, springs at a share of the way there, to first order in h.
//!
//! Limitations: first order in h, as velocities are those of half a substep before; joints that bend
//! by a tenth of a radian and more in a substep lose energy; a joint's linear axes must come
//! before its angular ones, which must meet in a point; coordinates of stacked axes are ill-defined in
//! gimbal lock. Contacts push single
//! bodies, and joints and neighbours pass it on from sweep to sweep: what bears a
//! hundred times its own mass does not come to rest. Of the blows in a row of bodies that touch, only the first is
//! elastic: the row shares it out in that substep (cradles: use `impulse`). A bounce is one of the body that is struck: what
//! joints then take from it is not given back.

mod articulated;
mod axis;
mod body;
mod contact;
mod force;
mod guard;
mod joint;
mod laws;
mod reaction;
mod report;
mod seats;
mod tables;
mod topology;
mod tree;

use crate::contacts::place_shapes;
use crate::{ContactTables, Featherstone, Kernels, Lengths, OutputTables, Settings, SolverError};
use guard::{Survey, guard};
use model::{Model, ShapeId};
use numbers::machine::Index;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Real};
use std::ops::Range;
pub use tables::Tables;
use tables::{NAME, global, motion};

/// The solver, compiled for a model, with contacts or without.
#[derive(Clone, Debug, PartialEq)]
pub struct Xpbd {
    tables: Tables,
    parameters: Vec<f64>,
    links: Vec<u32>,
    contact_shapes: Vec<[ShapeId; 2]>,
    /// Places the bodies for given joint coordinates; loops left open.
    tree: Featherstone,
}

impl Xpbd {
    /// Compiles a model whose bodies pass through each other.
    ///
    /// # Errors
    /// Axes in an order, or a law on a joint, that this solver does not know.
    pub fn new(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        Self::compile(model, false, settings)
    }

    /// Compiles a model whose bodies touch.
    ///
    /// # Errors
    /// As [`new`](Self::new); a shape that no kernel collides.
    pub fn touching(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        Self::compile(model, true, settings)
    }

    fn compile(model: &Model, touching: bool, settings: &Settings) -> Result<Self, SolverError> {
        let (tables, mut filler, contact_shapes) = Tables::new(model, touching, settings)?;
        let numbers = [
            settings.substep(),
            settings.speed_limit,
            settings.relaxation,
            settings.angular_damping,
            crate::tables::bounded(settings.displacement_cap),
            crate::tables::bounded(settings.force_cap),
        ];
        filler.numbers(tables.global, 0, global::STEP, &numbers);
        Ok(Self {
            tables,
            parameters: filler.parameters,
            links: filler.links,
            contact_shapes,
            tree: Featherstone::of_tree(model, settings),
        })
    }
}

impl Xpbd {
    /// Where in the state the bodies are, how they move, and how they did before the last substep.
    fn bodies_in_state(&self) -> [Range<usize>; 3] {
        let Tables {
            rows,
            pose,
            twist,
            before,
            ..
        } = self.tables;
        [
            pose.start()..pose.at(rows, 0),
            twist.start()..twist.at(rows, 0),
            before.start()..before.at(rows, 0),
        ]
    }
}

impl Kernels for Xpbd {
    const TOUCHES: bool = true;
    const MANY_REGISTERS: bool = false;
    fn name(&self) -> &'static str {
        NAME
    }
    fn lengths(&self) -> Lengths {
        Lengths {
            state: self.tables.state_length,
            input: self.tables.input.length,
            output: self.tables.output.length,
            scratch: self.tables.scratch_length,
        }
    }
    fn outputs(&self) -> OutputTables {
        self.tables.output
    }
    fn contact_shapes(&self) -> &[[ShapeId; 2]] {
        &self.contact_shapes
    }
    fn parameters(&self) -> &[f64] {
        &self.parameters
    }
    fn links(&self) -> &[u32] {
        &self.links
    }
    fn alive(&self) -> usize {
        self.tables.alive.at(0, 0)
    }
    fn initial(&self, model: &Model, position: &[f64], velocity: &[f64]) -> Vec<f64> {
        let mut state = vec![0.0; self.tables.state_length];
        state[self.alive()] = 1.0;
        let length = self.tables.global.at(0, global::STEP);
        state[self.tables.led.at(0, 0)] = self.parameters[length];
        state[self.tables.pose.at(0, 6)] = 1.0;
        self.tables.laws.initial(model, &mut state);
        self.tables.kept.initial(&mut state);
        self.place(position, velocity, &mut state);
        state
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        let bodies = self.tree.bodies(position, velocity);
        self.tables
            .place(&bodies, &self.parameters, &self.links, state);
        self.tables
            .count_turns(position, &self.parameters, &self.links, state);
        self.tables.laws.set_speeds(velocity, &self.links, state);
    }
    fn push(&self, position: &[f64], velocities: [&[f64]; 2], state: &mut [f64]) {
        let placed = velocities.map(|velocity| {
            let mut placed = state.to_vec();
            self.place(position, velocity, &mut placed);
            placed
        });
        let [_, twists @ ..] = self.bodies_in_state();
        let speeds = self.tables.laws.speeds();
        for i in twists.into_iter().chain(speeds).flatten() {
            state[i] += placed[1][i] - placed[0][i];
        }
    }
    fn motion(&self) -> Vec<Range<usize>> {
        let Tables {
            axes, angle, laws, ..
        } = self.tables;
        let mut motion = Vec::from(self.bodies_in_state());
        motion.push(angle.start()..angle.at(axes, 0));
        motion.extend(laws.speeds());
        motion
    }
    fn targets(&self) -> Vec<Range<usize>> {
        self.tables.laws.targets()
    }
    /// The bodies' own frames depend on the masses; the turns that were counted stay.
    fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        self.tables
            .place(bodies, &self.parameters, &self.links, state);
    }
    fn contacts(&self) -> Option<&ContactTables> {
        self.tables.touches().then_some(&self.tables.contacts)
    }
    fn stages(&self) -> usize {
        1
    }
    #[inline(always)]
    fn begin<M: Machine>(&self, k: &mut M, _: M::I) {
        let tables = self.tables;
        if tables.touches() {
            let h = k.load(tables.global, k.index(0), global::STEP);
            place_shapes(k, &tables.contacts, &tables, h);
        }
    }
    #[inline(always)]
    fn finish<M: Machine>(&self, k: &mut M, _: M::I) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let tables = self.tables;
        substep(k, &tables);
    }
    #[inline(always)]
    fn report_joints<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::joints(k, &tables);
    }
    #[inline(always)]
    fn report_motion<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::motion(k, &tables);
    }
    #[inline(always)]
    fn report_contacts<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::contacts(k, &tables);
    }
    #[inline(always)]
    fn report<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::report(k, &tables);
    }
}

#[inline(always)]
fn substep<M: Machine>(k: &mut M, t: &Tables) {
    let h = k.load(t.global, k.index(0), global::STEP);
    clear(k, t);
    reaction::unburden(k, t);
    axis::track(k, t);
    body::fly(k, t, h);
    force::forces(k, t, h);
    laws::smooth_balls(k, t, h);
    laws::prepare(k, t, h);
    let mut survey = Survey::new(k);
    passes(k, t, h, &mut survey);
    k.store(t.led, k.index(0), 0, h);
    laws::follow(k, t);
    guard(k, t, &survey);
}

/// Passes over contacts and joints, and a last round for what bounces. Where there are joints, the
/// first pass lets them pass on what the contacts start with, before these are asked for more.
#[inline(always)]
fn passes<M: Machine>(k: &mut M, t: &Tables, h: M::R, survey: &mut Survey<M>) {
    let touching = t.presses();
    let mut fresh = k.cell(M::R::one());
    if touching {
        contact::meet(k, t, h);
    }
    for round in k.count(t.iterations + usize::from(touching)) {
        let joins = k.less(round, k.index(t.iterations));
        if touching {
            sweeps(k, t, h, round, joins);
        }
        if let Some(_branch) = k.when(joins) {
            if touching {
                contact::drift(k, t, h);
            }
            pass(k, t, h, fresh.read(), survey);
            fresh.write(M::R::zero());
            if touching {
                contact::save(k, t);
            }
        }
    }
    if t.touches() {
        contact::keep(k, t, h);
    }
    if touching {
        survey.repeat(k, t);
    }
}

/// Sweeps over the contacts, before the joints of a round or, where none `joins`, last of all.
#[inline(always)]
fn sweeps<M: Machine>(k: &mut M, t: &Tables, h: M::R, round: M::I, joins: M::Flag) {
    let mut ending = k.cell(M::R::one());
    if let Some(_branch) = k.when(joins) {
        ending.write(M::R::zero());
    }
    if let Some(_branch) = k.when(k.less(k.index(usize::from(t.jointed)), round.offset(1))) {
        contact::sweeps(k, t, h, ending.read());
    }
}

/// One pass over everything that binds; `fresh` is 1 in the first one of a substep, else 0.
#[inline(always)]
fn pass<M: Machine>(k: &mut M, t: &Tables, h: M::R, fresh: M::R, survey: &mut Survey<M>) {
    // A loop, so that what closes is compiled once, though it comes before or after the trees.
    for last in [false, true] {
        if t.closes() && last != t.closes_first() {
            close(k, t, h);
            if last {
                survey.repeat(k, t);
            } else {
                body::arms(k, t);
            }
        }
        if !last {
            relax(k, t, h, fresh, survey);
        }
    }
    if t.iterations > 1 {
        laws::keep(k, t, h);
        if !t.closes_first() {
            body::arms(k, t);
        }
    }
}

/// The trees, with the laws along their coordinates, and what is geared to these.
#[inline(always)]
fn relax<M: Machine>(k: &mut M, t: &Tables, h: M::R, fresh: M::R, survey: &mut Survey<M>) {
    laws::lead(k, t, h);
    reaction::uncap(k, t);
    for _ in k.count(laws::rounds(t)) {
        laws::gather(k, t, h, fresh);
        tree::tree(k, t, h);
        let settled = laws::hold(k, t, h) & reaction::cap(k, t, h);
        if k.finished(settled) {
            break;
        }
    }
    reaction::count_capped(k, t);
    survey.restart();
    laws::keep_speeds(k, t, h);
    tree::commit(k, t, h, survey);
}

/// Couplings, and what trees leave open. Before the tree where anything is geared to axes, which the tree ties to the
/// bodies: if loops then moved these on, it would swing.
#[inline(always)]
fn close<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    body::inverse_inertias(k, t);
    laws::couplings(k, t, h);
    joint::closings(k, t, h);
}

/// Nothing has been pushed yet, and the world stands. What only one pass of the tree pushes, that overwrites.
#[inline(always)]
fn clear<M: Machine>(k: &mut M, t: &Tables) {
    let world = k.index(0);
    k.store_pose(t.saved_pose, world, 0, Pose::identity());
    if t.presses() {
        k.store_spatial(t.unpushed, world, 0, Spatial::zero());
    }
    for c in k.count(t.closings) {
        k.store_spatial(t.multiplier, c, 0, Spatial::zero());
    }
    if t.sums_moves() {
        for row in k.count(t.rows) {
            k.store_spatial(t.moved, row, 0, Spatial::zero());
        }
    }
    if t.iterations > 1 {
        for m in k.count(t.motions) {
            k.store(t.motion, m, motion::PUSH, M::R::zero());
        }
    }
}
