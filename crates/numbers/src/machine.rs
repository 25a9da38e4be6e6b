//! What a kernel needs beyond arithmetic: tables, links and loops.
//!
//! A kernel is a function over a [`Machine`]. Everything that a plain program
//! would do with arrays, `for` and `if` goes through it, in one form that every
//! reading understands:
//!
//! ```text
//! for b in k.range(0, bodies) {          // a loop; stays a loop when traced
//!     let parent = k.link(t.parent, b, 0);        // an index read from a table
//!     if let Some(_branch) = k.when(k.equals(kind, REVOLUTE)) { // a branch that is the same in all worlds
//!         ...
//!     }
//!     if let Some(_branch) = k.if_any(mask) {           // work that is skipped when no lane needs it
//!         k.store_where(mask, table, b, FIELD, x);
//!     }
//!     if k.finished(done) { break; }      // leave when every lane is done
//! }
//! ```
//!
//! On the CPU these are a range, a branch and `any()`; the tracer hands out a
//! symbolic index and closes a loop when its iterator is asked again, a branch
//! when it is dropped.
//! Two rules follow. A value that changes from one round to the next lives in a
//! table or a [`Cell`], not in a `let mut`. And inside `if_any`, writes are
//! masked, since the lanes that did not ask run along.
//!
//! A table can hold rows, too: [`number`](Machine::number) makes one of an index, and [`whole`](Machine::whole)
//! an index of it again.

use crate::spatial::{Inertia, Spatial};
use crate::{Float, Known, LanesMask, Mat3, Pose, Quat, Real, SymMat3, Vec3};
use core::fmt::Debug;
use core::marker::PhantomData;
use core::ops::Range;

/// The memories a kernel reads and writes.
pub mod space {
    /// Which memory a table lies in.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
    #[allow(missing_docs)]
    pub enum Kind {
        State,
        Input,
        Output,
        Scratch,
        Parameter,
    }
    /// A memory of numbers.
    pub trait Space: Copy {
        /// Which one.
        const KIND: Kind;
    }
    /// A memory that kernels may write.
    pub trait Writable: Space {}

    macro_rules! space {
        ($(#[$doc:meta])* $name:ident) => {
            $(#[$doc])*
            #[derive(Clone, Copy, Debug, PartialEq, Eq)]
            pub struct $name;
            impl Space for $name {
                const KIND: Kind = Kind::$name;
            }
        };
    }
    space!(
        /// What a world carries from step to step.
        State
    );
    space!(
        /// What a controller writes and a kernel reads, per world.
        Input
    );
    space!(
        /// What a kernel reports, per world.
        Output
    );
    space!(
        /// Intermediate results, per thread; contents do not outlive a block.
        Scratch
    );
    space!(
        /// Constants of the model, shared by all worlds or held per world.
        Parameter
    );
    impl Writable for State {}
    impl Writable for Output {}
    impl Writable for Scratch {}
}

use space::{Kind, Space, Writable};

/// Rows of `W` numbers, starting at `base`, in the memory `S`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Table<S, const W: usize = 1> {
    base: u32,
    memory: PhantomData<S>,
}

impl<S, const W: usize> Table<S, W> {
    /// `rows` rows, placed at `*end`, which moves past them.
    #[inline(always)]
    pub fn place(end: &mut usize, rows: usize) -> Self {
        Self {
            base: reserve(end, rows * W),
            memory: PhantomData,
        }
    }
    /// Offset of the first number.
    #[inline(always)]
    pub fn start(&self) -> usize {
        self.base as usize
    }
    /// Offset of a field of a row.
    pub fn at(&self, row: usize, field: usize) -> usize {
        self.base as usize + row * W + field
    }
}

/// Rows of `W` whole numbers (kinds, parents, ranges), the same in all worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Links<const W: usize = 1> {
    base: u32,
}

impl<const W: usize> Links<W> {
    /// `rows` rows, placed at `*end`, which moves past them.
    #[inline(always)]
    pub fn place(end: &mut usize, rows: usize) -> Self {
        Self {
            base: reserve(end, rows * W),
        }
    }
    /// Offset of the first number.
    #[inline(always)]
    pub fn start(&self) -> usize {
        self.base as usize
    }
    /// Offset of a field of a row.
    pub fn at(&self, row: usize, field: usize) -> usize {
        self.base as usize + row * W + field
    }
}

