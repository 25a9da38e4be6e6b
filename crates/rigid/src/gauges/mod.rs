//! What sensors of joints, bodies and contacts read.
//!
//! A kernel of its own, not of a solver: its input is what a solver has reported, its state the solver's controls, which it
//! only reads; it writes the numbers of one gauge after the other. Gauges of a kind stand in a table, so that a record of
//! the kernel is as long for a hundred as for one.

mod center_of_mass;
mod contacts;
mod effort;
mod ends;
mod frames;
mod pairs;
mod rows;
mod touch;

use crate::output::body;
use crate::tables::Filler;
use crate::{InputTables, OutputTables, Sheet};
use center_of_mass::{CenterNotes, Centers};
use contacts::{ContactNotes, Contacts};
use effort::{EffortNotes, Efforts};
use ends::{EndNotes, Ends};
use frames::{FrameNotes, Frames};
use model::{Axes, BodyId, JointId, Model, Mount, Pose, ShapeId};
use numbers::machine::space::{Input, Output, Space};
use numbers::{Machine, Real, Table};
use pairs::{PairNotes, Pairs};
use rows::{Notes, Rows};
use std::ops::Range;
use touch::{TouchNotes, Touches};

/// Flags in a number: up to 2²⁴, whole numbers are exact in single precision.
pub const FLAGS: usize = 24;

/// What the flag of one of several counts in its number.
fn flag(row: usize) -> usize {
    1 << (row % FLAGS)
}

/// Something that is read of a world.
#[derive(Clone, Debug, PartialEq)]
pub enum Gauge {
    /// Coordinates of joints [m, rad, quaternions x, y, z, w]; those of axes that turn without end are in [−π, π].
    JointPosition(Vec<JointId>),
    /// Velocities of joints [m/s or rad/s].
    JointVelocity(Vec<JointId>),
    /// Forces of drives, actuators and a controller along degrees of freedom [N or N·m], by their laws at the present
    /// state, with as much of their stiffness as acts; drives take their targets as they are set, without a control time.
    JointEffort(Vec<JointId>),
    /// Forces of actuators before their gears [N or N·m], by their laws at the present state, with as much of their stiffness
    /// as acts; the rows of these.
    ActuatorForce(Vec<usize>),
    /// Acceleration of a frame's origin less that of gravity [m/s²], angular velocity [rad/s], in the frame's axes: 6.
    Imu(Mount),
    /// Force [N] of a joint on its child, and its torque [N·m] about a frame of the child, in that frame's axes: 6. The
    /// child's joint frame by default.
    ForceTorque(JointId, Option<Pose>),
    /// Sum of the normal forces of all contacts of a body [N].
    Touch(BodyId),
    /// Sum of the forces of all contacts on a body [N]: 3.
    ContactForce(BodyId, Axes),
    /// Position [m] and orientation x, y, z, w of the first frame in the second: 7.
    FramePose([Mount; 2]),
    /// Velocity of a frame's origin [m/s], angular velocity [rad/s]: 6.
    FrameVelocity(Mount, Axes),
    /// Centre of mass of a body and all that joints carry from it on, or of all bodies [m]: 3. Where nothing has mass, the
    /// body's origin, or the world's.
    CenterOfMass(Option<BodyId>),
    /// Which of these pairs of shapes press on each other: [`FLAGS`] pairs a number, of which the first counts 1, the next 2,
    /// then 4 and so on.
    Pressing(Vec<[ShapeId; 2]>),
    /// Which of these pairs of shapes overlap; numbers as of [`Pressing`](Self::Pressing).
    Overlapping(Vec<[ShapeId; 2]>),
    /// Sum of the forces of all contacts of the first of two shapes on the second [N], world axes: 3 for each pair.
    PairForce(Vec<[ShapeId; 2]>),
    /// At which ends of their ranges joints are: half of [`FLAGS`] degrees of freedom a number, of which the first counts 1
    /// at its upper end and 2 at its lower, the next 4 and 8, and so on.
    AtEnd(Vec<JointId>),
}

