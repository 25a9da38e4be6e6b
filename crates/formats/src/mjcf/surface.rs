//! How contacts of geoms behave (modeling guide, "Contact parameters" and "Solver parameters").
//!
//! A contact of depth r that grows at the rate v changes the acceleration a₀ that the touching bodies
//! would have into (1 − d) a₀ − k r − b v, where d is the [impedance](crate::impedance), which grows
//! with r. At its end
//!
//! ```text
//! solref = (T, ζ):     k = 1 / (T² ζ²),   b = 2 / T
//! solref = (−k, −b)    so T = 2 / b,      ζ = b / (2 √k)
//! ```
//!
//! which is what [`Softness::Time`] says. Time constants below two steps are raised to that, as
//! MuJoCo does ("refsafe").
//!
//! The law is that of a mass m which MuJoCo takes from the initial state, 1/m = Σ 1/mᵢ over the two bodies, with
//! their [mobilities](crate::joint_space::JointSpace::translation) 1/mᵢ; a contact in another state, or beside
//! others, gives way more or less than that. Where cones of friction are pyramids, 2 (c − 1) edges n ± μ t press
//! together (c being `condim`, 1 without friction), each as soft as 2 μ²/i · (1 + μ²) contacts without friction (i
//! being `impratio`; mj_makeImpedance in engine_core_constraint.c, MuJoCo 3), and so all of them as
//!
//! ```text
//! p = μ² (1 + μ²) / (i (c − 1)),    m/p in the place of m.
//! ```
//!
//! Departures: p is [`LEAST_PYRAMID`] at least, as contacts with little friction would otherwise be next to rigid;
//! where neither centre of mass can move, m is the whole mass of what moves; bodies that only slide have their
//! armature, too.

use super::joint::solref;
use super::option::Physics;
use crate::error::FormatError;
use crate::impedance::Impedance;
use crate::report::Report;
use crate::xml::Element;
use model::{Combine, Material, Softness, Whose};
use std::cmp::Ordering;

/// `solmix` below this counts as zero (mjMINVAL).
const LEAST_MIX: f64 = 1e-15;

/// How much softer pyramids make contacts, at least.
const LEAST_PYRAMID: f64 = 1e-3;

/// Masses m whose weight a contact carries at the depth of which it has its impedance: limbs that a robot stands on
/// are lighter than what they carry.
const SHARE: f64 = 2.0;

/// What a geom brings into its contacts.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surface {
    priority: i64,
    /// `condim`: 1 without friction, 3 with sliding, 4 also torsional, 6 also rolling friction.
    directions: i64,
    /// Sliding, torsional [m] and rolling [m] friction.
    friction: [f64; 3],
    mix: f64,
    /// Both positive or both negative.
    solref: [f64; 2],
    solimp: Impedance,
    /// The impedance that it has at all depths, and the one at its end over it.
    held: (f64, f64),
    /// Distance at which contact begins [m].
    margin: f64,
    /// Acceleration per force [1/kg] of the bodies that touch with it, together; zero while none moves.
    pub mobility: f64,
}

impl Surface {
    /// The surface of a `<geom>`.
    pub fn of_geom(
        element: &Element,
        physics: &Physics,
        report: &mut Report,
    ) -> Result<Self, FormatError> {
        let friction = friction(element, [1.0, 0.005, 0.0001])?;
        let solref = spring(element, report)?;
        let solimp = Impedance::read(element, "solimp")?;
        Ok(Self {
            priority: element.integer("priority")?.unwrap_or(0),
            directions: directions(element)?,
            friction,
            mix: element.non_negative("solmix")?.unwrap_or(1.0),
            solref,
            solimp,
            held: held(solref, &solimp, physics),
            margin: element.number("margin")?.unwrap_or(0.0),
            mobility: 0.0,
        })
    }

    /// The surface of a `<pair>`. Takes nothing from the geoms.
    pub fn of_pair(
        element: &Element,
        physics: &Physics,
        report: &mut Report,
    ) -> Result<Self, FormatError> {
        let friction = friction(element, [1.0, 1.0, 0.005, 0.0001, 0.0001])?;
        let [slide, across, torsion, roll, roll_across] = friction;
        let directions = directions(element)?;
        if (slide != across && directions >= 3) || (roll != roll_across && directions == 6) {
            let remedy = "write the same coefficient for both directions";
            report.refuse(element, "friction that differs by direction", remedy)?;
        }
        let solref = spring(element, report)?;
        let solimp = Impedance::read(element, "solimp")?;
        Ok(Self {
            priority: 0,
            directions,
            friction: [slide, torsion, roll],
            mix: 1.0,
            solref,
            solimp,
            held: held(solref, &solimp, physics),
            margin: element.number("margin")?.unwrap_or(0.0),
            mobility: 0.0,
        })
    }

