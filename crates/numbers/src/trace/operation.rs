//! The pure operations of a record, and what each computes.

use crate::Real;

/// What a word stands for: the bits of an `f32`, 0 or 1, or a whole number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Type {
    Real,
    Mask,
    Index,
}

/// An operation without side effects: equal operands give equal results.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
    Negate,
    Fma,
    Sqrt,
    Abs,
    Min,
    Max,
    Floor,
    Round,
    Copysign,
    Ldexp,
    /// The first part of `frexp`.
    Fraction,
    /// The second part of `frexp`.
    Exponent,
    Less,
    LessEqual,
    Same,
    Select,
    And,
    Or,
    Not,
    IndexSum,
    IndexEqual,
    IndexLess,
    /// An index as a number.
    Number,
    /// A number as an index.
    Whole,
}

impl Operation {
    /// The type of its operand number `k`.
    pub fn operand(self, k: usize) -> Type {
        use Operation::*;
        match self {
            And | Or | Not => Type::Mask,
            Select if k == 0 => Type::Mask,
            IndexSum | IndexEqual | IndexLess | Number => Type::Index,
            _ => Type::Real,
        }
    }

    /// The type of its result.
    pub fn result(self) -> Type {
        use Operation::*;
        match self {
            Less | LessEqual | Same | And | Or | Not | IndexEqual | IndexLess => Type::Mask,
            IndexSum | Whole => Type::Index,
            _ => Type::Real,
        }
    }

    /// Its result, by the arithmetic of `f32` where the operands are reals.
    pub fn evaluate(self, words: [u32; 3]) -> u32 {
        use Operation::*;
        let [a, b, c] = words.map(f32::from_bits);
        let [i, j, k] = words;
        match self {
            Add => (a + b).to_bits(),
            Subtract => (a - b).to_bits(),
            Multiply => (a * b).to_bits(),
            Divide => (a / b).to_bits(),
            Negate => (-a).to_bits(),
            Fma => a.fma(b, c).to_bits(),
            Sqrt => Real::sqrt(a).to_bits(),
            Abs => Real::abs(a).to_bits(),
            Min => Real::min(a, b).to_bits(),
            Max => Real::max(a, b).to_bits(),
            Floor => Real::floor(a).to_bits(),
            Round => Real::round(a).to_bits(),
            Copysign => Real::copysign(a, b).to_bits(),
            Ldexp => a.ldexp(b).to_bits(),
            Fraction => a.frexp().0.to_bits(),
            Exponent => a.frexp().1.to_bits(),
            Less => u32::from(a.lt(b)),
            LessEqual => u32::from(a.le(b)),
            Same => u32::from(a.same(b)),
            Select if i == 0 => k,
            Select => j,
            And => i & j,
            Or => i | j,
            Not => 1 - i,
            IndexSum => i.wrapping_add(j),
            IndexEqual => u32::from(i == j),
            IndexLess => u32::from(i < j),
            Number => (i as f32).to_bits(),
            Whole => a as u32,
        }
    }
}