impl Gauge {
    /// How many numbers it has.
    pub fn numbers(&self, model: &Model) -> usize {
        let dofs = |joints: &[JointId]| -> usize {
            joints.iter().map(|j| model.dof_range(*j).len()).sum()
        };
        match self {
            Self::JointPosition(joints) => {
                let coordinates = joints.iter().map(|j| model.coordinate_range(*j).len());
                coordinates.sum()
            }
            Self::JointVelocity(joints) | Self::JointEffort(joints) => dofs(joints),
            Self::ActuatorForce(rows) => rows.len(),
            Self::Imu(_) | Self::ForceTorque(..) | Self::FrameVelocity(..) => 6,
            Self::Touch(_) => 1,
            Self::ContactForce(..) | Self::CenterOfMass(_) => 3,
            Self::FramePose(_) => 7,
            Self::Pressing(pairs) | Self::Overlapping(pairs) => pairs.len().div_ceil(FLAGS),
            Self::PairForce(pairs) => 3 * pairs.len(),
            Self::AtEnd(joints) => (2 * dofs(joints)).div_ceil(FLAGS),
        }
    }
}

/// What a solver tells and is told.
#[derive(Clone, Copy, Debug)]
pub struct Reported<'a> {
    /// Where it tells of a world.
    pub outputs: &'a OutputTables,
    /// Where it is told.
    pub inputs: &'a InputTables,
    /// The shapes of each row of contacts; none where they change from step to step, as they do only of solvers that step
    /// one world at a time.
    pub contact_shapes: &'a [[ShapeId; 2]],
    /// The share of the stiffness along each degree of freedom that acts, by this model's numbers: see
    /// [`Impulse::acting`](crate::impulse::Impulse::acting); of other solvers 1.
    pub acting: &'a [f64],
}

/// A model, and what is reported of it.
type Of<'a> = (&'a Model, &'a Reported<'a>);

/// Where gauges write.
type Told = Table<Output>;

/// Where numbers of a solver lie for gauges.
fn reported<S: Space, T: Space, const W: usize>(table: Table<S, W>) -> Table<T, W> {
    Table::place(&mut table.start(), 0)
}

/// Gauges, sorted by what they take.
#[derive(Default)]
struct AllNotes {
    copies: Notes<2, 0>,
    frames: FrameNotes,
    contacts: ContactNotes,
    touches: TouchNotes,
    pairs: PairNotes,
    ends: EndNotes,
    efforts: EffortNotes,
    centers: CenterNotes,
}

impl AllNotes {
    /// Notes that a gauge tells its numbers from `to` on.
    fn add(&mut self, (model, all): Of<'_>, gauge: &Gauge, mut to: usize) {
        let outputs = all.outputs;
        match gauge {
            Gauge::JointPosition(joints) => {
                for row in joints.iter().flat_map(|j| model.coordinate_range(*j)) {
                    self.copies.add([outputs.position.at(row, 0), to], []);
                    to += 1;
                }
            }
            Gauge::JointVelocity(joints) => {
                for dof in joints.iter().flat_map(|j| model.dof_range(*j)) {
                    self.copies.add([outputs.velocity.at(dof, 0), to], []);
                    to += 1;
                }
            }
            Gauge::JointEffort(joints) => {
                for &joint in joints {
                    self.efforts.joint((model, all), joint, to);
                    to += model.dof_range(joint).len();
                }
            }
            Gauge::ActuatorForce(rows) => {
                for (i, &row) in rows.iter().enumerate() {
                    self.efforts.actuator((model, all), (row, 1.0), to + i);
                }
            }
            Gauge::Imu(mount) => self.frames.imu(model, mount, to),
            Gauge::ForceTorque(joint, frame) => self.frames.wrench(model, (*joint, *frame), to),
            Gauge::Touch(body) => self
                .touches
                .touch(((model, all), &mut self.contacts), *body, to),
            Gauge::ContactForce(body, axes) => {
                let own = |frames: &mut FrameNotes| frames.frame(model, &Mount::on(*body));
                let axes = self.frames.axes(model, *axes, own);
                let of = ((model, all), &mut self.contacts);
                self.touches.force(of, (*body, axes), to);
            }
            Gauge::FramePose([frame, relative]) => {
                self.frames.pose(model, [frame, relative], to);
            }
            Gauge::FrameVelocity(mount, axes) => self.frames.velocity(model, (mount, *axes), to),
            Gauge::Pressing(pairs) => self.pairs.presses((all, &mut self.contacts), pairs, to),
            Gauge::Overlapping(pairs) => self.pairs.overlaps((all, &mut self.contacts), pairs, to),
            Gauge::PairForce(pairs) => self.pairs.forces((all, &mut self.contacts), pairs, to),
            Gauge::AtEnd(joints) => self.ends.add((model, outputs), joints, to),
            Gauge::CenterOfMass(of) => {
                if let (false, Some(of)) = (self.centers.center(model, *of, to), of) {
                    for i in 0..3 {
                        let from = outputs.body.at(of.0, body::POSITION + i);
                        self.copies.add([from, to + i], []);
                    }
                }
            }
        }
    }
}

