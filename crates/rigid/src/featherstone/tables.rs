//! A model as the articulated-body algorithm reads it: its [forest](super::forest) in tables.
//!
//! Each tree has a row of its own for the world, so that a root is no special case; tree 0 is
//! the world alone, and carries what never moves.

use super::closing::ClosingTables;
use super::contact::{law, law_over, load};
use super::couples::Couples;
use super::coupling::CouplingTables;
use super::factor::response;
use super::force::{ForceRows, ForceTables, wrapping};
use super::forest::{Forest, along_limbs};
use super::friction::rubbing;
use super::gauss_seidel::impulse;
use super::limit::stop;
use super::locked::LockedTables;
use super::turning::{turn, turn_impulse, turn_law, turn_law_over};
use crate::contacts::{ContactPlan, ContactTables, Kept, pair_field};
use crate::implicitness::implicitness;
use crate::lists::Lists;
use crate::locks::Locks;
use crate::output::OutputTables;
use crate::tables::Filler;
use crate::{InputTables, Integrator, Settings, SolverError};
use glam::DQuat;
use model::{Joint, JointKind, Model, ShapeId};
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch, State};
use numbers::{Machine, Real, Table};

/// The solver's name.
pub(crate) const NAME: &str = "featherstone";

/// Kinds of motion.
pub(crate) mod motion {
    pub const REVOLUTE: usize = 0;
    pub const PRISMATIC: usize = 1;
    pub const BALL: usize = 2;
}

/// Fields of [`Tables::node`].
pub(crate) mod node {
    /// Placement in the parent node's frame where all coordinates are at their reference.
    pub const PLACE: usize = 0;
    pub const MASS: usize = 7;
    pub const CENTER: usize = 8;
    /// About the centre, node axes.
    pub const INERTIA: usize = 11;
    /// 1 where contacts go along: on free roots, and on wheels; else 0.
    pub const ROLLS: usize = 17;
    pub const WIDTH: usize = 18;
}

/// Fields of [`Tables::node_links`].
pub(crate) mod node_link {
    pub const PARENT: usize = 0;
    pub const MOTION_BEGIN: usize = 1;
    pub const MOTION_END: usize = 2;
    /// 1 if the node's frame is turned in its parent's where all coordinates are at their reference.
    pub const TURNED: usize = 3;
    /// Number of fields that the pass outwards over placements reads.
    pub const OUTWARDS: usize = 4;
    /// How many others the node carries: see [`carries`](super::carries).
    pub const CARRIES: usize = 4;
    /// When the node's inertia arrives at its parent: see [`arrival`](super::arrival).
    pub const ARRIVAL: usize = 5;
    /// 1 for a root that moves freely in the world, whose six degrees of freedom are solved at once.
    pub const FLOATS: usize = 6;
    /// Row whose acceleration the node's starts from: its parent's, or its own where it floats.
    pub const ACCELERATES_FROM: usize = 7;
    pub const DOF_BEGIN: usize = 8;
    /// Degrees of freedom that are eliminated one by one: all, or none where the node floats.
    pub const ELIMINATED: usize = 9;
    pub const DOF_COUNT: usize = 10;
    /// First slot of the node's contacts with what does not move, and one past the last.
    pub const SLOT_BEGIN: usize = 11;
    pub const SLOT_END: usize = 12;
    /// 1 for a free body, whether its degrees of freedom are eliminated or not: a root that floats and carries no other.
    pub const ALONE: usize = 13;
    /// 1 if the parent is visited just before, on the [way along the limbs](Tables::limb_links).
    pub const FOLLOWS: usize = 14;
    pub const WIDTH: usize = 15;
}

/// Values of [`node_link::ARRIVAL`].
pub(crate) mod arrival {
    /// The parent is the world.
    pub const NONE: usize = 0;
    /// Before its siblings.
    pub const FIRST: usize = 1;
    /// After a sibling.
    pub const LATER: usize = 2;
}

/// Values of [`node_link::CARRIES`].
pub(crate) mod carries {
    pub const NOTHING: usize = 0;
    /// The one that follows it on the [way along the limbs](super::Tables::limb_links).
    pub const ONE: usize = 1;
    /// More, which but for that one are summed up in its row.
    pub const MORE: usize = 2;
}

/// Fields of [`Tables::touch_links`], of the slots between bodies that move.
pub(crate) mod touch_link {
    /// Row of [`Tables::couple_links`](super::Tables).
    pub const COUPLE: usize = 0;
    /// First row of the slot's entries.
    pub const ENTRY: usize = 1;
    pub const WIDTH: usize = 2;
}

