//! The speed with which surfaces leave each other.
//!
//! Restitution e is the ratio of the speeds at the moment of contact. A solver knows those at the beginning of a step,
//! a gap C away, and puts the bounce there, before its time, or to the step's end, at the surface. With the free
//! approach's acceleration a the speeds w before and v after are those of the surface if
//!
//! ```text
//! early     v² + 2 a C = e² (w² + 2 a C)
//! late      v² = e² (w² + 2 a C)
//! ```
//!
//! In steps of length h, semi-implicit velocities lie half a step before their positions. Who takes w and v, early, at
//! the positions, a h/2 further on, lets a ball reach e² of each height, exactly: the energy of what it reports then
//! swings by m g h v/2 about what it has. Who takes them as they are, late, never has more energy, and loses
//! (1 + 1/e) g h / v of each height.

use numbers::Real;

/// v of a bounce before its time, and whether it can be: what is to rise less than the gap has to come nearer first.
///
/// All in units of a velocity: `gained` = a h, and `closing` = C / h.
#[inline(always)]
pub(crate) fn early<R: Real>(e: R, w: R, gained: R, closing: R) -> (R, R::Mask) {
    let fall = R::lit(2.0) * gained * closing.max(R::zero());
    let left = e.squared().fma(w.fma(w, fall), -fall);
    (left.max(R::zero()).sqrt(), left.gt(R::zero()))
}

/// v of a bounce at the step's end.
#[inline(always)]
pub(crate) fn late<R: Real>(e: R, w: R, gained: R, closing: R) -> R {
    let fall = R::lit(2.0) * gained * closing.max(R::zero());
    e * w.fma(w, fall).max(R::zero()).sqrt()
}
