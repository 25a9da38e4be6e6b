//! Where a simulation runs: the processor, or a graphics card.

use crate::SessionError;
use crate::protocol::{Field, Values};
use model::Model;
use numbers::Float;
use sim::{Device, Simulation, SimulationSettings};
use std::fmt;
use std::sync::Arc;

/// The name of the field, and the rows of its choice.
pub(crate) const RUNS_ON: &str = "runs_on";
pub(crate) const PROCESSOR: f64 = 0.0;
const GRAPHICS_CARD: f64 = 1.0;

/// The graphics card that pages may choose.
#[derive(Default)]
pub(crate) enum Card<T: Float> {
    /// Pages are not asked.
    #[default]
    Unasked,
    /// There is none, and why.
    Missing(String),
    Present(Arc<dyn Device<T>>),
}

impl<T: Float> Card<T> {
    /// The field by which pages choose.
    pub fn field(&self) -> Option<Field> {
        let choice = |names: &[&str], help| {
            Field::choice(RUNS_ON, "Runs on", PROCESSOR as usize, names).help(help)
        };
        match self {
            Self::Unasked => None,
            Self::Missing(reason) => {
                let help = "What advances the state. A graphics card would take thousands of replicas at once.";
                Some(choice(&["processor"], help).note(&format!("No graphics card: {reason}")))
            }
            Self::Present(card) => {
                let help = format!(
                    "What advances the state. {} takes thousands of replicas at once; those of the solver impulse, where it \
                     runs them at all, one after the other. Where auto takes that on the processor, a change starts again.",
                    card.name()
                );
                Some(choice(&["processor", "graphics card"], &help))
            }
        }
    }
    /// Chooses the processor where values ask for a card that is missing; why it is.
    pub fn settle(&self, values: &mut Values) -> Option<&str> {
        match (self, values.get_mut(RUNS_ON)) {
            (Self::Missing(reason), Some(chosen)) if *chosen == GRAPHICS_CARD => {
                *chosen = PROCESSOR;
                Some(reason)
            }
            _ => None,
        }
    }
    /// Makes a simulation where it was chosen to run.
    pub fn simulation(
        &self,
        model: Model,
        settings: SimulationSettings,
        runs_on: f64,
    ) -> Result<Simulation<T>, SessionError> {
        Ok(match self {
            Self::Present(card) if runs_on == GRAPHICS_CARD => {
                Simulation::on(&**card, model, settings)?
            }
            _ => Simulation::new(model, settings)?,
        })
    }
}

impl<T: Float> From<Result<Arc<dyn Device<T>>, String>> for Card<T> {
    fn from(card: Result<Arc<dyn Device<T>>, String>) -> Self {
        card.map_or_else(Self::Missing, Self::Present)
    }
}

impl<T: Float> fmt::Debug for Card<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unasked => f.write_str("Unasked"),
            Self::Missing(reason) => write!(f, "Missing({reason})"),
            Self::Present(card) => write!(f, "Present({})", card.name()),
        }
    }
}
