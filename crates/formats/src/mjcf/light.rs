//! `<light>` (XML reference, "light").

use super::Context;
use super::camera::mounted;
use super::content::Content;
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;
use glam::{DQuat, DVec3};
use model::{BodyId, Lamp, LampKind, Pose};
use std::f64::consts::FRAC_PI_2;

pub(super) const KNOWN: &[&str] = &[
    "name",
    "class",
    "mode",
    "target",
    "directional",
    "type",
    "castshadow",
    "active",
    "pos",
    "dir",
    "diffuse",
    "attenuation",
    "cutoff",
    "exponent",
];
/// What is left out of a light, and what that means.
pub(super) const UNUSED: &[(&str, &str)] = &[
    ("ambient", "what is lit from nowhere is lit by the sky"),
    ("specular", "what shines reflects `diffuse`"),
    ("texture", "not read"),
    ("intensity", "brightness is that of `diffuse`"),
    ("range", "light goes on, as `attenuation` says"),
    ("bulbradius", "shadows of lamps have sharp edges"),
];
/// MuJoCo's own colour, cutoff [°] and exponent.
const DIFFUSE: f64 = 0.7;
const CUTOFF: f64 = 45.0;
const EXPONENT: f64 = 10.0;

/// Adds a light of a body, or of the world; notes one that cannot be had.
pub(super) fn read(
    content: &Content,
    body: Option<BodyId>,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let defaults = &context.defaults;
    let element = defaults.apply(content.element, content.class, &["light"])?;
    report.check_attributes(&element, KNOWN, UNUSED)?;
    let Some(kind) = kind(&element, report)? else {
        return Ok(());
    };
    if element.truth("active")? == Some(false) {
        return Ok(());
    }
    let along = element.vector("dir")?.unwrap_or(DVec3::NEG_Z);
    let Some(along) = along.try_normalize() else {
        return Err(element.invalid("`dir` is no direction", "give one, such as 0 0 -1"));
    };
    let turn = DQuat::from_rotation_arc(DVec3::NEG_Z, along);
    let local = content.frame * Pose::new(element.vector("pos")?.unwrap_or_default(), turn);
    let Some((mode, pose)) = mounted("lights", &element, local, body, tree, report)? else {
        return Ok(());
    };
    let name = element.get("name").unwrap_or_default();
    let (diffuse, attenuation) = (element.vector("diffuse")?, element.vector("attenuation")?);
    tree.parts.lamps.push(Lamp {
        body,
        mode,
        pose,
        color: diffuse.unwrap_or(DVec3::splat(DIFFUSE)).as_vec3(),
        attenuation: attenuation.unwrap_or(DVec3::X),
        shadows: element.truth("castshadow")?.unwrap_or(true),
        ..Lamp::new(name, kind)
    });
    Ok(())
}

fn kind(element: &Element, report: &mut Report) -> Result<Option<LampKind>, FormatError> {
    let types = ["spot", "directional", "point", "image"];
    let parallel = element.truth("directional")?.unwrap_or(false);
    let otherwise = if parallel { "directional" } else { "spot" };
    Ok(match element.word("type", &types)?.unwrap_or(otherwise) {
        "directional" => Some(LampKind::Parallel),
        "point" => Some(LampKind::Point),
        "spot" => Some(spot(element)?),
        _ => {
            report.note(element, "lights of the type `image`", "not read");
            None
        }
    })
}

/// With OpenGL's cutoff: up to 90°, or 180° for light in all directions.
fn spot(element: &Element) -> Result<LampKind, FormatError> {
    let cutoff = element.number("cutoff")?.unwrap_or(CUTOFF);
    if cutoff >= 180.0 {
        return Ok(LampKind::Point);
    }
    Ok(LampKind::Spot {
        cutoff: cutoff.to_radians().min(FRAC_PI_2),
        exponent: element.number("exponent")?.unwrap_or(EXPONENT),
    })
}
