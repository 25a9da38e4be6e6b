//! How to simulate.

use crate::setting::SETTINGS;
use crate::{Device, SimulationError};
use model::{Model, hint};
use numbers::Float;
use numbers::dispatch::Isa;
use rigid::impulse::suits;
use rigid::{Integrator, Settings, featherstone};

/// Which solver advances the worlds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SolverKind {
    /// `impulse` for several things that touch and that nothing drives; `featherstone` for other trees, also with loops
    /// and couplings that lock up to 64 degrees of freedom; `xpbd` for more of these, and for joints that give way or
    /// are disabled.
    #[default]
    Auto,
    /// Reduced coordinates: accurate, no drift; loops and couplings by impulses.
    Featherstone,
    /// Maximal coordinates: robust; loops by the hundred, compliance.
    Xpbd,
    /// Sequential impulses: bodies by the thousand, free or jointed, in piles. Several threads can share a
    /// world.
    Impulse,
}

impl SolverKind {
    /// All of them.
    const ALL: [Self; 4] = [Self::Auto, Self::Featherstone, Self::Xpbd, Self::Impulse];

    /// What `auto` takes for a model on the processor; any other takes itself.
    pub fn pick(self, model: &Model, contacts: bool) -> Self {
        match self {
            Self::Auto if contacts && suits(model) => Self::Impulse,
            Self::Auto => Self::of_joints(model),
            named => named,
        }
    }
    /// What `auto` takes on a device: the same, but where that is `impulse` and does not run there.
    pub fn pick_on<T: Float>(self, device: &dyn Device<T>, model: &Model, contacts: bool) -> Self {
        match self.pick(model, contacts) {
            Self::Impulse if self == Self::Auto && !device.runs_impulse() => Self::of_joints(model),
            picked => picked,
        }
    }
    fn of_joints(model: &Model) -> Self {
        match featherstone::suits(model) {
            true => Self::Featherstone,
            false => Self::Xpbd,
        }
    }
    /// Substeps a time step for a model, where nobody says otherwise: 4 of `xpbd`, else 1.
    pub fn usual_substeps(self, model: &Model, contacts: bool) -> usize {
        match self.pick(model, contacts) {
            Self::Xpbd => 4,
            _ => 1,
        }
    }
    /// The integrator that a scene wishes for, where the solver taken for a model has a choice: `featherstone` alone.
    pub fn usual_integrator(self, model: &Model, contacts: bool, wish: Integrator) -> Integrator {
        match self.pick(model, contacts) {
            Self::Featherstone => wish,
            _ => Integrator::SemiImplicitEuler,
        }
    }
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Featherstone => "featherstone",
            Self::Xpbd => "xpbd",
            Self::Impulse => "impulse",
        }
    }
}

impl std::str::FromStr for SolverKind {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|kind| kind.name() == name);
        known.ok_or_else(|| {
            let known = Self::ALL.map(Self::name);
            format!("there is no solver \"{name}\"; {}", hint(name, &known))
        })
    }
}

/// Settings of a [`Simulation`](crate::Simulation).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimulationSettings {
    /// Number of worlds.
    pub worlds: usize,
    /// Solver.
    pub solver: SolverKind,
    /// Whether shapes touch; otherwise bodies pass through each other.
    pub contacts: bool,
    /// Step, substeps, iterations, integrator, caps.
    pub step: Settings,
    /// Number of threads; 0 takes one per processor.
    pub threads: usize,
    /// Instruction set; `None` takes the fastest, or what `KINETARIUM_ISA` names.
    pub isa: Option<Isa>,
    /// True: one world at a time, in scalars, whatever the number of worlds.
    pub scalar: bool,
}

impl SimulationSettings {
    /// One world per `worlds`, solver `auto`, the given time step [s], all processors.
    pub fn new(worlds: usize, time_step: f64) -> Self {
        Self {
            worlds,
            solver: SolverKind::Auto,
            contacts: true,
            step: Settings::new(time_step),
            threads: 0,
            isa: None,
            scalar: false,
        }
    }
}

/// More worlds than this are a slip of the keyboard.
const MOST_WORLDS: usize = 1 << 24;
/// And more threads than this.
const MOST_THREADS: usize = 1024;

impl SimulationSettings {
    /// Refuses what makes no sense.
    pub(crate) fn check(&self, model: &Model) -> Result<(), SimulationError> {
        let s = &self.step;
        let solver = self.solver.pick(model, self.contacts);
        if solver != SolverKind::Featherstone && s.integrator != Integrator::SemiImplicitEuler {
            return Err(SimulationError::Setting {
                what: "integrator".into(),
                value: format!("{} with the solver {}", s.integrator.name(), solver.name()),
                remedy: "semi_implicit_euler, or the solver featherstone".into(),
            });
        }
        let refuse = |what: &'static str, value: f64, remedy: &'static str| {
            Err(SimulationError::Setting {
                what: what.into(),
                value: value.to_string(),
                remedy: remedy.into(),
            })
        };
        if self.worlds == 0 || self.worlds > MOST_WORLDS {
            return refuse("worlds", self.worlds as f64, "from 1 to 16777216");
        }
        if self.threads > MOST_THREADS {
            return refuse(
                "threads",
                self.threads as f64,
                "at most 1024, or 0 for all processors",
            );
        }
        if s.contact_iterations == 0 && solver == SolverKind::Impulse {
            return refuse("contact iterations", 0.0, "at least 1 with `impulse`");
        }
        SETTINGS.iter().try_for_each(|setting| setting.check(self))
    }
}
