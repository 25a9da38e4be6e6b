//! Two registers as one of twice the width.

use super::Register;
use crate::{LanesMask, Mask};
use bytemuck::{Pod, Zeroable};
use core::ops::{BitAnd, BitOr, Not};

/// The lower lanes, then the upper lanes.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct Pair<V>([V; 2]);

/// Instructions on both halves.
macro_rules! halves {
    ($($name:ident($($arg:ident),+);)+) => {$(
        #[inline(always)]
        fn $name($($arg: Self),+) -> Self {
            Self([V::$name($($arg.0[0]),+), V::$name($($arg.0[1]),+)])
        }
    )+};
}

/// Comparisons on both halves.
macro_rules! comparisons {
    ($($name:ident)+) => {$(
        #[inline(always)]
        fn $name(a: Self, b: Self) -> Self::Mask {
            Pair([V::$name(a.0[0], b.0[0]), V::$name(a.0[1], b.0[1])])
        }
    )+};
}

impl<V: Register> Register for Pair<V> {
    type Scalar = V::Scalar;
    type Mask = Pair<V::Mask>;
    const WIDTH: usize = 2 * V::WIDTH;

    #[inline(always)]
    fn splat(x: V::Scalar) -> Self {
        Self([V::splat(x), V::splat(x)])
    }
    #[inline(always)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        Self([
            V::select(mask.0[0], yes.0[0], no.0[0]),
            V::select(mask.0[1], yes.0[1], no.0[1]),
        ])
    }
    halves! {
        add(a, b);
        sub(a, b);
        mul(a, b);
        div(a, b);
        fma(a, b, c);
        sqrt(a);
        min(a, b);
        max(a, b);
        floor(a);
        round(a);
        and(a, b);
        or(a, b);
        xor(a, b);
        to_exponent(a);
        from_exponent(a);
    }
    comparisons! { lt le eq }
}

impl<M: Mask> BitAnd for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self([self.0[0] & other.0[0], self.0[1] & other.0[1]])
    }
}

impl<M: Mask> BitOr for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self([self.0[0] | other.0[0], self.0[1] | other.0[1]])
    }
}

impl<M: Mask> Not for Pair<M> {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self([!self.0[0], !self.0[1]])
    }
}

impl<M: Mask> Mask for Pair<M> {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self([M::splat(value), M::splat(value)])
    }
}

impl<M: LanesMask> LanesMask for Pair<M> {
    #[inline(always)]
    fn any(self) -> bool {
        self.0[0].any() | self.0[1].any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0[0].all() & self.0[1].all()
    }
}
