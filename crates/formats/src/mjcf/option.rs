//! `<option>` and its `<flag>`: gravity, time step, and what is switched off (XML reference, "option").

use super::sections::merged;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::{Attribute, Element};
use glam::DVec3;

/// Settings of MuJoCo's own solver, renderer and state; they do not change what is simulated.
const SILENT: &[&str] = &[
    "tolerance",
    "ls_tolerance",
    "noslip_tolerance",
    "ccd_tolerance",
    "sleep_tolerance",
    "magnetic",
    "jacobian",
    "solver",
    "iterations",
    "ls_iterations",
    "noslip_iterations",
    "ccd_iterations",
    "sdf_iterations",
    "sdf_initpoints",
    "mpr_iterations",
    "mpr_tolerance",
    "apirate",
];
const READ: &[&str] = &[
    "timestep",
    "gravity",
    "wind",
    "density",
    "viscosity",
    "actuatorgroupdisable",
    "cone",
    "impratio",
];
const UNUSED: &[(&str, &str)] = &[
    (
        "integrator",
        "the integrator is chosen when the simulation is made",
    ),
    ("o_margin", "used by MuJoCo's contact override only"),
    ("o_solref", "used by MuJoCo's contact override only"),
    ("o_solimp", "used by MuJoCo's contact override only"),
    ("o_friction", "used by MuJoCo's contact override only"),
];

/// What those may be that choose how MuJoCo goes about it.
const KEYWORDS: &[(&str, &[&str])] = &[
    (
        "integrator",
        &["Euler", "RK4", "implicit", "implicitfast", "discrete"],
    ),
    ("solver", &["PGS", "CG", "Newton"]),
    ("jacobian", &["dense", "sparse", "auto"]),
];

/// Flags that act while the model is built.
const FLAGS: &[&str] = &[
    "constraint",
    "equality",
    "frictionloss",
    "limit",
    "contact",
    "passive",
    "spring",
    "damper",
    "gravity",
    "clampctrl",
    "actuation",
    "filterparent",
    "refsafe",
];
/// Flags of MuJoCo's own workings.
const SILENT_FLAGS: &[&str] = &[
    "warmstart",
    "sensor",
    "midphase",
    "eulerdamp",
    "autoreset",
    "nativeccd",
    "island",
    "multiccd",
    "energy",
    "fwdinv",
    "invdiscrete",
    "sleep",
    "diagexact",
    "ipc",
    "speculative",
];

#[derive(Clone, Debug)]
pub(super) struct Physics {
    pub time_step: f64,
    pub gravity: DVec3,
    /// Whether cones of friction are pyramids, with edges that press: MuJoCo's standard.
    pub pyramids: bool,
    /// How much harder friction is than what presses (`impratio`).
    pub hardness: f64,
    /// Groups of actuators that do not act.
    pub switched_off: Vec<i64>,
    flags: Vec<Attribute>,
}

impl Physics {
    pub fn read(root: &Element, report: &mut Report) -> Result<Self, FormatError> {
        let section = merged(root, "option");
        let known = [READ, SILENT].concat();
        report.check_attributes(&section, &known, UNUSED)?;
        refuse_fluid(&section, report)?;
        for (name, words) in KEYWORDS {
            section.word(name, words)?;
        }
        let flags = flags(&section, report)?;
        let mut physics = Self {
            time_step: positive(&section, "timestep", 0.002, "of seconds such as 0.002")?,
            gravity: section
                .vector("gravity")?
                .unwrap_or(DVec3::new(0.0, 0.0, -9.81)),
            pyramids: section.word("cone", &["pyramidal", "elliptic"])? != Some("elliptic"),
            hardness: positive(&section, "impratio", 1.0, "such as 1")?,
            switched_off: switched_off(&section)?,
            flags,
        };
        if !physics.on("gravity") {
            physics.gravity = DVec3::ZERO;
        }
        Ok(physics)
    }

    /// Shortest time constant of constraints [s]: two steps, or none ("refsafe").
    pub fn least_time(&self) -> f64 {
        if self.on("refsafe") {
            2.0 * self.time_step
        } else {
            0.0
        }
    }

    /// Whether a flag is on. "constraint" switches all constraints, "passive" springs and dampers.
    pub fn on(&self, flag: &str) -> bool {
        let group = match flag {
            "equality" | "frictionloss" | "limit" | "contact" => "constraint",
            "spring" | "damper" => "passive",
            _ => flag,
        };
        !self
            .flags
            .iter()
            .any(|f| (f.name == flag || f.name == group) && f.value == "disable")
    }
}

/// A number above zero; `example` is the rest of the remedy.
fn positive(section: &Element, name: &str, usual: f64, example: &str) -> Result<f64, FormatError> {
    match section.number(name)? {
        Some(x) if x <= 0.0 => Err(section.invalid_attribute(
            name,
            &format!("is {x}"),
            &format!("write a positive number {example}"),
        )),
        x => Ok(x.unwrap_or(usual)),
    }
}

/// `actuatorgroupdisable`: numbers of groups.
fn switched_off(section: &Element) -> Result<Vec<i64>, FormatError> {
    let groups = section
        .list("actuatorgroupdisable", 0, 31)?
        .unwrap_or_default();
    let is_group = |x: &f64| x.fract() == 0.0 && (0.0..=30.0).contains(x);
    match groups.iter().find(|x| !is_group(x)) {
        None => Ok(groups.iter().map(|x| *x as i64).collect()),
        Some(x) => Err(section.invalid_attribute(
            "actuatorgroupdisable",
            &format!("holds {x}"),
            "write whole numbers from 0 to 30",
        )),
    }
}

/// Drag by a fluid; wind acts through the fluid's density and viscosity only.
fn refuse_fluid(section: &Element, report: &mut Report) -> Result<(), FormatError> {
    for name in ["density", "viscosity"] {
        if section.non_negative(name)?.unwrap_or(0.0) > 0.0 {
            let remedy = "set density and viscosity to 0 for a simulation in vacuum";
            report.refuse(section, &format!("drag by a fluid (`{name}`)"), remedy)?;
        }
    }
    section.vector("wind").map(|_| ())
}

fn flags(section: &Element, report: &mut Report) -> Result<Vec<Attribute>, FormatError> {
    let mut flags = Vec::new();
    for element in &section.children {
        if element.name != "flag" {
            return Err(element.invalid("option holds no such element", "remove it"));
        }
        let known = [FLAGS, SILENT_FLAGS, &["override"]].concat();
        report.check_attributes(element, &known, &[])?;
        for attribute in &element.attributes {
            element.word(&attribute.name, &["enable", "disable"])?;
        }
        if element.get("override") == Some("enable") {
            let feature = "one surface for all contacts (flag `override`)";
            let remedy = "remove the flag, and write the parameters at the geoms";
            report.refuse(element, feature, remedy)?;
        }
        flags.extend(element.attributes.iter().cloned());
    }
    Ok(flags)
}
