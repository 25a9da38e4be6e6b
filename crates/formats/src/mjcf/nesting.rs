//! Which elements stand in which (XML reference): what is misplaced or misspelt is not passed over.
//!
//! What bodies, and the sections whose elements are read one by one, hold is seen there.

use super::body::GENERATORS;
use crate::error::FormatError;
use crate::xml::Element;

/// Sections of which not all elements are read.
const SECTIONS: &[(&str, &[&str])] = &[
    ("compiler", &["lengthrange"]),
    ("size", &[]),
    ("statistic", &[]),
    (
        "visual",
        &["global", "quality", "headlight", "map", "scale", "rgba"],
    ),
    ("custom", &["numeric", "text", "tuple"]),
    ("deformable", &["flex", "skin"]),
    ("extension", &["plugin"]),
];
/// Elements of sections and bodies that hold others; all others hold none.
const HOLDERS: &[(&str, &[&str])] = &[
    ("mesh", &["plugin"]),
    ("geom", &["plugin"]),
    ("material", &["layer"]),
    ("skin", &["bone"]),
    ("fixed", &["joint"]),
    ("spatial", &["site", "geom", "pulley"]),
    ("tuple", &["element"]),
];

/// Refuses what stands in an element that does not hold it.
pub(super) fn check(root: &Element) -> Result<(), FormatError> {
    for section in &root.children {
        if let Some((_, kinds)) = SECTIONS.iter().find(|(name, _)| *name == section.name) {
            hold(section, kinds)?;
        }
        section.children.iter().try_for_each(inside)?;
    }
    Ok(())
}

/// Within an element of a section or body. Generators, plugins and flexible bodies are refused as a whole.
fn inside(element: &Element) -> Result<(), FormatError> {
    match element.name.as_str() {
        "body" | "frame" | "default" => element.children.iter().try_for_each(inside),
        name if GENERATORS.contains(&name) || name == "flex" => Ok(()),
        name => {
            let holder = HOLDERS.iter().find(|(holder, _)| *holder == name);
            hold(element, holder.map_or(&[], |(_, kinds)| *kinds))
        }
    }
}

fn hold(element: &Element, kinds: &[&str]) -> Result<(), FormatError> {
    let mut children = element.children.iter();
    match children.find(|child| !kinds.contains(&child.name.as_str())) {
        None => Ok(()),
        Some(other) => {
            let problem = format!("<{}> holds no such element", element.name);
            let remedy = "correct its spelling, or put it where it belongs";
            Err(other.invalid(&problem, remedy))
        }
    }
}
