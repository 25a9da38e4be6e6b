//! The force law of an actuator, from its defaults and its shortcut (XML reference, "actuator/general",
//! "motor", "position", "velocity").
//!
//! Every shortcut sets the attributes of a `general` actuator, in the defaults as well as at the
//! element, so the law is found by going through them in turn.

use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// force = gain · u + bias₀ + bias₁ · length + bias₂ · velocity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Servo {
    pub gain: f64,
    pub bias: [f64; 3],
    /// Damping of a position servo as a ratio of the critical one, instead of bias₂.
    pub damping_ratio: Option<f64>,
    dynamics: String,
    gain_type: String,
    /// Terms of an affine gain in length and velocity.
    gain_slopes: [f64; 2],
    bias_type: String,
}

impl Default for Servo {
    fn default() -> Self {
        Self {
            gain: 1.0,
            bias: [0.0; 3],
            damping_ratio: None,
            dynamics: "none".into(),
            gain_type: "fixed".into(),
            gain_slopes: [0.0; 2],
            bias_type: "none".into(),
        }
    }
}

impl Servo {
    /// The law after one more level of attributes.
    pub fn with(mut self, level: &Element) -> Result<Self, FormatError> {
        match level.name.as_str() {
            "general" => self.general(level)?,
            "motor" => self = Self::default(),
            "position" => self.position(level)?,
            "velocity" => {
                let kv = level.non_negative("kv")?.unwrap_or(self.gain);
                self = Self {
                    gain: kv,
                    bias: [0.0, 0.0, -kv],
                    ..Self::default()
                };
                self.bias_type = "affine".into();
            }
            _ => {}
        }
        Ok(self)
    }

    fn general(&mut self, level: &Element) -> Result<(), FormatError> {
        for (target, name) in [
            (&mut self.dynamics, "dyntype"),
            (&mut self.gain_type, "gaintype"),
            (&mut self.bias_type, "biastype"),
        ] {
            if let Some(word) = level.get(name) {
                *target = word.to_owned();
            }
        }
        if let Some(numbers) = level.list("gainprm", 1, 10)? {
            self.gain = numbers[0];
            numbers[1..]
                .iter()
                .zip(&mut self.gain_slopes)
                .for_each(|(new, old)| *old = *new);
        }
        if let Some(numbers) = level.list("biasprm", 1, 10)? {
            numbers
                .iter()
                .zip(&mut self.bias)
                .for_each(|(new, old)| *old = *new);
            self.damping_ratio = None;
        }
        Ok(())
    }

    fn position(&mut self, level: &Element) -> Result<(), FormatError> {
        let kp = level.non_negative("kp")?.unwrap_or(self.gain);
        (self.gain, self.bias[0], self.bias[1]) = (kp, 0.0, -kp);
        (self.gain_type, self.gain_slopes) = ("fixed".into(), [0.0; 2]);
        self.bias_type = "affine".into();
        match (level.non_negative("kv")?, level.non_negative("dampratio")?) {
            (Some(_), Some(_)) => {
                let remedy = "keep one of them";
                return Err(level.invalid_attribute("dampratio", "stands beside `kv`", remedy));
            }
            (Some(kv), None) => (self.bias[2], self.damping_ratio) = (-kv, None),
            (None, Some(ratio)) => self.damping_ratio = Some(ratio),
            (None, None) => {}
        }
        if let Some(time) = level.non_negative("timeconst")? {
            self.dynamics = if time > 0.0 { "filterexact" } else { "none" }.into();
        }
        Ok(())
    }

    /// Refuses what the law of force cannot hold; lenient, reduces it to what it can.
    pub fn checked(mut self, element: &Element, report: &mut Report) -> Result<Self, FormatError> {
        if self.dynamics != "none" {
            let feature = format!("activation dynamics `{}`", self.dynamics);
            report.refuse(element, &feature, "set dyntype to none, or timeconst to 0")?;
        }
        let affine = self.gain_type == "affine" && self.gain_slopes == [0.0; 2];
        if self.gain_type != "fixed" && !affine {
            let feature = format!("gaintype `{}`", self.gain_type);
            report.refuse(element, &feature, "use gaintype fixed")?;
        }
        match self.bias_type.as_str() {
            "affine" => {}
            "none" => self.bias = [0.0; 3],
            other => {
                let feature = format!("biastype `{other}`");
                report.refuse(element, &feature, "use biastype none or affine")?;
                self.bias = [0.0; 3];
            }
        }
        Ok(self)
    }
}
