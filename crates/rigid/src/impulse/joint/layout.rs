//! The joints of a model as the kernels read them.

use super::super::layout::{Impulse, WORLD, bodies_and_rows, own_frame};
use super::actuation::Sources;
use super::report::{TieReport, passive};
use super::tables::{LAWS, ROWS, joint};
use super::tied::{Constants, sources};
use crate::SolverError;
use crate::check;
use crate::implicitness::one_by_one;
use crate::locks::pace;
use crate::output::reaction;
use crate::tables::{Filler, actuator_numbers, ball_target, bounded, frame};
use glam::DVec3;
use model::{AxisKind, BodyKind, Dof, Joint, JointId, JointKind, Model, Pose};
use numbers::machine::space::{Parameter, State as StateMemory};
use numbers::{Float, Table};

/// Joints of one body that are solved one after the other as if it had no other; of more, each has a share
/// of the body, as if it fell apart among them (Tonge, Benevolenski, Voroshilov, *Mass Splitting for
/// Jitter-Free Parallel Rigid Body Simulation*, 2012).
///
/// Impulses that are given again act as forces do, and one pass over n joints of a light body changes
/// them by more than these balance. With f = 1/8, T = 8 and shares of n/4 the errors of stars of 2 to 20
/// joints shrink, whatever the mass of the body in the middle; with f = 1/6 those of four joints grow.
const SHARED: f64 = 4.0;

/// Inverses of the paces at which a gap in a loop closes: turns [s/rad], shifts [s/m]. One in a tree is never wide.
const SLOW: [f64; 2] = [1.0 / pace::TURNS, 1.0 / pace::SHIFTS];

/// Fields of a degree of freedom's constants.
pub(super) mod dof {
    pub const REFERENCE: usize = 0;
    pub const DAMPING: usize = 1;
    pub const STIFFNESS: usize = 2;
    pub const REST: usize = 3;
    pub const ARMATURE: usize = 4;
    pub const FRICTION: usize = 5;
    /// Lower, upper, stiffness, damping, inertia.
    pub const LIMIT: usize = 6;
    /// Stiffness, damping, effort limit, control time.
    pub const DRIVE: usize = 11;
    /// (1 − Θ) h [s]: see [`law`](super::super::law).
    pub const EARLY: usize = 15;
    /// All stiffness that acts at most [N/m or N·m/rad].
    pub const STIFFEST: usize = 16;
    pub const WIDTH: usize = 17;
}

/// Numbers that a joint carries from step to step: its fields from the targets to the sums.
pub const TIED_STATE: usize = joint::WRITTEN - joint::CONSTANTS;

/// A row of a joint that is a degree of freedom.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Freedom {
    pub dof: usize,
    /// None where the coordinate is part of a quaternion.
    pub coordinate: Option<usize>,
    pub limited: bool,
    pub rubs: bool,
    pub driven: bool,
    /// A rotation without end.
    pub turns: bool,
    /// Rows of the actuators, and whether their force has bounds.
    pub motors: Vec<(usize, bool)>,
}

/// A joint that ties bodies together, or along which something acts.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Tie {
    pub joint: JointId,
    /// Parent and child.
    pub rows: [u32; 2],
    /// Whether it does anything.
    pub solved: bool,
    pub(super) ball: bool,
    /// How many joints each of its bodies has; the world none.
    joints: [f64; 2],
    locked: [bool; ROWS],
    pub(super) freedoms: [Option<Freedom>; ROWS],
    pub(super) sources: Sources,
    /// First coordinate of the quaternion of a ball or free joint.
    quaternion: Option<usize>,
    bodies_collide: bool,
}

/// Where the numbers of all ties lie.
#[derive(Clone, Debug, PartialEq)]
pub(in super::super) struct Ties {
    pub list: Vec<Tie>,
    pub(super) constants: Table<Parameter, { joint::CONSTANTS }>,
    /// [`ROWS`] a tie.
    pub(super) dofs: Table<Parameter, { dof::WIDTH }>,
    pub(super) motors: Table<Parameter, 9>,
    /// Origins of the children's frames in their bodies' own, about which reactions are told [m].
    origins: Table<Parameter, 3>,
    state: Table<StateMemory, TIED_STATE>,
    /// Targets as a world starts.
    targets: Vec<[f64; ROWS]>,
}

