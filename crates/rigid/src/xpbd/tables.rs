//! A model as position-based dynamics reads it.
//!
//! Row 0 of the bodies is the world, and every static body with it: no mass
//! moves it. A body's own frame is at its centre of mass, along its principal
//! axes, where its inertia is a diagonal. A joint's frame is turned so that its
//! first angular axis is x; its linear axes have a frame of their own.

use super::contact::{grip, touching};
use super::laws::{self, LawTables};
use super::seats::{Seats, jointed};
use super::topology::closings;
use crate::contacts::{ContactPlan, ContactTables, Kept};
use crate::featherstone::forest::Forest;
use crate::implicitness::implicitness;
use crate::locks::{Locks, turns};
use crate::output::{OutputTables, body};
use crate::tables::{Filler, frame};
use crate::{InputTables, Settings, SolverError};
use glam::{DQuat, DVec3};
use model::{
    AxisKind, Body, BodyId, BodyKind, Joint, JointId, JointKind, MassProperties, Model, Pose,
    ShapeId,
};
use numbers::Table;
use numbers::machine::Links;
use numbers::machine::space::{Parameter, Scratch, State};

/// The solver's name.
pub(crate) const NAME: &str = "xpbd";

/// Most rows that a joint locks.
const LOCKED_ROWS: usize = 6;

/// Fields of [`Tables::joint_links`].
pub(crate) mod joint_link {
    /// Rows of the bodies.
    pub const A: usize = 0;
    pub const B: usize = 1;
    /// See [`turns`](crate::locks::turns).
    pub const TURNS: usize = 2;
    /// See [`hold`](crate::locks::hold).
    pub const HOLD: usize = 3;
    /// The joint, in the model.
    pub const JOINT: usize = 4;
    pub const WIDTH: usize = 5;
}

/// Fields of [`Tables::joint`].
pub(crate) mod joint_field {
    use crate::locks::lock;
    pub use lock::*;
    /// Compliances: linear, angular.
    pub const COMPLIANCE: usize = lock::WIDTH;
    /// 1, or 0 for a joint that does not act.
    pub const ENABLED: usize = 27;
    /// First angular axis, in A's own frame.
    pub const AXIS_A: usize = 28;
    /// The same in B's own frame; of two axes, the second.
    pub const AXIS_B: usize = 31;
    /// From A's own anchor, at the joint that carries it, to this one's, in A's own frame.
    pub const STEP: usize = 34;
    /// 1 for a joint that acts and is compliant nowhere, else 0.
    pub const PLAIN: usize = 37;
    pub const WIDTH: usize = 38;
}

/// Fields of [`Tables::mass`].
pub(crate) mod mass {
    pub const INVERSE: usize = 0;
    pub const INVERSE_MOMENTS: usize = 1;
    /// Mass, principal moments.
    pub const MASS: usize = 4;
    pub const MOMENTS: usize = 5;
    /// Of the joint that carries the body, in its own frame; its centre, if none does.
    pub const ANCHOR: usize = 8;
    pub const WIDTH: usize = 11;
}

/// What carries a body.
pub(crate) mod inbound {
    /// A hinge.
    pub const HINGE: usize = 0;
    /// Another joint of the tree.
    pub const JOINT: usize = 1;
    /// Nothing, but it carries others.
    pub const ROOT: usize = 2;
    /// Nothing, and it carries nothing.
    pub const ALONE: usize = 3;
}

/// How a subtree reaches the sums of its parent.
pub(crate) mod arrival {
    /// Not: the parent is the world.
    pub const NONE: usize = 0;
    /// Before its siblings.
    pub const FIRST: usize = 1;
    /// After one of them.
    pub const LATER: usize = 2;
}

/// Fields of [`Tables::row_links`]: a body in its tree.
pub(crate) mod row_link {
    /// See [`inbound`](super::inbound).
    pub const INBOUND: usize = 0;
    /// Row of the joint that carries it, and of the body on the other side.
    pub const JOINT: usize = 1;
    pub const PARENT: usize = 2;
    /// Row of [`Tables::carried`] for what the body carries; 0 if that is nothing.
    pub const CARRIED: usize = 3;
    /// See [`arrival`](super::arrival).
    pub const ARRIVAL: usize = 4;
    /// First motion, number of motions along, number of motions about axes after them.
    pub const MOTION: usize = 5;
    pub const LINEAR: usize = 6;
    pub const ANGULAR: usize = 7;
    /// The same of the locked rows, which may be compliant.
    pub const SOFT: usize = 8;
    pub const SOFT_SHIFTS: usize = 9;
    pub const SOFT_TURNS: usize = 10;
    pub const WIDTH: usize = 11;
}

