//! Which shapes a query is about.

use super::scene::Scene;
use crate::SimulationError;
use crate::error::index;
use model::{BodyId, Shape};

/// Which shapes a query sees: by default all but sensors, also those that take part in no contacts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Those of one of these kinds only, a bit each, as in [`Shape::membership`]; of any where `None`.
    pub membership: Option<u32>,
    /// Those that take part in contacts only.
    pub colliding: bool,
    /// Sensors, too.
    pub sensors: bool,
    /// None of these bodies.
    pub except: Vec<BodyId>,
}

impl Seen {
    pub(super) fn sees(&self, shape: &Shape) -> bool {
        (self.sensors || !shape.sensor)
            && (shape.collides || !self.colliding)
            && self.membership.is_none_or(|m| m & shape.membership != 0)
            && shape.body.is_none_or(|body| !self.except.contains(&body))
    }

    /// Refuses bodies that do not exist.
    pub(super) fn check(&self, bodies: usize) -> Result<(), SimulationError> {
        let mut except = self.except.iter();
        except.try_for_each(|body| index("body", body.0, bodies))
    }

    /// Refuses what is seen and cannot be read.
    pub(super) fn can_see(&self, what: &'static str, scene: &Scene) -> Result<(), SimulationError> {
        let mut unread = scene.unread.iter();
        match unread.find(|(shape, _)| self.sees(scene.shape(*shape))) {
            Some((shape, reason)) => Err(SimulationError::NotRead {
                what,
                shape: shape.0,
                name: scene.shape(*shape).name.clone(),
                reason: reason.clone(),
            }),
            None => Ok(()),
        }
    }
}
