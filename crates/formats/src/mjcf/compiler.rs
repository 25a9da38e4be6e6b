//! `<compiler>`: how the rest of the file is to be understood (XML reference, "compiler").

use super::orientation::EulerSequence;
use super::sections::merged;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// Where a body's mass comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum InertiaFromGeom {
    /// From its inertial element, which must be there.
    Never,
    /// From its geoms, where it has any.
    Always,
    /// From its inertial element, and without one from its geoms.
    Auto,
}

#[derive(Clone, Debug)]
pub(super) struct Compiler {
    /// Radians per unit of angle in the file.
    pub angle: f64,
    pub euler: EulerSequence,
    pub auto_limits: bool,
    pub inertia_from_geom: InertiaFromGeom,
    /// Groups of geoms that count for the inertia.
    pub inertia_groups: (i64, i64),
    pub bound_mass: f64,
    pub bound_inertia: f64,
    pub balance_inertia: bool,
    /// Total mass [kg] to which all masses are scaled.
    pub total_mass: Option<f64>,
    /// Bodies that fly alone have the frame of their inertia, where their joints do not say.
    pub align_free: bool,
    /// Solids are fitted to the boxes about meshes, not to their inertia.
    pub fit_to_bounds: bool,
    pub mesh_folder: String,
    pub strip_path: bool,
}

const KNOWN: &[&str] = &[
    "autolimits",
    "boundmass",
    "boundinertia",
    "settotalmass",
    "balanceinertia",
    "strippath",
    "coordinate",
    "angle",
    "fitaabb",
    "eulerseq",
    "meshdir",
    "texturedir",
    "assetdir",
    "usethread",
    "inertiafromgeom",
    "inertiagrouprange",
    "saveinertial",
    "savecompiled",
    "savecanonical",
    "alignfree",
    "conflict",
    "passthrough",
    "convexhull",
    "exactmeshinertia",
    "discardvisual",
    "fusestatic",
];

impl Compiler {
    pub fn read(root: &Element, report: &mut Report) -> Result<Self, FormatError> {
        let section = merged(root, "compiler");
        report.check_attributes(&section, KNOWN, &[])?;
        if section.word("coordinate", &["local", "global"])? == Some("global") {
            return Err(section.invalid_attribute(
                "coordinate",
                "is `global`, which MuJoCo no longer reads either",
                "write the file in local coordinates: load it once with MuJoCo 2.3.3 or older and \
                 save it",
            ));
        }
        let degrees = section.word("angle", &["degree", "radian"])? != Some("radian");
        let truth = |name, default| Ok(section.truth(name)?.unwrap_or(default));
        let groups = section
            .numbers::<2>("inertiagrouprange")?
            .unwrap_or([0.0, 5.0]);
        let folder = section
            .get("meshdir")
            .or(section.get("assetdir"))
            .unwrap_or_default();
        Ok(Self {
            angle: if degrees { 1f64.to_radians() } else { 1.0 },
            euler: EulerSequence::read(&section)?,
            auto_limits: truth("autolimits", true)?,
            inertia_from_geom: inertia_from_geom(&section)?,
            inertia_groups: (groups[0] as i64, groups[1] as i64),
            bound_mass: section.non_negative("boundmass")?.unwrap_or(0.0),
            bound_inertia: section.non_negative("boundinertia")?.unwrap_or(0.0),
            balance_inertia: truth("balanceinertia", false)?,
            total_mass: section.number("settotalmass")?.filter(|mass| *mass > 0.0),
            align_free: truth("alignfree", false)?,
            fit_to_bounds: truth("fitaabb", false)?,
            mesh_folder: folder.to_owned(),
            strip_path: truth("strippath", false)?,
        })
    }

    /// The path of a mesh file relative to the main file, or absolute.
    pub fn mesh_path(&self, file: &str) -> String {
        let separators = ['/', '\\'];
        let file = match file.rsplit_once(separators) {
            Some((_, name)) if self.strip_path => name,
            _ => file,
        };
        if self.mesh_folder.is_empty() || file.starts_with(separators) {
            return file.to_owned();
        }
        format!("{}/{file}", self.mesh_folder.trim_end_matches(separators))
    }

    /// The range of an element, where it [acts](Self::acting).
    pub fn range(
        &self,
        element: &Element,
        limited: &str,
        range: &str,
    ) -> Result<Option<(f64, f64)>, FormatError> {
        let numbers = element.numbers::<2>(range)?.unwrap_or_default();
        self.acting(element, limited, range, numbers)
    }

    /// A range where it acts: as the `…limited` attribute says; else, with autolimits, where its lower end
    /// is below its upper one. 0 0 stands for none, and so takes back an inherited range. One that is written the wrong way
    /// round, which MuJoCo takes for none, is likely a mistake, and an error.
    pub fn acting(
        &self,
        element: &Element,
        limited: &str,
        range: &str,
        [lower, upper]: [f64; 2],
    ) -> Result<Option<(f64, f64)>, FormatError> {
        let given = [lower, upper] != [0.0; 2];
        match element
            .word(limited, &["true", "false", "auto"])?
            .unwrap_or("auto")
        {
            "false" => Ok(None),
            "auto" if given && !self.auto_limits => Err(element.invalid_attribute(
                range,
                &format!("is given without `{limited}`, while the compiler's autolimits is false"),
                &format!("write {limited}=\"true\" or {limited}=\"false\""),
            )),
            _ if lower > upper => Err(element.invalid_attribute(
                range,
                &format!("has its lower end {lower} above its upper end {upper}"),
                "swap them",
            )),
            "true" if lower == upper => {
                let problem = match element.has(range) {
                    true => format!("is true, but `{range}` is {lower} {upper}"),
                    false => format!("is true, but there is no `{range}`"),
                };
                let remedy = format!("write {range}=\"lower upper\"");
                Err(element.invalid_attribute(limited, &problem, &remedy))
            }
            _ => Ok((lower < upper).then_some((lower, upper))),
        }
    }
}

fn inertia_from_geom(section: &Element) -> Result<InertiaFromGeom, FormatError> {
    let word = section.word("inertiafromgeom", &["auto", "true", "false"])?;
    Ok(match word {
        Some("true") => InertiaFromGeom::Always,
        Some("false") => InertiaFromGeom::Never,
        _ => InertiaFromGeom::Auto,
    })
}