/// Fields of [`Tables::motion`]: what a joint leaves free, or a row that is compliant.
pub(crate) mod motion {
    /// λ₀ and g of what pulls along it [kg·m, kg]; of a compliant row, what it has pushed.
    pub const PUSH: usize = 0;
    pub const GIVE: usize = 1;
    /// Unit vector, world axes.
    pub const DIRECTION: usize = 2;
    pub const U: usize = 5;
    /// 1/D, and u/D.
    pub const INVERSE: usize = 11;
    /// How far it went in the last pass.
    pub const WAY: usize = 13;
    pub const WIDTH: usize = 14;
}

/// Fields of [`Tables::hinge`]: the joint that carries a body, in the present pass.
pub(crate) mod hinge {
    /// From the parent's anchor to the body's.
    pub const STEP: usize = 0;
    /// Error of the locked rows, about the body's anchor.
    pub const ERROR: usize = 3;
    pub const WIDTH: usize = 9;
}

/// Fields of [`Tables::borne`]: h² times the force of a joint [kg·m], in the passes before and in the present one.
pub(crate) mod borne {
    pub const BEFORE: usize = 0;
    pub const NOW: usize = 3;
    pub const WIDTH: usize = 6;
}

/// Fields of [`Tables::axis_links`].
pub(crate) mod axis_link {
    /// Row of the joint.
    pub const JOINT: usize = 0;
    pub const COORDINATE: usize = 1;
    pub const DOF: usize = 2;
    /// 1 for a rotation without end.
    pub const TURNS: usize = 3;
    pub const WIDTH: usize = 4;
}

/// Fields of [`Tables::group_links`]: the axes of one joint.
pub(crate) mod group_link {
    pub const JOINT: usize = 0;
    /// First linear axis row, number of linear axes, number of angular axes after them.
    pub const FIRST: usize = 1;
    pub const LINEAR: usize = 2;
    pub const ANGULAR: usize = 3;
    pub const WIDTH: usize = 4;
}

/// Fields of [`Tables::body_links`].
pub(crate) mod body_link {
    /// The body, in the model.
    pub const BODY: usize = 0;
    /// Its row among the moving ones, 0 for a static one.
    pub const ROW: usize = 1;
    pub const WIDTH: usize = 2;
}

/// Fields of [`Tables::global`].
pub(crate) mod global {
    pub const GRAVITY: usize = 0;
    pub const STEP: usize = 3;
    pub const SPEED_LIMIT: usize = 4;
    pub const RELAXATION: usize = 5;
    pub const ANGULAR_DAMPING: usize = 6;
    pub const DISPLACEMENT_CAP: usize = 7;
    pub const FORCE_CAP: usize = 8;
    pub const WIDTH: usize = 9;
}

/// Fields of [`Tables::axis`]: an axis at the start of a substep. The rate of its
/// coordinate is ANGULAR_B · ω_B − ANGULAR_A · ω_A + LINEAR · (v_B − v_A).
pub(crate) mod axis_field {
    pub const LINEAR: usize = 0;
    pub const ANGULAR_A: usize = 3;
    pub const ANGULAR_B: usize = 6;
    /// The coordinate.
    pub const VALUE: usize = 9;
    /// Its rate.
    pub const RATE: usize = 10;
    /// The axis itself.
    pub const DIRECTION: usize = 11;
    pub const WIDTH: usize = 14;
}