/// Whether a joint is a free one to the world, along which nothing acts.
pub(in super::super) fn is_bare(model: &Model, id: JointId) -> bool {
    let joint = &model.joints[id.0];
    let bare = |dof: &Dof| {
        let forces = [dof.armature, dof.damping, dof.stiffness, dof.friction_loss];
        forces == [0.0; 4] && dof.limit.is_none()
    };
    let pushed = model.actuators.iter().any(|a| a.joint == id);
    joint.kind == JointKind::Free
        && joint.parent.is_none()
        && joint.dofs.iter().all(bare)
        && !pushed
}

impl Ties {
    /// Lays out the joints of a model that are not bare.
    ///
    /// # Errors
    /// What this solver does not know of a joint.
    pub fn new(
        model: &Model,
        rows: &[u32],
        parameters: &mut usize,
        state: &mut usize,
    ) -> Result<Self, SolverError> {
        check::rotations(model, super::super::layout::NAME)?;
        let ids = (0..model.joints.len()).map(JointId);
        let tied = ids.filter(|id| {
            let joint = &model.joints[id.0];
            let nothing = joint.kind == JointKind::Free && joint.closes_loop;
            !nothing && !is_bare(model, *id)
        });
        let list: Vec<_> = tied
            .map(|id| Tie::new(model, id, rows))
            .collect::<Result<_, _>>()?;
        let list = count(list, rows.len());
        let targets = list.iter().map(|tie| tie.targets(model)).collect();
        Ok(Self {
            constants: Table::place(parameters, list.len()),
            dofs: Table::place(parameters, ROWS * list.len()),
            motors: Table::place(parameters, model.actuators.len()),
            origins: Table::place(parameters, list.len()),
            state: Table::place(state, list.len()),
            targets,
            list,
        })
    }

    /// The joints of a model on their own.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn of(model: &Model) -> Result<Self, SolverError> {
        Self::new(model, &bodies_and_rows(model).1, &mut 0, &mut 0)
    }

    /// Writes the constants, for small steps of length `h` [s]; `inner` is the model's frame in each body's own, or in the
    /// world.
    pub fn fill(&self, model: &Model, inner: &[Pose], h: f64, f: &mut Filler) {
        let shared = |id| {
            let found = self.list.binary_search_by_key(&id, |tie| tie.joint);
            found.ok().and_then(|i| self.list[i].shared())
        };
        let springs = one_by_one(model, h, shared);
        for (i, tie) in self.list.iter().enumerate() {
            let joint = &model.joints[tie.joint.0];
            f.numbers(self.constants, i, 0, &tie.constants(joint, inner));
            let frame = inner[joint.child.0] * joint.child_frame;
            f.vec3(self.origins, i, 0, frame.position);
            let freedoms = tie.freedoms.iter().zip(tie.dofs_of(joint)).enumerate();
            for (row, (freedom, own)) in freedoms {
                if let (Some(freedom), Some(own)) = (freedom, own) {
                    let reference = joint.axes.get(own).map_or(0.0, |axis| axis.reference);
                    let numbers = dof_numbers(&joint.dofs[own], reference);
                    f.numbers(self.dofs, ROWS * i + row, 0, &numbers);
                    let early = (1.0 - springs.implicitness[freedom.dof]) * h;
                    let limits = [early, springs.stiffest[freedom.dof]];
                    f.numbers(self.dofs, ROWS * i + row, dof::EARLY, &limits);
                }
            }
        }
        for (i, actuator) in model.actuators.iter().enumerate() {
            f.numbers(self.motors, i, 0, &actuator_numbers(actuator));
        }
    }

    /// All that two models must have in common besides where their numbers lie.
    pub fn structure(&self, words: &mut Vec<u32>) {
        for tie in &self.list {
            words.extend([tie.joint.0 as u32, tie.rows[0], tie.rows[1]]);
            words.extend([tie.solved, tie.ball, tie.bodies_collide].map(u32::from));
            for (locked, freedom) in tie.locked.iter().zip(&tie.freedoms) {
                words.push(u32::from(*locked));
                let Some(f) = freedom else { continue };
                words.extend([f.limited, f.rubs, f.driven, f.turns].map(u32::from));
                words.extend(f.motors.iter().flat_map(|m| [m.0 as u32, u32::from(m.1)]));
            }
        }
    }

    /// Gives the drives the targets that the model has.
    pub fn initial(&self, state: &mut [f64]) {
        for (i, target) in self.targets.iter().enumerate() {
            state[self.state.at(i, 0)..][..ROWS].copy_from_slice(target);
        }
    }

    /// Remembers the angles of all axes, so that their turns count, and their rates; nothing pushes yet.
    pub fn place(&self, [position, velocity]: [&[f64]; 2], parameters: &[f64], state: &mut [f64]) {
        for (i, tie) in self.list.iter().enumerate() {
            let at = self.state.at(i, ROWS);
            state[at..at + TIED_STATE - ROWS].fill(0.0);
            for (row, freedom) in tie.freedoms[..3].iter().enumerate() {
                if let Some(coordinate) = freedom.as_ref().and_then(|f| f.coordinate) {
                    let reference = parameters[self.dofs.at(ROWS * i + row, dof::REFERENCE)];
                    state[at + row] = position[coordinate] - reference;
                }
            }
            let speeds = self.state.at(i, joint::SPEED - joint::TARGET);
            for (row, freedom) in tie.freedoms.iter().enumerate() {
                if let Some(freedom) = freedom {
                    state[speeds + row] = velocity[freedom.dof];
                }
            }
        }
    }
}

