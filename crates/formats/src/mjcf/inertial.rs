//! A body's mass, centre and inertia: from `<inertial>`, or from its geoms (XML reference,
//! "body/inertial", and "compiler" for the rules that bound and balance them).

use super::compiler::{Compiler, InertiaFromGeom};
use super::geom::Geom;
use super::orientation::{ORIENTATIONS, pose};
use super::principal_frame;
use crate::error::FormatError;
use crate::inertia;
use crate::report::Report;
use crate::xml::Element;
use glam::{DMat3, DQuat, DVec3};
use model::{MassProperties, Pose};

const KNOWN: &[&str] = &[
    "pos",
    "quat",
    "axisangle",
    "xyaxes",
    "zaxis",
    "euler",
    "mass",
    "diaginertia",
    "fullinertia",
];

/// Whether a body's mass comes from its geoms.
pub(super) fn from_geoms(compiler: &Compiler, inertial: bool) -> bool {
    match compiler.inertia_from_geom {
        InertiaFromGeom::Always => true,
        InertiaFromGeom::Auto => !inertial,
        InertiaFromGeom::Never => false,
    }
}

/// Of a body whose inertial element, if any, stands in a frame.
pub(super) fn of_body(
    body: &Element,
    inertial: Option<(&Element, Pose)>,
    geoms: &[Geom],
    compiler: &Compiler,
    report: &mut Report,
) -> Result<MassProperties, FormatError> {
    let solids = geoms
        .iter()
        .filter_map(|geom| geom.solid)
        .reduce(|a, b| a.and(&b));
    let given = match inertial {
        Some((element, frame)) => Some(read(element, frame, compiler, report)?),
        None => None,
    };
    let properties = match from_geoms(compiler, inertial.is_some()) {
        true => solids.or(given),
        false => given,
    };
    bounded(body, properties.unwrap_or(inertia::NOTHING), compiler)
}

fn read(
    element: &Element,
    frame: Pose,
    compiler: &Compiler,
    report: &mut Report,
) -> Result<MassProperties, FormatError> {
    report.check_attributes(element, KNOWN, &[])?;
    element.require("pos")?;
    element.require("mass")?;
    let mass = element.non_negative("mass")?.unwrap_or(0.0);
    let inertia = match (
        element.vector("diaginertia")?,
        element.numbers::<6>("fullinertia")?,
    ) {
        (Some(moments), None) => DMat3::from_diagonal(moments),
        (None, Some(entries)) => {
            if let Some(name) = ORIENTATIONS.iter().find(|name| element.has(name)) {
                let remedy = "remove it: fullinertia is along the body's axes";
                return Err(element.invalid_attribute(name, "stands beside `fullinertia`", remedy));
            }
            inertia::symmetric(entries)
        }
        (Some(_), Some(_)) => {
            let problem = "both `diaginertia` and `fullinertia` are given";
            return Err(element.invalid(problem, "keep one of them"));
        }
        (None, None) => {
            let problem = "neither `diaginertia` nor `fullinertia` is given";
            return Err(element.invalid(problem, "write diaginertia=\"Ixx Iyy Izz\" [kg·m²]"));
        }
    };
    let local = MassProperties {
        mass,
        center: DVec3::ZERO,
        inertia,
    };
    Ok(local.placed(&(frame * pose(element, compiler)?)))
}

/// The axes of the inertia that an element in a frame gives, in the body: its own where it tells the moments about them.
pub(super) fn axes(
    element: &Element,
    frame: Pose,
    inertia: DMat3,
    compiler: &Compiler,
) -> Result<DQuat, FormatError> {
    Ok(match element.has("fullinertia") {
        true => principal_frame::along(inertia, frame.orientation),
        false => frame.orientation * pose(element, compiler)?.orientation,
    })
}

/// Applies the compiler's lower bounds and its balancing, and checks what comes of it.
fn bounded(
    body: &Element,
    properties: MassProperties,
    compiler: &Compiler,
) -> Result<MassProperties, FormatError> {
    let mut bounded = properties;
    bounded.mass = properties.mass.max(compiler.bound_mass);
    let (mut moments, axes) = properties.principal();
    let least = compiler.bound_inertia;
    let raised = least > 0.0 && moments.min_element() < least;
    if raised {
        moments = moments.max(DVec3::splat(least));
    }
    let balanced = compiler.balance_inertia && inertia::violates_triangle(moments);
    if balanced {
        moments = DVec3::splat(moments.element_sum() / 3.0);
    }
    let remedy = "correct them, or set balanceinertia=\"true\" in <compiler>";
    inertia::check(body, moments, remedy)?;
    if raised || balanced {
        let r = DMat3::from_quat(axes);
        bounded.inertia = r * DMat3::from_diagonal(moments) * r.transpose();
    }
    Ok(bounded)
}
