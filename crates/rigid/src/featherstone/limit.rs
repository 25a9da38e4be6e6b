//! Limits of coordinates: stops that act beyond an end of the range, and never pull.
//!
//! With the excess r, positive beyond the upper end and negative beyond the lower, a stop of stiffness
//! k, damping d and inertia m gives, in a step of length h,
//!
//! ```text
//! f = −k (r + h q̇') − d ((1 − θ) q̇ + θ q̇') − m q̈ = −(f₀ + g q̈)
//! f₀ = k (r + h q̇) + d q̇      g = h² k + θ h d + m      θ = (3 m + h d) / (6 m + h d)
//! ```
//!
//! where that pushes back, f r < 0, and nothing elsewhere. In the articulated-body algorithm it takes
//! f₀ from u, and adds g to D. θ slows m as d alone does, by e⁻ᶻ with z = h d / m: there
//! θ = 1/(1 − e⁻ᶻ) − 1/z = ½ + z/12 + O(z³) (Liniger & Willoughby 1970, exponential fitting); without
//! inertia θ = 1, which is stable however stiff.
//!
//! Whether it pushes back is known once q̈ is. In the first pass over the tree q̈ is taken for q̈⁻ + u / D, what it would be
//! if the parent accelerated as in the step before; further ones, while stops are wrong, go by the q̈ of the pass before.

use super::articulated_body::{TINY, articulated_body};
use super::friction;
use super::tables::{Tables, dof};
use crate::tables::UNBOUNDED;
use model::Limit;
use numbers::{Cell, Machine, Real};

/// Passes at most for stops and friction alone.
const PASSES: usize = 5;

/// Fields of [`Tables::stop`], a row for each degree of freedom.
pub(crate) mod stop {
    /// r.
    pub const EXCESS: usize = 0;
    /// Positive where the stop is taken to push back; zero before the first pass. f₀ and g follow.
    pub const ACTS: usize = 1;
    /// What [`ACTS`] was in the pass before.
    pub const ACTED: usize = 4;
    pub const WIDTH: usize = 5;
}

/// Lower and upper end, k, d, θ d for steps of length `h` [s], and m; for a degree of freedom without
/// a limit, those of one that it never reaches.
pub(crate) fn numbers(limit: Option<&Limit>, h: f64) -> [f64; 6] {
    let Some(l) = limit else {
        return [-UNBOUNDED, UNBOUNDED, 0.0, 0.0, 0.0, 0.0];
    };
    let late = late_damping(l.damping, l.inertia, h);
    [l.lower, l.upper, l.stiffness, l.damping, late, l.inertia]
}

/// θ d: what of a damping acts on the speed at the end of a step of length `h` [s].
#[inline(always)]
pub(crate) fn late_damping<R: Real>(damping: R, inertia: R, h: R) -> R {
    let three = R::lit(3.0);
    let all = three.fma(inertia, h * damping);
    damping * all / three.fma(inertia, all).max(R::lit(TINY))
}

/// r of a degree of freedom's stop.
#[inline(always)]
fn excess<M: Machine>(k: &M, t: &Tables, v: M::I) -> M::R {
    let q = k.load(t.position, k.link(t.forces.limit_links, v, 0), 0);
    let [lower, upper] = k.read(t.forces.limit, v, 0);
    (q - upper).max(M::R::zero()) + (q - lower).min(M::R::zero())
}

/// Takes f₀ from u, and adds g to D, where the stop acts.
#[inline(always)]
pub(crate) fn act<M: Machine>(k: &mut M, t: &Tables, v: M::I, u: &mut M::Cell, d: &mut M::Cell) {
    let zero = M::R::zero();
    let r = k.load(t.stop, v, stop::EXCESS);
    if let Some(_branch) = k.if_any(!r.same(zero)) {
        let [known, force, opposing] = k.read(t.stop, v, stop::ACTS);
        let force = opposing.fma(t.before(k, v), force);
        let guess = (force * r).fma(d.read(), (opposing * r) * u.read());
        let sign = M::R::select(known.same(zero), guess, known);
        k.store(t.stop, v, stop::ACTS, sign);
        let acts = sign.gt(zero);
        u.write(u.read() - M::R::select(acts, force, zero));
        d.write(d.read() + M::R::select(acts, opposing, zero));
    }
}

