//! What turns an instruction set's table into numbers and masks.

use super::Layout;
use crate::Real;

/// A call of instructions, as a function of their own with the target features they need.
///
/// The compiler simplifies that function once, and then inlines the little that is left.
macro_rules! instructions {
    ($features:literal ($($arg:ident: $type:ty = $value:expr),+) -> $out:ty $body:block) => {{
        #[inline]
        #[target_feature(enable = $features)]
        fn instructions($($arg: $type),+) -> $out $body
        // SAFETY: the instructions exist here; see the module.
        #[allow(unused_unsafe)] // WebAssembly's are safe to call
        unsafe { instructions($($value),+) }
    }};
}

/// The same instruction on each register of the arguments.
macro_rules! each {
    ($features:literal ($($arg:ident: $type:ty = $value:expr),+) -> $out:ty = $each:expr) => {
        instructions!($features ($($arg: $type = $value),+) -> $out {
            let mut out = <$out as bytemuck::Zeroable>::zeroed();
            for i in 0..out.0.len() {
                let ($($arg,)+) = ($($arg.0[i],)+);
                out.0[i] = $each;
            }
            out
        })
    };
}

/// Writes a table of instructions out as a number and its mask.
///
/// The table gives the target features, the number (an array of registers, of so many scalars) and its
/// mask (an array of registers or of words), and what each operation is on one register. `operators` are
/// those of `core::ops`, `functions` and `comparisons` those of [`Real`], `bits` those of [`Bits`]; `quads` names
/// functions for those of [`Lanes`](crate::Lanes), where there are faster ones.
macro_rules! lanes {
    (
        $features:literal
        $number:ident([$register:ty; $n:literal]) of $scalar:ty;
        $(quads($load:ident, $store:ident);)?
        splat($s:ident) = $splat:expr;
        operators { $($operator:ident $op:ident($x:ident $(, $y:ident)?) = $operation:expr;)+ }
        functions { $($name:ident($a:ident $(, $b:ident)*) = $function:expr;)+ }
        bits { $($bits:ident($p:ident $(, $q:ident)?) = $bitwise:expr;)+ }
        comparisons { $($compare:ident($l:ident, $r:ident) = $comparison:expr;)+ }
        select($mask:ident, $yes:ident, $no:ident) = $select:expr;

        $truth:ident([$flags:ty; $m:literal]);
        splat($t:ident) = $truth_splat:expr;
        operators { $($mask_operator:ident $mask_op:ident($v:ident $(, $w:ident)?) = $mask_operation:expr;)+ }
        any($any:ident) = $some:expr;
        all($all:ident) = $every:expr;
    ) => {
        #[doc = concat!("Numbers of `", stringify!($scalar), "`, side by side.")]
        #[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(transparent)]
        pub struct $number([$register; $n]);

        $(impl core::ops::$operator for $number {
            type Output = Self;
            #[inline(always)]
            fn $op(self $(, $y: Self)?) -> Self {
                each!($features ($x: $number = self $(, $y: $number = $y)?) -> $number = $operation)
            }
        })+

        impl core::ops::AddAssign for $number {
            #[inline(always)]
            fn add_assign(&mut self, other: Self) {
                *self = *self + other;
            }
        }
        impl core::ops::SubAssign for $number {
            #[inline(always)]
            fn sub_assign(&mut self, other: Self) {
                *self = *self - other;
            }
        }
        impl core::ops::MulAssign for $number {
            #[inline(always)]
            fn mul_assign(&mut self, other: Self) {
                *self = *self * other;
            }
        }

        impl $crate::Real for $number {
            type Scalar = $scalar;
            type Mask = $truth;

            #[inline(always)]
            fn lit(x: f64) -> Self {
                Self::splat(x as $scalar)
            }
            #[inline(always)]
            fn splat(x: $scalar) -> Self {
                instructions!($features ($s: $scalar = x) -> $number { $number([$splat; $n]) })
            }
            $(#[inline(always)]
            fn $name(self $(, $b: Self)*) -> Self {
                each!($features ($a: $number = self $(, $b: $number = $b)*) -> $number = $function)
            })+
            $(#[inline(always)]
            fn $compare(self, $r: Self) -> $truth {
                each!($features ($l: $number = self, $r: $number = $r) -> $truth = $comparison)
            })+
            #[inline(always)]
            fn select($mask: $truth, $yes: Self, $no: Self) -> Self {
                each!($features ($mask: $truth = $mask, $yes: $number = $yes, $no: $number = $no)
                    -> $number = $select)
            }
            #[inline(always)]
            fn copysign(self, sign: Self) -> Self {
                $crate::lanes::table::copysign(self, sign)
            }
            #[inline(always)]
            fn ldexp(self, n: Self) -> Self {
                $crate::lanes::table::ldexp(self, n)
            }
            #[inline(always)]
            fn frexp(self) -> (Self, Self) {
                $crate::lanes::table::frexp(self)
            }
        }

        impl $crate::lanes::table::Bits for $number {
            $(#[inline(always)]
            fn $bits(self $(, $q: Self)?) -> Self {
                each!($features ($p: $number = self $(, $q: $number = $q)?) -> $number = $bitwise)
            })+
        }

        impl $crate::Lanes for $number {
            const WIDTH: usize = size_of::<Self>() / size_of::<$scalar>();
            $(#[inline(always)]
            fn load_quads<const Q: usize>(rows: &[&[Quad<$scalar>; Q]; LANES], quad: usize) -> [Self; 4] {
                // SAFETY: the instructions exist here; see the module.
                unsafe { $load(rows, quad) }
            }
            #[inline(always)]
            fn store_quads<const Q: usize>(
                columns: [Self; 4],
                rows: &[&[Quad<$scalar>; Q]; LANES],
                quad: usize,
            ) {
                // SAFETY: the instructions exist here; see the module.
                unsafe { $store(columns, rows, quad) }
            })?
        }

        /// A truth per lane.
        #[derive(Clone, Copy, Debug, bytemuck::Zeroable)]
        #[repr(transparent)]
        pub struct $truth([$flags; $m]);

        $(impl core::ops::$mask_operator for $truth {
            type Output = Self;
            #[inline(always)]
            fn $mask_op(self $(, $w: Self)?) -> Self {
                each!($features ($v: $truth = self $(, $w: $truth = $w)?) -> $truth = $mask_operation)
            }
        })+

        impl $crate::Mask for $truth {
            #[inline(always)]
            fn splat(value: bool) -> Self {
                instructions!($features ($t: bool = value) -> $truth { $truth([$truth_splat; $m]) })
            }
        }

        impl $crate::LanesMask for $truth {
            #[inline(always)]
            fn any(self) -> bool {
                instructions!($features (mask: $truth = self) -> bool {
                    let mut any = false;
                    for $any in mask.0 {
                        any |= $some;
                    }
                    any
                })
            }
            #[inline(always)]
            fn all(self) -> bool {
                instructions!($features (mask: $truth = self) -> bool {
                    let mut all = true;
                    for $all in mask.0 {
                        all &= $every;
                    }
                    all
                })
            }
        }
    };
}
pub(super) use {each, instructions, lanes};

