//! The record of a kernel.

use super::operation::{Operation, Type};
use crate::machine::space::Kind;

/// A literal word, or the result of an earlier instruction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operand {
    Literal(u32),
    Node(u32),
}

/// Where a number lies: `offset + row · width`, the row being an operand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Place {
    pub offset: u32,
    pub width: u32,
}

impl Place {
    pub fn new(base: usize, field: usize, width: usize) -> Self {
        Self {
            offset: narrow(base + field),
            width: narrow(width),
        }
    }
    pub fn at(self, row: u32) -> u64 {
        u64::from(self.offset) + u64::from(row) * u64::from(self.width)
    }
}

/// As 32 bits. What does not fit becomes the largest index, which lies outside
/// of every memory.
pub(super) fn narrow(n: usize) -> u32 {
    u32::try_from(n).unwrap_or(u32::MAX)
}

/// What an instruction does with its operands, here named in order.
///
/// The body of a `Loop` or an `If` is the `length` instructions that follow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Action {
    Compute(Operation),
    /// row
    Load(Kind, Place),
    /// row
    Link(Place),
    /// row, number
    Store(Kind, Place),
    /// first number
    Cell,
    /// cell
    Get,
    /// cell, number
    Set,
    /// from, to; its result is the index of the round
    Loop {
        down: bool,
        length: u32,
    },
    /// condition
    If {
        length: u32,
    },
    /// condition; leaves the loop whose body it is in
    Break,
}

impl Action {
    /// The type of its result; of a store and the like, which have none, that of what they deal with.
    pub fn result(self) -> Type {
        match self {
            Self::Compute(operation) => operation.result(),
            Self::Link(_) | Self::Loop { .. } => Type::Index,
            Self::Load(..) | Self::Store(..) | Self::Cell | Self::Get | Self::Set => Type::Real,
            Self::If { .. } | Self::Break => Type::Mask,
        }
    }
}

/// One step of a record. Its result is known by its position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Instruction {
    pub action: Action,
    pub operands: [Operand; 3],
}

impl Instruction {
    /// Whether the same instruction, met again, has the same result.
    pub fn pure(&self) -> bool {
        matches!(
            self.action,
            Action::Compute(_) | Action::Link(_) | Action::Load(Kind::Input | Kind::Parameter, _)
        )
    }

    /// The same instruction in a body that lies `by` places earlier, where
    /// results at `start` and later belong to that body.
    pub fn moved_up(mut self, start: u32, by: u32) -> Self {
        for operand in &mut self.operands {
            match operand {
                Operand::Node(id) if *id >= start => *id -= by,
                _ => {}
            }
        }
        self
    }
}

/// A kernel as data; see [`record`](super::record).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Program {
    pub(super) instructions: Vec<Instruction>,
}

/// How much of what a [`Program`] contains, each loop body counted once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// Operations on numbers, masks and indices.
    pub arithmetic: usize,
    /// Reads of a memory, links included.
    pub loads: usize,
    /// Writes to a memory.
    pub stores: usize,
    /// Cells, and reads and writes of cells.
    pub cells: usize,
    /// Loops.
    pub loops: usize,
    /// Branches, and exits from loops.
    pub branches: usize,
}

impl Program {
    /// Counts the instructions by kind.
    pub fn operations(&self) -> Operations {
        let mut n = Operations::default();
        for instruction in &self.instructions {
            let count = match instruction.action {
                Action::Compute(_) => &mut n.arithmetic,
                Action::Load(..) | Action::Link(_) => &mut n.loads,
                Action::Store(..) => &mut n.stores,
                Action::Cell | Action::Get | Action::Set => &mut n.cells,
                Action::Loop { .. } => &mut n.loops,
                Action::If { .. } | Action::Break => &mut n.branches,
            };
            *count += 1;
        }
        n
    }
    /// Whether worlds go different ways for long: whether what they hold says which rows they work on.
    pub(super) fn differs(&self) -> bool {
        let whole = Action::Compute(Operation::Whole);
        self.instructions.iter().any(|it| it.action == whole)
    }
}
