//! Elementary functions, branch-free, over any [`Real`].

use crate::Real;

/// `(sin x, cos x)`, x in radians.
#[inline(always)]
pub fn sin_cos<R: Real>(x: R) -> (R, R) {
    let _ = x;
    unimplemented!()
}
/// Angle of the point (x, y) from the x axis, in [−π, π].
#[inline(always)]
pub fn atan2<R: Real>(y: R, x: R) -> R {
    let _ = (x, y);
    unimplemented!()
}
