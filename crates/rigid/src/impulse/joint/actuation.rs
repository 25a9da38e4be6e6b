//! What controls make of the forces along a joint's axes.
//!
//! A controller gives each axis a force f̂, and a target θ̂ and a speed ω̂ of its drive; and each actuator a control u,
//! within its range u₋, u₊. Once in a step
//!
//! ```text
//! P = P₀ + f̂ + Σ a(u)      a(u) = g (c clamp(u, u₋, u₊) + b)      of actuators without a force range
//! l = d ω̂ + a(u)                                                  of a law with bounds
//! ```
//!
//! P and l are those of [`law`](super::law), where all else about them is constant: P₀ the force of springs at the
//! coordinate's reference, those of actuators too, g gear, c gain, b bias, d the drive's damping. A law is a drive's, an
//! actuator's with a force range, or neither, and l is 0.

use super::tables::ROWS;
use numbers::machine::Links;
use numbers::machine::space::{Input, Output, Parameter};
use numbers::{Cell, Machine, Real, Table};

/// Controls of a row, zeros where it is no degree of freedom.
pub(super) mod given {
    /// Force [N or N·m], target [m or rad] and speed [m/s or rad/s] of the drive.
    pub const WIDTH: usize = 3;
}

/// Constants of a row.
pub(super) mod constant {
    /// P₀ [N or N·m]; then 1 where something acts along it even if no force does.
    pub const WIDTH: usize = 2;
}

/// Constants of a law or an actuator.
pub(super) mod source {
    /// Gear, gain, bias, control range.
    pub const ACTUATOR: usize = 0;
    /// Damping of the drive [N·s/m or N·m·s/rad].
    pub const DAMPING: usize = 5;
    /// Numbers in a row.
    pub const WIDTH: usize = 6;
}

/// What is made of them in a row.
pub mod acting {
    /// 1 where something acts along it.
    pub const ACTS: usize = 0;
    /// P [N or N·m].
    pub const FORCE: usize = 1;
    /// Goal of the drive [m or rad].
    pub const GOAL: usize = 2;
    /// Numbers in a row.
    pub const WIDTH: usize = 3;
}

/// Whole numbers of a row: its laws, then its actuators without a force range, each from the first to before the end.
mod link {
    pub const LAWS: usize = 0;
    pub const FREE: usize = 2;
    pub const WIDTH: usize = 4;
}

/// For how many laws, and actuators without a force range, each row of a joint has room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Sources {
    /// Laws with bounds.
    pub laws: [usize; ROWS],
    /// Actuators without a force range.
    pub free: [usize; ROWS],
}

impl Sources {
    /// Room for either.
    pub fn max(self, other: Self) -> Self {
        let most = |a: [usize; ROWS], b: [usize; ROWS]| std::array::from_fn(|i| a[i].max(b[i]));
        Self {
            laws: most(self.laws, other.laws),
            free: most(self.free, other.free),
        }
    }
    /// How many laws there is room for.
    pub fn all_laws(&self) -> usize {
        self.laws.iter().sum()
    }
    /// What [`actuate`] reads of it: laws come before actuators.
    pub fn links(&self) -> [u32; ROWS * link::WIDTH] {
        let mut links = [0; ROWS * link::WIDTH];
        let mut end = 0;
        for (field, counts) in [(link::LAWS, self.laws), (link::FREE, self.free)] {
            for (row, count) in counts.into_iter().enumerate() {
                let at = row * link::WIDTH + field;
                links[at] = end;
                end += count as u32;
                links[at + 1] = end;
            }
        }
        links
    }
}

/// Tables of [`actuate`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Actuation {
    row: Table<Input, { given::WIDTH }>,
    /// Control of each law and actuator.
    control: Table<Input>,
    constant: Table<Parameter, { constant::WIDTH }>,
    source: Table<Parameter, { source::WIDTH }>,
    links: Links<{ link::WIDTH }>,
    /// [`ROWS`] rows: see [`acting`].
    pub axis: Table<Output, { acting::WIDTH }>,
    /// l of each law [N or N·m].
    pub law: Table<Output>,
    /// Numbers that are given, constants, and what is made of them.
    pub lengths: [usize; 3],
}

impl Actuation {
    /// The layout of a joint with room for these.
    pub fn new(sources: &Sources) -> Self {
        let laws = sources.all_laws();
        let all = laws + sources.free.iter().sum::<usize>();
        let (mut given, mut constants, mut made, mut links) = (0, 0, 0, 0);
        let mut tables = Self {
            row: Table::place(&mut given, ROWS),
            control: Table::place(&mut given, all),
            constant: Table::place(&mut constants, ROWS),
            source: Table::place(&mut constants, all),
            links: Links::place(&mut links, ROWS),
            axis: Table::place(&mut made, ROWS),
            law: Table::place(&mut made, laws),
            lengths: [0; 3],
        };
        tables.lengths = [given, constants, made];
        tables
    }
}

/// Controls of a joint become forces along its axes.
#[inline(always)]
pub fn actuate<M: Machine>(k: &mut M, t: &Actuation) {
    for row in k.count(ROWS) {
        let [given, target, speed] = k.read(t.row, row, 0);
        let [springs, acts] = k.read(t.constant, row, 0);
        let [first_law, end_of_laws, first, end] = k.link_row(t.links, row);
        for i in k.range(first_law, end_of_laws) {
            let damping = k.load(t.source, i, source::DAMPING);
            let force = damping * speed + effort(k, t, i);
            k.store(t.law, i, 0, force);
        }
        let mut force = k.cell(springs + given);
        for i in k.range(first, end) {
            force.write(force.read() + effort(k, t, i));
        }
        let force = force.read();
        let rests = force.same(M::R::zero());
        let acts = M::R::select(rests, acts, M::R::one());
        k.write(t.axis, row, 0, [acts, force, target]);
    }
}

/// a(u).
#[inline(always)]
fn effort<M: Machine>(k: &M, t: &Actuation, i: M::I) -> M::R {
    let [gear, gain, bias, low, high] = k.read(t.source, i, source::ACTUATOR);
    let control = k.load(t.control, i, 0).clamp(low, high);
    gear * (gain * control + bias)
}