/// [`articulated_body`] under stops and friction that agree with the accelerations found, as far as [`PASSES`] reach.
#[inline(always)]
pub(crate) fn under_stops<M: Machine, const CONTACTS: bool>(
    k: &mut M,
    t: &Tables,
    h: M::R,
    implicit: M::R,
) {
    begin(k, t, implicit);
    friction::begin(k, t);
    let guesses = t.forces.limits + t.forces.frictions > 0;
    for _ in k.count(if guesses { PASSES } else { 1 }) {
        articulated_body::<M, CONTACTS>(k, t, h, implicit);
        let mut changes = k.cell(M::R::zero());
        settle(k, t, &mut changes);
        friction::settle(k, t, implicit, &mut changes);
        if k.finished(changes.read().same(M::R::zero())) {
            break;
        }
    }
}

/// Finds how far degrees of freedom are beyond an end, with the laws of their stops over steps of `h` [s], and forgets what
/// passes have found.
#[inline(always)]
pub(crate) fn begin<M: Machine>(k: &mut M, t: &Tables, h: M::R) {
    let zero = M::R::zero();
    for v in k.count(t.forces.limits) {
        let r = excess(k, t, v);
        k.store(t.stop, v, stop::EXCESS, r);
        if let Some(_branch) = k.if_any(!r.same(zero)) {
            let [force, opposing] = law(k, t, v, r, h);
            k.write(t.stop, v, stop::ACTS, [zero, force, opposing]);
        }
    }
}

/// f₀ and g of a degree of freedom's stop beyond which it is by r; with h = 0 its law is explicit.
#[inline(always)]
fn law<M: Machine>(k: &M, t: &Tables, v: M::I, r: M::R, h: M::R) -> [M::R; 2] {
    let [stiffness, damping, late, inertia] = k.read(t.forces.limit, v, 2);
    let speed = k.load(t.velocity, v, 0);
    let force = stiffness.fma(h.fma(speed, r), damping * speed);
    let opposing = h.fma(h.fma(stiffness, late), inertia);
    [force, opposing]
}

/// Finds which stops push back under the accelerations found, and counts those that were taken for
/// something else.
#[inline(always)]
pub(crate) fn settle<M: Machine>(k: &mut M, t: &Tables, changes: &mut M::Cell) {
    let zero = M::R::zero();
    for v in k.count(t.forces.limits) {
        let r = k.load(t.stop, v, stop::EXCESS);
        if let Some(_branch) = k.if_any(!r.same(zero)) {
            let [before, force, opposing] = k.read(t.stop, v, stop::ACTS);
            let acceleration = k.load(t.dof, v, dof::ACCELERATION);
            let known = opposing.fma(acceleration, force) * r;
            k.store(t.stop, v, stop::ACTS, known);
            k.store(t.stop, v, stop::ACTED, before);
            let (acted, acts) = (before.gt(zero), known.gt(zero));
            let wrong = (acts & !acted) | (acted & !acts);
            let change = M::R::select(wrong, M::R::one(), zero);
            changes.write(changes.read() + change);
        }
    }
}

/// Takes the stops for what they were when the accelerations were found, but in the lanes of `open`.
#[inline(always)]
pub(crate) fn go_back<M: Machine>(k: &mut M, t: &Tables, open: <M::R as Real>::Mask) {
    for v in k.count(t.forces.limits) {
        let beyond = !k.load(t.stop, v, stop::EXCESS).same(M::R::zero());
        if let Some(_branch) = k.if_any(beyond) {
            let acts = k.load(t.stop, v, stop::ACTS);
            let acted = k.load(t.stop, v, stop::ACTED);
            k.store(t.stop, v, stop::ACTS, M::R::select(open, acts, acted));
        }
    }
}

/// The force [N or N·m] of a stop on what does not accelerate.
#[inline(always)]
pub(crate) fn at_rest<M: Machine>(k: &M, t: &Tables, v: M::I) -> M::R {
    let r = excess(k, t, v);
    let [force, _] = law(k, t, v, r, M::R::zero());
    let acts = (force * r).gt(M::R::zero());
    M::R::select(acts, -force, M::R::zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// θ = 1/(1 − e⁻ᶻ) − 1/z for small z, up to z²/72, and 1 without inertia.
    #[test]
    fn a_stop_slows_its_inertia_as_damping_does() {
        for z in [0.01, 0.1, 0.3, 1.0_f64] {
            let exact = 1.0 / (1.0 - (-z).exp()) - 1.0 / z;
            assert!((late_damping(z, 1.0, 1.0) / z - exact).abs() < z.powi(2) / 72.0);
        }
        assert_eq!(late_damping(2.0, 0.0, 1.0), 2.0);
        assert_eq!(late_damping(0.0, 0.0, 1.0), 0.0);
    }
}
