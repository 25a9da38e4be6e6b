//! What is asked of each engine.

use glam::DVec3;
use kinetarium::prelude::*;
use std::error::Error;

pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Time step [s].
pub const TIME_STEP: f64 = 0.004;

/// Name of what is compared with the others.
pub const OURS: &str = "Kinetarium";

/// One world of a model in an engine.
pub trait Engine {
    fn name(&self) -> &'static str;
    /// Advances the world by as many time steps.
    fn step(&mut self, steps: usize);
    /// Where a body's frame is [m].
    fn position(&mut self, body: BodyId) -> DVec3;
    /// How many points of contact press now, where the engine tells.
    fn points(&mut self) -> Option<usize>;
    /// Refuses to go on when the world was lost, so that its figures mean nothing.
    fn check(&self) -> Outcome<()>;
}
