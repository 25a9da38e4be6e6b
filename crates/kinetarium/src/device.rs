//! Where worlds run: on the processor, or on a graphics card.
//!
//! Cards are reached by two ways, each a feature of this crate: `gpu` takes cards of any maker, `cuda` NVIDIA's, where
//! results have the same bits as on the processor.

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
    /// `auto`: a graphics card, by CUDA where that is there, and the processor where there is none. Never a program
    /// that stands in for a card.
    Auto,
    /// `gpu`, or `gpu:NAME` with a part of its name; by name a program that stands in for a card is taken, too.
    Card(String),
    /// `cuda`, or `cuda:1`: an NVIDIA card, as CUDA counts them from 0.
    Cuda(usize),
}

/// A card that is open.
pub type Card = Box<dyn Device<f32>>;

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
    /// The card, or none where worlds are to run on the processor.
    ///
    /// # Errors
    /// A card that is not there, with those that are; a build without cards.
    pub fn open(&self) -> Result<Option<Card>, DeviceChoiceError> {
        match self {
            Self::Processor => Ok(None),
            Self::Auto => match auto_cuda()? {
                Some(card) => Ok(Some(card)),
                None => auto_gpu(),
            },
            Self::Card(name) => card(name).map(Some),
            Self::Cuda(number) => nvidia(*number).map(Some),
        }
    }
    /// The same for the solver that the processor would take and a precision, `double` for f64: `auto` takes the processor
    /// for `impulse`, whose worlds are few as a rule, and where a card does not take the precision.
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
fn auto_gpu() -> Result<Option<Card>, DeviceChoiceError> {
    match card("") {
        Ok(card) => Ok(Some(card)),
        Err(DeviceChoiceError::Gpu(gpu::GpuError::NoCard(_))) => Ok(None),
        Err(error) => Err(error),
    }
}

#[cfg(not(feature = "gpu"))]
fn card(_: &str) -> Result<Card, DeviceChoiceError> {
    Err(DeviceChoiceError::NotBuilt("gpu"))
}

#[cfg(not(feature = "gpu"))]
fn auto_gpu() -> Result<Option<Card>, DeviceChoiceError> {
    Ok(None)
}

#[cfg(feature = "cuda")]
fn nvidia(number: usize) -> Result<Card, DeviceChoiceError> {
    Ok(Box::new(cuda::Cuda::open(number)?))
}

#[cfg(feature = "cuda")]
fn auto_cuda() -> Result<Option<Card>, DeviceChoiceError> {
    use cuda::CudaError::{NoCard, NoCompiler, NoDriver, TooOld};
    match nvidia(0) {
        Ok(card) => Ok(Some(card)),
        Err(DeviceChoiceError::Cuda(NoDriver | NoCompiler | NoCard { .. } | TooOld { .. })) => {
            Ok(None)
        }
        Err(error) => Err(error),
    }
}

#[cfg(not(feature = "cuda"))]
fn nvidia(_: usize) -> Result<Card, DeviceChoiceError> {
    Err(DeviceChoiceError::NotBuilt("cuda"))
}

#[cfg(not(feature = "cuda"))]
fn auto_cuda() -> Result<Option<Card>, DeviceChoiceError> {
    Ok(None)
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