/// Layout of everything the kernels touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tables {
    /// Moving bodies, with the world as row 0.
    pub(crate) rows: usize,
    pub(crate) bodies: usize,
    pub(crate) joints: usize,
    pub(crate) axes: usize,
    /// Axes with a coordinate; they come first.
    pub(crate) coordinates: usize,
    /// Joints that no tree has: they close loops, or hold a distance.
    pub(crate) closings: usize,
    /// Joints with axes; those whose coordinates act come first.
    pub(crate) groups: usize,
    pub(crate) tracked: usize,
    pub(crate) balls: usize,
    pub(crate) frees: usize,
    /// Passes per substep. Where there are joints and contacts, one comes before the contacts.
    pub(crate) iterations: usize,
    /// Sweeps over the contacts in a pass.
    pub(crate) sweeps: usize,
    /// True if joints hold any bodies.
    pub(crate) jointed: bool,
    /// True if any surfaces resist twisting or rolling on each other.
    pub(crate) grips: bool,
    /// True if a cap is set.
    pub(crate) capped_at_all: bool,

    /// Centre of mass and orientation of the principal axes.
    pub(crate) pose: Table<State, 7>,
    /// Angular velocity, velocity of the centre.
    pub(crate) twist: Table<State, 6>,
    /// Twist at the start of the last substep.
    pub(crate) before: Table<State, 6>,
    /// Per row: how far the last substep's passes over the tree moved the body.
    pub(crate) moved: Table<State, 6>,
    /// Per closing: angular and linear impulse·h of the last substep, world axes.
    pub(crate) multiplier: Table<State, 6>,
    /// Per axis: the coordinate, less its reference, counting turns.
    pub(crate) angle: Table<State>,
    pub(crate) alive: Table<State>,
    /// Length of the substep that led here, which may be of other settings [s].
    pub(crate) led: Table<State>,
    /// How often a cap has bitten.
    pub(crate) capped: Table<State>,
    pub(crate) laws: LawTables,
    /// The contacts of the last substep, as they are reported.
    pub(crate) kept: Kept,
    /// Their torques against twisting and rolling [N·m].
    pub(crate) gripped: Table<State, 3>,
    pub(crate) state_length: usize,

    pub(crate) input: InputTables,
    pub(crate) output: OutputTables,

    pub(crate) global: Table<Parameter, { global::WIDTH }>,
    pub(crate) mass: Table<Parameter, { mass::WIDTH }>,
    pub(crate) joint: Table<Parameter, { joint_field::WIDTH }>,
    /// Per axis: direction in the linear or angular frame, reference.
    pub(crate) direction: Table<Parameter, 4>,
    /// Per body: the model's frame in its own; for a static one, in the world.
    pub(crate) body: Table<Parameter, 7>,
    pub(crate) parameter_length: usize,

    pub(crate) joint_links: Links<{ joint_link::WIDTH }>,
    pub(crate) axis_links: Links<{ axis_link::WIDTH }>,
    pub(crate) group_links: Links<{ group_link::WIDTH }>,
    pub(crate) row_links: Links<{ row_link::WIDTH }>,
    /// Joint rows of the closings.
    pub(crate) closing_links: Links,
    /// Balls and frees with coordinates: joint row, coordinate, degree of freedom, first motion.
    pub(crate) ball_links: Links<4>,
    pub(crate) free_links: Links<3>,
    pub(crate) body_links: Links<{ body_link::WIDTH }>,
    /// Rows of the bodies that carry shapes.
    pub(crate) carrier_links: Links,
    /// Per slot: rows of the bodies A and B.
    pub(crate) touch_links: Links<2>,
    pub(crate) link_length: usize,

    /// Per row: inverse inertia, world axes.
    pub(crate) inverse_inertia: Table<Scratch, 6>,
    pub(crate) axis: Table<Scratch, { axis_field::WIDTH }>,
    pub(crate) saved_pose: Table<Scratch, 7>,
    /// Axes first, then three a ball, then locked rows, which may be compliant.
    pub(crate) motion: Table<Scratch, { motion::WIDTH }>,
    pub(crate) motions: usize,
    /// Per row: from the centre to the joint that carries the body, world axes.
    pub(crate) arm: Table<Scratch, 3>,
    pub(crate) hinge: Table<Scratch, { hinge::WIDTH }>,
    /// Inertia and force of what a body carries, about its anchor, until it is its own turn; row 0
    /// stays zero. Rows are used again.
    pub(crate) carried: Table<Scratch, 27>,
    /// Per row: displacement in the present pass, about its anchor.
    pub(crate) way: Table<Scratch, 6>,
    /// Per row: which share of its error a joint corrects, so as to stay within the caps.
    pub(crate) share: Table<Scratch>,
    /// Per row, where there are caps: what its joint has borne; see [`borne`].
    pub(crate) borne: Table<Scratch, { borne::WIDTH }>,
    /// Per row: what it carries has passed on to it, about its centre.
    pub(crate) load: Table<Scratch, 6>,
    pub(crate) contacts: ContactTables,
    pub(crate) touching: Table<Scratch, { touching::WIDTH }>,
    pub(crate) grip: Table<Scratch, { grip::WIDTH }>,
    /// Friction coefficient of each slot in this substep, where any surfaces resist more while they stick.
    pub(crate) cone: Table<Scratch>,
    /// Per row: twist before the contacts of a pass.
    pub(crate) unpushed: Table<Scratch, 6>,
    pub(crate) scratch_length: usize,
}