/// Moves `*end` past `length` numbers; returns where they start.
///
/// Panics beyond 2³² numbers: offsets are 32 bits wide, on the CPU so that one
/// comparison checks a bound, and in a shader because its words are.
#[inline(always)]
fn reserve(end: &mut usize, length: usize) -> u32 {
    let base = u32::try_from(*end).expect("a world has fewer than 2³² numbers");
    *end += length;
    base
}

/// A whole number that is the same in all lanes: a row, a count, a kind.
pub trait Index: Copy + Debug {
    /// Sum.
    fn plus(self, other: Self) -> Self;
    /// Sum with a literal.
    fn offset(self, n: usize) -> Self;
}

/// A number that changes from one round of a loop to the next.
pub trait Cell {
    /// The number.
    type R: Real;
    /// The present value.
    fn read(&self) -> Self::R;
    /// Replaces it.
    fn write(&mut self, x: Self::R);
}

/// What runs, or records, a kernel.
pub trait Machine {
    /// The numbers.
    type R: Real;
    /// The indices.
    type I: Index;
    /// A condition that is the same in all lanes.
    type Flag: Copy;
    /// A loop-carried number.
    type Cell: Cell<R = Self::R>;
    /// Rounds of a loop.
    type Rounds: Iterator<Item = Self::I>;
    /// A branch that is taken, for as long as it is held.
    type Branch;
    /// Whether it has registers to keep what the next round of a loop needs of this one's, and memory that is far away:
    /// graphics cards do, to a processor's lanes the nearest cache is no farther than their stack.
    const HANDS_ON: bool;

