//! The handles that a recorded kernel computes with.

use super::graph::{Handle, apply};
use super::operation::Operation;
use super::program::narrow;
use crate::machine::Index;
use crate::real::{Mask, Real};
use core::fmt;
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// A recorded number: an `f32` literal or the result of an instruction.
#[derive(Clone, Copy)]
pub struct Trace<'g>(pub(super) Handle<'g>);

/// A recorded condition.
#[derive(Clone, Copy)]
pub struct TraceMask<'g>(pub(super) Handle<'g>);

/// A recorded whole number of 32 bits.
#[derive(Clone, Copy)]
pub struct TraceIndex<'g>(pub(super) Handle<'g>);

macro_rules! handle {
    ($name:ident, $literal:expr) => {
        impl fmt::Debug for $name<'_> {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                match self.0 {
                    Handle::Literal(word) => fmt::Debug::fmt(&$literal(word), f),
                    Handle::Node(node) => write!(f, "%{}", node.id),
                }
            }
        }
    };
}
handle!(Trace, f32::from_bits);
handle!(TraceMask, |word| word != 0);
handle!(TraceIndex, core::convert::identity);

macro_rules! binary {
    ($operator:ident, $function:ident, $operation:ident) => {
        impl $operator for Trace<'_> {
            type Output = Self;
            fn $function(self, b: Self) -> Self {
                Self(apply(Operation::$operation, &[self.0, b.0]))
            }
        }
    };
    ($operator:ident, $function:ident, $operation:ident, assign) => {
        impl $operator for Trace<'_> {
            fn $function(&mut self, b: Self) {
                *self = Self(apply(Operation::$operation, &[self.0, b.0]));
            }
        }
    };
}
binary!(Add, add, Add);
binary!(Sub, sub, Subtract);
binary!(Mul, mul, Multiply);
binary!(Div, div, Divide);
binary!(AddAssign, add_assign, Add, assign);
binary!(SubAssign, sub_assign, Subtract, assign);
binary!(MulAssign, mul_assign, Multiply, assign);

impl Neg for Trace<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        Self(apply(Operation::Negate, &[self.0]))
    }
}

impl<'g> Real for Trace<'g> {
    type Scalar = f32;
    type Mask = TraceMask<'g>;

    fn lit(x: f64) -> Self {
        Self::splat(x as f32)
    }
    fn splat(x: f32) -> Self {
        Self(Handle::Literal(x.to_bits()))
    }
    fn fma(self, b: Self, c: Self) -> Self {
        Self(apply(Operation::Fma, &[self.0, b.0, c.0]))
    }
    fn sqrt(self) -> Self {
        Self(apply(Operation::Sqrt, &[self.0]))
    }
    fn abs(self) -> Self {
        Self(apply(Operation::Abs, &[self.0]))
    }
    fn min(self, other: Self) -> Self {
        Self(apply(Operation::Min, &[self.0, other.0]))
    }
    fn max(self, other: Self) -> Self {
        Self(apply(Operation::Max, &[self.0, other.0]))
    }
    fn floor(self) -> Self {
        Self(apply(Operation::Floor, &[self.0]))
    }
    fn round(self) -> Self {
        Self(apply(Operation::Round, &[self.0]))
    }
    fn copysign(self, sign: Self) -> Self {
        Self(apply(Operation::Copysign, &[self.0, sign.0]))
    }
    fn ldexp(self, n: Self) -> Self {
        Self(apply(Operation::Ldexp, &[self.0, n.0]))
    }
    fn frexp(self) -> (Self, Self) {
        (
            Self(apply(Operation::Fraction, &[self.0])),
            Self(apply(Operation::Exponent, &[self.0])),
        )
    }
    fn lt(self, other: Self) -> TraceMask<'g> {
        TraceMask(apply(Operation::Less, &[self.0, other.0]))
    }
    fn le(self, other: Self) -> TraceMask<'g> {
        TraceMask(apply(Operation::LessEqual, &[self.0, other.0]))
    }
    fn same(self, other: Self) -> TraceMask<'g> {
        TraceMask(apply(Operation::Same, &[self.0, other.0]))
    }
    fn select(mask: TraceMask<'g>, yes: Self, no: Self) -> Self {
        match mask.0 {
            Handle::Literal(0) => no,
            Handle::Literal(_) => yes,
            mask => Self(apply(Operation::Select, &[mask, yes.0, no.0])),
        }
    }
}

impl Mask for TraceMask<'_> {
    fn splat(value: bool) -> Self {
        Self(Handle::Literal(u32::from(value)))
    }
}

impl BitAnd for TraceMask<'_> {
    type Output = Self;
    fn bitand(self, b: Self) -> Self {
        match (self.0, b.0) {
            (Handle::Literal(0), _) | (_, Handle::Literal(1)) => self,
            (Handle::Literal(1), _) | (_, Handle::Literal(0)) => b,
            (x, y) => Self(apply(Operation::And, &[x, y])),
        }
    }
}

impl BitOr for TraceMask<'_> {
    type Output = Self;
    fn bitor(self, b: Self) -> Self {
        match (self.0, b.0) {
            (Handle::Literal(1), _) | (_, Handle::Literal(0)) => self,
            (Handle::Literal(0), _) | (_, Handle::Literal(1)) => b,
            (x, y) => Self(apply(Operation::Or, &[x, y])),
        }
    }
}

impl Not for TraceMask<'_> {
    type Output = Self;
    fn not(self) -> Self {
        Self(apply(Operation::Not, &[self.0]))
    }
}

impl TraceIndex<'_> {
    pub(super) fn literal(n: usize) -> Self {
        Self(Handle::Literal(narrow(n)))
    }
}

impl Index for TraceIndex<'_> {
    fn plus(self, other: Self) -> Self {
        match (self.0, other.0) {
            (Handle::Literal(0), _) => other,
            (_, Handle::Literal(0)) => self,
            (x, y) => Self(apply(Operation::IndexSum, &[x, y])),
        }
    }
    fn offset(self, n: usize) -> Self {
        self.plus(Self::literal(n))
    }
}
