//! Coulomb's cone of what sticks, and of what slides.
//!
//! Where the static coefficient μₛ is more than that of sliding, μ, the speed v of the surfaces along each other when a
//! step begins tells which holds for the step: μₛ up to the speed that it could stop within the step,
//!
//! ```text
//! v ≤ μₛ g h
//! ```
//!
//! and μ beyond. So all points of a body that sticks bear what they can before it slides, and what slides does not
//! stick again before it has all but stopped (Stribeck's curve as a step: Armstrong-Hélouvry, Dupont & Canudas de Wit
//! 1994, §2). A force beyond the cone takes as long to break a body away as it takes to that speed.

use numbers::Real;

/// Speed [m/s] below which anything sticks, be it without weight.
const STILL: f64 = 1e-3;

/// The coefficient for a step in which gravity alone would give the speed `fall` [m/s], by the square of v.
#[inline(always)]
pub(crate) fn friction<R: Real>([sliding, sticking]: [R; 2], speed2: R, fall: R) -> R {
    let slow = (sticking * fall).max(R::lit(STILL));
    R::select(speed2.le(slow.squared()), sticking, sliding)
}
