//! Small checks, each of which names the culprit when it fails.

use crate::{ModelError, Pose};
use glam::DVec3;
use std::collections::HashSet;

/// Lengths of unit vectors and quaternions may differ from 1 by this much.
const UNIT_TOLERANCE: f64 = 1e-6;

/// The thing that is being checked: its kind and name.
#[derive(Clone, Copy)]
pub(crate) struct Subject<'a> {
    pub kind: &'static str,
    pub name: &'a str,
}

impl Subject<'_> {
    /// As errors show it: `joint "hinge"`.
    pub fn what(&self) -> String {
        if self.name.is_empty() {
            self.kind.into()
        } else {
            format!("{} \"{}\"", self.kind, self.name)
        }
    }

    pub fn finite(&self, quantity: &'static str, value: f64) -> Result<(), ModelError> {
        if value.is_finite() {
            return Ok(());
        }
        Err(ModelError::NotFinite {
            what: self.what(),
            quantity,
            value,
        })
    }

    pub fn all_finite(&self, quantity: &'static str, values: &[f64]) -> Result<(), ModelError> {
        values.iter().try_for_each(|&v| self.finite(quantity, v))
    }

    pub fn not_negative(&self, quantity: &'static str, value: f64) -> Result<(), ModelError> {
        self.finite(quantity, value)?;
        if value >= 0.0 {
            return Ok(());
        }
        Err(ModelError::Negative {
            what: self.what(),
            quantity,
            value,
        })
    }

    pub fn positive(&self, quantity: &'static str, value: f64) -> Result<(), ModelError> {
        self.finite(quantity, value)?;
        if value > 0.0 {
            return Ok(());
        }
        Err(ModelError::NotPositive {
            what: self.what(),
            quantity,
            value,
        })
    }

    pub fn within(
        &self,
        quantity: &'static str,
        value: f64,
        lower: f64,
        upper: f64,
    ) -> Result<(), ModelError> {
        self.finite(quantity, value)?;
        if (lower..=upper).contains(&value) {
            return Ok(());
        }
        Err(ModelError::OutsideRange {
            what: self.what(),
            quantity,
            value,
            lower,
            upper,
        })
    }

    pub fn range(
        &self,
        quantity: &'static str,
        (lower, upper): (f64, f64),
    ) -> Result<(), ModelError> {
        self.all_finite(quantity, &[lower, upper])?;
        if lower <= upper {
            return Ok(());
        }
        Err(ModelError::RangeReversed {
            what: self.what(),
            quantity,
            lower,
            upper,
        })
    }

    pub fn unit(&self, quantity: &'static str, vector: DVec3) -> Result<(), ModelError> {
        self.all_finite(quantity, &vector.to_array())?;
        self.unit_length(
            vector.length(),
            || quantity.into(),
            "give one, such as (0, 1, 0)",
        )
    }

    /// A quaternion x, y, z, w.
    pub fn rotation(&self, quantity: &'static str, q: &[f64]) -> Result<(), ModelError> {
        self.all_finite(quantity, q)?;
        let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
        let remedy = "give one; no rotation is (0, 0, 0, 1)";
        self.unit_length(length, || format!("quaternion of its {quantity}"), remedy)
    }

    fn unit_length(
        &self,
        length: f64,
        quantity: impl Fn() -> String,
        remedy: &'static str,
    ) -> Result<(), ModelError> {
        if (length - 1.0).abs() <= UNIT_TOLERANCE {
            return Ok(());
        }
        let (what, quantity) = (self.what(), quantity());
        Err(if length > 0.0 {
            ModelError::NotUnit {
                what,
                quantity,
                length,
            }
        } else {
            ModelError::ZeroLength {
                what,
                quantity,
                remedy,
            }
        })
    }

    pub fn pose(&self, quantity: &'static str, pose: &Pose) -> Result<(), ModelError> {
        self.all_finite(quantity, &pose.position.to_array())?;
        self.rotation(quantity, &pose.orientation.to_array())
    }

    pub fn all_positive(&self, quantity: &'static str, sizes: DVec3) -> Result<(), ModelError> {
        sizes
            .to_array()
            .into_iter()
            .try_for_each(|s| self.positive(quantity, s))
    }

    pub fn length(
        &self,
        quantity: &'static str,
        count: usize,
        needed: usize,
        why: &'static str,
    ) -> Result<(), ModelError> {
        if count == needed {
            return Ok(());
        }
        Err(ModelError::WrongLength {
            what: self.what(),
            quantity,
            count,
            needed,
            why,
        })
    }

    pub fn row(&self, role: &'static str, index: usize, count: usize) -> Result<(), ModelError> {
        if index < count {
            return Ok(());
        }
        Err(ModelError::NoSuchRow {
            what: self.what(),
            role,
            index,
            count,
        })
    }
}

/// Every name is there, and there once.
pub(crate) fn names<'a>(
    kind: &'static str,
    names: impl Iterator<Item = &'a str>,
) -> Result<(), ModelError> {
    let mut seen = HashSet::new();
    for (index, name) in names.enumerate() {
        if name.is_empty() {
            return Err(ModelError::EmptyName { kind, index });
        }
        if !seen.insert(name) {
            return Err(ModelError::DuplicateName {
                kind,
                name: name.into(),
            });
        }
    }
    Ok(())
}
