//! The sections of a file: which there are, and those that are spread over several elements.

use crate::error::FormatError;
use crate::report::Report;
use crate::xml::Element;

/// Sections that are read.
const READ: &[&str] = &[
    "compiler",
    "option",
    "default",
    "asset",
    "worldbody",
    "contact",
    "equality",
    "tendon",
    "actuator",
    "sensor",
    "keyframe",
];
/// Sections that say nothing about the motion: memory, drawing, and what users store for themselves.
const SILENT: &[&str] = &["size", "visual", "statistic", "custom"];

/// Notes or refuses every section that is not read.
pub(super) fn check(root: &Element, report: &mut Report) -> Result<(), FormatError> {
    for section in &root.children {
        match section.name.as_str() {
            name if READ.contains(&name) || SILENT.contains(&name) => {}
            "deformable" => deformable(section, report)?,
            "extension" => extension(section, report)?,
            other => {
                return Err(section.invalid(
                    &format!("`{other}` is no section of a MuJoCo file"),
                    "correct its spelling, or remove it",
                ));
            }
        }
    }
    Ok(())
}

/// Bodies that deform are refused; skins are looks, here as among the assets.
fn deformable(section: &Element, report: &mut Report) -> Result<(), FormatError> {
    section
        .children_named("skin")
        .for_each(|skin| note_skin(skin, report));
    section
        .children_named("flex")
        .try_for_each(|flex| report.refuse(flex, "a flexible body", "remove it from the file"))
}

pub(super) fn note_skin(skin: &Element, report: &mut Report) {
    report.note(skin, "skins", "only seen; not read");
}

fn extension(section: &Element, report: &mut Report) -> Result<(), FormatError> {
    let remedy = "remove it and what refers to it";
    section
        .children_named("plugin")
        .try_for_each(|plugin| report.refuse(plugin, "a plugin", remedy))
}

/// All sections of a name as one: their attributes, the later ones winning, and their children.
pub(super) fn merged(root: &Element, name: &str) -> Element {
    let mut section = Element {
        name: name.to_owned(),
        attributes: Vec::new(),
        children: Vec::new(),
        place: root.place.clone(),
    };
    for part in root.children_named(name) {
        if section.attributes.is_empty() && section.children.is_empty() {
            section.place = part.place.clone();
        }
        section.inherit_over(&part.attributes);
        section.children.extend(part.children.iter().cloned());
    }
    section
}
