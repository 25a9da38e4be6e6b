//! Dry friction of joints.
//!
//! Of size f, against the speed q̇' that a step of length h ends with, and in proportion to it below [`FRICTION_SPEED`] ε:
//!
//! ```text
//! F = −c q̇'      c = f / max(|q̇'|, ε)
//! ```
//!
//! In the articulated-body algorithm this takes c q̇ from u and adds h c to D: it stops, and never reverses, a motion. Which c
//! it is follows from w, the speed without friction, as D (q̇' − w) = −h f sgn q̇':
//!
//! ```text
//! w = q̇ + h (q̈⁻ + u / D)      |q̇'| = |w| − h f / D
//! ```
//!
//! In the first pass over the tree u is that of a parent that accelerates as in the step before, which is exact for one
//! joint. Further ones, while c q̇' is not the friction, have it from the q̈ of the pass before: D q̈⁻ + u = (D + h c) q̈ + c
//! q̇. What is right keeps its c, so that a pass that another world needs finds the same again.
//!
//! Limitation: loops and couplings lock rows that are solved after the passes, and make a joint move on whatever its
//! friction is. What that lacked in a step, their forces would bear in the next, in which w would fall short by it: both
//! would swing. So c is f / |q̇| there, of the speed before the step, and too large by |q̇'| / |q̇| where a motion begins.

use super::tables::{Tables, dof};
use numbers::{Cell, Machine, Real};

/// Speed [m/s or rad/s] below which dry friction turns into viscous creep.
pub const FRICTION_SPEED: f64 = 1e-3;
/// What of f friction may be off by, when passes end.
const ERROR: f64 = 1e-3;

/// Fields of [`Tables::rubbing`], a row for each degree of freedom.
pub(crate) mod rubbing {
    /// c; negative before the first pass.
    pub const DAMPING: usize = 0;
    /// 1 where the next pass is to find another.
    pub const WRONG: usize = 1;
    pub const WIDTH: usize = 2;
}

/// Forgets what passes have found.
#[inline(always)]
pub(crate) fn begin<M: Machine>(k: &mut M, t: &Tables) {
    let unknown = [-M::R::one(), M::R::one()];
    for v in k.count(t.forces.frictions) {
        k.write(t.rubbing, v, 0, unknown);
    }
}

/// Takes friction for what it was, in the passes to come.
#[inline(always)]
pub(crate) fn hold<M: Machine>(k: &mut M, t: &Tables) {
    for v in k.count(t.forces.frictions) {
        k.store(t.rubbing, v, rubbing::WRONG, M::R::zero());
    }
}

/// Takes c q̇ from u, and adds h c to D.
#[inline(always)]
pub(crate) fn act<M: Machine>(
    k: &mut M,
    t: &Tables,
    v: M::I,
    h: M::R,
    u: &mut M::Cell,
    d: &mut M::Cell,
) {
    let zero = M::R::zero();
    let f = k.load(t.forces.friction, v, 0);
    if let Some(_branch) = k.if_any(f.gt(zero)) {
        let (speed, opposed) = (k.load(t.velocity, v, 0), d.read());
        let [before, wrong] = k.read(t.rubbing, v, rubbing::DAMPING);
        let acceleration = k.load(t.dof, v, dof::ACCELERATION);
        let found = h.fma(before, opposed).fma(acceleration, before * speed);
        let recent = t.before(k, v);
        let guess = opposed.fma(recent, u.read());
        let force = M::R::select(before.lt(zero), guess, found);
        let per_force = h / opposed;
        let free = per_force.fma(force, speed).abs();
        let foreseen = per_force.fnma(f, free);
        let slip = if t.locked.count > 0 {
            speed.abs()
        } else {
            foreseen
        };
        let other = f / slip.max(M::R::lit(FRICTION_SPEED));
        let c = M::R::select(wrong.gt(zero), other, before);
        k.store(t.rubbing, v, rubbing::DAMPING, c);
        u.write(c.fnma(h.fma(recent, speed), u.read()));
        d.write(h.fma(c, opposed));
    }
}

/// Counts where friction is not what it was taken for, under the accelerations found over `h` [s].
#[inline(always)]
pub(crate) fn settle<M: Machine>(k: &mut M, t: &Tables, h: M::R, changes: &mut M::Cell) {
    if t.locked.count > 0 {
        return hold(k, t);
    }
    for v in k.count(t.forces.frictions) {
        let f = k.load(t.forces.friction, v, 0);
        if let Some(_branch) = k.if_any(f.gt(M::R::zero())) {
            let c = k.load(t.rubbing, v, rubbing::DAMPING);
            let acceleration = k.load(t.dof, v, dof::ACCELERATION);
            let speed = h.fma(acceleration, k.load(t.velocity, v, 0)).abs();
            let off = (c * speed.max(M::R::lit(FRICTION_SPEED)) - f).abs();
            let wrong = off.gt(f * M::R::lit(ERROR));
            let change = M::R::select(wrong, M::R::one(), M::R::zero());
            k.store(t.rubbing, v, rubbing::WRONG, change);
            changes.write(changes.read() + change);
        }
    }
}

/// The force [N or N·m] of friction on what does not accelerate.
#[inline(always)]
pub(crate) fn at_rest<M: Machine>(k: &M, t: &Tables, v: M::I) -> M::R {
    let (f, speed) = (k.load(t.forces.friction, v, 0), k.load(t.velocity, v, 0));
    -(f * speed) / speed.abs().max(M::R::lit(FRICTION_SPEED))
}