impl Tie {
    fn new(model: &Model, id: JointId, rows: &[u32]) -> Result<Self, SolverError> {
        let joint = &model.joints[id.0];
        refuse(joint)?;
        let (linear, angular) = check::axes(joint, super::super::layout::NAME)?;
        let locks = |row: usize| match joint.kind {
            JointKind::Free => false,
            JointKind::Distance => row == 3,
            JointKind::Ball => row >= 3,
            _ if row < 3 => row >= angular.len(),
            _ => row - 3 >= linear.len(),
        };
        let turning = matches!(joint.kind, JointKind::Ball | JointKind::Free);
        let mut tie = Self {
            joint: id,
            rows: [joint.parent, Some(joint.child)].map(|body| body.map_or(WORLD, |b| rows[b.0])),
            solved: joint.enabled,
            ball: turning,
            joints: [0.0; 2],
            locked: std::array::from_fn(locks),
            freedoms: [const { None }; ROWS],
            sources: Sources::default(),
            quaternion: None,
            bodies_collide: joint.bodies_collide,
        };
        if joint.closes_loop {
            return Ok(tie);
        }
        let coordinates = model.coordinate_range(id);
        tie.quaternion = turning.then(|| coordinates.end - 4);
        for (row, own) in tie.dofs_of(joint).into_iter().enumerate() {
            let Some(own) = own else { continue };
            let straight = joint.kind == JointKind::Free && row >= 3;
            let coordinate = (!turning || straight).then_some(coordinates.start + own);
            tie.freedoms[row] = Some(Freedom::new(model, id, own, coordinate)?);
        }
        tie.sources = sources(&tie.freedoms);
        Ok(tie)
    }

    /// By how much more the bodies respond: see [`SHARED`].
    fn shares(&self) -> [f64; 2] {
        self.joints.map(|count| f64::max(count / SHARED, 1.0))
    }

    /// The larger of these, where a body has other joints.
    fn shared(&self) -> Option<f64> {
        let [a, b] = self.shares();
        let others = self.joints.iter().any(|count| *count > 1.0);
        others.then_some(a.max(b))
    }

    /// Which of the joint's own degrees of freedom each row is.
    fn dofs_of(&self, joint: &Joint) -> [Option<usize>; ROWS] {
        let kind = |kind| move |i: &usize| joint.axes[*i].kind == kind;
        let all = 0..joint.axes.len();
        let angular: Vec<_> = all.clone().filter(kind(AxisKind::Angular)).collect();
        let linear: Vec<_> = all.filter(kind(AxisKind::Linear)).collect();
        std::array::from_fn(|row| match joint.kind {
            JointKind::Ball => (row < 3).then_some(row),
            JointKind::Free => Some((row + 3) % ROWS),
            _ if row < 3 => angular.get(row).copied(),
            _ => linear.get(row - 3).copied(),
        })
    }