/// Principal moments of a body, and the orientation of their axes.
fn principal(body: &Body) -> (DVec3, DQuat) {
    let mass = MassProperties {
        mass: body.mass,
        center: body.center,
        inertia: body.inertia,
    };
    mass.principal()
}

/// Per body of the model, its row and the model's frame in its own (in the world, for a static one).
fn own_frames(model: &Model) -> Vec<(usize, Pose)> {
    let mut own = vec![(0, Pose::IDENTITY); model.bodies.len()];
    let mut row = 0;
    for &BodyId(id) in model.order() {
        let body = &model.bodies[id];
        own[id] = match body.kind {
            BodyKind::Static => (0, body.pose),
            BodyKind::Dynamic => {
                row += 1;
                let (_, turn) = principal(body);
                (row, Pose::new(body.center, turn).inverse())
            }
        };
    }
    own
}

/// A joint's axes sorted for the kernels.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) joint: usize,
    pub(crate) linear: Vec<usize>,
    pub(crate) angular: Vec<usize>,
    tracked: bool,
}

impl Group {
    fn new(index: usize, joint: &Joint, model: &Model) -> Result<Self, SolverError> {
        let (linear, angular) = crate::check::axes(joint, NAME)?;
        let acts = joint.dofs.iter().any(laws::acts)
            || model.actuators.iter().any(|a| a.joint.0 == index)
            || model
                .couplings
                .iter()
                .any(|c| c.joint.0 == index || c.other.0 == index);
        let tracked = !joint.closes_loop && (acts || angular.len() > 1);
        Ok(Self {
            joint: index,
            linear,
            angular,
            tracked,
        })
    }
}

impl Tables {
    /// Whether bodies may touch anything.
    pub(crate) fn touches(&self) -> bool {
        self.contacts.slots > 0
    }

    /// Whether any of what touches pushes: not all are sensors.
    pub(crate) fn presses(&self) -> bool {
        self.contacts.sensed > 0
    }

    /// Whether anything is coupled or closes a loop.
    pub(crate) fn closes(&self) -> bool {
        self.laws.couplings > 0 || self.closings > 0
    }

    /// Whether that comes before the tree in a pass.
    pub(crate) fn closes_first(&self) -> bool {
        self.laws.geared && self.closes()
    }

    /// Whether the tree is not the only thing, or not only once, that moves what it carries.
    pub(crate) fn sums_moves(&self) -> bool {
        self.iterations > 1 || self.closes_first()
    }

    /// Lays out a model and fills its parameters and links; with the shapes of each contact.
    ///
    /// # Errors
    /// What this solver does not know; a shape that no kernel collides, if `contacts` are asked for.
    pub(crate) fn new(
        model: &Model,
        contacts: bool,
        settings: &Settings,
    ) -> Result<(Self, Filler, Vec<[ShapeId; 2]>), SolverError> {
        let mut groups = Vec::new();
        for (i, joint) in model.joints.iter().enumerate() {
            if !joint.axes.is_empty() {
                groups.push(Group::new(i, joint, model)?);
            }
        }
        groups.sort_by_key(|g| (model.joints[g.joint].closes_loop, !g.tracked));
        laws::check(model)?;
        let own = own_frames(model);
        let seats = Seats::new(model, &own);
        let plan = if contacts {
            seats.plan(model)?
        } else {
            ContactPlan::empty()
        };
        let t = Self::layout(model, settings, &groups, &plan, seats.carriers());
        let mut f = Filler::new(t.parameter_length, t.link_length);
        t.fill_bodies(model, &own, &mut f);
        t.contacts.fill(model, &plan, NAME, &mut f)?;
        seats.fill(&t, &plan, &mut f);
        t.fill_joints(model, &groups, &own, &mut f);
        t.fill_tree(model, &groups, &own, &mut f);
        let axis_of = t.fill_axes(model, &groups, &mut f);
        let implicit = implicitness(model, &Forest::new(model), settings.substep());
        let motion = |ball| t.ball_motion(ball);
        t.laws.fill(model, &implicit, &axis_of, motion, &mut f);
        f.vec3(t.global, 0, global::GRAVITY, model.gravity);
        Ok((t, f, plan.shapes()))
    }

