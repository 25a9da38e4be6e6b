//! Where worlds run: on the processor, or on a graphics card.
//!
//! Cards are reached by two ways, each a feature of this crate: `gpu` takes cards of any maker, `cuda` NVIDIA's, where
//! results have the same bits as on the processor.

use crate::{Card, Cards};
use sim::SolverKind;
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
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub enum DeviceChoice {
    /// `cpu`.
    #[default]
    Processor,
    /// `auto`: a graphics card, by CUDA where that is there, and the processor where there is none. Never a program
    /// that stands in for a card.
    Auto,
    /// `gpu`, or `gpu:NAME` with a part of its name; by name a program that stands in for a card is taken, too.
    Card(String),
    /// `cuda`, or `cuda:1`: an NVIDIA card, as CUDA counts them from 0.
    Cuda(usize),
}

/// Why a choice cannot be met.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DeviceChoiceError {
    /// There is no such choice.
    #[error(
        "unknown device `{0}`; known are cpu, auto, gpu, gpu:NAME with a part of the card's name, cuda, and cuda:NUMBER"
    )]
    Unknown(String),
    /// Cards compute in f32.
    #[error("{0} computes in single precision: take that, or the device cpu")]
    Precision(String),
    /// This build has no part for such cards.
    #[error(
        "this build has no part for the device {0}: build it with that feature, as `cargo run --release --features {0}`"
    )]
    NotBuilt(&'static str),
    /// The card is not to be had.
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] gpu::GpuError),
    /// The same, by CUDA.
    #[cfg(feature = "cuda")]
    #[error(transparent)]
    Cuda(#[from] cuda::CudaError),
}

impl FromStr for DeviceChoice {
    type Err = DeviceChoiceError;
    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let unknown = || DeviceChoiceError::Unknown(text.to_owned());
        match text.split_once(':') {
            None if text == "cpu" => Ok(Self::Processor),
            None if text == "auto" => Ok(Self::Auto),
            None if text == "gpu" => Ok(Self::Card(String::new())),
            Some(("gpu", name)) => Ok(Self::Card(name.to_owned())),
            None if text == "cuda" => Ok(Self::Cuda(0)),
            Some(("cuda", number)) => number.parse().map(Self::Cuda).map_err(|_| unknown()),
            _ => Err(unknown()),
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
            Self::Cuda(0) => f.write_str("cuda"),
            Self::Cuda(number) => write!(f, "cuda:{number}"),
        }
    }
}

impl DeviceChoice {
    /// The card, opened anew, or none where worlds are to run on the processor; see [`Cards::open`], by which programs share
    /// those that are open.
    ///
    /// # Errors
    /// A card that is not there, with those that are; a build without cards.
    pub fn open(&self) -> Result<Option<Card>, DeviceChoiceError> {
        Cards::default().open(self)
    }
    /// The same for a solver and a precision; see [`Cards::open_for`].
    ///
    /// # Errors
    /// As [`open`](Self::open); a card that was asked for, and double precision.
    pub fn open_for(
        &self,
        solver: SolverKind,
        double: bool,
    ) -> Result<Option<Card>, DeviceChoiceError> {
        Cards::default().open_for(self, solver, double)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        for text in ["cpu", "auto", "gpu", "gpu:llvmpipe", "cuda", "cuda:1"] {
            assert_eq!(text.parse::<DeviceChoice>().unwrap().to_string(), text);
        }
        for text in ["", "GPU", "tpu", "cpu:0", "cuda:first", "cuda:-1"] {
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
        if !cfg!(feature = "cuda") {
            let told = DeviceChoice::Cuda(0).open().err().unwrap().to_string();
            assert!(told.contains("--features cuda"), "{told}");
        }
        assert!(DeviceChoice::Processor.open().unwrap().is_none());
    }
}