    fn targets(&self, model: &Model) -> [f64; ROWS] {
        let joint = &model.joints[self.joint.0];
        if self.ball {
            let mut target = [0.0; ROWS];
            let first = joint.dofs.len() - 3;
            target[..4].copy_from_slice(&ball_target(&joint.dofs[first..]));
            return target;
        }
        let target = |own: usize| joint.dofs[own].drive.target_position;
        self.dofs_of(joint).map(|own| own.map_or(0.0, target))
    }

    /// The first fields of [`joint`].
    fn constants(&self, joint: &Joint, inner: &[Pose]) -> [f64; joint::CONSTANTS] {
        let directions = |kind| -> Vec<DVec3> {
            let axes = joint.axes.iter().filter(|axis| axis.kind == kind);
            axes.map(|axis| axis.direction).collect()
        };
        let (angular, linear) = (directions(AxisKind::Angular), directions(AxisKind::Linear));
        let (turn, slide) = (frame(&angular), frame(&linear));
        let about = joint
            .axes
            .iter()
            .find(|axis| axis.kind == AxisKind::Angular);
        let anchor = about.map_or(DVec3::ZERO, |axis| axis.anchor);
        let parent = joint.parent.map_or(Pose::IDENTITY, |body| inner[body.0]);
        let a = parent * joint.parent_frame;
        let b = inner[joint.child.0] * joint.child_frame;
        let own = |i: usize| angular.get(i).map(|d| turn.conjugate() * *d);
        let second = own(1).unwrap_or(DVec3::Y);
        let third = own(2).unwrap_or(DVec3::X.cross(second).normalize());
        let length = if joint.kind == JointKind::Distance {
            joint.length
        } else {
            -1.0
        };
        let mut x = [0.0; joint::CONSTANTS];
        let mut put =
            |at: usize, numbers: &[f64]| x[at..at + numbers.len()].copy_from_slice(numbers);
        put(joint::ANCHOR_A, &a.point(anchor).to_array());
        put(joint::FRAME_A, &(a.orientation * turn).to_array());
        put(joint::ANCHOR_B, &b.point(anchor).to_array());
        put(joint::FRAME_B, &(b.orientation * turn).to_array());
        put(joint::LINEAR_FRAME, &(a.orientation * slide).to_array());
        put(joint::LOCKED, &self.locked.map(|l| f64::from(u8::from(l))));
        put(joint::SECOND, &second.to_array());
        put(joint::THIRD, &third.to_array());
        put(
            joint::CARRIED,
            &[f64::from(u8::from(angular.len() == 3)), length],
        );
        put(joint::BALL, &[f64::from(u8::from(self.ball))]);
        put(joint::SHARES, &self.shares());
        let slow = if joint.closes_loop { SLOW } else { [0.0; 2] };
        put(joint::SLOW, &slow);
        x
    }
}

/// Tells each joint how many its bodies have.
fn count(mut list: Vec<Tie>, bodies: usize) -> Vec<Tie> {
    let mut joints = vec![0.0; bodies + 1];
    for tie in list.iter().filter(|tie| tie.solved) {
        for row in tie.rows {
            joints[row as usize] += 1.0;
        }
    }
    joints[WORLD as usize] = 0.0;
    for tie in &mut list {
        tie.joints = tie.rows.map(|row| joints[row as usize]);
    }
    list
}

fn unsupported(what: &'static str, joint: &Joint, remedy: &'static str) -> SolverError {
    super::super::layout::unsupported(what, &joint.name, remedy)
}

fn refuse(joint: &Joint) -> Result<(), SolverError> {
    if joint.linear_compliance > 0.0 || joint.angular_compliance > 0.0 {
        let remedy = "use the solver `xpbd`";
        return Err(unsupported("compliance", joint, remedy));
    }
    let linear = joint.axes.iter().filter(|a| a.kind == AxisKind::Linear);
    let linear: Vec<_> = linear.map(|axis| axis.direction).collect();
    let slide = frame(&linear);
    let columns = [DVec3::X, DVec3::Y, DVec3::Z].map(|x| slide * x);
    let fits = |(d, column): (&DVec3, DVec3)| d.distance(column) < 1e-9;
    if linear.iter().zip(columns).all(fits) {
        return Ok(());
    }
    let remedy =
        "choose them at right angles, a third to the right of two, or use the solver `xpbd`";
    Err(unsupported("linear axes that are no frame", joint, remedy))
}

