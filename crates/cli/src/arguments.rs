//! What the command line understands.

use clap::builder::{PossibleValue, PossibleValuesParser, RangedU64ValueParser, TypedValueParser};
use clap::error::{ContextKind, ContextValue};
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use kinetarium::DeviceChoice;
use kinetarium::formats::Meshes;
use kinetarium::model::examples::{SCENES, Scene, Start};
use kinetarium::numbers::dispatch::Isa;
use kinetarium::rigid::Integrator;
use kinetarium::sim::{Setting, SolverKind};
use std::ffi::OsStr;
use std::net::IpAddr;
use std::path::{Path, PathBuf};

const EXAMPLES: &str = "\
Examples:
  kinetarium                                       the examples, in a browser
  kinetarium view robot.xml                        a robot file in a browser
  kinetarium pendula --links 10 --start upright    others like them
  kinetarium example tower                         a built-in scene; `example --help` lists them
  kinetarium run robot.xml                         a MuJoCo (MJCF) or URDF file, one world
  kinetarium run robot.xml --worlds 4096 --perturb 0.05 --record 3 --out results
  kinetarium run robot.xml --worlds 65536 --device gpu   built with the feature `gpu`, or cuda
  kinetarium info robot.xml                        what is in a file, and which solver fits
  kinetarium shot room --time 2 --out room.png     a picture of it after two seconds

Every run, example and pendula writes the trajectory (.npz for numpy, .csv) and a plot (.png, .svg).";

/// Simulates articulated bodies, in thousands of worlds side by side.
#[derive(Debug, Parser)]
#[command(name = "kinetarium", version, after_help = EXAMPLES)]
pub struct Arguments {
    /// What to do; without one, the examples are shown in a browser.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Serve no page: without a command, simulate the built-in pendula and write their files.
    #[arg(long, global = true)]
    pub headless: bool,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    /// Show a robot file, or an example, in a browser.
    View(View),
    /// Simulate a robot file: MuJoCo's MJCF or ROS's URDF.
    Run(Run),
    /// Simulate a built-in scene of bodies that touch: a tower, dominoes, a room, …
    Example(Example),
    /// Simulate the built-in pendula of N links.
    Pendula(Pendula),
    /// Show what is in a robot file, what of it is not supported, and which solver fits.
    Info(Info),
    /// Draw a scene or a robot file into a picture, without a window.
    Shot(Shot),
}

#[derive(Debug, Parser)]
pub struct View {
    /// A robot file, or the name of an example; the first example without one.
    #[arg(value_name = "FILE|EXAMPLE")]
    pub what: Option<PathBuf>,
    #[command(flatten)]
    pub reading: Reading,
    /// Start a file from this keyframe.
    #[arg(long, value_name = "NAME")]
    pub keyframe: Option<String>,
    /// Number of worlds of a file [default: the file's].
    #[arg(long, value_name = "N", value_parser = count(1, 4096))]
    pub worlds: Option<usize>,
    /// A graphics card that pages may choose to run on: auto (one if it is there), gpu, gpu:NAME with a part of its
    /// name, cuda, cuda:NUMBER, or cpu, which is none.
    #[arg(long, value_name = "DEVICE", default_value = "auto")]
    pub device: DeviceChoice,
    /// Address to listen at. One that other machines can reach wants a token, which is printed.
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1")]
    pub address: IpAddr,
    /// Port to listen at [default: 7357, or any that is free].
    #[arg(long, value_name = "PORT")]
    pub port: Option<u16>,
    /// Open no browser.
    #[arg(long)]
    pub no_browser: bool,
}

#[derive(Debug, Args)]
pub struct Run {
    #[command(flatten)]
    pub file: RobotFile,
    /// Start from this keyframe of the file: positions, velocities and controls.
    #[arg(long, value_name = "NAME")]
    pub keyframe: Option<String>,
    #[command(flatten)]
    pub simulation: Simulation,
}

#[derive(Debug, Args)]
pub struct Example {
    /// Name of the scene.
    #[arg(value_name = "NAME", value_parser = scene())]
    pub scene: &'static Scene,
    #[command(flatten)]
    pub simulation: Simulation,
}