/// Fields of [`Tables::couple_links`].
pub(crate) mod couple_link {
    /// Trees of A and B.
    pub const GROUP_A: usize = 0;
    pub const GROUP_B: usize = 1;
    pub const NODE_A: usize = 2;
    pub const NODE_B: usize = 3;
    /// First name of an entry.
    pub const ENTRY_BEGIN: usize = 4;
    /// How many entries A's path inwards has until it meets B's, both have until they meet, and there are with
    /// the path from there.
    pub const OWN_A: usize = 5;
    pub const OWN: usize = 6;
    pub const ENTRIES: usize = 7;
    pub const WIDTH: usize = 8;
}

/// Fields of [`Tables::motion_links`].
pub(crate) mod motion_link {
    pub const KIND: usize = 0;
    pub const COORDINATE: usize = 1;
    pub const DOF: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Fields of [`Tables::step`].
pub(crate) mod step {
    /// h [s].
    pub const TIME: usize = 0;
    /// 1 / h.
    pub const RATE: usize = 1;
    /// Largest speed of a coordinate.
    pub const SPEED_LIMIT: usize = 2;
    pub const WIDTH: usize = 3;
}

/// Fields of [`Tables::body`].
pub(crate) mod body_field {
    // A body's own mass is read as a node's is: the same fields, at the same places.
    pub use super::node::{CENTER, INERTIA, MASS, PLACE};
    /// Origin of the joint's frame on the child, in the body's frame.
    pub const JOINT: usize = super::node::WIDTH;
    pub const WIDTH: usize = JOINT + 3;
}

/// Fields of [`Tables::body_links`].
pub(crate) mod body_link {
    pub const NODE: usize = 0;
    /// Tree the node belongs to.
    pub const TREE: usize = 1;
    /// The body, in the model.
    pub const BODY: usize = 2;
    /// Row of the body that carries this one; its own where the world does.
    pub const CARRIER: usize = 3;
    /// Joint that carries the body; one past the last for a static body.
    pub const JOINT: usize = 4;
    pub const WIDTH: usize = 5;
}

/// Layout of everything the kernels touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tables {
    pub(crate) trees: usize,
    pub(crate) nodes: usize,
    pub(crate) dofs: usize,
    pub(crate) coordinates: usize,
    pub(crate) motions: usize,
    pub(crate) bodies: usize,

    pub(crate) position: Table<State>,
    pub(crate) velocity: Table<State>,
    /// 1 while the world runs, 0 once it diverged.
    pub(crate) alive: Table<State>,
    /// Rows of `recent`: one for each degree of freedom, or none where q̈⁻ is 0.
    pub(crate) recents: usize,
    /// q̈⁻: see [`articulated_body`](super::articulated_body).
    pub(crate) recent: Table<State>,
    pub(crate) forces: ForceTables,
    /// Joints that close loops.
    pub(crate) closings: ClosingTables,
    pub(crate) couplings: CouplingTables,
    /// What both of them lock.
    pub(crate) locked: LockedTables,
    /// The contacts of the last step.
    pub(crate) kept: Kept,
    /// Tangential impedance of each contact of the last step.
    pub(crate) grip: Table<State>,
    /// True if any surfaces resist twisting or rolling on each other.
    pub(crate) grips: bool,
    /// Impedances against twisting and rolling of each contact of the last step with what does not move.
    pub(crate) turning: Table<State, 2>,
    /// Torque of each contact of the last step against twisting and rolling [N·m].
    pub(crate) gripped: Table<State, 3>,
    pub(crate) state_length: usize,

    pub(crate) input: InputTables,
    pub(crate) output: OutputTables,

    /// Gravity, 3.
    pub(crate) world: Table<Parameter, 3>,
    /// See [`step`].
    pub(crate) step: Table<Parameter, { step::WIDTH }>,
    /// Per pair of shapes: see [`law`].
    pub(crate) law: Table<Parameter, { law::WIDTH }>,
    /// The same of twisting and rolling: see [`turn_law`].
    pub(crate) turn_law: Table<Parameter, { turn_law::WIDTH }>,
    /// Runge–Kutta stages: weight, next offset, 1 for the last.
    pub(crate) tableau: Table<Parameter, 3>,
    pub(crate) tree: Table<Parameter, 3>,
    pub(crate) origin: Table<Parameter, 3>,
    pub(crate) node: Table<Parameter, { node::WIDTH }>,
    pub(crate) motion: Table<Parameter, 4>,
    pub(crate) body: Table<Parameter, { body_field::WIDTH }>,
    pub(crate) parameter_length: usize,