impl Freedom {
    fn new(
        model: &Model,
        id: JointId,
        own: usize,
        coordinate: Option<usize>,
    ) -> Result<Self, SolverError> {
        let joint = &model.joints[id.0];
        let dof = &joint.dofs[own];
        let actuators = model.actuators.iter().enumerate();
        let motors: Vec<_> = actuators
            .filter(|(_, a)| a.joint == id && a.dof == own)
            .map(|(i, a)| (i, a.force_range.is_some()))
            .collect();
        let freedom = Self {
            dof: model.dof_range(id).start + own,
            coordinate,
            limited: dof.limit.is_some(),
            rubs: dof.friction_loss > 0.0,
            driven: dof.drive.stiffness > 0.0 || dof.drive.damping > 0.0,
            turns: model.turns_without_end(id, own),
            motors,
        };
        if freedom.count_laws() > LAWS {
            let remedy = "use the solver `featherstone` or `xpbd`";
            return Err(unsupported(
                "so many actuators with a force range",
                joint,
                remedy,
            ));
        }
        Ok(freedom)
    }
}

fn dof_numbers(d: &Dof, reference: f64) -> [f64; dof::WIDTH] {
    let limit = d.limit.map_or([0.0; 5], |l| {
        [l.lower, l.upper, l.stiffness, l.damping, l.inertia]
    });
    let drive = &d.drive;
    let mut x = [0.0; dof::WIDTH];
    let passive = [
        reference,
        d.damping,
        d.stiffness,
        d.rest,
        d.armature,
        d.friction_loss,
    ];
    x[..dof::LIMIT].copy_from_slice(&passive);
    x[dof::LIMIT..dof::DRIVE].copy_from_slice(&limit);
    let effort = bounded(drive.effort_limit);
    let numbers = [drive.stiffness, drive.damping, effort, drive.control_time];
    x[dof::DRIVE..dof::EARLY].copy_from_slice(&numbers);
    x
}

impl Impulse {
    /// How many joints tie bodies together, or have something act along them.
    pub fn ties(&self) -> usize {
        self.ties.list.len()
    }
    /// Rows of the bodies of such a joint, parent and child; none where it does nothing.
    pub fn tied_rows(&self, tie: usize) -> Option<[u32; 2]> {
        let tie = &self.ties.list[tie];
        tie.solved.then_some(tie.rows)
    }
    /// Which joint it is.
    pub fn tied_joint(&self, tie: usize) -> JointId {
        self.ties.list[tie].joint
    }
    /// Whether a row of a joint is a degree of freedom, along which something may act.
    pub fn freedoms(&self, tie: usize) -> [bool; ROWS] {
        let freedoms = self.ties.list[tie].freedoms.each_ref();
        freedoms.map(Option::is_some)
    }
    /// Whether any joint has a drive.
    pub fn drives(&self) -> bool {
        let mut freedoms = self.ties.list.iter().flat_map(|tie| &tie.freedoms);
        freedoms.any(|freedom| freedom.as_ref().is_some_and(|f| f.driven))
    }
    /// Where a joint's numbers lie in the state that it carries from step to step: its fields from the targets on.
    pub fn tied_state(&self, tie: usize) -> std::ops::Range<usize> {
        self.ties.state.at(tie, 0)..self.ties.state.at(tie + 1, 0)
    }
    /// Where in the state the rates of a joint's rows lie.
    pub fn tied_rates(&self, tie: usize) -> std::ops::Range<usize> {
        let first = self.ties.state.at(tie, joint::SPEED - joint::TARGET);
        first..first + ROWS
    }
    /// Where in the state the targets lie that drives follow with a lag, and as much of joints without any.
    pub fn targets(&self) -> Vec<std::ops::Range<usize>> {
        let all = (0..self.ties()).map(|tie| self.ties.state.at(tie, 0));
        all.map(|first| first..first + ROWS).collect()
    }
    /// These numbers.
    pub fn carried<'a, T>(&self, tie: usize, state: &'a [T]) -> &'a [T] {
        &state[self.tied_state(tie)]
    }
    /// Keeps what a joint carries to the next step: its fields from the targets on.
    pub fn keep_tied<T: Float>(
        &self,
        tie: usize,
        numbers: impl Iterator<Item = T>,
        state: &mut [T],
    ) {
        let carried = &mut state[self.tied_state(tie)];
        for (to, x) in carried.iter_mut().zip(numbers) {
            *to = x;
        }
    }
    /// A joint of bodies that sleep gives in each of so many small steps what it gave in the last one; they are the first
    /// of a step, or come to those before. What is geared to its axes rests.
    pub fn persist_tied<T: Float>(
        &self,
        tie: usize,
        first: bool,
        small_steps: usize,
        state: &mut [T],
    ) {
        let at = |field| self.ties.state.at(tie, field - joint::TARGET);
        let steps = T::from_f64(small_steps as f64);
        for i in 0..6 {
            let before = if first {
                T::zero()
            } else {
                state[at(joint::SUM + i)]
            };
            state[at(joint::SUM + i)] = before + state[at(joint::IMPULSE + i)] * steps;
            state[at(joint::SPEED + i)] = T::zero();
        }
    }
    /// What a joint gave in small steps, and in a step, that were so many times as long.
    pub(in super::super) fn stretch_tied<T: Float>(
        &self,
        tie: usize,
        [small, whole]: [T; 2],
        state: &mut [T],
    ) {
        let at = |field| self.ties.state.at(tie, field - joint::TARGET);
        for (field, times) in [(joint::IMPULSE, small), (joint::SUM, whole)] {
            for x in &mut state[at(field)..][..6] {
                *x *= times;
            }
        }
    }
}

