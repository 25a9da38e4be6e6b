//! Bodies, shapes and contacts in lanes: gathered, worked on, and put back.

use super::batches::Batch;
use numbers::dispatch::Job;
use numbers::{Cpu, Float, Lanes, PerWorld, Rows};
use rigid::impulse::pair::{Placed, ShapeTables, place, placed, solid};
use rigid::impulse::{BodyTables, ContactTables, body, contact, global, mass, row};

/// The bodies of a world while it steps; row 0 is what does not move.
pub(super) type BodyRows<T> = Rows<T, { row::WIDTH }>;

/// What to do with bodies.
#[derive(Clone, Copy, Debug)]
pub(super) enum BodyStage {
    Begin,
    /// `again`: the contacts have given in the small step before.
    Advance {
        again: bool,
    },
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
fn spread<R: Lanes, const N: usize>(globals: &[R::Scalar; global::WIDTH]) -> [R; N] {
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

impl<T: Float> Job for Bodies<'_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let t = BodyTables::new();
        let mut parameters: [R; BODY_PARAMETERS] = spread(self.globals);
        let mut numbers = [R::zero(); row::WIDTH];
        for batch in 0..self.index.len() / R::WIDTH {
            let index = &self.index[batch * R::WIDTH..];
            let rows = self.rows;
            match self.stage {
                BodyStage::Begin => {
                    fill::<R, { mass::WIDTH }>(&mut parameters, index, self.masses, global::WIDTH);
                    rows.gather::<R, 6>(index, row::VELOCITY, &mut numbers[row::VELOCITY..]);
                    rows.gather::<R, 4>(index, row::ORIENTATION, &mut numbers[row::ORIENTATION..]);
                    rows.gather::<R, 6>(index, row::WRENCH, &mut numbers[row::WRENCH..]);
                }
                BodyStage::Finish => {
                    fill::<R, { mass::WIDTH }>(&mut parameters, index, self.masses, global::WIDTH);
                    rows.gather::<R, { row::MOVING }>(index, 0, &mut numbers);
                    rows.gather::<R, 7>(index, row::CENTER, &mut numbers[row::CENTER..]);
                    rows.gather::<R, 12>(
                        index,
                        row::ACCELERATION,
                        &mut numbers[row::ACCELERATION..],
                    );
                }
                BodyStage::Advance { .. } => {
                    rows.gather::<R, 6>(index, row::VELOCITY, &mut numbers[row::VELOCITY..]);
                    rows.gather::<R, 12>(index, row::FREE, &mut numbers[row::FREE..]);
                }
                BodyStage::Drift => rows.gather::<R, { row::MOVING }>(index, 0, &mut numbers),
            }
            let mut k = Cpu {
                state: &mut numbers,
                input: &[],
                output: &mut [],
                scratch: &mut [],
                parameters: PerWorld(&parameters),
                links: &[],
            };
            match self.stage {
                BodyStage::Begin => body::begin(&mut k, &t),
                BodyStage::Advance { again } => {
                    body::advance(&mut k, &t, R::lit(if again { 1.0 } else { 0.0 }));
                }
                BodyStage::Drift => body::drift(&mut k, &t),
                BodyStage::Finish => body::finish(&mut k, &t),
            }
            match self.stage {
                BodyStage::Begin => {
                    rows.scatter::<R, 13>(index, row::SHIFT, &numbers[row::SHIFT..]);
                    rows.scatter::<R, 12>(index, row::FREE, &numbers[row::FREE..]);
                }
                BodyStage::Finish => {
                    rows.scatter::<R, 3>(index, row::SPIN, &numbers[row::SPIN..]);
                    rows.scatter::<R, 7>(index, row::CENTER, &numbers[row::CENTER..]);
                }
                BodyStage::Advance { .. } => {
                    rows.scatter::<R, 6>(index, row::VELOCITY, &numbers[row::VELOCITY..]);
                    rows.scatter::<R, 6>(index, row::FREE, &numbers[row::FREE..]);
                }
                BodyStage::Drift => rows.scatter::<R, 6>(index, row::SHIFT, &numbers[row::SHIFT..]),
            }
        }
    }
}

/// Shapes put in their places.
pub(super) struct Shapes<'a, T: Float> {
    pub rows: &'a BodyRows<T>,
    /// Body of each shape, filled up to whole registers with row 0.
    pub carriers: &'a [u32],
    /// The shapes themselves, filled up with the last one.
    pub index: &'a [u32],
    /// Constants of each shape: one row of [`solid`] a row.
    pub solids: &'a [T],
    pub globals: &'a [T; global::WIDTH],
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
            let (rows, mut scratch) = (self.rows, [R::zero(); 19]);
            rows.gather::<R, 6>(carriers, row::VELOCITY, &mut scratch);
            rows.gather::<R, 6>(carriers, row::ACCELERATION, &mut scratch[6..]);
            rows.gather::<R, 7>(carriers, row::CENTER, &mut scratch[12..]);
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
                let placed = &mut self.placed[index[lane] as usize];
                for i in 0..placed::WIDTH {
                    placed.placed[i] = numbers[i * R::WIDTH + lane];
                }
            }
        }
    }
}

/// What to do with contacts.
#[derive(Clone, Copy, Debug)]
pub(super) enum ContactStage {
    Prepare,
    WarmStart,
    Solve { pushing: bool },
    Bounce,
}

/// Contacts in lanes.
pub(super) struct Contacts<'a, 'b, T: Float> {
    pub rows: &'a BodyRows<T>,
    pub batches: &'a mut [Batch<'b, T>],
    pub globals: &'a [T; global::WIDTH],
    pub stage: ContactStage,
}

impl<T: Float> Job for Contacts<'_, '_, T> {
    type Scalar = T;
    type Output = ();
    #[inline(always)]
    fn run<R: Lanes<Scalar = T>>(self) {
        let t = ContactTables::new();
        let parameters: [R; global::WIDTH] = spread(self.globals);
        let mut pair = [R::zero(); 2 * row::PREPARED];
        for batch in self.batches.iter_mut() {
            for side in 0..2 {
                let bodies = &batch.bodies[side * R::WIDTH..];
                let to = &mut pair[side * row::PREPARED..];
                if matches!(self.stage, ContactStage::Prepare) {
                    self.rows.gather::<R, { row::PREPARED }>(bodies, 0, to);
                } else {
                    self.rows.gather::<R, { row::MOVING }>(bodies, 0, to);
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
            match self.stage {
                ContactStage::Prepare => contact::prepare(&mut k, &t),
                ContactStage::WarmStart => contact::warm_start(&mut k, &t),
                ContactStage::Solve { pushing } => {
                    contact::solve(&mut k, &t, R::lit(if pushing { 1.0 } else { 0.0 }));
                }
                ContactStage::Bounce => contact::bounce(&mut k, &t),
            }
            if !matches!(self.stage, ContactStage::Prepare) {
                for side in 0..2 {
                    let bodies = &batch.bodies[side * R::WIDTH..];
                    let from = &pair[side * row::PREPARED..];
                    self.rows.scatter::<R, 6>(bodies, row::VELOCITY, from);
                }
            }
        }
    }
}