    pub(crate) tree_links: Links<2>,
    pub(crate) origin_links: Links,
    pub(crate) node_links: Links<{ node_link::WIDTH }>,
    /// The nodes, each limb to its end, so that most are visited just after their parents.
    pub(crate) limb_links: Links,
    pub(crate) motion_links: Links<{ motion_link::WIDTH }>,
    /// Revolute motions, with their coordinates.
    pub(crate) hinge_links: Links<2>,
    pub(crate) ball_links: Links<2>,
    pub(crate) axis_links: Links<2>,
    /// Coordinates that turn without end; those whose turns nothing counts come first.
    pub(crate) wrap_links: Links,
    pub(crate) body_links: Links<{ body_link::WIDTH }>,
    pub(crate) hinges: usize,
    pub(crate) balls: usize,
    pub(crate) axes: usize,
    pub(crate) wraps: usize,
    pub(crate) link_length: usize,

    /// Origin O of each tree.
    pub(crate) point: Table<Scratch, 3>,
    /// Per motion: sine and cosine of half its angle.
    pub(crate) half_angle: Table<Scratch, 2>,
    /// Per node, and per tree for the world: see [`frame`].
    pub(crate) frame: Table<Scratch, { frame::WIDTH }>,
    /// Per node, where there are contacts: see [`own`].
    pub(crate) own: Table<Scratch, { own::WIDTH }>,
    /// Per degree of freedom: see [`dof`].
    pub(crate) dof: Table<Scratch, { dof::WIDTH }>,
    pub(crate) contacts: ContactTables,
    /// Whether anything that does not move could be got through.
    pub(crate) thin: bool,
    /// Whether things may touch that no joints hold together.
    pub(crate) strangers: bool,
    /// Passes over the contacts.
    pub(crate) passes: usize,
    /// Passes of projected Gauss–Seidel.
    pub(crate) iterations: usize,
    /// Per slot: see [`load`].
    pub(crate) load: Table<Scratch, { load::WIDTH }>,
    /// Per slot of a contact with what does not move: 1 where the point presses.
    pub(crate) on: Table<Scratch>,
    /// Per slot of what does not move: see [`turn`].
    pub(crate) turn: Table<Scratch, { turn::WIDTH }>,
    /// Per slot between bodies that move: see [`turn_impulse`].
    pub(crate) turn_impulse: Table<Scratch, { turn_impulse::WIDTH }>,
    /// As [`entry`](Self::entry), of moments.
    pub(crate) turn_entry: Table<Scratch, 3>,
    /// Per degree of freedom: see [`stop`].
    pub(crate) stop: Table<Scratch, { stop::WIDTH }>,
    /// Per degree of freedom: see [`rubbing`].
    pub(crate) rubbing: Table<Scratch, { rubbing::WIDTH }>,
    /// Rows of the bodies of each slot, that of the shape that its normal points to last; one past
    /// the last body for the world.
    pub(crate) touching_links: Links<2>,
    /// Per slot: see [`touch_link`].
    pub(crate) touch_links: Links<{ touch_link::WIDTH }>,
    /// Per pair of nodes that may touch, or that a joint ties: see [`couple_link`].
    pub(crate) couple_links: Links<{ couple_link::WIDTH }>,
    /// Degree of freedom of each entry of a pair, along the paths inwards: A's own, B's own, then the one they share.
    pub(crate) entry_links: Links,
    /// Per slot between bodies that move: see [`impulse`].
    pub(crate) impulse: Table<Scratch, { impulse::WIDTH }>,
    /// y of the three directions, for each entry of each slot.
    pub(crate) entry: Table<Scratch, 3>,
    /// Per degree of freedom: see [`response`].
    pub(crate) response: Table<Scratch, { response::WIDTH }>,
    /// Per slot between bodies that move: 1 where the contact takes part in the step.
    pub(crate) takes_part: Table<Scratch>,
    /// Friction coefficient of each slot in this step, where any surfaces resist more while they stick.
    pub(crate) cone: Table<Scratch>,
    /// The slots that do.
    pub(crate) acting: Lists,
    /// Wrench of the contacts with other bodies that move, and of what closes loops, per node, and per tree
    /// for the world.
    pub(crate) pressure: Table<Scratch, 6>,
    /// Saved coordinates and velocities.
    pub(crate) saved_position: Table<Scratch>,
    pub(crate) saved_velocity: Table<Scratch>,
    /// Runge–Kutta sums and the stage's increment.
    pub(crate) sum_velocity: Table<Scratch>,
    pub(crate) sum_acceleration: Table<Scratch>,
    pub(crate) increment: Table<Scratch>,
    /// Per body, reporting: wrench about the world's origin. A last row is of the world.
    pub(crate) wrench: Table<Scratch, 6>,
    pub(crate) scratch_length: usize,
}

