//! A record run on the CPU.

use super::program::{Action, Instruction, Operand, Place, Program};
use crate::machine::space::Kind;
use crate::{Cpu, Shared};
use core::ops::Range;

/// Why a record could not be run to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum InterpretError {
    /// A number was read or written beyond the end of a memory.
    #[error(
        "offset {offset} lies outside of the {kind:?} memory: check the row and make the memory as long as its tables need"
    )]
    OutOfBounds {
        /// The memory.
        kind: Kind,
        /// The offset of the number.
        offset: u64,
    },
    /// A link was read beyond the end of the links.
    #[error(
        "offset {offset} lies outside of the links: check the row and make them as long as their tables need"
    )]
    NoLink {
        /// The offset of the link.
        offset: u64,
    },
}

/// What a run of a record did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Operations on numbers, indices and masks.
    pub operations: u64,
    /// Numbers of a world's own that were read: state, input, output, scratch.
    pub loads: u64,
    /// Numbers of a world's own that were written.
    pub stores: u64,
    /// Numbers and links of the model that were read.
    pub constants: u64,
}

impl Program {
    /// Runs the record on the memories of one world.
    ///
    /// The memories end up with the same bits as after the kernel itself on the
    /// same `Cpu`. Where a row lies outside of a memory, stops with an error and
    /// leaves what was written before.
    pub fn interpret<'m>(
        &self,
        world: &mut Cpu<'m, f32, Shared<'m, f32>>,
    ) -> Result<(), InterpretError> {
        self.work(world).map(|_| ())
    }
    /// As [`interpret`](Self::interpret), and tells what it took.
    pub fn work<'m>(
        &self,
        world: &mut Cpu<'m, f32, Shared<'m, f32>>,
    ) -> Result<Work, InterpretError> {
        let instructions = &self.instructions[..];
        let mut interpreter = Interpreter {
            instructions,
            words: vec![0; instructions.len()],
            work: Work::default(),
            world,
        };
        interpreter.run(0..instructions.len())?;
        Ok(interpreter.work)
    }
}

struct Interpreter<'a, 'm> {
    instructions: &'a [Instruction],
    /// The latest result of each instruction.
    words: Vec<u32>,
    work: Work,
    world: &'a mut Cpu<'m, f32, Shared<'m, f32>>,
}

/// Whether a body ran to its end or left its loop.
#[derive(PartialEq)]
enum Exit {
    End,
    Break,
}

impl Interpreter<'_, '_> {
    fn run(&mut self, mut body: Range<usize>) -> Result<Exit, InterpretError> {
        while let Some(id) = body.next() {
            let Instruction { action, operands } = self.instructions[id];
            let [a, b, c] = operands.map(|operand| self.word(operand));
            match action {
                Action::Compute(operation) => {
                    self.work.operations += 1;
                    self.words[id] = operation.evaluate([a, b, c]);
                }
                Action::Load(kind, place) => self.words[id] = self.load(kind, place, a)?,
                Action::Link(place) => self.words[id] = self.link(place, a)?,
                Action::Store(kind, place) => self.store(kind, place, a, b)?,
                Action::Cell => self.words[id] = a,
                Action::Get => self.words[id] = a,
                Action::Set => self.set(operands[0], b),
                Action::Loop { down, length } => {
                    body.start += length as usize;
                    self.rounds(id, a..b, down, id + 1..body.start)?;
                }
                Action::If { length } => {
                    body.start += length as usize;
                    if a != 0 {
                        self.run(id + 1..body.start)?;
                    }
                }
                Action::Break if a != 0 => return Ok(Exit::Break),
                Action::Break => {}
            }
        }
        Ok(Exit::End)
    }

    /// Runs the body of the loop `id` once for each index in `range`.
    fn rounds(
        &mut self,
        id: usize,
        range: Range<u32>,
        down: bool,
        body: Range<usize>,
    ) -> Result<(), InterpretError> {
        for round in range.clone() {
            self.words[id] = if down { range.end - 1 - round } else { round };
            if self.run(body.clone())? == Exit::Break {
                break;
            }
        }
        Ok(())
    }

    fn word(&self, operand: Operand) -> u32 {
        match operand {
            Operand::Literal(word) => word,
            Operand::Node(id) => self.words[id as usize],
        }
    }

    fn set(&mut self, cell: Operand, word: u32) {
        if let Operand::Node(id) = cell {
            self.words[id as usize] = word;
        }
    }

    fn load(&mut self, kind: Kind, place: Place, row: u32) -> Result<u32, InterpretError> {
        let own = u64::from(kind != Kind::Parameter);
        self.work.loads += own;
        self.work.constants += 1 - own;
        let memory = match kind {
            Kind::State => &*self.world.state,
            Kind::Input => self.world.input,
            Kind::Output => &*self.world.output,
            Kind::Scratch => &*self.world.scratch,
            Kind::Parameter => self.world.parameters.0,
        };
        let offset = place.at(row);
        let number = usize::try_from(offset).ok().and_then(|i| memory.get(i));
        Ok(number
            .ok_or(InterpretError::OutOfBounds { kind, offset })?
            .to_bits())
    }

    fn store(&mut self, kind: Kind, place: Place, row: u32, x: u32) -> Result<(), InterpretError> {
        self.work.stores += 1;
        let memory: &mut [f32] = match kind {
            Kind::State => self.world.state,
            Kind::Output => self.world.output,
            Kind::Scratch => self.world.scratch,
            Kind::Input | Kind::Parameter => &mut [],
        };
        let offset = place.at(row);
        let number = usize::try_from(offset).ok().and_then(|i| memory.get_mut(i));
        *number.ok_or(InterpretError::OutOfBounds { kind, offset })? = f32::from_bits(x);
        Ok(())
    }

    fn link(&mut self, place: Place, row: u32) -> Result<u32, InterpretError> {
        self.work.constants += 1;
        let offset = place.at(row);
        let link = usize::try_from(offset)
            .ok()
            .and_then(|i| self.world.links.get(i));
        link.copied().ok_or(InterpretError::NoLink { offset })
    }
}
