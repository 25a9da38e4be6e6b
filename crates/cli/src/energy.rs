//! How well energy is conserved over a run.

use kinetarium::model::{CollisionFilter, Dof, Model};
use kinetarium::numbers::Float;
use kinetarium::sim::{Diverged, Outputs, Simulation};
use std::fmt;

/// Energies of all worlds as a run goes on.
#[derive(Debug)]
pub struct Audit {
    initial: Vec<f64>,
    last: Vec<f64>,
    largest_kinetic: Vec<f64>,
}

impl Audit {
    /// Starts with the worlds as they are.
    pub fn new<T: Float>(outputs: &Outputs<'_, T>) -> Self {
        let initial: Vec<f64> = (0..outputs.worlds()).map(|w| outputs.energy(w)).collect();
        let mut audit = Self {
            last: initial.clone(),
            largest_kinetic: vec![0.0; initial.len()],
            initial,
        };
        audit.update(outputs);
        audit
    }

    /// Notes the worlds as they are.
    pub fn update<T: Float>(&mut self, outputs: &Outputs<'_, T>) {
        for world in 0..outputs.worlds() {
            self.last[world] = outputs.energy(world);
            let largest = &mut self.largest_kinetic[world];
            *largest = largest.max(outputs.kinetic_energy(world));
        }
    }

    /// Drift of the worlds that did not diverge; nothing if all did.
    pub fn drift(&self, diverged: &[Diverged]) -> Option<Drift> {
        let mut lost = vec![false; self.initial.len()];
        diverged.iter().for_each(|d| lost[d.world] = true);
        let fine: Vec<usize> = (0..lost.len()).filter(|&w| !lost[w]).collect();
        let drift = |w: usize| (self.last[w] - self.initial[w]).abs();
        let largest = fine
            .iter()
            .copied()
            .max_by(|&a, &b| drift(a).total_cmp(&drift(b)))?;
        let mean = fine.iter().map(|&w| drift(w)).sum::<f64>() / fine.len() as f64;
        let kinetic =
            fine.iter().map(|&w| self.largest_kinetic[w]).sum::<f64>() / fine.len() as f64;
        let change = |w: usize| self.last[w] - self.initial[w];
        Some(Drift {
            mean,
            change: fine.iter().map(|&w| change(w)).sum::<f64>() / fine.len() as f64,
            largest: drift(largest),
            world: largest,
            kinetic,
        })
    }
}

/// Difference of total energy from start to end, over the worlds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drift {
    /// Mean of the absolute values [J].
    pub mean: f64,
    /// Mean with its sign [J].
    pub change: f64,
    /// Largest absolute value [J].
    pub largest: f64,
    /// The world of the largest.
    pub world: usize,
    /// Largest kinetic energy during the run [J], mean of the worlds.
    pub kinetic: f64,
}

impl fmt::Display for Drift {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            mean,
            largest,
            world,
            kinetic,
            ..
        } = self;
        write!(
            f,
            "{mean:.2e} J mean, {largest:.2e} J largest (world {world})"
        )?;
        if *kinetic > 0.0 {
            write!(
                f,
                "; mean is {:.2e} of the largest kinetic energy",
                mean / kinetic
            )?;
        }
        Ok(())
    }
}

/// What changes a simulation's energy by its laws, in words; nothing where energy should stay.
pub fn exchange<T: Float>(simulation: &Simulation<T>) -> Option<String> {
    let model = simulation.model();
    let dof = |acts: fn(&Dof) -> bool| model.joints.iter().any(|j| j.dofs.iter().any(acts));
    let causes = [
        (
            "contacts",
            simulation.settings().contacts && may_touch(model),
        ),
        ("damping", dof(|d| d.damping > 0.0)),
        ("friction of joints", dof(|d| d.friction_loss > 0.0)),
        ("limits", dof(|d| d.limit.is_some())),
        ("drives", dof(|d| d.drive != Default::default())),
        ("actuators", !model.actuators.is_empty()),
    ];
    let causes: Vec<_> = causes.iter().filter(|c| c.1).map(|c| c.0).collect();
    (!causes.is_empty()).then(|| causes.join(", "))
}

fn may_touch(model: &Model) -> bool {
    CollisionFilter::new(model).pairs().next().is_some()
}