/// Fields of [`Tables::frame`]: one row, so that one offset serves all that is known of a node.
pub(crate) mod frame {
    /// Position from O, orientation.
    pub const PLACE: usize = 0;
    /// Spatial velocity about O.
    pub const TWIST: usize = 7;
    /// Spatial acceleration about O where every q̈ is q̈⁻, less gravity.
    pub const BIAS: usize = 13;
    /// Articulated bias force of what the node carries.
    pub const FORCE: usize = 19;
    /// Articulated inertia Iᴬ of what the node carries.
    pub const INERTIA: usize = 25;
    /// What impulses add to the acceleration; takes the place of FORCE once that is spent.
    pub const INCREMENT: usize = FORCE;
    /// What the accelerations q̈ − q̈⁻ add to BIAS; takes the place of INERTIA once that is spent.
    pub const ACCELERATION: usize = INERTIA;
    pub const WIDTH: usize = 46;
}

/// Fields of [`Tables::own`]: what a node is by itself, whatever touches it.
pub(crate) mod own {
    /// Moments of mass about O: first, 3, and second, 6.
    pub const FIRST: usize = 0;
    pub const SECOND: usize = 3;
    /// Wrench that moves it where every q̈ is q̈⁻, 6.
    pub const FORCE: usize = 9;
    pub const WIDTH: usize = 15;
}

/// Fields of [`Tables::dof`].
pub(crate) mod dof {
    /// Axis S.
    pub const AXIS: usize = 0;
    /// U = Iᴬ S.
    pub const U: usize = 6;
    /// u = τ − S·p.
    pub const FORCE: usize = 12;
    /// 1 / D; follows u.
    pub const INVERSE: usize = 13;
    /// Acceleration q̈; takes the place of u once that is spent.
    pub const ACCELERATION: usize = FORCE;
    /// Force τ along the axis.
    pub const TAU: usize = 14;
    // Armature, and what of the force opposes q̈, follows TAU.
    pub const WIDTH: usize = 16;
}

/// The classical Runge–Kutta method (Kutta 1901): weight of the stage, offset of
/// the next in steps, and 1 where the next is the sum.
const RUNGE_KUTTA_4: [[f64; 3]; 4] = [
    [1.0 / 6.0, 0.5, 0.0],
    [1.0 / 3.0, 0.5, 0.0],
    [1.0 / 3.0, 1.0, 0.0],
    [1.0 / 6.0, 0.0, 1.0],
];

/// What a solver holds besides the tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scope {
    /// Nothing: loops are left open.
    Tree,
    /// Joints that close loops.
    Loops,
    /// The same, and contacts.
    Contacts,
}

/// Whether a joint is outside the tree.
pub(super) fn closes(joint: &Joint) -> bool {
    joint.closes_loop || joint.kind == JointKind::Distance
}

/// Whether all joints of the tree hold, and do not give way where they lock.
pub(crate) fn is_rigid(model: &Model) -> bool {
    let rigid = |j: &Joint| j.enabled && j.linear_compliance == 0.0 && j.angular_compliance == 0.0;
    model.joints.iter().filter(|j| !closes(j)).all(rigid)
}

/// How many rows joints outside the tree, and couplings, lock; none where a joint's axes are not known here.
pub(crate) fn locked_rows(model: &Model) -> Option<usize> {
    let rows = |joint: &Joint| {
        let (linear, angular) = crate::check::axes(joint, NAME).ok()?;
        let rows = Locks::new(joint, &linear, &angular).rows();
        Some(rows.into_iter().filter(|locked| *locked).count())
    };
    let closings = model.joints.iter().filter(|j| closes(j));
    let rows: Option<usize> = closings.map(rows).sum();
    Some(rows? + model.couplings.len())
}

/// Refuses what reduced coordinates cannot express.
pub(crate) fn check(model: &Model, scope: Scope, settings: &Settings) -> Result<(), SolverError> {
    for joint in &model.joints {
        let name = || joint.name.clone();
        if closes(joint) {
            if scope == Scope::Tree {
                return Err(SolverError::ClosedLoop { joint: name() });
            }
            refuse_integrator(name(), settings)?;
            continue;
        }
        if !joint.enabled {
            return Err(SolverError::DisabledJoint { joint: name() });
        }
        if joint.linear_compliance > 0.0 || joint.angular_compliance > 0.0 {
            return Err(SolverError::Unsupported {
                solver: NAME,
                what: "compliance",
                name: name(),
                remedy: "use the solver `xpbd`, or springs along the axes of a d6 joint",
            });
        }
    }
    if let Some(coupling) = model.couplings.first() {
        let name = || coupling.name.clone();
        if scope == Scope::Tree {
            return Err(SolverError::ClosedLoop { joint: name() });
        }
        refuse_integrator(name(), settings)?;
    }
    crate::check::rotations(model, NAME)
}