    /// A literal index.
    fn index(&self, i: usize) -> Self::I;
    /// Reads `N` neighbouring fields. Panics where they lie outside the memory.
    fn read<S: Space, const W: usize, const N: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> [Self::R; N];
    /// Writes neighbouring fields in all lanes. Panics where they lie outside the memory.
    fn write<S: Writable, const W: usize, const N: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        x: [Self::R; N],
    );
    /// Reads a whole number.
    fn link<const W: usize>(&self, links: Links<W>, row: Self::I, field: usize) -> Self::I;
    /// Reads the first `N` whole numbers of a row.
    fn link_row<const W: usize, const N: usize>(
        &self,
        links: Links<W>,
        row: Self::I,
    ) -> [Self::I; N];
    /// `from, from + 1, … to − 1`.
    fn range(&self, from: Self::I, to: Self::I) -> Self::Rounds;
    /// `n − 1, … 1, 0`.
    fn range_down(&self, n: Self::I) -> Self::Rounds;
    /// A branch if the flag holds.
    fn when(&self, flag: Self::Flag) -> Option<Self::Branch>;
    /// A branch if the mask holds in any lane.
    fn if_any(&self, mask: <Self::R as Real>::Mask) -> Option<Self::Branch>;
    /// True when the mask holds in every lane: `if k.finished(m) { break; }`.
    fn finished(&self, mask: <Self::R as Real>::Mask) -> bool;
    /// `a == b`.
    fn equals(&self, a: Self::I, b: usize) -> Self::Flag;
    /// `a < b`.
    fn less(&self, a: Self::I, b: Self::I) -> Self::Flag;
    /// A cell that holds `x`.
    fn cell(&self, x: Self::R) -> Self::Cell;
    /// An index as a number; exact below 2²⁴.
    fn number(&self, i: Self::I) -> Self::R;
    /// A number as an index, without its fraction, so that a table can hold rows.
    ///
    /// Must be the same in all lanes: the first counts.
    fn whole(&self, x: Self::R) -> Self::I;

    /// `0, 1, … n − 1` for a literal `n`.
    #[inline(always)]
    fn count(&self, n: usize) -> Self::Rounds {
        self.range(self.index(0), self.index(n))
    }
    /// Reads a number.
    #[inline(always)]
    fn load<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Self::R {
        let [x] = self.read(table, row, field);
        x
    }
    /// Writes a number.
    #[inline(always)]
    fn store<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        x: Self::R,
    ) {
        self.write(table, row, field, [x]);
    }
    /// Writes where the mask holds.
    #[inline(always)]
    fn store_where<S: Writable, const W: usize>(
        &mut self,
        mask: <Self::R as Real>::Mask,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        x: Self::R,
    ) {
        let old = self.load(table, row, field);
        self.store(table, row, field, Self::R::select(mask, x, old));
    }
    /// Adds to a number.
    #[inline(always)]
    fn add<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        x: Self::R,
    ) {
        let sum = self.load(table, row, field) + x;
        self.store(table, row, field, sum);
    }
    /// Reads three fields.
    #[inline(always)]
    fn vec3<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Vec3<Self::R> {
        Vec3::from_array(self.read(table, row, field))
    }
    /// Writes three fields.
    #[inline(always)]
    fn store_vec3<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        v: Vec3<Self::R>,
    ) {
        self.write(table, row, field, v.to_array());
    }
    /// Adds to three fields.
    #[inline(always)]
    fn add_vec3<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        v: Vec3<Self::R>,
    ) {
        let sum = self.vec3(table, row, field) + v;
        self.store_vec3(table, row, field, sum);
    }
    /// Reads four fields x, y, z, w.
    #[inline(always)]
    fn quat<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Quat<Self::R> {
        let [x, y, z, w] = self.read(table, row, field);
        Quat::new(x, y, z, w)
    }
    /// Writes four fields x, y, z, w.
    #[inline(always)]
    fn store_quat<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        q: Quat<Self::R>,
    ) {
        self.write(table, row, field, [q.x, q.y, q.z, q.w]);
    }
    /// Reads seven fields: position, orientation.
    #[inline(always)]
    fn pose<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Pose<Self::R> {
        let [px, py, pz, x, y, z, w] = self.read(table, row, field);
        Pose::new(Vec3::new(px, py, pz), Quat::new(x, y, z, w))
    }
    /// Writes seven fields: position, orientation.
    #[inline(always)]
    fn store_pose<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        pose: Pose<Self::R>,
    ) {
        let Pose { p, q } = pose;
        self.write(table, row, field, [p.x, p.y, p.z, q.x, q.y, q.z, q.w]);
    }
    /// Reads six fields: xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    fn sym<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> SymMat3<Self::R> {
        SymMat3::from_array(self.read(table, row, field))
    }
    /// Writes six fields: xx, yy, zz, xy, xz, yz.
    #[inline(always)]
    fn store_sym<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        m: SymMat3<Self::R>,
    ) {
        self.write(table, row, field, m.to_array());
    }
    /// Reads six fields: angular, linear.
    #[inline(always)]
    fn spatial<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Spatial<Self::R> {
        Spatial::from_array(self.read(table, row, field))
    }
    /// Writes six fields: angular, linear.
    #[inline(always)]
    fn store_spatial<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        v: Spatial<Self::R>,
    ) {
        self.write(table, row, field, v.to_array());
    }
    /// Reads 21 fields: I, H by columns, M.
    #[inline(always)]
    fn inertia<S: Space, const W: usize>(
        &self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
    ) -> Inertia<Self::R> {
        Inertia::from_array(self.read(table, row, field))
    }
    /// Writes 21 fields: I, H by columns, M.
    #[inline(always)]
    fn store_inertia<S: Writable, const W: usize>(
        &mut self,
        table: Table<S, W>,
        row: Self::I,
        field: usize,
        m: Inertia<Self::R>,
    ) {
        self.write(table, row, field, m.to_array());
    }
}

/// A composite of [`Cell`]s: what changes from one round of a loop to the next.
pub trait Held {
    /// The composite number.
    type Value;
    /// The present value.
    fn get(&self) -> Self::Value;
    /// Replaces it.
    fn set(&mut self, x: Self::Value);
}

/// A composite number that can be [`Held`]: `let mut v = v.hold(k);`.
pub trait Hold<M: Machine>: Sized {
    /// The same composite, of cells.
    type Held: Held<Value = Self>;
    /// Cells that hold `self`.
    fn hold(self, k: &M) -> Self::Held;
}

