//! `<link>` (urdf/XML/link): a body's mass and shapes.

use super::geometry::{Looks, origin, shape};
use crate::error::FormatError;
use crate::inertia::{self, NOTHING};
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

/// Of opacity zero.
const UNSEEN: [f32; 4] = [0.0; 4];

/// The visual and collision shapes of a link. Only the visual ones are seen, if there are any.
pub(super) fn shapes(
    link: &Element,
    looks: &Looks<'_>,
    report: &mut Report,
) -> Result<Vec<Shape>, FormatError> {
    report.check_attributes(link, &["name", "type"], &[])?;
    let mut shapes = Vec::new();
    for child in &link.children {
        if ["visual", "collision"].contains(&child.name.as_str()) {
            shapes.extend(shape(child, looks, report)?);
        }
    }
    if shapes.iter().any(|shape| !shape.collides) {
        let collision = shapes.iter_mut().filter(|shape| shape.collides);
        collision.for_each(|shape| shape.color = Some(UNSEEN));
    }
    Ok(shapes)
}
