//! One scalar without a fused multiply-add, and arrays of them: for any machine.
//!
//! There may be no fused multiply-add here, so `fma` rounds twice; nor an
//! instruction that rounds to a whole number, so sums do it. Operations on arrays
//! are functions of their own, each a loop that the compiler turns into what
//! vectors the machine has; inlined into a kernel, such loops would be scalar code
//! of many times the size.

use super::Layout;
use crate::{Lanes, LanesMask, Mask, Real};
use bytemuck::{Pod, Zeroable};
use core::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub, SubAssign};

/// Sixteen `f32`.
pub type F32x16 = Array<Unfused<f32>, 16>;
/// Eight `f64`.
pub type F64x8 = Array<Unfused<f64>, 8>;

/// A scalar.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct Unfused<T>(T);

/// `N` of them.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(transparent)]
pub struct Array<R, const N: usize>([R; N]);

macro_rules! operators {
    ($($operator:ident $name:ident)+) => {$(
        impl<T: Layout> $operator for Unfused<T> {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                Self(self.0.$name(other.0))
            }
        }
        impl<R: Lanes, const N: usize> $operator for Array<R, N> {
            type Output = Self;
            #[inline(never)]
            fn $name(mut self, other: Self) -> Self {
                for i in 0..N {
                    self.0[i] = self.0[i].$name(other.0[i]);
                }
                self
            }
        }
    )+};
}

operators! { Add add Sub sub Mul mul Div div }

macro_rules! assignments {
    ($($operator:ident $name:ident $op:tt)+) => {$(
        impl<T: Layout> $operator for Unfused<T> {
            #[inline(always)]
            fn $name(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
        impl<R: Lanes, const N: usize> $operator for Array<R, N> {
            #[inline(always)]
            fn $name(&mut self, other: Self) {
                *self = *self $op other;
            }
        }
    )+};
}

assignments! { AddAssign add_assign + SubAssign sub_assign - MulAssign mul_assign * }

impl<T: Layout> Neg for Unfused<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

/// Operations as the scalar does them.
macro_rules! as_scalar {
    ($($name:ident($($arg:ident),*);)+) => {$(
        #[inline(always)]
        fn $name(self $(, $arg: Self)*) -> Self {
            Self(self.0.$name($($arg.0),*))
        }
    )+};
}

impl<T: Layout> Real for Unfused<T> {
    type Scalar = T;
    type Mask = bool;

    #[inline(always)]
    fn lit(x: f64) -> Self {
        Self(T::lit(x))
    }
    #[inline(always)]
    fn splat(x: T) -> Self {
        Self(x)
    }
    #[inline(always)]
    fn fma(self, b: Self, c: Self) -> Self {
        self * b + c
    }
    #[inline(always)]
    fn floor(self) -> Self {
        let rounded = self.round();
        Self::select(rounded.gt(self), rounded - Self::one(), rounded)
    }
    #[inline(always)]
    fn round(self) -> Self {
        // Beside `whole` there is no room for a fraction; larger numbers have none.
        let (size, whole) = (self.abs(), Self(T::WHOLE));
        let rounded = ((size + whole) - whole).copysign(self);
        Self::select(size.lt(whole), rounded, self)
    }
    #[inline(always)]
    fn frexp(self) -> (Self, Self) {
        let (m, e) = self.0.frexp();
        (Self(m), Self(e))
    }
    as_scalar! {
        sqrt();
        abs();
        min(other);
        max(other);
        copysign(sign);
        ldexp(n);
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self.0.lt(other.0)
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self.0.le(other.0)
    }
    #[inline(always)]
    fn same(self, other: Self) -> bool {
        self.0.same(other.0)
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        Self(T::select(mask, yes.0, no.0))
    }
}

impl<T: Layout> Lanes for Unfused<T> {
    const WIDTH: usize = 1;
}

impl<R: Lanes, const N: usize> Neg for Array<R, N> {
    type Output = Self;
    #[inline(never)]
    fn neg(mut self) -> Self {
        for i in 0..N {
            self.0[i] = -self.0[i];
        }
        self
    }
}

/// Operations on each element.
macro_rules! each {
    ($($name:ident($($arg:ident),*);)+) => {$(
        #[inline(never)]
        fn $name(mut self $(, $arg: Self)*) -> Self {
            for i in 0..N {
                self.0[i] = self.0[i].$name($($arg.0[i]),*);
            }
            self
        }
    )+};
}

/// Comparisons of each element.
macro_rules! comparisons {
    ($($name:ident)+) => {$(
        #[inline(never)]
        fn $name(self, other: Self) -> Self::Mask {
            let mut out = Each::splat(false);
            for i in 0..N {
                out.0[i] = self.0[i].$name(other.0[i]);
            }
            out
        }
    )+};
}

impl<R: Lanes, const N: usize> Real for Array<R, N> {
    type Scalar = R::Scalar;
    type Mask = Each<R::Mask, N>;

    #[inline(never)]
    fn lit(x: f64) -> Self {
        Self([R::lit(x); N])
    }
    #[inline(never)]
    fn splat(x: R::Scalar) -> Self {
        Self([R::splat(x); N])
    }
    #[inline(never)]
    fn frexp(self) -> (Self, Self) {
        let (mut m, mut e) = (self, self);
        for i in 0..N {
            (m.0[i], e.0[i]) = self.0[i].frexp();
        }
        (m, e)
    }
    #[inline(never)]
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self {
        let mut out = no;
        for i in 0..N {
            out.0[i] = R::select(mask.0[i], yes.0[i], no.0[i]);
        }
        out
    }
    each! {
        fma(b, c);
        sqrt();
        abs();
        min(other);
        max(other);
        floor();
        round();
        copysign(sign);
        ldexp(n);
    }
    comparisons! { lt le same }
}

impl<R: Lanes, const N: usize> Lanes for Array<R, N> {
    const WIDTH: usize = N * R::WIDTH;
}

/// A truth per element.
#[derive(Clone, Copy, Debug)]
pub struct Each<M, const N: usize>([M; N]);

impl<M: Mask, const N: usize> BitAnd for Each<M, N> {
    type Output = Self;
    #[inline(never)]
    fn bitand(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] & other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> BitOr for Each<M, N> {
    type Output = Self;
    #[inline(never)]
    fn bitor(mut self, other: Self) -> Self {
        for i in 0..N {
            self.0[i] = self.0[i] | other.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Not for Each<M, N> {
    type Output = Self;
    #[inline(never)]
    fn not(mut self) -> Self {
        for i in 0..N {
            self.0[i] = !self.0[i];
        }
        self
    }
}

impl<M: Mask, const N: usize> Mask for Each<M, N> {
    #[inline(never)]
    fn splat(value: bool) -> Self {
        Self([M::splat(value); N])
    }
}

impl<M: LanesMask, const N: usize> LanesMask for Each<M, N> {
    #[inline(never)]
    fn any(self) -> bool {
        let mut any = false;
        for i in 0..N {
            any |= self.0[i].any();
        }
        any
    }
    #[inline(never)]
    fn all(self) -> bool {
        let mut all = true;
        for i in 0..N {
            all &= self.0[i].all();
        }
        all
    }
}
