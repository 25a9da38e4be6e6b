//! Surfaces, and what two of them make of a contact.

use serde::{Deserialize, Serialize};

/// Surface of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Coulomb friction coefficient of what slides.
    pub friction: f64,
    /// Coulomb friction coefficient of what sticks, which is what slides more slowly than it could stop within a
    /// step; at least `friction`. None: the same.
    pub static_friction: Option<f64>,
    /// Torsional friction coefficient [m].
    pub torsional_friction: f64,
    /// Rolling friction coefficient [m].
    pub rolling_friction: f64,
    /// Restitution: separation speed over approach speed, 0 to 1. With 0, a body lands on the
    /// softness: a critically damped surface still gives back up to exp(−2) of the speed.
    pub restitution: f64,
    /// How far the surface gives way.
    pub softness: Softness,
    /// Distance from the surface at which contact begins [m], as if the surface were that much
    /// further out; those of two surfaces add up. 0 by default.
    pub margin: f64,
    /// How friction and restitution of two surfaces combine; of two rules the later in
    /// [`Combine`] holds.
    pub combine: Combine,
}

impl Default for Material {
    /// Friction 0.5 whether it slides or sticks, no rolling or torsional friction, no restitution, the
    /// standard softness, averages.
    fn default() -> Self {
        Self {
            friction: 0.5,
            static_friction: None,
            torsional_friction: 0.0,
            rolling_friction: 0.0,
            restitution: 0.0,
            softness: Softness::default(),
            margin: 0.0,
            combine: Combine::Average,
        }
    }
}

/// Resistance of a surface to being pressed in: a spring and a damper at each point of contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Softness {
    /// What brings the touching masses m to rest so, with an added mass m' = m d / (1 − d):
    /// stiffness (m + m') / (T ζ)², damping 2 (m + m') / T, and the force −m' a against the
    /// acceleration a of the point of contact.
    ///
    /// m is the whole mass of what moves, unless the surface has its own, and of two m₁ m₂ / (m₁ + m₂). The
    /// added mass lets a contact settle in the same time, but sink 1 − d times as far under a steady load.
    Time {
        /// Time constant T [s] of the damper.
        constant: f64,
        /// Damping ratio ζ.
        ratio: f64,
        /// Impedance d, from 0 to below 1: the share of a load that the added mass takes.
        impedance: f64,
        /// The mass [kg] that moves at this surface: less than the whole where a light limb gives way.
        mass: Option<f64>,
    },
    /// In physical units.
    Spring {
        /// Stiffness [N/m].
        stiffness: f64,
        /// Damping [N·s/m].
        damping: f64,
    },
}

impl Default for Softness {
    /// Time constant 2 ms, critically damped, no added mass: 10 µm of sinking under a body's
    /// weight on four points.
    fn default() -> Self {
        Self::Time {
            constant: 0.002,
            ratio: 1.0,
            impedance: 0.0,
            mass: None,
        }
    }
}

impl Softness {
    /// Stiffness [N/m] and damping [N·s/m] for touching masses m [kg].
    pub fn spring(self, mass: f64) -> (f64, f64) {
        match self {
            Self::Time {
                constant,
                ratio,
                mass: own,
                ..
            } => {
                let mass = own.unwrap_or(mass) + self.added_mass(mass);
                (mass / (constant * ratio).powi(2), 2.0 * mass / constant)
            }
            Self::Spring { stiffness, damping } => (stiffness, damping),
        }
    }

    /// Added mass [kg] for touching masses m [kg].
    pub fn added_mass(self, mass: f64) -> f64 {
        match self {
            Self::Time {
                impedance: d,
                mass: own,
                ..
            } => own.unwrap_or(mass) * d / (1.0 - d),
            Self::Spring { .. } => 0.0,
        }
    }

    /// Two surfaces pressed together: springs and dampers in series, twice as stiff each as given,
    /// so that two alike make one like them; or the means of time constants, damping ratios and
    /// impedances, and of masses m₁ m₂ / (m₁ + m₂), as each gives way. Physical units go before time constants.
    pub fn with(self, other: Self) -> Self {
        use Softness::{Spring, Time};
        let series = |a: f64, b: f64| {
            if a + b > 0.0 {
                2.0 * a * b / (a + b)
            } else {
                0.0
            }
        };
        match (self, other) {
            (
                Time {
                    constant: a,
                    ratio: c,
                    impedance: e,
                    mass: m,
                },
                Time {
                    constant: b,
                    ratio: d,
                    impedance: f,
                    mass: n,
                },
            ) => Time {
                constant: 0.5 * (a + b),
                ratio: 0.5 * (c + d),
                impedance: 0.5 * (e + f),
                mass: match (m, n) {
                    (Some(m), Some(n)) => Some(m * n / (m + n)),
                    (one, other) => one.or(other),
                },
            },
            (
                Spring {
                    stiffness: a,
                    damping: c,
                },
                Spring {
                    stiffness: b,
                    damping: d,
                },
            ) => Spring {
                stiffness: series(a, b),
                damping: series(c, d),
            },
            (spring @ Spring { .. }, Time { .. }) | (Time { .. }, spring @ Spring { .. }) => spring,
        }
    }
}

