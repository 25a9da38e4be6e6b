//! Soft limits of joints, from MuJoCo's constraint parameters.
//!
//! With r the excess over the limit, v its rate, and a₀ the acceleration without the limit, MuJoCo's
//! limit gives the acceleration a = (1 − d) a₀ − d b v − d k r. At full impedance d (modeling guide,
//! "Solver parameters") the solref attribute means
//!
//! ```text
//! solref = (tc, dr):     d b = 2 / tc,   d k = 1 / (tc² dr²)
//! solref = (−k', −b'):   d b = b',       d k = k'
//! ```
//!
//! whatever solimp is. The model's limits are forces, so these are multiplied by the inertia that
//! the degree of freedom shows, at the initial coordinates, to a force on it alone. That is an
//! approximation: MuJoCo uses the inertia of the moment, ramps d with r, and takes d a₀ off the
//! load, so that a limit under load gives way 1/(1 − d) times less than here (20 times, by default).

use model::Limit;

/// The solref attribute: time constant [s] and damping ratio; or, negative, stiffness [1/s²] and
/// damping [1/s] per inertia.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Softness(pub [f64; 2]);

impl Default for Softness {
    fn default() -> Self {
        Self([0.02, 1.0])
    }
}

impl Softness {
    /// A limit of force on what shows `inertia` [kg or kg·m²]. Shorter time constants are raised to
    /// `least_time` [s].
    pub fn limit(&self, (lower, upper): (f64, f64), inertia: f64, least_time: f64) -> Limit {
        let [first, second] = self.0;
        let (k, b) = if first > 0.0 && second > 0.0 {
            let tc = first.max(least_time);
            (1.0 / (tc * tc * second * second), 2.0 / tc)
        } else {
            (-first, -second)
        };
        Limit {
            lower,
            upper,
            stiffness: inertia * k,
            damping: inertia * b,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_limit_is_critically_damped() {
        let m = 3.0;
        let limit = Softness::default().limit((-1.0, 1.0), m, 0.001);
        assert_eq!(limit.damping, m * 2.0 / 0.02);
        let ratio = limit.damping / (2.0 * (limit.stiffness * m).sqrt());
        assert!((ratio - 1.0).abs() < 1e-12);
    }

    #[test]
    fn short_time_constants_are_raised() {
        assert_eq!(
            Softness([1e-6, 1.0]).limit((0.0, 1.0), 1.0, 0.02).damping,
            100.0
        );
    }

    #[test]
    fn negative_reference_is_stiffness_and_damping() {
        let limit = Softness([-100.0, -5.0]).limit((0.0, 1.0), 2.0, 0.01);
        assert_eq!((limit.stiffness, limit.damping), (200.0, 10.0));
    }
}