/// A number whose bits can be had.
pub(super) trait Bits: Real<Scalar: Layout> {
    fn and(self, other: Self) -> Self;
    fn or(self, other: Self) -> Self;
    /// The lowest bits move up to the exponent; higher ones are lost.
    fn shift_up(self) -> Self;
    /// The exponent, and the sign above it, move down to the lowest bits.
    fn shift_down(self) -> Self;
}

#[inline(always)]
pub(super) fn copysign<R: Bits>(x: R, sign: R) -> R {
    x.abs().or(sign.and(R::splat(R::Scalar::SIGN)))
}

/// `x · 2ⁿ`, by two factors so that each is a normal power of two.
#[inline(always)]
pub(super) fn ldexp<R: Bits>(x: R, n: R) -> R {
    let limit = R::splat(R::Scalar::LIMIT + R::Scalar::LIMIT);
    let n = n.clamp(-limit, limit);
    let half = (n * R::lit(0.5)).floor();
    x * power_of_two(half) * power_of_two(n - half)
}

/// 2ⁿ for a whole n of a normal power: n + bias, counted in the lowest bits, moved up.
#[inline(always)]
fn power_of_two<R: Bits>(n: R) -> R {
    (n + R::splat(R::Scalar::WHOLE + R::Scalar::BIAS)).shift_up()
}

/// `(m, e)` with `x = m · 2ᵉ`: the fraction with the exponent of 1, and the exponent as a number.
#[inline(always)]
pub(super) fn frexp<R: Bits>(x: R) -> (R, R) {
    let m = x.and(R::splat(R::Scalar::FRACTION)).or(R::one());
    let exponent = x.shift_down().and(R::splat(R::Scalar::EXPONENT));
    let counted = exponent.or(R::splat(R::Scalar::WHOLE));
    (m, counted - R::splat(R::Scalar::WHOLE + R::Scalar::BIAS))
}
