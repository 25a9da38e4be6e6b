//! The force law of an actuator, from its defaults and its shortcut (XML reference, "actuator/general",
//! "motor", "position", "velocity").
//!
//! Every shortcut sets the attributes of a `general` actuator, in the defaults as well as at the element, so the law
//! is found by going through them in turn. A shortcut starts from the law of the innermost class that another of
//! its kind made, or a `general` one that changes it; and else from a motor's.

use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// force = gain · u + bias₀ + bias₁ · length + bias₂ · velocity.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Servo {
    pub gain: f64,
    /// As MuJoCo has them: a positive bias₂ of a servo of position is the ratio of its damping to the critical one.
    pub bias: [f64; 3],
    /// `ctrlrange`; 0 0 is none.
    pub range: [f64; 2],
    /// `inheritrange`: the joint's range times this; 0 is none of it.
    pub inherited: f64,
    /// The element that made it.
    kind: String,
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
            range: [0.0; 2],
            inherited: 0.0,
            kind: "general".into(),
            dynamics: "none".into(),
            gain_type: "fixed".into(),
            gain_slopes: [0.0; 2],
            bias_type: "none".into(),
        }
    }
}

impl Servo {
    /// The law of an element behind the settings of its classes, the outermost first.
    pub fn of(element: &Element, classes: &[Vec<&Element>]) -> Result<Self, FormatError> {
        let mut outer = vec![Self::default()];
        for class in classes {
            let last = outer[outer.len() - 1].clone();
            let mut settings = class.iter().copied();
            let law = settings.try_fold(last, |law, level| law.with(level, &outer))?;
            outer.push(law);
        }
        let last = outer[outer.len() - 1].clone();
        last.with(element, &outer)
    }

    /// The law after one more level of attributes, in a class that `outer` ones are around.
    fn with(self, level: &Element, outer: &[Self]) -> Result<Self, FormatError> {
        let kind = level.name.as_str();
        let range = level.numbers::<2>("ctrlrange")?.unwrap_or(self.range);
        let mut law = match kind {
            "general" => self,
            "position" | "velocity" => {
                let mut laws = std::iter::once(&self).chain(outer.iter().rev());
                let base = laws.find(|law| law.is_base_of(kind));
                base.cloned().unwrap_or_default()
            }
            _ => Self::default(),
        };
        law.range = range;
        law.kind = kind.into();
        match kind {
            "general" => law.general(level)?,
            "motor" => {}
            "position" => law.position(level)?,
            "velocity" => law = law.velocity(level)?,
            other => (law.gain_type, law.dynamics) = (other.into(), other.into()),
        }
        Ok(law)
    }

    fn is_base_of(&self, kind: &str) -> bool {
        [kind, "general"].contains(&self.kind.as_str()) && self.gain_type == "fixed"
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
            let slopes = self.gain_slopes.iter_mut();
            slopes.zip(&numbers[1..]).for_each(|(old, new)| *old = *new);
        }
        let bias = level.list("biasprm", 1, 10)?.unwrap_or_default();
        self.bias
            .iter_mut()
            .zip(bias)
            .for_each(|(old, new)| *old = new);
        self.inherited = level
            .non_negative("inheritrange")?
            .unwrap_or(self.inherited);
        Ok(())
    }

    fn position(&mut self, level: &Element) -> Result<(), FormatError> {
        let kp = level.non_negative("kp")?.unwrap_or(self.gain);
        (self.gain, self.bias[0], self.bias[1]) = (kp, 0.0, -kp);
        self.gain_slopes = [0.0; 2];
        self.bias_type = "affine".into();
        match (level.non_negative("kv")?, level.non_negative("dampratio")?) {
            (Some(_), Some(_)) => {
                let remedy = "keep one of them";
                return Err(level.invalid_attribute("dampratio", "stands beside `kv`", remedy));
            }
            (Some(kv), None) => self.bias[2] = -kv,
            (None, Some(ratio)) => self.bias[2] = ratio,
            (None, None) => {}
        }
        let filtered = match level.non_negative("timeconst")? {
            Some(time) => time > 0.0,
            None => self.dynamics == "filterexact",
        };
        self.dynamics = if filtered { "filterexact" } else { "none" }.into();
        self.inherit_range(level)
    }

    /// Where it has one of `ctrlrange` and `inheritrange`, this takes the place of an inherited other one.
    fn inherit_range(&mut self, level: &Element) -> Result<(), FormatError> {
        match (level.has("ctrlrange"), level.non_negative("inheritrange")?) {
            (true, None) => self.inherited = 0.0,
            (own, Some(share)) => {
                self.inherited = share;
                if !own && share > 0.0 {
                    self.range = [0.0; 2];
                }
            }
            (false, None) => {}
        }
        if self.inherited > 0.0 && self.range != [0.0; 2] {
            let problem = "stands beside `ctrlrange`";
            return Err(level.invalid_attribute("inheritrange", problem, "keep one of them"));
        }
        Ok(())
    }

    fn velocity(self, level: &Element) -> Result<Self, FormatError> {
        let kv = level.non_negative("kv")?.unwrap_or(self.gain);
        Ok(Self {
            gain: kv,
            bias: [0.0, 0.0, -kv],
            bias_type: "affine".into(),
            range: self.range,
            kind: self.kind,
            ..Self::default()
        })
    }

    /// Whether it is a servo of position.
    pub fn holds_position(&self) -> bool {
        self.gain_type == "fixed" && self.gain == -self.bias[1]
    }

    /// Damping of a servo of position as a ratio of the critical one, instead of bias₂.
    pub fn damping_ratio(&self) -> Option<f64> {
        let ratio = Some(self.bias[2]).filter(|ratio| *ratio > 0.0);
        ratio.filter(|_| self.bias_type == "affine" && self.holds_position())
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
