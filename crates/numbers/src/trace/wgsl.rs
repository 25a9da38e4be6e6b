//! A record printed as a WGSL compute shader.

use super::operation::{Operation, Type};
use super::program::{Action, Instruction, Operand, Place, Program};
use crate::machine::space::Kind;
use core::ops::Range;

/// The bindings, and the operations that WGSL lacks or leaves loose.
const PRELUDE: &str = include_str!("prelude.wgsl");

/// How a record is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WgslOptions {
    /// Invocations in a workgroup; 64 by default.
    pub workgroup_size: u32,
    /// Whether each world has its own parameters, laid out like its state;
    /// by default all worlds share one set, at plain offsets.
    pub parameters_per_world: bool,
}

impl Default for WgslOptions {
    fn default() -> Self {
        Self {
            workgroup_size: 64,
            parameters_per_world: false,
        }
    }
}

/// Why a record has no WGSL.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum WgslError {
    /// WGSL has no way to write an infinity or a NaN.
    #[error("the literal {0} cannot be written in WGSL: use a large finite number")]
    NotFinite(f32),
}

impl Program {
    /// Prints the record as a WGSL shader whose entry point is `main`.
    ///
    /// One invocation runs one world, `global_invocation_id.x`. In group 0 it
    /// binds state (0), input (1), output (2), scratch (3), parameters (4) and
    /// links (5) as storage buffers (1, 4 and 5 read-only) and, as a uniform of two
    /// `u32` (6), the number of worlds and how often the kernel runs, one time
    /// after the other. All seven are declared whether used or
    /// not; a pipeline needs an explicit layout, as one derived from the shader
    /// leaves out the unused. A world's number at `offset` lies at
    /// `offset · worlds + world`.
    ///
    /// A GPU rounds division, `sqrt` and `fma` as WGSL allows, so results agree
    /// with the CPU to a tolerance, not to the bit; and it may take for granted
    /// that no infinity and no NaN comes up.
    pub fn to_wgsl(&self, options: &WgslOptions) -> Result<String, WgslError> {
        let instructions = &self.instructions[..];
        let text = format!(
            "{PRELUDE}\n@compute @workgroup_size({})\n\
             fn main(@builtin(global_invocation_id) invocation: vec3<u32>) {{\n    \
             let world = invocation.x;\n    \
             let worlds = launch.worlds;\n    \
             if (world >= worlds) {{ return; }}\n    \
             for (var nth = 0u; nth < launch.rounds; nth++) {{\n",
            options.workgroup_size
        );
        let mut printer = Printer {
            instructions,
            options,
            text,
            depth: 2,
        };
        printer.block(0..instructions.len())?;
        printer.text.push_str("    }\n}\n");
        Ok(printer.text)
    }
}

struct Printer<'a> {
    instructions: &'a [Instruction],
    options: &'a WgslOptions,
    text: String,
    depth: usize,
}

impl Printer<'_> {
    fn line(&mut self, line: &str) {
        self.text.extend(core::iter::repeat_n("    ", self.depth));
        self.text.push_str(line);
        self.text.push('\n');
    }

    fn block(&mut self, mut body: Range<usize>) -> Result<(), WgslError> {
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
    fn statement(&self, id: usize) -> Result<String, WgslError> {
        let Instruction {
            action,
            operands: [a, b, _],
        } = self.instructions[id];
        let name = self.name(id);
        Ok(match action {
            Action::Compute(operation) => {
                format!("let {name} = {};", self.expression(id, operation)?)
            }
            Action::Load(kind, place) => {
                format!("let {name} = {};", self.number(kind, place, a)?)
            }
            Action::Link(place) => format!("let {name} = links[{}];", self.offset(place, a)?),
            Action::Store(kind, place) => {
                let value = self.operand(b, Type::Real)?;
                format!("{} = {value};", self.number(kind, place, a)?)
            }
            Action::Cell => format!("var {name} = {};", self.operand(a, Type::Real)?),
            Action::Get => format!("let {name} = {};", self.operand(a, Type::Real)?),
            Action::Set => {
                let value = self.operand(b, Type::Real)?;
                format!("{} = {value};", self.operand(a, Type::Real)?)
            }
            Action::Loop { down, .. } => {
                let (from, to) = (self.operand(a, Type::Index)?, self.operand(b, Type::Index)?);
                if down {
                    // One below zero is the largest index, which ends the loop.
                    format!("for (var {name} = {to} - 1u; {name} < {to}; {name}--) {{")
                } else {
                    format!("for (var {name} = {from}; {name} < {to}; {name}++) {{")
                }
            }
            Action::If { .. } => format!("if ({}) {{", self.operand(a, Type::Mask)?),
            Action::Break => format!("if ({}) {{ break; }}", self.operand(a, Type::Mask)?),
        })
    }

    /// The name of a result: its type's initial and its number.
    fn name(&self, id: usize) -> String {
        let initial = match self.instructions[id].action {
            Action::Compute(operation) => match operation.result() {
                Type::Real => 'x',
                Type::Mask => 'm',
                Type::Index => 'i',
            },
            Action::Link(_) | Action::Loop { .. } => 'i',
            Action::Cell => 'c',
            _ => 'x',
        };
        format!("{initial}{id}")
    }

    fn operand(&self, operand: Operand, kind: Type) -> Result<String, WgslError> {
        match (operand, kind) {
            (Operand::Node(id), _) => Ok(self.name(id as usize)),
            (Operand::Literal(word), Type::Real) => literal(f32::from_bits(word)),
            (Operand::Literal(word), Type::Mask) => Ok((word != 0).to_string()),
            (Operand::Literal(word), Type::Index) => Ok(format!("{word}u")),
        }
    }

    /// A number in a memory.
    fn number(&self, kind: Kind, place: Place, row: Operand) -> Result<String, WgslError> {
        let offset = self.offset(place, row)?;
        Ok(match kind {
            Kind::State => format!("state[({offset}) * worlds + world]"),
            Kind::Input => format!("input[({offset}) * worlds + world]"),
            Kind::Output => format!("output[({offset}) * worlds + world]"),
            Kind::Scratch => format!("scratch[({offset}) * worlds + world]"),
            Kind::Parameter if self.options.parameters_per_world => {
                format!("parameters[({offset}) * worlds + world]")
            }
            Kind::Parameter => format!("parameters[{offset}]"),
        })
    }

    fn offset(&self, place: Place, row: Operand) -> Result<String, WgslError> {
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
    fn expression(&self, id: usize, operation: Operation) -> Result<String, WgslError> {
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
            Round => "round($0)",
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
            Whole => "u32($0)",
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

/// A number as WGSL that reads back to the same bits.
///
/// Decimal where that is short and exact, else hexadecimal, since a decimal may
/// be rounded either way.
fn literal(x: f32) -> Result<String, WgslError> {
    if !x.is_finite() {
        return Err(WgslError::NotFinite(x));
    }
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
    Ok(if x.is_sign_negative() {
        format!("(-{text})")
    } else {
        text
    })
}