/// Where the numbers lie.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Tables {
    told: Told,
    /// How many numbers are told.
    count: usize,
    /// All that was reported.
    all: Table<Input>,
    /// FROM, of `all`; TO.
    copies: Rows<2, 0>,
    frames: Frames,
    contacts: Contacts,
    touches: Touches,
    pairs: Pairs,
    ends: Ends,
    efforts: Efforts,
    centers: Centers,
}

/// Gauges of a model, compiled to tables.
#[derive(Clone, Debug, PartialEq)]
pub struct Gauges {
    tables: Tables,
    /// Where each of them writes.
    numbers: Vec<Range<usize>>,
    sheet: Sheet,
}

impl Gauges {
    /// Of gauges of bodies, joints and actuators that the model has. Models of one structure differ in the
    /// [parameters](Sheet::parameters) alone.
    pub fn new(model: &Model, reported: &Reported<'_>, list: &[Gauge]) -> Self {
        let mut notes = AllNotes::default();
        let mut numbers: Vec<Range<usize>> = Vec::with_capacity(list.len());
        let mut count = 0;
        for gauge in list {
            notes.add((model, reported), gauge, count);
            numbers.push(count..count + gauge.numbers(model));
            count += gauge.numbers(model);
        }
        let (mut parameters, mut links, mut scratch) = (0, 0, 0);
        let of = (model, reported.outputs);
        let tables = Tables {
            told: Table::place(&mut 0, count),
            count,
            all: Table::place(&mut 0, 0),
            copies: notes.copies.place(&mut parameters, &mut links),
            frames: notes
                .frames
                .place(of, [&mut parameters, &mut links, &mut scratch]),
            contacts: notes
                .contacts
                .place(reported, [&mut parameters, &mut links]),
            touches: notes.touches.place(of, [&mut parameters, &mut links]),
            pairs: notes.pairs.place(&mut parameters, &mut links),
            ends: notes.ends.place(&mut parameters, &mut links),
            efforts: notes.efforts.place(reported, [&mut parameters, &mut links]),
            centers: notes.centers.place(&mut parameters, &mut links),
        };
        let mut f = Filler::new(parameters, links);
        tables.copies.fill(&notes.copies, &mut f);
        tables.frames.fill(&notes.frames, model, &mut f);
        tables.contacts.fill(&notes.contacts, &mut f);
        tables.touches.fill(&notes.touches, model, &mut f);
        tables.pairs.fill(&notes.pairs, &mut f);
        tables.ends.fill(&notes.ends, &mut f);
        tables.efforts.fill(&notes.efforts, &mut f);
        tables.centers.fill(&notes.centers, &mut f);
        let sums = notes.touches.rounds() + notes.efforts.rounds() + notes.centers.rounds();
        let flags = notes.contacts.rounds() + notes.pairs.rounds() + notes.ends.len();
        let rounds = count + notes.copies.len() + notes.frames.rounds() + sums + flags;
        Self {
            tables,
            numbers,
            sheet: Sheet::new(f, [count, scratch], rounds),
        }
    }

    /// Where each gauge writes, in their order.
    pub fn numbers(&self) -> &[Range<usize>] {
        &self.numbers
    }
    /// What they are compiled to.
    pub fn sheet(&self) -> &Sheet {
        &self.sheet
    }

    /// Writes what all gauges read.
    #[inline(always)]
    pub fn measure<M: Machine>(&self, k: &mut M) {
        // A copy on the stack: offsets stay in registers, whatever is written meanwhile.
        let t = self.tables;
        for number in k.count(t.count) {
            k.store(t.told, number, 0, M::R::zero());
        }
        for row in t.copies.all(k) {
            let [from, to] = t.copies.links(k, row);
            let x = k.load(t.all, from, 0);
            k.store(t.told, to, 0, x);
        }
        t.frames.place(k);
        t.frames.tell(k, t.told);
        t.touches.tell(k, (&t.contacts, &t.frames), t.told);
        t.pairs.tell(k, &t.contacts, t.told);
        t.ends.tell(k, t.all, t.told);
        t.efforts.tell(k, t.told);
        t.centers.tell(k, &t.frames, t.told);
    }
}