impl Impulse {
    /// The constants that [`tell_tie`](super::tell_tie) is given.
    pub(in super::super) fn given_constants_of_tie<T: Float>(
        &self,
        tie: usize,
        parameters: &[T],
        mut give: impl FnMut(f64),
    ) {
        let ties = &self.ties;
        let given = Constants { ties, parameters };
        let constants = ties.constants.at(tie, 0)..ties.constants.at(tie + 1, 0);
        let origin = ties.origins.at(tie, 0)..ties.origins.at(tie + 1, 0);
        for numbers in [constants, origin] {
            parameters[numbers].iter().for_each(|x| give(x.to_f64()));
        }
        for (row, freedom) in ties.list[tie].freedoms.iter().enumerate() {
            let x = given.dof(tie, row);
            let numbers = freedom.as_ref().map_or([0.0; passive::WIDTH], |freedom| {
                let spring = [dof::STIFFNESS, dof::REST, dof::ARMATURE];
                let [stiffness, rest, armature] = spring.map(|i| x[i]);
                let acts = given.stiffness_that_acts(freedom, &x) * stiffness;
                let turns = f64::from(u8::from(freedom.turns));
                [x[dof::REFERENCE], acts, rest, armature, turns]
            });
            numbers.into_iter().for_each(&mut give);
        }
    }
    /// Where what that tells belongs: from, to, how many numbers.
    pub(in super::super) fn told_places_of_tie(
        &self,
        tie: usize,
        mut row: impl FnMut(usize, usize, usize),
    ) {
        let (t, output, tie) = (TieReport::new(), &self.output, &self.ties.list[tie]);
        for (i, freedom) in tie.freedoms.iter().enumerate() {
            let Some(freedom) = freedom else { continue };
            row(t.rate.at(i, 0), output.velocity.at(freedom.dof, 0), 1);
            let acceleration = output.acceleration.at(freedom.dof, 0);
            row(t.acceleration.at(i, 0), acceleration, 1);
            if let Some(coordinate) = freedom.coordinate {
                row(t.value.at(i, 0), output.position.at(coordinate, 0), 1);
            }
        }
        if let Some(first) = tie.quaternion {
            row(t.turn.start(), output.position.at(first, 0), 4);
        }
        let reaction = output.reaction.at(tie.joint.0, 0);
        row(t.reaction.start(), reaction, reaction::WIDTH);
    }
}

/// The model's frame in each body's own; of a static one, in the world.
pub(in super::super) fn inner_frames(model: &Model) -> Vec<Pose> {
    let inner = |body: &model::Body| match body.kind {
        BodyKind::Static => body.pose,
        BodyKind::Dynamic => own_frame(body).1.inverse(),
    };
    model.bodies.iter().map(inner).collect()
}
