//! Kinetarium's side.

use crate::engine::{Engine, OURS, Outcome, TIME_STEP};
use glam::DVec3;
use kinetarium::prelude::*;

/// The solver that is measured: that for piles.
const SOLVER: SolverKind = SolverKind::Impulse;

/// One world of the model.
pub fn ours(model: &Model, threads: usize) -> Outcome<Simulation<f32>> {
    let mut settings = SimulationSettings {
        solver: SOLVER,
        threads,
        ..SimulationSettings::new(1, TIME_STEP)
    };
    settings.step.sleep_speed = 0.0;
    Ok(Simulation::new(model.clone(), settings)?)
}

impl Engine for Simulation<f32> {
    fn name(&self) -> &'static str {
        OURS
    }
    fn step(&mut self, steps: usize) {
        Simulation::step(self, steps);
    }
    fn position(&mut self, body: BodyId) -> DVec3 {
        self.outputs().body_position(0, body)
    }
    fn points(&mut self) -> Option<usize> {
        let outputs = self.outputs();
        let presses = |contact: &Contact| contact.force != DVec3::ZERO;
        Some(outputs.contacts(0).filter(presses).count())
    }
    fn check(&self) -> Outcome<()> {
        match self.diverged().first() {
            Some(lost) => Err(format!("Kinetarium's world diverged at {} s", lost.time).into()),
            None => Ok(()),
        }
    }
}
