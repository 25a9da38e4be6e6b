//! Bodies, shapes and contacts in lanes: gathered, worked on, and put back.

use super::batches::Batch;
use numbers::dispatch::Job;
use numbers::{Cpu, Float, Lanes, Machine, PerWorld, Picked, Rows};
use rigid::impulse::pair::{Placed, ShapeTables, place, placed, solid};
use rigid::impulse::{BodyTables, ContactTables, blow, body, contact, global, mass, row};

/// The bodies of a world while it steps; row 0 is what does not move.
pub(super) type BodyRows<T> = Rows<T, { row::WIDTH / 4 }>;
/// Some of them, a lane each.
type PickedBodies<'a, T> = Picked<'a, T, { row::WIDTH / 4 }>;

/// What to do with bodies.
#[derive(Clone, Copy, Debug)]
pub(super) enum BodyStage {
    Begin,
    /// `again`: the contacts have given in the small step before.
    Advance {
        again: bool,
    },
    Part,
    Drift,
    Finish,
}

/// Bodies in lanes: `rows` has a register's worth of them for each batch, row 0 where there is none.
pub(super) struct Bodies<'a, T: Float> {
    pub rows: &'a BodyRows<T>,
    pub index: &'a [u32],
    /// Constants of each body: one row of [`mass`] a row.
    pub masses: &'a [T],
    pub globals: &'a [T; global::WIDTH],
    pub stage: BodyStage,
}

/// The same constants in every lane, where a kernel looks for them.
#[inline(always)]
pub(super) fn spread<R: Lanes, const N: usize>(globals: &[R::Scalar; global::WIDTH]) -> [R; N] {
    let mut registers = [R::zero(); N];
    for i in 0..global::WIDTH {
        registers[i] = R::splat(globals[i]);
    }
    registers
}

/// Numbers of several rows, a lane each.
#[inline(always)]
fn fill<R: Lanes, const W: usize>(
    registers: &mut [R],
    index: &[u32],
    numbers: &[R::Scalar],
    first: usize,
) {
    let lanes: &mut [R::Scalar] = bytemuck::cast_slice_mut(registers);
    for lane in 0..R::WIDTH {
        let start = index[lane] as usize * W;
        let row = &numbers[start..start + W];
        for i in 0..W {
            lanes[(first + i) * R::WIDTH + lane] = row[i];
        }
    }
}

const BODY_PARAMETERS: usize = global::WIDTH + mass::WIDTH;

/// A stage as a type, so that it is chosen once and not in every batch.
trait BodyWork {
    /// Whether the kernel reads the bodies' constants.
    const MASSES: bool;
    /// Reads what the kernel needs.
    fn gather<R: Lanes>(rows: &PickedBodies<'_, R::Scalar>, to: &mut [R; row::WIDTH]);
    fn run<M: Machine>(k: &mut M, t: &BodyTables, again: M::R);
    /// Writes what the kernel changed.
    fn scatter<R: Lanes>(rows: &PickedBodies<'_, R::Scalar>, from: &[R; row::WIDTH]);
}

/// A stage's kernel, whether it reads the bodies' constants, and the fields that it reads and writes,
/// as `FIELD: COUNT`. Whole quads are written sooner than single fields, so that some are written as they were.
macro_rules! body_work {
    ($($name:ident($k:ident, $t:ident, $again:ident) = $kernel:expr;
       masses $masses:literal; reads $($from:ident: $n:expr),+; writes $($to:ident: $m:expr),+;)+) => {
        $(struct $name;
        impl BodyWork for $name {
            const MASSES: bool = $masses;
            #[inline(always)]
            fn gather<R: Lanes>(rows: &PickedBodies<'_, R::Scalar>, to: &mut [R; row::WIDTH]) {
                $(rows.gather::<R, { $n }>(row::$from, &mut to[row::$from..]);)+
            }
            #[inline(always)]
            fn run<M: Machine>($k: &mut M, $t: &BodyTables, $again: M::R) {
                $kernel
            }
            #[inline(always)]
            fn scatter<R: Lanes>(rows: &PickedBodies<'_, R::Scalar>, from: &[R; row::WIDTH]) {
                $(rows.scatter::<R, { $m }>(row::$to, &from[row::$to..]);)+
            }
        })+
    };
}

body_work! {
    Begin(k, t, _again) = body::begin(k, t);
    masses true; reads VELOCITY: row::PLACED, WRENCH: 6; writes VELOCITY: 20, FREE: 12;

    Advance(k, t, again) = body::advance(k, t, again);
    masses false; reads VELOCITY: 8, FREE: 12; writes VELOCITY: 8, FREE: 8;

    Part(k, t, _again) = body::part(k, t);
    masses false; reads VELOCITY: 8, FREE: 8; writes FREE: 8;

    Drift(k, t, _again) = body::drift(k, t);
    masses false; reads VELOCITY: row::MOVING; writes VELOCITY: row::MOVING;

    Finish(k, t, _again) = body::finish(k, t);
    masses true; reads VELOCITY: row::PLACED, ACCELERATION: 12; writes VELOCITY: row::PLACED;
}

impl<T: Float> Job for Bodies<'_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        match self.stage {
            BodyStage::Begin => self.work::<R, Begin>(false),
            BodyStage::Advance { again } => self.work::<R, Advance>(again),
            BodyStage::Part => self.work::<R, Part>(false),
            BodyStage::Drift => self.work::<R, Drift>(false),
            BodyStage::Finish => self.work::<R, Finish>(false),
        }
    }
}

