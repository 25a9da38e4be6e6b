//! The settings as a table, which forms, the program's help, checks and the documentation read.

use crate::{SimulationError, SimulationSettings, SolverKind};
use rigid::Integrator;

/// One of the [`SimulationSettings`], as people see it.
#[derive(Debug)]
pub struct Setting {
    /// Name of its field in [`SimulationSettings`] or [`Settings`](rigid::Settings).
    pub name: &'static str,
    /// Name for people.
    pub label: &'static str,
    /// Unit; empty for a bare number.
    pub unit: &'static str,
    /// What it does, in a sentence.
    pub help: &'static str,
    /// The solvers that read it; none are all of them.
    pub solvers: &'static [SolverKind],
    /// What values it takes.
    pub kind: SettingKind,
    /// What it is, as a number: of a flag 0 or 1, of a choice the row; infinite where there is no cap.
    pub read: fn(&SimulationSettings) -> f64,
    /// Sets it to such a number, which it takes.
    pub write: fn(&mut SimulationSettings, f64),
}

/// What values a [`Setting`] takes.
#[derive(Clone, Copy, Debug)]
pub enum SettingKind {
    /// A number.
    Number {
        /// Whether it may be this.
        takes: fn(f64) -> bool,
        /// The same in words.
        must: &'static str,
        /// Least and most of what is usual.
        usual: [f64; 2],
        /// Whether its size matters more than its distance from others.
        logarithmic: bool,
    },
    /// A whole number.
    Whole {
        /// Least and most.
        range: [f64; 2],
        /// Least and most of what is usual.
        usual: [f64; 2],
    },
    /// Yes or no.
    Flag,
    /// One of several, with their names for people.
    Choice(&'static [&'static str]),
}

const FEATHERSTONE: &[SolverKind] = &[SolverKind::Featherstone];
const XPBD: &[SolverKind] = &[SolverKind::Xpbd];
const IMPULSE: &[SolverKind] = &[SolverKind::Impulse];

/// What says how worlds advance, in the order in which forms show it. What says where and how many they are (worlds,
/// threads, instruction set) is not among it.
pub const SETTINGS: [Setting; 13] = [
    Setting {
        name: "time_step",
        label: "Time step",
        unit: "s",
        help: "Time from one state to the next. Shorter is more accurate, and slower.",
        solvers: &[],
        kind: SettingKind::Number {
            takes: |x| (1e-9..=1e3).contains(&x),
            must: "from 1e-9 to 1e3, in seconds",
            usual: [1e-5, 0.1],
            logarithmic: true,
        },
        read: |s| s.step.time_step,
        write: |s, x| s.step.time_step = x,
    },
    Setting {
        name: "substeps",
        label: "Substeps",
        unit: "",
        help: "Into how many parts each time step is cut.",
        solvers: &[],
        kind: SettingKind::Whole {
            range: [1.0, 10_000.0],
            usual: [1.0, 100.0],
        },
        read: |s| s.step.substeps as f64,
        write: |s, x| s.step.substeps = x as usize,
    },
    Setting {
        name: "integrator",
        label: "Integrator",
        unit: "",
        help: "How a step advances the state: Runge–Kutta 4 is the most accurate where nothing touches, and takes four \
               times as long. Explicit Euler and Verlet are for comparison.",
        solvers: FEATHERSTONE,
        kind: SettingKind::Choice(&[
            "semi-implicit Euler",
            "explicit Euler",
            "Verlet",
            "Runge–Kutta 4",
        ]),
        read: |s| row(&Integrator::ALL, s.step.integrator),
        write: |s, x| s.step.integrator = Integrator::ALL[x as usize],
    },
    Setting {
        name: "contacts",
        label: "Contacts",
        unit: "",
        help: "Whether shapes touch; otherwise bodies pass through each other.",
        solvers: &[],
        kind: SettingKind::Flag,
        read: |s| f64::from(s.contacts),
        write: |s, x| s.contacts = x != 0.0,
    },
    Setting {
        name: "iterations",
        label: "Iterations",
        unit: "",
        help: "Passes over all constraints in each substep. More substeps are mostly the better use of the time.",
        solvers: XPBD,
        kind: SettingKind::Whole {
            range: [1.0, 10_000.0],
            usual: [1.0, 50.0],
        },
        read: |s| s.step.iterations as f64,
        write: |s, x| s.step.iterations = x as usize,
    },
    Setting {
        name: "contact_passes",
        label: "Contact passes",
        unit: "",
        help: "Passes of a step over the contacts, at most, to find out which press and which slide.",
        solvers: FEATHERSTONE,
        kind: SettingKind::Whole {
            range: [1.0, MOST_PASSES],
            usual: [1.0, 10.0],
        },
        read: |s| s.step.contact_passes as f64,
        write: |s, x| s.step.contact_passes = x as usize,
    },
    Setting {
        name: "contact_iterations",
        label: "Contact iterations",
        unit: "",
        help: "Passes over contacts: with featherstone those between bodies that move; with xpbd all of them, in each \
               iteration; with impulse small steps, of one pass each.",
        solvers: &[],
        kind: SettingKind::Whole {
            range: [0.0, MOST_PASSES],
            usual: [1.0, 50.0],
        },
        read: |s| s.step.contact_iterations as f64,
        write: |s, x| s.step.contact_iterations = x as usize,
    },
    Setting {
        name: "relaxation",
        label: "Relaxation",
        unit: "",
        help: "Factor on every correction of a position; 1 is the plain method.",
        solvers: XPBD,
        kind: SettingKind::Number {
            takes: |x| x > 0.0 && x < 2.0,
            must: "above 0 and below 2",
            usual: [0.1, 1.9],
            logarithmic: false,
        },
        read: |s| s.step.relaxation,
        write: |s, x| s.step.relaxation = x,
    },
    Setting {
        name: "angular_damping",
        label: "Angular damping",
        unit: "1/s",
        help: "Rate at which bodies lose their spin.",
        solvers: XPBD,
        kind: SettingKind::Number {
            takes: |x| (0.0..=1e9).contains(&x),
            must: "from 0 to 1e9, in 1/s",
            usual: [0.0, 10.0],
            logarithmic: false,
        },
        read: |s| s.step.angular_damping,
        write: |s, x| s.step.angular_damping = x,
    },
    Setting {
        name: "displacement_cap",
        label: "Displacement cap",
        unit: "m",
        help: "Largest correction of a joint in a pass; 1000 m and more are no cap.",
        solvers: XPBD,
        kind: SettingKind::Number {
            takes: |x| x > 0.0,
            must: "above zero, in metres",
            usual: [1e-4, 1e3],
            logarithmic: true,
        },
        read: |s| s.step.displacement_cap,
        write: |s, x| s.step.displacement_cap = if x < 1e3 { x } else { f64::INFINITY },
    },
    Setting {
        name: "force_cap",
        label: "Force cap",
        unit: "N",
        help: "Largest force of a joint; 1e9 N and more are no cap.",
        solvers: XPBD,
        kind: SettingKind::Number {
            takes: |x| x > 0.0,
            must: "above zero, in newtons",
            usual: [1.0, 1e9],
            logarithmic: true,
        },
        read: |s| s.step.force_cap,
        write: |s, x| s.step.force_cap = if x < 1e9 { x } else { f64::INFINITY },
    },
    Setting {
        name: "sleep_speed",
        label: "Sleep speed",
        unit: "m/s",
        help: "Bodies slower than this for half a second sleep until they are touched; 0 is never.",
        solvers: IMPULSE,
        kind: SettingKind::Number {
            takes: |x| (0.0..=1e9).contains(&x),
            must: "from 0 to 1e9, in m/s",
            usual: [0.0, 1.0],
            logarithmic: true,
        },
        read: |s| s.step.sleep_speed,
        write: |s, x| s.step.sleep_speed = x,
    },
    Setting {
        name: "speed_limit",
        label: "Speed limit",
        unit: "m/s",
        help: "A world in which something is faster than this, in m/s or rad/s, has diverged, and stands still.",
        solvers: &[],
        kind: SettingKind::Number {
            takes: |x| x > 0.0 && x <= 1e9,
            must: "above zero and at most 1e9",
            usual: [1.0, 1e9],
            logarithmic: true,
        },
        read: |s| s.step.speed_limit,
        write: |s, x| s.step.speed_limit = x,
    },
];

