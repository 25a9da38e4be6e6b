//! Random controls of actuators.

use crate::sliders::control_range;
use fastrand::Rng;
use numbers::Float;
use sim::{Simulation, SimulationError};

/// From one random control to the next [s].
const EVERY: f64 = 0.1;

/// Random controls of all actuators: the same ones again from its making on.
#[derive(Debug)]
pub(crate) struct Wander {
    /// As a share of the controls' ranges; 0: none.
    size: f64,
    rng: Rng,
}

impl Wander {
    pub fn new(size: f64) -> Self {
        Self {
            size,
            rng: Rng::with_seed(1),
        }
    }
    /// New controls of all actuators in all worlds, but of those that are set, if it is time after so many steps
    /// since the start. Steps until it is time again.
    pub fn steer<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        steps: u64,
        set: &[Option<f64>],
    ) -> Result<u64, SimulationError> {
        if self.size == 0.0 {
            return Ok(u64::MAX);
        }
        let every = EVERY / simulation.settings().step.time_step;
        let every = every.round().max(1.0) as u64;
        if steps.is_multiple_of(every) {
            self.draw(simulation, set)?;
        }
        Ok(every - steps % every)
    }

    fn draw<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        set: &[Option<f64>],
    ) -> Result<(), SimulationError> {
        let model = simulation.model().clone();
        for world in 0..simulation.worlds() {
            let control = |(actuator, set): (&model::Actuator, &Option<f64>)| {
                let (lower, upper) = control_range(&model, actuator);
                let (middle, half) = (0.5 * (lower + upper), 0.5 * (upper - lower));
                let drawn = middle + self.size * half * (2.0 * self.rng.f64() - 1.0);
                set.unwrap_or(drawn)
            };
            let controls = model.actuators.iter().zip(set);
            let control: Vec<f64> = controls.map(control).collect();
            simulation.controls().set_control(world, &control)?;
        }
        Ok(())
    }
}