/// Loops and couplings hold the positions that semi-implicit Euler arrives at.
fn refuse_integrator(name: String, settings: &Settings) -> Result<(), SolverError> {
    if settings.integrator == Integrator::SemiImplicitEuler {
        return Ok(());
    }
    Err(SolverError::Unsupported {
        solver: NAME,
        what: "another integrator than semi-implicit Euler together with the loop or coupling",
        name,
        remedy: "use that integrator, or the solver `xpbd`",
    })
}

/// Whether a step has forces that depend on its accelerations.
fn guesses(model: &Model, settings: &Settings) -> bool {
    let mut dofs = model.joints.iter().flat_map(|joint| &joint.dofs);
    let hindered = dofs.any(|dof| dof.limit.is_some() || dof.friction_loss > 0.0);
    hindered && settings.integrator == Integrator::SemiImplicitEuler
}

impl Tables {
    /// Lays out a model and fills its parameters and links; with the shapes of each contact.
    ///
    /// # Errors
    /// A shape that no kernel collides, or a loop that nothing can close, where these are in scope.
    pub(crate) fn new(
        model: &Model,
        scope: Scope,
        settings: &Settings,
    ) -> Result<(Self, Filler, Vec<[ShapeId; 2]>), SolverError> {
        let mut forest = Forest::new(model);
        let plan = match scope {
            Scope::Contacts => ContactPlan::new(model, NAME, |shape| forest.carrier(shape.body))?,
            Scope::Tree | Scope::Loops => ContactPlan::empty(),
        };
        let contact_shapes = plan.shapes();
        forest.find_wheels(model, contact_shapes.iter().flatten().copied());
        let (mut closings, mut couplings) = match scope {
            Scope::Tree => Default::default(),
            Scope::Loops | Scope::Contacts => (forest.closings(model)?, forest.couplings(model)),
        };
        let mut couples = Couples::new(&forest, &plan);
        let h = settings.substep();
        forest.tie(model, &mut closings, &mut couplings);
        couples.lock(&forest, model, &mut closings, &mut couplings, h);
        let counts = [closings.len(), couplings.len()];
        let tables = Self::layout(model, &forest, &plan, &couples, counts, settings);
        let mut filler = Filler::new(tables.parameter_length, tables.link_length);
        tables.fill_forest(&forest, &mut filler);
        tables.fill_bodies(model, &forest, &mut filler);
        let implicit = implicitness(model, &forest, h);
        tables.forces.fill(model, h, &implicit, &mut filler);
        tables.contacts.fill(model, &plan, NAME, &mut filler)?;
        tables.fill_step(settings, &mut filler);
        tables.fill_couples(&couples, &mut filler);
        for (row, closing) in closings.iter().enumerate() {
            let joint = &model.joints[closing.joint];
            tables.closings.fill(row, closing, joint, h, &mut filler);
        }
        for (row, locked) in couples.locked.iter().enumerate() {
            tables.locked.fill(row, locked, &mut filler);
        }
        for (row, coupled) in couplings.iter().enumerate() {
            let coupling = &model.couplings[row];
            let t = tables.couplings;
            t.fill(row, coupled, model, coupling, h, &mut filler);
        }
        tables.acting.fill(&[couples.slots.len()], &mut filler);
        for (slot, shapes) in contact_shapes.iter().enumerate() {
            for (side, shape) in shapes.iter().enumerate() {
                let row = forest.row(model.shapes[shape.0].body);
                filler.link(tables.touching_links, slot, side, row);
            }
        }
        for n in 0..forest.nodes.len() {
            let (row, slots) = (tables.trees + n, plan.slots_of(tables.trees + n));
            filler.link(tables.node_links, row, node_link::SLOT_BEGIN, slots.start);
            filler.link(tables.node_links, row, node_link::SLOT_END, slots.end);
        }
        for (row, coordinate) in wrapping(model).enumerate() {
            filler.link(tables.wrap_links, row, 0, coordinate);
        }
        filler.vec3(tables.world, 0, 0, model.gravity);
        for (stage, row) in RUNGE_KUTTA_4.iter().enumerate() {
            filler.numbers(tables.tableau, stage, 0, row);
        }
        Ok((tables, filler, contact_shapes))
    }

    fn fill_step(&self, settings: &Settings, f: &mut Filler) {
        let h = settings.substep();
        f.numbers(self.step, 0, 0, &[h, h.recip(), settings.speed_limit]);
        for pair in 0..self.contacts.pairs() {
            let from = self.contacts.pair.at(pair, pair_field::FRICTION);
            let numbers = f.parameters[from..].first_chunk().expect("a row of a pair");
            let fastest = f.parameters[self.contacts.pair.at(pair, pair_field::FASTEST)];
            let sticking = f.parameters[self.contacts.pair.at(pair, pair_field::STICKING)];
            let law = law_over(*numbers, [fastest, sticking], h);
            f.numbers(self.law, pair, 0, &law);
            if self.grips {
                let from = self.contacts.pair.at(pair, pair_field::TORSION);
                let coefficients = [f.parameters[from], f.parameters[from + 1]];
                let inertia = f.parameters[self.contacts.pair.at(pair, pair_field::INERTIA)];
                let numbers = turn_law_over(coefficients, inertia, h);
                f.numbers(self.turn_law, pair, 0, &numbers);
            }
        }
    }

