//! A record printed in a language that looks like C.
//!
//! The languages share statements and expressions; each has a prelude which gives the same words to what it lacks or
//! does in its own way, and says itself how a name is declared and a number written.

use super::operation::{Operation, Type};
use super::program::{Action, Instruction, Operand, Place, Program};
use crate::machine::space::Kind;
use core::marker::PhantomData;
use core::ops::Range;

/// How a record is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PrintOptions {
    /// Invocations in a workgroup, or threads in a block; 64 by default.
    pub workgroup_size: u32,
    /// Whether each world has its own parameters, laid out like its input;
    /// by default all worlds share one set, at plain offsets.
    pub parameters_per_world: bool,
    /// What an invocation works on.
    pub members: Members,
    /// So many numbers of scratch of each invocation, where each [`PIECE`] of them have a piece of their own: there, the
    /// number at `offset` of the invocation `i` lies at `offset · PIECE + i`. All steps are constants then: addresses cost
    /// less, and a compiler sees which differ. By default each world has scratch, laid out as its input is.
    pub pieces: Option<u32>,
    /// So many numbers of state of each world, where these lie in pieces likewise, of each [`PIECE`] worlds; of
    /// [worlds](Members::Worlds) only. By default state is laid out as input is.
    pub state_pieces: Option<u32>,
    /// Only the worlds of a list are worked on, which stands in the links from here on: how many they are, then which. Their
    /// output lies together, the number at `offset` of the i-th at `offset · count + i`. Of [worlds](Members::Worlds) only.
    /// By default all worlds are.
    pub listed: Option<u32>,
}

/// Invocations, or worlds, whose numbers lie together in a piece: so many as cards of most makers have in lockstep. Their
/// numbers of a row are one stretch of memory, which none of others interrupts.
pub const PIECE: u32 = 32;

/// What an invocation works on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Members {
    /// A world, several times; all of them.
    #[default]
    Worlds,
    /// A member of a run; WGSL only, from which `cuda` makes its own.
    Runs,
    /// A member of a run that sits on two bodies; WGSL only.
    Seats {
        /// The first numbers of its scratch are so many of each of these bodies, which binding 3 holds at
        /// `number · bodies + body`.
        bodies: u32,
        /// The others lie behind so many numbers of its state.
        state: u32,
    },
}

impl Default for PrintOptions {
    fn default() -> Self {
        Self {
            workgroup_size: 64,
            parameters_per_world: false,
            members: Members::Worlds,
            pieces: None,
            state_pieces: None,
            listed: None,
        }
    }
}

impl PrintOptions {
    /// Where an invocation's scratch begins.
    pub(super) fn own_piece(&self) -> Option<String> {
        Some(format!("own = {}", piece("index", self.pieces?)))
    }
    /// Where a world's state begins.
    pub(super) fn held_piece(&self) -> Option<String> {
        Some(format!("held = {}", piece("world", self.state_pieces?)))
    }
    /// What invocations count through, and up to where.
    pub(super) fn counted(&self) -> [&'static str; 2] {
        match self.listed {
            None => ["world", "worlds"],
            Some(_) => ["entry", "entries"],
        }
    }
    /// How long the list is, and which world an entry of it is.
    pub(super) fn list(&self) -> Option<[String; 2]> {
        let at = self.listed?;
        let world = format!("world = links[{}u + entry]", at + 1);
        Some([format!("entries = links[{at}u]"), world])
    }
}

/// Where the numbers of an invocation, or of a world, begin, of which each has so many.
fn piece(of: &str, numbers: u32) -> String {
    let size = numbers.saturating_mul(PIECE);
    format!("({of} / {PIECE}u) * {size}u + {of} % {PIECE}u")
}

/// What differs from language to language.
pub(super) trait Language {
    /// Why something cannot be written.
    type Error;
    /// Declares a name for a value.
    fn constant(kind: Type) -> &'static str;
    /// Declares a name for a place that takes other values.
    fn variable(kind: Type) -> &'static str;
    /// A number that reads back to the same bits.
    fn number(x: f32) -> Result<String, Self::Error>;
}