macro_rules! hold {
    ($name:ident { $($field:ident),* }) => {
        impl<C: Cell> Held for $name<C> {
            type Value = $name<C::R>;
            #[inline(always)]
            fn get(&self) -> Self::Value {
                $name { $($field: self.$field.read()),* }
            }
            #[inline(always)]
            fn set(&mut self, x: Self::Value) {
                $(self.$field.write(x.$field);)*
            }
        }
        impl<M: Machine> Hold<M> for $name<M::R> {
            type Held = $name<M::Cell>;
            #[inline(always)]
            fn hold(self, k: &M) -> Self::Held {
                $name { $($field: k.cell(self.$field)),* }
            }
        }
    };
    ($name:ident of $($field:ident),*) => {
        impl<C: Cell> Held for $name<C> {
            type Value = $name<C::R>;
            #[inline(always)]
            fn get(&self) -> Self::Value {
                $name { $($field: self.$field.get()),* }
            }
            #[inline(always)]
            fn set(&mut self, x: Self::Value) {
                $(self.$field.set(x.$field);)*
            }
        }
        impl<M: Machine> Hold<M> for $name<M::R> {
            type Held = $name<M::Cell>;
            #[inline(always)]
            fn hold(self, k: &M) -> Self::Held {
                $name { $($field: self.$field.hold(k)),* }
            }
        }
    };
}

hold!(Vec3 { x, y, z });
hold!(Quat { x, y, z, w });
hold!(SymMat3 {
    xx,
    yy,
    zz,
    xy,
    xz,
    yz
});
hold!(Mat3 of x, y, z);
hold!(Pose of p, q);
hold!(Spatial of angular, linear);
hold!(Inertia of i, h, m);

impl Index for u32 {
    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self.wrapping_add(other)
    }
    #[inline(always)]
    fn offset(self, n: usize) -> Self {
        self.wrapping_add(n as u32)
    }
}

/// Offset of a field of a row. Wraps where the row is absurd; the memory then refuses it.
#[inline(always)]
fn place<const W: usize>(base: u32, row: u32, field: usize) -> usize {
    // The row in 32 bits, so that adding a field cannot overflow; the field outside, so that
    // all fields of a row share one address.
    base.wrapping_add(row.wrapping_mul(W as u32)) as usize + field
}

/// `N` neighbouring numbers, with one check of the bounds.
#[inline(always)]
fn neighbours<R: Copy, const N: usize>(memory: &[R], offset: usize) -> [R; N] {
    *memory[offset..offset + N].as_array().expect("N of them")
}

/// Where a CPU kernel finds the constants of the model.
pub trait Parameters<R: Real>: Copy {
    /// Neighbouring numbers, for all lanes.
    fn read<const N: usize>(&self, offset: usize) -> [R; N];
}

/// One number for all worlds, broadcast on use.
#[derive(Clone, Copy, Debug)]
pub struct Shared<'a, R: Real>(pub &'a [R::Scalar]);

/// A number for each world.
#[derive(Clone, Copy, Debug)]
pub struct PerWorld<'a, R>(pub &'a [R]);

impl<R: Real> Parameters<R> for Shared<'_, R> {
    #[inline(always)]
    fn read<const N: usize>(&self, offset: usize) -> [R; N] {
        let numbers: [R::Scalar; N] = neighbours(self.0, offset);
        let mut x = [R::zero(); N];
        for i in 0..N {
            x[i] = R::splat(numbers[i]);
        }
        x
    }
}

impl<R: Real> Parameters<R> for PerWorld<'_, R> {
    #[inline(always)]
    fn read<const N: usize>(&self, offset: usize) -> [R; N] {
        neighbours(self.0, offset)
    }
}

/// The machine that runs a kernel on the CPU, over one block of worlds.
#[derive(Debug)]
pub struct Cpu<'a, R, P> {
    /// What a world carries from step to step.
    pub state: &'a mut [R],
    /// What a controller wrote.
    pub input: &'a [R],
    /// What the kernel reports.
    pub output: &'a mut [R],
    /// Intermediate results.
    pub scratch: &'a mut [R],
    /// Constants of the model.
    pub parameters: P,
    /// Whole numbers: kinds, parents, ranges.
    pub links: &'a [u32],
}

