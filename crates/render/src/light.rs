//! What lights a scene, and what is behind everything.

use crate::error::{RenderError, require};
use glam::{DVec3, Vec3};
use model::Lamp;
#[cfg(feature = "gpu")]
use {glam::DQuat, model::LampKind};

/// A sun, a sky and lamps. Colours are linear, not sRGB; 1 is as bright as a white sheet can be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Direction to the sun, world axes; of any length but zero.
    pub to_sun: DVec3,
    /// What the sun adds to a white sheet that faces it; 0 is no sun.
    pub sun: Vec3,
    /// Whether what is behind something else, as the sun sees it, is in its shadow.
    pub shadows: bool,
    /// Angle [rad] from the middle of the sun to its edge, which makes the edges of shadows soft where
    /// there are several samples a pixel; 0 to ½.
    pub sun_radius: f64,
    /// What the sky adds to a white sheet that faces up.
    pub sky: Vec3,
    /// What the ground adds to a white sheet that faces down.
    pub ground: Vec3,
    /// Colour straight above, where nothing is.
    pub zenith: Vec3,
    /// Colour of the horizon, and where endless planes end.
    pub horizon: Vec3,
    /// Other lights, in the world or on bodies. A solid that holds one lets its light out.
    pub lamps: Vec<Lamp>,
}

impl Light {
    /// A sunny day: the sun to the right, in front of what is seen along −z (Y up) or along y (Z up).
    pub fn day(up: DVec3) -> Self {
        let (right, front) = axes(up);
        Self {
            to_sun: (0.45 * right + 0.5 * front + 1.0 * up).normalize(),
            sun: Vec3::new(0.72, 0.68, 0.62),
            shadows: true,
            sun_radius: 0.03,
            sky: Vec3::new(0.36, 0.40, 0.46),
            ground: Vec3::new(0.20, 0.19, 0.18),
            zenith: Vec3::new(0.20, 0.38, 0.66),
            horizon: Vec3::new(0.76, 0.84, 0.92),
            lamps: Vec::new(),
        }
    }

    /// The sky of a sunny day, and a model's lamps, of which one may be [the sun](Lamp::sun): without it there is
    /// none. Where there are no lamps, a sunny day.
    pub fn of(up: DVec3, lamps: &[Lamp]) -> Self {
        let mut light = Self::day(up);
        if lamps.is_empty() {
            return light;
        }
        light.sun = Vec3::ZERO;
        light.lamps = lamps.to_vec();
        if let Some(row) = Lamp::sun(lamps) {
            let lamp = light.lamps.remove(row);
            light.to_sun = lamp.pose.direction(DVec3::Z);
            (light.sun, light.shadows) = (lamp.color, lamp.shadows);
        }
        light
    }

    /// Whether it can be in a scene of so many bodies.
    pub(crate) fn check(&self, bodies: usize) -> Result<(), RenderError> {
        self.lamps.iter().try_for_each(|lamp| lamp.check(bodies))?;
        let length = self.to_sun.length();
        let (what, must) = ("the direction to the sun", "finite and not zero");
        require(length > 0.0 && length.is_finite(), what, self.to_sun, must)?;
        let (what, must) = ("the sun's radius", "from 0 to 0.5, in radians");
        require(
            (0.0..=0.5).contains(&self.sun_radius),
            what,
            self.sun_radius,
            must,
        )?;
        let colors = [self.sun, self.sky, self.ground, self.zenith, self.horizon];
        let wrong = colors
            .into_iter()
            .find(|c| !(c.is_finite() && c.min_element() >= 0.0));
        let (what, must) = ("a colour of the light", "finite, and nowhere below 0");
        wrong.map_or(Ok(()), |color| require(false, what, color, must))
    }

    /// Sun and lamps, as lamps; but for what is black.
    #[cfg(feature = "gpu")]
    pub(crate) fn all(&self) -> Vec<Lamp> {
        let mut sun = Lamp::new("sun", LampKind::Parallel);
        sun.pose.orientation = DQuat::from_rotation_arc(DVec3::Z, self.to_sun.normalize());
        (sun.color, sun.shadows) = (self.sun, self.shadows);
        let mut all = vec![sun];
        all.extend_from_slice(&self.lamps);
        all.retain(|lamp| lamp.color != Vec3::ZERO);
        all
    }

    /// What is seen along a unit vector that meets nothing; `up` is a unit vector too.
    pub(crate) fn background(&self, direction: DVec3, up: DVec3) -> Vec3 {
        let height = direction.dot(up).max(0.0) as f32;
        // Bluer quickly above the horizon, slowly higher up.
        self.horizon.lerp(self.zenith, 1.0 - (1.0 - height).powi(3))
    }
    /// What sky and ground add to a white sheet that faces a unit vector.
    pub(crate) fn ambient(&self, normal: DVec3, up: DVec3) -> Vec3 {
        self.ground
            .lerp(self.sky, (0.5 + 0.5 * normal.dot(up)) as f32)
    }
}

/// What is to the right and in front of someone who stands upright and looks along −z (Y up) or along
/// y (Z up).
pub(crate) fn axes(up: DVec3) -> (DVec3, DVec3) {
    (DVec3::X, DVec3::X.cross(up))
}