    fn layout(
        model: &Model,
        settings: &Settings,
        groups: &[Group],
        plan: &ContactPlan,
        carriers: usize,
    ) -> Self {
        let moving = model
            .bodies
            .iter()
            .filter(|b| b.kind == BodyKind::Dynamic)
            .count();
        let (rows, joints) = (moving + 1, model.joints.len());
        let axes_of = |closing: bool| -> usize {
            let own = groups
                .iter()
                .filter(|g| model.joints[g.joint].closes_loop == closing);
            own.map(|g| g.linear.len() + g.angular.len()).sum()
        };
        let (coordinates, axes) = (axes_of(false), axes_of(false) + axes_of(true));
        let closings = closings(model).count();
        let open = |kind| {
            model
                .joints
                .iter()
                .filter(|j| j.kind == kind && !j.closes_loop)
                .count()
        };
        let (balls, frees) = (open(JointKind::Ball), open(JointKind::Free));
        let motions = coordinates + 3 * balls + LOCKED_ROWS * moving;
        let (mut s, mut p, mut l, mut t) = (0, 0, 0, 0);
        let laws = LawTables::place(model, &mut s, &mut p, &mut l, &mut t);
        let contacts = ContactTables::place(plan, &mut p, &mut l, &mut t);
        let (presses, jointed) = (contacts.sensed > 0, jointed(model));
        let grips = plan.grips(model);
        let output = OutputTables::new(model).with_contacts(contacts.slots);
        let capped_at_all = settings.displacement_cap.is_finite() || settings.force_cap.is_finite();
        Self {
            rows,
            bodies: model.bodies.len(),
            joints,
            axes,
            coordinates,
            closings,
            groups: groups.len(),
            tracked: groups.iter().filter(|g| g.tracked).count(),
            balls,
            frees,
            iterations: settings.iterations + usize::from(presses && jointed),
            sweeps: settings.contact_iterations,
            jointed,
            grips,
            capped_at_all,
            pose: Table::place(&mut s, rows),
            twist: Table::place(&mut s, rows),
            before: Table::place(&mut s, rows),
            moved: Table::place(&mut s, rows),
            multiplier: Table::place(&mut s, closings),
            angle: Table::place(&mut s, axes),
            alive: Table::place(&mut s, 1),
            led: Table::place(&mut s, 1),
            capped: Table::place(&mut s, 1),
            laws,
            kept: Kept::place(&mut s, contacts.slots),
            gripped: Table::place(&mut s, if grips { contacts.sensed } else { 0 }),
            state_length: s,
            input: InputTables::new(model),
            output: if grips {
                output.with_contact_torques()
            } else {
                output
            },
            global: Table::place(&mut p, 1),
            mass: Table::place(&mut p, rows),
            joint: Table::place(&mut p, joints),
            direction: Table::place(&mut p, axes),
            body: Table::place(&mut p, model.bodies.len()),
            parameter_length: p,
            joint_links: Links::place(&mut l, joints),
            axis_links: Links::place(&mut l, axes),
            group_links: Links::place(&mut l, groups.len()),
            row_links: Links::place(&mut l, rows),
            closing_links: Links::place(&mut l, closings),
            ball_links: Links::place(&mut l, balls),
            free_links: Links::place(&mut l, frees),
            body_links: Links::place(&mut l, model.bodies.len()),
            carrier_links: Links::place(&mut l, carriers),
            touch_links: Links::place(&mut l, contacts.sensed),
            link_length: l,
            inverse_inertia: Table::place(&mut t, rows),
            axis: Table::place(&mut t, axes),
            saved_pose: Table::place(&mut t, rows),
            motion: Table::place(&mut t, motions),
            motions,
            arm: Table::place(&mut t, rows),
            hinge: Table::place(&mut t, rows),
            carried: Table::place(&mut t, rows),
            way: Table::place(&mut t, rows),
            share: Table::place(&mut t, rows),
            borne: Table::place(&mut t, if capped_at_all { rows } else { 0 }),
            load: Table::place(&mut t, rows),
            contacts,
            touching: Table::place(&mut t, contacts.sensed),
            grip: Table::place(&mut t, if grips { contacts.sensed } else { 0 }),
            cone: Table::place(&mut t, if contacts.sticks { contacts.sensed } else { 0 }),
            unpushed: Table::place(&mut t, if presses { rows } else { 0 }),
            scratch_length: t,
        }
    }