/// How two coefficients become one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Default, Serialize, Deserialize)]
pub enum Combine {
    /// Their mean.
    #[default]
    Average,
    /// The smaller.
    Minimum,
    /// Their product.
    Multiply,
    /// The larger.
    Maximum,
}

impl Combine {
    /// One coefficient of two.
    pub fn of(self, a: f64, b: f64) -> f64 {
        match self {
            Self::Average => 0.5 * (a + b),
            Self::Minimum => a.min(b),
            Self::Multiply => a * b,
            Self::Maximum => a.max(b),
        }
    }
}

impl Material {
    /// Coulomb friction coefficient of what sticks.
    pub fn sticking(&self) -> f64 {
        self.static_friction.unwrap_or(self.friction)
    }
    /// The surface that a contact of two has, whichever comes first.
    pub fn with(&self, other: &Self) -> Self {
        let combine = self.combine.max(other.combine);
        let differs = self.static_friction.or(other.static_friction).is_some();
        let sticking = combine.of(self.sticking(), other.sticking());
        Self {
            friction: combine.of(self.friction, other.friction),
            static_friction: differs.then_some(sticking),
            torsional_friction: combine.of(self.torsional_friction, other.torsional_friction),
            rolling_friction: combine.of(self.rolling_friction, other.rolling_friction),
            restitution: combine.of(self.restitution, other.restitution),
            softness: self.softness.with(other.softness),
            margin: self.margin + other.margin,
            combine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_later_rule_holds_and_margins_add_up() {
        let a = Material {
            friction: 0.2,
            margin: 0.01,
            ..Material::default()
        };
        let b = Material {
            friction: 0.6,
            combine: Combine::Multiply,
            ..Material::default()
        };
        assert!((a.with(&a).friction - 0.2).abs() < 1e-15);
        assert!((a.with(&b).friction - 0.12).abs() < 1e-15);
        assert_eq!(a.with(&b).friction, b.with(&a).friction);
        assert_eq!((a.with(&a).margin, a.with(&b).margin), (0.02, 0.01));
    }

    /// One that sticks as it slides is taken for what it is.
    #[test]
    fn static_friction_combines_by_the_rule_of_the_pair() {
        let sticky = Material {
            friction: 0.2,
            static_friction: Some(0.6),
            ..Material::default()
        };
        let plain = Material {
            friction: 0.4,
            ..Material::default()
        };
        let rule = |combine| Material { combine, ..plain };
        assert_eq!(plain.with(&plain).static_friction, None);
        for (combine, sticking) in [
            (Combine::Average, 0.5),
            (Combine::Minimum, 0.4),
            (Combine::Multiply, 0.24),
            (Combine::Maximum, 0.6),
        ] {
            let pair = sticky.with(&rule(combine));
            assert!((pair.sticking() - sticking).abs() < 1e-15, "{combine:?}");
            assert_eq!(pair, rule(combine).with(&sticky));
            assert!(pair.sticking() >= pair.friction);
        }
    }

    fn time(constant: f64, ratio: f64, impedance: f64) -> Softness {
        Softness::Time {
            constant,
            ratio,
            impedance,
            mass: None,
        }
    }

    /// Each gives way by its share: 1/m = 1/m₁ + 1/m₂; what has none of its own does not.
    #[test]
    fn masses_of_surfaces_take_the_place_of_what_moves() {
        let light = |mass| Softness::Time {
            constant: 0.1,
            ratio: 0.5,
            impedance: 0.75,
            mass,
        };
        let one = light(Some(3.0));
        assert_eq!(one.with(light(Some(6.0))), light(Some(2.0)));
        assert_eq!((one.with(light(None)), light(None).with(one)), (one, one));
        assert_eq!(one.added_mass(100.0), 9.0);
        assert_eq!(one.spring(100.0), light(None).spring(3.0));
    }

    #[test]
    fn two_like_springs_make_one_like_them() {
        let s = Softness::Spring {
            stiffness: 2e4,
            damping: 30.0,
        };
        assert_eq!(s.with(s), s);
        assert_eq!(s.with(Softness::default()), s);
        assert_eq!(Softness::default().with(s), s);
        let (soft, hard) = (time(0.06, 0.5, 0.0), time(0.02, 1.0, 0.5));
        assert_eq!(soft.with(hard), time(0.04, 0.75, 0.25));
        let (k, d) = time(0.1, 0.5, 0.0).spring(3.0);
        // ω = 1 / (T ζ) = 20 /s and d = 2 ζ ω m
        assert!((k - 1200.0).abs() < 1e-9 && (d - 60.0).abs() < 1e-12);
    }

    /// With the added mass, the same frequency and damping ratio, and a spring 1 / (1 − d) as stiff.
    #[test]
    fn added_mass_stiffens_at_the_same_time_constant() {
        let (m, impedance) = (3.0, 0.9);
        let (plain, heavy) = (time(0.1, 0.5, 0.0), time(0.1, 0.5, impedance));
        assert_eq!(plain.added_mass(m), 0.0);
        assert!((heavy.added_mass(m) - 27.0).abs() < 1e-12);
        let ((k, d), (stiff, viscous)) = (plain.spring(m), heavy.spring(m));
        assert!((stiff / k - 10.0).abs() < 1e-12 && (viscous / d - 10.0).abs() < 1e-12);
    }
}
