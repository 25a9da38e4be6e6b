//! When a solid that moves without turning first touches another.
//!
//! Conservative advancement: Mirtich, Impulse-based Dynamic Simulation of Rigid Body Systems (1996), §2.3; for
//! translations, where the plane between the two tells the most that may be gone: van den Bergen, Ray Casting
//! against General Convex Objects with Application to Continuous Collision Detection (2004).
//!
//! With A moved by t d, |d| = 1, let f(t) be the distance of B from it, and n the unit vector from A to B. All of B
//! is beyond a plane that A has still to go f to along n, and A goes there at the speed n·d. So nothing touches before
//! t + f/(n·d), and nothing ever does where n·d ≤ 0. Since ḟ = −n·d, and the distance of a point from a convex
//! set is convex, these are Newton's steps to the first root of a convex f, from where it falls: they come
//! to the root from before it, and never beyond; quadratically, or, where A only grazes B, by half of what is left
//! each.
//!
//! The direction between solids that nearly touch is rounding over distance. So the normal is that of a little before,
//! where they are [`NEAR`] sizes apart: it errs there by as much as it turns until they touch.

use super::{Convex, Separation, separation};
use glam::DVec3;
use numbers::dispatch::Isa;

/// Distance, against the sizes of the solids, at which the normal is taken.
const NEAR: f64 = 1e-8;
/// Distance, against these, from which one step leads to the root.
const LEAST: f64 = 1e-12;
/// A solid that comes nearer more slowly than this is treated as if it came so fast, in steps that are not Newton's.
const SLOWEST: f64 = 1e-4;
/// Rounds; more than halving takes to get to [`LEAST`].
const ROUNDS: usize = 64;

/// How far [m] A is when it first touches B, if it goes along `direction`, of unit length, from `from` [m] on up to
/// `until`; and the way from A to B just before. Where they overlap at the start, it is there, with the way out.
///
/// Edges and rims, which are known to be apart to a millionth of their sizes, may stop that much too early.
pub fn first_touch(
    isa: Isa,
    a: &Convex<'_>,
    b: &Convex<'_>,
    direction: DVec3,
    [from, until]: [f64; 2],
) -> Option<(f64, Separation)> {
    let size = a.size() + b.size();
    let way = |t: f64| separation(isa, &a.moved(t * direction), b);
    let (mut t, mut speed) = (from, 0.0);
    for round in 0..ROUNDS {
        let now = way(t)?;
        if now.distance <= 0.0 && round == 0 {
            return Some((t, now));
        }
        if now.distance <= 0.0 {
            break;
        }
        speed = now.normal.dot(direction);
        if speed <= 0.0 {
            return None;
        }
        let arrives = now.distance <= LEAST * size;
        t += now.distance / if arrives { speed.max(SLOWEST) } else { speed };
        if t > until {
            return None;
        }
        if arrives {
            break;
        }
    }
    let before = way(t - NEAR * size / speed.max(SLOWEST))?;
    Some((t, before))
}
