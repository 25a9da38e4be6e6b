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
            "deformable" => {
                report.refuse(section, "a flexible body", "remove it from the file")?;
            }
            "extension" => {
                report.refuse(section, "a plugin", "remove it and what refers to it")?;
            }
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
