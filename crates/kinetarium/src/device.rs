//! Where worlds run: on the processor, or on a graphics card.

use sim::{Device, SolverKind};
use std::fmt;
use std::str::FromStr;

/// Where worlds are to run.
///
/// ```
/// use kinetarium::prelude::*;
///
/// let model = examples::n_pendula(3)?;
/// let settings = SimulationSettings::new(4096, 0.002);
/// // A card where there is one, else the processor.
/// let mut simulation = match DeviceChoice::Auto.open()? {
///     Some(card) => Simulation::on(&*card, model, settings)?,
///     None => Simulation::<f32>::new(model, settings)?,
/// };
/// simulation.try_step(10)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// `cpu`.
    #[default]
    Processor,
    /// `auto`: any graphics card, and the processor where there is none. Never a program that stands in for a card.
    Auto,
    /// `gpu`, or `gpu:NAME` with a part of its name; by name a program that stands in for a card is taken, too.
    Card(String),
}

/// A card that is open.
pub type Card = Box<dyn Device<f32>>;

/// Why a choice cannot be met.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceChoiceError {
    /// There is no such choice.
    #[error(
        "unknown device `{0}`; known are cpu, auto, gpu, and gpu:NAME with a part of the card's name"
    )]
    Unknown(String),
    /// Cards compute in f32.
    #[error("{0} computes in single precision: take that, or the device cpu")]
    Precision(String),
    /// This build has no part for cards.
    #[error(
        "this build runs on processors only: build it with the feature `gpu`, as `cargo run --release --features gpu`"
    )]
    NotBuilt,
    /// The card is not to be had.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] gpu::GpuError),
}

impl FromStr for DeviceChoice {
    type Err = DeviceChoiceError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text.split_once(':') {
            None if text == "cpu" => Ok(Self::Processor),
            None if text == "auto" => Ok(Self::Auto),
            None if text == "gpu" => Ok(Self::Card(String::new())),
            Some(("gpu", name)) => Ok(Self::Card(name.to_owned())),
            _ => Err(DeviceChoiceError::Unknown(text.to_owned())),
        }
    }
}

impl fmt::Display for DeviceChoice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Processor => f.write_str("cpu"),
            Self::Auto => f.write_str("auto"),
            Self::Card(name) if name.is_empty() => f.write_str("gpu"),
            Self::Card(name) => write!(f, "gpu:{name}"),
        }
    }
}

impl DeviceChoice {
    /// The card, or none where worlds are to run on the processor.
    ///
    /// # Errors
    /// A card that is not there, with those that are; a build without cards.
    pub fn open(&self) -> Result<Option<Card>, DeviceChoiceError> {
        match self {
            Self::Processor => Ok(None),
            Self::Auto => auto(),
            Self::Card(name) => card(name).map(Some),
        }
    }
    /// The same for a solver and a precision, `double` for f64: `auto` takes the processor where a card does not
    /// take these.
    ///
    /// # Errors
    /// As [`open`](Self::open); a card that was asked for, and double precision.
    pub fn open_for(
        &self,
        solver: SolverKind,
        double: bool,
    ) -> Result<Option<Card>, DeviceChoiceError> {
        if *self == Self::Auto && (double || solver == SolverKind::Impulse) {
            return Ok(None);
        }
        match self.open()? {
            Some(card) if double => Err(DeviceChoiceError::Precision(card.name())),
            other => Ok(other),
        }
    }
}

#[cfg(feature = "gpu")]
fn card(name: &str) -> Result<Card, DeviceChoiceError> {
    let Ok(choice) = name.parse();
    Ok(Box::new(gpu::Gpu::open(&choice)?))
}

#[cfg(feature = "gpu")]
fn auto() -> Result<Option<Card>, DeviceChoiceError> {
    match card("") {
        Ok(card) => Ok(Some(card)),
        Err(DeviceChoiceError::Gpu(gpu::GpuError::NoCard { .. })) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(not(feature = "gpu"))]
fn card(_: &str) -> Result<Card, DeviceChoiceError> {
    Err(DeviceChoiceError::NotBuilt)
}

#[cfg(not(feature = "gpu"))]
fn auto() -> Result<Option<Card>, DeviceChoiceError> {
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for text in ["cpu", "auto", "gpu", "gpu:llvmpipe"] {
            assert_eq!(text.parse::<DeviceChoice>().unwrap().to_string(), text);
        }
        for text in ["", "GPU", "tpu", "cpu:0"] {
            let told = text.parse::<DeviceChoice>().unwrap_err().to_string();
            assert!(told.contains(&format!("`{text}`")), "{told}");
        }
    }

    #[test]
    fn a_card_that_is_not_there_is_told() {
        let told = "gpu:no such card".parse::<DeviceChoice>().unwrap().open();
        let told = told.err().unwrap().to_string();
        let remedy = if cfg!(feature = "gpu") {
            "no such card"
        } else {
            "--features gpu"
        };
        assert!(told.contains(remedy), "{told}");
        assert!(DeviceChoice::Processor.open().unwrap().is_none());
    }
}