    /// The surface of a contact of two geoms: that of the higher priority; of equal ones the larger
    /// coefficients, and the softness mixed. Margins and mobilities add up.
    pub fn with(&self, other: &Self, physics: &Physics) -> Self {
        let margin = self.margin + other.margin;
        let mobility = self.mobility + other.mobility;
        if self.priority != other.priority {
            let first = self.priority > other.priority;
            let winner = if first { self } else { other }.clone();
            return Self {
                margin,
                mobility,
                ..winner
            };
        }
        let share = match (self.mix >= LEAST_MIX, other.mix >= LEAST_MIX) {
            (true, true) => self.mix / (self.mix + other.mix),
            (true, false) => 1.0,
            (false, true) => 0.0,
            (false, false) => 0.5,
        };
        let (a, b) = (self.solref, other.solref);
        let both_times = a[0] > 0.0 && b[0] > 0.0;
        let mean = |a: f64, b: f64| share * a + (1.0 - share) * b;
        let solref = std::array::from_fn(|i| match both_times {
            true => mean(a[i], b[i]),
            false => a[i].min(b[i]),
        });
        let solimp = Impedance(std::array::from_fn(|i| {
            mean(self.solimp.0[i], other.solimp.0[i])
        }));
        let held = match (solref, solimp) == (a, self.solimp) {
            true => self.held,
            false => held(solref, &solimp, physics),
        };
        Self {
            priority: self.priority,
            directions: self.directions.max(other.directions),
            friction: std::array::from_fn(|i| self.friction[i].max(other.friction[i])),
            mix: self.mix,
            solref,
            solimp,
            held,
            margin,
            mobility,
        }
    }

    /// Whose coefficients a contact of two geoms has.
    pub fn wins(&self, other: &Self) -> Whose {
        match self.priority.cmp(&other.priority) {
            Ordering::Greater => Whose::First,
            Ordering::Less => Whose::Second,
            Ordering::Equal => Whose::Both,
        }
    }

    /// Whether its contacts have friction, with what has none of its own.
    pub fn rubs(&self) -> bool {
        self.directions >= 3
    }

    /// As the material of a shape, whose sliding friction counts in contacts with what [rubs](Self::rubs), even if it does
    /// not itself.
    pub fn of_shape(&self, physics: &Physics) -> Material {
        Material {
            friction: self.friction[0],
            ..self.material(physics)
        }
    }

    /// As the material of a contact.
    pub fn material(&self, physics: &Physics) -> Material {
        let from = |directions, coefficient| match self.directions >= directions {
            true => coefficient,
            false => 0.0,
        };
        let [slide, torsion, roll] = self.friction;
        let (constant, ratio) = times(self.solref, physics);
        let (impedance, growth) = self.held;
        Material {
            friction: from(3, slide),
            torsional_friction: from(4, torsion),
            rolling_friction: from(6, roll),
            softness: Softness::Time {
                constant: constant * growth,
                ratio,
                impedance,
                mass: (self.mobility > 0.0).then(|| 1.0 / (self.mobility * self.pyramid(physics))),
            },
            margin: self.margin,
            combine: Combine::Maximum,
            ..Material::default()
        }
    }

    /// p of the derivation above; 1 without a pyramid.
    fn pyramid(&self, physics: &Physics) -> f64 {
        if !physics.pyramids || self.directions == 1 {
            return 1.0;
        }
        let square = self.friction[0].powi(2);
        let edges = physics.hardness * (self.directions - 1) as f64;
        (square * (1.0 + square) / edges).max(LEAST_PYRAMID)
    }
}

/// Time constant [s] and damping ratio.
fn times(solref: [f64; 2], physics: &Physics) -> (f64, f64) {
    match solref {
        [time, ratio] if time > 0.0 => (time.max(physics.least_time()), ratio),
        [k, b] => (2.0 / -b, -b / (2.0 * (-k).sqrt())),
    }
}

/// [`Surface::held`]: as it is under a weight, or half way down where there is none.
fn held(solref: [f64; 2], solimp: &Impedance, physics: &Physics) -> (f64, f64) {
    let (constant, ratio) = times(solref, physics);
    match SHARE * physics.gravity.length() {
        fall if fall > 0.0 => solimp.under(fall, constant * ratio),
        _ => solimp.typical(),
    }
}

/// The coefficients, those that are not given being the usual ones.
fn friction<const N: usize>(element: &Element, usual: [f64; N]) -> Result<[f64; N], FormatError> {
    let given = element.list("friction", 1, N)?.unwrap_or_default();
    if let Some(x) = given.iter().find(|x| **x < 0.0) {
        let remedy = "write zero or positive numbers";
        return Err(element.invalid_attribute(
            "friction",
            &format!("holds {x}, below zero"),
            remedy,
        ));
    }
    Ok(std::array::from_fn(|i| {
        given.get(i).copied().unwrap_or(usual[i])
    }))
}

fn directions(element: &Element) -> Result<i64, FormatError> {
    match element.integer("condim")?.unwrap_or(3) {
        n @ (1 | 3 | 4 | 6) => Ok(n),
        n => Err(element.invalid_attribute("condim", &format!("is {n}"), "write 1, 3, 4 or 6")),
    }
}

/// `solref`, both numbers positive or both negative.
fn spring(element: &Element, report: &mut Report) -> Result<[f64; 2], FormatError> {
    let numbers = solref(element, "solref")?;
    if numbers.contains(&0.0) {
        let remedy = "write a solref whose numbers are both positive, or both negative";
        report.refuse(element, "a contact without spring or damper", remedy)?;
        return Ok([0.02, 1.0]);
    }
    Ok(numbers)
}
