//! A lamp of a scene in a world.

use glam::DVec3;
use model::{Lamp, Pose};

/// A lamp where it is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLamp<'a> {
    pub lamp: &'a Lamp,
    /// In the world [m].
    pub position: DVec3,
    /// Where it shines, a unit vector.
    pub along: DVec3,
}

impl<'a> PlacedLamp<'a> {
    pub fn new(lamp: &'a Lamp, bodies: &[Pose]) -> Self {
        let pose = lamp.placed(bodies);
        Self {
            lamp,
            position: pose.position,
            along: pose.direction(DVec3::NEG_Z).normalize(),
        }
    }
}
