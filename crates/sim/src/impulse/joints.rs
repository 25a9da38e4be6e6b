//! Joints in lanes: gathered, worked on, and put back, as contacts are.

use super::colours::Colours;
use super::jobs::{BodyRows, WRITTEN, spread};
use numbers::dispatch::Job;
use numbers::{Cpu, Float, Lanes, Machine, Memory, PerWorld};
use rigid::impulse::joint::{
    self, Actuators, JointTables, PLACED, ROWS, Sources, Tied, axis, axis_link, joint as field,
};
use rigid::impulse::{Impulse, State, global, row};

/// Memory for joints in lanes; kept from step to step, its contents are not.
pub(super) struct JointLanes<T> {
    numbers: Memory<T>,
    /// Bodies A, then bodies B, of each batch.
    bodies: Vec<u32>,
}

impl<T: Float> Default for JointLanes<T> {
    fn default() -> Self {
        Self {
            numbers: Memory::new(0, 1, 1),
            bodies: Vec::new(),
        }
    }
}

/// A register's worth of joints of one colour.
pub(super) struct JointBatch<'a, T> {
    numbers: &'a mut [T],
    /// Bodies A, then bodies B, a lane each; row 0 where nothing moves.
    bodies: &'a mut [u32],
    /// Which of the joints these are.
    members: &'a [u32],
    links: [u32; ROWS * axis_link::WIDTH],
}

impl<T: Float> JointLanes<T> {
    /// Room for so many batches of `width` joints.
    pub fn make_room(&mut self, batches: usize, width: usize) {
        let (lanes, length) = (batches * width, JointTables::new().length);
        let fits = self.numbers.width() == width && self.numbers.length() == length;
        if !fits || self.numbers.worlds() < lanes {
            self.numbers = Memory::new(lanes, length, width);
        }
        self.bodies.resize(2 * lanes.max(self.bodies.len() / 2), 0);
    }

    /// The batches, each with its joints, and still to be filled.
    pub fn batches<'a>(
        &'a mut self,
        members: impl Iterator<Item = &'a [u32]>,
        width: usize,
    ) -> impl Iterator<Item = JointBatch<'a, T>> {
        let block = self.numbers.block_size();
        let numbers = self.numbers.scalars_mut().chunks_exact_mut(block);
        let bodies = self.bodies.chunks_exact_mut(2 * width);
        let rooms = numbers.zip(bodies).zip(members);
        rooms.map(|((numbers, bodies), members)| JointBatch {
            numbers,
            bodies,
            members,
            links: [0; ROWS * axis_link::WIDTH],
        })
    }

    /// Takes back what the joints of a batch carry to the next step.
    pub fn read(
        &self,
        batch: usize,
        joints: impl Iterator<Item = usize>,
        impulse: &Impulse,
        state: &mut [T],
    ) {
        let t = JointTables::new();
        let (numbers, width) = (self.numbers.block(batch), self.numbers.width());
        for (lane, tie) in joints.enumerate() {
            let fields = t.joint.at(0, field::TARGET)..t.joint.at(0, field::WRITTEN);
            let carried = fields.map(|at| numbers[at * width + lane]);
            impulse.keep_tied(tie, carried, state);
        }
    }
}

impl<T: Float> JointBatch<'_, T> {
    /// Writes the joints into their lanes, for the first part of a step or another.
    pub fn fill(&mut self, joints: &[u32], state: &State<'_, T>, input: &[T], first: bool) {
        let width = self.bodies.len() / 2;
        self.bodies.fill(0);
        let tie = |member: u32| joints[member as usize] as usize;
        let sources = self.members.iter();
        let sources = sources.map(|member| state.impulse.sources(tie(*member)));
        let room = sources.fold(Sources::default(), Sources::max);
        let mut next = 0;
        for (row, end) in room.laws.into_iter().enumerate() {
            let links = &mut self.links[row * axis_link::WIDTH..];
            links[axis_link::ACTS] = 0;
            links[axis_link::FIRST] = next;
            next += end as u32;
            links[axis_link::END] = next;
        }
        let mut actuators = Actuators::default();
        for (lane, &member) in self.members.iter().enumerate() {
            let tie = tie(member);
            let rows = state.impulse.tied_rows(tie).unwrap_or_default();
            for (side, row) in rows.into_iter().enumerate() {
                self.bodies[side * width + lane] = row;
            }
            let tied = state
                .impulse
                .tied(tie, state.parameters, input, &mut actuators);
            let carried = state.impulse.carried(tie, state.state);
            self.write(lane, width, &tied, carried);
            if first {
                let sum = JointTables::new().joint.at(0, field::SUM);
                (sum..sum + 6).for_each(|at| self.numbers[at * width + lane] = T::zero());
            }
        }
    }

    fn write(&mut self, lane: usize, width: usize, tied: &Tied, carried: &[T]) {
        let t = JointTables::new();
        let target = t.joint.at(0, field::CONSTANTS);
        for (i, x) in carried.iter().enumerate() {
            self.numbers[(target + i) * width + lane] = *x;
        }
        let mut put = |at: usize, numbers: &[f64]| {
            for (i, x) in numbers.iter().enumerate() {
                self.numbers[(at + i) * width + lane] = T::from_f64(*x);
            }
        };
        put(t.joint.at(0, 0), &tied.joint);
        for row in 0..ROWS {
            put(t.axis.at(row, 0), &tied.axes[row]);
            let links = &mut self.links[row * axis_link::WIDTH..];
            if tied.axes[row][axis::ACTS] > 0.0 {
                links[axis_link::ACTS] = 1;
            }
            let laws = links[axis_link::FIRST]..links[axis_link::END];
            for (at, law) in laws.zip(&tied.laws[row]) {
                put(t.law.at(at as usize, 0), law);
            }
        }
    }
}

