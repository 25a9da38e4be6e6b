//! Soft limits of joints, from MuJoCo's constraint parameters.
//!
//! With r the excess over the limit, v its rate, and a₀ the acceleration without the limit, MuJoCo's
//! limit gives the acceleration a = (1 − d) a₀ − d b v − d k r. At the largest [impedance](Impedance)
//! d (modeling guide, "Solver parameters") the solref attribute means
//!
//! ```text
//! solref = (tc, dr):     d b = 2 / tc,   d k = 1 / (tc² dr²)
//! solref = (−k', −b'):   d b = b',       d k = k'
//! ```
//!
//! As a force on the inertia m that the degree of freedom shows, at the initial coordinates, to a force
//! on it alone (MuJoCo's `dof_invweight0`), that is
//!
//! ```text
//! (m + m') a = m a₀ − m' (k r + b v)      m' = m d / (1 − d)
//! ```
//!
//! a stop of the model with the inertia m'. MuJoCo also ramps d with r.

use crate::impedance::Impedance;
use model::Limit;

/// MuJoCo's parameters of a limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Softness {
    /// The solref attribute: time constant [s] and damping ratio; or, negative, stiffness [1/s²] and
    /// damping [1/s] per inertia.
    pub reference: [f64; 2],
    pub impedance: Impedance,
}

impl Default for Softness {
    fn default() -> Self {
        Self {
            reference: [0.02, 1.0],
            impedance: Impedance::default(),
        }
    }
}

impl Softness {
    /// A limit of force on what shows `inertia` [kg or kg·m²]. Shorter time constants are raised to
    /// `least_time` [s].
    pub fn limit(&self, (lower, upper): (f64, f64), inertia: f64, least_time: f64) -> Limit {
        let [first, second] = self.reference;
        let (d, growth) = self.impedance.typical();
        let (k, b) = if first > 0.0 && second > 0.0 {
            let tc = first.max(least_time);
            (1.0 / (tc * tc * second * second), 2.0 / tc)
        } else {
            (-first, -second)
        };
        let felt = inertia / (1.0 - d);
        Limit {
            lower,
            upper,
            stiffness: felt * k / (growth * growth),
            damping: felt * b / growth,
            inertia: felt * d,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Half of a load is taken off at any depth.
    fn halved(reference: [f64; 2]) -> Softness {
        Softness {
            reference,
            impedance: Impedance([0.5, 0.5, 0.001, 0.5, 2.0]),
        }
    }

    #[test]
    fn standard_limit_is_critically_damped() {
        let m = 3.0;
        let limit = Softness::default().limit((-1.0, 1.0), m, 0.001);
        // At half the width d = 0.925: the inertia that a load feels is m / (1 − d), and the time
        // constant 0.95 / d times what it is at the end.
        let (felt, time) = (m / 0.075, 0.02 * 0.95 / 0.925);
        assert!((limit.damping * time / (2.0 * felt) - 1.0).abs() < 1e-12);
        let ratio = limit.damping / (2.0 * (limit.stiffness * felt).sqrt());
        assert!((ratio - 1.0).abs() < 1e-12);
        // What runs into it moves with that inertia too.
        assert!((m + limit.inertia - felt).abs() < 1e-12);
    }

    #[test]
    fn short_time_constants_are_raised() {
        let limit = halved([1e-6, 1.0]).limit((0.0, 1.0), 1.0, 0.02);
        assert!((limit.damping - 200.0).abs() < 1e-9);
    }

    #[test]
    fn negative_reference_is_stiffness_and_damping() {
        let limit = halved([-100.0, -5.0]).limit((0.0, 1.0), 2.0, 0.01);
        assert!((limit.stiffness - 400.0).abs() < 1e-9);
        assert!((limit.damping - 20.0).abs() < 1e-9);
    }
}