impl<T: Float> Bodies<'_, T> {
    #[inline(always)]
    fn work<R: Lanes<Scalar = T>, W: BodyWork>(self, again: bool) {
        let t = BodyTables::new();
        let again = R::lit(if again { 1.0 } else { 0.0 });
        let mut parameters: [R; BODY_PARAMETERS] = spread(self.globals);
        let mut numbers = [R::zero(); row::WIDTH];
        for batch in 0..self.index.len() / R::WIDTH {
            let index = &self.index[batch * R::WIDTH..];
            if W::MASSES {
                fill::<R, { mass::WIDTH }>(&mut parameters, index, self.masses, global::WIDTH);
            }
            let rows = self.rows.pick::<R>(index);
            W::gather(&rows, &mut numbers);
            let mut k = Cpu {
                state: &mut numbers,
                input: &[],
                output: &mut [],
                scratch: &mut [],
                parameters: PerWorld(&parameters),
                links: &[],
            };
            W::run(&mut k, &t, again);
            W::scatter(&rows, &numbers);
        }
    }
}

/// Shapes put in their places.
pub(super) struct Shapes<'a, T: Float> {
    pub rows: &'a BodyRows<T>,
    /// Body of each shape, filled up to whole registers with that of the last one.
    pub carriers: &'a [u32],
    /// The shapes themselves, filled up with the last one.
    pub index: &'a [u32],
    /// Constants of each shape: one row of [`solid`] a row.
    pub solids: &'a [T],
    pub globals: &'a [T; global::WIDTH],
    /// From the first of these shapes on.
    pub placed: &'a mut [Placed<T>],
}

const SHAPE_PARAMETERS: usize = global::WIDTH + solid::WIDTH;

impl<T: Float> Job for Shapes<'_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let t = ShapeTables::new();
        let mut parameters: [R; SHAPE_PARAMETERS] = spread(self.globals);
        for batch in 0..self.index.len() / R::WIDTH {
            let index = &self.index[batch * R::WIDTH..];
            let carriers = &self.carriers[batch * R::WIDTH..];
            fill::<R, { solid::WIDTH }>(&mut parameters, index, self.solids, global::WIDTH);
            let (rows, mut scratch) = (self.rows.pick::<R>(carriers), [R::zero(); 19]);
            rows.gather::<R, 6>(row::VELOCITY, &mut scratch);
            rows.gather::<R, 6>(row::ACCELERATION, &mut scratch[6..]);
            rows.gather::<R, 7>(row::CENTER, &mut scratch[12..]);
            let mut found = [R::zero(); placed::WIDTH];
            let mut k = Cpu {
                state: &mut found,
                input: &[],
                output: &mut [],
                scratch: &mut scratch,
                parameters: PerWorld(&parameters),
                links: &[],
            };
            place(&mut k, &t);
            let numbers: &[T] = bytemuck::cast_slice(&found);
            for lane in 0..R::WIDTH {
                let shape = index[lane] as usize;
                let to = &mut self.placed[shape - self.index[0] as usize];
                let solid = &self.solids[shape * solid::WIDTH..];
                to.size = [
                    solid[solid::SIZE],
                    solid[solid::SIZE + 1],
                    solid[solid::SIZE + 2],
                ];
                for i in 0..placed::WIDTH {
                    to.placed[i] = numbers[i * R::WIDTH + lane];
                }
            }
        }
    }
}

