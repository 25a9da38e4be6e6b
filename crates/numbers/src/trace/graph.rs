//! The record while it is being made: instructions, open blocks, faults.

use super::operation::Operation;
use super::program::{Action, Instruction, Operand, Program};
use core::cell::RefCell;
use core::marker::PhantomData;
use core::panic::Location;
use std::collections::HashMap;

/// A line of a kernel's source.
type Site = &'static Location<'static>;

/// Why a kernel could not be recorded. The place is where the block was opened.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    /// A value was used outside of the block it was made in.
    #[error(
        "a value made in the block opened at {0} is used after that block or in another round \
         of it: carry it in a `Machine::cell` or a table"
    )]
    Escaped(Site),
    /// Two rounds of a loop gave different instructions.
    #[error(
        "two rounds of the loop opened at {0} differ: what changes from round to round belongs \
         in a `Machine::cell` or a table, not in a `let mut`"
    )]
    Carried(Site),
    /// A block was left by `break` or `return`, or blocks overlap.
    #[error(
        "the block opened at {0} was left before its end: leave a loop only by \
         `if k.finished(mask) {{ break; }}`, and a branch not at all"
    )]
    Unfinished(Site),
    /// `finished` stood in a branch or outside of any loop.
    #[error(
        "`finished` at {0} is not directly in a loop, so there is no loop that it could leave: \
         compute the mask in the branch, keep it in a cell, and ask after the branch"
    )]
    NoLoop(Site),
}

/// A word that is known now, or the result of a recorded instruction.
#[derive(Clone, Copy)]
pub(super) enum Handle<'g> {
    Literal(u32),
    Node(Node<'g>),
}

/// The result of an instruction, valid while its block is open.
///
/// The brand keeps the lifetimes of two records apart, so that a value of one
/// cannot be used in the other.
#[derive(Clone, Copy)]
pub(super) struct Node<'g> {
    graph: &'g Graph,
    pub id: u32,
    block: usize,
    brand: PhantomData<fn(&'g ()) -> &'g ()>,
}

/// The result of a pure operation: a literal where all operands are.
pub(super) fn apply<'g>(operation: Operation, operands: &[Handle<'g>]) -> Handle<'g> {
    let mut words = [0; 3];
    for (word, operand) in words.iter_mut().zip(operands) {
        match operand {
            Handle::Literal(literal) => *word = *literal,
            Handle::Node(node) => {
                return Handle::Node(node.graph.emit(Action::Compute(operation), operands));
            }
        }
    }
    Handle::Literal(operation.evaluate(words))
}

/// The record under construction.
pub(super) struct Graph(RefCell<Recording>);

struct Recording {
    instructions: Vec<Instruction>,
    /// The blocks being recorded, innermost last.
    open: Vec<Block>,
    /// Where each block was opened, by its number.
    sites: Vec<Site>,
    /// The first thing that went wrong.
    fault: Option<TraceError>,
}

/// A block being recorded: the kernel, or one reading of a body.
struct Block {
    number: usize,
    is_loop: bool,
    /// Pure instructions made here: met again, their result is used again.
    known: HashMap<Instruction, u32>,
}

impl Graph {
    /// An empty record of the kernel that is called at `site`.
    pub fn new(site: Site) -> Self {
        let mut recording = Recording {
            instructions: Vec::new(),
            open: Vec::new(),
            sites: Vec::new(),
            fault: None,
        };
        recording.open(false, site);
        Self(RefCell::new(recording))
    }

    /// The record, if nothing went wrong.
    pub fn finish(self) -> Result<Program, TraceError> {
        let Recording {
            instructions,
            fault,
            ..
        } = self.0.into_inner();
        fault.map_or(Ok(Program { instructions }), Err)
    }

    /// Records an instruction, or finds the result of an equal one.
    pub fn emit<'g>(&'g self, action: Action, operands: &[Handle<'g>]) -> Node<'g> {
        let mut recording = self.0.borrow_mut();
        let mut resolved = [Operand::Literal(0); 3];
        for (to, from) in resolved.iter_mut().zip(operands) {
            *to = recording.resolve(from);
        }
        let (id, block) = recording.add(Instruction {
            action,
            operands: resolved,
        });
        Node {
            graph: self,
            id,
            block,
            brand: PhantomData,
        }
    }

    /// Records the exit from a loop.
    pub fn leave<'g>(&'g self, condition: Handle<'g>, site: Site) {
        if self.0.borrow().innermost().is_loop {
            self.emit(Action::Break, &[condition]);
        } else {
            self.0.borrow_mut().fail(TraceError::NoLoop(site));
        }
    }