    /// Masses and frames of the bodies; `own` as [`own_frames`] has them.
    fn fill_bodies(&self, model: &Model, own: &[(usize, Pose)], f: &mut Filler) {
        for (i, &BodyId(id)) in model.order().iter().enumerate() {
            let (body, (row, frame)) = (&model.bodies[id], own[id]);
            if row > 0 {
                let (moments, _) = principal(body);
                let inverse = [
                    1.0 / body.mass,
                    1.0 / moments.x,
                    1.0 / moments.y,
                    1.0 / moments.z,
                ];
                f.numbers(self.mass, row, mass::INVERSE, &inverse);
                f.number(self.mass, row, mass::MASS, body.mass);
                f.vec3(self.mass, row, mass::MOMENTS, moments);
            }
            f.link(self.body_links, i, body_link::BODY, id);
            f.link(self.body_links, i, body_link::ROW, row);
            f.pose(self.body, i, 0, frame);
        }
    }

    fn fill_joints(&self, model: &Model, groups: &[Group], own: &[(usize, Pose)], f: &mut Filler) {
        let (mut ball, mut free) = (0, 0);
        let mut group_of = vec![None; model.joints.len()];
        for group in groups {
            group_of[group.joint] = Some(group);
        }
        for (j, joint) in model.joints.iter().enumerate() {
            let (linear, angular) =
                group_of[j].map_or((&[][..], &[][..]), |g| (&g.linear, &g.angular));
            let locks = Locks::new(joint, linear, angular);
            let (row_a, own_a) = joint.parent.map_or((0, Pose::IDENTITY), |p| own[p.0]);
            let (row_b, own_b) = own[joint.child.0];
            let a = own_a * joint.parent_frame;
            let b = own_b * joint.child_frame;
            let axis_b = if locks.turns == turns::TWO {
                locks.second
            } else {
                DVec3::X
            };
            let axis_a = a.orientation * locks.turn * DVec3::X;
            let axis_b = b.orientation * locks.turn * axis_b;
            f.vec3(self.joint, j, joint_field::AXIS_A, axis_a);
            f.vec3(self.joint, j, joint_field::AXIS_B, axis_b);
            locks.fill(self.joint, j, [a, b], joint.length, f);
            let compliance = [joint.linear_compliance, joint.angular_compliance];
            f.numbers(self.joint, j, joint_field::COMPLIANCE, &compliance);
            let plain = joint.enabled && compliance == [0.0; 2];
            f.number(
                self.joint,
                j,
                joint_field::ENABLED,
                f64::from(u8::from(joint.enabled)),
            );
            f.number(
                self.joint,
                j,
                joint_field::PLAIN,
                f64::from(u8::from(plain)),
            );
            f.link(self.joint_links, j, joint_link::A, row_a);
            f.link(self.joint_links, j, joint_link::B, row_b);
            f.link(self.joint_links, j, joint_link::TURNS, locks.turns);
            f.link(self.joint_links, j, joint_link::HOLD, locks.hold);
            f.link(self.joint_links, j, joint_link::JOINT, j);
            if joint.closes_loop {
                continue;
            }
            let id = JointId(j);
            let row = [
                j,
                model.coordinate_range(id).start,
                model.dof_range(id).start,
            ];
            match joint.kind {
                JointKind::Ball => {
                    for (field, x) in row.into_iter().enumerate() {
                        f.link(self.ball_links, ball, field, x);
                    }
                    f.link(self.ball_links, ball, 3, self.ball_motion(ball));
                    ball += 1;
                }
                JointKind::Free => {
                    for (field, x) in row.into_iter().enumerate() {
                        f.link(self.free_links, free, field, x);
                    }
                    free += 1;
                }
                _ => {}
            }
        }
    }