    /// q̈⁻ of a degree of freedom.
    #[inline(always)]
    pub(crate) fn before<M: Machine>(&self, k: &M, v: M::I) -> M::R {
        if self.recents > 0 {
            k.load(self.recent, v, 0)
        } else {
            M::R::zero()
        }
    }

    /// The same tree, whose limits and friction do not act.
    pub(crate) fn unhindered(&self) -> Self {
        let mut tables = *self;
        (tables.forces.limits, tables.forces.frictions) = (0, 0);
        tables
    }

    /// Whether bodies that move give each other impulses: they may touch, close loops, or be coupled.
    pub(crate) fn exchanges(&self) -> bool {
        let touch = self.contacts.between < self.contacts.sensed;
        touch || self.locked.count > 0
    }

    fn layout(
        model: &Model,
        forest: &Forest,
        plan: &ContactPlan,
        couples: &Couples,
        [closings, couplings]: [usize; 2],
        settings: &Settings,
    ) -> Self {
        let trees = forest.bases.len();
        let nodes = forest.nodes.len();
        let rows = trees + nodes;
        let dofs = model.degrees_of_freedom();
        let coordinates = model.coordinates();
        let all = || forest.nodes.iter().flat_map(|n| &n.motions);
        let motions = all().count();
        let hinges = all().filter(|m| m.kind == motion::REVOLUTE).count();
        let balls = all().filter(|m| m.kind == motion::BALL).count();
        let bodies = model.bodies.len();
        let wraps = wrapping(model).count();

        let (mut s, mut p, mut l, mut t) = (0, 0, 0, 0);
        let position = Table::place(&mut s, coordinates);
        let velocity = Table::place(&mut s, dofs);
        let alive = Table::place(&mut s, 1);
        let forces = ForceTables::place(&ForceRows::count(model), dofs, &mut s, &mut p, &mut l);
        let contacts = ContactTables::place(plan, &mut p, &mut l, &mut t);
        let alone = contacts.slots + closings + couplings == 0;
        let recents = if alone && guesses(model, settings) {
            dofs
        } else {
            0
        };
        let recent = Table::place(&mut s, recents);
        let kept = Kept::place(&mut s, contacts.slots);
        let grip = Table::place(&mut s, contacts.sensed);
        let grips = plan.grips(model);
        let gripping = |rows: usize| if grips { rows } else { 0 };
        let turning = Table::place(&mut s, gripping(contacts.between));
        let gripped = Table::place(&mut s, gripping(contacts.sensed));
        let closings = ClosingTables::place(closings, &mut p, &mut l, &mut t);
        let couplings = CouplingTables::place(couplings, &mut p, &mut l);
        let locked = [couples.rows(), couples.locked_entries];
        let locked = LockedTables::place(locked, &mut s, &mut p, &mut l, &mut t);
        let exchange = couples.exchange();
        let output = OutputTables::new(model).with_contacts(contacts.slots);
        Self {
            trees,
            nodes,
            dofs,
            coordinates,
            motions,
            bodies,
            contacts,
            thin: plan.has_thin(model),
            strangers: plan.has_strangers(),
            passes: if contacts.sensed > 0 {
                settings.contact_passes
            } else {
                1
            },
            // What is locked is solved in the first of them.
            iterations: settings.contact_iterations.max(couples.rows().min(1)),
            closings,
            couplings,
            locked,
            kept,
            grip,
            grips,
            turning,
            gripped,
            position,
            velocity,
            alive,
            recents,
            recent,
            forces,
            state_length: s,
            input: InputTables::new(model),
            output: if grips {
                output.with_contact_torques()
            } else {
                output
            },
            world: Table::place(&mut p, 1),
            step: Table::place(&mut p, 1),
            law: Table::place(&mut p, contacts.pairs()),
            turn_law: Table::place(&mut p, gripping(contacts.pairs())),
            tableau: Table::place(&mut p, 4),
            tree: Table::place(&mut p, trees),
            origin: Table::place(&mut p, coordinates),
            node: Table::place(&mut p, rows),
            motion: Table::place(&mut p, motions),
            body: Table::place(&mut p, bodies),
            parameter_length: p,
            tree_links: Links::place(&mut l, trees),
            origin_links: Links::place(&mut l, coordinates),
            node_links: Links::place(&mut l, rows),
            limb_links: Links::place(&mut l, nodes),
            motion_links: Links::place(&mut l, motions),
            hinge_links: Links::place(&mut l, hinges),
            ball_links: Links::place(&mut l, balls),
            axis_links: Links::place(&mut l, motions - balls),
            wrap_links: Links::place(&mut l, wraps),
            body_links: Links::place(&mut l, bodies),
            hinges,
            balls,
            axes: motions - balls,
            wraps,
            point: Table::place(&mut t, trees),
            half_angle: Table::place(&mut t, motions),
            frame: Table::place(&mut t, rows),
            own: Table::place(&mut t, rows),
            dof: Table::place(&mut t, dofs),
            load: Table::place(&mut t, contacts.sensed),
            on: Table::place(&mut t, contacts.between),
            turn: Table::place(&mut t, gripping(contacts.between)),
            turn_impulse: Table::place(&mut t, gripping(contacts.sensed)),
            turn_entry: Table::place(&mut t, gripping(couples.entries)),
            stop: Table::place(&mut t, dofs),
            rubbing: Table::place(&mut t, forces.frictions),
            touching_links: Links::place(&mut l, contacts.slots),
            touch_links: Links::place(&mut l, contacts.sensed),
            couple_links: Links::place(&mut l, couples.couples.len()),
            entry_links: Links::place(&mut l, couples.names.len()),
            impulse: Table::place(&mut t, contacts.sensed),
            entry: Table::place(&mut t, couples.entries),
            response: Table::place(&mut t, if exchange { dofs } else { 0 }),
            takes_part: Table::place(&mut t, contacts.sensed),
            cone: Table::place(&mut t, if contacts.sticks { contacts.sensed } else { 0 }),
            acting: Lists::place(&[couples.slots.len()], &mut l, &mut t),
            pressure: Table::place(&mut t, if exchange { rows } else { 0 }),
            saved_position: Table::place(&mut t, coordinates),
            saved_velocity: Table::place(&mut t, dofs),
            sum_velocity: Table::place(&mut t, dofs),
            sum_acceleration: Table::place(&mut t, dofs),
            increment: Table::place(&mut t, dofs),
            wrench: Table::place(&mut t, bodies + 1),
            scratch_length: t,
            link_length: l,
        }
    }

