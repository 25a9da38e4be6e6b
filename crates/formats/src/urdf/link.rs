//! `<link>` (urdf/XML/link): a body's mass and shapes.

use super::geometry::{Looks, origin, shape};
use crate::error::FormatError;
use crate::inertia::{self, NOTHING};
use crate::meshes::UNSEEN;
use crate::report::Report;
use crate::xml::Element;
use model::{MassProperties, Shape};

/// Mass, centre and inertia of a link; nothing without an `<inertial>`. Unless the link `moves`, its
/// inertia is not checked, for it is not used.
pub(super) fn mass_properties(
    link: &Element,
    moves: bool,
    report: &mut Report,
) -> Result<MassProperties, FormatError> {
    let Some(inertial) = link.child("inertial") else {
        return Ok(NOTHING);
    };
    let mass = child(inertial, "mass")?;
    report.check_attributes(mass, &["value"], &[])?;
    mass.require("value")?;
    let mass = mass.non_negative("value")?.unwrap_or(0.0);
    if mass == 0.0 {
        return Ok(NOTHING);
    }
    let matrix = child(inertial, "inertia")?;
    let names = ["ixx", "iyy", "izz", "ixy", "ixz", "iyz"];
    report.check_attributes(matrix, &names, &[])?;
    let mut entries = [0.0; 6];
    for (entry, name) in entries.iter_mut().zip(names) {
        matrix.require(name)?;
        *entry = matrix.number(name)?.unwrap_or(0.0);
    }
    let frame = origin(inertial, report)?;
    let own = MassProperties {
        mass,
        inertia: inertia::symmetric(entries),
        ..NOTHING
    };
    if moves {
        let remedy = "correct them; setting all three to their mean also helps";
        inertia::check(matrix, own.principal().0, remedy)?;
    }
    Ok(own.placed(&frame))
}

fn child<'a>(element: &'a Element, name: &str) -> Result<&'a Element, FormatError> {
    element
        .child(name)
        .ok_or_else(|| element.invalid(&format!("it has no <{name}>"), &format!("add <{name} …/>")))
}

/// The visual and collision shapes of a link. Only the visual ones are seen, if there are any that can be.
pub(super) fn shapes(
    link: &Element,
    looks: &Looks<'_>,
    report: &mut Report,
) -> Result<Vec<Shape>, FormatError> {
    report.check_attributes(link, &["name", "type"], &[])?;
    let (mut shapes, mut elements) = (Vec::new(), Vec::new());
    for child in &link.children {
        if ["visual", "collision"].contains(&child.name.as_str())
            && let Some(shape) = shape(child, looks, report)?
        {
            shapes.push(shape);
            elements.push(child);
        }
    }
    let looks_otherwise = shapes.iter().any(|shape| !shape.collides);
    for (shape, element) in shapes.iter_mut().zip(elements) {
        if shape.collides && (looks_otherwise || !looks.meshes.can_show(element, shape, report)) {
            shape.color = Some(UNSEEN);
        }
    }
    Ok(shapes)
}