    /// Directions of the axes. Returns the row of each degree of freedom's axis.
    fn fill_axes(&self, model: &Model, groups: &[Group], f: &mut Filler) -> Vec<Option<usize>> {
        let mut axis_of = vec![None; model.degrees_of_freedom()];
        let mut row = 0;
        for (g, group) in groups.iter().enumerate() {
            let joint = &model.joints[group.joint];
            let id = JointId(group.joint);
            f.link(self.group_links, g, group_link::JOINT, group.joint);
            f.link(self.group_links, g, group_link::FIRST, row);
            f.link(self.group_links, g, group_link::LINEAR, group.linear.len());
            f.link(
                self.group_links,
                g,
                group_link::ANGULAR,
                group.angular.len(),
            );
            let angular: Vec<_> = group
                .angular
                .iter()
                .map(|&i| joint.axes[i].direction)
                .collect();
            let linear: Vec<_> = group
                .linear
                .iter()
                .map(|&i| joint.axes[i].direction)
                .collect();
            let (turn, slide) = (frame(&angular), frame(&linear));
            for &i in group.linear.iter().chain(&group.angular) {
                let axis = &joint.axes[i];
                let is_angular = axis.kind == AxisKind::Angular;
                let own = if is_angular { turn } else { slide };
                f.vec3(self.direction, row, 0, own.conjugate() * axis.direction);
                f.number(self.direction, row, 3, axis.reference);
                f.link(self.axis_links, row, axis_link::JOINT, group.joint);
                let turns = model.turns_without_end(id, i);
                f.link(self.axis_links, row, axis_link::TURNS, usize::from(turns));
                // An axis of a loop-closing joint has no coordinate: its row points past the end.
                let (q, v) = if joint.closes_loop {
                    (model.coordinates(), model.degrees_of_freedom())
                } else {
                    (
                        model.coordinate_range(id).start + i,
                        model.dof_range(id).start + i,
                    )
                };
                f.link(self.axis_links, row, axis_link::COORDINATE, q);
                f.link(self.axis_links, row, axis_link::DOF, v);
                if let Some(slot) = axis_of.get_mut(v) {
                    *slot = Some(row);
                }
                row += 1;
            }
        }
        axis_of
    }
}

impl Tables {
    /// Writes the bodies' own poses and twists, given the model's frames (13 numbers a body:
    /// see [`output::body`](crate::output::body)).
    pub(crate) fn place(
        &self,
        bodies: &[f64],
        parameters: &[f64],
        links: &[u32],
        state: &mut [f64],
    ) {
        for i in 0..self.bodies {
            let id = links[self.body_links.at(i, body_link::BODY)] as usize;
            let row = links[self.body_links.at(i, body_link::ROW)] as usize;
            if row == 0 {
                continue;
            }
            let b = &bodies[id * body::WIDTH..][..body::WIDTH];
            let frame = Pose::new(
                DVec3::from_slice(&b[body::POSITION..]),
                DQuat::from_slice(&b[body::ORIENTATION..]),
            );
            let p = &parameters[self.body.at(i, 0)..][..7];
            let inner = Pose::new(DVec3::from_slice(p), DQuat::from_slice(&p[3..]));
            let own = frame * inner.inverse();
            let v = DVec3::from_slice(&b[body::VELOCITY..]);
            let w = DVec3::from_slice(&b[body::ANGULAR_VELOCITY..]);
            let v = v + w.cross(own.position - frame.position);
            let at = self.pose.at(row, 0);
            state[at..at + 3].copy_from_slice(&own.position.to_array());
            state[at + 3..at + 7].copy_from_slice(&own.orientation.to_array());
            for table in [self.twist, self.before] {
                let at = table.at(row, 0);
                state[at..at + 3].copy_from_slice(&w.to_array());
                state[at + 3..at + 6].copy_from_slice(&v.to_array());
            }
        }
    }

    /// Remembers the coordinates of the axes on which something acts, so that their turns count.
    pub(crate) fn count_turns(
        &self,
        position: &[f64],
        parameters: &[f64],
        links: &[u32],
        state: &mut [f64],
    ) {
        for group in 0..self.tracked {
            let at = |field| links[self.group_links.at(group, field)] as usize;
            let first = at(group_link::FIRST);
            for row in first..first + at(group_link::LINEAR) + at(group_link::ANGULAR) {
                let q = links[self.axis_links.at(row, axis_link::COORDINATE)] as usize;
                if let Some(q) = position.get(q) {
                    state[self.angle.at(row, 0)] = q - parameters[self.direction.at(row, 3)];
                }
            }
        }
    }
}
