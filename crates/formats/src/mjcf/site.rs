//! `<site>` (XML reference, "body/site"): frames on bodies and in the world, for sensors and constraints.

use super::Context;
use super::content::Content;
use super::geom::between;
use super::orientation::{ORIENTATIONS, pose};
use super::tree::Tree;
use crate::error::FormatError;
use crate::report::Report;
use model::BodyId;

pub(super) const KNOWN: &[&str] = &[
    "name", "type", "group", "pos", "material", "size", "fromto", "rgba", "mesh", "user",
];
const TYPES: &[&str] = &["sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh"];

/// Adds a site of a body, or of the world.
pub(super) fn read(
    content: &Content,
    body: Option<BodyId>,
    tree: &mut Tree,
    context: &Context<'_>,
    report: &mut Report,
) -> Result<(), FormatError> {
    let defaults = &context.defaults;
    let site = defaults.apply(content.element, content.class, &["site"])?;
    report.check_attributes(&site, &[KNOWN, ORIENTATIONS].concat(), &[])?;
    let kind = site.word("type", TYPES)?.unwrap_or("sphere");
    let local = match between(&site, kind)? {
        Some((local, _)) => local,
        None => pose(&site, &context.compiler)?,
    };
    tree.add_site(&site, body, content.frame * local)
}
