//! What can go wrong, and the exit code it ends with.

use kinetarium::DeviceChoiceError;
use kinetarium::formats::FormatError;
use kinetarium::model::ModelError;
use kinetarium::sim::SimulationError;
use render::RenderError;
use session::SessionError;
use std::path::PathBuf;
use viewer::ViewerError;

#[derive(Debug, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Format(#[from] FormatError),
    #[error(transparent)]
    Model(#[from] ModelError),
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    #[error(transparent)]
    Device(#[from] DeviceChoiceError),
    #[error(transparent)]
    Session(#[from] SessionError),
    #[error(transparent)]
    Viewer(#[from] ViewerError),
    #[error("--headless shows nothing: leave it out, or use `kinetarium run`")]
    Headless,
    #[error(
        "--worlds and --keyframe are for files: `{name}` is an example, which is built on the page"
    )]
    FilesOnly { name: String },
    #[error(
        "there is no file `{name}`, but an example is called so: use `kinetarium {command} {name}`"
    )]
    NoFile { name: String, command: &'static str },
    #[error(
        "--iterations is for the solver {readers}, and this is simulated with {solver}: leave it out, or choose \
         another --solver"
    )]
    Iterations { readers: String, solver: String },
    #[error(transparent)]
    Render(#[from] RenderError),
    #[error("--time {seconds} are too many time steps of {time_step} s: lower it")]
    ShotTime { seconds: f64, time_step: f64 },
    #[error(
        "--record {record} is more than the {worlds} worlds there are: lower it, or raise --worlds"
    )]
    Record { record: usize, worlds: usize },
    #[error(
        "the trajectory would have {rows} rows of {numbers} numbers, over {most} in all: raise \
         --every, or lower --seconds or --record"
    )]
    Large {
        rows: usize,
        numbers: usize,
        most: usize,
    },
    #[error(
        "--seconds {seconds} are no time step of {time_step} s, or too many: correct one of them"
    )]
    Steps { seconds: f64, time_step: f64 },
    #[error("cannot write to the folder {path}: {reason}; choose another with --out")]
    Folder {
        path: PathBuf,
        reason: std::io::Error,
    },
    #[error("cannot write the picture {path}: {reason}; choose another with --out")]
    Picture {
        path: PathBuf,
        reason: std::io::Error,
    },
    #[error("cannot write {path}: {reason}")]
    Write {
        path: PathBuf,
        reason: Box<dyn std::error::Error + Send + Sync>,
    },
    #[error(
        "all {worlds} worlds diverged, the last at {time:.3} s: lower --time-step, raise \
         --substeps, or try another --solver"
    )]
    AllDiverged { worlds: usize, time: f64 },
    #[error(
        "the scene diverged within {seconds} s: lower --time, or the time step in its file; \
         `kinetarium run` tells when, and tries others (--time-step, --substeps, --solver)"
    )]
    ShotDiverged { seconds: f64 },
}

impl Error {
    /// 2 where options or files are wrong, 1 where the work failed.
    pub fn exit_code(&self) -> u8 {
        match self {
            Self::Write { .. } | Self::AllDiverged { .. } | Self::ShotDiverged { .. } => 1,
            _ => 2,
        }
    }
}