    /// Who carries whom, for the pass inwards, which visits the nodes last to first.
    fn fill_arrivals(&self, forest: &Forest, children: &[Vec<usize>], f: &mut Filler) {
        for (i, n) in forest.nodes.iter().enumerate() {
            let arrival = match n.parent {
                None => arrival::NONE,
                Some(parent) if children[parent].last() == Some(&i) => arrival::FIRST,
                Some(_) => arrival::LATER,
            };
            let carries = match children[i].len() {
                0 => carries::NOTHING,
                1 => carries::ONE,
                _ => carries::MORE,
            };
            let alone = n.floats && carries == carries::NOTHING;
            let mut link = |field, x| f.link(self.node_links, self.trees + i, field, x);
            link(node_link::ARRIVAL, arrival);
            link(node_link::CARRIES, carries);
            link(node_link::ALONE, usize::from(alone));
        }
    }

    /// The way along the limbs, and who follows whom on it.
    fn fill_limbs(&self, forest: &Forest, children: &[Vec<usize>], f: &mut Filler) {
        let limbs = along_limbs(forest, children);
        for (i, &n) in limbs.iter().enumerate() {
            let follows = i > 0 && forest.nodes[n].parent == Some(limbs[i - 1]);
            let row = self.trees + n;
            f.link(self.limb_links, i, 0, row);
            f.link(
                self.node_links,
                row,
                node_link::FOLLOWS,
                usize::from(follows),
            );
        }
    }

    fn fill_couples(&self, couples: &Couples, f: &mut Filler) {
        for (row, couple) in couples.couples.iter().enumerate() {
            for (field, &x) in couple.iter().enumerate() {
                f.link(self.couple_links, row, field, x);
            }
        }
        for (row, &dof) in couples.names.iter().enumerate() {
            f.link(self.entry_links, row, 0, dof);
        }
        for &(slot, couple, entry) in &couples.slots {
            f.link(self.touch_links, slot, touch_link::COUPLE, couple);
            f.link(self.touch_links, slot, touch_link::ENTRY, entry);
        }
    }