/// A loop-carried number on the CPU: a plain variable.
#[derive(Clone, Copy, Debug)]
pub struct Register<R>(R);

impl<R: Real> Cell for Register<R> {
    type R = R;
    #[inline(always)]
    fn read(&self) -> R {
        self.0
    }
    #[inline(always)]
    fn write(&mut self, x: R) {
        self.0 = x;
    }
}

/// Counts up or down.
#[derive(Clone, Debug)]
pub struct Rounds {
    left: Range<u32>,
    down: bool,
}

impl Iterator for Rounds {
    type Item = u32;
    #[inline(always)]
    fn next(&mut self) -> Option<u32> {
        if self.left.start >= self.left.end {
            return None;
        }
        if self.down {
            self.left.end -= 1;
            Some(self.left.end)
        } else {
            self.left.start += 1;
            Some(self.left.start - 1)
        }
    }
}

impl<R, P> Machine for Cpu<'_, R, P>
where
    R: Known,
    P: Parameters<R>,
{
    type R = R;
    type I = u32;
    type Flag = bool;
    type Cell = Register<R>;
    type Rounds = Rounds;
    type Branch = ();
    const HANDS_ON: bool = false;

    #[inline(always)]
    fn index(&self, i: usize) -> u32 {
        i as u32
    }
    #[inline(always)]
    fn read<S: Space, const W: usize, const N: usize>(
        &self,
        table: Table<S, W>,
        row: u32,
        field: usize,
    ) -> [R; N] {
        let offset = place::<W>(table.base, row, field);
        match S::KIND {
            Kind::State => neighbours(self.state, offset),
            Kind::Input => neighbours(self.input, offset),
            Kind::Output => neighbours(self.output, offset),
            Kind::Scratch => neighbours(self.scratch, offset),
            Kind::Parameter => self.parameters.read(offset),
        }
    }
    #[inline(always)]
    fn write<S: Writable, const W: usize, const N: usize>(
        &mut self,
        table: Table<S, W>,
        row: u32,
        field: usize,
        x: [R; N],
    ) {
        let offset = place::<W>(table.base, row, field);
        let memory = match S::KIND {
            Kind::State => &mut *self.state,
            Kind::Output => &mut *self.output,
            Kind::Scratch => &mut *self.scratch,
            Kind::Input | Kind::Parameter => unreachable!("not writable"),
        };
        let found = memory[offset..offset + N].as_mut_array();
        *found.expect("N of them") = x;
    }
    #[inline(always)]
    fn link<const W: usize>(&self, links: Links<W>, row: u32, field: usize) -> u32 {
        self.links[place::<W>(links.base, row, field)]
    }
    #[inline(always)]
    fn link_row<const W: usize, const N: usize>(&self, links: Links<W>, row: u32) -> [u32; N] {
        neighbours(self.links, place::<W>(links.base, row, 0))
    }
    #[inline(always)]
    fn range(&self, from: u32, to: u32) -> Rounds {
        Rounds {
            left: from..to,
            down: false,
        }
    }
    #[inline(always)]
    fn range_down(&self, n: u32) -> Rounds {
        Rounds {
            left: 0..n,
            down: true,
        }
    }
    #[inline(always)]
    fn when(&self, flag: bool) -> Option<()> {
        flag.then_some(())
    }
    #[inline(always)]
    fn if_any(&self, mask: R::Mask) -> Option<()> {
        mask.any().then_some(())
    }
    #[inline(always)]
    fn finished(&self, mask: R::Mask) -> bool {
        mask.all()
    }
    #[inline(always)]
    fn equals(&self, a: u32, b: usize) -> bool {
        a == b as u32
    }
    #[inline(always)]
    fn less(&self, a: u32, b: u32) -> bool {
        a < b
    }
    #[inline(always)]
    fn cell(&self, x: R) -> Register<R> {
        Register(x)
    }
    #[inline(always)]
    fn number(&self, i: u32) -> R {
        R::splat(R::Scalar::from_f64(f64::from(i)))
    }
    #[inline(always)]
    fn whole(&self, x: R) -> u32 {
        x.first().to_f64() as u32
    }
}
