//! Bodies in maximal coordinates: extended position-based dynamics.
//!
//! Macklin, Müller, Chentanez, *XPBD* (2016); Müller et al., *Detailed Rigid Body
//! Simulation with Extended Position Based Dynamics* (2020); Macklin et al., *Small
//! Steps in Physics Simulation* (2019), whose advice is substeps before iterations.
//! A substep of length h, in order:
//!
//! ```text
//! measure coordinates; apply forces           axis, force
//! v ← v + h g;  x ← x + h v                   body::fly
//! repeat: laws along coordinates              laws
//!         what joints lock, as blocks         joint
//! ```
//!
//! Departures from the sources:
//! - Delta form. Velocities are state, and a position correction Δx also adds Δx/h
//!   to the velocity, instead of v = (x − x_prev)/h at the end, which loses all
//!   precision of f32 as h shrinks.
//! - A joint's locked rows are solved as one block, not along the residual, which
//!   is chaotic.
//! - Free flight conserves angular momentum and turns by the midpoint rate.
//! - Forces along coordinates act on rates, at the coordinate the substep ends
//!   with, to first order in h.
//!
//! Limitations: a drive's damping alone, however stiff, does not hold a chain upright
//! for long, since the locks, solved after the laws, undo part of them in each pass
//! (a position target does, with enough substeps); first order in h; energy is lost at the rate of h; a joint's
//! linear axes must come before its angular ones, which must meet in a point;
//! coordinates of stacked axes are ill-defined in gimbal lock.

mod axis;
mod body;
mod force;
mod joint;
mod laws;
mod report;
mod tables;

use crate::{Featherstone, Kernels, Lengths, Settings, SolverError};
use model::Model;
use numbers::functions::finite;
use numbers::spatial::Spatial;
use numbers::{Cell, Machine, Pose, Quat, Real, Vec3};
pub use tables::Tables;
use tables::global;

/// Positions beyond this are taken for diverged [m].
const FAR: f64 = 1e9;

/// The solver, compiled for a model.
#[derive(Clone, Debug, PartialEq)]
pub struct Xpbd {
    tables: Tables,
    iterations: usize,
    capped: bool,
    parameters: Vec<f64>,
    links: Vec<u32>,
    /// Places the bodies for given joint coordinates; loops left open.
    tree: Featherstone,
}

impl Xpbd {
    /// Compiles a model.
    ///
    /// # Errors
    /// Axes in an order, or a law on a joint, that this solver does not know.
    pub fn new(model: &Model, settings: &Settings) -> Result<Self, SolverError> {
        let (tables, mut filler) = Tables::new(model)?;
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
            iterations: settings.iterations,
            capped: settings.displacement_cap.is_finite() || settings.force_cap.is_finite(),
            parameters: filler.parameters,
            links: filler.links,
            tree: Featherstone::of_tree(model, settings),
        })
    }
}

impl Kernels for Xpbd {
    fn name(&self) -> &'static str {
        "xpbd"
    }
    fn lengths(&self) -> Lengths {
        Lengths {
            state: self.tables.state_length,
            input: self.tables.input.length,
            output: self.tables.output.length,
            scratch: self.tables.scratch_length,
        }
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
        state[self.tables.pose.at(0, 6)] = 1.0;
        self.tables.laws.initial(model, &mut state);
        self.place(position, velocity, &mut state);
        state
    }
    fn place(&self, position: &[f64], velocity: &[f64], state: &mut [f64]) {
        let bodies = self.tree.bodies(position, velocity);
        self.tables
            .place(&bodies, &self.parameters, &self.links, state);
        self.tables
            .count_turns(position, &self.parameters, &self.links, state);
    }
    /// The bodies' own frames depend on the masses; the turns that were counted stay.
    fn take_over(&self, bodies: &[f64], state: &mut [f64]) {
        self.tables
            .place(bodies, &self.parameters, &self.links, state);
    }
    #[inline(always)]
    fn step<M: Machine>(&self, k: &mut M) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let tables = self.tables;
        substep(k, &tables, self.iterations, self.capped);
    }
    #[inline(always)]
    fn report<M: Machine>(&self, k: &mut M) {
        let tables = self.tables;
        report::report(k, &tables);
    }
}

#[inline(always)]
fn substep<M: Machine>(k: &mut M, t: &Tables, iterations: usize, capped: bool) {
    let h = k.load(t.global, k.index(0), global::STEP);
    body::save(k, t);
    for j in k.count(t.joints) {
        k.store_spatial(t.multiplier, j, 0, Spatial::zero());
    }
    axis::track(k, t);
    force::forces(k, t, h);
    body::fly(k, t, h);
    laws::smooth_balls(k, t, h);
    laws::prepare(k, t, h);
    for _ in k.count(iterations) {
        laws::solve(k, t, h);
        joint::joints(k, t, h, capped);
    }
    guard(k, t);
}

/// A lane that has diverged, now or before, keeps its last finite state, and passes on no forces.
#[inline(always)]
fn guard<M: Machine>(k: &mut M, t: &Tables) {
    let world = k.index(0);
    let zero = M::R::zero();
    let mut fastest = k.cell(zero);
    let mut farthest = k.cell(zero);
    let mut sum = k.cell(zero);
    for row in k.count(t.rows) {
        let (pose, twist) = (k.pose(t.pose, row, 0), k.spatial(t.twist, row, 0));
        let (v, w) = (
            twist.linear.length_squared(),
            twist.angular.length_squared(),
        );
        let (far, turned) = (pose.p.length_squared(), pose.q.dot(pose.q));
        fastest.write(fastest.read().max(v).max(w));
        farthest.write(farthest.read().max(far));
        sum.write(sum.read() + ((v + w) + (far + turned)));
    }
    let limit = k.load(t.global, world, global::SPEED_LIMIT);
    let slow = fastest.read().le(limit.squared());
    let near = farthest.read().le(M::R::lit(FAR * FAR));
    let fine = slow & near & finite(sum.read());
    let fine = M::R::select(fine, k.load(t.alive, world, 0), zero);
    k.store(t.alive, world, 0, fine);
    let lost = fine.same(M::R::zero());
    for _ in k.if_any(lost) {
        for row in k.count(t.rows) {
            restore(k, t, row, lost);
        }
        for j in k.count(t.joints) {
            let (none, passed) = (Vec3::zero(), k.spatial(t.multiplier, j, 0));
            let angular = Vec3::select(lost, none, passed.angular);
            let linear = Vec3::select(lost, none, passed.linear);
            k.store_spatial(t.multiplier, j, 0, Spatial::new(angular, linear));
        }
    }
}

#[inline(always)]
fn restore<M: Machine>(k: &mut M, t: &Tables, row: M::I, lost: <M::R as Real>::Mask) {
    let (now, saved) = (k.pose(t.pose, row, 0), k.pose(t.saved_pose, row, 0));
    let p = Vec3::select(lost, saved.p, now.p);
    k.store_pose(
        t.pose,
        row,
        0,
        Pose::new(p, Quat::select(lost, saved.q, now.q)),
    );
    let (now, saved) = (k.spatial(t.twist, row, 0), k.spatial(t.before, row, 0));
    let angular = Vec3::select(lost, saved.angular, now.angular);
    let linear = Vec3::select(lost, saved.linear, now.linear);
    k.store_spatial(t.twist, row, 0, Spatial::new(angular, linear));
}
