//! The point of a solid that lies farthest in a direction, in the solid's own frame.

use numbers::{Real, Vec3};

/// Of an ellipsoid: x = S² d / |S d| with S = diag(a, b, c), where its gradient is along d.
#[inline(always)]
pub(crate) fn ellipsoid<R: Real>(half: Vec3<R>, d: Vec3<R>) -> Vec3<R> {
    let scaled = half.times(d);
    half.times(scaled.normalized_or(Vec3::zero()))
}