impl Program {
    /// Its statements, indented, between what opens the kernel and what closes it.
    pub(super) fn print<L: Language>(
        &self,
        options: &PrintOptions,
        opening: String,
        closing: &str,
    ) -> Result<String, L::Error> {
        let mut printer = Printer::<L> {
            instructions: &self.instructions,
            options,
            text: opening,
            depth: 2,
            language: PhantomData,
        };
        printer.block(0..self.instructions.len())?;
        printer.text.push_str(closing);
        Ok(printer.text)
    }
}

struct Printer<'a, L> {
    instructions: &'a [Instruction],
    options: &'a PrintOptions,
    text: String,
    depth: usize,
    language: PhantomData<L>,
}

impl<L: Language> Printer<'_, L> {
    fn line(&mut self, line: &str) {
        self.text.extend(core::iter::repeat_n("    ", self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn block(&mut self, mut body: Range<usize>) -> Result<(), L::Error> {
        while let Some(id) = body.next() {
            let line = self.statement(id)?;
            self.line(&line);
            if let Action::Loop { length, .. } | Action::If { length } =
                self.instructions[id].action
            {
                body.start += length as usize;
                self.depth += 1;
                self.block(id + 1..body.start)?;
                self.depth -= 1;
                self.line("}");
            }
        }
        Ok(())
    }

    /// The line of an instruction, or the first one of its block.
    fn statement(&self, id: usize) -> Result<String, L::Error> {
        let Instruction {
            action,
            operands: [a, b, _],
        } = self.instructions[id];
        let name = self.name(id);
        let kind = action.result();
        let (constant, variable) = (L::constant(kind), L::variable(kind));
        Ok(match action {
            Action::Compute(operation) => {
                format!("{constant} {name} = {};", self.expression(id, operation)?)
            }
            Action::Load(kind, place) => {
                format!("{constant} {name} = {};", self.number(kind, place, a)?)
            }
            Action::Link(place) => {
                format!("{constant} {name} = links[{}];", self.offset(place, a)?)
            }
            Action::Store(kind, place) => {
                let value = self.operand(b, Type::Real)?;
                format!("{} = {value};", self.number(kind, place, a)?)
            }
            Action::Cell => format!("{variable} {name} = {};", self.operand(a, Type::Real)?),
            Action::Get => format!("{constant} {name} = {};", self.operand(a, Type::Real)?),
            Action::Set => {
                let value = self.operand(b, Type::Real)?;
                format!("{} = {value};", self.operand(a, Type::Real)?)
            }
            Action::Loop { down, .. } => {
                let (from, to) = (self.operand(a, Type::Index)?, self.operand(b, Type::Index)?);
                if down {
                    // One below zero is the largest index, which ends the loop.
                    format!("for ({variable} {name} = {to} - 1u; {name} < {to}; {name}--) {{")
                } else {
                    format!("for ({variable} {name} = {from}; {name} < {to}; {name}++) {{")
                }
            }
            Action::If { .. } => format!("if ({}) {{", self.operand(a, Type::Mask)?),
            Action::Break => format!("if ({}) {{ break; }}", self.operand(a, Type::Mask)?),
        })
    }

    /// The name of a result: its type's initial and its number.
    fn name(&self, id: usize) -> String {
        let action = self.instructions[id].action;
        let initial = match action.result() {
            _ if action == Action::Cell => 'c',
            Type::Real => 'x',
            Type::Mask => 'm',
            Type::Index => 'i',
        };
        format!("{initial}{id}")
    }

    fn operand(&self, operand: Operand, kind: Type) -> Result<String, L::Error> {
        match (operand, kind) {
            (Operand::Node(id), _) => Ok(self.name(id as usize)),
            (Operand::Literal(word), Type::Real) => L::number(f32::from_bits(word)),
            (Operand::Literal(word), Type::Mask) => Ok((word != 0).to_string()),
            (Operand::Literal(word), Type::Index) => Ok(format!("{word}u")),
        }
    }

    /// A number in a memory.
    fn number(&self, kind: Kind, place: Place, row: Operand) -> Result<String, L::Error> {
        let offset = self.offset(place, row)?;
        Ok(match kind {
            Kind::State if self.options.state_pieces.is_some() => {
                format!("state[({offset}) * {PIECE}u + held]")
            }
            Kind::State => format!("state[({offset}) * worlds + world]"),
            Kind::Input => format!("input[({offset}) * worlds + world]"),
            Kind::Output => {
                let [counted, count] = self.options.counted();
                format!("output[({offset}) * {count} + {counted}]")
            }
            Kind::Scratch => match self.options.members {
                Members::Seats { bodies, .. } if place.offset < 2 * bodies => {
                    format!("scratch[seat({offset}, world)]")
                }
                Members::Seats { bodies, state } => {
                    let offset = place.offset - 2 * bodies + state;
                    let offset = self.offset(Place { offset, ..place }, row)?;
                    format!("state[({offset}) * worlds + world]")
                }
                _ if self.options.pieces.is_some() => {
                    format!("scratch[({offset}) * {PIECE}u + own]")
                }
                _ => format!("scratch[({offset}) * worlds + world]"),
            },
            Kind::Parameter if self.options.parameters_per_world => {
                format!("parameters[({offset}) * worlds + world]")
            }
            Kind::Parameter => format!("parameters[{offset}]"),
        })
    }

    fn offset(&self, place: Place, row: Operand) -> Result<String, L::Error> {
        if let Operand::Literal(row) = row {
            return Ok(format!("{}u", place.at(row)));
        }
        let row = self.operand(row, Type::Index)?;
        Ok(match (place.offset, place.width) {
            (0, 1) => row,
            (0, width) => format!("{row} * {width}u"),
            (offset, 1) => format!("{offset}u + {row}"),
            (offset, width) => format!("{offset}u + {row} * {width}u"),
        })
    }

    /// What a pure instruction computes. `$0` stands for its first operand.
    fn expression(&self, id: usize, operation: Operation) -> Result<String, L::Error> {
        use Operation::*;
        let mut text = String::from(match operation {
            Add | IndexSum => "$0 + $1",
            Subtract => "$0 - $1",
            Multiply => "$0 * $1",
            Divide => "$0 / $1",
            Negate => "-$0",
            Fma => "fma($0, $1, $2)",
            Sqrt => "sqrt($0)",
            Abs => "abs($0)",
            Min => "lesser($0, $1)",
            Max => "greater($0, $1)",
            Floor => "floor($0)",
            Round => "nearest($0)",
            Copysign => "with_sign($0, $1)",
            Ldexp => "scaled($0, $1)",
            Fraction => "fraction($0)",
            Exponent => "exponent($0)",
            Less | IndexLess => "$0 < $1",
            LessEqual => "$0 <= $1",
            Same | IndexEqual => "$0 == $1",
            Select => "select($2, $1, $0)",
            And => "$0 & $1",
            Or => "$0 | $1",
            Not => "!$0",
            Number => "f32($0)",
            Whole => "whole($0)",
        });
        for (k, operand) in self.instructions[id].operands.into_iter().enumerate() {
            let slot = ["$0", "$1", "$2"][k];
            if text.contains(slot) {
                text = text.replace(slot, &self.operand(operand, operation.operand(k))?);
            }
        }
        Ok(text)
    }
}

/// A finite number as WGSL and CUDA C++ write it, to the bit. It may be negative: then it is in parentheses.
///
/// Decimal where that is short and exact, else hexadecimal, since a decimal may
/// be rounded either way.
pub fn finite(x: f32) -> String {
    let size = x.abs();
    let text = if size < 65536.0 && (size * 8.0).fract() == 0.0 {
        format!("{size:?}f")
    } else {
        let (lead, exponent) = match size.to_bits() >> 23 {
            0 => (0, -126),
            biased => (1, biased as i32 - 127),
        };
        format!(
            "0x{lead}.{:06x}p{exponent}f",
            (size.to_bits() & 0x7f_ffff) << 1
        )
    };
    if x.is_sign_negative() {
        format!("(-{text})")
    } else {
        text
    }
}