    /// Records the head of a loop or a branch, and opens its body.
    pub fn open<'g>(&'g self, head: Action, operands: &[Handle<'g>], site: Site) -> Body<'g> {
        let is_loop = matches!(head, Action::Loop { .. });
        let head = self.emit(head, operands).id;
        let block = self.0.borrow_mut().open(is_loop, site);
        Body {
            graph: self,
            head,
            block,
            once: None,
        }
    }
}

/// A body being recorded. A loop's is recorded twice.
pub(super) struct Body<'g> {
    graph: &'g Graph,
    /// The instruction that the body belongs to.
    head: u32,
    block: usize,
    /// Where the first record of the body ends, once it does.
    once: Option<usize>,
}

impl<'g> Body<'g> {
    /// The index of the round, if this is a loop.
    pub fn index(&self) -> Handle<'g> {
        Handle::Node(Node {
            graph: self.graph,
            id: self.head,
            block: self.block,
            brand: PhantomData,
        })
    }

    /// Ends the first record of a loop's body and begins the second.
    pub fn again(self) -> Self {
        let mut recording = self.graph.0.borrow_mut();
        recording.close(self.block);
        let site = recording.sites[self.block];
        let block = recording.open(true, site);
        let once = Some(recording.instructions.len());
        Body {
            graph: self.graph,
            head: self.head,
            block,
            once,
        }
    }

    /// Ends the body, and drops the second record in favour of an equal first.
    pub fn close(self) {
        let mut recording = self.graph.0.borrow_mut();
        recording.close(self.block);
        if recording.fault.is_some() {
            return;
        }
        if let Some(end) = self.once {
            recording.unify(self.head as usize + 1, end, self.block);
        }
        let inside = recording.instructions.len() as u32 - self.head - 1;
        match &mut recording.instructions[self.head as usize].action {
            Action::Loop { length, .. } | Action::If { length } => *length = inside,
            _ => unreachable!("not the head of a block"),
        }
    }
}

impl Drop for Body<'_> {
    /// A body that was not closed was left by `break` or `return`.
    fn drop(&mut self) {
        let mut recording = self.graph.0.borrow_mut();
        if recording.is_open(self.block) {
            let site = recording.sites[self.block];
            recording.fail(TraceError::Unfinished(site));
            recording.close(self.block);
        }
    }
}

impl Recording {
    fn fail(&mut self, fault: TraceError) {
        self.fault.get_or_insert(fault);
    }

    fn is_open(&self, block: usize) -> bool {
        self.open.iter().any(|b| b.number == block)
    }

    fn innermost(&self) -> &Block {
        self.open
            .last()
            .expect("the kernel's own block is never closed")
    }

    fn open(&mut self, is_loop: bool, site: Site) -> usize {
        let number = self.sites.len();
        self.sites.push(site);
        self.open.push(Block {
            number,
            is_loop,
            known: HashMap::new(),
        });
        number
    }

    /// Closes a block, and faults those still open inside it.
    fn close(&mut self, block: usize) {
        while self.innermost().number > block {
            let site = self.sites[self.innermost().number];
            self.fail(TraceError::Unfinished(site));
            self.open.pop();
        }
        if self.innermost().number == block {
            self.open.pop();
        }
    }

    /// The operand that a handle stands for, where it may be used.
    fn resolve(&mut self, handle: &Handle<'_>) -> Operand {
        match handle {
            Handle::Literal(word) => Operand::Literal(*word),
            Handle::Node(node) => {
                if !self.is_open(node.block) {
                    self.fail(TraceError::Escaped(self.sites[node.block]));
                }
                Operand::Node(node.id)
            }
        }
    }

    /// The number and the block of an instruction, new or known.
    fn add(&mut self, instruction: Instruction) -> (u32, usize) {
        if instruction.pure() {
            let known = |b: &Block| Some((*b.known.get(&instruction)?, b.number));
            if let Some(found) = self.open.iter().rev().find_map(known) {
                return found;
            }
        }
        let id = self.instructions.len() as u32;
        self.instructions.push(instruction);
        let block = self
            .open
            .last_mut()
            .expect("the kernel's own block is never closed");
        if instruction.pure() {
            block.known.insert(instruction, id);
        }
        (id, block.number)
    }

    /// Drops the second record of a body, from `middle` on, if it repeats the
    /// first, from `start` on.
    fn unify(&mut self, start: usize, middle: usize, block: usize) {
        let again = self.instructions.split_off(middle);
        let first = &self.instructions[start..];
        let same = again
            .iter()
            .map(|i| i.moved_up(middle as u32, (middle - start) as u32))
            .eq(first.iter().copied());
        if !same {
            self.fail(TraceError::Carried(self.sites[block]));
        }
    }
}
