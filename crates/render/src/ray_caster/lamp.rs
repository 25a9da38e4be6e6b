//! What arrives of a lamp's light, and what may be in its way.

use super::placed::Placed;
use crate::lamp::PlacedLamp;
use glam::{DVec3, Vec3};
use model::LampKind;

/// What arrives of a lamp's light where nothing is in its way.
pub(super) struct Arriving {
    /// Where from: a unit vector, and how far [m].
    pub direction: DVec3,
    pub distance: f64,
    /// On a sheet that faces it.
    pub light: Vec3,
}

impl PlacedLamp<'_> {
    /// What arrives at a point; `None` where that is nothing.
    pub(super) fn at(&self, point: DVec3) -> Option<Arriving> {
        let (direction, distance) = match self.lamp.kind {
            LampKind::Parallel => (-self.along, f64::INFINITY),
            LampKind::Point | LampKind::Spot { .. } => {
                let way = self.position - point;
                (way.try_normalize()?, way.length())
            }
        };
        let share = self.lamp.share(distance, -direction.dot(self.along));
        (share > 0.0).then_some(Arriving {
            direction,
            distance,
            light: share as f32 * self.lamp.color,
        })
    }

    /// Whether a shape may be between it and a point of a box: whether balls about both are within each
    /// other's reach along the way.
    pub(super) fn is_before(&self, shape: &Placed, [low, high]: [DVec3; 2]) -> bool {
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low).length());
        let arm = shape.center - middle;
        let way = match self.lamp.kind {
            LampKind::Parallel => -self.along * (-arm.dot(self.along)).max(0.0),
            LampKind::Point | LampKind::Spot { .. } => {
                let way = self.position - middle;
                way * (arm.dot(way) / way.length_squared().max(1e-300)).clamp(0.0, 1.0)
            }
        };
        shape.radius.is_finite() && (arm - way).length() <= shape.radius + reach
    }
}