/// Joints, given the rows of their bodies, in runs of which each may be solved side by side, one run after the other.
pub fn joint_runs(joints: &[[u32; 2]], bodies: usize) -> Vec<Vec<u32>> {
    let ends: Vec<_> = joints.iter().map(|rows| (*rows, 0)).collect();
    let mut colours = Colours::default();
    colours.paint(&ends, bodies, joints.len().max(1));
    let batches = 0..colours.batches.len();
    batches.map(|i| colours.batch(i).to_vec()).collect()
}

/// What to do with joints.
#[derive(Clone, Copy, Debug)]
pub(super) enum JointStage {
    Follow,
    Place,
    WarmStart,
    Solve { pushing: bool },
    Strike,
}

/// Joints in lanes.
pub(super) struct Joints<'a, 'b, T: Float> {
    pub rows: &'a BodyRows<T>,
    pub batches: &'a mut [JointBatch<'b, T>],
    pub globals: &'a [T; global::WIDTH],
    pub stage: JointStage,
}

/// What a stage sees of the bodies of a joint.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sees {
    Nothing,
    /// All of them, and changes nothing.
    Place,
    /// Their motion, which it changes.
    Motion,
}

/// A stage as a type, as for bodies.
trait JointWork {
    /// What it sees of its bodies.
    const SEES: Sees;
    fn run<M: Machine>(k: &mut M, t: &JointTables, pushing: M::R);
}

macro_rules! joint_work {
    ($($name:ident($k:ident, $t:ident, $pushing:ident) = $kernel:expr, $sees:ident;)+) => {
        $(struct $name;
        impl JointWork for $name {
            const SEES: Sees = Sees::$sees;
            #[inline(always)]
            fn run<M: Machine>($k: &mut M, $t: &JointTables, $pushing: M::R) {
                $kernel
            }
        })+
    };
}

joint_work! {
    Follow(k, t, _pushing) = joint::follow(k, t), Nothing;
    Place(k, t, _pushing) = joint::place(k, t), Place;
    WarmStart(k, t, _pushing) = joint::warm_start(k, t), Motion;
    Solve(k, t, pushing) = joint::solve(k, t, pushing), Motion;
    Strike(k, t, _pushing) = joint::strike(k, t), Motion;
}

impl<T: Float> Job for Joints<'_, '_, T> {
    type Scalar = T;
    type Output = ();
    const WIDEST: bool = false;
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        match self.stage {
            JointStage::Follow => self.work::<R, Follow>(false),
            JointStage::Place => self.work::<R, Place>(false),
            JointStage::WarmStart => self.work::<R, WarmStart>(false),
            JointStage::Solve { pushing } => self.work::<R, Solve>(pushing),
            JointStage::Strike => self.work::<R, Strike>(false),
        }
    }
}

impl<T: Float> Joints<'_, '_, T> {
    #[inline(always)]
    fn work<R: Lanes<Scalar = T>, W: JointWork>(self, pushing: bool) {
        let t = JointTables::new();
        let pushing = R::lit(if pushing { 1.0 } else { 0.0 });
        let parameters: [R; global::WIDTH] = spread(self.globals);
        let mut work = [R::zero(); JointTables::SCRATCH];
        for batch in self.batches.iter_mut() {
            let bodies = [
                self.rows.pick::<R>(batch.bodies),
                self.rows.pick::<R>(&batch.bodies[R::WIDTH..]),
            ];
            for side in 0..2 {
                let to = &mut work[side * PLACED..];
                match W::SEES {
                    Sees::Nothing => {}
                    Sees::Place => bodies[side].gather::<R, PLACED>(0, to),
                    Sees::Motion => bodies[side].gather::<R, WRITTEN>(row::VELOCITY, to),
                }
            }
            let mut k = Cpu {
                state: bytemuck::cast_slice_mut(batch.numbers),
                input: &[],
                output: &mut [],
                scratch: &mut work,
                parameters: PerWorld(&parameters),
                links: &batch.links,
            };
            W::run(&mut k, &t, pushing);
            for side in 0..2 {
                if W::SEES == Sees::Motion {
                    let from = &work[side * PLACED..];
                    bodies[side].scatter::<R, WRITTEN>(row::VELOCITY, from);
                }
            }
        }
    }
}