#[derive(Debug, Parser)]
pub struct Pendula {
    /// Links of each pendulum.
    #[arg(long, value_name = "N", default_value = "3", value_parser = count(1, 1000))]
    pub links: usize,
    /// How the pendula start.
    #[arg(long, value_enum, default_value_t = StartName::Horizontal)]
    pub start: StartName,
    #[command(flatten)]
    pub simulation: Simulation,
}

#[derive(Debug, Args)]
pub struct Info {
    #[command(flatten)]
    pub file: RobotFile,
}

#[derive(Debug, Args)]
pub struct Shot {
    /// A robot file, or the name of an example, with its random motors.
    #[arg(value_name = "FILE|EXAMPLE")]
    pub scene: PathBuf,
    /// Picture to write, as PNG.
    #[arg(long, value_name = "FILE", default_value = "picture.png", value_parser = picture)]
    pub out: PathBuf,
    /// Pixels of a row, and rows.
    #[arg(long, value_name = "WIDTHxHEIGHT", default_value = "1280x720", value_parser = size)]
    pub size: (usize, usize),
    /// Time [s] to simulate before the picture is taken.
    #[arg(long, value_name = "SECONDS", default_value = "0", value_parser = not_negative, allow_negative_numbers = true)]
    pub time: f64,
    /// Where the camera is, and a point in the middle of the image [m], or the name of a camera of the file
    /// [default: so that everything that can move is seen].
    #[arg(long, value_name = "X,Y,Z:X,Y,Z|NAME", value_parser = camera, allow_hyphen_values = true)]
    pub camera: Option<Viewpoint>,
    /// Samples along each edge of a pixel [default: 4; 2 on a graphics card, which takes no more].
    #[arg(long, value_name = "N", value_parser = count(1, 64))]
    pub samples: Option<usize>,
    /// Where the picture is drawn: cpu, where corners are shaded, too; gpu (a graphics card), gpu:NAME with a part of its
    /// name, or auto, which takes a card where there is one.
    #[arg(long, value_name = "DEVICE", default_value = "cpu")]
    pub device: render::Device,
    /// Start from this keyframe of the file.
    #[arg(long, value_name = "NAME")]
    pub keyframe: Option<String>,
    #[command(flatten)]
    pub reading: Reading,
}

/// From where a picture is taken.
#[derive(Clone, Debug)]
pub enum Viewpoint {
    /// From a point towards another [m].
    Points([DVec3; 2]),
    /// From a camera of the model.
    Named(String),
}

#[derive(Debug, Args)]
pub struct RobotFile {
    /// MJCF (.xml) or URDF (.urdf) file.
    #[arg(value_name = "FILE")]
    pub path: PathBuf,
    #[command(flatten)]
    pub reading: Reading,
}

/// How a robot file is read.
#[derive(Clone, Debug, Args)]
pub struct Reading {
    /// Go on, with a warning, where the file uses something that is not supported and changes the motion.
    #[arg(long)]
    pub lenient: bool,
    /// What becomes of meshes that collide, or that a body has its mass from.
    #[arg(long, value_enum, default_value_t = MeshesName::Named)]
    pub meshes: MeshesName,
    /// URDF only: let the root link float freely instead of fixing it to the world.
    #[arg(long)]
    pub floating_base: bool,
}

