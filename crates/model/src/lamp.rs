//! Lights that a model's author has placed, of which cameras and pages make pictures.

use crate::model::Subject;
use crate::{BodyId, CameraMode, ModelError, Pose};
use glam::{DVec3, Vec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::FRAC_PI_2;

/// Largest exponent of a spot, as in OpenGL.
const MOST_FOCUSED: f64 = 128.0;

/// A light. It shines along the −z axis of its frame, as a camera looks.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Lamp {
    /// Unique in the model.
    pub name: String,
    /// What it is on; `None` is the world.
    pub body: Option<BodyId>,
    /// How it goes along with its body, as cameras do.
    pub mode: CameraMode,
    /// Placement, as its mode says.
    pub pose: Pose,
    /// Where its light goes.
    pub kind: LampKind,
    /// What it adds to a white sheet that faces it, in linear light, before it fades; 1 is as bright as a
    /// white sheet can be drawn.
    pub color: Vec3,
    /// It fades with the distance d [m] as 1 / (a + b d + c d²), for these a, b [1/m] and c [1/m²]: (1, 0, 0)
    /// does not, (0, 0, 1) does as lamps do. Parallel light does not fade, and does not read them.
    pub attenuation: DVec3,
    /// Whether what is behind something else, as it sees it, is in its shadow.
    pub shadows: bool,
}

/// Where the light of a lamp goes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum LampKind {
    /// Everywhere in one direction, as a sun's.
    Parallel,
    /// From a point in all directions.
    Point,
    /// From a point, less far from the axis: as cosᵉ of the angle to it, up to a largest one.
    Spot {
        /// The largest angle to the axis [rad], above 0 and at most π/2.
        cutoff: f64,
        /// The exponent e, 0 to 128.
        exponent: f64,
    },
}

impl Lamp {
    /// White light that does not fade, with shadows, from the world's origin along −z.
    pub fn new(name: impl Into<String>, kind: LampKind) -> Self {
        Self {
            name: name.into(),
            body: None,
            mode: CameraMode::Fixed,
            pose: Pose::IDENTITY,
            kind,
            color: Vec3::ONE,
            attenuation: DVec3::X,
            shadows: true,
        }
    }

    /// The sun, if one of these is it: the first that is parallel and of the world.
    pub fn sun(lamps: &[Self]) -> Option<usize> {
        let is_sun = |lamp: &Self| lamp.kind == LampKind::Parallel && lamp.body.is_none();
        lamps.iter().position(is_sun)
    }

    /// Whether it can be in a model of so many bodies.
    ///
    /// # Errors
    /// A number is out of its range, or there is no such body.
    pub fn check(&self, bodies: usize) -> Result<(), ModelError> {
        let subject = Subject {
            kind: "lamp",
            name: &self.name,
        };
        if let Some(body) = self.body {
            subject.row("body", body.0, bodies)?;
        }
        subject.pose("pose", &self.pose)?;
        let mut colors = self.color.to_array().into_iter().map(f64::from);
        colors.try_for_each(|part| subject.not_negative("colour", part))?;
        let mut factors = self.attenuation.to_array().into_iter();
        factors.try_for_each(|factor| subject.not_negative("attenuation", factor))?;
        subject.positive("sum of its attenuation", self.attenuation.element_sum())?;
        if let LampKind::Spot { cutoff, exponent } = self.kind {
            subject.positive("cutoff [rad]", cutoff)?;
            subject.within("cutoff [rad]", cutoff, 0.0, FRAC_PI_2)?;
            subject.within("exponent", exponent, 0.0, MOST_FOCUSED)?;
        }
        Ok(())
    }

    /// Where it is in a world whose bodies are placed so.
    ///
    /// # Panics
    /// If its body has no pose.
    pub fn placed(&self, bodies: &[Pose]) -> Pose {
        self.mode.placed_on(self.body, bodies, &self.pose)
    }

    /// What of its light goes to a distance [m] at an angle of this cosine to the axis.
    pub fn share(&self, distance: f64, cosine: f64) -> f64 {
        let spread = match self.kind {
            LampKind::Parallel => return 1.0,
            LampKind::Point => 1.0,
            LampKind::Spot { cutoff, .. } if cosine < cutoff.cos() => 0.0,
            LampKind::Spot { exponent, .. } => cosine.max(0.0).powf(exponent),
        };
        spread
            / self
                .attenuation
                .dot(DVec3::new(1.0, distance, distance * distance))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 / (1 + 2·3 + 3·9) of cos²(60°) = ¼ at 3 m; nothing beyond the cutoff.
    #[test]
    fn light_fades_with_distance_and_angle() {
        let (cutoff, exponent) = (1.1, 2.0);
        let lamp = Lamp {
            attenuation: DVec3::new(1.0, 2.0, 3.0),
            ..Lamp::new("spot", LampKind::Spot { cutoff, exponent })
        };
        assert!((lamp.share(3.0, 0.5) - 0.25 / 34.0).abs() < 1e-15);
        assert_eq!(lamp.share(3.0, 1.2_f64.cos()), 0.0);
        assert_eq!(Lamp::new("sun", LampKind::Parallel).share(1e9, -1.0), 1.0);
    }
}