    fn fill_forest(&self, forest: &Forest, f: &mut Filler) {
        let children = forest.children();
        self.fill_arrivals(forest, &children, f);
        self.fill_limbs(forest, &children, f);
        let (mut m, mut hinge, mut ball, mut axis, mut origin) = (0, 0, 0, 0, 0);
        for (i, n) in forest.nodes.iter().enumerate() {
            let row = self.trees + i;
            let parent = n.parent.map_or(n.tree, |p| self.trees + p);
            f.link(self.node_links, row, node_link::PARENT, parent);
            f.link(self.node_links, row, node_link::MOTION_BEGIN, m);
            f.link(
                self.node_links,
                row,
                node_link::MOTION_END,
                m + n.motions.len(),
            );
            f.link(self.node_links, row, node_link::DOF_BEGIN, n.dof);
            f.link(self.node_links, row, node_link::DOF_COUNT, n.dofs());
            let turned = n.place.orientation != DQuat::IDENTITY;
            f.link(self.node_links, row, node_link::TURNED, usize::from(turned));
            // Impulses that bodies give each other need the factor of every degree of freedom.
            let floats = n.floats && !self.exchanges();
            let (eliminated, from) = if floats { (0, row) } else { (n.dofs(), parent) };
            f.link(self.node_links, row, node_link::FLOATS, usize::from(floats));
            f.link(self.node_links, row, node_link::ELIMINATED, eliminated);
            f.link(self.node_links, row, node_link::ACCELERATES_FROM, from);
            f.pose(self.node, row, node::PLACE, n.place);
            f.number(self.node, row, node::MASS, n.mass);
            f.vec3(self.node, row, node::CENTER, n.center);
            f.sym(self.node, row, node::INERTIA, n.inertia);
            f.number(self.node, row, node::ROLLS, f64::from(u8::from(n.rolls)));
            for motion in &n.motions {
                f.link(self.motion_links, m, motion_link::KIND, motion.kind);
                f.link(
                    self.motion_links,
                    m,
                    motion_link::COORDINATE,
                    motion.coordinate,
                );
                f.link(self.motion_links, m, motion_link::DOF, motion.dof);
                f.vec3(self.motion, m, 0, motion.axis);
                f.number(self.motion, m, 3, motion.reference);
                if motion.kind == motion::REVOLUTE {
                    f.link(self.hinge_links, hinge, 0, m);
                    f.link(self.hinge_links, hinge, 1, motion.coordinate);
                    hinge += 1;
                }
                if motion.kind == motion::BALL {
                    f.link(self.ball_links, ball, 0, motion.coordinate);
                    f.link(self.ball_links, ball, 1, motion.dof);
                    ball += 1;
                } else {
                    f.link(self.axis_links, axis, 0, motion.coordinate);
                    f.link(self.axis_links, axis, 1, motion.dof);
                    axis += 1;
                }
                m += 1;
            }
        }
        let mut roots = vec![None; forest.bases.len()];
        for root in forest.nodes.iter().filter(|n| n.parent.is_none()) {
            roots[root.tree] = Some(root);
        }
        for (tree, (base, root)) in forest.bases.iter().zip(&roots).enumerate() {
            let slides = root
                .iter()
                .flat_map(|n| &n.motions)
                .filter(|m| m.kind == motion::PRISMATIC);
            let mut point = base.position;
            f.link(self.tree_links, tree, 0, origin);
            for slide in slides {
                let direction = base.direction(slide.axis);
                point -= direction * slide.reference;
                f.link(self.origin_links, origin, 0, slide.coordinate);
                f.vec3(self.origin, origin, 0, direction);
                origin += 1;
            }
            f.link(self.tree_links, tree, 1, origin);
            f.vec3(self.tree, tree, 0, point);
        }
    }

    fn fill_bodies(&self, model: &Model, forest: &Forest, f: &mut Filler) {
        for (row, &id) in model.order().iter().enumerate() {
            let (body, seat) = (&model.bodies[id.0], forest.seats[id.0]);
            let carrier = model.carrier(id);
            let parent = carrier.and_then(|j| model.joints[j.0].parent);
            f.link(
                self.body_links,
                row,
                body_link::NODE,
                seat.node.map_or(0, |n| self.trees + n),
            );
            f.link(
                self.body_links,
                row,
                body_link::TREE,
                seat.node.map_or(0, |n| forest.nodes[n].tree),
            );
            f.link(self.body_links, row, body_link::BODY, id.0);
            f.link(
                self.body_links,
                row,
                body_link::CARRIER,
                parent.map_or(row, |p| forest.row(Some(p))),
            );
            f.link(
                self.body_links,
                row,
                body_link::JOINT,
                carrier.map_or(model.joints.len(), |j| j.0),
            );
            f.pose(self.body, row, body_field::PLACE, seat.place);
            if let Some(joint) = carrier {
                f.number(self.body, row, body_field::MASS, body.mass);
                f.vec3(self.body, row, body_field::CENTER, body.center);
                f.sym(self.body, row, body_field::INERTIA, body.inertia);
                f.vec3(
                    self.body,
                    row,
                    body_field::JOINT,
                    model.joints[joint.0].child_frame.position,
                );
            }
        }
    }
}
