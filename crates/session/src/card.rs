//! Where a simulation runs: the processor, or a graphics card.

use crate::protocol::{Field, Values};
use numbers::Float;
use sim::Device;
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
                    "What advances the state. {} takes thousands of replicas at once.{}",
                    card.name(),
                    match card.runs_impulse() {
                        true => "",
                        false => {
                            " It does not run the solver impulse: where auto takes that on the processor, a change \
                             starts again."
                        }
                    }
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