/// What to do with contacts.
#[derive(Clone, Copy, Debug)]
pub(super) enum ContactStage {
    Prepare,
    Foresee,
    WarmStart,
    Strike,
    Solve { pushing: bool },
}

/// Contacts in lanes.
pub(super) struct Contacts<'a, 'b, T: Float> {
    pub rows: &'a BodyRows<T>,
    pub batches: &'a mut [Batch<'b, T>],
    pub globals: &'a [T; global::WIDTH],
    pub stage: ContactStage,
}

/// A stage as a type, as for bodies.
trait ContactWork {
    const READS: Reads;
    fn run<M: Machine>(k: &mut M, t: &ContactTables, pushing: M::R);
}

/// What a stage needs of the bodies: all, to change nothing, or the motion, which it changes.
enum Reads {
    All,
    Motion,
}

macro_rules! contact_work {
    ($($name:ident($k:ident, $t:ident, $pushing:ident) = $kernel:expr, $reads:ident;)+) => {
        $(struct $name;
        impl ContactWork for $name {
            const READS: Reads = Reads::$reads;
            #[inline(always)]
            fn run<M: Machine>($k: &mut M, $t: &ContactTables, $pushing: M::R) {
                $kernel
            }
        })+
    };
}

contact_work! {
    Prepare(k, t, _pushing) = contact::prepare(k, t), All;
    Foresee(k, t, _pushing) = blow::foresee(k, t), Motion;
    WarmStart(k, t, _pushing) = contact::warm_start(k, t), Motion;
    Strike(k, t, _pushing) = blow::strike(k, t), Motion;
    Solve(k, t, pushing) = contact::solve(k, t, pushing), Motion;
}

impl<T: Float> Job for Contacts<'_, '_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        match self.stage {
            ContactStage::Prepare => self.work::<R, Prepare>(false),
            ContactStage::Foresee => self.work::<R, Foresee>(false),
            ContactStage::WarmStart => self.work::<R, WarmStart>(false),
            ContactStage::Strike => self.work::<R, Strike>(false),
            ContactStage::Solve { pushing } => self.work::<R, Solve>(pushing),
        }
    }
}

/// What a contact or a joint writes of its bodies: velocity and spin, and, for whole quads, what follows as it was.
pub(super) const WRITTEN: usize = 8;

impl<T: Float> Contacts<'_, '_, T> {
    #[inline(always)]
    fn work<R: Lanes<Scalar = T>, W: ContactWork>(self, pushing: bool) {
        let t = ContactTables::new();
        let pushing = R::lit(if pushing { 1.0 } else { 0.0 });
        let parameters: [R; global::WIDTH] = spread(self.globals);
        let mut pair = [R::zero(); 2 * row::PREPARED];
        for batch in self.batches.iter_mut() {
            let bodies = [
                self.rows.pick::<R>(batch.bodies),
                self.rows.pick::<R>(&batch.bodies[R::WIDTH..]),
            ];
            for side in 0..2 {
                let to = &mut pair[side * row::PREPARED..];
                match W::READS {
                    Reads::All => bodies[side].gather::<R, { row::PREPARED }>(0, to),
                    Reads::Motion => bodies[side].gather::<R, { row::MOVING }>(0, to),
                }
            }
            let mut k = Cpu {
                state: bytemuck::cast_slice_mut(batch.numbers),
                input: &[],
                output: &mut [],
                scratch: &mut pair,
                parameters: PerWorld(&parameters),
                links: core::slice::from_ref(&batch.points),
            };
            W::run(&mut k, &t, pushing);
            for side in 0..2 {
                if let Reads::Motion = W::READS {
                    let from = &pair[side * row::PREPARED..];
                    bodies[side].scatter::<R, WRITTEN>(row::VELOCITY, from);
                }
            }
        }
    }
}
