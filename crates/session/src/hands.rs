//! What users' hands do to a simulation while it is stepped.

use crate::card::Card;
use crate::error::{SessionError, count};
use crate::pull::{Grab, Push, add_force};
use numbers::Float;
use sim::{Diverged, Simulation, SimulationError};

/// Blows that wait for the next step, at most.
const MOST_PUSHES: usize = 256;

/// The hand that draws a body, and the blows that wait for the next step.
#[derive(Clone, Debug, Default)]
pub(crate) struct Hands {
    pub grab: Option<Grab>,
    pushes: Vec<Push>,
}

impl Hands {
    /// Whether nothing is drawn or pushed.
    pub fn rest(&self) -> bool {
        self.grab.is_none() && self.pushes.is_empty()
    }
    /// A blow in the next step.
    pub fn push(&mut self, push: Push) -> Result<(), SessionError> {
        count("pushes that wait", self.pushes.len() + 1, [0, MOST_PUSHES])?;
        self.pushes.push(push);
        Ok(())
    }
    /// Forgets the blows that wait.
    pub fn forget(&mut self) {
        self.pushes.clear();
    }

    /// Steps with them. Forces that were set stay, and those of hands are added while they act.
    pub fn step<T: Float>(
        &mut self,
        simulation: &mut Simulation<T>,
        steps: usize,
    ) -> Result<(), SimulationError> {
        for done in 0..steps {
            if self.rest() {
                simulation.try_step(steps - done)?;
                return Ok(());
            }
            let before = self.forces(simulation)?;
            for (world, forces) in &before {
                let pulled = self.pulled(simulation, *world, forces)?;
                set(simulation, *world, &pulled);
            }
            self.pushes.clear();
            simulation.try_step(1)?;
            for (world, forces) in &before {
                set(simulation, *world, forces);
            }
        }
        Ok(())
    }

    /// The forces that are set on degrees of freedom, in each world where a hand or a blow acts.
    fn forces<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
    ) -> Result<Vec<(usize, Vec<f64>)>, SimulationError> {
        let mut worlds: Vec<_> = self.pushes.iter().map(|p| p.world).collect();
        worlds.extend(self.grab.map(|g| g.world));
        worlds.sort_unstable();
        worlds.dedup();
        simulation.fetch_controls()?;
        let dofs = simulation.model().degrees_of_freedom();
        let forces = |world| {
            let mut numbers = simulation.controls().of_world(world).ok()?;
            numbers.truncate(dofs);
            Some((world, numbers))
        };
        Ok(worlds.into_iter().filter_map(forces).collect())
    }

    /// Forces that are set, and those of hand and blows.
    fn pulled<T: Float>(
        &self,
        simulation: &mut Simulation<T>,
        world: usize,
        set: &[f64],
    ) -> Result<Vec<f64>, SimulationError> {
        let model = simulation.model().clone();
        let h = simulation.settings().step.time_step;
        let outputs = simulation.try_outputs()?;
        let mut forces = set.to_vec();
        let mut add = |body, point, force| {
            add_force(&model, &outputs, (world, body, point), force, &mut forces);
        };
        if let Some(g) = self.grab.filter(|g| g.world == world) {
            add(g.body, g.point, g.force(&model, &outputs, h));
        }
        for p in self.pushes.iter().filter(|p| p.world == world) {
            add(p.body, p.point, p.impulse / h);
        }
        Ok(forces)
    }
}

/// Sets forces; those beyond all bounds are refused, and do not act.
fn set<T: Float>(simulation: &mut Simulation<T>, world: usize, forces: &[f64]) {
    let _ = simulation.controls().set_force(world, forces);
}

/// A simulation, the hands on it, and the card that may run it.
pub(crate) struct Subject<T: Float> {
    pub simulation: Simulation<T>,
    pub hands: Hands,
    pub card: Card<T>,
}

impl<T: Float> Subject<T> {
    pub fn new(simulation: Simulation<T>) -> Self {
        Self {
            simulation,
            hands: Hands::default(),
            card: Card::default(),
        }
    }
    /// Steps under the hands; returns the worlds that diverged meanwhile.
    pub fn step(&mut self, steps: usize) -> Result<&[Diverged], SimulationError> {
        let known = self.simulation.diverged().len();
        self.hands.step(&mut self.simulation, steps)?;
        Ok(&self.simulation.diverged()[known..])
    }
}