/// More passes than this are a slip of the keyboard.
const MOST_PASSES: f64 = 10_000.0;

fn row<T: PartialEq>(all: &[T], one: T) -> f64 {
    all.iter().position(|x| *x == one).unwrap_or(0) as f64
}

impl Setting {
    /// The one of this name.
    ///
    /// # Panics
    /// There is none: names are the program's own.
    pub fn named(name: &str) -> &'static Self {
        let found = SETTINGS.iter().find(|setting| setting.name == name);
        found.unwrap_or_else(|| panic!("a setting `{name}`"))
    }
    /// Whether a solver reads it, of this name.
    pub fn is_read_by(&self, solver: &str) -> bool {
        self.solvers.is_empty() || self.solvers.iter().any(|kind| kind.name() == solver)
    }
    /// Names of the solvers that read it, or `all`.
    pub fn read_by(&self) -> String {
        let names: Vec<_> = self.solvers.iter().map(|kind| kind.name()).collect();
        match names[..] {
            [] => "all".into(),
            _ => names.join(", "),
        }
    }
    /// What it must be, in words.
    pub fn must_be(&self) -> String {
        match self.kind {
            SettingKind::Number { must, .. } => must.into(),
            SettingKind::Whole { range, .. } => format!("from {} to {}", range[0], range[1]),
            SettingKind::Flag => "true or false".into(),
            SettingKind::Choice(names) => names.join(", "),
        }
    }
    /// Refuses what it does not take.
    pub(crate) fn check(&self, settings: &SimulationSettings) -> Result<(), SimulationError> {
        let value = (self.read)(settings);
        let taken = match self.kind {
            SettingKind::Number { takes, .. } => takes(value),
            SettingKind::Whole { range, .. } => (range[0]..=range[1]).contains(&value),
            SettingKind::Flag | SettingKind::Choice(_) => true,
        };
        if taken {
            return Ok(());
        }
        Err(SimulationError::Setting {
            what: self.name.replace('_', " ").into(),
            value: value.to_string(),
            remedy: self.must_be().into(),
        })
    }
}
