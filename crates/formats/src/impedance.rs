//! How much of a load a contact or limit takes off, by how deep it is: `solimp` (modeling guide, "Impedance").
//!
//! With r the depth over `width`, the impedance d grows from `dmin` to `dmax` as
//!
//! ```text
//! d = dmin + y (dmax − dmin)      y = rᵖ / mᵖ⁻¹                     for r ≤ m
//!                                 y = 1 − (1 − r)ᵖ / (1 − m)ᵖ⁻¹     for r > m
//! ```
//!
//! m being `midpoint` and p `power`. MuJoCo's constraint gives the acceleration
//! a = (1 − d) a₀ − d (d k r + b v) with k = 1 / (dmax T ζ)² and b = 2 / (dmax T); that is the law
//! of [`Softness::Time`](model::Softness::Time) with the time constant T dmax / d. The model has one
//! impedance: that of limits, and without gravity, the one at half the width, which is the mean of both with
//! MuJoCo's standard m; that of contacts the one at which a weight rests, a = v = 0 and so
//!
//! ```text
//! a₀ = d² k r / (1 − d).
//! ```

use crate::error::FormatError;
use crate::xml::Element;

/// What MuJoCo clips impedances and midpoints to (mjMINIMP, mjMAXIMP).
const RANGE: (f64, f64) = (1e-4, 0.9999);

/// `dmin`, `dmax`, `width` [m], `midpoint`, `power`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impedance(pub [f64; 5]);

impl Default for Impedance {
    fn default() -> Self {
        Self([0.9, 0.95, 0.001, 0.5, 2.0])
    }
}

impl Impedance {
    /// The attribute of this name, with MuJoCo's standard for what it leaves out.
    pub fn read(element: &Element, name: &str) -> Result<Self, FormatError> {
        let Self(mut numbers) = Self::default();
        let given = element.list(name, 1, 5)?.unwrap_or_default();
        numbers
            .iter_mut()
            .zip(given)
            .for_each(|(own, new)| *own = new);
        Ok(Self(numbers))
    }

    /// The impedance at half the width, and the one at its end over it.
    pub fn typical(&self) -> (f64, f64) {
        self.at(0.5)
    }

    /// The impedance where something rests that would fall with this acceleration [m/s²], on what comes to rest in
    /// T ζ [s]; and the one at its end over it.
    pub fn under(&self, fall: f64, time: f64) -> (f64, f64) {
        let [_, most, width, ..] = self.0;
        let k = (clip(most) * time).powi(-2);
        let holds = |r: f64| {
            let (d, _) = self.at(r);
            d * d * k * r * width / (1.0 - d) >= fall
        };
        let (mut above, mut below) = (0.0, 1.0);
        while holds(below) && below - above > 1e-9 {
            let middle = 0.5 * (above + below);
            if holds(middle) {
                below = middle;
            } else {
                above = middle;
            }
        }
        self.at(below)
    }

    /// The impedance at a depth r of the width, from 0 to 1, and the one at its end over it.
    fn at(&self, r: f64) -> (f64, f64) {
        let [least, most, _, midpoint, power] = self.0;
        let (least, most, m, p) = (clip(least), clip(most), clip(midpoint), power.max(1.0));
        let y = match r <= m {
            true => r * (r / m).powf(p - 1.0),
            false => 1.0 - (1.0 - r) * ((1.0 - r) / (1.0 - m)).powf(p - 1.0),
        };
        let d = least + y * (most - least);
        (d, most / d)
    }
}

fn clip(x: f64) -> f64 {
    x.clamp(RANGE.0, RANGE.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_way_down_a_standard_contact_has_the_mean() {
        let (d, growth) = Impedance::default().typical();
        assert!((d - 0.925).abs() < 1e-15 && (growth - 0.95 / 0.925).abs() < 1e-15);
        assert_eq!(Impedance([0.8, 0.8, 0.0, 0.2, 3.0]).typical(), (0.8, 1.0));
    }

    /// Where the weight is a = d² k r / (1 − d), with k = 1 / (dmax T ζ)²; at the end where it is heavier.
    #[test]
    fn a_weight_rests_where_it_is_held() {
        let (width, time) = (0.01, 0.02);
        let soft = Impedance([0.0, 0.8, width, 0.5, 2.0]);
        let r: f64 = 0.7;
        let (d, _) = soft.at(r);
        assert!((d - 0.8 * (1.0 - 0.3 * 0.3 / 0.5)).abs() < 1e-4);
        let fall = d * d * r * width / ((1.0 - d) * (0.8f64 * time).powi(2));
        let (found, growth) = soft.under(fall, time);
        assert!((found - d).abs() < 1e-8 && (growth * d - 0.8).abs() < 1e-8);
        assert_eq!(soft.under(1e9, time), (0.8, 1.0));
        assert!((soft.under(0.0, time).0 - soft.at(0.0).0).abs() < 1e-9);
        let even = Impedance([0.6, 0.6, width, 0.5, 2.0]);
        assert_eq!(even.under(9.81, time), (0.6, 1.0));
    }

    /// p = 2: y(½) = ¼ / m, and 1 − ¼ / (1 − m) where the midpoint is passed.
    #[test]
    fn the_midpoint_shifts_it() {
        let at = |m| Impedance([0.0, 0.8, 0.01, m, 2.0]).typical().0;
        assert!((at(0.8) - (1e-4 + 0.3125 * (0.8 - 1e-4))).abs() < 1e-12);
        assert_eq!(Impedance([0.0, 0.8, 0.01, 0.8, 1e9]).typical().0, 1e-4);
        assert!((at(0.2) - (1e-4 + 0.6875 * (0.8 - 1e-4))).abs() < 1e-12);
    }
}