/// How to simulate, and what to write.
#[derive(Debug, Args)]
pub struct Simulation {
    /// Number of worlds [default: the file's, which is mostly 1; 1024 pendula].
    #[arg(long, value_name = "N", value_parser = count(1, 1 << 24))]
    pub worlds: Option<usize>,
    /// Simulated time [s].
    #[arg(long, value_name = "SECONDS", default_value = "5", value_parser = positive, allow_negative_numbers = true)]
    pub seconds: f64,
    /// Solver; `auto` takes impulse for several things that touch, featherstone for other trees, else xpbd.
    #[arg(long, value_enum, default_value_t = SolverName::Auto)]
    pub solver: SolverName,
    #[arg(long, help = setting("time_step", "the file's"), value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true)]
    pub time_step: Option<f64>,
    #[arg(long, help = setting("substeps", "4 with xpbd, else 1"), value_name = "N", value_parser = count(1, 10_000))]
    pub substeps: Option<usize>,
    #[arg(long, help = setting("iterations", "1"), value_name = "N", value_parser = count(1, 10_000))]
    pub iterations: Option<usize>,
    /// Let bodies pass through each other.
    #[arg(long)]
    pub no_contacts: bool,
    #[arg(long, help = setting("integrator", "semi-implicit-euler; rk4 for the pendula"), value_enum)]
    pub integrator: Option<IntegratorName>,
    /// Precision of all numbers.
    #[arg(long, value_enum, default_value_t = Precision::F32)]
    pub precision: Precision,
    /// Threads; 0 takes one per processor.
    #[arg(long, value_name = "N", default_value = "0", value_parser = count(0, 1024))]
    pub threads: usize,
    /// Instruction set: avx512, avx2, neon, simd128 or portable [default: the fastest here].
    #[arg(long, value_name = "NAME")]
    pub isa: Option<Isa>,
    /// Where worlds run: cpu, gpu (a graphics card), gpu:NAME with a part of its name, cuda (an NVIDIA card),
    /// cuda:NUMBER, or auto, which takes a card where there is one, but for the solver impulse.
    #[arg(long, value_name = "DEVICE", default_value = "cpu")]
    pub device: DeviceChoice,
    /// Start each world but the first a little apart: joint positions differ at random by up to
    /// this much [rad or m] [default: 0; 0.01 for the pendula].
    #[arg(long, value_name = "SIZE", value_parser = not_negative, allow_negative_numbers = true)]
    pub perturb: Option<f64>,
    /// Seed of the random differences.
    #[arg(long, value_name = "N", default_value = "1")]
    pub seed: u64,
    /// Number of worlds, from the first, whose trajectories are written.
    #[arg(long, value_name = "N", default_value = "1", value_parser = count(1, 1 << 24))]
    pub record: usize,
    /// Time [s] from one row of the trajectory to the next, rounded to whole time steps
    /// [default: 1/60].
    #[arg(long, value_name = "SECONDS", value_parser = positive, allow_negative_numbers = true)]
    pub every: Option<f64>,
    /// Folder to write to; made if it does not exist.
    #[arg(long, value_name = "FOLDER", default_value = "kinetarium-out")]
    pub out: PathBuf,
    /// Show errors only.
    #[arg(long, short)]
    pub quiet: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum MeshesName {
    /// Their files are not read; no solver collides them.
    Named,
    /// As they are: surfaces.
    Exact,
    /// Their convex hulls: what is hollow is filled.
    Hull,
    /// Convex pieces, nearly what they are. Built with `--features decomposition`.
    Pieces,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum StartName {
    Hanging,
    Horizontal,
    Upright,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum SolverName {
    Auto,
    Featherstone,
    Xpbd,
    Impulse,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum IntegratorName {
    SemiImplicitEuler,
    ExplicitEuler,
    Verlet,
    Rk4,
}

#[derive(Clone, Copy, Debug, PartialEq, ValueEnum)]
pub enum Precision {
    F32,
    F64,
}

impl From<MeshesName> for Meshes {
    fn from(name: MeshesName) -> Self {
        match name {
            MeshesName::Named => Self::Named,
            MeshesName::Exact => Self::Exact,
            MeshesName::Hull => Self::ConvexHull,
            MeshesName::Pieces => Self::Pieces,
        }
    }
}

impl From<StartName> for Start {
    fn from(name: StartName) -> Self {
        match name {
            StartName::Hanging => Self::Hanging,
            StartName::Horizontal => Self::Horizontal,
            StartName::Upright => Self::Upright,
        }
    }
}

impl From<SolverName> for SolverKind {
    fn from(name: SolverName) -> Self {
        match name {
            SolverName::Auto => Self::Auto,
            SolverName::Featherstone => Self::Featherstone,
            SolverName::Xpbd => Self::Xpbd,
            SolverName::Impulse => Self::Impulse,
        }
    }
}

impl From<IntegratorName> for Integrator {
    fn from(name: IntegratorName) -> Self {
        match name {
            IntegratorName::SemiImplicitEuler => Self::SemiImplicitEuler,
            IntegratorName::ExplicitEuler => Self::ExplicitEuler,
            IntegratorName::Verlet => Self::Verlet,
            IntegratorName::Rk4 => Self::RungeKutta4,
        }
    }
}

/// What a setting does, which solvers read it, and what it is where it is not given.
fn setting(name: &str, default: &str) -> String {
    let setting = Setting::named(name);
    let unit = match setting.unit {
        "" => String::new(),
        unit => format!(" [{unit}]"),
    };
    let solvers = match setting.solvers {
        [] => String::new(),
        _ => format!(" Read by {}.", setting.read_by()),
    };
    let (label, help) = (setting.label, setting.help);
    format!("{label}{unit}. {help}{solvers} [default: {default}]")
}

/// Tells whoever gives a file or an example without a command which one shows it.
pub fn with_tip(mut error: clap::Error) -> clap::Error {
    let Some(ContextValue::String(word)) = error.get(ContextKind::InvalidSubcommand) else {
        return error;
    };
    let path = Path::new(word);
    let is_robot = |ending: &OsStr| ["xml", "mjcf", "urdf"].iter().any(|known| ending == *known);
    if path.extension().is_some_and(is_robot) || session::Example::find(word).is_ok() {
        let tip = format!("'kinetarium view {word}' shows it; '--help' lists the other commands");
        let tips = ContextValue::StyledStrs(vec![tip.into()]);
        error.insert(ContextKind::Suggested, tips);
    }
    error
}

fn count(least: u64, most: u64) -> RangedU64ValueParser<usize> {
    RangedU64ValueParser::new().range(least..=most)
}

/// A scene by its name; the help lists them all.
fn scene() -> impl TypedValueParser<Value = &'static Scene> {
    let values = SCENES
        .iter()
        .map(|s| PossibleValue::new(s.name).help(s.about));
    PossibleValuesParser::new(values).try_map(|name| Scene::find(&name).ok_or("no such scene"))
}

/// Two numbers of pixels.
fn size(text: &str) -> Result<(usize, usize), String> {
    let numbers = text.split_once('x');
    let numbers = numbers.and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    numbers.ok_or_else(|| "write two numbers of pixels, as 1280x720".into())
}

/// Two points, or a name: what has a comma is none.
fn camera(text: &str) -> Result<Viewpoint, String> {
    if !text.contains(',') {
        return Ok(Viewpoint::Named(text.into()));
    }
    let wrong = || "write two points, as 3,2,5:0,0.5,0, or a camera's name".to_owned();
    let point = |text: &str| {
        let numbers = text.split(',').map(number).collect::<Result<Vec<_>, _>>();
        let numbers: [f64; 3] = numbers.ok()?.try_into().ok()?;
        Some(DVec3::from_array(numbers))
    };
    let (eye, target) = text.split_once(':').ok_or_else(wrong)?;
    let (eye, target) = point(eye).zip(point(target)).ok_or_else(wrong)?;
    let apart = eye.distance(target);
    if apart == 0.0 || apart.is_infinite() {
        return Err("a camera looks from one point to another: give two, some way apart".into());
    }
    Ok(Viewpoint::Points([eye, target]))
}

/// A file whose name does not say that it is another kind of picture.
fn picture(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension() {
        Some(kind) if !kind.eq_ignore_ascii_case("png") => {
            Err("pictures are PNG: write a name that ends in .png".into())
        }
        _ => Ok(path),
    }
}

fn number(text: &str) -> Result<f64, String> {
    let x: f64 = text.parse().map_err(|_| "this is no number".to_owned())?;
    if x.is_finite() {
        Ok(x)
    } else {
        Err("it must be finite".into())
    }
}

fn positive(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x > 0.0 {
        Ok(x)
    } else {
        Err("it must be above zero".into())
    }
}

fn not_negative(text: &str) -> Result<f64, String> {
    let x = number(text)?;
    if x >= 0.0 {
        Ok(x)
    } else {
        Err("it must not be negative".into())
    }
}
